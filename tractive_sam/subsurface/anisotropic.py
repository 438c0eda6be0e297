"""Stress in anisotropic half-spaces, by antiderivatives over elements.

A wave of traction t exp(i k m.x) causes the stress i W exp(i k z P) K t at the depth z, with the
response K/k of the surface and the matrices P and W of Stroh's formalism, all functions of the
direction m = (cos theta, sin theta) (`AnisotropicMaterial.waves`). The sum over the wave numbers is
an inverse matrix, so that the stress by a unit force is dA/dx + dB/dy with

    A, B = int (cos, sin) i W (m.x + z P)^-1 K dtheta / (2 pi)².

Eigenvalues of P are not needed, and may be equal: the inverse is a polynomial of P over its
characteristic polynomial. At the surface the integrand has poles; the path of theta passes them in
the complex plane, at a distance at which the material's Fourier series still converge. A and B are
smooth functions of the direction from the force, over the distance. Their integrals along the edges
of an element depend on two angles: the logarithms of the ends, and a smooth part whose Chebyshev
coefficients are found once for a material. They hold at all depths, for elements of any sides, and
for strips; so there is neither a period nor a longest wave.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import cast

import numpy as np
from numpy.polynomial import chebyshev

from tractive_sam.mechanics import AnisotropicMaterial, LayeredBody, LinearHalfSpaces
from tractive_sam.subsurface.layered import ElementSums, LayeredStress
from tractive_sam.subsurface.sources import StressSource, stress_source


def _nodes(count: int) -> np.ndarray:
    """Return the zeros of a Chebyshev polynomial."""
    return np.cos(np.pi * (np.arange(count) + 0.5) / count)


def _to_coefficients(count: int) -> np.ndarray:
    """Return the matrix of Chebyshev coefficients by values at `_nodes`."""
    matrix = chebyshev.chebvander(_nodes(count), count - 1).T * (2.0 / count)
    matrix[0] *= 0.5
    return matrix


def _integrate_waves(
    material: AnisotropicMaterial, polar: np.ndarray, harmonics: int
) -> np.ndarray:
    """Return the Fourier coefficients of A and B on a unit hemisphere, times its radius.

    Parameters
    ----------
    material : AnisotropicMaterial
        The material.
    polar : ndarray, shape (n,)
        Angles from the z axis, up to pi/2.
    harmonics : int
        Number of harmonics of the response.

    Returns
    -------
    ndarray of complex, shape (2, n, h, 18)
        The real part of their sum with exp(i h phi) are the stresses by tractions.
    """
    count = 4 * (harmonics + 8)
    angle = 2.0 * np.pi / count * np.arange(count)
    K, (P, W) = material.response(angle), material.waves(angle)
    square, trace = P @ P, np.trace(P, axis1=1, axis2=2)
    second = 0.5 * (trace**2 - np.trace(square, axis1=1, axis2=2))
    # The inverse of s + z P is a polynomial of P over its determinant.
    turned = trace[:, None, None] * np.eye(3) - P
    adjoint = square - trace[:, None, None] * P + second[:, None, None] * np.eye(3)
    each = [(W @ part @ K).reshape(count, 18) for part in (np.eye(3), turned, adjoint)]
    values = np.concatenate((*each, np.stack((trace, second, np.linalg.det(P)), axis=1)), axis=1)
    series, order = np.fft.fft(values, axis=0) / count, np.fft.fftfreq(count, 1.0 / count)
    series[np.abs(series) <= 1e-13 * np.abs(series).max()] = 0.0
    known = series.any(axis=1)
    series, order = series[known], order[known]
    # Half of the path of theta - phi around both poles; the other half is the conjugate.
    bend = min(0.5, 7.0 / harmonics)
    steps = int(20.0 / bend)
    t = np.pi / steps * (np.arange(steps) + 0.5)
    path = t - 1j * bend * np.sin(t)
    weight = 1j * (1.0 - 1j * bend * np.cos(t)) / (2.0 * np.pi * steps)
    waves = np.exp(1j * np.outer(path, order))
    s, z = np.outer(np.sin(polar), np.cos(path)), np.cos(polar)[:, None]
    found = np.empty((2, 2 * (harmonics + 8), polar.size, 18))
    for k in range(found.shape[1]):
        phi = 2.0 * np.pi / found.shape[1] * k
        local = waves @ (series * np.exp(1j * order * phi)[:, None])
        first, second, third = local[:, 54:].T
        inverse = weight / (s**3 + s**2 * z * first + s * z**2 * second + z**3 * third)
        powers = np.stack((s**2 * inverse, s * z * inverse, z**2 * inverse), axis=1)
        parts = local[:, :54].reshape(steps, 3, 18).swapaxes(0, 1).reshape(-1, 18)
        for of, wave in zip(found, (np.cos(path + phi), np.sin(path + phi)), strict=True):
            of[k] = ((powers * wave).reshape(polar.size, -1) @ parts).real
    result = np.fft.rfft(found, axis=1) / found.shape[1]
    result[:, 1:] *= 2.0
    return result.swapaxes(1, 2)


@lru_cache(16)
def _integrate_edges(
    material: AnisotropicMaterial, digits: float = 1e-7
) -> tuple[np.ndarray, np.ndarray]:
    """Return ends (2, 2, 18) and coefficients (2, n, n, 18) of the integrals of A and B.

    The integral of A along y from 0 is, with rho² = x² + z² and R² = rho² + y²,

        ends[0] asinh(y/rho) + ends[1] log(R/rho) + sum of c_ij T_i(2 psi/pi - 1) T_j(2 lam/pi),

    psi = atan2(z, x), lam = atan2(y, rho); that of B along x has x and y exchanged.

    Raises
    ------
    ValueError
        If the stress changes too fast with the direction.
    """
    harmonics = material.harmonics
    for count in (16, 24, 32, 48, 64, 96, 128):
        polar = 0.25 * np.pi * (1.0 + _nodes(count))
        waves = np.einsum(
            "kl,plhc->pkhc", _to_coefficients(count), _integrate_waves(material, polar, harmonics)
        )
        size = np.abs(waves).max(axis=(0, 3))
        if size[-3:].max() <= digits * size.max():
            break
    else:
        raise ValueError(
            "the stress changes too fast with the direction: use a stiffness that is less unequal "
            "along different axes"
        )
    known = np.flatnonzero(size.max(axis=0) > 1e-3 * digits * size.max())
    waves = waves[:, :, : int(known[-1]) + 1]
    # Angles over twice the range need twice as many coefficients.
    psi, lam = (0.5 * np.pi * (shift + _nodes(2 * count)) for shift in (1.0, 0.0))
    across, depth = np.outer(np.cos(psi), np.cos(lam)), np.outer(np.sin(psi), np.cos(lam))
    along = np.broadcast_to(np.sin(lam), across.shape)
    ends, smooth = np.empty((2, 2, 18)), np.empty((2, 2 * count, 2 * count, 18))
    to_coefficients = _to_coefficients(2 * count)
    for k, (x, y) in enumerate(((across, along), (along, across))):
        values = _evaluate(waves[k], x, y, depth)
        end, none = np.array([1.0, -1.0]), np.zeros(2)
        end_x, end_y = (none, end) if k == 0 else (end, none)
        after, before = _evaluate(waves[k], end_x, end_y, none)
        ends[k] = 0.5 * (after + before), 0.5 * (after - before)
        values -= ends[k, 0] + ends[k, 1] * np.sin(lam)[:, None]
        values /= np.cos(lam)[:, None]
        found = np.einsum("ip,jl,plc->ijc", to_coefficients, to_coefficients, values, optimize=True)
        integral = 0.5 * np.pi * chebyshev.chebint(found, axis=1)
        smooth[k] = integral[:, :-1]
    return ends, smooth


def _evaluate(waves: np.ndarray, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Return the sum of waves (n, h, 18) at points (...) of the unit hemisphere, (..., 18)."""
    count, harmonics, _ = waves.shape
    out = np.empty((*x.shape, 18))
    for at in np.ndindex(x.shape[:-1]):
        polar = np.arctan2(np.hypot(x[at], y[at]), z[at])
        of_harmonics = chebyshev.chebvander(4.0 / np.pi * polar - 1.0, count - 1) @ waves.reshape(
            count, -1
        )
        turn = np.exp(1j * np.outer(np.arctan2(y[at], x[at]), np.arange(harmonics)))
        out[at] = np.einsum("mh,mhc->mc", turn, of_harmonics.reshape(-1, harmonics, 18)).real
    return out


