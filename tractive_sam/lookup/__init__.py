"""Evaluation of creep-force tables, with NumPy alone.

`hermite` interpolates, `coordinates` converts creepages to the bounded coordinates of a table,
`creep_table` combines both, and `c_code` and `text` write a table as C code and as columns.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
