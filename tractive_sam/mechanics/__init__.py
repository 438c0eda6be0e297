"""Laws as objects: elastic bodies, friction, wear, and stress criteria.

The laws call the formulas of `tractive_sam.kernels`, which state their sources; the layers above
use only the laws. This package imports neither scenes nor solvers.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used: a material or a criterion needs no
# compiler.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
