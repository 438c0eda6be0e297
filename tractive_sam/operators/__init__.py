"""Linear maps from tractions to displacement and slip: planned once, applied many times."""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
