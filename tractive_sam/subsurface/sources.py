"""Methods that compute the stress in bodies: patches or strips of traction, near and distant.

Body A needs no transformation. Body B is mirrored in z: it has the opposite tangential traction,
and in the axes of the contact its xz and yz have the opposite sign.

Far from the tractions, stress is computed on coarser levels of resolution. At the surface, stress
is sought between elements, at the contact edge and at the stick boundary. At the edge and the
boundary, traction and pressure depend on the root of the distance, which no mesh resolves; but each
stress has the root on one side only, and is smooth on the other side (`kernels.contact_edge`).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import singledispatch
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.kernels import stress, stress_sum
from tractive_sam.kernels.contact_edge import (
    BOTH,
    UNLOADED,
    kinds_of_corners,
    stresses_at_edges,
    stresses_at_loaded_corners,
)
from tractive_sam.mechanics import (
    AnisotropicMaterial,
    Elasticity,
    HalfSpaces,
    Steel,
    StressCriterion,
    Strips,
)
from tractive_sam.operators import (
    Lattice,
    StressLayers,
    StressPlane,
    StripLayers,
    extent,
    surface_stress,
)
from tractive_sam.results import Grid, Point


def largest_at_surface(
    lattice: Lattice,
    bodies: Sequence[HalfSpaces],
    signs: Sequence[float],
    tractions: np.ndarray,
    sliding: np.ndarray,
    criterion: StressCriterion,
    first_row: float = 0.0,
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
    first_row : float
        y of the first row of elements, mm.

    Returns
    -------
    list of (float, float, float)
        The stress, MPa, and its position (i, j) from the centre of the first element, in elements.
    """
    stress, pressure = _between_elements(lattice, bodies, signs, tractions), tractions[2]
    kinds = kinds_of_corners(pressure, sliding)
    if not kinds.any():  # nowhere wider than an element
        kinds[:] = BOTH
    below = _below_edges(bodies)
    candidates = (
        stresses_at_loaded_corners(stress, kinds),
        stresses_at_edges(stress, pressure, kinds, below, lattice.dx, lattice.dy),
    )
    each, places = (np.concatenate(parts, axis=-1) for parts in zip(*candidates, strict=True))
    number = np.arange(len(bodies))[:, None]
    rows = first_row + lattice.dy * (places[1] + 0.5)
    values = criterion.at(each, number, rows, 0.0)
    at = values.argmax(axis=1)
    i, j = places[:, at] + np.array(((0.5,), (0.5 if pressure.shape[1] > 1 else 0.0,)))
    return list(zip(values[range(len(at)), at].tolist(), i.tolist(), j.tolist(), strict=True))


