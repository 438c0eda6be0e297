"""Fatigue of the material from its stress path through the contact.

In steady rolling the stress path of a point (y, depth) is sigma(x; y, depth), from the leading side
to the trailing side: the stress along x on a mesh.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import cast

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.mechanics import HalfSpaces, enclosing_radius, evaluate_cycles, residual_shear
from tractive_sam.operators import Lattice
from tractive_sam.results import BodyFatigue, Grid, State
from tractive_sam.scene import Fatigue
from tractive_sam.subsurface.depth import check_depths, semi_axes
from tractive_sam.subsurface.layers import stress_layers
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.mirror import SIGNS
from tractive_sam.subsurface.surface import surface_cycles


def cycle_depths(contact: State, grading: float = 1.5) -> np.ndarray:
    """Return the depths at which [fatigue] is computed, shape (elements,), mm.

    They are the surface, one element below it (the longer side), and further depths down to the
    depth in the scene, or at least three elements.

    Parameters
    ----------
    contact : State
        The solved contact of a scene with [fatigue].
    grading : float
        Exponent of the distribution: above 1 depths are denser towards the surface.

    Examples
    --------
    >>> tired = scene.replace(fatigue={"shear_yield": 300.0, "elements": 8})
    >>> cycle_depths(ts.solve(tired)).size
    8
    """
    table = fatigue_table(contact)
    side = max(contact.grid.sides)
    deepest = max(table.depth * semi_axes(contact)[0], 3.0 * side)
    share = np.linspace(0.0, 1.0, table.elements - 1) ** grading
    return np.concatenate(([0.0], side + (deepest - side) * share))


def fatigue(
    contact: State, *, depths: np.ndarray | None = None, laws: Laws | None = None
) -> dict[str, BodyFatigue]:
    """Return the fatigue of each body's material in one pass of a contact, by body.

    The stress is computed layer by layer, and not stored.

    Parameters
    ----------
    contact : State
        The solved contact of a scene with [fatigue].
    depths : array_like, shape (n,), optional
        Depths, ascending from 0, mm; by default from [fatigue].
    laws : Laws, optional
        Criterion and bodies; by default the laws of the solution.

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
    >>> table = {"criterion": "orthogonal-shear", "limit": 250.0, "bodies": ["A"]}
    >>> top = ts.fatigue(ts.solve(scene.replace(fatigue=table)))["A"].largest()
    >>> round(top.interior * 250.0 / scene.hertz.p0, 1), round(top.interior_at[2], 1)
    (0.2, 1.5)
    """
    fatigue_table(contact)
    depths = cycle_depths(contact) if depths is None else check_depths(depths)
    if not depths.size or depths[0] != 0.0 or (np.diff(depths) <= 0.0).any():
        raise ValueError("depths must ascend from 0, the surface")
    needed = "elasticity", "fatigue", "life"
    by_body = cycle_fatigue([contact], depths, [laws or Laws.of_contact(contact, needed)])
    return {body: worst for body, (worst, _) in by_body.items()}


def cycle_fatigue(
    contacts: Sequence[State], depths: np.ndarray, laws: Sequence[Laws]
) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    """Return by body (fatigue in the passes of contacts, utilisation in each contact).

    The criterion applies to each pass separately. Residual stress is constant over all passes:
    shakedown refers to the path through all contacts.

    Parameters
    ----------
    contacts : sequence of State
        Solved contacts on one mesh: of the blocks of a load spectrum, or a single one.
    depths : ndarray, shape (n,)
        Ascending from 0, mm.
    laws : sequence of Laws
        Laws of each contact.

    Returns
    -------
    dict of str to (BodyFatigue, ndarray of shape (contacts, n_y, n))
        By body: the largest utilisation, and the utilisation of each contact.

    Examples
    --------
    >>> contact = ts.solve(scene.replace(fatigue={"shear_yield": 300.0, "bodies": ["A"]}))
    >>> depths = cycle_depths(contact)
    >>> worst, each = cycle_fatigue([contact], depths, [ts.Laws.of(contact.scene)])["A"]
    >>> each.shape == (1, *worst.path_radius.shape)
    True
    """
    table, grid = fatigue_table(contacts[0]), contacts[0].grid
    shape = grid.elements[1], depths.size
    used = {body: np.full((len(contacts), *shape), np.nan) for body in table.bodies}
    residual, radius = ({body: np.zeros(shape) for body in table.bodies} for _ in range(2))
    limit = 1.0 if table.limit is None else table.limit
    layers = (
        layer_cycles(contact, depths, law) for contact, law in zip(contacts, laws, strict=True)
    )
    for k, at_depth in enumerate(zip(*layers, strict=True), 1):
        for i, body in enumerate(table.bodies):
            cycles = [layer[i] for _, _, layer in at_depth]
            radius[body][:, k], residual[body][:, k], values = _evaluate(laws, cycles, limit)
            for utilisation, value in zip(used[body], values, strict=False):
                utilisation[:, k] = value
    surfaces = (_surface_cycles(contact, law) for contact, law in zip(contacts, laws, strict=True))
    for passes in zip(*surfaces, strict=True):
        body, cycles = passes[0][0], [cycle for _, cycle, _ in passes]
        is_valid = np.any([rows for _, _, rows in passes], axis=0)
        path, shear, values = _evaluate(laws, cycles, limit)
        radius[body][:, 0] = average_rows(path, is_valid, radius[body][:, 1])
        residual[body][:, 0] = average_rows(shear, is_valid, residual[body][:, 1])
        for utilisation, value, (_, _, rows) in zip(used[body], values, passes, strict=False):
            utilisation[:, 0] = average_rows(value, rows, utilisation[:, 1])
    shear_yield = table.shear_yield_stress
    about = laws[0].fatigue, math.nan if shear_yield is None else shear_yield
    y = grid.shifted(0.0).y
    results: dict[str, tuple[BodyFatigue, np.ndarray]] = {}
    for body in table.bodies:
        fields = used[body].max(axis=0), residual[body], radius[body]
        results[body] = BodyFatigue(body, y, depths, *fields, *about), used[body]
    return results


def fatigue_table(contact: State) -> Fatigue:
    """Return the [fatigue] table of the scene; raise a ValueError if there is none."""
    table = contact.scene.fatigue
    if table is None:
        raise ValueError("the scene has no [fatigue] table; add one with a criterion and a limit")
    return table


def _evaluate(
    laws: Sequence[Laws], cycles: Sequence[np.ndarray], limit: float
) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Return (path radius, residual shear, list of each pass's utilisation) of stress cycles.

    Returns
    -------
    radius, residual : ndarray
        `enclosing_radius` and `residual_shear` of the path through all cycles.
    utilisations : list of ndarray
        Utilisation in each pass; empty without a criterion.
    """
    path, utilisations = _join_cycles(cycles), []
    radius = None
    for law, cycle in zip(laws, cycles, strict=True):
        if law.fatigue is not None:
            value, radius = evaluate_cycles(law.fatigue, cycle)
            utilisations.append(np.maximum(value, 0.0) / limit)
    if radius is None or len(cycles) > 1:
        radius = enclosing_radius(path)
    return radius, residual_shear(path), utilisations


