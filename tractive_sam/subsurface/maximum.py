"""The largest equivalent stress of a body and its position."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.kernels.tops import ENDED, GOES_ON, climb, find_tops, last_steps, stencil
from tractive_sam.results import Maximum, Point, State
from tractive_sam.subsurface.loaded_bodies import LoadedBodies
from tractive_sam.subsurface.multilevel import MultiLevel
from tractive_sam.subsurface.sources import StripLevels

_NOWHERE: Point = (np.nan, np.nan, np.nan)


@dataclass(frozen=True)
class MaximumSearch:
    """Settings of the search for the largest stress below the surface.

    Attributes
    ----------
    shallowest : float
        Depth of the first layer over the longer side of an element. Steps of the traction between
        elements change the stress by (1 + k z) exp(-k z), k = 2 pi over the side: at the depth of
        one element by a per cent, which causes local maxima, at two by 5e-5.
    deepest : float
        Smallest depth of the last layer over half of the shorter side of the contact: the maximum
        of a Hertz contact is at 0.45 to 0.79.
    candidates : int
        Local maxima that are refined.
    steps : int
        Largest number of Newton steps: longer searches oscillate between elements near the surface.
    rise : float
        Largest ratio of a maximum to the start of its search. For a Hertz contact it is 1.07 from
        half a layer above and a quarter of the depth aside.
    close : float
        Part of the stress at the surface: a search path that ends at the first layer below it
        cannot exceed the surface.
    """

    shallowest: float = 2.0
    deepest: float = 0.8
    candidates: int = 6
    steps: int = 6
    rise: float = 1.1
    close: float = 0.99


_SEARCH = MaximumSearch()


def stress_maximum(contact: State, body: str = "A", laws: Laws | None = None) -> Maximum:
    """Return the largest equivalent stress inside and at the surface of a body, with positions.

    The search starts in layers at depths in a geometric sequence, with elements combined in blocks
    with sides up to the depth. The largest local maxima are refined with blocks that grow with
    their distance. For constant tractions on the elements the error of the value is 6e-4, of the
    position a hundredth of its depth (`benchmarks/whole_roll.py`). If two maxima are nearer than
    the layers, the result may be the smaller one.

    At the surface the stress is computed between the elements, at the edge of the contact and at
    the border of stick and slip, from differences of displacements: on a mesh the stress is
    infinite on every edge with a jump of the tangential traction (`subsurface.multilevel`). Depths
    of less than two elements are not searched: if elements are longer than about a quarter of the
    smaller half width of the contact, the result for the interior is too small.

    Parameters
    ----------
    contact : State
        The solved contact.
    body : "A" or "B"
        The body.
    laws : Laws, optional
        Criterion and bodies; by default the laws of the solution.

    Returns
    -------
    Maximum
        Zero without position if there is no contact.

    Raises
    ------
    ValueError
        If the body is not "A" or "B".

    Examples
    --------
    >>> top = ts.stress_maximum(contact, "A")
    >>> round(top.interior / scene.hertz.p0, 2), round(top.interior_at[2] / scene.hertz.a, 1)
    (0.67, 0.5)
    """
    return _maxima(contact, (body,), laws)[body]


def maxima_by_body(contact: State, laws: Laws | None = None) -> dict[str, Maximum]:
    """Return the largest stress in each body of [subsurface], by body; {} without the table.

    Examples
    --------
    >>> list(maxima_by_body(contact))
    ['A', 'B']
    """
    subsurface = contact.scene.subsurface
    return {} if subsurface is None else _maxima(contact, subsurface.bodies, laws)


def _maxima(contact: State, bodies: Sequence[str], laws: Laws | None) -> dict[str, Maximum]:
    """Return the largest stress in and on each of several bodies, by body; 0 without load."""
    laws = laws or Laws.of_contact(contact, ("elasticity", "criterion"))
    load, criterion = LoadedBodies.from_contact(contact, bodies, laws), laws.criterion
    if not load.tractions.any():
        nothing = Maximum(criterion, 0.0, _NOWHERE, np.nan, _NOWHERE, 0.0, _NOWHERE)
        return dict.fromkeys(load.names, nothing)
    levels = load.source.levels(criterion)
    surface = levels.surface(contact.sliding)
    interior = _interior(levels, [top[0] for top in surface])
    maxima = {}
    for name, above, below in zip(load.names, surface, interior, strict=True):
        larger = below if below[0] > above[0] else above
        maxima[name] = Maximum(criterion, *larger, *below, *above)
    return maxima


def _interior(levels: MultiLevel | StripLevels, surface: list[float]) -> list[tuple[float, Point]]:
    """Return (value, position) of the largest stress below each body's surface; nan if none."""
    depths = _search_depths(levels)
    bound, floor = np.array(surface), float(depths[0])
    bodies, tops, values = _climb_to_maxima(levels, *_starts(levels, depths), floor, bound)
    # A search path that ends at the floor would continue to the surface, unless that is lower.
    below = (tops[:, 2] > floor) | (values > bound[bodies])
    maxima: list[tuple[float, Point]] = [(np.nan, _NOWHERE)] * len(surface)
    for k in np.flatnonzero(below)[np.argsort(values[below])]:
        x, y, depth = tops[k].tolist()
        maxima[bodies[k]] = float(values[k]), (x, y, depth)
    return maxima


