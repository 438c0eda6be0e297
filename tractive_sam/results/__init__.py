"""Plain data with names and units: grids, contacts, records, histories, stress.

A `State` is one solved contact, a `Record` contains its stored values, and a `History` contains all
records. A `Quantity` describes a recorded number and computes it from a contact.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used: code that needs only a mesh does not
# load scenes, as the rest of the package does.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
