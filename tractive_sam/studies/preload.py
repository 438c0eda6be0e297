"""Imports and compiled kernels that workers share.

The server process of `pool` imports this module before it copies itself, so that kernels are loaded
(at the first use after an installation: compiled) once, and not by each worker.
"""

import gc
from contextlib import suppress

gc.disable()  # a search for unused objects takes a tenth of the time of imports

from tractive_sam.run import roll  # noqa: E402 - without searches
from tractive_sam.scene import Scene  # noqa: E402

with suppress(Exception):  # whatever the error, workers report it for their own scenes
    roll(Scene.builtin("spheres").replace(subsurface=None), progress=False)

gc.freeze()  # copies search and change only their own objects
gc.enable()
