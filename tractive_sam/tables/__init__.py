"""Construction of creep-force tables from many contacts, with error bars and gradients.

    title = "Steel on steel"
    ellipticity = [0.5, 1.0, 2.0]   # a/b; the program adds values between these
    poisson = 0.3                   # or several values
    tolerance = 0.01                # error bar and interpolation error, over mu P

`tractive_sam.lookup.hermite` describes the law, its scaling and its symmetries.
"""

from tractive_sam.lazy_names import attach_names, with_renamed

# Names, listed in __init__.pyi, are looked up when first used: who reads a table computes nothing.
_lookup, __dir__, __all__ = attach_names(__name__, __file__)
_RENAMED = {"Progress": "TableProgress"}
__getattr__ = with_renamed(__name__, _lookup, _RENAMED)
