"""Piecewise cubic Hermite interpolation on a grid of any dimension, once differentiable."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

CHUNK = 4096
"""Points at once: what is gathered for them stays in the cache."""


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
        at = np.stack([np.asarray(one, float) for one in points])
        found = np.empty((self.coefficients.shape[-1], at.shape[1]))
        for first in range(0, at.shape[1], CHUNK):
            here = slice(first, first + CHUNK)
            found[:, here] = self._chunk(at[:, here], by)
        return found

    def _chunk(self, at: np.ndarray, by: int | None) -> np.ndarray:
        if by is not None and len(self.axes[by]) == 1:
            return np.zeros((self.coefficients.shape[-1], at.shape[1]))
        cells, weights = [], []
        for k, (nodes, x) in enumerate(zip(self.axes, at, strict=True)):
            cell = cell_of(nodes, x)
            cells.append(cell)
            if len(nodes) == 1:
                weights.append(np.stack([np.ones_like(x), np.zeros_like(x)])[None])
                continue
            width = nodes[cell + 1] - nodes[cell]
            t = np.clip((x - nodes[cell]) / width, 0.0, 1.0)
            weights.append((slopes if by == k else cubics)(t, width))
        shape = self.coefficients.shape
        flat = self.coefficients.reshape(-1, *shape[-2:])
        found = np.zeros((at.shape[1], shape[-1]))
        for corner in product(*(range(len(w)) for w in weights)):
            place = np.zeros(at.shape[1], int)
            weight = np.ones((1, at.shape[1]))
            for cell, side, w, count in zip(cells, corner, weights, shape, strict=False):
                place = place * count + cell + side
                weight = (weight[:, None] * w[side]).reshape(-1, at.shape[1])
            found += np.einsum("dp,pdm->pm", weight, flat[place])
        return found.T


def cell_of(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The interval between nodes in which each point lies, the outermost one outside."""
    return np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, max(len(nodes) - 2, 0))


def cubics(t: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Weights of value and slope at either end, shape (end, value or slope, P)."""
    rest = 1.0 - t
    return np.array(
        [
            [rest * rest * (1.0 + 2.0 * t), width * t * rest * rest],
            [t * t * (3.0 - 2.0 * t), -width * t * t * rest],
        ]
    )


def slopes(t: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Derivatives of `cubics` by the coordinate."""
    rise = 6.0 * t * (1.0 - t) / width
    return np.array([[-rise, (1.0 - t) * (1.0 - 3.0 * t)], [rise, t * (3.0 * t - 2.0)]])
