"""Stress on several levels of resolution, and its largest value at the surface of a body.

At the surface, stress is sought between elements, at the contact edge and at the stick boundary. At
the edge and the boundary, traction and pressure depend on the root of the distance, which no mesh
resolves; but each stress has the root on one side only, and is smooth on the other side
(`kernels.surface_edges`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import stress_sum
from tractive_sam.kernels.surface_edges import (
    BOTH,
    UNLOADED,
    kinds_of_corners,
    stresses_at_edges,
    stresses_at_loaded_corners,
)
from tractive_sam.mechanics import HalfSpaces, StressCriterion
from tractive_sam.operators import Lattice, StressLayers, extent, surface_stress
from tractive_sam.results import Grid, Point


def largest_at_surface(
    lattice: Lattice,
    bodies: Sequence[HalfSpaces],
    signs: Sequence[float],
    tractions: np.ndarray,
    sliding: np.ndarray,
    criterion: StressCriterion,
) -> list[tuple[float, float, float]]:
    """Return (value, i, j), in elements, of the largest surface stress of each body.

    Positions are the corners of four loaded elements, the edge of the contact, and the border
    between stick and slip.

    Parameters
    ----------
    lattice : Lattice
        Elements, or strips; lengths in mm.
    bodies : sequence of HalfSpaces
        The half-spaces, see `HalfSpaces.single_body`.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.
    criterion : StressCriterion
        Criterion of the stress.

    Returns
    -------
    list of (float, float, float)
        The stress, MPa, and its position (i, j) from the centre of the first element, in elements.
    """
    stress, pressure = _between_elements(lattice, bodies, signs, tractions), tractions[2]
    kinds = kinds_of_corners(pressure, sliding)
    if not kinds.any():  # nowhere wider than an element
        kinds[:] = BOTH
    poisson = tuple(body.A.poisson for body in bodies)
    candidates = (
        stresses_at_loaded_corners(stress, kinds),
        stresses_at_edges(stress, pressure, kinds, poisson, lattice.dx, lattice.dy),
    )
    each, places = (np.concatenate(parts, axis=-1) for parts in zip(*candidates, strict=True))
    values = criterion(each)
    at = values.argmax(axis=1)
    i, j = places[:, at] + np.array(((0.5,), (0.5 if pressure.shape[1] > 1 else 0.0,)))
    return list(zip(values[range(len(at)), at].tolist(), i.tolist(), j.tolist(), strict=True))


def _between_elements(
    lattice: Lattice, bodies: Sequence[HalfSpaces], signs: Sequence[float], tractions: np.ndarray
) -> np.ndarray:
    """Return the surface stress (bodies, 6, ...) between elements; equal bodies share work."""
    if all(body == bodies[0] for body in bodies):
        return surface_stress(lattice, bodies[0], tractions, signs)
    each = zip(bodies, signs, strict=True)
    return np.concatenate([surface_stress(lattice, body, tractions, (s,)) for body, s in each])


def surface_cycles(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sign: float, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return (surface stress paths (6, n, rows) along corner rows, mask of valid rows).

    It contains the positions of `largest_at_surface` in the row, and corners without load;
    elsewhere the material counts as unloaded.

    Parameters
    ----------
    lattice : Lattice
        Elements, or strips; lengths in mm.
    body : HalfSpaces
        The half-space, see `HalfSpaces.single_body`.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    sign : float
        Sign of the body, see `SIGNS`.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.

    Returns
    -------
    cycles : ndarray, shape (6, n, n_y - 1), for strips (6, n, 1)
        Stresses, in no order along the row, MPa.
    is_valid : ndarray of bool, shape (n_y - 1,), for strips (1,)
        Rows with a valid path: not those that only touch the edge of the contact.
    """
    stress, even, is_valid, rough, (_, row) = _surface_stresses(
        lattice, body, tractions, sign, sliding
    )
    order = np.argsort(row, kind="stable")
    rough, row = rough[:, order], row[order]
    count = np.bincount(row, minlength=stress.shape[2])
    among = np.arange(row.size) - (np.cumsum(count) - count)[row]
    added = np.zeros((6, count.max(initial=0), stress.shape[2]))
    added[:, among, row] = rough
    return np.concatenate((np.where(even, stress, 0.0), added), axis=1), is_valid


