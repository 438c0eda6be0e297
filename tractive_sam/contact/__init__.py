"""Contact problems of steady rolling, steps and shifts: model, laws of a scene, and solution."""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
