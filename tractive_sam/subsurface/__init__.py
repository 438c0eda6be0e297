"""Stress below the surface of both bodies, from the tractions of a solved contact.

Components xx, yy, zz, xy, xz, yz are those of the axes of the contact, for both bodies; MPa,
compression negative. Depths are distances below the surface of the body concerned: body A is at
z = +depth, body B at z = -depth. Across the interface xz, yz and zz are continuous, -p_x, -p_y and
-p_n.
"""

from tractive_sam.results import Maximum, PlaneStress
from tractive_sam.subsurface.cycle import cycle_depths, cycle_fatigue, fatigue
from tractive_sam.subsurface.depth import depths, semi_axes
from tractive_sam.subsurface.layers import stress_layers
from tractive_sam.subsurface.maximum import stress_maxima, stress_maximum
from tractive_sam.subsurface.plane import stress_on_plane, stress_on_planes
from tractive_sam.subsurface.points import stress_at, stress_path
from tractive_sam.subsurface.volume import stress_volume

__all__ = [
    "Maximum",
    "PlaneStress",
    "cycle_depths",
    "cycle_fatigue",
    "depths",
    "fatigue",
    "semi_axes",
    "stress_at",
    "stress_layers",
    "stress_maxima",
    "stress_maximum",
    "stress_on_plane",
    "stress_on_planes",
    "stress_path",
    "stress_volume",
]
