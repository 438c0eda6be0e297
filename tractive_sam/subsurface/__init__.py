"""Stress below the surface of both bodies, from the tractions of a solved contact.

Components xx, yy, zz, xy, xz, yz refer to the axes of the contact, for both bodies; MPa,
compression negative. Depths are distances below the surface of a body: body A is at
z = +depth, body B at z = -depth. Across the interface xz, yz and zz are continuous, -p_x, -p_y and
-p_n.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
