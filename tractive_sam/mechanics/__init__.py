"""The laws as objects: elastic bodies, friction, wear, and how stress is judged.

Formulas are in `tractive_sam.kernels` with their sources; the laws call them, and everything above
sees the laws only. Imports nothing of what is asked (`scene`) or solved.
"""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used: a material or a criterion needs no
# compiler.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
