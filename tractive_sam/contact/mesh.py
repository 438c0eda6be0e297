"""The mesh of a scene that does not give one."""

import math

import numpy as np

from tractive_sam.results import Grid
from tractive_sam.scene import MOST_ELEMENTS, Fault, Scene, SceneError

MARGIN = 1.15
"""Half length of the domain over the semi-axis of the Hertzian contact."""

WORN_MARGIN = 1.5
"""The same in the lateral direction of a scene that wears; it grows on with the contact."""

ACROSS = 64
"""Elements across the shorter axis of the contact."""

ACROSS_LINE = 512
"""Elements across a line contact, where they cost next to nothing."""


GROWTH = 1.25
"""Factor by which a chosen mesh grows when the contact reaches its edge."""


def grown(grid: Grid, axes: tuple[bool, bool] = (True, True)) -> Grid:
    """A mesh of the same elements that is larger along some axes; a row stays a row."""
    sides = zip(grid.half_length, axes, strict=True)
    return reaching(grid, tuple(half * (GROWTH if grows else 1.0) for half, grows in sides))


def reaching(grid: Grid, half_length: tuple[float, float]) -> Grid:
    """A mesh of the same elements, as many more on either side, at least so long; a row stays."""
    more = [
        max(0, int(np.ceil(0.5 * n * (asked / half - 1.0) - 1e-9))) if n > 1 else 0
        for asked, half, n in zip(half_length, grid.half_length, grid.elements, strict=True)
    ]
    elements = tuple(n + 2 * m for n, m in zip(grid.elements, more, strict=True))
    half_length = (0.5 * elements[0] * grid.dx, 0.5 * elements[1] * grid.dy)
    return Grid(half_length, elements)


def as_asked(grid: Grid) -> str:
    """A mesh as a scene asks for it, in digits enough to be the same elements."""
    directions = 1 if grid.line else 2
    lengths = ", ".join([f"{one:.10g}" for one in grid.half_length][:directions])
    elements = ", ".join([str(one) for one in grid.elements][:directions])
    return f"grid.half_length=[{lengths}] and grid.elements=[{elements}]"


def choose_grid(scene: Scene, measured=None, finer: float = 1.0) -> Grid:
    """The scene's [grid]; what it does not give is chosen from the Hertzian contact or the gap.

    Chosen elements are at most twice as long as wide or the reverse; their number is odd, so that
    one is centred on the axis.

    Parameters
    ----------
    scene : Scene
        What is asked.
    measured : Gap, optional
        The measured separation of a scene with [gap].
    finer : float
        Elements of a chosen mesh along each axis over the usual.

    Raises
    ------
    SceneError
        If a measured gap is so much longer than wide that they would be too many.
    """
    wears, shifts_only = scene.wear is not None, scene.shifts
    scene = scene.heaviest
    given = None if scene.grid is None else scene.grid.elements
    if scene.bounded:
        return Grid.of(scene.grid.half_length, given)
    if scene.hertz is not None and math.isinf(scene.hertz.b):
        half = [one.hertz.a for one in (scene.spectrum.scenes if scene.spectrum else (scene,))]
        elements = 2 * int(0.5 * MARGIN * ACROSS_LINE * finer * max(half) / min(half)) + 1
        return Grid.of((MARGIN * max(half),), given or (elements,))
    if scene.hertz is None:
        x, y, _ = measured
        half_length = (float(max(-x[0], x[-1])), float(max(-y[0], y[-1])))
        across = 0.5 * min(half_length)
        side = (2.0 * across / (ACROSS * finer),) * 2
    else:
        lateral = WORN_MARGIN if wears else MARGIN
        along = WORN_MARGIN if wears and shifts_only else MARGIN  # fretting lets it grow in x, too
        shifts = scene.spectrum.shifts if scene.spectrum else (0.0,)
        contacts = [one.hertz for one in (scene.spectrum.scenes if scene.spectrum else (scene,))]
        reach = [lateral * c.b + abs(y) for c, y in zip(contacts, shifts, strict=True)]
        half_length = (along * max(c.a for c in contacts), max(reach))
        a, b = (min(getattr(c, axis) for c in contacts) for axis in "ab")
        side = (2.0 * a / (ACROSS * finer), 2.0 * b / (ACROSS * finer))
        side = tuple(min(length, 2.0 * min(side)) for length in side)
    elements = given or tuple(
        int(2 * np.ceil(length / s - 0.5) + 1) for length, s in zip(half_length, side, strict=True)
    )
    if math.prod(elements) > MOST_ELEMENTS:
        given = f"nothing, and a measured gap of {2 * half_length[0]:g} x {2 * half_length[1]:g} mm"
        raise SceneError([Fault("grid", given, "a [grid] where the gap is so long or so wide")])
    return Grid(half_length, elements)