def _join_cycles(cycles: Sequence[np.ndarray]) -> np.ndarray:
    """Concatenate stress cycles of passes to one path (6, n, n_y)."""
    return cycles[0] if len(cycles) == 1 else np.concatenate(cycles, axis=1)


def layer_cycles(
    contact: State,
    depths: np.ndarray,
    laws: Laws,
    half_width: float | None = None,
    spaces: int = 12,
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield (x of the layer, x outside it, stress paths) for each depth below the surface.

    Parameters
    ----------
    contact : State
        The solved contact.
    depths : ndarray, shape (k,)
        Ascending from 0, mm.
    laws : Laws
        Laws of the bodies.
    half_width : float, optional
        Half width of the contact in x that determines the length of layers, mm; by default of this
        contact.
    spaces : int
        See `_columns`: with 12 the error of a criterion from maxima outside the layers is 1e-3,
        with 8 it is 3e-3.

    Yields
    ------
    x, columns : ndarray, shapes (n,) and (2 spaces - 2,)
        Positions on the layer, ascending, and ahead of it and behind it, mm.
    cycles : ndarray, shape (bodies, 6, n + 2 spaces - 1, n_y)
        Stress at these positions, and then none, MPa.
    """
    # Few lengths of layers: transforms are cached for each, also while wear changes the contact.
    lengths, multiple = 3, 4
    grid, bodies = contact.grid, fatigue_table(contact).bodies
    # The shear stress is largest ahead and behind the contact at a distance of about the depth.
    part = np.ceil(depths[1:] / depths[-1] * lengths) / lengths
    # At this distance the first columns are an element apart.
    distance = np.maximum(part * depths[-1], 0.5 * spaces * grid.dx)
    half_width = contact.half_width_x if half_width is None else half_width
    needed = half_width + distance - grid.half_length[0]
    beyond = np.maximum(0, multiple * np.ceil(needed / grid.dx / multiple)).astype(int)
    load = LoadedBodies.from_contact(contact, bodies, laws)
    for more, together in groupby(zip(beyond, depths[1:], strict=True), lambda pair: pair[0]):
        group = np.array([depth for _, depth in together])
        x = _columns(grid, half_width, int(more), group[0], spaces)
        outside = load.in_contact_axes(load.source.at_columns(x, group))
        layer_x = grid.lengthened(int(more)).x
        elements = grid.elements[0] + 2 * int(more)
        layers = stress_layers(contact, group, bodies, int(more), laws=laws)
        for k, (_, stress) in enumerate(layers):
            # In memory path by path, as the kernels need them.
            paths = np.zeros((len(bodies), stress.shape[3], 6, elements + x.size + 1))
            paths[..., :elements] = stress.transpose(0, 3, 1, 2)
            paths[..., elements:-1] = outside[..., k].transpose(0, 3, 1, 2)
            yield layer_x, x, paths.transpose(0, 2, 3, 1)


def _columns(grid: Grid, half_width: float, more: int, depth: float, spaces: int) -> np.ndarray:
    """Return x of the sparse points ahead of and behind a layer of stress paths, mm.

    Friction causes tension behind the contact, and the hydrostatic tension of a deep point has its
    maximum at a distance of some depths over the friction coefficient. At the distance s from a
    line contact the stress is proportional to 1/s. The error of a maximum is proportional to the
    square of the spacing over s³: with columns equally spaced in 1/sqrt(s) it does not depend on s,
    and a few columns cover the stress. Outside an ellipse the stress is proportional to 1/s², and
    the error to 1/s.

    Parameters
    ----------
    grid : Grid
        The mesh.
    half_width : float
        Half width of the contact in x, mm.
    more : int
        Elements by which the layer extends beyond the mesh.
    depth : float
        Smallest depth of the columns, mm.
    spaces : int
        Number of spaces between the end of the layer and infinity.
    """
    end = grid.half_length[0] + (more - 0.5) * grid.dx
    nearest = end - half_width + depth
    x = end + nearest * ((spaces / np.arange(spaces - 1, 0, -1)) ** 2 - 1.0)
    return grid.centre[0] + np.concatenate((x, -x))


def _surface_cycles(contact: State, laws: Laws) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Yield (body, stress cycles at its surface, mask of valid rows) for each body.

    A point of the surface passes the contact along a row of element corners: the cycles have the
    shape (6, n, m), with stress components, n positions in x, the last one unloaded, and m rows. A
    row that only touches the edge of the contact is not valid.
    """
    grid, bodies = contact.grid, fatigue_table(contact).bodies
    load = LoadedBodies.from_contact(contact, bodies, laws)
    lattice = Lattice(grid.elements, grid.dx, grid.dy)
    for name, body in zip(bodies, load.bodies, strict=True):
        sign = SIGNS[name]
        cycle, is_valid = surface_cycles(
            lattice, cast(HalfSpaces, body), load.tractions, sign, contact.sliding
        )
        unloaded = np.zeros((6, 1, cycle.shape[2]))
        cycle = np.concatenate((cycle, unloaded), axis=1)
        cycle[4:] *= sign  # in the axes of the contact
        yield name, cycle, is_valid


def average_rows(values: np.ndarray, is_valid: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Return the mean of the valid corner rows beside each row; `below` where neither is valid."""
    if values.size == below.size:  # a line
        return np.where(is_valid, values, below)
    count = np.zeros(below.size)
    total = np.zeros(below.size)
    for rows in (slice(None, -1), slice(1, None)):
        count[rows] += is_valid
        total[rows] += np.where(is_valid, values, 0.0)
    return np.divide(total, count, out=below.copy(), where=count > 0.0)
