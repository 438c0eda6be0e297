"""Piecewise cubic Hermite interpolation in any dimension, on arrays and at one point.

With arrays of one point NumPy needs a microsecond for each of some hundred operations.
`SinglePointLaw` computes with numbers, and only the sum over the nodes of a cell with arrays.
Formulas and results agree with `CreepTable`; it returns no result for a point that needs more care
(separated bodies, infinite creepages, values outside the table), which `CreepTable` evaluates or
refuses.
"""

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, hypot, isfinite, isqrt, log, pi, sin, sqrt
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.lookup.coordinates import MIN_RADIUS, NAMES, POLE, RATIO, SPIN, unit_radius


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


class Point(NamedTuple):
    """A point in the coordinates of a table.

    Attributes
    ----------
    at : tuple of float
        Position on all axes.
    r, tangent, r0 : float
        Length of the scaled creepages, length without spin, and `unit_radius`.
    signs, unit, scale : tuple of float
        Signs of the forces by symmetry, their units, and the units of creepages.
    """

    at: tuple[float, ...]
    r: float
    tangent: float
    r0: float
    signs: tuple[float, float, float]
    unit: tuple[float, float, float]
    scale: tuple[float, float, float]


class SinglePointLaw:
    """The law of a table at single points.

    Parameters
    ----------
    law : Hermite
        The law.
    names : tuple of str
        Axes besides creepages.
    apart : tuple of str
        Axes without interpolation.
    full_range : bool
        Whether the table has all creepages.
    """

    def __init__(
        self, law: Hermite, names: tuple[str, ...], apart: tuple[str, ...], full_range: bool
    ):
        self._varying = law.varying
        self._nodes = [law.axes[k].tolist() for k in law.varying]
        self._strides, self._corners = law.strides.tolist(), law.corners
        data = law.node_values
        self._data = data.reshape(len(data), -1, data.shape[-1])
        self._limits = {
            name: (float(nodes[0]), float(nodes[-1]))
            for name, nodes in zip(names, law.axes, strict=False)
        }
        self._apart, self._full_range = apart, full_range

    def locate(
        self,
        creepages: tuple[float, float, float],
        contact: tuple[float, float, float, float, float],
        along: Mapping[str, float],
    ) -> Point | None:
        """Return the point of creepages and a contact; None if arrays must be used.

        Parameters
        ----------
        creepages, contact : tuple of float
            (xi_x, xi_y, spin), and (a, b, load, mu, shear).
        along : mapping of str to float
            Values on the axes of the table.
        """
        a, b, load, mu, shear = contact
        if self._apart or not all(value > 0.0 and isfinite(value) for value in contact):
            return None
        values = {RATIO: log(a / b)} | dict(along)
        for name, (low, high) in self._limits.items():
            if not low <= values[name] <= high:
                return None
        c, bound = sqrt(a * b), mu * load
        scale = shear * (c * c) / bound
        scales = scale, scale, scale * c
        w1, w2, w3 = (xi * unit for xi, unit in zip(creepages, scales, strict=True))
        if not isfinite(w1 + w2 + w3):
            return None
        mirrored = w3 < 0.0 and not self._full_range
        reverse = -1.0 if w1 < 0.0 and not self._full_range else 1.0
        mirror = -1.0 if mirrored else 1.0
        # Adding 0 turns -0 into 0: for -0, atan2 would return a heading of pi.
        x, y, kappa = reverse * w1 + 0.0, mirror * w2 + 0.0, mirror * w3 * SPIN
        tangent, r0 = hypot(x, y), float(unit_radius(a / b))
        r = hypot(tangent, kappa)
        at = (
            *(values[name] for name in self._limits),
            atan2(y, x),
            atan2(kappa, tangent),
            r / (r + r0),
        )
        signs = reverse, mirror, mirror
        return Point(at, r, tangent, r0, signs, (bound, bound, bound * c), scales)

    def forces(self, point: Point) -> tuple[float, float, float]:
        """Return (Q_x, Q_y, M_z) at a point, N and N mm."""
        law = self._law(point.at)
        Qx, Qy, Mz = (u * s * f for u, s, f in zip(point.unit, point.signs, law, strict=True))
        return Qx, Qy, Mz

    def gradient(self, point: Point) -> np.ndarray:
        """Return the derivatives of forces by creepages, shape (3, 3); see `Coordinates`."""
        first = len(point.at) - len(NAMES)
        heading, tilt, u = point.at[first:]
        limit = 0.5 * pi - POLE
        r, r0 = point.r, point.r0
        tangent = max(point.tangent, POLE * r)
        if r <= MIN_RADIUS * r0:
            r = tangent = MIN_RADIUS * r0
        at = (*point.at[:first], heading, min(max(tilt, -limit), limit), max(u, MIN_RADIUS))
        ch, sh, ct, st = cos(heading), sin(heading), cos(tilt), sin(tilt)
        stretch = r0 / (r + r0) ** 2
        by_creepages = np.array(
            [
                [-sh / tangent, ch / tangent, 0.0],
                [-st * ch / r, -st * sh / r, SPIN * ct / r],
                [stretch * ct * ch, stretch * ct * sh, SPIN * stretch * st],
            ]
        )
        slopes = np.array([self._law(at, first + k) for k in range(len(NAMES))])
        signs = np.array(point.signs)
        rows = (signs * point.unit)[:, None] * (slopes.T @ by_creepages)
        gradient: np.ndarray = rows * (signs * point.scale)
        return gradient

    def _law(self, at: tuple[float, ...], by: int | None = None) -> list[float]:
        """Return the interpolated values at a position, or their derivatives by an axis."""
        first, halves, middle = 0, [[1.0], [1.0]], (len(self._varying) + 1) // 2
        for k, (axis, nodes, stride) in enumerate(
            zip(self._varying, self._nodes, self._strides, strict=True)
        ):
            cell = bisect_right(nodes, at[axis], 1, len(nodes) - 1) - 1
            first += cell * stride
            width = nodes[cell + 1] - nodes[cell]
            t = min(max((at[axis] - nodes[cell]) / width, 0.0), 1.0)
            weights = _slopes(t, width) if axis == by else _cubics(t, width)
            half = 0 if k < middle else 1
            halves[half] = _kronecker(halves[half], weights)
        left, right = (np.array(half) for half in halves)
        n, m = (isqrt(half.size) for half in (left, right))
        product = left.reshape(n, 1, n, 1) * right.reshape(1, m, 1, m)
        nodes = self._data[first + self._corners].reshape(-1, self._data.shape[-1])
        values: list[float] = (product.reshape(-1) @ nodes).tolist()
        return values


def _cubics(t: float, width: float) -> tuple[float, float, float, float]:
    """Return the weights of value and slope at the left end, then at the right end."""
    rest = 1.0 - t
    inner = t * rest
    bend = inner * (t - rest)
    return rest - bend, width * rest * inner, t + bend, -width * t * inner


def _slopes(t: float, width: float) -> tuple[float, float, float, float]:
    """Return the derivatives of `_cubics` by the coordinate."""
    rest = 1.0 - t
    rise = 6.0 * t * rest / width
    return -rise, rest * (1.0 - 3.0 * t), rise, t * (3.0 * t - 2.0)


def _kronecker(matrix: list[float], factors: tuple[float, float, float, float]) -> list[float]:
    """Return the Kronecker product of a square matrix and a 2 x 2 matrix, row by row."""
    n = isqrt(len(matrix))
    a, b, c, d = factors
    product: list[float] = []
    for k in range(0, n * n, n):
        row = matrix[k : k + n]
        product += [value for x in row for value in (x * a, x * b)]
        product += [value for x in row for value in (x * c, x * d)]
    return product
