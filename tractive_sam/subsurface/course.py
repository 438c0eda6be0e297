"""The stress that material lives through in a course of contacts that change.

Each point of the material keeps its place in its body. Where the bodies shift, that is a place in
the contact. Where they roll, the contact moves over the point: at the distance s it is at
x = X - s, if X was its place at the distance 0. Material that is below the contact at the end of
the course leaves it as if the contact rolled on with the tractions that it has then.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.mechanics import enclosing_radius, evaluate_cycles, residual_shear
from tractive_sam.operators import Lattice
from tractive_sam.results import BodyFatigue, State
from tractive_sam.subsurface.cycle import average_rows, layer_cycles
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.mirror import SIGNS
from tractive_sam.subsurface.surface import surface_points


@dataclass(frozen=True, eq=False)
class Course:
    """Contacts that follow each other, and how far the material has moved by each.

    Attributes
    ----------
    contacts : sequence of State
        Solved, on one mesh.
    places : ndarray, shape (k,)
        Distance rolled at each, mm; 0 where the bodies shift.
    laws : Laws
        Criterion and bodies.
    rolls : bool
        Whether the material was unloaded before it came to the contact.
    steady : bool
        Whether the bodies rolled steadily under the first contact before.
    paths : int
        Numbers of stress paths that are held at once.
    """

    contacts: Sequence[State]
    places: np.ndarray
    laws: Laws
    rolls: bool = True
    steady: bool = False
    paths: int = 2**22

    def steps(self, away: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return places (m,) and numbers (m,) of the contacts that the material meets.

        Where the bodies roll, the last contact rolls further with its tractions; so did the
        first one before, if it rolled steadily.

        Parameters
        ----------
        away : ndarray, shape (n,)
            Distances that it is rolled before or after, ascending, mm.
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
    """What a course of contacts does to the material of each body that [fatigue] names.

    The course counts as one cycle of every point. Of all points of a row and a depth the result has
    the largest utilisation and the largest ball.

    Parameters
    ----------
    course : Course
        Contacts of a scene with [fatigue].
    depths : ndarray, shape (n,)
        Ascending from 0, mm.

    Returns
    -------
    dict of str to (BodyFatigue, ndarray of shape (n_y, n))
        By body: what the material goes through, and the place x of the point with the largest
        utilisation, mm; where the bodies roll, its place in the contact at the distance 0.
    """
    first = course.contacts[0]
    asked, grid = first.scene.fatigue, first.grid
    shape = len(asked.bodies), grid.elements[1], depths.size
    used, place = np.full(shape, np.nan), np.full(shape, np.nan)
    left, radius = np.zeros(shape), np.zeros(shape)
    limit = 1.0 if asked.limit is None else asked.limit
    half_width = max(one.half_width_x for one in course.contacts)
    layers = (layer_cycles(one, depths, course.laws, half_width) for one in course.contacts)
    for k, at_depth in enumerate(zip(*layers, strict=True), 1):
        x, columns, _ = at_depth[0]
        for i in range(len(asked.bodies)):
            cycles = np.stack([one[i] for _, _, one in at_depth])
            left[i, :, k] = residual_shear(np.concatenate(cycles, axis=1))
            for rows, material, paths in _paths(course, x, columns, cycles, grid.dx):
                found = _worst(course.laws, paths, material)
                radius[i, rows, k], used[i, rows, k], place[i, rows, k] = found
    for i, body in enumerate(asked.bodies):
        known, *found = _surface(course, body)
        for values, own in zip(found, (left, radius, used, place), strict=True):
            own[i, :, 0] = average_rows(values, known, own[i, :, 1])
    k = asked.shear_yield_stress
    about = course.laws.fatigue, math.nan if k is None else k
    y = grid.shifted(0.0).y
    used = np.maximum(used, 0.0) / limit
    return {
        body: (BodyFatigue(body, y, depths, used[i], left[i], radius[i], *about), place[i])
        for i, body in enumerate(asked.bodies)
    }


def _worst(
    laws: Laws, path: np.ndarray, material: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the largest radius, the largest value of the criterion and its place in each row.

    Parameters
    ----------
    laws : Laws
        Criterion.
    path : ndarray, shape (6, m, rows, points)
        Stress of each point.
    material : ndarray, shape (points,)
        Places of the points.
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
    """Yield rows, places of material (points,), and its paths (6, m, rows, points) at a depth.

    Between places of known stress it is interpolated.

    Parameters
    ----------
    course : Course
        The contacts.
    x, columns : ndarray, shapes (n,) and (c,)
        Places in the contact: of a layer, ascending, and ahead of it and behind, mm.
    cycles : ndarray, shape (contacts, 6, n + c + 1, n_y)
        Stress there, and none.
    dx : float
        Distance of the points of the material, mm.
    """
    # Over the layer, and on to where the columns are: they become sparse as stress changes less.
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
        here = slice(first, first + rows)
        stress = cycles[..., here]
        paths = np.zeros((6, count, stress.shape[3], material.size))
        for k, (one, low, high, part) in enumerate(zip(contact, before, after, share, strict=True)):
            found = (
                stress[one][:, low] * (1.0 - part[:, None]) + stress[one][:, high] * part[:, None]
            )
            paths[:, k] = found.swapaxes(1, 2)
        yield here, material, paths


def _surface(
    course: Course, body: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return which rows between the elements are known, and four results of each, shape (m,).

    These are what residual stress leaves, the largest radius, the largest value of the criterion
    and its place. A stress at an edge is taken at the nearest corner of elements.
    """
    grid = course.contacts[0].grid
    lattice, sign = Lattice(grid.elements, grid.dx, grid.dy), SIGNS[body]
    found, rows_known = [], []
    for contact in course.contacts:
        load = LoadedBodies.from_contact(contact, (body,), course.laws)
        stress, *at, rows = surface_points(
            lattice, load.bodies[0], load.tractions, sign, contact.sliding
        )
        stress[4:] *= sign  # in the axes of the contact
        found.append((stress, *at))
        rows_known.append(rows)
    known = np.any(rows_known, axis=0)
    corner = grid.x[0] + 0.5 * grid.dx
    places, contact_of = course.steps(grid.dx * np.arange(1, grid.elements[0] + 1))
    moved = np.rint((places - course.places[0]) / grid.dx).astype(int)
    results = np.zeros((4, known.size))
    for j in range(known.size):
        stresses, at = [], []
        for shift, k in zip(moved, contact_of, strict=True):
            stress, column, row = found[k]
            here = row == j
            stresses.append(stress[:, here])
            at.append(column[here] + shift)
        every = np.concatenate(
            [found[k][0][:, found[k][2] == j] for k in range(len(found))], axis=1
        )
        if not every.shape[1]:
            continue
        paths, columns = _grouped(
            np.concatenate(stresses, axis=1), np.concatenate(at), course.rolls
        )
        material = course.places[0] + corner + grid.dx * columns
        worst = _worst(course.laws, paths[:, :, None], material)
        results[:, j] = residual_shear(every[..., None])[0], *(one[0] for one in worst)
    return known, *results


def _grouped(
    stress: np.ndarray, column: np.ndarray, unloaded: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return paths (6, m, columns) of stresses (6, n) by the column of each, and the columns.

    Shorter paths end with their last stress again; all begin unloaded, if they are to.
    """
    order = np.argsort(column, kind="stable")
    columns, begin, count = np.unique(column[order], return_index=True, return_counts=True)
    number = np.minimum(np.arange(count.max())[:, None], count - 1)
    paths = stress[:, order[begin + number]]
    if unloaded:
        paths = np.concatenate((np.zeros((6, 1, columns.size)), paths), axis=1)
    return paths, columns
