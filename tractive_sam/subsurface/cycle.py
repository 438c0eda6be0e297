"""The stress that material lives through as it rolls through the contact, and what it does.

In steady rolling the point (y, depth) meets sigma(x; y, depth), from the leading side to the
trailing one: what is along x on a mesh is its history.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.mechanics import enclosing_radius, evaluate_cycles, residual_shear
from tractive_sam.operators import Lattice
from tractive_sam.results import BodyFatigue, State
from tractive_sam.subsurface.depth import checked, semi_axes
from tractive_sam.subsurface.layers import stress_layers
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.mirror import SIGNS
from tractive_sam.subsurface.surface import surface_cycles

GRADING = 1.5
"""Depths go with this power of their number: they are closer towards the surface."""

LENGTHS, ROUND = 3, 4
"""Different lengths of layers, and what elements beyond the mesh are multiples of: transforms are
kept for each length, also while wear changes that of the contact."""


def cycle_depths(contact: State) -> np.ndarray:
    """Depths at which a scene with [fatigue] follows the material, shape (elements,), mm.

    The surface, one element below it (the longer side), and on, closer above, to the depth that the
    scene asks for; at least three elements deep.

    Examples
    --------
    >>> tired = scene.replace(fatigue={"shear_yield": 300.0, "elements": 8})
    >>> cycle_depths(ts.solve(tired)).size
    8
    """
    asked = contact.scene.fatigue
    side = max(contact.grid.sides)
    deepest = max(asked.depth * semi_axes(contact)[0], 3.0 * side)
    share = np.linspace(0.0, 1.0, asked.elements - 1) ** GRADING
    return np.concatenate(([0.0], side + (deepest - side) * share))


def fatigue(
    contact: State, *, depths: np.ndarray | None = None, laws: Laws | None = None
) -> dict[str, BodyFatigue]:
    """What a pass of the contact does to the material of each body that [fatigue] names.

    Layer by layer: nothing is kept of the stress.

    Parameters
    ----------
    contact : State
        The solved contact of a scene with [fatigue].
    depths : array_like, shape (n,), optional
        Depths, ascending from 0, mm; by default those that the scene asks for.
    laws : Laws, optional
        Criterion and bodies; by default those that the contact was solved with.

    Returns
    -------
    dict of str to BodyFatigue
        By body.

    Raises
    ------
    ValueError
        If the scene has no [fatigue], or the depths do not begin with the surface.

    Examples
    --------
    >>> asked = {"criterion": "orthogonal-shear", "limit": 250.0, "bodies": ["A"]}
    >>> top = ts.fatigue(ts.solve(scene.replace(fatigue=asked)))["A"].largest()
    >>> round(top.interior * 250.0 / scene.hertz.p0, 1), round(top.interior_at[2], 1)
    (0.2, 1.5)
    """
    asked = contact.scene.fatigue
    if asked is None:
        raise ValueError(
            "a scene with a [fatigue] table is needed: it says what the material endures"
        )
    depths = cycle_depths(contact) if depths is None else checked(depths)
    if not depths.size or depths[0] != 0.0 or (np.diff(depths) <= 0.0).any():
        raise ValueError("depths must ascend from 0, the surface")
    needed = "elasticity", "fatigue", "life"
    found = cycle_fatigue([contact], depths, [laws or Laws.of_contact(contact, needed)])
    return {body: worst for body, (worst, _) in found.items()}


def cycle_fatigue(
    contacts: Sequence[State], depths: np.ndarray, laws: Sequence[Laws]
) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    """What the passes of several contacts do that the material goes through in turn.

    Each pass is judged by itself; no residual stress but one goes with all of them, so shakedown is
    that of the path through them all.

    Parameters
    ----------
    contacts : sequence of State
        Solved, on one mesh; of the blocks of a duty cycle, or one.
    depths : ndarray, shape (n,)
        Ascending from 0, mm.
    laws : sequence of Laws
        Of each.

    Returns
    -------
    dict of str to (BodyFatigue, ndarray of shape (contacts, n_y, n))
        By body: the largest utilisation, and that of each contact.

    Examples
    --------
    >>> contact = ts.solve(scene.replace(fatigue={"shear_yield": 300.0, "bodies": ["A"]}))
    >>> depths = cycle_depths(contact)
    >>> worst, each = cycle_fatigue([contact], depths, [ts.Laws.of(contact.scene)])["A"]
    >>> each.shape == (1, *worst.path_radius.shape)
    True
    """
    asked, grid = contacts[0].scene.fatigue, contacts[0].grid
    shape = grid.elements[1], depths.size
    used = {body: np.full((len(contacts), *shape), np.nan) for body in asked.bodies}
    left, radius = ({body: np.zeros(shape) for body in asked.bodies} for _ in range(2))
    limit = 1.0 if asked.limit is None else asked.limit

    def judge(body: str, cycles: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
        criterion = laws[0].fatigue
        if criterion is None or len(cycles) > 1:
            yield enclosing_radius(_through(cycles))
        for one, cycle in zip(laws, cycles, strict=True):
            if one.fatigue is not None:
                value, path = evaluate_cycles(one.fatigue, cycle)
                if len(cycles) == 1:
                    yield path
                yield np.maximum(value, 0.0) / limit

    layers = (_layers(one, depths, law) for one, law in zip(contacts, laws, strict=True))
    for k, at_depth in enumerate(zip(*layers, strict=True), 1):
        for i, body in enumerate(asked.bodies):
            cycles = [layer[i] for layer in at_depth]
            radius[body][:, k], *values = judge(body, cycles)
            left[body][:, k] = residual_shear(_through(cycles))
            for own, value in zip(used[body], values, strict=False):
                own[:, k] = value
    surfaces = (_surfaces(one, law) for one, law in zip(contacts, laws, strict=True))
    for same in zip(*surfaces, strict=True):
        body, cycles = same[0][0], [cycle for _, cycle, _ in same]
        known = np.any([rows for _, _, rows in same], axis=0)
        values = judge(body, cycles)
        radius[body][:, 0] = _of_rows(next(values), known, radius[body][:, 1])
        whole = residual_shear(_through(cycles))
        left[body][:, 0] = _of_rows(whole, known, left[body][:, 1])
        for own, value, (_, _, rows) in zip(used[body], values, same, strict=False):
            own[:, 0] = _of_rows(value, rows, own[:, 1])
    k = asked.shear_yield_stress
    about = laws[0].fatigue, math.nan if k is None else k
    return {
        body: (
            BodyFatigue(
                body,
                grid.shifted(0.0).y,
                depths,
                used[body].max(axis=0),
                left[body],
                radius[body],
                *about,
            ),
            used[body],
        )
        for body in asked.bodies
    }


def _through(cycles: Sequence[np.ndarray]) -> np.ndarray:
    """The path through all cycles (6, n, n_y)."""
    return cycles[0] if len(cycles) == 1 else np.concatenate(cycles, axis=1)


def _layers(
    contact: State, depths: np.ndarray, laws: Laws, spaces: int = 12
) -> Iterator[np.ndarray]:
    """Yield cycles (bodies, 6, n, n_y) at each depth below the surface; the last stress is none.

    See `_columns` for `spaces`: with 12 the maxima outside the layers are found to 1e-3 of a
    criterion, with 8 to 3e-3.
    """
    grid, bodies = contact.grid, contact.scene.fatigue.bodies
    # The shear stress is largest about as far ahead and behind the contact as the point is deep.
    part = np.ceil(depths[1:] / depths[-1] * LENGTHS) / LENGTHS
    # At this distance the first columns are an element apart.
    least = np.maximum(part * depths[-1], 0.5 * spaces * grid.dx)
    wanted = contact.half_width_x + least - grid.half_length[0]
    beyond = np.maximum(0, ROUND * np.ceil(wanted / grid.dx / ROUND)).astype(int)
    load = LoadedBodies.of(contact, bodies, laws)
    for more, together in groupby(zip(beyond, depths[1:], strict=True), lambda one: one[0]):
        at = np.array([depth for _, depth in together])
        x = _columns(contact, int(more), at[0], spaces)
        outside = load.in_contact_axes(load.source.at_columns(x, at))
        elements = grid.elements[0] + 2 * int(more)
        layers = stress_layers(contact, at, bodies, int(more), laws=laws)
        for k, (_, stress) in enumerate(layers):
            # In memory path by path, as the kernels take them: laid out once for all.
            paths = np.zeros((len(bodies), stress.shape[3], 6, elements + x.size + 1))
            paths[..., :elements] = stress.transpose(0, 3, 1, 2)
            paths[..., elements:-1] = outside[..., k].transpose(0, 3, 1, 2)
            yield paths.transpose(0, 2, 3, 1)


def _columns(contact: State, more: int, depth: float, spaces: int) -> np.ndarray:
    """Return x of the stress path ahead of a layer and behind it, shape (2 spaces - 2,), mm.

    Friction draws the material behind the contact, and the hydrostatic tension of a deep point has
    its maximum some depths over the friction coefficient away. At the distance s from a line
    contact stress falls with 1/s. The error of a maximum goes with the square of the spacing over
    s: with columns equally spaced in 1/sqrt(s) it is the same at every s, and a few columns reach
    as far as there is stress. Outside an ellipse stress falls with 1/s², and the error with 1/s.

    Parameters
    ----------
    contact : State
        The solved contact.
    more : int
        Elements by which the layer goes beyond the mesh.
    depth : float
        The smallest depth for which the columns are, mm.
    spaces : int
        Number of spaces between the end of the layer and infinity.
    """
    grid = contact.grid
    end = grid.half_length[0] + (more - 0.5) * grid.dx
    nearest = end - contact.half_width_x + depth
    x = end + nearest * ((spaces / np.arange(spaces - 1, 0, -1)) ** 2 - 1.0)
    return np.concatenate((x, -x))


def _surfaces(contact: State, laws: Laws) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Of each body the cycles (6, n, m) along rows between the elements, and which are known."""
    grid, bodies = contact.grid, contact.scene.fatigue.bodies
    load = LoadedBodies.of(contact, bodies, laws)
    lattice = Lattice(grid.elements, grid.dx, grid.dy)
    for name, body in zip(bodies, load.bodies, strict=True):
        sign = SIGNS[name]
        cycle, known = surface_cycles(lattice, body, load.tractions, sign, contact.sliding)
        unloaded = np.zeros((6, 1, cycle.shape[2]))
        cycle = np.concatenate((cycle, unloaded), axis=1)
        cycle[4:] *= sign  # in the axes of the contact
        yield name, cycle, known


def _of_rows(values: np.ndarray, known: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Means of what is known on either side of every row of elements; else what is below."""
    if values.size == below.size:  # a line
        return np.where(known, values, below)
    count = np.zeros(below.size)
    total = np.zeros(below.size)
    for rows in (slice(None, -1), slice(1, None)):
        count[rows] += known
        total[rows] += np.where(known, values, 0.0)
    return np.divide(total, count, out=below.copy(), where=count > 0.0)
