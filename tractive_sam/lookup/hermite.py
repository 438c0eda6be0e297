"""Piecewise cubic Hermite interpolation on a grid of any dimension, once differentiable."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class Hermite:
    """Piecewise cubic interpolation of values and derivatives at the nodes of a grid.

    The interpolant of a cell is the product of Hermite cubics along each axis: values and first
    derivatives are continuous. Values do not depend on an axis with one node.

    Parameters
    ----------
    axes : sequence of ndarray
        Ascending nodes along each axis.
    coefficients : ndarray, shape (n_1, ..., n_N, 2**N, m)
        Derivatives at each node: bit k of the index among the 2**N, the highest bit for the first
        axis, is set for the first derivative by the axis k.
    """

    axes: tuple[np.ndarray, ...]
    coefficients: np.ndarray
    chunk: ClassVar[int] = 2**18
    """Number of weights computed at once: they fit into the cache."""

    def __call__(self, points: Sequence[ArrayLike], by: int | None = None) -> np.ndarray:
        """Return the values at points, or their derivative by an axis.

        Parameters
        ----------
        points : sequence of array_like, shape (P,)
            A coordinate along each axis; points outside are moved to the edge.
        by : int, optional
            Axis.

        Returns
        -------
        ndarray, shape (m, P)
        """
        return self.parts(points, (by,))[0]

    def parts(self, points: Sequence[ArrayLike], by: Iterable[int | None]) -> np.ndarray:
        """Return several derivatives at each point, shape (len(by), m, P); see `__call__`."""
        by = tuple(by)
        at = np.array([np.asarray(points[k], float) for k in self.varying])
        count = np.shape(points[0])[0]
        values = np.empty((len(by), self.coefficients.shape[-1], count))
        chunk = max(1, self.chunk // 4 ** len(self.varying))
        for first in range(0, count, chunk):
            part = slice(first, first + chunk)
            values[..., part] = self._interpolate(at[:, part], by)
        return values

    @cached_property
    def varying(self) -> tuple[int, ...]:
        """Axes with several nodes."""
        return tuple(k for k, nodes in enumerate(self.axes) if len(nodes) > 1)

    @cached_property
    def derivative_indices(self) -> list[int]:
        """Indices of the derivatives by axes with several nodes."""
        fixed = sum(1 << (len(self.axes) - 1 - k) for k in range(len(self.axes))
                    if k not in self.varying)  # fmt: skip
        return [d for d in range(2 ** len(self.axes)) if not d & fixed]

    @cached_property
    def node_values(self) -> np.ndarray:
        """Derivatives by axes with several nodes, shape (nodes, 2**n, m)."""
        shape = self.coefficients.shape
        return np.ascontiguousarray(
            self.coefficients.reshape(-1, *shape[-2:])[:, self.derivative_indices]
        )  # fmt: skip

    @cached_property
    def strides(self) -> np.ndarray:
        """Number of nodes between neighbours along each axis with several nodes."""
        counts = [len(self.axes[k]) for k in self.varying]
        return np.array([int(np.prod(counts[k + 1 :])) for k in range(len(counts))], int)

    @cached_property
    def corners(self) -> np.ndarray:
        """Number of nodes from the first corner of a cell to each corner."""
        return sum(np.ix_(*([0, n] for n in self.strides)), np.zeros((), int)).ravel()

    def _interpolate(self, at: np.ndarray, by: tuple[int | None, ...]) -> np.ndarray:
        """Return the derivatives at points (axes, P), shape (len(by), m, P)."""
        axes = [self.axes[k] for k in self.varying]
        cells = np.array([cell_of(nodes, x) for nodes, x in zip(axes, at, strict=True)])
        left = np.array([nodes[cell] for nodes, cell in zip(axes, cells, strict=True)])
        right = np.array([nodes[cell + 1] for nodes, cell in zip(axes, cells, strict=True)])
        width = right - left
        t = np.minimum(np.maximum((at - left) / width, 0.0), 1.0)
        value, first = cubics(t, width), self.strides @ cells
        slope = slopes(t, width) if any(k in self.varying for k in by) else value
        nodes = self.node_values[first[:, None] + self.corners]
        values = np.zeros((len(by), nodes.shape[-1], at.shape[1]))
        for place, axis in enumerate(by):
            if axis is None or axis in self.varying:
                weights = [slope[k] if axis == varying_axis else value[k]
                           for k, varying_axis in enumerate(self.varying)]  # fmt: skip
                values[place] = np.einsum("pcd,pcdm->mp", _multiply_axes(weights), nodes)
        return values


def cell_of(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the interval between nodes of each point; the first or last one for points outside."""
    return nodes[1:-1].searchsorted(x, side="right")


def cubics(t: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Return the weights of value and slope at both ends, shape (..., end, value or slope)."""
    rest = 1.0 - t
    inner = t * rest
    bend = inner * (t - rest)  # t (1 - t) (2 t - 1)
    weights = np.array([rest - bend, width * rest * inner, t + bend, -width * t * inner])
    return np.moveaxis(weights, 0, -1).reshape(*t.shape, 2, 2)


def slopes(t: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Return the derivatives of `cubics` by the coordinate."""
    rest = 1.0 - t
    rise = 6.0 * t * rest / width
    weights = np.array([-rise, rest * (1.0 - 3.0 * t), rise, t * (3.0 * t - 2.0)])
    return np.moveaxis(weights, 0, -1).reshape(*t.shape, 2, 2)


def _multiply_axes(weights: list[np.ndarray]) -> np.ndarray:
    """Return the weights of all corners and derivatives of a cell from those along each axis."""
    product = weights[0]
    for along_axis in weights[1:]:
        number, corners, _ = product.shape
        outer = product[:, :, None, :, None] * along_axis[:, None, :, None, :]
        product = outer.reshape(number, 2 * corners, 2 * corners)
    return product
