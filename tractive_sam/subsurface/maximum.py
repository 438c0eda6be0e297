"""The largest equivalent stress of a body, and where it is."""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.results import Maximum, Point, State
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.maximise import maximise
from tractive_sam.subsurface.multilevel import Layer, MultiLevel
from tractive_sam.subsurface.strips import StripLevels

SHALLOWEST = 2.0
"""Depth of the first layer of the search, over the longer side of an element. What the steps of the
tractions between elements make of the stress falls as (1 + k z) exp(-k z), k = 2 pi over the side:
one element deep it is still a percent, and makes maxima of its own; two deep it is 5e-5."""

GROWTH = 2.0
"""Ratio of the depths of successive layers."""

DEEPEST = 1.25
"""Depth of its last layer, over the smaller half width of the contact."""

CANDIDATES = 6
"""Local maxima of the search that are looked at more closely."""

BETWEEN = 1.1
"""By what a maximum between the points of the search may be higher than these. Half a layer and a
quarter of the depth aside of that of Hertz it is 7 %."""

CLOSE = 0.99
"""Tops that may be the highest, over the one that is found so: each is right to a percent."""

_NOWHERE: Point = (np.nan, np.nan, np.nan)


def stress_maximum(contact: State, body: str = "A", laws: Laws | None = None) -> Maximum:
    """Find the largest stress in a body, by von Mises or another criterion.

    Layers at depths that grow by `GROWTH` show where to look; below the first few, elements are
    taken together in blocks of at most half the depth. The best local maxima are refined with
    blocks that grow with their distance; the value is exact for the tractions on the elements, the
    place off by so little of its depth that the value there is the largest to 1e-4.

    At the surface it is taken between the elements, at the edge of the contact and where stick
    ends, from differences of displacements: on a mesh, the stress itself is infinite on every edge
    across which the tangential traction jumps (`subsurface.surface`). From there down to two
    elements deep nothing is looked at.

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
    return _maxima(contact, (body,), laws)[body]


def stress_maxima(contact: State, laws: Laws | None = None) -> dict[str, Maximum]:
    """The largest stress in each body that the scene's [subsurface] names; see `stress_maximum`.

    Examples
    --------
    >>> list(stress_maxima(contact))
    ['A', 'B']
    """
    subsurface = contact.scene.subsurface
    return {} if subsurface is None else _maxima(contact, subsurface.bodies, laws)


def _maxima(contact: State, bodies: Sequence[str], laws: Laws | None) -> dict[str, Maximum]:
    """The largest stress in bodies, which share most of the work."""
    laws = laws or Laws.of(contact.scene)
    load, criterion = LoadedBodies.of(contact, bodies, laws), laws.criterion
    if not load.tractions.any():
        nothing = Maximum(criterion, 0.0, _NOWHERE, np.nan, _NOWHERE, 0.0, _NOWHERE)
        return dict.fromkeys(load.names, nothing)
    levels = load.source.levels(criterion)
    surface = levels.surface(contact.sliding)
    layers = [levels.layer(depth) for depth in _search_depths(contact, levels.side)]
    found = {}
    starts = _local_maxima(layers, levels.blocks)
    for body, (name, from_here) in enumerate(zip(load.names, starts, strict=True)):
        value, at = top = surface[body]
        interior, interior_at = _interior(levels, body, layers, from_here, value)
        if interior > value:
            value, at = interior, interior_at
        found[name] = Maximum(criterion, value, at, interior, interior_at, *top)
    return found


def _search_depths(contact: State, side: float) -> np.ndarray:
    """From below the elements on until no maximum is to be expected any more, mm."""
    deepest = DEEPEST * min(contact.half_width_x, contact.half_width_y)
    first = SHALLOWEST * side
    count = max(3, int(np.ceil(np.log(deepest / first) / np.log(GROWTH))) + 1)
    return first * GROWTH ** np.arange(count)


def _interior(
    levels: MultiLevel | StripLevels,
    body: int,
    layers: list[Layer],
    starts: list[tuple[int, int, int]],
    surface: float,
) -> tuple[float, Point]:
    """Go on from the largest local maxima of the layers below the surface."""
    floor = layers[0].depth
    near, exact = partial(levels.around, body), partial(levels.at, body)
    tops = []
    best = 0.0
    for k, i, j in starts:
        layer = layers[k]
        if layer.values[body, i, j] * BETWEEN < best:
            break  # the others are lower still
        start = np.array([layer.x[i], layer.y[j], layer.depth])
        at = maximise(near, start, floor, CLOSE * surface)
        # A way that ends at the floor leads on to the surface, unless that is lower.
        if at is None or (at[2] <= floor and exact(at[None])[0] <= surface):
            continue
        value = near(at[None], at)[0]
        tops.append((value, at))
        best = max(best, value)
    if not tops:
        return np.nan, _NOWHERE
    highest = [at for value, at in tops if value >= CLOSE * best]
    values = exact(np.array(highest))
    first = np.argmax(values)
    return float(values[first]), tuple(map(float, highest[first]))


def _local_maxima(
    layers: list[Layer], blocks: tuple[int, int]
) -> Iterator[list[tuple[int, int, int]]]:
    """Layer and place in it, (k, i, j), of the largest local maxima of each body inside it.

    Of every layer the largest value in each of the coarsest blocks, where no block beside it has a
    larger one, nor has the layer above or below it there.
    """
    tops = np.stack([_largest_in(layer.values, blocks) for layer in layers], axis=1)
    peaks = tops == _largest_around(tops)
    for body, (values, found) in enumerate(zip(tops, peaks, strict=True)):
        each = _peaks(layers, body, blocks, np.argwhere(found)[np.argsort(-values[found])])
        yield list(islice(each, CANDIDATES))


def _peaks(
    layers: list[Layer], body: int, blocks: tuple[int, int], places: np.ndarray
) -> Iterator[tuple[int, int, int]]:
    """Those of the largest values in blocks that are larger than the layers above and below."""
    for k, m, n in places.tolist():
        here = layers[k]
        i, j = _top(here.values[body], blocks, m, n)
        beside = (layers[other] for other in (k - 1, k + 1) if 0 <= other < len(layers))
        value, x, y = here.values[body, i, j], here.x[i], here.y[j]
        if all(other.near(body, x, y) <= value for other in beside):
            yield k, i, j


def _largest_around(values: np.ndarray) -> np.ndarray:
    """The largest of each value and its 8 neighbours, along the last two axes."""
    for axis in (2, 3):
        along = np.moveaxis(values, axis, 0)
        largest = along.copy()
        np.maximum(largest[1:], along[:-1], out=largest[1:])
        np.maximum(largest[:-1], along[1:], out=largest[:-1])
        values = np.moveaxis(largest, 0, axis)
    return values


def _largest_in(values: np.ndarray, blocks: tuple[int, int]) -> np.ndarray:
    """The largest value in each block; halving by halving, as numpy reduces short axes slowly."""
    while values.shape[1] > blocks[0]:
        values = np.maximum(values[:, ::2], values[:, 1::2])
    while values.shape[2] > blocks[1]:
        values = np.maximum(values[:, :, ::2], values[:, :, 1::2])
    return values


def _split(layer: np.ndarray, blocks: tuple[int, int]) -> np.ndarray:
    """A layer by blocks: (..., block in x, within it, block in y, within it)."""
    (*bodies, nx, ny), (mx, my) = layer.shape, blocks
    return layer.reshape(*bodies, mx, nx // mx, my, ny // my)


def _top(layer: np.ndarray, blocks: tuple[int, int], i: int, j: int) -> tuple[int, int]:
    """Where in a layer the largest value of block (i, j) is."""
    block = _split(layer, blocks)[i, :, j]
    m, n = np.unravel_index(np.argmax(block), block.shape)
    return i * block.shape[0] + int(m), j * block.shape[1] + int(n)
