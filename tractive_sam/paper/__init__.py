"""Reproduction of every figure and table of the paper, and comparison with its statements.

After Juliá & Rodríguez-Tembleque, Int. J. Mech. Sci. 294 (2025) 110195. Every chapter computes a
group of the paper's figures and yields its findings one by one: statements, figures, tables. Every
result on the page is computed in one run.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
