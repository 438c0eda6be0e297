"""Closed forms for comparison with computed results.

Units mm, N, MPa; x is the rolling direction; forces and tractions act on the upper body A, and
a negative longitudinal creepage drives it (Q_x > 0). Imports nothing of the package.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
