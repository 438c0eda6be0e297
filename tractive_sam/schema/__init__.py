"""Reading of tables: types of keys, faults, documentation of keys, and TOML.

It contains no physics: the tables of a scene, of a study and of a table design are built on it.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
