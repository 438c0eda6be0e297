"""Fatigue of the material in a sequence of contacts that change.

Each point of the material has a fixed position in its body. If the bodies shift, this is a fixed
position in the contact. If they roll, the contact moves over the point: at the rolling distance s
the point is at x = X - s, with its position X at the distance 0. Material below the contact at the
end of the sequence leaves it as if the contact continued to roll with its last tractions.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import HalfSpaces, enclosing_radius, evaluate_cycles, residual_shear
from tractive_sam.operators import Lattice
from tractive_sam.results import BodyFatigue, State
from tractive_sam.subsurface.cycle import average_rows, fatigue_table, layer_cycles
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.mirror import SIGNS
from tractive_sam.subsurface.surface import surface_points


@dataclass(frozen=True, eq=False, repr=False)
class Course(ShortArrays):
    """Sequence of contacts that material passes, with the rolling distance at each of them.

    Attributes
    ----------
    contacts : sequence of State
        Solved contacts on one mesh.
    places : ndarray, shape (k,)
        Rolling distance at each contact, mm; 0 if the bodies shift.
    laws : Laws
        Criterion and bodies.
    rolls : bool
        Whether the material is unloaded before it enters the contact.
    steady : bool
        Whether steady rolling under the first contact precedes the sequence.
    paths : int
        Largest number of stress values in memory.

    Examples
    --------
    >>> course = Course([contact, contact], np.array([0.0, 0.1]), ts.Laws.of(contact.scene))
    >>> course.rolls, course.steady
    (True, False)
    """

    contacts: Sequence[State]
    places: np.ndarray
    laws: Laws
    rolls: bool = True
    steady: bool = False
    paths: int = 2**22

    def steps(self, away: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (rolling distances, contact indices) of the sequence, with `away` if it rolls.

        If the bodies roll, the last contact continues with its tractions, and with `steady` the
        first contact precedes with its tractions.

        Parameters
        ----------
        away : ndarray, shape (n,)
            Rolling distances before and after the sequence, ascending, mm.

        Returns
        -------
        positions : ndarray, shape (m,)
            Rolling distances, mm.
        numbers : ndarray of int, shape (m,)
            Contact at each of them.
        """
        number = np.arange(self.places.size)
        if not self.rolls:
            return self.places, number
        none = np.zeros(away.size, int)
        places, numbers = [self.places, self.places[-1] + away], [number, none + number[-1]]
        if self.steady:
            places, numbers = [self.places[0] - away[::-1], *places], [none, *numbers]
        return np.concatenate(places), np.concatenate(numbers)


def course_fatigue(course: Course, depths: np.ndarray) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    """Return by body (fatigue in a sequence of contacts, x of the worst point by row and depth).

    The sequence is one cycle of every point. The results are the largest utilisation and the
    largest ball of all points of a row and a depth.

    Parameters
    ----------
    course : Course
        Contacts of a scene with [fatigue].
    depths : ndarray, shape (n,)
        Ascending from 0, mm.

    Returns
    -------
    dict of str to (BodyFatigue, ndarray of shape (n_y, n))
        By body: the fatigue, and the position x of the point with the largest utilisation, mm; if
        the bodies roll, its position in the contact at the distance 0.

    Examples
    --------
    >>> tired = ts.solve(scene.replace(fatigue={"shear_yield": 300.0, "bodies": ["A"]}))
    >>> course = Course([tired, tired], np.array([0.0, 0.1]), ts.Laws.of(tired.scene))
    >>> depths = cycle_depths(tired)[::20]
    >>> worst, place = course_fatigue(course, depths)["A"]
    >>> worst.residual_shear.shape == place.shape == (tired.grid.elements[1], depths.size)
    True
    """
    first = course.contacts[0]
    table, grid = fatigue_table(first), first.grid
    shape = len(table.bodies), grid.elements[1], depths.size
    used, place = np.full(shape, np.nan), np.full(shape, np.nan)
    residual, radius = np.zeros(shape), np.zeros(shape)
    limit = 1.0 if table.limit is None else table.limit
    half_width = max(contact.half_width_x for contact in course.contacts)
    layers = (layer_cycles(contact, depths, course.laws, half_width) for contact in course.contacts)
    for k, at_depth in enumerate(zip(*layers, strict=True), 1):
        x, columns, _ = at_depth[0]
        for i in range(len(table.bodies)):
            cycles = np.stack([layer[i] for _, _, layer in at_depth])
            residual[i, :, k] = residual_shear(np.concatenate(cycles, axis=1))
            for rows, material, paths in _paths(course, x, columns, cycles, grid.dx):
                largest = _worst(course.laws, paths, material)
                radius[i, rows, k], used[i, rows, k], place[i, rows, k] = largest
    for i, body in enumerate(table.bodies):
        is_valid, *at_surface = _surface(course, body)
        for values, field in zip(at_surface, (residual, radius, used, place), strict=True):
            field[i, :, 0] = average_rows(values, is_valid, field[i, :, 1])
    shear_yield = table.shear_yield_stress
    about = course.laws.fatigue, math.nan if shear_yield is None else shear_yield
    y = grid.shifted(0.0).y
    used = np.maximum(used, 0.0) / limit
    return {
        body: (BodyFatigue(body, y, depths, used[i], residual[i], radius[i], *about), place[i])
        for i, body in enumerate(table.bodies)
    }


