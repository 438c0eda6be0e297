"""Imports and compiled kernels that workers share.

The server process of `pool` imports this module before it copies itself, so that kernels are loaded
(at the first use after an installation: compiled) once, and not by each worker.
"""

from contextlib import suppress

from tractive_sam.run import roll
from tractive_sam.scene import Scene

with suppress(Exception):  # whatever the error, workers report it for their own scenes
    roll(Scene.builtin("spheres").replace(subsurface=None), progress=False)
