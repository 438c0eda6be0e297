"""Published results of the field beside computed ones: closed forms, tables, programs, tests.

Every set of published values knows its source, the digits that the source claims and the error that
its computation claims. `validate` computes all sets and writes one page; see docs/validation.md.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
