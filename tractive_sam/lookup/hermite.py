"""Bounded coordinates of creepages, and piecewise cubic Hermite interpolation in them.

With arrays of one point NumPy needs a microsecond for each of some hundred operations.
`SinglePointLaw` computes with numbers, and only the sum over the nodes of a cell with arrays.
Formulas and results agree with `CreepTable`; it returns no result for a point that needs more care
(separated bodies, infinite creepages, values outside the table), which `CreepTable` evaluates or
refuses.

With c = sqrt(a b) the forces over mu P of a Hertz contact of equal materials depend only on a/b,
Poisson's ratio and the scaled creepages

    w = G c² / (mu P) (xi_x, xi_y, c phi).

With kappa = w_3/2 the coordinates are

    r       = sqrt(w_1² + w_2² + kappa²)
    u       = r / (r + r_0),  r_0 = 2 / (3.2 + 0.9 a/b)     0 at rest, 1 in full slip: r infinite
    heading = atan2(w_2, w_1)                               -pi/2 to pi/2, as w_1 >= 0
    tilt    = atan2(kappa, sqrt(w_1² + w_2²))               0 to pi/2, as w_3 >= 0

3.2 + 0.9 a/b is near Kalker's C11: full slip begins at u of about 0.6 for any a/b. Mirrored at the
plane y = 0, (w_1, -w_2, -w_3) gives (Q_x, -Q_y, -M_z). Reversed creepages reverse all forces, and
(-w_1, w_2, w_3) gives (-Q_x, Q_y, M_z).

The table of a contact without a symmetry is a full one, with headings from -pi to pi and tilts from
-pi/2 to pi/2. Dissimilar bodies have no symmetry for reversed creepages, oblique axes of friction
or a gap have none for the mirror image.
"""

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, hypot, isfinite, isqrt, log, pi, sin, sqrt
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

MIRROR = np.array([1.0, -1.0, -1.0])
"""Signs of creepages and of forces if y is mirrored."""

REVERSED = np.array([-1.0, 1.0, 1.0])
"""Signs if y is mirrored and all creepages are reversed."""

NAMES = ("heading", "tilt", "u")

RATIO = "log_ratio"
"""Name of the axis ln(a/b), in tables of any Hertz contact."""

CONTACT = ("a", "b", "load", "mu", "shear")
"""Properties of a contact that scale its forces."""

SPIN = 0.5
"""Weight of scaled spin relative to scaled creepages."""

MIN_RADIUS, POLE = 1e-9, 1e-6
"""Smallest r over r_0 and smallest cosine of the tilt at which slopes are evaluated."""


def unit_radius(ratio: Any) -> Any:
    """Return r_0, the length of scaled creepages at u = 1/2, for the ratio a/b of the semi-axes."""
    return 2.0 / (3.2 + 0.9 * ratio)


def creepages_at(ratio: float, heading: float, tilt: float, u: float) -> np.ndarray:
    """Return the scaled creepages w at given coordinates; for u = 1 only their direction."""
    r = 1.0 if u == 1.0 else unit_radius(ratio) * u / (1.0 - u)
    t = r * np.cos(tilt)
    return np.array([t * np.cos(heading), t * np.sin(heading), r * np.sin(tilt) / SPIN])


