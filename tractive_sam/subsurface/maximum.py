"""The largest equivalent stress of a body, and where it is."""

import numpy as np
from scipy.ndimage import maximum_filter

from tractive_sam.contact import Laws
from tractive_sam.results import Maximum, Point, State
from tractive_sam.subsurface.climb import climb, polish
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.pyramid import Pyramid

GROWTH = 1.5
"""Ratio of the depths of successive layers of the search."""

DEEPEST = 1.25
"""Depth of its last layer, over the smaller half width of the contact."""

CANDIDATES = 3
"""Local maxima of the search that are looked at more closely."""

BETWEEN = 1.1
"""By what a maximum between the points of the search may be higher than these. Half a layer and a
quarter of the depth aside of that of Hertz it is 2 %."""

_NOWHERE: Point = (np.nan, np.nan, np.nan)


def stress_maximum(contact: State, body: str = "A", laws: Laws | None = None) -> Maximum:
    """Find the largest stress in a body, by von Mises or another criterion.

    Layers at depths that grow by `GROWTH` show where to look; below the first few, elements are
    taken together in blocks of at most half the depth. The best local maxima are climbed with the
    same blocks; the last step and the value are exact for the tractions on the elements.

    At the surface it is taken between the elements, at the edge of the contact and where stick
    ends, from differences of displacements: on a mesh, the stress itself is infinite on every edge
    across which the tangential traction jumps (`subsurface.surface`). From there down to one
    element deep nothing is looked at.

    Parameters
    ----------
    contact : State
        The solved contact.
    body : "A" or "B"
        The body concerned.
    laws : Laws, optional
        Criterion, and what the contact was solved with; by default those of its scene.

    Returns
    -------
    Maximum
        Zero, and nowhere, if there is no contact.

    Raises
    ------
    ValueError
        If there is no such body.

    Examples
    --------
    >>> top = ts.stress_maximum(contact, "A")
    >>> round(top.interior / scene.hertz.p0, 2), round(top.interior_at[2] / scene.hertz.a, 2)
    (0.67, 0.47)
    """
    laws = laws or Laws.of(contact.scene)
    load, criterion = LoadedBodies.of(contact, (body,), laws), laws.criterion
    if not load.tractions.any():
        return Maximum(criterion, 0.0, _NOWHERE, np.nan, _NOWHERE, 0.0, _NOWHERE)
    pyramid = load.source.levels(criterion)
    depths = _search_depths(contact, pyramid.side)
    layers = [pyramid.level(0.5 * depth).layer(depth) for depth in depths]
    surface, surface_at = pyramid.surface(contact.sliding)
    interior, interior_at = _interior(pyramid, depths, layers, surface)
    value, at = (interior, interior_at) if interior > surface else (surface, surface_at)
    return Maximum(criterion, value, at, interior, interior_at, surface, surface_at)


def stress_maxima(contact: State, laws: Laws | None = None) -> dict[str, Maximum]:
    """The largest stress in each body that the scene's [subsurface] names; see `stress_maximum`.

    Examples
    --------
    >>> list(stress_maxima(contact))
    ['A', 'B']
    """
    subsurface = contact.scene.subsurface
    bodies = () if subsurface is None else subsurface.bodies
    return {body: stress_maximum(contact, body, laws) for body in bodies}


def _search_depths(contact: State, side: float) -> np.ndarray:
    """The surface, one element below it, and on until no maximum is to be expected any more, mm."""
    deepest = DEEPEST * min(contact.half_width_x, contact.half_width_y)
    count = max(3, int(np.ceil(np.log(deepest / side) / np.log(GROWTH))) + 1)
    return np.concatenate(([0.0], side * GROWTH ** np.arange(count)))


def _interior(
    pyramid: Pyramid, depths: np.ndarray, layers: list[np.ndarray], surface: float
) -> tuple[float, Point]:
    """Climb from the largest local maxima of the layers below the surface."""
    floor = depths[1]
    tops = []
    best = 0.0
    for k, i, j in _local_maxima(pyramid, layers):
        if layers[k][i, j] * BETWEEN < best:
            break  # the others are lower still
        level = pyramid.level(0.5 * depths[k])
        start = np.array([level.x[i], level.y[j], depths[k]])
        blocks = pyramid.level(0.5 * depths[k])
        at, hessian = climb(blocks.at, start, floor)
        value = blocks.at(at[None])[0]
        # A way that ends at the floor leads on to the surface, unless that is lower.
        if at[2] > floor or value > surface:
            tops.append((value, at, hessian))
            best = max(best, value)
    if not tops:
        return np.nan, _NOWHERE
    _, at, hessian = max(tops, key=lambda top: top[0])
    at, value = polish(pyramid.level(0.0).at, at, hessian, floor)
    return value, tuple(map(float, at))


def _local_maxima(pyramid: Pyramid, layers: list[np.ndarray]) -> list[tuple[int, int, int]]:
    """Layer and element (k, i, j) of the largest local maxima below the surface."""
    # Of every layer the largest value in each of the coarsest blocks, (layer, block, block).
    values = np.stack([_split(layer, pyramid.blocks).max(axis=(1, 3)) for layer in layers])
    found = np.argwhere(values == maximum_filter(values, 3, mode="nearest"))
    found = found[found[:, 0] > 0]
    best = np.argsort(-values[tuple(found.T)])[:CANDIDATES]
    return [(k, *_top(layers[k], pyramid.blocks, i, j)) for k, i, j in found[best].tolist()]


def _split(layer: np.ndarray, blocks: tuple[int, int]) -> np.ndarray:
    """A layer by blocks: (block in x, within it, block in y, within it)."""
    (nx, ny), (mx, my) = layer.shape, blocks
    return layer.reshape(mx, nx // mx, my, ny // my)


def _top(layer: np.ndarray, blocks: tuple[int, int], i: int, j: int) -> tuple[int, int]:
    """Where in a layer the largest value of block (i, j) is."""
    block = _split(layer, blocks)[i, :, j]
    m, n = np.unravel_index(np.argmax(block), block.shape)
    return i * block.shape[0] + int(m), j * block.shape[1] + int(n)
