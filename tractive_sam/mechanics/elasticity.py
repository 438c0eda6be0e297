"""Elastic bodies: how the surfaces of two displace under the tractions between them.

All that a contact problem knows of its bodies. A body of one's own, as a layered one or one whose
surface gives way by itself only, is a subclass of `Elasticity`.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from tractive_sam.kernels.strip import logarithm, step
from tractive_sam.kernels.tables import quadrant
from tractive_sam.mechanics.material import CombinedMaterial, Material, combine

COMPONENTS = ("xx", "xy", "yy", "zz", "xz", "yz")
"""The six independent influence coefficients; A_zx = -A_xz and A_zy = -A_yz (reciprocity)."""


class Elasticity(ABC):
    """Two bodies as one; a subclass gives the moduli and `coefficients`.

    Examples
    --------
    >>> @dataclasses.dataclass(frozen=True)
    ... class Winkler(ts.Elasticity):
    ...     normal_modulus: float = 1e5  # MPa
    ...     shear_modulus: float = 8e4
    ...     thickness: float = 0.1  # mm
    ...
    ...     def coefficients(self, component, offsets, dx, dy):
    ...         table = np.zeros(offsets)
    ...         moduli = {"xx": self.shear_modulus, "yy": self.shear_modulus}
    ...         moduli["zz"] = self.normal_modulus
    ...         if component in moduli:
    ...             table[0, 0] = self.thickness / moduli[component]
    ...         return table
    >>> laws = ts.Laws.of(scene).replace(elasticity=Winkler())
    >>> ts.solve(scene, laws=laws).converged
    True
    """

    @property
    @abstractmethod
    def normal_modulus(self) -> float:
        """Pressure over normal strain, MPa: makes problems dimensionless (of half-spaces E*)."""

    @property
    @abstractmethod
    def shear_modulus(self) -> float:
        """Traction over slip, MPa: makes problems dimensionless (of half-spaces G)."""

    @property
    def coupled(self) -> bool:
        """Whether pressure makes the surfaces slip and tractions make them lift."""
        return False

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

    def opening(self, normal: np.ndarray) -> np.ndarray:
        """Displacement by tractions over that by the pressure, just ahead of an edge of contact.

        Of tractions that are a constant share of the pressure, over that share. They make the
        surfaces slip ahead of the contact by as much as the pressure makes them part.

        Parameters
        ----------
        normal : ndarray, shape (2, m)
            Unit vectors out of the contact.

        Returns
        -------
        ndarray, shape (m, 2, 2)
            Dimensionless; by default the ratio of the moduli, in any direction.
        """
        ratio = self.normal_modulus / self.shear_modulus
        return np.broadcast_to(ratio * np.eye(2), (normal.shape[1], 2, 2))

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
        raise ValueError(f"the stress in body {body} is not known of {self!r}")


@dataclass(frozen=True)
class HalfSpaces(Elasticity):
    """Two isotropic half-spaces.

    Juliá & Rodríguez-Tembleque (2025), eqs. (43) and (45); the signs of the coupling terms are
    those of a z-axis that points into body A.

    Parameters
    ----------
    A, B : Material
        The upper and the lower body; one may be rigid.

    Examples
    --------
    >>> round(ts.Laws.of(scene).elasticity.normal_modulus)
    114286
    """

    A: Material
    B: Material

    @cached_property
    def material(self) -> CombinedMaterial:
        """The constants of the pair."""
        return combine(self.A, self.B)

    @property
    def normal_modulus(self) -> float:
        """E*, MPa."""
        return self.material.E_star

    @property
    def shear_modulus(self) -> float:
        """Combined shear modulus G, MPa."""
        return self.material.shear

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

    def opening(self, normal: np.ndarray) -> np.ndarray:
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
    """Two isotropic half-spaces under strips of traction, endless in y: line contact, plane strain.

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
