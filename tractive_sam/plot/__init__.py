"""Figures as the field draws them; the only room that draws.

Every function returns a matplotlib `Figure` that belongs to no window and no global state, but for
`save_all` and `animate`, which write files.
"""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
