"""Linear maps from tractions to displacement and slip: planned once, applied many times."""

from tractive_sam.mechanics import Frame
from tractive_sam.operators.advection import Advection
from tractive_sam.operators.convolution import Convolution
from tractive_sam.operators.elastic import Operators
from tractive_sam.operators.extent import extent
from tractive_sam.operators.heat import STEPS_FROM, SurfaceHeat
from tractive_sam.operators.heat_memory import HeatMemory
from tractive_sam.operators.influence import Box, Lattice, block_mean
from tractive_sam.operators.kinematics import Kinematics, RollingStep, SteadyRolling
from tractive_sam.operators.memory import available
from tractive_sam.operators.meter import ConvolutionMeter
from tractive_sam.operators.rows import row_compliance
from tractive_sam.operators.stencil import STAGGERED, UPWIND, FrictionSlip, Stencil
from tractive_sam.operators.stress_layers import StressLayers
from tractive_sam.operators.stress_plane import StressPlane
from tractive_sam.operators.strip_layers import StripLayers
from tractive_sam.operators.surface import surface_stress
from tractive_sam.operators.threads import cores, one_blas_thread
from tractive_sam.results import Grid

__all__ = [
    "STAGGERED",
    "STEPS_FROM",
    "UPWIND",
    "Advection",
    "Box",
    "Convolution",
    "ConvolutionMeter",
    "Frame",
    "FrictionSlip",
    "Grid",
    "HeatMemory",
    "Kinematics",
    "Lattice",
    "Operators",
    "RollingStep",
    "SteadyRolling",
    "Stencil",
    "StressLayers",
    "StressPlane",
    "StripLayers",
    "SurfaceHeat",
    "available",
    "block_mean",
    "cores",
    "extent",
    "one_blas_thread",
    "row_compliance",
    "surface_stress",
]