def _below_edges(bodies: Sequence[Any]) -> list[Any]:
    """Return the bodies' Poisson's ratios, or of anisotropic ones the stress inside an edge."""
    return [
        AnisotropicMaterial(body.A.stiffness).below_edge
        if hasattr(body.A, "stiffness")
        else body.A.poisson
        for body in bodies
    ]


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
    below, sides = _below_edges((body,)), (lattice.dx, lattice.dy)
    rough, places = stresses_at_edges(stress[None], pressure, kinds, below, *sides)
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
        rows = first[1] + steps[1] * np.arange(stress.shape[3])
        number = np.arange(len(self._bodies))[:, None, None]
        values = self._criterion.at(stress.swapaxes(0, 1), number, rows, depth)
        return Layer(depth, first, steps, values)

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
        place = bodies[:, None], points[..., 1], points[..., 2]
        return self._criterion.at(stress.swapaxes(0, 1), *place)

    def surface(self, sliding: np.ndarray) -> list[tuple[float, Point]]:
        """Return (value, position) of the largest stress at the surface of each body.

        It includes positions with stress that the mesh cannot resolve (`subsurface.sources`).

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
        at_x, at_y = x.corner + 0.5 * x.step, y.corner + 0.5 * y.step
        largest = largest_at_surface(lattice, *loads, slips, self._criterion, at_y)
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


class DistantLoads:
    """Point forces in place of a contact's tractions, for stress far from the mesh.

    Blocks of elements are halved until their sides are at most `widest` times their distance; each
    block becomes four forces with its load and moments (`kernels.stress_sum.stress_around`). The
    blocks are mirror-symmetric about the middle of the mesh in y: a mirrored load gives exactly the
    mirrored stress. Blocks depend on the mesh, not on the load: stress changes smoothly as a
    contact wears.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    poisson : sequence of float
        Poisson's ratio of each body.
    widest : float
        Largest side of a block over its distance. The error is proportional to its square: with 0.3
        it is at most 1e-4 of the largest pressure.
    spread : float
        Width of the rows with common blocks over their distance; no influence on the error up to 1.
    """

    def __init__(
        self,
        grid: Grid,
        tractions: np.ndarray,
        signs: Sequence[float],
        poisson: Sequence[float],
        widest: float = 0.3,
        spread: float = 1.0,
    ):
        nx, ny = grid.elements
        odd, rows = ny % 2, ny - ny // 2
        self._bodies = np.array(signs), np.array(poisson)
        self._widest, self._spread = widest, spread
        # From the middle row outwards; for an odd number half of its load is on each side.
        self._y = (np.arange(ny) - 0.5 * (ny - 1)) * grid.dy
        self._corner = float(grid.x[0] - 0.5 * grid.dx), -0.5 * odd * grid.dy
        self._lengths = grid.dx, grid.dy
        self._block = tuple(1 << (count - 1).bit_length() for count in (nx, rows))
        self._sides = []
        for sign, half in ((1, tractions), (-1, tractions[..., ::-1])):
            loads = np.zeros((3, *self._block))
            loads[:, :nx, :rows] = half[..., ny // 2 :]
            loads[1] *= sign
            loads[..., 0] *= 1.0 - 0.5 * odd
            self._sides.append((sign, stress_sum.cumulative_sums(loads)))

    def stress(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at distant x (n_x,) in all rows at k depths.

        Depths ascend from above 0; x are beyond the ends of the grid.
        """
        signs, poisson = self._bodies
        out = np.zeros((signs.size, 6, x.size, self._y.size, depths.size))
        part = np.empty(out.shape)
        mirrored = np.array((1.0, 1.0, 1.0, -1.0, 1.0, -1.0))[:, None, None, None]
        for sign, sums in self._sides:
            blocks = self._corner, sums, self._lengths, self._block, self._widest, self._spread
            stress_sum.stress_at_columns(part, x, self._y, depths, signs, poisson, *blocks)
            out += part if sign > 0 else part[:, :, :, ::-1] * mirrored
        return out


