"""The loaded part of a mesh at several resolutions: elements, and blocks of 2, 4, 8 ... of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import stress_sum
from tractive_sam.mechanics import HalfSpaces, StressCriterion
from tractive_sam.operators import Lattice, StressLayers, extent
from tractive_sam.results import Grid, Point
from tractive_sam.subsurface.surface import largest_at_surface

FEWEST = 12
"""Fewest blocks across the loaded rectangle."""

MARGIN = 2
"""Unloaded elements around the loaded ones."""

WIDEST, NARROW = 0.5, 0.2
"""Longest side of blocks of elements over their distance, where these are taken together on the way
to a top, and at it: there the stress is right to 3e-5 (spheres of 31 to 91 elements)."""

ROUND = 16
"""Sides are multiples of this many elements: a contact that grows as it wears meets few of them,
and the transforms of each are planned but once."""


@dataclass(frozen=True, eq=False)
class Layer:
    """Equivalent stress of all bodies at one depth.

    Attributes
    ----------
    depth : float
        Where it lies, mm.
    first, steps : tuple of float
        The first point (x, y), and the steps to the next ones, mm.
    values : ndarray, shape (bodies, n_x, n_y)
        Equivalent stress, MPa.
    """

    depth: float
    first: tuple[float, float]
    steps: tuple[float, float]
    values: np.ndarray

    def points(self, i: np.ndarray, j: np.ndarray, deeper: np.ndarray) -> np.ndarray:
        """Points (n, 3) so many steps from the first one, and times as deep, mm."""
        (x, y), (dx, dy) = self.first, self.steps
        return np.stack((x + i * dx, y + j * dy, self.depth * deeper), axis=1)


class _Side:
    """One side of the rectangle around the loaded elements of a mesh.

    Parameters
    ----------
    loaded : slice
        Those of the mesh.
    origin, step : float
        Centre of its first element, and the length of each, mm.

    Attributes
    ----------
    inside : slice
        The loaded ones in the rectangle.
    coarsest : int
        Elements along the largest block of a layer, a power of two.
    count, unit : int
        Elements along the side, and what they are a multiple of, a power of two.
    half_width : float
        Half of the length of the loaded ones, mm.
    corner : float
        Where it begins, mm.
    """

    def __init__(self, loaded: slice, origin: float, step: float) -> None:
        self.loaded, self.step = loaded, step
        number = loaded.stop - loaded.start
        least = number + 2 * MARGIN
        self.inside = slice(MARGIN, MARGIN + number)
        self.coarsest = _power_of_two(least / FEWEST)
        self.unit = max(ROUND, self.coarsest)
        self.count = -(-least // self.unit) * self.unit
        self.half_width = 0.5 * number * step
        self.corner = float(origin + (loaded.start - MARGIN - 0.5) * step)

    def block(self, longest: float) -> int:
        """Elements along the longest block up to a length in mm."""
        return min(_power_of_two(longest / self.step), self.coarsest)


class MultiLevel:
    """The tractions of bodies under one contact, and the stress that they cause.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    signs : sequence of float
        Those of `SIGNS` for each body.
    bodies : sequence of HalfSpaces
        The half-spaces, as `HalfSpaces.single_body` gives them.
    criterion : StressCriterion
        What makes one number of a stress.

    Attributes
    ----------
    side : float
        Longer side of an element, mm.
    half_width : float
        Half of the shorter side of the rectangle around the loaded elements, mm.
    growth : float
        Ratio of the depths of successive layers.
    """

    growth = 2.5

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
        sums = stress_sum.summed(self._tractions)
        self._summed = (x.corner, y.corner), sums, (x.step, y.step), (x.unit, y.unit)
        self._of_bodies = np.array((signs, self._poisson))
        self._levels: dict[tuple[int, int], StressLayers] = {}

    def layer(self, depth: float) -> Layer:
        """Stress by blocks with sides up to the depth; by elements where there are none.

        At the centres of the blocks.
        """
        x, y = self._x, self._y
        bx, by = x.block(depth), y.block(depth)
        if (bx, by) not in self._levels:
            lattice = Lattice((x.count // bx, y.count // by), bx * x.step, by * y.step)
            own = self._means(bx, by), self._poisson, self._signs
            self._levels[bx, by] = StressLayers(lattice, *own)
        stress = self._levels[bx, by].at(depth)
        steps = bx * x.step, by * y.step
        first = x.corner + 0.5 * steps[0], y.corner + 0.5 * steps[1]
        return Layer(depth, first, steps, self._criterion(stress.swapaxes(0, 1)))

    def around(
        self, bodies: np.ndarray, points: np.ndarray, around: np.ndarray, closely: bool = False
    ) -> np.ndarray:
        """Equivalent stress (m, n) of bodies (m,) at points (m, n, 3) near some (m, 3).

        Right to some thousandths, `closely` to some 1e-5, and smooth as it is exactly: elements
        that are far are taken together in the same blocks for all the points.
        """
        widest = NARROW if closely else WIDEST
        stress = np.empty((6, *points.shape[:2]))
        own = self._of_bodies.take(bodies, axis=1)  # contiguous rows, as the kernel is compiled for
        stress_sum.stress_around(stress, points, around, *own, *self._summed, widest)
        return self._criterion(stress)

    def surface(self, sliding: np.ndarray) -> list[tuple[float, Point]]:
        """The largest stress of each body at the surface, MPa, and where.

        Also where the mesh cannot follow it (`subsurface.surface`).

        Parameters
        ----------
        sliding : ndarray of bool, shape (n_x, n_y)
            Elements of the grid that slip.
        """
        x, y = self._x, self._y
        slips = np.zeros((x.count, y.count), dtype=bool)
        slips[x.inside, y.inside] = sliding[x.loaded, y.loaded]
        lattice = Lattice(slips.shape, x.step, y.step)
        own = self._bodies, self._signs, self._tractions
        found = largest_at_surface(lattice, *own, slips, self._criterion)
        at_x, at_y = x.corner + 0.5 * x.step, y.corner + 0.5 * y.step
        return [(value, (at_x + i * x.step, at_y + j * y.step, 0.0)) for value, i, j in found]

    def _means(self, bx: int, by: int) -> np.ndarray:
        """Tractions (3, ...) on blocks, each made of the two halves of its longer side."""
        if (bx, by) == (1, 1):
            return self._tractions
        if bx >= by:
            halves = self._means(bx // 2, by)
            return 0.5 * (halves[..., ::2, :] + halves[..., 1::2, :])
        halves = self._means(bx, by // 2)
        return 0.5 * (halves[..., ::2] + halves[..., 1::2])


def _power_of_two(most: float) -> int:
    """Largest power of two up to a number, at least 1."""
    return 1 << max(1, int(most)).bit_length() - 1
