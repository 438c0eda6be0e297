"""Preconditioner of steady rolling on large meshes, which is sharp at the borders of stick zones.

The upwind sweep (`mechanics.friction.Linearisation.upwind_inverse`) inverts stick zones by the
circulant inverse and a sum from the leading edge, and slip zones element by element. Its iterations
increase with the number of elements, in both zones. The inverse by zones applies two convolutions
to the same rows r, which couples the zones.

*Stick.* The inverse of the finite Hilbert transform is W H^-1 W^-1, with a weight W that is
singular at both ends of a zone. Towards a slip zone behind, W = (T/c)^-a for distances T up to c,
for the component of the traction along the slip there; the other component remains regular. At the
leading edge the sum has the weight V = 1 + v (L^-1/2 - l^-1/2) for distances L up to l.

*Slip.* The elastic slip and the local term gamma are of equal size at wavelengths of many elements.
The convolution with the inverse of D + g, for one constant g, is combined with the row itself:
a1 t.(D + g)^-1 r + a2 t.r. For each gamma, the weights a1 and a2 are those of least squares over
the spectrum of D.
"""

from collections.abc import Callable
from functools import cache
from typing import ClassVar

import numpy as np

from tractive_sam.compute import Convolution
from tractive_sam.kernels.zone_inverse import combine_zones, prepare_zones, weight_rows
from tractive_sam.mechanics import Linearisation


class ZoneInverse:
    """Preconditioner of one mesh for isotropic friction and bodies of equal material.

    Parameters
    ----------
    spectra : ndarray, shape (3, p_x, p_y/2 + 1)
        Entries (11, 12, 22) of the spectra of A_tt / dx on a period.
    trace : float
        Trace of the slip of an element due to its own traction.
    smooth : Convolution
        The circulant inverse of A_tt / dx.
    convolution : callable
        Function that returns the convolution with spectra of the period.
    """

    damping: ClassVar[float] = 0.4
    """The constant g."""
    tuning: ClassVar[tuple[float, ...]] = (16.0, 0.4, -0.3, 32.0)
    """Length c of the border of a stick zone, elements, exponent a, weight v, and its length l."""

    def __init__(
        self,
        spectra: np.ndarray,
        trace: float,
        smooth: Convolution,
        convolution: Callable[[np.ndarray], Convolution],
    ):
        self._trace, self._smooth = trace, smooth
        px, half = spectra.shape[1:]
        size, damping = px * 2 * (half - 1), self.damping
        first, mixed, second = spectra[:, max(2, px // 8), 0].real  # a wave along x
        self._edge = np.array((second, -mixed, first)) / (first + second)
        a, b, c = spectra * (1.0 - np.exp(2j * np.pi / px * np.arange(px))[:, None])
        determinant = (a + damping) * (c + damping) - b * b
        self._damped = convolution(np.stack((c + damping, -b, a + damping)) / (size * determinant))
        rows, columns = np.linspace(1, px - 1, 20), np.linspace(0, half - 1, 10)
        slip = 0.5 * (a + c)[np.ix_(rows.astype(int), columns.astype(int))].ravel()
        parts = np.stack((1.0 / (slip + damping), np.ones_like(slip)), axis=1)
        gamma = np.geomspace(1e-3, 50.0, 120)
        products = (slip + gamma[:, None])[..., None] * parts
        normal = np.einsum("gsa,gsb->gab", products.conj(), products).real + 1e-6 * np.eye(2)
        weights = np.linalg.solve(normal, products.real.sum(axis=1)[..., None])
        self._nodes, self._table = np.log(gamma), np.ascontiguousarray(weights[..., 0].T)

    def at(self, law: Linearisation, stiffness: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """Return the preconditioner of a linearised law; see `Kinematics.approximate_inverse`."""
        state = law.state

        @cache
        def prepare(kind: np.dtype) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
            weights, border = np.empty((7, *state.shape), kind), np.empty((5, state.size), kind)
            places = np.empty((2, state.size), np.int32)
            count = prepare_zones(
                *(state, law.direction, law.kappa, stiffness, self._trace, self._edge),
                *(self.tuning, self._nodes, self._table, weights, places, border),
            )
            return weights, places, border, count

        def solve(rows: np.ndarray) -> np.ndarray:
            zones, weighted, out = prepare(rows.dtype), np.empty_like(rows), np.empty_like(rows)
            weight_rows(*zones, rows, weighted)
            combine_zones(*zones, rows, self._smooth(weighted), self._damped(weighted), out)
            return out

        return solve
