"""The dimensionless operators of one contact problem.

With a unit of pressure p*, of gap g* and of slip s* (of half-spaces p* l / E* and
max(mu1, mu2)² p* / G), and with the tractions in the scaled tribological frame, p~ = M^-1 R p_t and
s~ = M R s, every quantity that a solver meets is of order one and both penalty-like factors of the
contact conditions are unity:

    gap   eta   = h/g* - delta/g* + A_nn pi_n + A_nt pi_t,    pi_n = max(0, pi_n - eta)
    slip  sigma = s~_rigid/s*     + D_tn pi_n + D_tt pi_t,    pi_t = disc(pi_t - sigma; pi_n)

Isotropic friction drops out of D_tt altogether. The scaled frame turns orthotropic friction into
isotropic friction of unit coefficient.
"""

from collections.abc import Callable
from functools import cached_property, lru_cache, partial

import numpy as np

from tractive_sam.kernels import spectral
from tractive_sam.mechanics import Elasticity, Frame, Linearisation
from tractive_sam.operators import influence
from tractive_sam.operators.convolution import Convolution
from tractive_sam.operators.fft import spectrum
from tractive_sam.operators.influence import Lattice
from tractive_sam.operators.stencil import UPWIND, FrictionSlip, Stencil


class Operators:
    """Elastic operators on a mesh, dimensionless, each made on its first use.

    Parameters
    ----------
    lattice : Lattice
        Elements; lengths in mm.
    elasticity : Elasticity
        The bodies.
    gap, slip : float
        Units of gap and of slip over that of pressure, g*/p*, mm/MPa, and s*/p*, 1/MPa.
    frame : Frame
        Scaled tribological frame.
    stencil : Stencil
        How the friction law takes the slip; the operators are those of the leading faces for any.
    """

    def __init__(
        self,
        lattice: Lattice,
        elasticity: Elasticity,
        gap: float,
        slip: float,
        frame: Frame | None = None,
        stencil: Stencil = UPWIND,
    ):
        self.lattice = lattice
        self.elasticity = elasticity
        self._per_gap, self._per_slip = 1.0 / gap, 1.0 / slip
        self._units = gap, slip
        self.frame = frame or Frame()
        self.stencil = stencil

    def on(self, lattice: Lattice) -> "Operators":
        """The same bodies and units on another mesh."""
        return type(self)(lattice, self.elasticity, *self._units, self.frame, self.stencil)

    @cached_property
    def coarsened(self) -> "Operators":
        """The same bodies and units on elements of twice the size."""
        return self.on(self.lattice.coarsened())

    @cached_property
    def part(self) -> Callable[[tuple[int, int]], "Operators"]:
        """Operators on fewer elements of the mesh, by their numbers; the last eight are kept."""
        whole = (self.lattice, self.elasticity, *self._units, self.frame, self.stencil)
        return lru_cache(8)(partial(_on_part, type(self), *whole))

    def _displacement(self, component: str, period: tuple[int, int] | None = None) -> np.ndarray:
        return spectrum(influence.displacement(self.lattice, self.elasticity, component, period))

    def _slip(self, component: str) -> np.ndarray:
        return spectrum(influence.slip(self.lattice, self.elasticity, component))

    def _normal_spectrum(self, period: tuple[int, int] | None = None) -> np.ndarray:
        return self._per_gap * self._displacement("zz", period).real

    @cached_property
    def along_x(self) -> np.ndarray:
        """Spectra along x of A_nn per traction, mm/MPa, (p_y, p_x/2 + 1), for sums over x."""
        px, _ = self.lattice.padded
        # Even in x: a real spectrum. Parseval over its half: inner frequencies count twice.
        along = np.fft.rfft(influence.displacement(self.lattice, self.elasticity, "zz"), axis=0)
        along = along.real / px
        along[1:-1] *= 2.0
        return np.ascontiguousarray(along.T)

    @cached_property
    def _slip_spectra(self) -> np.ndarray:
        """Entries (11, 12, 22) of D_tt."""
        entries = self._tangential(*(self._slip(k) for k in ("xx", "xy", "yy")))
        return self._per_slip * np.stack(entries)

    def _convolution(self, spectra, product, fields: int) -> Convolution:
        spectra = np.ascontiguousarray(spectra)
        return Convolution(spectra, product, fields, self.lattice.shape, self.lattice.padded)

    def _inverse(self, spectra, product, fields: int) -> Convolution:
        """Of inverted spectra, which still carry the size of their table twice."""
        period = self.lattice.cyclic
        spectra = np.stack(spectra) / np.prod(period) ** 2
        return Convolution(spectra, product, fields, self.lattice.shape, period)

    def _tangential(self, xx, xy, yy):
        """Entries (11, 12, 22) of F [[xx, xy], [xy, yy]] F^T, any kind of array."""
        (a, b), (c, d) = self.frame.matrix
        return (
            a * a * xx + 2.0 * a * b * xy + b * b * yy,
            a * c * xx + (a * d + b * c) * xy + b * d * yy,
            c * c * xx + 2.0 * c * d * xy + d * d * yy,
        )

    @cached_property
    def normal(self) -> Convolution:
        """pi_n -> A_nn pi_n."""
        return self._convolution([self._normal_spectrum()], spectral.scale, 1)

    @cached_property
    def normal_inverse(self) -> Convolution:
        """Circulant inverse of `normal`, its preconditioner."""
        return self._inverse([1.0 / self._normal_spectrum(self.lattice.cyclic)], spectral.scale, 1)

    @cached_property
    def slip(self) -> Convolution:
        """pi_t -> D_tt pi_t, at the leading faces."""
        return self._convolution(self._slip_spectra, spectral.symmetric_2x2, 2)

    @cached_property
    def self_influence(self) -> tuple[float, float, float]:
        """Entries (11, 12, 22) of D_tt of an element on itself."""
        alone = self.lattice.of((1, 1))
        tables = (influence.slip(alone, self.elasticity, k) for k in ("xx", "xy", "yy"))
        entries = self._tangential(*(table[0, 0] for table in tables))
        return tuple(float(self._per_slip * e) for e in entries)

    def friction_slip(self, bound: np.ndarray, gap: np.ndarray) -> FrictionSlip:
        """The slip that the friction law sees under dimensionless pressure and gap.

        What the tractions displace ahead of an edge is told by `Elasticity.opening`.
        """
        leading, layer, F = (
            self.stencil.leading(bound, gap),
            self.elasticity.layer,
            self.frame.matrix,
        )
        ahead, dx = (leading[0] + 1, leading[1]), self.lattice.dx
        sheared = self._per_slip * layer / dx * F @ F.T if layer else None
        seen = self.stencil.staggered, bound, gap, leading, ahead, dx / self.lattice.dy
        return FrictionSlip(*seen, self._opening, sheared)

    def _opening(self, angle: np.ndarray) -> np.ndarray:
        """What the surfaces slip by a unit of gap that closes, by angles of the edge, (m, 2, 2)."""
        per_gap, F = self._per_slip / (self._per_gap * self.lattice.dx), self.frame.matrix
        normal = np.stack((np.cos(angle), np.sin(angle)))
        return per_gap * F @ self.elasticity.opening(normal, self.lattice.dx, self.lattice.dy) @ F.T

    def approximate_inverse(
        self, law: Linearisation, rows: np.ndarray, stiffness: np.ndarray
    ) -> np.ndarray:
        """Tractions whose rows of a friction law are nearly those given: the upwind sweep."""
        return law.approximate_inverse(
            rows, self.tangential_inverse, self.self_influence, stiffness
        )

    @cached_property
    def tangential(self) -> Convolution:
        """pi_t -> A_tt pi_t / dx in units of slip, the displacement whose difference is slip."""
        return self._convolution(self._displacement_per_dx(), spectral.symmetric_2x2, 2)

    @cached_property
    def tangential_inverse(self) -> Convolution:
        """Circulant inverse of `tangential`."""
        a11, a12, a22 = self._displacement_per_dx(self.lattice.cyclic)
        determinant = a11 * a22 - a12 * a12
        inverse = (a22 / determinant, -a12 / determinant, a11 / determinant)
        return self._inverse(inverse, spectral.symmetric_2x2, 2)

    def _displacement_per_dx(self, period: tuple[int, int] | None = None) -> np.ndarray:
        entries = self._tangential(
            *(self._displacement(k, period).real for k in ("xx", "xy", "yy"))
        )
        return self._per_slip / self.lattice.dx * np.stack(entries)

    @cached_property
    def coupled(self) -> Convolution:
        """(pi_n, pi_t) -> (A_nn pi_n + A_nt pi_t, D_tn pi_n + D_tt pi_t)."""
        d11, d12, d22 = self._slip_spectra
        F, per_gap, per_slip = self.frame.matrix, self._per_gap, self._per_slip
        # Reciprocity: u_n from p_x is minus u_x from p_n, A_zx = -A_xz.
        gap = [-1j * self._displacement(k).imag for k in ("xz", "yz")]
        drag = [self._slip(k) for k in ("xz", "yz")]
        entries = np.stack(
            (
                self._normal_spectrum() + 0j,
                per_gap * (F[0, 0] * gap[0] + F[0, 1] * gap[1]),
                per_gap * (F[1, 0] * gap[0] + F[1, 1] * gap[1]),
                per_slip * (F[0, 0] * drag[0] + F[0, 1] * drag[1]),
                d11,
                d12,
                per_slip * (F[1, 0] * drag[0] + F[1, 1] * drag[1]),
                d12,
                d22,
            )
        )
        return self._convolution(entries, spectral.full_3x3, 3)

    def slip_by_pressure(self, pressure: np.ndarray) -> np.ndarray:
        """D_tn pi_n, shape (2, n_x, n_y), of a pressure of shape (n_x, n_y)."""
        none = np.zeros((2, *pressure.shape))
        return self.coupled(np.concatenate((pressure[None], none)))[1:]


def _on_part(kind, lattice, elasticity, gap, slip, frame, stencil, shape) -> Operators:
    return kind(lattice.of(shape), elasticity, gap, slip, frame, stencil)
