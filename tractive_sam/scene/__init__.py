"""The scene: what is asked, checked as a whole before anything is computed.

Tables and keys are those of a scene file; units mm, N, MPa, degrees, revolutions.
"""

from .bodies import Bodies, Body
from .catalogue import builtin_names
from .faults import Fault, PlausibilityWarning, SceneError, SceneWarning
from .gap import Gap
from .plane import Plane
from .scene import Scene
from .tables import (
    Accuracy,
    Coefficients,
    Creepage,
    Friction,
    Load,
    Mesh,
    Solver,
    Subsurface,
    Wear,
)

__all__ = [
    "Accuracy",
    "Bodies",
    "Body",
    "Coefficients",
    "Creepage",
    "Fault",
    "Friction",
    "Gap",
    "Load",
    "Mesh",
    "Plane",
    "PlausibilityWarning",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Solver",
    "Subsurface",
    "Wear",
    "builtin_names",
]
