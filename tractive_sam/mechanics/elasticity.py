"""Elastic bodies: how the surfaces of two displace under the tractions between them.

All that a contact problem knows of its bodies. A body of one's own, as a layered one or one whose
surface gives way by itself only, is a subclass of `Elasticity`.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from tractive_sam.kernels.rectangle import quadrant
from tractive_sam.kernels.strip import logarithm, step
from tractive_sam.mechanics.law import Law
from tractive_sam.mechanics.material import CombinedMaterial, Material, combine

COMPONENTS = ("xx", "xy", "yy", "zz", "xz", "yz")
"""The six independent influence coefficients; A_zx = -A_xz and A_zy = -A_yz (reciprocity)."""


class Elasticity(Law, ABC):
    """Two bodies as one; a subclass gives `coefficients`, and the rest where it is another.

    Examples
    --------
    >>> class Winkler(ts.Elasticity):
    ...     def coefficients(self, component, offsets, dx, dy):
    ...         table = np.zeros(offsets)
    ...         table[0, 0] = {"xx": 2e-6, "yy": 2e-6, "zz": 1e-6}.get(component, 0.0)
    ...         return table
    >>> laws = ts.Laws.of(scene).replace(elasticity=Winkler())
    >>> soft = ts.solve(scene, laws=laws)
    >>> round(soft.approach / soft.p_max, 7)
    1e-06
    """

    @property
    def coupled(self) -> bool:
        """Whether pressure makes the surfaces slip and tractions make them lift.

        By default not; then "xz" and "yz" of `coefficients` are not asked for.
        """
        return False

    @property
    def layer(self) -> float:
        """Compliance of what the surfaces shear by in every point by itself, mm/MPa; none."""
        return 0.0

    @abstractmethod
    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Displacement u_A - u_B at the centre of an element per unit traction on another.

        Parameters
        ----------
        component : str
            One of "xx", "xy", "yy", "zz", "xz", "yz"; "xz" is u_x by p_z. The sign of z is that of
            an axis that points into body A.
        offsets : (int, int)
            Shape of the table.
        dx, dy : float
            Sides of an element, mm.

        Returns
        -------
        ndarray, shape `offsets`
            mm/MPa; at (i, j) that of an element i dx further in x and j dy further in y. On the
            other sides "xy" is odd in x and in y, "xz" odd in x, "yz" odd in y; all else is even.
        """

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """What gaps are measured in, over what pressures are: they are then of like size.

        Parameters
        ----------
        length : float
            Of the contact, mm.
        dx, dy : float
            Sides of an element, mm.

        Returns
        -------
        float
            mm/MPa; by default what an element is pressed in by itself.
        """
        return float(self.coefficients("zz", (1, 1), dx, dy)[0, 0])

    def slip_per_traction(self, dx: float, dy: float) -> float:
        """What slips are measured in, over what tractions are, 1/MPa.

        By default what an element makes itself slip.
        """
        here, ahead = self.coefficients("xx", (2, 1), dx, dy)[:, 0]
        return float(here - ahead) / dx

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """Displacement by tractions over that by the pressure, just ahead of an edge of contact.

        Of tractions that are a constant share of the pressure, over that share. They make the
        surfaces slip ahead of the contact by as much as the pressure makes them part.

        Parameters
        ----------
        normal : ndarray, shape (2, m)
            Unit vectors out of the contact.
        dx, dy : float
            Sides of an element, mm.

        Returns
        -------
        ndarray, shape (m, 2, 2)
            Dimensionless; by default as an element displaces itself.
        """
        xx, yy, zz = (self.coefficients(k, (1, 1), dx, dy)[0, 0] for k in ("xx", "yy", "zz"))
        return np.broadcast_to(np.diag([xx / zz, yy / zz]), (normal.shape[1], 2, 2))

    def spanning(self, length: float) -> "Elasticity":
        """The same for a mesh of a length in x, mm, where that makes a difference."""
        return self

    def alone(self, body: str) -> "Elasticity":
        """One body, "A" or "B", against a rigid one: what the stress in it is computed from.

        Raises
        ------
        ValueError
            If stress in the bodies is not known, as by default.
        """
        raise ValueError(
            f"the stress in body {body} is not known of {self!r}: leave [subsurface] and [fatigue] "
            f"out, or define {type(self).__name__}.alone(body)"
        )


