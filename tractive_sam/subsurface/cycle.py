"""The stress that material lives through as it rolls through the contact, and what it does.

In steady rolling the point (y, depth) meets sigma(x; y, depth), from the leading side to the
trailing one: what is along x on a mesh is its history.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.mechanics import enclosing_radius, residual_shear
from tractive_sam.operators import Lattice
from tractive_sam.results import BodyFatigue, State
from tractive_sam.scene import Fatigue
from tractive_sam.subsurface.depth import checked, semi_axes
from tractive_sam.subsurface.layers import stress_layers
from tractive_sam.subsurface.loaded import SIGNS, LoadedBodies
from tractive_sam.subsurface.surface import surface_cycles

GRADING = 1.5
"""Depths go with this power of their number: they are closer towards the surface."""


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
    side = _longer(contact)
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
        Criterion, and what the contact was solved with; by default those of its scene.

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
    laws = laws or Laws.of(contact.scene)
    depths = cycle_depths(contact) if depths is None else checked(depths)
    if not depths.size or depths[0] != 0.0 or (np.diff(depths) <= 0.0).any():
        raise ValueError("depths must ascend from 0, the surface")
    judges = {"residual_shear": residual_shear, "path_radius": enclosing_radius}
    if laws.fatigue is not None:
        judges["utilisation"] = _utilisation(laws, asked)
    shape = contact.grid.elements[1], depths.size
    fields = {
        body: {name: np.full(shape, np.nan) for name in ("utilisation", *judges)}
        for body in asked.bodies
    }
    for k, cycles in enumerate(_layers(contact, depths, laws)):
        for cycle, found in zip(cycles, fields.values(), strict=True):
            for name, judge in judges.items():
                found[name][:, k] = judge(cycle)
    for body, cycle, rows in _surfaces(contact, laws):
        for name, judge in judges.items():
            found = fields[body][name]
            found[:, 0] = _of_rows(judge(cycle), rows, found[:, 1])
    k = asked.shear_yield_stress
    return {
        body: BodyFatigue(
            body,
            contact.grid.y,
            depths,
            found["utilisation"],
            found["residual_shear"],
            found["path_radius"],
            laws.fatigue,
            math.nan if k is None else k,
        )
        for body, found in fields.items()
    }


def _utilisation(laws: Laws, asked: Fatigue) -> Callable[[np.ndarray], np.ndarray]:
    limit = 1.0 if asked.limit is None else asked.limit

    def judge(cycle: np.ndarray) -> np.ndarray:
        return np.maximum(laws.fatigue(cycle), 0.0) / limit

    return judge


def _longer(contact: State) -> float:
    grid = contact.grid
    return grid.dx if grid.line else max(grid.dx, grid.dy)


def _layers(contact: State, depths: np.ndarray, laws: Laws) -> Iterator[np.ndarray]:
    """Cycles (bodies, 6, n, n_y) at each depth but the surface, which stands in as no stress."""
    grid, bodies = contact.grid, contact.scene.fatigue.bodies
    cycles = np.zeros((len(bodies), 6, 1, grid.elements[1]))
    yield cycles
    # The shear stress is largest about as far ahead and behind the contact as the point is deep.
    wanted = contact.half_width_x + depths[-1] - grid.half_length[0]
    beyond = max(0, math.ceil(wanted / grid.dx))
    for _, stress in stress_layers(contact, depths[1:], bodies, beyond, laws=laws):
        yield np.concatenate((stress, cycles), axis=2)


def _surfaces(contact: State, laws: Laws) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Of each body the cycles (6, n, m) along rows between the elements, and which are known."""
    grid, bodies = contact.grid, contact.scene.fatigue.bodies
    load = LoadedBodies.of(contact, bodies, laws)
    lattice = Lattice(grid.elements, grid.dx, grid.dy)
    for name, body, tractions in zip(bodies, load.bodies, load.tractions, strict=True):
        cycle, known = surface_cycles(lattice, body, tractions, contact.sliding)
        unloaded = np.zeros((6, 1, cycle.shape[2]))
        cycle = np.concatenate((cycle, unloaded), axis=1)
        cycle[4:] *= SIGNS[name]  # in the axes of the contact
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
