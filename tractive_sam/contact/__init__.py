"""Contact problems of steady rolling, steps and shifts: model, laws of a scene, and solution."""

from tractive_sam.contact.equilibrium import equilibrium, fitted, fitted_blocks
from tractive_sam.contact.heat import divide_heat, wear_law_in, with_heat
from tractive_sam.contact.jacobian import check_jacobian, jacobian_of
from tractive_sam.contact.laws import Laws
from tractive_sam.contact.measured import across, standing_roughness, uncovered_axes
from tractive_sam.contact.mesh import as_asked, choose_grid, grown, reaching
from tractive_sam.contact.message import not_resolved
from tractive_sam.contact.model import Gap, Model
from tractive_sam.contact.roughness import Roughness, rough_maps
from tractive_sam.contact.step import Asked, Stepped, Stepper, travelled
from tractive_sam.contact.worn import Worn
from tractive_sam.results import NotConverged, State

__all__ = [
    "Asked",
    "Gap",
    "Laws",
    "Model",
    "NotConverged",
    "Roughness",
    "State",
    "Stepped",
    "Stepper",
    "Worn",
    "across",
    "as_asked",
    "check_jacobian",
    "choose_grid",
    "divide_heat",
    "equilibrium",
    "fitted",
    "fitted_blocks",
    "grown",
    "jacobian_of",
    "not_resolved",
    "reaching",
    "rough_maps",
    "standing_roughness",
    "travelled",
    "uncovered_axes",
    "wear_law_in",
    "with_heat",
]