@dataclass(frozen=True)
class HalfSpaces(Elasticity):
    """Two isotropic half-spaces.

    A subclass with other `coefficients` is no homogeneous body any more: its stress is not known
    unless it defines `alone` as well.

    Juliá & Rodríguez-Tembleque (2025), eqs. (43) and (45); the signs of the coupling terms are
    those of a z-axis that points into body A.

    Parameters
    ----------
    A, B : Material
        The upper and the lower body; one may be rigid.

    Examples
    --------
    >>> round(ts.Laws.of(discs).elasticity.material.E_star)
    114286
    """

    A: Material
    B: Material

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Withdraw the stress of homogeneous bodies from subclasses of other coefficients."""
        super().__init_subclass__(**kwargs)
        if "coefficients" in vars(cls) and "alone" not in vars(cls):
            cls.alone = Elasticity.alone

    @cached_property
    def material(self) -> CombinedMaterial:
        """The constants of the pair."""
        return combine(self.A, self.B)

    @property
    def coupled(self) -> bool:
        """Whether the bodies are dissimilar, K != 0."""
        return self.material.coupling != 0.0

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """See `Elasticity.coefficients`; integrated over an element."""
        r1, xx, yy, xy, x2, y2 = _integrals(*offsets, dx, dy)
        nu, K = self.material.poisson, self.material.coupling
        match component:
            case "xx":
                entry = (1.0 - nu) * r1 + nu * xx
            case "xy":
                entry = nu * xy
            case "yy":
                entry = (1.0 - nu) * r1 + nu * yy
            case "zz":
                entry = (1.0 - nu) * r1
            case "xz":
                entry = -K * x2
            case "yz":
                entry = -K * y2
        return entry / (np.pi * self.material.shear)

    def response(self, component: str, kx: np.ndarray, ky: np.ndarray) -> np.ndarray:
        """Displacement u_A - u_B over traction in wave numbers, u and p as exp(i (kx x + ky y)).

        Parameters
        ----------
        component : str
            As of `coefficients`.
        kx, ky : ndarray
            Wave numbers, not both 0, 1/mm.

        Returns
        -------
        ndarray
            mm/MPa; imaginary for "xz" and "yz".
        """
        k, nu, K = np.hypot(kx, ky), self.material.poisson, self.material.coupling
        match component:
            case "xx":
                entry = (1.0 - nu * (kx / k) ** 2) / k
            case "xy":
                entry = -nu * kx * ky / k**3
            case "yy":
                entry = (1.0 - nu * (ky / k) ** 2) / k
            case "zz":
                entry = (1.0 - nu) / k
            case "xz":
                entry = 1j * K * kx / k**2
            case "yz":
                entry = 1j * K * ky / k**2
        return 2.0 * entry / self.material.shear

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """length / E*; see `Elasticity.gap_per_pressure`."""
        return length / self.material.E_star

    def slip_per_traction(self, dx: float, dy: float) -> float:
        """1/G; see `Elasticity.slip_per_traction`."""
        return 1.0 / self.material.shear

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """(1 - nu n n^T)/(1 - nu), that of line loads along the edge; see `Elasticity.opening`."""
        nu = self.material.poisson
        return (np.eye(2) - nu * np.einsum("am,bm->mab", normal, normal)) / (1.0 - nu)

    def alone(self, body: str) -> "HalfSpaces":
        """One body of unit shear modulus, as "A", against a rigid one.

        Stress by given tractions does not depend on the modulus.

        Raises
        ------
        ValueError
            If a body is neither "A" nor "B".
        """
        if body not in ("A", "B"):
            raise ValueError(f'a body is "A" or "B", not {body!r}')
        poisson = getattr(self, body).poisson
        return replace(self, A=Material(1.0, poisson), B=Material(np.inf, poisson))


@dataclass(frozen=True)
class Strips(HalfSpaces):
    """Two half-spaces under infinitely long strips of traction: line contact, plane strain.

    Parameters
    ----------
    A, B : Material
        As of `HalfSpaces`.
    datum : float
        Distance from a load at which its displacement is taken to be zero, mm: relative to distant
        points it is infinite.
    """

    datum: float

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """See `Elasticity.coefficients`; the only offset in y is 0.

        Columns beyond it are zero: with them the transform in y passes every row by itself, in
        circulant inverses as well.
        """
        table = np.zeros(offsets)
        x, nu, K = dx * np.arange(offsets[0]), self.material.poisson, self.material.coupling
        c = 1.0 / (np.pi * self.material.shear)
        match component:
            case "xx" | "zz":
                table[:, 0] = c * (1.0 - nu) * logarithm(x, dx, self.datum)
            case "yy":
                table[:, 0] = c * logarithm(x, dx, self.datum)
            case "xz":
                table[:, 0] = -c * K * step(x, dx)
        return table

    alone = HalfSpaces.alone

    def spanning(self, length: float) -> "Strips":
        """With a datum of twice the length at least.

        From once the length on the normal operator is positive definite, from twice on with the
        circulant inverse.
        """
        return replace(self, datum=max(self.datum, 2.0 * length))


@lru_cache(maxsize=8)
def _integrals(nx: int, ny: int, dx: float, dy: float) -> np.ndarray:
    """Of all components at once, for any material."""
    return quadrant(nx, ny, dx, dy)
