"""The loaded part of a mesh at several resolutions: elements, and blocks of 2, 4, 8 ... of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tractive_sam.mechanics import HalfSpaces, StressCriterion
from tractive_sam.operators import Lattice, StressLayers, extent
from tractive_sam.results import Grid
from tractive_sam.subsurface.patches import Patches
from tractive_sam.subsurface.surface import largest_at_surface

FEWEST = 16
"""Fewest blocks across the loaded rectangle."""

MARGIN = 2
"""Unloaded elements around the loaded ones."""

ROUND = 8
"""Sides are multiples of this many elements: a contact that grows as it wears meets few of them,
and the transforms of each are planned but once."""


@dataclass(frozen=True, eq=False)
class Level:
    """Tractions on equal blocks, and the stress they cause.

    Attributes
    ----------
    x, y : ndarray
        Centres of the blocks, mm.
    sides : tuple of float
        Sides of a block, mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n), MPa.
    poisson : float
        Poisson's ratio.
    criterion : StressCriterion
        What makes one number of a stress.
    """

    x: np.ndarray
    y: np.ndarray
    sides: tuple[float, float]
    tractions: np.ndarray
    poisson: float
    criterion: StressCriterion

    @property
    def _lattice(self) -> Lattice:
        return Lattice((self.x.size, self.y.size), *self.sides)

    @cached_property
    def _layers(self) -> StressLayers:
        return StressLayers(self._lattice, self.tractions[None], (self.poisson,))

    @cached_property
    def _patches(self) -> Patches:
        return Patches.on_mesh(self.x, self.y, self.sides, self.tractions, self.poisson)

    def layer(self, depth: float) -> np.ndarray:
        """Equivalent stress at the centres at one depth, shape (n_x, n_y), MPa."""
        return self.criterion(self._layers.at(depth)[0])

    def at(self, points: np.ndarray) -> np.ndarray:
        """Equivalent stress (n,) at points (n, 3), MPa."""
        return self.criterion(self._patches.stress(points).T)


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
    def count(self) -> int:
        """Elements along the side, a multiple of the largest block and of `ROUND`."""
        unit = max(ROUND, self.coarsest)
        return -(-self._least // unit) * unit

    @property
    def inside(self) -> slice:
        """The loaded ones among them."""
        return slice(MARGIN, MARGIN + self.loaded.stop - self.loaded.start)

    def block(self, longest: float) -> int:
        """Elements along the longest block up to a length in mm."""
        return min(_power_of_two(longest / self.step), self.coarsest)

    def centres(self, block: int) -> np.ndarray:
        """Centres of the blocks, mm."""
        elements = self.loaded.start - MARGIN + np.arange(self.count)
        return self.origin + self.step * elements.reshape(-1, block).mean(axis=1)


class Pyramid:
    """Levels of one body's tractions, made as they are asked for.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on one half-space, MPa.
    body : HalfSpaces
        That half-space, as `HalfSpaces.alone` gives it.
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
        self, grid: Grid, tractions: np.ndarray, body: HalfSpaces, criterion: StressCriterion
    ):
        loaded = tractions.any(axis=0)
        x = self._x = _Side(extent(loaded.any(axis=1)), grid.x[0], grid.dx)
        y = self._y = _Side(extent(loaded.any(axis=0)), grid.y[0], grid.dy)
        self.side = max(grid.dx, grid.dy)
        self._body, self._criterion = body, criterion
        self._tractions = np.zeros((3, x.count, y.count))
        self._tractions[:, x.inside, y.inside] = tractions[:, x.loaded, y.loaded]
        self.blocks = (x.count // x.coarsest, y.count // y.coarsest)
        self._levels: dict[tuple[int, int], Level] = {}

    def level(self, longest: float) -> Level:
        """The largest blocks with sides up to a length in mm; elements where there are none."""
        block = self._x.block(longest), self._y.block(longest)
        if block not in self._levels:
            self._levels[block] = self._made(*block)
        return self._levels[block]

    def surface(self, sliding: np.ndarray) -> tuple[float, tuple[float, float, float]]:
        """Largest equivalent stress at the surface, MPa, and where, (x, y, 0), mm.

        Parameters
        ----------
        sliding : ndarray of bool, shape (n_x, n_y)
            Elements of the grid that slip.
        """
        x, y = self._x, self._y
        slips = np.zeros(self._tractions.shape[1:], dtype=bool)
        slips[x.inside, y.inside] = sliding[x.loaded, y.loaded]
        lattice = Lattice(slips.shape, x.step, y.step)
        value, i, j = largest_at_surface(
            lattice, self._body, self._tractions, slips, self._criterion
        )
        at = x.centres(1)[0] + i * x.step, y.centres(1)[0] + j * y.step
        return value, (float(at[0]), float(at[1]), 0.0)

    def _made(self, bx: int, by: int) -> Level:
        x, y = self._x.centres(bx), self._y.centres(by)
        sides = bx * self._x.step, by * self._y.step
        means = self._tractions.reshape(3, x.size, bx, y.size, by).mean(axis=(2, 4))
        return Level(x, y, sides, means, self._body.A.poisson, self._criterion)


def _power_of_two(most: float) -> int:
    """Largest power of two up to a number, at least 1."""
    return 1 << max(0, int(np.log2(max(most, 1.0))))
