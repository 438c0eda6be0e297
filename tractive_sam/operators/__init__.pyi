"""What `operators` lets out, for `__init__.py` and for type checkers."""

from .advection import Advection as Advection
from .eigenstrain import EigenstrainBox as EigenstrainBox
from .eigenstrain import isotropic_stiffness as isotropic_stiffness
from .elastic import Box as Box
from .elastic import Lattice as Lattice
from .elastic import Operators as Operators
from .elastic import operators_of as operators_of
from .elastic import row_compliance as row_compliance
from .elastic import transform_quadrants as transform_quadrants
from .heat import STEPS_FROM as STEPS_FROM
from .heat import HeatMemory as HeatMemory
from .heat import SurfaceHeat as SurfaceHeat
from .kinematics import Kinematics as Kinematics
from .kinematics import RollingStep as RollingStep
from .kinematics import SteadyRolling as SteadyRolling
from .stencil import STAGGERED as STAGGERED
from .stencil import UPWIND as UPWIND
from .stencil import FrictionSlip as FrictionSlip
from .stencil import Stencil as Stencil
from .stress_layers import StressLayers as StressLayers
from .stress_layers import StressPlane as StressPlane
from .stress_layers import StripLayers as StripLayers
from .stress_layers import extent as extent
from .stress_layers import layer_cache as layer_cache
from .stress_layers import surface_stress as surface_stress
