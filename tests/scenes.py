"""Scenes that many tests share."""

import numpy as np
import pytest

from tractive_sam.contact import Model, equilibrium
from tractive_sam.run import roll
from tractive_sam.scene import Scene


def steady(name, *settings, elements=None, start=None, solver=None):
    """The solved contact of a built-in scene with settings, on a mesh of `elements`."""
    settings = list(settings)
    if elements is not None:
        half = {"spheres": 4.08, "spheres-orthotropic": 4.08}[name]
        settings.append(f"grid.half_length=[{half}, {half}]")
        settings.append(f"grid.elements=[{elements}, {elements}]")
    return equilibrium(Model(Scene.builtin(name).with_set(settings), solver=solver), start=start)


def across_contact(scene, n, beside=4):
    """The line contact on n elements across it unworn, so that its edges are elements' edges."""
    half_length = scene.hertz.a * (n + beside) / n
    return scene.replace(**{"grid.half_length": half_length, "grid.elements": n + beside})


def steady_line(n, *settings, name="cylinders"):
    """The solved line contact of a built-in scene with settings, on n elements across it."""
    return equilibrium(Model(across_contact(Scene.builtin(name).with_set(settings), n)))


class Stop(Exception):
    """Ends a roll from its progress."""


def interrupted(scene, path, after, **options):
    """Roll until a number of records is reached."""
    seen = []

    def progress(record):
        seen.append(record)
        if len(seen) == after:
            raise Stop

    with pytest.raises(Stop):
        roll(scene, path, progress=progress, **options)


def size(field):
    """Root of the sum of squares."""
    return float(np.linalg.norm(field))
