"""The engine that reads tables: types of keys, faults, documentation of keys, TOML.

It contains no physics: the tables of a scene, of a study and of a table design are built on it.
"""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
