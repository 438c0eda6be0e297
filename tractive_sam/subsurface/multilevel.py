"""The loaded part of a mesh at several resolutions: elements, and blocks of 2, 4, 8 ... of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import stress_sum
from tractive_sam.mechanics import HalfSpaces, StressCriterion
from tractive_sam.operators import Lattice, StressLayers, extent
from tractive_sam.results import Grid, Point
from tractive_sam.subsurface.patches import Patches
from tractive_sam.subsurface.surface import corner_stress, largest_at_surface

FEWEST = 16
"""Fewest blocks across the loaded rectangle."""

MARGIN = 2
"""Unloaded elements around the loaded ones."""

ROUND = 8
"""Sides are multiples of this many elements: a contact that grows as it wears meets few of them,
and the transforms of each are planned but once."""


@dataclass(frozen=True, eq=False)
class Layer:
    """Equivalent stress of all bodies at one depth.

    Attributes
    ----------
    depth : float
        Where it lies, mm.
    x, y : ndarray
        Coordinates, mm.
    values : ndarray, shape (bodies, n_x, n_y)
        Equivalent stress, MPa.
    """

    depth: float
    x: np.ndarray
    y: np.ndarray
    values: np.ndarray

    def near(self, body: int, x: float, y: float) -> float:
        """The value of a body at the centre next to a place."""
        return self.values[body, np.abs(self.x - x).argmin(), np.abs(self.y - y).argmin()]


@dataclass(frozen=True, eq=False)
class _Level:
    """Blocks of one size: their centres, and the stress below them."""

    x: np.ndarray
    y: np.ndarray
    stress: StressLayers


@dataclass(frozen=True)
class _Side:
    """One side of the rectangle around the loaded elements of a mesh."""

    loaded: slice
    origin: float
    step: float

    @property
    def _least(self) -> int:
        return self.loaded.stop - self.loaded.start + 2 * MARGIN

    @property
    def coarsest(self) -> int:
        """Elements along the largest block."""
        return _power_of_two(self._least / FEWEST)

    @property
    def unit(self) -> int:
        """The side is a multiple of so many elements, a power of two."""
        return max(ROUND, self.coarsest)

    @property
    def count(self) -> int:
        """Elements along the side."""
        return -(-self._least // self.unit) * self.unit

    @property
    def inside(self) -> slice:
        """The loaded ones among them."""
        return slice(MARGIN, MARGIN + self.loaded.stop - self.loaded.start)

    @property
    def corner(self) -> float:
        """Where it begins, mm."""
        return float(self.origin + (self.loaded.start - MARGIN - 0.5) * self.step)

    def block(self, longest: float) -> int:
        """Elements along the longest block up to a length in mm."""
        return min(_power_of_two(longest / self.step), self.coarsest)

    def centres(self, block: int) -> np.ndarray:
        """Centres of the blocks, mm."""
        elements = self.loaded.start - MARGIN + np.arange(self.count)
        return self.origin + self.step * elements.reshape(-1, block).mean(axis=1)


class MultiLevel:
    """The tractions of bodies under one contact, and the stress that they cause.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (bodies, 3, n_x, n_y)
        (p_x, p_y, p_n) on each half-space, MPa.
    bodies : sequence of HalfSpaces
        The half-spaces, as `HalfSpaces.alone` gives them.
    criterion : StressCriterion
        What makes one number of a stress.

    Attributes
    ----------
    side : float
        Longer side of an element, mm.
    blocks : tuple of int
        Number of blocks (m_x, m_y) of the coarsest level; all others divide these.
    """

    def __init__(
        self,
        grid: Grid,
        tractions: np.ndarray,
        bodies: Sequence[HalfSpaces],
        criterion: StressCriterion,
    ):
        loaded = tractions.any(axis=(0, 1))
        x = self._x = _Side(extent(loaded.any(axis=1)), grid.x[0], grid.dx)
        y = self._y = _Side(extent(loaded.any(axis=0)), grid.y[0], grid.dy)
        self.side = max(grid.dx, grid.dy)
        self._bodies, self._criterion = bodies, criterion
        self._poisson = tuple(body.A.poisson for body in bodies)
        self._tractions = np.zeros((len(bodies), 3, x.count, y.count))
        self._tractions[:, :, x.inside, y.inside] = tractions[:, :, x.loaded, y.loaded]
        self.blocks = (x.count // x.coarsest, y.count // y.coarsest)
        self._corner = x.corner, y.corner
        self._sizes = x.step, y.step, x.unit, y.unit
        self._patches: dict[int, Patches] = {}
        self._levels: dict[tuple[int, int], _Level] = {}

    def layer(self, depth: float) -> Layer:
        """Stress by blocks with sides of at most half the depth; by elements where there are none.

        At the centres of the blocks.
        """
        level = self._level(self._x.block(0.5 * depth), self._y.block(0.5 * depth))
        return Layer(depth, level.x, level.y, self._equivalent(level.stress.at(depth)))

    def around(self, body: int, points: np.ndarray, around: np.ndarray) -> np.ndarray:
        """Equivalent stress (n,) of a body at points (n, 3) near a point; right to a percent.

        Smooth as it is exactly: elements that are far are taken together in the same blocks for
        all the points.
        """
        out = np.empty((len(points), 6))
        tractions, nu = self._tractions[body], self._poisson[body]
        stress_sum.stress_around(out, points, around, self._corner, tractions, *self._sizes, nu)
        return self._criterion(out.T)

    def at(self, body: int, points: np.ndarray) -> np.ndarray:
        """Equivalent stress (n,) of a body at points (n, 3), MPa."""
        if body not in self._patches:
            level, sides = self._level(1, 1), (self._x.step, self._y.step)
            own = self._tractions[body], self._poisson[body]
            self._patches[body] = Patches.on_mesh(level.x, level.y, sides, *own)
        return self._criterion(self._patches[body].stress(points).T)

    def surface(self, sliding: np.ndarray) -> list[tuple[float, Point]]:
        """The largest stress of each body at the surface, MPa, and where.

        Also where the mesh cannot follow it (`subsurface.surface`).

        Parameters
        ----------
        sliding : ndarray of bool, shape (n_x, n_y)
            Elements of the grid that slip.
        """
        x, y = self._x, self._y
        slips = np.zeros(self._tractions.shape[2:], dtype=bool)
        slips[x.inside, y.inside] = sliding[x.loaded, y.loaded]
        lattice = Lattice(slips.shape, x.step, y.step)
        stress = corner_stress(lattice, self._bodies, self._tractions)
        found = largest_at_surface(
            lattice, self._poisson, self._tractions, stress, slips, self._criterion
        )
        at_x, at_y = float(x.centres(1)[0]), float(y.centres(1)[0])
        return [(value, (at_x + i * x.step, at_y + j * y.step, 0.0)) for value, i, j in found]

    def _equivalent(self, stress: np.ndarray) -> np.ndarray:
        """Of stresses (bodies, 6, ...), shape (bodies, ...)."""
        return self._criterion(stress.swapaxes(0, 1))

    def _level(self, bx: int, by: int) -> "_Level":
        if (bx, by) not in self._levels:
            x, y = self._x.centres(bx), self._y.centres(by)
            lattice = Lattice((x.size, y.size), bx * self._x.step, by * self._y.step)
            stress = StressLayers(lattice, self._means(bx, by), self._poisson)
            self._levels[bx, by] = _Level(x, y, stress)
        return self._levels[bx, by]

    def _means(self, bx: int, by: int) -> np.ndarray:
        """Tractions (bodies, 3, ...) on blocks, each made of the two halves of its longer side."""
        if (bx, by) == (1, 1):
            return self._tractions
        if bx >= by:
            halves = self._means(bx // 2, by)
            return 0.5 * (halves[..., ::2, :] + halves[..., 1::2, :])
        halves = self._means(bx, by // 2)
        return 0.5 * (halves[..., ::2] + halves[..., 1::2])


def _power_of_two(most: float) -> int:
    """Largest power of two up to a number, at least 1."""
    return 1 << max(0, int(np.log2(max(most, 1.0))))