def creepages_by_coordinates(ratio: float, heading: float, tilt: float, u: float) -> np.ndarray:
    """Return the derivatives of the scaled creepages w (rows) by heading, tilt and u (columns).

    For the ratio a/b of the semi-axes and u < 1; shape (3, 3). The module defines the coordinates.
    """
    r0 = unit_radius(ratio)
    r, stretch = r0 * u / (1.0 - u), r0 / (1.0 - u) ** 2
    ch, sh, ct, st = np.cos(heading), np.sin(heading), np.cos(tilt), np.sin(tilt)
    return np.array(
        [
            [-r * ct * sh, -r * st * ch, stretch * ct * ch],
            [r * ct * ch, -r * st * sh, stretch * ct * sh],
            [0.0, r * ct / SPIN, stretch * st / SPIN],
        ]
    )


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Scaled creepages times the signs that bring them into a table, with (heading, tilt, u).

    Attributes
    ----------
    w : ndarray, shape (3, P)
        Scaled creepages times `signs`; for full slip their direction.
    signs : ndarray, shape (3, P)
        Signs of (w_1, w_2, w_3) and of (Q_x, Q_y, M_z).
    r0 : ndarray, shape (P,)
        `unit_radius`.
    full : ndarray of bool, shape (P,)
        Whether a creepage is infinite.
    """

    w: np.ndarray
    signs: np.ndarray
    r0: np.ndarray
    full: np.ndarray

    @classmethod
    def of(cls, w: np.ndarray, ratio: np.ndarray, full_range: bool = False) -> "Coordinates":
        """Return the coordinates of scaled creepages (3, P); one of the three may be infinite.

        Parameters
        ----------
        w : ndarray, shape (3, P)
            Scaled creepages.
        ratio : ndarray, shape (P,)
            a/b.
        full_range : bool
            Whether the table has all headings and tilts, without symmetries.

        Raises
        ------
        ValueError
            If a creepage is nan, or several are infinite.
        """
        full = np.zeros(w.shape[1], bool)
        if not np.isfinite(w).all():
            w, full = _directions(w)
        signs = np.ones_like(w)
        if not full_range:
            signs = np.where(w[2] < 0.0, MIRROR[:, None], signs)
            signs = np.where(w[0] < 0.0, REVERSED[:, None] * signs, signs)
        # + 0 removes -0, for which atan2 would give a heading of pi.
        return cls(signs * w + 0.0, signs, unit_radius(ratio), full)

    @cached_property
    def _polar(self) -> tuple[np.ndarray, ...]:
        """(w_1, w_2), kappa, the size of (w_1, w_2), and r."""
        x, y, kappa = self.w[0], self.w[1], SPIN * self.w[2]
        # Squares of huge creepages would overflow: hypot does not.
        t = np.hypot(x, y)
        return x, y, kappa, t, np.hypot(t, kappa)

    @cached_property
    def points(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Heading, tilt and u, each of shape (P,)."""
        x, y, kappa, t, r = self._polar
        u = np.where(self.full, 1.0, r / (r + self.r0))
        return np.arctan2(y, x), np.arctan2(kappa, t), u

    @property
    def points_of_slopes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Heading, tilt and u, shifted from rest and pure spin, at which slopes are undefined."""
        heading, tilt, u = self.points
        limit = 0.5 * np.pi - POLE
        return heading, np.minimum(np.maximum(tilt, -limit), limit), np.maximum(u, MIN_RADIUS)

    @property
    def by_creepages(self) -> np.ndarray:
        """Derivatives of (heading, tilt, u) by the given w, shape (3, 3, P); zero in full slip."""
        (heading, tilt, _), r0 = self.points, self.r0
        *_, t, r = self._polar
        t, rest = np.maximum(t, POLE * r), r <= MIN_RADIUS * r0
        r, t = np.where(rest, MIN_RADIUS * r0, r), np.where(rest, MIN_RADIUS * r0, t)
        ch, sh = np.cos(heading), np.sin(heading)
        ct, st = np.cos(tilt), np.sin(tilt)
        none = np.zeros_like(r)
        stretch = r0 / (r + r0) / (r + r0)
        by = np.array(
            [
                [-sh / t, ch / t, none],
                [-st * ch / r, -st * sh / r, SPIN * ct / r],
                [stretch * ct * ch, stretch * ct * sh, SPIN * stretch * st],
            ]
        )
        return np.where(self.full, 0.0, by) * self.signs


def _directions(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return creepages with infinite ones replaced by their direction, and their places."""
    if np.isnan(w).any():
        raise ValueError("creepages: nan; allowed: numbers")
    is_infinite = np.isinf(w)
    if (is_infinite.sum(axis=0) > 1).any():
        raise ValueError("creepages: several are infinite; allowed: at most one")
    full = is_infinite.any(axis=0)
    return np.where(full, np.where(is_infinite, np.sign(w), 0.0), w), full


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
