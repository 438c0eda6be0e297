"""Linear maps from tractions to displacement and slip: planned once, applied many times."""

from tractive_sam.mechanics import Frame
from tractive_sam.operators.convolution import Convolution
from tractive_sam.operators.elastic import Operators
from tractive_sam.operators.influence import Lattice
from tractive_sam.operators.stencil import STAGGERED, UPWIND, Stencil
from tractive_sam.operators.stress_layers import StressLayers
from tractive_sam.operators.stress_plane import StressPlane
from tractive_sam.operators.surface import surface_stress
from tractive_sam.results import Grid

__all__ = [
    "STAGGERED",
    "UPWIND",
    "Convolution",
    "Frame",
    "Grid",
    "Lattice",
    "Operators",
    "Stencil",
    "StressLayers",
    "StressPlane",
    "surface_stress",
]
