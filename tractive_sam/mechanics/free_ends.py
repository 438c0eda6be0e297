"""Bodies of finite width with free ends: what the ends add to the displacement of half-spaces.

The body is |y| < h, z > 0, with no traction on its faces y = +-h. A pressure p_eff on its top and
its mirror images in both faces leave only normal stress on the faces, and so do pressures s_eff on
the faces, mirrored in z = 0, on the top (Hetenyi 1960, J. Appl. Mech. 27, 289-296):

    p_eff + R s_eff = p,    s_eff + K p_eff = 0.

Pressures on the faces do not move the top along z, so that u = G p_eff, with G the half-space with
all mirror images. With H, the displacement of the faces by s_eff, reciprocity gives G R = K^T H and

    u = G p + K^T (H^-1 - K G^-1 K^T)^-1 K p.

For a wave exp(i k x), pressures on the top are sums of modes cos(m pi y/h) and sin((m + 1/2) pi
y/h), and those on the faces integrals of cos(q z). G and H are diagonal, K has a closed form, and
the second term is symmetric and positive. The corner makes s_eff decay like log(q)/q^2: a few nodes
for each decade of q, which correspond to rows graded towards the corner, are exact to 1e-5, and the
remaining matrix is so small that it is factorised in place of an iteration.

What the ends add is smooth along y except near the corner, and smooth in log(k): it is computed for
some rows and waves, and interpolated between them. Far away, a body of finite width is a plate, in
which the displacement is a logarithm of the distance. As in line contacts, it is counted from
points at a distance, the datum.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import ClassVar

import numpy as np

from tractive_sam.mechanics.elasticity import HalfSpaces


@dataclass(frozen=True, eq=False)
class EndResponse:
    """Linear map from the pressure on a mesh to the displacement that free ends add.

    Attributes
    ----------
    table : ndarray, shape (n_x or more, m, m)
        Displacement of m rows by the pressure on them at offsets in x, mm/MPa.
    seen, loaded : ndarray, shape (m, n_y)
        Share of these rows in the displacement, and in the pressure, of the rows of the mesh.
    columns : int
        Number of columns, n_x.
    """

    table: np.ndarray
    seen: np.ndarray
    loaded: np.ndarray
    columns: int

    def __post_init__(self) -> None:
        # Frozen: the spectrum along x, even in the offset, is computed once.
        n = self.columns
        period = 2 * n
        full = np.zeros((period, *self.table.shape[1:]))
        full[:n] = self.table[:n]
        full[n + 1 :] = self.table[1:n][::-1]
        object.__setattr__(self, "_spectrum", np.fft.rfft(full, axis=0).real)

    def __call__(self, pressure: np.ndarray) -> np.ndarray:
        """Return the displacement, mm, of elements under a pressure (n_x, n_y), MPa."""
        n = self.columns
        loads = np.fft.rfft(pressure @ self.loaded.T, 2 * n, axis=0)
        pairs = np.stack((loads.real, loads.imag), axis=2)
        moved = self._spectrum @ pairs  # type: ignore[attr-defined]
        answer = np.fft.irfft(moved[..., 0] + 1j * moved[..., 1], 2 * n, axis=0)[:n]
        return np.asarray(answer @ self.seen)

    def part(self, columns: int, rows: slice, mirrored: int | None = None) -> "EndResponse":
        """Return the map on some columns and rows.

        Parameters
        ----------
        columns : int
            Number of columns.
        rows : slice
            Rows.
        mirrored : int, optional
            Sum of the indices of two rows that have the same pressure, of symmetric fields whose
            upper half the rows are.
        """
        loaded = self.loaded[:, rows]
        if mirrored is not None:
            other = mirrored - np.arange(self.seen.shape[1])[rows]
            below = (other >= 0) & (other < rows.start)
            loaded = loaded + np.where(below, self.loaded[:, np.maximum(other, 0)], 0.0)
        return EndResponse(self.table, self.seen[:, rows], loaded, columns)

    def coarsened(self, shape: tuple[int, int], block: tuple[int, int]) -> "EndResponse":
        """Return the map on elements that combine `block` elements of this one."""
        table, (columns, rows), (along, across) = self.table, shape, block
        if along == 2:
            far = table[-1:] if len(table) % 2 else table[:0]
            even = np.concatenate((table, far, table[-1:]))
            before = np.concatenate((even[1:2], even[1:-2:2]))[:columns]
            table = 0.5 * (before + even[1::2][:columns]) + even[::2][:columns]
        wide = np.pad(self.seen, ((0, 0), (0, across * rows - self.seen.shape[1])), mode="edge")
        last = np.pad(self.loaded, ((0, 0), (0, across * rows - self.seen.shape[1])))
        seen = wide.reshape(len(wide), rows, across).mean(axis=2)
        loaded = last.reshape(len(last), rows, across).sum(axis=2)
        return EndResponse(table, seen, loaded, columns)


@dataclass(frozen=True)
class FreeEnds(HalfSpaces):
    """Elasticity of two bodies; one or both have free ends.

    The ends act on pressure and normal displacement. Tractions, and what dissimilar bodies do to
    each other's tractions and gaps, act as on half-spaces.

    Parameters
    ----------
    A, B : Material
        See `HalfSpaces`.
    widths : (float, float)
        Width of each body, mm; infinite for a half-space.
    quick : (bool, bool)
        Whether a factor on mirror images stands for the ends of each body.
    datum : float
        Distance at which the displacement by the far field of the ends is zero, mm.
    """

    widths: tuple[float, float] = (math.inf, math.inf)
    quick: tuple[bool, bool] = (False, False)
    datum: float = 0.0

    def spanning(self, length: float) -> "FreeEnds":
        """Return the bodies with a datum of at least twice the length of the mesh, mm."""
        return replace(self, datum=max(self.datum, 2.0 * length))

    def ends_on(
        self, shape: tuple[int, int], dx: float, dy: float, first: float
    ) -> EndResponse | None:
        """Return what the ends add to the normal displacement on a mesh, mm/MPa.

        Parameters as in `Elasticity.ends_on`.
        """
        return _find_response(self, shape, dx, dy, first)


@lru_cache(8)
def _find_response(
    law: FreeEnds, shape: tuple[int, int], dx: float, dy: float, first: float
) -> EndResponse:
    """Return what the ends of two bodies add on a mesh; see `FreeEnds.ends_on`."""
    compliances: dict[tuple[float, float, bool], float] = {}
    for m, width, quick in zip((law.A, law.B), law.widths, law.quick, strict=True):
        if math.isfinite(width) and math.isfinite(m.shear):
            alike = width, m.poisson, quick
            compliances[alike] = compliances.get(alike, 0.0) + 0.5 * (1.0 - m.poisson) / m.shear
    widths = [width for width, _, _ in compliances]
    widest = max(widths)
    inside = np.flatnonzero(np.abs(first + dy * np.arange(shape[1])) < 0.5 * widest)
    y = first + dy * inside
    chosen, share = _choose_rows(y, dy, widths)
    waves, weights = _find_waves(shape[0] + 1, dx, widest, max(law.datum, 2.0 * widest))
    table = np.zeros((len(waves), len(chosen), len(chosen)))
    for (width, poisson, quick), compliance in compliances.items():
        own = np.abs(y[chosen]) < 0.5 * width
        factor = quick and find_quick_factor(poisson)
        body = _Plate(0.5 * width, poisson, factor, y[chosen[own]], dy)
        for k, wave in enumerate(waves):
            for rows, factors in body.parts(wave):
                at = np.flatnonzero(own)[rows]
                table[k, at[:, None], at] += compliance * factors.T @ factors
    seen = np.zeros((len(chosen), shape[1]))
    seen[:, inside] = share
    return EndResponse(np.tensordot(weights, table, axes=1), seen, seen, shape[0])


def find_quick_factor(poisson: float) -> float:
    """Return the factor on mirror images that stands for free ends.

    Source: Guilbault (2011), J. Tribology 133, 031402.
    """
    return 1.29 - (0.08 - 0.5 * poisson) / (1.0 - poisson)


def _choose_rows(y: np.ndarray, dy: float, widths: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return indices of rows, denser towards the faces, and interpolation from them, (m, n)."""
    distance = np.min([np.abs(np.abs(y) - 0.5 * width) for width in widths], axis=0)
    # Rows are a sixth of their distance from the nearest face apart.
    passed = np.cumsum(1.0 / np.maximum(1.0, distance / (6.0 * dy)))
    rows = np.flatnonzero(np.diff(np.floor(passed), prepend=-1.0) > 0.0)
    rows = np.union1d(rows, [0, len(y) - 1])
    rows = np.union1d(rows[2 * rows < len(y)], len(y) - 1 - rows[2 * rows < len(y)])  # symmetric
    chosen, share = rows, np.zeros((len(rows), len(y)))
    order = min(6, len(rows))
    for i in range(len(y)):
        start = min(max(int(np.searchsorted(chosen, i)) - order // 2, 0), len(rows) - order)
        near = chosen[start : start + order]
        for a, node in enumerate(near):
            others = np.delete(near, a)
            share[start + a, i] = np.prod((i - others) / (node - others))
    return chosen, share


def _find_waves(
    offsets: int, dx: float, width: float, datum: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return wave numbers along x, 1/mm, and their weights in the response at offsets.

    The response to a wave times its wave number is smooth in the logarithm of the latter: it is
    interpolated between eight waves in each of some intervals, and integrated with the cosine. They
    begin where the body is a plate in plane stress, and end with waves shorter than an element.
    """
    x = dx * np.arange(offsets)
    start, most = 0.02 / max(x[-1], width), 6.0 * np.pi / min(dx, 0.3 * width)
    edges = np.geomspace(start, most, 2 + int(math.log(most / start) / 2.8))
    # Below, the response is c/k + log(k); its integral begins at exp(-gamma)/datum.
    start /= 512.0
    edges = np.append(start, edges)
    points, _ = np.polynomial.legendre.leggauss(8)
    inverse = np.linalg.inv(np.polynomial.legendre.legvander(points, 7))
    waves, weights = [], []
    for low, high in pairwise(edges):
        middle, half = 0.5 * math.log(high * low), 0.5 * math.log(high / low)
        fine = np.linspace(low, high, 2 + int((high - low) * x[-1] / (3.0 * np.pi)))
        k, weight = _place_nodes(fine if len(fine) > 3 else np.geomspace(low, high, 4), 8)
        share = np.polynomial.legendre.legvander((np.log(k) - middle) / half, 7) @ inverse
        nodes = np.exp(middle + half * points)
        along = np.cos(x[:, None] * k) * weight * np.sinc(0.5 * k * dx / np.pi) / k
        waves.append(nodes)
        weights.append(dx / np.pi * along @ (share * nodes))
    weights[0][:, 0] += dx / np.pi * waves[0][0] * (math.log(start * datum) + np.euler_gamma)
    return np.concatenate(waves), np.concatenate(weights, axis=1)


def _place_nodes(edges: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss points and weights, `count` in each interval."""
    points, weights = _gauss_points(count)
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1.0 + points)).ravel(), (half * weights).ravel()


_gauss_points = lru_cache(4)(np.polynomial.legendre.leggauss)


class _Plate:
    """A body of E* = 1 in one wave along x.

    Parameters
    ----------
    half : float
        Half of its width, mm.
    poisson : float
        Poisson's ratio.
    quick : float
        Factor on mirror images that stands for free ends; 0 for free ends.
    y : ndarray, shape (n,)
        Rows, mm.
    dy : float
        Side of a row, mm.
    """

    apart: ClassVar[float] = 10.0
    """Half width, in units of 1/k, from which the faces do not influence each other."""

    def __init__(self, half: float, poisson: float, quick: float, y: np.ndarray, dy: float):
        self.half, self.poisson, self.quick, self.y, self.dy = half, poisson, quick, y, dy
        self.nearest = max(dy, 0.5 * float((half - np.abs(y)).min() - 0.5 * dy))
        self._shapes: dict[bool, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}

    def parts(self, k: float) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield rows and factors (r, n): they add factors^T factors times the pressure of rows.

        Waves that are short against the width see one end at a time, and only near it.
        """
        if k * self.half <= self.apart:
            distance, side = self.half - np.abs(self.y), np.sign(self.y)
            yield np.arange(len(self.y)), self._factors(k, self.half, distance, False)
            yield np.arange(len(self.y)), side * self._factors(k, self.half, distance, True)
            return
        for distance in (self.half + self.y, self.half - self.y):
            rows = np.flatnonzero(distance < self.apart / k)
            if rows.size:
                factors = self._factors(k, self.apart / k, distance[rows], False)
                yield rows, math.sqrt(2.0) * factors

    def _factors(self, k: float, half: float, distance: np.ndarray, odd: bool) -> np.ndarray:
        """Return factors of mirror images, and of what pressure and images leave on the faces.

        They contain half of the displacement by a pressure on one side.
        """
        dy, sign = self.dy, -1.0 if odd else 1.0
        inner = np.maximum(distance - 0.5 * dy, 0.0)
        # K0(k y) is the integral of exp(-k y cosh t); so are all mirror images together.
        last = math.acosh(max(2.0, 200.0 / (k * max(dy, 2.0 * inner.min()))))
        t = np.linspace(0.0, last, 2 + int(last / 0.7))
        step = np.full(t.size, t[1])
        step[[0, -1]] *= 0.5
        decay = (k * np.cosh(t))[:, None]
        # From middle to middle of rows, as in half-spaces: the mean of one of both.
        near = inner + 0.25 * dy
        images = np.exp(-decay * near) + sign * np.exp(-decay * (2.0 * half - near - 0.5 * dy))
        weight = step[:, None] / (np.pi * (1.0 - sign * np.exp(-2.0 * decay * half)))
        images *= np.sqrt((self.quick or 1.0) * weight * -np.expm1(-decay * dy) / decay)
        if self.quick:
            return images
        q, weight = self._waves_on_face(k, half)
        long, scale = np.hypot(k, q), np.sqrt(2.0 / np.pi * weight)[:, None]
        # Displacement of the faces of a plate that is squeezed or bent; above, of a half-space.
        thick = np.minimum(2.0 * long * half, 300.0)
        finite = np.maximum(thick, 1e-2)
        face = (np.cosh(finite) - sign) / (np.sinh(finite) + sign * finite)
        face = np.where(thick < 1e-2, 12.0 / thick**3 if odd else 0.25 * thick, face) * 2.0 / long
        finest = float(q[-1])
        mode, weight = _find_modes(3.0 * finest * half / np.pi, half * finest)
        across, stress = self._stress(k, half, mode + 0.5 * odd, q)
        size = np.where(across == 0.0, 1.0, 2.0) / half
        stress = scale * stress
        own = (stress * (0.5 * weight * size * np.hypot(k, across))) @ stress.T
        mode, weight, shape = self._shape(half, distance, odd)
        across, stress = self._stress(k, half, mode, q)
        loads = (scale * stress) @ (shape * math.sqrt(0.5 * dy))
        root = np.linalg.cholesky(np.diag(1.0 / face) - own)
        return np.concatenate((images, np.linalg.solve(root, loads)))

    def _waves_on_face(self, k: float, half: float) -> tuple[np.ndarray, np.ndarray]:
        """Return wave numbers along z, 1/mm, graded, and their weights."""
        start, finest = 0.25 * min(k, 1.0 / half), max(20.0 / self.nearest, 20.0 * k)
        edges = np.linspace(
            math.log(start), math.log(finest), 2 + int(math.log(finest / start) / math.log(8.0))
        )
        graded, weight = _place_nodes(edges, 6)
        first, share = _place_nodes(np.array([0.0, start]), 6)
        graded = np.exp(graded)
        return np.append(first, graded), np.append(share, weight * graded)

    def _stress(
        self, k: float, half: float, mode: np.ndarray, q: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return lateral wave numbers of modes and the cosine transform of their stress on faces.

        Modes of pressure leave ((ky/K)^2 (1 - K z) + 2 nu (k/K)^2) exp(-K z), K^2 = k^2 + ky^2.
        """
        across = mode * (np.pi / half)
        total = k * k + across**2
        square = total + (q * q)[:, None]
        share = (2.0 * q * q)[:, None] * (across**2 / np.sqrt(total))
        return across, (share / square + 2.0 * self.poisson * k * k / np.sqrt(total)) / square

    def _shape(
        self, half: float, distance: np.ndarray, odd: bool
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return modes, their weights, and the size of modes in the pressure on a row, (m, n)."""
        known = self._shapes.get(odd) if half == self.half else None
        if known is None:
            last, longest = 10.0 / self.nearest * half / np.pi, float(distance.max())
            mode, weight = _find_modes(last, half / longest)
            mode = mode + 0.5 * odd
            across = mode[:, None] * (np.pi / half)
            size = weight * np.where(mode == 0.0, 1.0, 2.0) / half
            mean = np.sinc(0.5 * across * self.dy / np.pi) * size[:, None]
            known = mode, weight, np.cos(across * distance) * mean
            if half == self.half:
                self._shapes[odd] = known
        return known


def _find_modes(last: float, smooth: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the modes of a sum, and weights; the sum over many becomes an integral.

    Parameters
    ----------
    last : float
        Last mode.
    smooth : float
        Half width over the largest distance in the cosines of the sum.
    """
    exact = 16
    if last < 3 * exact or smooth < 3.0:
        return np.arange(math.ceil(last) + 1.0), np.ones(math.ceil(last) + 1)
    edges = [exact - 0.5]
    while edges[-1] < last:
        edges.append(edges[-1] + min(1.2 * edges[-1], 1.5 * smooth))
    mode, weight = _place_nodes(np.array(edges), 6)
    return np.append(np.arange(float(exact)), mode), np.append(np.ones(exact), weight)