def _worst(
    laws: Laws, path: np.ndarray, material: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (largest radius, largest criterion, its position) by row; nan without a criterion.

    Parameters
    ----------
    laws : Laws
        Criterion.
    path : ndarray, shape (6, m, rows, points)
        Stress of each point.
    material : ndarray, shape (points,)
        Positions of the points, mm.
    """
    if laws.fatigue is None:
        radius, none = enclosing_radius(path), np.full(path.shape[2], np.nan)
        return radius.max(axis=1), none, none
    value, radius = evaluate_cycles(laws.fatigue, path)
    worst = value.argmax(axis=1)
    return radius.max(axis=1), value.max(axis=1), material[worst]


def _paths(
    course: Course, x: np.ndarray, columns: np.ndarray, cycles: np.ndarray, dx: float
) -> Iterator[tuple[slice, np.ndarray, np.ndarray]]:
    """Yield (rows, positions, stress paths) of material points at one depth, in chunks of rows.

    The stress is interpolated between the positions at which it is computed.

    Parameters
    ----------
    course : Course
        The contacts.
    x, columns : ndarray, shapes (n,) and (c,)
        Positions in the contact: of a layer, ascending, and ahead of it and behind it, mm.
    cycles : ndarray, shape (contacts, 6, n + c + 1, n_y)
        Stress at these positions, and then none.
    dx : float
        Spacing of the points of the material, mm.
    """
    # Over the layer and the columns, which become sparse as the stress changes less.
    far = columns[columns > x[-1]] - x[-1]
    passing = dx * np.arange(1, x.size + 1)
    places, contact = course.steps(np.concatenate((passing, passing[-1] + far)))
    rolled = course.places[-1] - course.places[0]
    material = course.places[0] + x[0] + dx * np.arange(x.size + round(rolled / dx))
    x = np.concatenate((x, columns))
    order = np.argsort(x)
    x = x[order]
    at = np.clip(material - places[:, None], x[0], x[-1])
    after = np.clip(np.searchsorted(x, at), 1, x.size - 1)
    share = (at - x[after - 1]) / (x[after] - x[after - 1])
    before, after = order[after - 1], order[after]
    count = places.size + course.rolls
    rows = max(1, course.paths // (6 * count * material.size))
    for first in range(0, cycles.shape[3], rows):
        part = slice(first, first + rows)
        stress = cycles[..., part]
        paths = np.zeros((6, count, stress.shape[3], material.size))
        for k, (number, low, high) in enumerate(zip(contact, before, after, strict=True)):
            weight, field = share[k][:, None], stress[number]
            values = field[:, low] * (1.0 - weight) + field[:, high] * weight
            paths[:, k] = values.swapaxes(1, 2)
        yield part, material, paths


def _surface(
    course: Course, body: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (valid rows, residual shear, radius, criterion, its position) at the surface.

    A stress at an edge is assigned to the nearest corner of elements.

    Returns
    -------
    is_valid : ndarray of bool
        Rows with a valid path.
    residual, radius, value, position : ndarray
        Residual shear, largest radius, largest value of the criterion, and its position.
    """
    grid = course.contacts[0].grid
    lattice, sign = Lattice(grid.elements, grid.dx, grid.dy), SIGNS[body]
    surfaces, rows_in_contact = [], []
    for contact in course.contacts:
        load = LoadedBodies.from_contact(contact, (body,), course.laws)
        stress, *at, rows = surface_points(
            lattice, cast(HalfSpaces, load.bodies[0]), load.tractions, sign, contact.sliding
        )
        stress[4:] *= sign  # in the axes of the contact
        surfaces.append((stress, *at))
        rows_in_contact.append(rows)
    in_contact = np.any(rows_in_contact, axis=0)
    corner = grid.x[0] + 0.5 * grid.dx
    places, contact_of = course.steps(grid.dx * np.arange(1, grid.elements[0] + 1))
    moved = np.rint((places - course.places[0]) / grid.dx).astype(int)
    results = np.zeros((4, in_contact.size))
    for j in range(in_contact.size):
        stresses, at = [], []
        for shift, k in zip(moved, contact_of, strict=True):
            stress, column, row = surfaces[k]
            here = row == j
            stresses.append(stress[:, here])
            at.append(column[here] + shift)
        every = np.concatenate(
            [surfaces[k][0][:, surfaces[k][2] == j] for k in range(len(surfaces))], axis=1
        )
        if not every.shape[1]:
            continue
        paths, columns = _grouped(
            np.concatenate(stresses, axis=1), np.concatenate(at), course.rolls
        )
        material = course.places[0] + corner + grid.dx * columns
        worst = _worst(course.laws, paths[:, :, None], material)
        results[:, j] = residual_shear(every[..., None])[0], *(value[0] for value in worst)
    return in_contact, *results


def _grouped(
    stress: np.ndarray, column: np.ndarray, unloaded: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Group stresses by column: (paths (6, m, columns) padded with their last stress, columns).

    Shorter paths end with their last stress again; all begin unloaded, if they are to.
    """
    order = np.argsort(column, kind="stable")
    columns, begin, count = np.unique(column[order], return_index=True, return_counts=True)
    number = np.minimum(np.arange(count.max())[:, None], count - 1)
    paths = stress[:, order[begin + number]]
    if unloaded:
        paths = np.concatenate((np.zeros((6, 1, columns.size)), paths), axis=1)
    return paths, columns