def _along_edges(
    ends: np.ndarray, smooth: np.ndarray, across: np.ndarray, along: np.ndarray, depth: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integrals of `_integrate_edges` at places across and along, as two factors.

    Their product are the integrals (n, m, 18). They are infinite on an edge itself, at the surface:
    that part is left out.

    Returns
    -------
    basis : ndarray, shape (n, m, k)
        Functions of the place.
    factors : ndarray, shape (n, k, 18)
        Factors of the stresses.
    """
    rho, count = np.hypot(across, depth)[:, None], len(smooth)
    psi, lam = np.arctan2(depth, across), np.arctan2(along, rho)
    far = np.where(rho > 0.0, rho, np.where(along == 0.0, 1.0, np.abs(along)))
    logarithms = np.arcsinh(along / far), np.log(np.hypot(along, far) / far)
    by_psi = chebyshev.chebvander(2.0 / np.pi * psi - 1.0, count - 1)
    lines = (by_psi @ smooth.reshape(count, -1)).reshape(-1, count, 18)
    basis = chebyshev.chebvander(2.0 / np.pi * lam, count - 1)
    factors = np.concatenate((lines, np.broadcast_to(ends, (len(lines), 2, 18))), axis=1)
    return np.concatenate((basis, np.stack(logarithms, axis=2)), axis=2), factors


def _along_lines(
    ends: np.ndarray, smooth: np.ndarray, across: np.ndarray, depth: float
) -> np.ndarray:
    """Return the integrals of A along whole lines, (n, 18), less an infinite constant."""
    rho, count = np.hypot(across, depth), len(smooth)
    by_psi = chebyshev.chebvander(2.0 / np.pi * np.arctan2(depth, across) - 1.0, count - 1)
    logarithm = np.log(np.where(rho > 0.0, rho, 1.0))
    return 2.0 * (by_psi @ smooth[:, 1::2].sum(axis=1) - np.outer(logarithm, ends[0]))


class AnisotropicStress(ElementSums):
    """Stress solver for an anisotropic body, under rectangular elements or strips.

    Parameters as in `ElementSums`.
    """

    weights = np.eye(18).reshape(1, 6, 3, 18)
    """Weights of the functions of an element: they are the stresses by unit tractions."""

    def _edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the integrals along edges (`_integrate_edges`) for the material of the body."""
        body = cast(AnisotropicMaterial, self._body.A)  # or another one with a stiffness
        return _integrate_edges(AnisotropicMaterial(body.stiffness))

    def functions(
        self, x: np.ndarray, y: np.ndarray, depths: np.ndarray
    ) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield stresses by unit tractions (18, k, l), depth by depth (`ElementSums.functions`)."""
        (of_A, of_B), (smooth_A, smooth_B) = self._edges()
        for depth in depths:
            if self._body.datum is None:
                corners = np.matmul(*_along_edges(of_A, smooth_A, x, y, depth))
                of_y = np.matmul(*_along_edges(of_B, smooth_B, y, x, depth))
                corners += of_y.swapaxes(0, 1)
                values = np.diff(np.diff(corners, axis=0), axis=1)
            else:
                values = np.zeros((x.size - 1, y.size - 1, 18))
                values[:, 0] = np.diff(_along_lines(of_A, smooth_A, x, depth), axis=0)
            yield np.moveaxis(values, 2, 0), self.weights

    def spectra(self, depths: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the spectrum of the stress by a unit traction (6, 3, ...), depth by depth."""
        period, sides = self._lattice.padded, (self._grid.dx, self._grid.dy)
        counts = period if self._body.datum is None else (period[0], 1)
        before = [count // 2 for count in counts]
        x, y = (
            side * (np.arange(count + 1) - first - 0.5)
            for side, count, first in zip(sides, counts, before, strict=True)
        )
        for table, _ in self.functions(x, y, depths):
            cyclic = np.roll(table, [-first for first in before], axis=(1, 2))
            yield np.fft.rfft2(cyclic, period).reshape(6, 3, period[0], -1)

    def _at_place(self, place: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return the stress (6, k) at a place (x, y), and k depths, by jumps of the tractions."""
        if self._body.datum is not None:
            return super()._at_place(place, depths)
        loads, (x, y) = self._loads_around(place)
        jumps = np.diff(np.diff(np.pad(loads, ((0, 0), (1, 1), (1, 1))), axis=1), axis=2)
        stress = np.zeros((6, depths.size))
        each = (x, y, jumps), (y, x, jumps.swapaxes(1, 2))
        for edges, (across, along, jump) in zip(
            zip(*self._edges(), strict=True), each, strict=True
        ):
            for k, depth in enumerate(depths):
                basis, factors = _along_edges(*edges, across, along, depth)
                weighted = np.matmul(jump[:, :, None], basis[None])[:, :, 0]
                factors = factors.reshape(*factors.shape[:2], 6, 3)
                stress[:, k] += np.einsum("lnb,nbcl->c", weighted, factors, optimize=True)
        return stress


@stress_source.register
def _linear_stress(body: LinearHalfSpaces, *of_bodies) -> StressSource:
    """Return the stress solver for a body with layers, or an anisotropic one."""
    kind = LayeredStress if isinstance(body.A, LayeredBody) else AnisotropicStress
    return kind(*of_bodies)