def surface_points(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sign: float, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (surface stresses (6, n), corner columns, corner rows, mask of valid rows).

    At an edge of the contact or of stick it is the stress on the smooth side, at the nearest
    corner; if this is not known, the stress between the elements. Parameters as for
    `surface_cycles`.

    Returns
    -------
    stress : ndarray, shape (6, n)
        MPa.
    column, row : ndarray of int, shape (n,)
        Numbers of the corners in x and in y.
    is_valid : ndarray of bool, shape (n_y - 1,), for strips (1,)
        As by `surface_cycles`.
    """
    stress, even, is_valid, rough, places = _surface_stresses(
        lattice, body, tractions, sign, sliding
    )
    edge = np.zeros_like(even)
    edge[tuple(places)] = True
    column, row = np.nonzero(even | ~edge)
    every = np.concatenate((stress[:, column, row], rough), axis=1)
    return every, np.append(column, places[0]), np.append(row, places[1]), is_valid


def _surface_stresses(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sign: float, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (corner stresses, smooth corners, valid rows, edge stresses, their nearest corners).

    Parameters as for `surface_cycles`; `sliding` is a mask.

    Returns
    -------
    stress : ndarray, shape (6, n_x - 1, n_y - 1)
        Stress at the corners.
    is_smooth : ndarray of bool, shape (n_x - 1, n_y - 1)
        Corners with smooth stress.
    is_valid : ndarray of bool, shape (n_y - 1,)
        Rows with a valid path.
    edge_stress : ndarray, shape (6, n)
        Stress at the edges in the rows of corners.
    nearest : ndarray of int, shape (2, n)
        Numbers of the nearest corner of each edge.
    """
    (stress,) = surface_stress(lattice, body, tractions, (sign,))
    pressure = tractions[2]
    kinds = kinds_of_corners(pressure, sliding)
    loaded = kinds != UNLOADED
    away = kinds_of_corners(1.0 * (pressure <= 0.0), sliding) != UNLOADED
    nu, sides = (body.A.poisson,), (lattice.dx, lattice.dy)
    rough, places = stresses_at_edges(stress[None], pressure, kinds, nu, *sides)
    in_row = places[1] == np.rint(places[1])
    is_valid = loaded.any(axis=0) | away.all(axis=0)
    last = np.array(stress.shape[1:])[:, None] - 1
    nearest = np.clip(np.rint(places[:, in_row]).astype(int), 0, last)
    return stress, loaded | away, is_valid, rough[:, 0, in_row], nearest


@dataclass(frozen=True, eq=False)
class Layer:
    """Equivalent stress of all bodies on a regular mesh of points at one depth.

    Attributes
    ----------
    depth : float
        Depth, mm.
    first, steps : tuple of float
        The first point (x, y), and the steps to the next points, mm.
    values : ndarray, shape (bodies, n_x, n_y)
        Equivalent stress, MPa.
    """

    depth: float
    first: tuple[float, float]
    steps: tuple[float, float]
    values: np.ndarray

    def points(self, i: np.ndarray, j: np.ndarray, deeper: np.ndarray) -> np.ndarray:
        """Return points (n, 3), mm, at indices i, j of the layer, at a multiple of its depth."""
        (x, y), (dx, dy) = self.first, self.steps
        return np.stack((x + i * dx, y + j * dy, self.depth * deeper), axis=1)


class _Side:
    """One side (x or y) of the rectangle of blocks around the loaded elements.

    Parameters
    ----------
    loaded : slice
        Loaded elements of the mesh.
    origin, step : float
        Centre of its first element, and the element length, mm.

    Attributes
    ----------
    inside : slice
        Loaded elements of the rectangle.
    coarsest : int
        Elements along the largest block of a layer, a power of two.
    count, unit : int
        Elements along the side, a multiple of `unit`, which is a power of two.
    half_width : float
        Half of the length of the loaded elements, mm.
    corner : float
        Start of the side, mm.
    margin : int
        Unloaded elements around the loaded ones.
    fewest : int
        Smallest number of blocks across the rectangle.
    multiple : int
        The number of elements is a multiple of it: a contact that grows as it wears needs few
        numbers, and the transforms of each are planned once.
    """

    margin, fewest, multiple = 2, 12, 16

    def __init__(self, loaded: slice, origin: float, step: float) -> None:
        self.loaded, self.step = loaded, step
        number = loaded.stop - loaded.start
        needed = number + 2 * self.margin
        self.inside = slice(self.margin, self.margin + number)
        self.coarsest = _power_of_two(needed / self.fewest)
        self.unit = max(self.multiple, self.coarsest)
        self.count = -(-needed // self.unit) * self.unit
        self.half_width = 0.5 * number * step
        self.corner = float(origin + (loaded.start - self.margin - 0.5) * step)

    def block(self, longest: float) -> int:
        """Return the number of elements (a power of two) along a block of at most this length."""
        return min(_power_of_two(longest / self.step), self.coarsest)


class MultiLevel:
    """Stress below a contact at several resolutions, to search its maximum.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    bodies : sequence of HalfSpaces
        The half-spaces, see `HalfSpaces.single_body`.
    criterion : StressCriterion
        Criterion of the stress.

    Attributes
    ----------
    side : float
        Longer side of an element, mm.
    half_width : float
        Half of the shorter side of the rectangle around the loaded elements, mm.
    growth : float
        Ratio of the depths of successive layers.
    widest, narrow : float
        Largest side of blocks over their distance, during the search and at its end: there the
        error of the stress is 3e-5 (spheres of 31 to 91 elements).
    """

    growth = 2.5
    widest, narrow = 0.5, 0.2

    def __init__(
        self,
        grid: Grid,
        tractions: np.ndarray,
        signs: Sequence[float],
        bodies: Sequence[HalfSpaces],
        criterion: StressCriterion,
    ):
        loaded = tractions[2] != 0.0
        x = self._x = _Side(extent(loaded.any(axis=1)), grid.x[0], grid.dx)
        y = self._y = _Side(extent(loaded.any(axis=0)), grid.y[0], grid.dy)
        self.side, self.half_width = max(grid.dx, grid.dy), min(x.half_width, y.half_width)
        self._signs, self._bodies, self._criterion = signs, bodies, criterion
        self._poisson = tuple(body.A.poisson for body in bodies)
        self._tractions = np.zeros((3, x.count, y.count))
        self._tractions[:, x.inside, y.inside] = tractions[:, x.loaded, y.loaded]
        sums = stress_sum.cumulative_sums(self._tractions)
        self._summed = (x.corner, y.corner), sums, (x.step, y.step), (x.unit, y.unit)
        self._of_bodies = np.array((signs, self._poisson))
        self._levels: dict[tuple[int, int], StressLayers] = {}

    def layer(self, depth: float) -> Layer:
        """Return the stress layer at a depth, on blocks that grow with the depth."""
        x, y = self._x, self._y
        bx, by = x.block(depth), y.block(depth)
        if (bx, by) not in self._levels:
            lattice = Lattice((x.count // bx, y.count // by), bx * x.step, by * y.step)
            loads = self._means(bx, by), self._poisson, self._signs
            self._levels[bx, by] = StressLayers(lattice, *loads)
        stress = self._levels[bx, by].at(depth)
        steps = bx * x.step, by * y.step
        first = x.corner + 0.5 * steps[0], y.corner + 0.5 * steps[1]
        return Layer(depth, first, steps, self._criterion(stress.swapaxes(0, 1)))

    def stress_around(
        self, bodies: np.ndarray, points: np.ndarray, around: np.ndarray, closely: bool = False
    ) -> np.ndarray:
        """Return the equivalent stress (m, n) at points (m, n, 3) near the points `around` (m, 3).

        The error is some 1e-3, with `closely` some 1e-5, and the stress is smooth: distant
        elements are combined in equal blocks for all the points.
        """
        widest = self.narrow if closely else self.widest
        stress = np.zeros((len(points), 6, points.shape[1]))
        rows = self._of_bodies.take(bodies, axis=1)  # contiguous, as the kernel is compiled for
        stress_sum.stress_around(stress, points, around, *rows, *self._summed, widest)
        return self._criterion(stress.swapaxes(0, 1))

    def surface(self, sliding: np.ndarray) -> list[tuple[float, Point]]:
        """Return (value, position) of the largest stress at the surface of each body.

        It includes positions with stress that the mesh cannot resolve (`subsurface.multilevel`).

        Parameters
        ----------
        sliding : ndarray of bool, shape (n_x, n_y)
            Elements of the grid that slip.
        """
        x, y = self._x, self._y
        slips = np.zeros((x.count, y.count), dtype=bool)
        slips[x.inside, y.inside] = sliding[x.loaded, y.loaded]
        lattice = Lattice(slips.shape, x.step, y.step)
        loads = self._bodies, self._signs, self._tractions
        largest = largest_at_surface(lattice, *loads, slips, self._criterion)
        at_x, at_y = x.corner + 0.5 * x.step, y.corner + 0.5 * y.step
        return [(value, (at_x + i * x.step, at_y + j * y.step, 0.0)) for value, i, j in largest]

    def _means(self, bx: int, by: int) -> np.ndarray:
        """Return mean tractions (3, ...) on blocks of bx by by elements."""
        if (bx, by) == (1, 1):
            return self._tractions
        if bx >= by:
            halves = self._means(bx // 2, by)
            return 0.5 * (halves[..., ::2, :] + halves[..., 1::2, :])
        halves = self._means(bx, by // 2)
        return 0.5 * (halves[..., ::2] + halves[..., 1::2])


def _power_of_two(largest: float) -> int:
    """Return the largest power of two that does not exceed a number, at least 1."""
    return 1 << max(1, int(largest)).bit_length() - 1