@dataclass(frozen=True, eq=False)
class PatchLoads:
    """Loaded elements (patches) of a half-space, for stress at any points.

    Attributes
    ----------
    centres : ndarray, shape (m, 2)
        (x, y), mm.
    tractions : ndarray, shape (m, 3)
        (p_x, p_y, p_n), MPa.
    sides : tuple of float
        (dx, dy), mm.
    poisson : float
        Poisson's ratio.
    """

    centres: np.ndarray
    tractions: np.ndarray
    sides: tuple[float, float]
    poisson: float

    @classmethod
    def on_mesh(
        cls,
        x: np.ndarray,
        y: np.ndarray,
        sides: tuple[float, float],
        tractions: np.ndarray,
        poisson: float,
    ) -> "PatchLoads":
        """Return the patches of a mesh that carry tractions (3, n_x, n_y)."""
        i, j = np.nonzero(tractions.any(axis=0))
        loads = np.ascontiguousarray(tractions[:, i, j].T)
        return cls(np.stack((x[i], y[j]), axis=1), loads, sides, poisson)

    def stress(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (n, 6) at points (n, 3) of the half-space, MPa."""
        out = np.empty((len(points), 6))
        stress_sum.sum_patch_stress(
            out, points, self.centres, self.tractions, *self.sides, self.poisson
        )
        return out


SIGNS = {"A": 1.0, "B": -1.0}
"""Sign of z in each body, and of the tangential traction that acts on it."""


def tractions_on_bodies(tractions: np.ndarray, signs: Sequence[float]) -> np.ndarray:
    """Return the tractions (bodies, 3, ...) on each body's half-space, from those on body A."""
    each = np.array([(sign, sign, 1.0) for sign in signs])
    return tractions * each.reshape(*each.shape, *(1,) * (tractions.ndim - 1))


@dataclass(frozen=True, eq=False)
class StripLoads:
    """Loaded strips of a half-space (line contact), for stress at any points.

    Attributes
    ----------
    edges : ndarray, shape (m,)
        x, mm.
    jumps : ndarray, shape (m, 3)
        Increase of (p_x, p_y, p_n) across each edge, MPa.
    width : float
        Width of a strip, mm.
    poisson : float
        Poisson's ratio.
    """

    edges: np.ndarray
    jumps: np.ndarray
    width: float
    poisson: float

    @classmethod
    def on_grid(cls, grid: Grid, tractions: np.ndarray, poisson: float) -> "StripLoads":
        """Return the loaded strips of a line contact's grid, from tractions (3, n_x, 1)."""
        jumps = np.diff(tractions[:, :, 0].T, axis=0, prepend=0.0, append=0.0)
        edges = np.append(grid.x - 0.5 * grid.dx, grid.x[-1] + 0.5 * grid.dx)
        loaded = jumps.any(axis=1)
        return cls(edges[loaded], np.ascontiguousarray(jumps[loaded]), grid.dx, poisson)

    def stress(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (n, 6) at points (n, 3) of the half-space, constant in y, MPa."""
        out = np.empty((len(points), 6))
        at = np.ascontiguousarray(points[:, [0, 2]])
        stress.sum_strip_stress(out, at, self.edges, self.jumps, self.width, self.poisson)
        return out


class StripLevels:
    """Stress below a line contact, to search its maximum (`MultiLevel` without blocks).

    Parameters
    ----------
    grid : Grid
        Grid of a line contact.
    tractions : ndarray, shape (3, n_x, 1)
        (p_x, p_y, p_n) on body A, MPa.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    bodies : sequence of Strips
        The half-spaces, see `Strips.single_body`.
    criterion : StressCriterion
        Criterion of the stress.
    """

    # Layers cost little; below a line the shear stress may have two maxima, which differ by 2 %.
    growth = 1.25

    def __init__(
        self,
        grid: Grid,
        tractions: np.ndarray,
        signs: Sequence[float],
        bodies: Sequence[Strips],
        criterion: StressCriterion,
    ):
        self._x, self.side = grid.x, grid.dx
        self.half_width = 0.5 * grid.dx * np.count_nonzero(tractions[2])
        self._tractions, self._signs = tractions, signs
        self._bodies, self._criterion = bodies, criterion
        self._lattice = Lattice(grid.elements, grid.dx, grid.dy)
        poisson = [body.A.poisson for body in bodies]
        self._layers = StripLayers(self._lattice, tractions, poisson, signs)
        each = zip(tractions_on_bodies(tractions, signs), poisson, strict=True)
        self._strips = [StripLoads.on_grid(grid, on_body, nu) for on_body, nu in each]

    def layer(self, depth: float) -> Layer:
        """Return the stress layer at a depth, at the element centres."""
        number = np.arange(len(self._bodies))[:, None, None]
        stress = self._layers.at(depth).swapaxes(0, 1)
        values = self._criterion.at(stress, number, np.zeros(1), depth)
        return Layer(depth, (float(self._x[0]), 0.0), (self.side, 0.0), values)

    def stress_around(
        self, bodies: np.ndarray, points: np.ndarray, around: np.ndarray, closely: bool = False
    ) -> np.ndarray:
        """Return the equivalent stress (m, n) at points (m, n, 3) near the points `around` (m, 3).

        The sum over the elements is exact.
        """
        values = np.empty(points.shape[:2])
        for k, body in enumerate(bodies):
            stress = self._strips[body].stress(points[k]).T
            values[k] = self._criterion.at(stress, body, points[k, :, 1], points[k, :, 2])
        return values

    def surface(self, sliding: np.ndarray) -> list[tuple[float, Point]]:
        """Return (value, position) of the largest stress at the surface of each body.

        The stress is evaluated at the edges of strips.
        """
        loads = self._bodies, self._signs, self._tractions
        largest = largest_at_surface(self._lattice, *loads, sliding, self._criterion)
        return [(value, (float(self._x[0] + i * self.side), 0.0, 0.0)) for value, i, _ in largest]


class StressSource(Protocol):
    """Protocol of stress solvers for half-spaces under tractions on a grid.

    Stresses have the order of `results.COMPONENTS`, MPa.
    """

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, n_y) if z.

        The shape is (bodies, 6, n, k) at k depths, or (bodies, 6, n_x, n_y) for the axis z.
        """

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths.

        They are in all rows of the grid; depths are above 0.
        """

    def levels(self, criterion: StressCriterion) -> Any:
        """Return the stress at several depths (resolutions) in which the maximum is searched."""


@singledispatch
def stress_source(
    body: Elasticity,
    bodies: Sequence[Elasticity],
    signs: Sequence[float],
    grid: Grid,
    tractions: np.ndarray,
) -> StressSource:
    """Return the stress solver for the class of the first body; ValueError if none is registered.

    Parameters
    ----------
    body : Elasticity
        The first body; its class selects the method.
    bodies : sequence of Elasticity
        The bodies, see `Elasticity.single_body`.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on body A, MPa.

    Raises
    ------
    ValueError
        If no method is registered for the class.
    """
    raise ValueError(
        f"the stress in bodies with the law {body!r} is unknown; use HalfSpaces or a subclass"
    )


class PatchStress:
    """Stress solver for half-spaces under tractions on rectangular elements."""

    def __init__(
        self,
        bodies: Sequence[HalfSpaces],
        signs: Sequence[float],
        grid: Grid,
        tractions: np.ndarray,
    ):
        self._bodies, self._signs, self._grid, self._tractions = bodies, signs, grid, tractions
        self._poisson = tuple(body.A.poisson for body in bodies)

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        grid = self._grid
        lattice = Lattice(grid.elements, grid.dx, grid.dy)
        loads = self._tractions, self._poisson, self._signs
        return map(StressLayers(lattice, *loads, threads).at, depths)

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, n_y) if z."""
        if axis == "z":
            return next(self.layers([position]))
        loads = self._tractions, self._poisson, self._signs
        plane = StressPlane(self._grid, axis, position, *loads)
        return np.stack([plane.at(depth) for depth in depths], axis=-1)

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""
        grid, sides = self._grid, (self._grid.dx, self._grid.dy)
        each = zip(tractions_on_bodies(self._tractions, self._signs), self._poisson, strict=True)
        patches = [PatchLoads.on_mesh(grid.x, grid.y, sides, on_body, nu) for on_body, nu in each]
        return np.stack([patch.stress(points).T for patch in patches])

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths.

        See `DistantLoads` for the error.
        """
        loads = DistantLoads(self._grid, self._tractions, self._signs, self._poisson)
        return loads.stress(x, depths)

    def levels(self, criterion: StressCriterion) -> MultiLevel:
        """Return the `MultiLevel` of the bodies, in which the largest stress is searched."""
        return MultiLevel(self._grid, self._tractions, self._signs, self._bodies, criterion)


class StripStress:
    """Stress solver for half-spaces under tractions on strips (line contact)."""

    def __init__(
        self, bodies: Sequence[Strips], signs: Sequence[float], grid: Grid, tractions: np.ndarray
    ):
        self._bodies, self._signs, self._grid, self._tractions = bodies, signs, grid, tractions
        self._poisson = tuple(body.A.poisson for body in bodies)

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        lattice = Lattice(self._grid.elements, self._grid.dx, self._grid.dy)
        return map(StripLayers(lattice, self._tractions, self._poisson, self._signs).at, depths)

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, 1) if z."""
        if axis == "z":
            return next(self.layers([position]))
        if axis == "y":
            return np.concatenate(list(self.layers(depths)), axis=-1)
        points = np.stack(np.broadcast_arrays(position, 0.0, depths), axis=-1)
        return self.at(points)[:, :, None]

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""
        each = zip(tractions_on_bodies(self._tractions, self._signs), self._poisson, strict=True)
        strips = [StripLoads.on_grid(self._grid, on_body, nu) for on_body, nu in each]
        return np.stack([strip.stress(points).T for strip in strips])

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths.

        The sum over the elements is exact.
        """
        places = np.broadcast_arrays(x[:, None], 0.0, depths)
        stress = self.at(np.stack(places, axis=-1).reshape(-1, 3))
        return stress.reshape(len(stress), 6, x.size, 1, depths.size)

    def levels(self, criterion: StressCriterion) -> StripLevels:
        """Return the `StripLevels` of the bodies, in which the largest stress is searched."""
        return StripLevels(self._grid, self._tractions, self._signs, self._bodies, criterion)


@stress_source.register
def _patch_stress(body: HalfSpaces, *of_bodies) -> PatchStress:
    """Return the stress solver for half-spaces under rectangular elements."""
    return PatchStress(*of_bodies)


@stress_source.register
def _strip_stress(body: Strips, *of_bodies) -> StripStress:
    """Return the stress solver for a line contact."""
    return StripStress(*of_bodies)


class StressWithResidual:
    """Stress solver that adds the residual stress of the bodies to the stress of another solver.

    Parameters
    ----------
    source : StressSource
        Solver of the stress that tractions cause.
    steel : sequence of Steel
        Material of each body.
    rows : ndarray, shape (n_y,)
        y of the rows of the grid, mm.
    worn : ndarray, shape (bodies, n_y)
        Depth worn off each body, mm: residual stress belongs to the material below.
    """

    def __init__(
        self, source: StressSource, steel: Sequence[Steel], rows: np.ndarray, worn: np.ndarray
    ):
        self._source, self._steel, self._rows, self._worn = source, steel, rows, worn

    def residual(self, y: np.ndarray | float, depth: np.ndarray | float) -> np.ndarray:
        """Return the residual stress xx, yy of each body at places, shape (bodies, 2, ...), MPa."""
        stresses = []
        for steel, worn in zip(self._steel, self._worn, strict=True):
            zeta = depth + np.interp(y, self._rows, worn)
            stress = steel.stress(zeta)
            stresses.append(np.zeros((2, *zeta.shape)) if stress is None else stress)
        return np.stack(stresses)

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        depths = list(depths)
        for depth, total in zip(depths, self._source.layers(depths, threads), strict=True):
            total[:, :2] += self.residual(self._rows, depth)[:, :, None]
            yield total

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, n_y) if z."""
        stress = self._source.on_plane(axis, position, depths)
        y = self._rows[:, None] if axis == "x" else np.full((1, 1), position)
        if axis == "z":
            stress[:, :2] += self.residual(self._rows, position)[:, :, None]
        else:
            stress[:, :2] += self.residual(y, depths)
        return stress

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""
        stress = self._source.at(points)
        stress[:, :2] += self.residual(points[:, 1], points[:, 2])
        return stress

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths."""
        stress = self._source.at_columns(x, depths)
        stress[:, :2] += self.residual(self._rows[:, None], depths)[:, :, None]
        return stress

    def levels(self, criterion: StressCriterion) -> Any:
        """Return the levels of the other solver, whose criterion adds the residual stress."""
        return self._source.levels(_CriterionWithResidual(criterion, self))


class _CriterionWithResidual(StressCriterion):
    """Criterion of the sum of a stress and the residual stress at its place."""

    def __init__(self, criterion: StressCriterion, source: StressWithResidual):
        self._criterion, self._residual = criterion, source.residual

    def __call__(self, stress: np.ndarray) -> np.ndarray:
        """Raise a LookupError: without a place the residual stress is not known."""
        raise LookupError("residual stress depends on the place: use StressCriterion.at")

    def at(
        self, stress: np.ndarray, body: np.ndarray, y: np.ndarray, depth: ArrayLike
    ) -> np.ndarray:
        """Return the equivalent stress of the sum (`StressCriterion.at`)."""
        body, y, depth = np.broadcast_arrays(body, y, depth)
        residual = np.take_along_axis(self._residual(y, depth), body[None, None], axis=0)[0]
        total = stress.copy()
        total[:2] += residual
        return self._criterion(total)
