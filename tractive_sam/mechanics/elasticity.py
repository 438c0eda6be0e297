"""Elastic bodies: displacement of their surfaces under the tractions between them.

A contact problem needs nothing else of its bodies. User-defined bodies (coated half-spaces, a
Winkler foundation) are subclasses of `Elasticity`.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from tractive_sam.kernels.half_space import integrate_logarithm, integrate_sign, quadrant
from tractive_sam.lazy_names import accept_renamed_methods, renamed_attributes
from tractive_sam.mechanics.law import Law
from tractive_sam.mechanics.material import CombinedMaterial, Material, combine

COMPONENTS = ("xx", "xy", "yy", "zz", "xz", "yz")
"""The six independent influence coefficients; A_zx = -A_xz and A_zy = -A_yz (reciprocity)."""


@renamed_attributes(alone="single_body")
class Elasticity(Law, ABC):
    """Base class of elastic bodies: a subclass adds `coefficients`, and the stress if it knows it.

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
        """Whether pressure causes tangential and traction normal displacement; default False.

        The default is False: "xz" and "yz" of `coefficients` are not used.
        """
        return False

    @property
    def layer(self) -> float:
        """Shear compliance of an interfacial layer between the surfaces, mm/MPa; default 0."""
        return 0.0

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Accept methods of a subclass under their former names, with a warning."""
        super().__init_subclass__(**kwargs)
        accept_renamed_methods(cls, {"alone": "single_body"})

    @abstractmethod
    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return influence coefficients: displacement u_A - u_B per unit traction on an element.

        The table has a coefficient for each offset of the elements in x and y.

        Parameters
        ----------
        component : str
            One of "xx", "xy", "yy", "zz", "xz", "yz"; "xz" is u_x by p_z. The z-axis points
            into body A.
        offsets : (int, int)
            Shape of the table.
        dx, dy : float
            Sides of an element, mm.

        Returns
        -------
        ndarray, shape `offsets`
            mm/MPa; at (i, j) the displacement of an element i dx further in x and j dy further in
            y. For negative offsets "xy" is odd in x and in y, "xz" odd in x, "yz" odd in y; the
            other components are even.
        """

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """Return the unit of gap over that of pressure, mm/MPa; default: that of a loaded element.

        Parameters
        ----------
        length : float
            Length of the contact, mm.
        dx, dy : float
            Sides of an element, mm.

        Returns
        -------
        float
            mm/MPa; by default the displacement of an element by a unit pressure on it.
        """
        return float(self.coefficients("zz", (1, 1), dx, dy)[0, 0])

    def slip_per_traction(self, dx: float, dy: float) -> float:
        """Return the unit of slip over that of traction, 1/MPa; default: slip of a loaded element.

        By default the slip of an element by a unit traction on it.
        """
        here, ahead = self.coefficients("xx", (2, 1), dx, dy)[:, 0]
        return float(here - ahead) / dx

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """Return the displacement by traction over that by pressure, just ahead of a contact edge.

        The traction is a constant share of the pressure, and the ratio is over that share: it gives
        the tangential displacement ahead of the contact over the opening.

        Parameters
        ----------
        normal : ndarray, shape (2, m)
            Unit vectors out of the contact.
        dx, dy : float
            Sides of an element, mm.

        Returns
        -------
        ndarray, shape (m, 2, 2)
            Dimensionless; by default the ratio of the displacements of an element by a unit load
            on it.
        """
        xx, yy, zz = (self.coefficients(k, (1, 1), dx, dy)[0, 0] for k in ("xx", "yy", "zz"))
        return np.broadcast_to(np.diag([xx / zz, yy / zz]), (normal.shape[1], 2, 2))

    def spanning(self, length: float) -> "Elasticity":
        """Return the law for a mesh of a length in x, mm, as strips need; default: this law."""
        return self

    def single_body(self, body: str) -> "Elasticity":
        """Return the elasticity of body "A" or "B" against a rigid one; default: ValueError.

        Raises
        ------
        ValueError
            If the law does not give the stress in the bodies, which is the default.
        """
        raise ValueError(
            f"the law {self!r} does not give the stress in body {body}: remove [subsurface] and "
            f"[fatigue], or define {type(self).__name__}.single_body(body)"
        )


