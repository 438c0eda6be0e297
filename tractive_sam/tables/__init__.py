"""Tables of creep forces: made from many contacts, with error bars and gradients, and read again.

    title = "Steel on steel"
    ellipticity = [0.5, 1.0, 2.0]   # a/b; more values are added between these
    poisson = 0.3                   # or several
    tolerance = 0.01                # error bar and error of interpolation, over mu P

The law, its scaling and its symmetries are told in `tractive_sam.lookup.coordinates`.
"""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used: who reads a table computes nothing.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
