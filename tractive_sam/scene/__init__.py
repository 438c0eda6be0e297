"""The tables of a scene, and the checks of these tables before a computation.

A scene file has these tables and keys; units mm, N, MPa, degrees, revolutions.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
