"""The tables of a scene, and the checks of them before anything is computed.

Tables and keys are those of a scene file; units mm, N, MPa, degrees, revolutions.
"""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
