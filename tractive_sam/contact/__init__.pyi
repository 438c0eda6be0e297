"""What `contact` lets out, for `__init__.py` and for type checkers."""

from .heat import divide_heat as divide_heat
from .heat import wear_law_in as wear_law_in
from .heat import with_heat as with_heat
from .jacobian import check_jacobian as check_jacobian
from .jacobian import jacobian_of as jacobian_of
from .laws import Laws as Laws
from .measured import gap_across as gap_across
from .measured import standing_roughness as standing_roughness
from .measured import uncovered_axes as uncovered_axes
from .mesh import choose_grid as choose_grid
from .mesh import describe_grid_entries as describe_grid_entries
from .mesh import enlarge as enlarge
from .mesh import extend_to as extend_to
from .message import not_resolved as not_resolved
from .model import Gap as Gap
from .model import Model as Model
from .roughness import Roughness as Roughness
from .roughness import rough_maps as rough_maps
from .steady import equilibrium as equilibrium
from .steady import solve_blocks_on_fitted_mesh as solve_blocks_on_fitted_mesh
from .steady import solve_on_fitted_mesh as solve_on_fitted_mesh
from .steady import solve_patches_on_fitted_mesh as solve_patches_on_fitted_mesh
from .step import Stepper as Stepper
from .step_result import StepInput as StepInput
from .step_result import StepResult as StepResult
from .worn import Worn as Worn