@dataclass(frozen=True)
class HalfSpaces(Elasticity):
    """Elasticity of two isotropic half-spaces.

    A subclass with other `coefficients` is not homogeneous: the stress in its bodies is known only
    if it defines `single_body` as well.

    Juliá & Rodríguez-Tembleque (2025), eqs. (43) and (45); the signs of the coupling terms belong
    to a z-axis that points into body A.

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
        """Remove the stress of homogeneous bodies from subclasses with other coefficients."""
        super().__init_subclass__(**kwargs)
        if "coefficients" in vars(cls) and "single_body" not in vars(cls):
            cls.single_body = Elasticity.single_body  # type: ignore[assignment, method-assign]

    @cached_property
    def material(self) -> CombinedMaterial:
        """Elastic constants of the pair of bodies as one half-space."""
        return combine(self.A, self.B)

    @property
    def coupled(self) -> bool:
        """Whether the bodies are dissimilar (K != 0): pressure causes tangential displacement."""
        return self.material.coupling != 0.0

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the influence coefficients of two half-spaces for all offsets, mm/MPa.

        They are displacements u_A - u_B at the centre of an element per uniform unit traction on
        another one.

        Parameters as in `Elasticity.coefficients`.
        """
        r1, xx, yy, xy, x2, y2 = _integrals_of(dx, dy).at(*offsets)
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
        """Return displacement u_A - u_B over traction at wave numbers, with exp(i (kx x + ky y)).

        Parameters
        ----------
        component : str
            See `coefficients`.
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
        """Return length / E*, the scale of gaps over pressures (`Elasticity.gap_per_pressure`)."""
        return length / self.material.E_star

    def slip_per_traction(self, dx: float, dy: float) -> float:
        """Return 1/G, the scale of slips over tractions; see `Elasticity.slip_per_traction`."""
        return 1.0 / self.material.shear

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """Return tangential over normal displacement ahead of an edge: (1 - nu n n^T)/(1 - nu).

        See `Elasticity.opening`.
        """
        nu = self.material.poisson
        return (np.eye(2) - nu * np.einsum("am,bm->mab", normal, normal)) / (1.0 - nu)

    def single_body(self, body: str) -> "HalfSpaces":
        """Return half-spaces of one body, with unit shear modulus, and a rigid body.

        The stress under given tractions does not depend on the modulus.

        Raises
        ------
        ValueError
            If `body` is neither "A" nor "B".
        """
        if body not in ("A", "B"):
            raise ValueError(f'a body is "A" or "B", not {body!r}')
        poisson = getattr(self, body).poisson
        return replace(self, A=Material(1.0, poisson), B=Material(np.inf, poisson))


@dataclass(frozen=True)
class Strips(HalfSpaces):
    """Elasticity of two half-spaces under infinitely long strips: line contact, plane strain.

    Parameters
    ----------
    A, B : Material
        See `HalfSpaces`.
    datum : float
        Distance from a load at which its displacement is defined as zero, mm: relative to distant
        points the displacement is infinite.
    """

    datum: float

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the displacement of a strip per unit traction on another, mm/MPa, (offsets[0], 1).

        The other columns are zero: then the transform in y treats every row separately, also in
        circulant inverses.

        Parameters as in `Elasticity.coefficients`.
        """
        table = np.zeros(offsets)
        x, nu, K = dx * np.arange(offsets[0]), self.material.poisson, self.material.coupling
        c = 1.0 / (np.pi * self.material.shear)
        match component:
            case "xx" | "zz":
                table[:, 0] = c * (1.0 - nu) * integrate_logarithm(x, dx, self.datum)
            case "yy":
                table[:, 0] = c * integrate_logarithm(x, dx, self.datum)
            case "xz":
                table[:, 0] = -c * K * integrate_sign(x, dx)
        return table

    single_body = HalfSpaces.single_body

    def spanning(self, length: float) -> "Strips":
        """Return the strips with a datum of at least twice the length of the mesh, mm.

        The normal operator is positive definite from once the length, its circulant inverse from
        twice the length.
        """
        return replace(self, datum=max(self.datum, 2.0 * length))


class _ElementIntegrals:
    """Surface kernels integrated over an element, for any material, stored and extended on demand.

    The table has as many offsets as were needed so far: a rectangle around the contact has the
    elements of its mesh.
    """

    def __init__(self, dx: float, dy: float) -> None:
        self._sides, self._table = (dx, dy), np.empty((6, 0, 0))

    def at(self, nx: int, ny: int) -> np.ndarray:
        """Return the six kernel integrals at offsets below (nx, ny) elements, mm, (6, nx, ny)."""
        table = self._table
        stored_x, stored_y = table.shape[1:]
        if nx > stored_x or ny > stored_y:
            table = quadrant(max(nx, stored_x), max(ny, stored_y), *self._sides)
            self._table = table
        return table[:, :nx, :ny]


_integrals_of = lru_cache(maxsize=8)(_ElementIntegrals)
"""The integrals of elements by their sides."""