def _search_depths(levels: MultiLevel | StripLevels) -> np.ndarray:
    """Return depths in geometric sequence, mm, of the layers in which the search starts."""
    first, deepest = _SEARCH.shallowest * levels.side, _SEARCH.deepest * levels.half_width
    count = max(3, int(np.ceil(np.log(deepest / first) / np.log(levels.growth))) + 1)
    return first * levels.growth ** np.arange(count)


def _starts(levels: MultiLevel | StripLevels, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return bodies (n,) and points (n, 3) of each body's largest local maxima in stress layers."""
    layers = [levels.layer(depth) for depth in depths]
    none = np.empty((len(layers[0].values), 0, 0))
    values = [*(layer.values for layer in layers), none]
    # The second layer is not compared with the first, where the stress of the surface may end.
    higher = [none, none, *values[1:]]
    starts = []
    for layer, above, here, below in zip(layers, higher, values, values[1:], strict=False):
        body, value, i, j, deeper = find_tops(here, above, below).T
        starts.append((body.astype(int), value, layer.points(i, j, levels.growth**deeper)))
    bodies, value, at = (np.concatenate(each) for each in zip(*starts, strict=True))
    order = np.argsort(-value)
    chosen = [order[bodies[order] == body][: _SEARCH.candidates] for body in range(len(none))]
    return bodies[np.concatenate(chosen)], at[np.concatenate(chosen)]


def _climb_to_maxima(
    levels: MultiLevel | StripLevels,
    bodies: np.ndarray,
    at: np.ndarray,
    floor: float,
    surface: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Climb from points to local maxima of stress; return bodies, points and values.

    A search path is abandoned if it ends at or below another one, or at the floor below a larger
    stress at the surface.

    Returns
    -------
    bodies, points, values : ndarray, shapes (n,), (n, 3) and (n,)
        Body, position and stress of each maximum.
    """
    barred, best = np.zeros(len(bodies), dtype=bool), np.zeros(len(surface))
    threshold = _SEARCH.close * surface[bodies]
    ended = []
    for step in range(_SEARCH.steps):
        values = levels.stress_around(bodies, stencil(at), at)
        if step == 0:
            highest = _SEARCH.rise * values[:, 0]
        fates = climb(at, barred, best, values, bodies, highest, threshold, floor, step == 0)
        last, on = fates == ENDED, fates == GOES_ON
        ended.append((bodies[last], at[last]))
        if not on.any():
            break
        bodies, at, barred, highest, threshold = (
            each[on] for each in (bodies, at, barred, highest, threshold)
        )
    bodies, at = (np.concatenate(each) for each in zip(*ended, strict=True))
    values = levels.stress_around(bodies, stencil(at), at, closely=True)
    return bodies, at, last_steps(at, values, floor)
