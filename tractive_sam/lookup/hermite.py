"""Piecewise cubic Hermite interpolation on a grid of any dimension, once differentiable."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

GATHERED = 2**18
"""Weights of the points that are taken at once: what is gathered for them stays in the cache."""


@dataclass(frozen=True, eq=False)
class Hermite:
    """Values and derivatives at the nodes of a grid.

    Within a cell it is the product of the cubics of Hermite along each axis, so values and first
    derivatives are continuous whatever the derivatives are. An axis of one node does not vary.

    Parameters
    ----------
    axes : sequence of ndarray
        Ascending nodes along each axis.
    coefficients : ndarray, shape (n_1, ..., n_N, 2**N, m)
        Of each node the derivatives: bit k of the place among the 2**N, the highest one for the
        first axis, says whether it is once by the axis k.
    """

    axes: tuple[np.ndarray, ...]
    coefficients: np.ndarray

    def __call__(self, points: Sequence[ArrayLike], by: int | None = None) -> np.ndarray:
        """Values at points, or their derivative by an axis.

        Parameters
        ----------
        points : sequence of array_like, shape (P,)
            A coordinate along each axis; outside they are taken on the edge.
        by : int, optional
            Axis.

        Returns
        -------
        ndarray, shape (m, P)
        """
        return self.parts(points, (by,))[0]

    def parts(self, points: Sequence[ArrayLike], by: Iterable[int | None]) -> np.ndarray:
        """Several derivatives of each point, as of a call; shape (len(by), m, P)."""
        by = tuple(by)
        at = np.array([np.asarray(points[k], float) for k in self.varying])
        count = np.shape(points[0])[0]
        found = np.empty((len(by), self.coefficients.shape[-1], count))
        chunk = max(1, GATHERED // 4 ** len(self.varying))
        for first in range(0, count, chunk):
            here = slice(first, first + chunk)
            found[..., here] = self._chunk(at[:, here], by)
        return found

    @cached_property
    def varying(self) -> tuple[int, ...]:
        """Axes of several nodes."""
        return tuple(k for k, nodes in enumerate(self.axes) if len(nodes) > 1)

    @cached_property
    def kept(self) -> list[int]:
        """Places of the derivatives by axes that vary."""
        fixed = sum(1 << (len(self.axes) - 1 - k) for k in range(len(self.axes))
                    if k not in self.varying)  # fmt: skip
        return [d for d in range(2 ** len(self.axes)) if not d & fixed]

    @cached_property
    def _of_nodes(self) -> np.ndarray:
        """Derivatives by axes that vary, shape (nodes, 2**n, m)."""
        shape = self.coefficients.shape
        return np.ascontiguousarray(
            self.coefficients.reshape(-1, *shape[-2:])[:, self.kept]
        )  # fmt: skip

    @cached_property
    def _strides(self) -> np.ndarray:
        """Nodes between neighbours along each axis that varies."""
        counts = [len(self.axes[k]) for k in self.varying]
        return np.array([int(np.prod(counts[k + 1 :])) for k in range(len(counts))], int)

    @cached_property
    def _corners(self) -> np.ndarray:
        """Nodes from the first corner of a cell to each."""
        return sum(np.ix_(*([0, n] for n in self._strides)), np.zeros((), int)).ravel()

    def _chunk(self, at: np.ndarray, by: tuple[int | None, ...]) -> np.ndarray:
        axes = [self.axes[k] for k in self.varying]
        cells = np.array([cell_of(nodes, x) for nodes, x in zip(axes, at, strict=True)])
        left = np.array([nodes[cell] for nodes, cell in zip(axes, cells, strict=True)])
        right = np.array([nodes[cell + 1] for nodes, cell in zip(axes, cells, strict=True)])
        width = right - left
        t = np.minimum(np.maximum((at - left) / width, 0.0), 1.0)
        value, first = cubics(t, width), self._strides @ cells
        slope = slopes(t, width) if any(k in self.varying for k in by) else value
        nodes = self._of_nodes[first[:, None] + self._corners]
        found = np.zeros((len(by), nodes.shape[-1], at.shape[1]))
        for place, axis in enumerate(by):
            if axis is None or axis in self.varying:
                weights = [slope[k] if axis == one else value[k]
                           for k, one in enumerate(self.varying)]  # fmt: skip
                found[place] = np.einsum("pcd,pcdm->mp", product_of(weights), nodes)
        return found


def cell_of(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The interval between nodes in which each point lies, the outermost one outside."""
    return nodes[1:-1].searchsorted(x, side="right")


def cubics(t: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Weights of value and slope at either end, shape (..., end, value or slope)."""
    rest = 1.0 - t
    inner = t * rest
    bend = inner * (t - rest)  # t (1 - t) (2 t - 1)
    weights = np.array([rest - bend, width * rest * inner, t + bend, -width * t * inner])
    return np.moveaxis(weights, 0, -1).reshape(*t.shape, 2, 2)


def slopes(t: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Derivatives of `cubics` by the coordinate."""
    rest = 1.0 - t
    rise = 6.0 * t * rest / width
    weights = np.array([-rise, rest * (1.0 - 3.0 * t), rise, t * (3.0 * t - 2.0)])
    return np.moveaxis(weights, 0, -1).reshape(*t.shape, 2, 2)


def product_of(weights: list[np.ndarray]) -> np.ndarray:
    """Weights of all corners and derivatives of a cell, of those (P, 2, 2) along each axis."""
    found = weights[0]
    for one in weights[1:]:
        number, corners, _ = found.shape
        outer = found[:, :, None, :, None] * one[:, None, :, None, :]
        found = outer.reshape(number, 2 * corners, 2 * corners)
    return found
