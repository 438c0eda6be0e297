"""The largest equivalent stress of a body, and where it is."""

from collections.abc import Sequence

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.kernels.tops import ENDED, GOES_ON, climb, find_tops, last_steps, stencil
from tractive_sam.results import Maximum, Point, State
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.multilevel import MultiLevel
from tractive_sam.subsurface.strips import StripLevels

SHALLOWEST = 2.0
"""Depth of the first layer of the search, over the longer side of an element. What the steps of the
tractions between elements make of the stress falls as (1 + k z) exp(-k z), k = 2 pi over the side:
one element deep it is still a percent, and makes maxima of its own; two deep it is 5e-5."""

DEEPEST = 0.8
"""Least depth of its last layer, over half of the shorter side of the contact: that of Hertz has
its maximum 0.45 to 0.79 deep."""

CANDIDATES = 6
"""Local maxima of the search that are looked at more closely."""

STEPS = 6
"""Largest number of Newton steps: a longer search swings between elements near the surface."""

RISE = 1.1
"""By what a top may be higher than where the way to it begins. Half a layer and a quarter of the
depth aside of that of Hertz it is 7 %."""

CLOSE = 0.99
"""Part of the surface's stress below which a way that the floor bars cannot end higher."""

_NOWHERE: Point = (np.nan, np.nan, np.nan)


def stress_maximum(contact: State, body: str = "A", laws: Laws | None = None) -> Maximum:
    """Find the largest stress in a body, by von Mises or another criterion.

    Layers at depths that grow by a factor show where to look; in them elements are taken together
    in blocks with sides up to the depth. The best local maxima are refined with blocks that grow
    with their distance. For tractions constant on the elements the value is right to 6e-4, the
    place to a hundredth of its depth (`benchmarks/whole_roll.py`). Of two maxima that are nearer to
    each other than layers are the lower one may be found.

    At the surface it is taken between the elements, at the edge of the contact and where stick
    ends, from differences of displacements: on a mesh, the stress itself is infinite on every edge
    across which the tangential traction jumps (`subsurface.surface`). From there down to two
    elements deep nothing is looked at: where elements are longer than about a quarter of the
    smaller half width of the contact, the largest stress inside is missed: what is found is less.

    Parameters
    ----------
    contact : State
        The solved contact.
    body : "A" or "B"
        The body concerned.
    laws : Laws, optional
        Criterion and bodies; by default those that the contact was solved with.

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
    >>> round(top.interior / scene.hertz.p0, 2), round(top.interior_at[2] / scene.hertz.a, 1)
    (0.67, 0.5)
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
    laws = laws or Laws.of_contact(contact, ("elasticity", "criterion"))
    load, criterion = LoadedBodies.of(contact, bodies, laws), laws.criterion
    if not load.tractions.any():
        nothing = Maximum(criterion, 0.0, _NOWHERE, np.nan, _NOWHERE, 0.0, _NOWHERE)
        return dict.fromkeys(load.names, nothing)
    levels = load.source.levels(criterion)
    surface = levels.surface(contact.sliding)
    interior = _interior(levels, [top[0] for top in surface])
    found = {}
    for name, above, below in zip(load.names, surface, interior, strict=True):
        larger = below if below[0] > above[0] else above
        found[name] = Maximum(criterion, *larger, *below, *above)
    return found


def _interior(levels: MultiLevel | StripLevels, surface: list[float]) -> list[tuple[float, Point]]:
    """The highest top of each body below its surface, on which the largest stress is given."""
    depths = _search_depths(levels)
    bound, floor = np.array(surface), float(depths[0])
    bodies, tops, values = _climbed(levels, *_starts(levels, depths), floor, bound)
    # A way that ends at the floor leads on to the surface, unless that is lower.
    below = (tops[:, 2] > floor) | (values > bound[bodies])
    found = [(np.nan, _NOWHERE)] * len(surface)
    for k in np.flatnonzero(below)[np.argsort(values[below])]:
        found[bodies[k]] = float(values[k]), tuple(tops[k].tolist())
    return found


def _search_depths(levels: MultiLevel | StripLevels) -> np.ndarray:
    """From below the elements on until no maximum is to be expected any more, mm."""
    first, deepest = SHALLOWEST * levels.side, DEEPEST * levels.half_width
    count = max(3, int(np.ceil(np.log(deepest / first) / np.log(levels.growth))) + 1)
    return first * levels.growth ** np.arange(count)


def _starts(levels: MultiLevel | StripLevels, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bodies (n,) and places (n, 3) of the largest local maxima of layers."""
    layers = [levels.layer(depth) for depth in depths]
    none = np.empty((len(layers[0].values), 0, 0))
    values = [none, *(layer.values for layer in layers), none]
    found = []
    for layer, above, here, below in zip(layers, values, values[1:], values[2:], strict=False):
        body, value, i, j, deeper = find_tops(here, above, below).T
        found.append((body.astype(int), value, layer.points(i, j, levels.growth**deeper)))
    bodies, value, at = (np.concatenate(each) for each in zip(*found, strict=True))
    order = np.argsort(-value)
    chosen = [order[bodies[order] == body][:CANDIDATES] for body in range(len(none))]
    return bodies[np.concatenate(chosen)], at[np.concatenate(chosen)]


def _climbed(
    levels: MultiLevel | StripLevels,
    bodies: np.ndarray,
    at: np.ndarray,
    floor: float,
    surface: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Go up from places to the tops, by Newton steps on differences.

    Ways that end where another one does, or lower, are given up, and those that the floor bars
    below a higher surface. Bodies, places and stress of what is found.
    """
    barred, best = np.zeros(len(bodies), dtype=bool), np.zeros(len(surface))
    least = CLOSE * surface[bodies]
    ended = []
    for step in range(STEPS):
        values = levels.around(bodies, stencil(at), at)
        if step == 0:
            highest = RISE * values[:, 0]
        fates = climb(at, barred, best, values, bodies, highest, least, floor, step == 0)
        last, on = fates == ENDED, fates == GOES_ON
        ended.append((bodies[last], at[last]))
        if not on.any():
            break
        bodies, at, barred, highest, least = (
            each[on] for each in (bodies, at, barred, highest, least)
        )
    bodies, at = (np.concatenate(each) for each in zip(*ended, strict=True))
    values = levels.around(bodies, stencil(at), at, closely=True)
    return bodies, at, last_steps(at, values, floor)
