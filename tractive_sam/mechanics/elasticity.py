"""Elastic bodies: displacement of their surfaces under the tractions between them.

A contact problem needs nothing else of its bodies. User-defined bodies (coated half-spaces, a
Winkler foundation) are subclasses of `Elasticity`.

Coated and graded half-spaces are defined by their response at wave numbers. Short waves respond
like the surface material, long waves like the material far below. With the responses c_s and c_f of
homogeneous half-spaces of these materials, the response c(k) is split into

    c = c_s + (c_f - c_s) exp(-k d) + g.

`HalfSpaces` has the influence coefficients of the first term. The second term is smooth: it is the
displacement at a height d (Boussinesq and Cerruti) in closed form. The remainder g decreases fast
with the wave number, and is integrated over the wave numbers. At the wave number 0 it has a cone
and a limit that depends on the direction, so that it is felt at long distances: sums over equally
spaced waves would add its periodic images.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from operator import attrgetter
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from tractive_sam.kernels.half_space import integrate_logarithm, integrate_sign, quadrant
from tractive_sam.lazy_names import accept_renamed_methods, renamed_attributes
from tractive_sam.mechanics.law import Law


class SurfaceResponse(ABC):
    """Base class of half-spaces by their response to waves, the mean over their directions.

    The displacement by a wave of traction with the wave number k is S(k), and each component of k S
    is c_0 + sum over i of c_i exp(-k d_i), with c_0 of `compliances`, and c_i and d_i of `images`;
    see `tractive_sam.mechanics.layers`. Subclasses are equal if they respond alike, and have a
    hash: contacts of equal bodies are computed once.

    Examples
    --------
    >>> class Rigid(ts.mechanics.SurfaceResponse):
    ...     @property
    ...     def compliances(self):
    ...         return np.zeros(4)
    >>> ts.LinearHalfSpaces(Rigid(), ts.Material(1.0, 0.5)).contact_modulus(length=1.0)
    4.0
    """

    is_isotropic: ClassVar[bool] = False
    """Whether the body is homogeneous, isotropic and elastic."""
    relaxes: ClassVar[bool] = False
    """Whether the body dissipates, and its response depends on the rolling speed."""

    @property
    @abstractmethod
    def compliances(self) -> np.ndarray:
        """Limits of k (S_zz, S_LL, S_TT, |S_Lz|) for short waves, 1/MPa, shape (4,)."""

    @property
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights d_i, mm, (m,), and amplitudes c_i, 1/MPa, (4, m), without c_0; default: none.

        A term c_i exp(-k d_i) is the response to an image of the traction at the height d_i above
        the surface: its waves decay with the depth.
        """
        return np.empty(0), np.empty((4, 0))

    @property
    def laws(self) -> frozenset[type[Any]]:
        """Laws of elasticity that a pair with this body needs; default: none.

        `LinearHalfSpaces` serve each pair of bodies without such needs.
        """
        return frozenset()

    def reach(self, speed: float) -> float:
        """Return the length of the waves at which the response changes, mm; 0 if it does not.

        Parameters
        ----------
        speed : float
            Rolling speed, mm/s.
        """
        return float(self.images[0].max(initial=0.0))

    def factor(
        self, k: np.ndarray | float, speed: float, step: tuple[float, float] | None = None
    ) -> np.ndarray:
        """Return the complex compliance in rolling over the elastic one, for waves exp(i k x).

        The default, 1, is the factor of an elastic body, whose response does not lag.

        Parameters
        ----------
        k : ndarray or float
            Wave numbers, 1/mm.
        speed : float
            Rolling speed V, mm/s.
        step : (float, float), optional
            Distance, mm, and time, s, over which the tractions have grown linearly from zero; by
            default they have always been there.
        """
        return np.ones_like(k)

    @property
    def unit_body(self) -> Any:
        """Body with equal stress under equal tractions, of the modulus 1; None if not known.

        The modulus is that at the surface; a body of any stiffness may stay as it is.
        """
        return None

    def worn(self, depth: float, step: float) -> "SurfaceResponse":
        """Return the body without a worn depth, mm, in steps of its layers; default: the body.

        Parameters
        ----------
        depth : float
            mm.
        step : float
            Share of the thickness of a layer by which it becomes thinner at once.
        """
        return self


@dataclass(frozen=True)
class Material(SurfaceResponse):
    """Linear elastic, isotropic material of one body.

    Parameters
    ----------
    shear : float
        Shear modulus G, MPa; positive.
    poisson : float
        Poisson's ratio, above -1 and at most 0.5.

    Raises
    ------
    ValueError
        If a constant lies outside its range.

    Examples
    --------
    >>> ts.Material.from_young(208e3, 0.3).shear
    80000.0
    """

    shear: float
    poisson: float
    is_isotropic = True
    recorded_name = "tractive_sam.mechanics.material.Material"

    def __post_init__(self) -> None:
        if not self.shear > 0:
            raise ValueError(f"the shear modulus must be above 0, not {self.shear}")
        if not -1 < self.poisson <= 0.5:
            raise ValueError(f"Poisson's ratio must lie in (-1, 0.5], not {self.poisson}")

    @classmethod
    def from_young(cls, young: float, poisson: float) -> "Material":
        """Return a material from Young's modulus, MPa, and Poisson's ratio.

        Parameters
        ----------
        young : float
            Young's modulus, MPa.
        poisson : float
            Poisson's ratio.
        """
        return cls(young / (2 * (1 + poisson)), poisson)

    @property
    def young(self) -> float:
        """Young's modulus E = 2 G (1 + nu), MPa."""
        return 2 * self.shear * (1 + self.poisson)

    @property
    def unit_body(self) -> "Material":
        """Material with the shear modulus 1 and equal Poisson's ratio."""
        return Material(1.0, self.poisson)

    @property
    def compliances(self) -> np.ndarray:
        """Response k (S_zz, S_LL, S_TT, |S_Lz|) of the surface to waves, 1/MPa, shape (4,).

        See `tractive_sam.mechanics.layers`.
        """
        nu = self.poisson
        return np.array((1.0 - nu, 1.0 - nu, 1.0, 0.5 - nu)) / self.shear


@dataclass(frozen=True)
class CombinedMaterial:
    """Elastic constants of one half-space that is equivalent to the pair of bodies (eq. 45).

    Parameters
    ----------
    shear : float
        Combined shear modulus G, MPa.
    poisson : float
        Combined Poisson's ratio nu.
    coupling : float
        K, which couples the normal to the tangential problem; 0 for equal materials, positive if
        the upper body A is the more compliant one.

    Examples
    --------
    >>> steel, aluminium = Material.from_young(208e3, 0.3), Material.from_young(70e3, 0.33)
    >>> combine(aluminium, steel).coupling > 0.0
    True
    """

    shear: float
    poisson: float
    coupling: float
    recorded_name = "tractive_sam.mechanics.material.CombinedMaterial"

    @property
    def plane_strain_modulus(self) -> float:
        """Contact modulus E* = G / (1 - nu), MPa."""
        return self.shear / (1 - self.poisson)

    @property
    def E_star(self) -> float:
        """Contact modulus E* = G / (1 - nu), MPa, as `plane_strain_modulus`."""
        return self.plane_strain_modulus


def combine(A: Material, B: Material) -> CombinedMaterial:
    """Return the elastic constants of the pair of the upper body A and the lower body B.

    Source: Juliá & Rodríguez-Tembleque, Int. J. Mech. Sci. 294 (2025) 110195, eq. (45). One of
    the two bodies may be rigid, ``shear=math.inf``.

    Raises
    ------
    ValueError
        If both bodies are rigid.

    Examples
    --------
    >>> steel = Material.from_young(208e3, 0.3)
    >>> round(combine(steel, steel).E_star)
    114286
    """
    compliance = (1 / A.shear + 1 / B.shear) / 2
    if compliance == 0:
        raise ValueError("at least one of the two bodies must be elastic")
    lateral = (A.poisson / A.shear + B.poisson / B.shear) / 2
    mismatch = ((1 - 2 * A.poisson) / A.shear - (1 - 2 * B.poisson) / B.shear) / 4
    return CombinedMaterial(1 / compliance, lateral / compliance, mismatch / compliance)


PARITIES = MappingProxyType(
    {"xx": (1, 1), "xy": (-1, -1), "yy": (1, 1), "zz": (1, 1), "xz": (-1, 1), "yz": (1, -1)}
)
"""Parity in x and in y, 1 (even) or -1 (odd), of the six independent influence coefficients.

By reciprocity A_zx(x, y) = A_xz(-x, -y).
"""


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

    shared: ClassVar[bool] = False
    """Whether equal laws of the class itself, on small meshes, share operators that are stored."""

    @property
    def coupled(self) -> bool:
        """Whether pressure causes tangential and traction normal displacement; default False.

        The default is False: "xz" and "yz" of `coefficients` are not used.
        """
        return False

    @property
    def coupling(self) -> str:
        """Text for the bodies of a `coupled` law, as a description names them."""
        return "unlike bodies"

    @property
    def symmetric(self) -> bool:
        """Whether normal and tangential displacement are symmetric in the elements; default True.

        The default is True: bodies store energy. If False, the law has the coefficients of `lag`.
        """
        return True

    @property
    def layer(self) -> float:
        """Shear compliance of an interfacial layer between the surfaces, mm/MPa; default 0."""
        return 0.0

    def parts(self, component: str) -> Mapping[str, tuple[int, int]]:
        """Return the parts of a component, with their parity in x and in y; default: one part.

        A law without symmetry about the axes splits its coefficients; `coefficients` has a table
        for each part.

        Parameters
        ----------
        component : str
            See `coefficients`.

        Returns
        -------
        mapping
            Parity, 1 (even) or -1 (odd), in x and y, by the name of the part: the component itself,
            followed by further characters for parts with another parity.
        """
        return {component: PARITIES[component]}

    @property
    def interchangeable(self) -> bool:
        """Whether u_x by p_y is u_y by p_x at each place, not only for exchanged places."""
        return all(x * y > 0 for x, y in self.parts("xy").values())

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

    def lag(self, component: str, offsets: tuple[int, int], dx: float, dy: float) -> np.ndarray:
        """Return the part of the coefficients of a law that is not `symmetric`; default: zero.

        Its parity in x is opposite to that of `coefficients`, to which it adds. See there for the
        parameters.
        """
        return np.zeros(offsets)

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
        ndarray, shape (m, 2, 2) or (m, 2, 3)
            Dimensionless; by default the ratio of the displacements of an element by a unit load
            on it. A third column is the tangential displacement by pressure alone.
        """
        xx, yy, zz = (self.coefficients(k, (1, 1), dx, dy)[0, 0] for k in ("xx", "yy", "zz"))
        return np.broadcast_to(np.diag([xx / zz, yy / zz]), (normal.shape[1], 2, 2))

    def periodic(
        self, component: str, period: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray | None:
        """Return the spectrum of periodic displacements, for preconditioners; default: None.

        A law defines it if the coefficients within a period have a spectrum that is not positive.

        Parameters
        ----------
        component : str
            One of "xx", "xy", "yy", "zz".
        period : (int, int)
            (p_x, p_y), elements.
        dx, dy : float
            Sides of an element, mm.

        Returns
        -------
        ndarray, shape (p_x, p_y/2 + 1), or None
            mm/MPa, without division by the number of elements; None: that of the coefficients.
        """
        return None

    def spanning(self, length: float) -> "Elasticity":
        """Return the law for a mesh of a length in x, mm, as strips need; default: this law."""
        return self

    def worn(self, depths: tuple[float, float], step: float) -> "Elasticity":
        """Return the law without worn depths of both bodies, mm, in steps; default: this law.

        Parameters
        ----------
        depths : (float, float)
            mm.
        step : float
            See `SurfaceResponse.worn`.
        """
        return self

    def ends_on(self, shape: tuple[int, int], dx: float, dy: float, first: float) -> Any:
        """Return what ends of the bodies add to the normal displacement on a mesh; default: None.

        Parameters
        ----------
        shape : tuple of int
            Elements (n_x, n_y).
        dx, dy : float
            Sides of an element, mm.
        first : float
            Position y of the middle of the first row, mm.

        Returns
        -------
        mechanics.free_ends.EndResponse or None
            Map from pressure to displacement, mm/MPa; None for bodies without ends.
        """
        return None

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
    shared = True

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

    @property
    def coupling(self) -> str:
        """Text for the bodies, with K."""
        return f"unlike bodies (K = {self.material.coupling:.4g}, 0 for like bodies)"

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the influence coefficients of two half-spaces for all offsets, mm/MPa.

        They are displacements u_A - u_B at the centre of an element per uniform unit traction on
        another one.

        Parameters as in `Elasticity.coefficients`.
        """
        r1, xx, yy, xy, x2, y2 = integrals_of(dy / dx).at(*offsets)
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
        return dx / (np.pi * self.material.shear) * entry

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

    The element has the length 1: integrals are proportional to its size, and coarser meshes share
    them. The table has as many offsets as were needed so far: a rectangle around the contact has
    the elements of its mesh.
    """

    def __init__(self, aspect: float) -> None:
        self._aspect, self._table = aspect, np.empty((6, 0, 0))

    def at(self, nx: int, ny: int) -> np.ndarray:
        """Return the six kernel integrals at offsets below (nx, ny) elements, (6, nx, ny)."""
        stored_x, stored_y = self._table.shape[1:]
        if nx > stored_x or ny > stored_y:
            self._table = quadrant(max(nx, stored_x), max(ny, stored_y), 1.0, self._aspect)
        return self._table[:, :nx, :ny]


integrals_of = lru_cache(maxsize=32)(_ElementIntegrals)
"""The integrals of elements by their width over their length."""


def _member_of_bodies(name: str) -> Any:
    """Return a member that an interfacial layer does not change: an attribute of its bodies."""
    text = f"`Elasticity.{name}` of the bodies; the layer does not change it."
    return property(attrgetter(f"bodies.{name}"), doc=text)


@dataclass(frozen=True)
class InterfacialLayer(Elasticity):
    """Elastic bodies with an interfacial layer, whose shear is compliance times traction.

    A layer of the thickness h and the shear modulus G3 has the compliance L = h/G3 (the third body
    of Vollebregt 2014, Wear 314, 151-157). It adds L dp_t/dx to the slip and reduces the initial
    slope of the creep force curve. It has no normal compliance, and no influence on the stress in
    the bodies under given tractions.

    Parameters
    ----------
    bodies : Elasticity
        The bodies without the layer.
    compliance : float
        L, mm/MPa.

    Examples
    --------
    >>> laws = ts.Laws.of(scene)
    >>> third_body = laws.replace(elasticity=ts.InterfacialLayer(laws.elasticity, compliance=0.5))
    >>> ts.solve(scene, laws=third_body).Qx < contact.Qx
    True
    """

    bodies: Elasticity
    compliance: float
    recorded_name = "tractive_sam.mechanics.layer.Layered"

    coupled = _member_of_bodies("coupled")
    coupling = _member_of_bodies("coupling")
    symmetric = _member_of_bodies("symmetric")
    lag = _member_of_bodies("lag")
    parts = _member_of_bodies("parts")
    gap_per_pressure = _member_of_bodies("gap_per_pressure")
    opening = _member_of_bodies("opening")
    ends_on = _member_of_bodies("ends_on")
    single_body = _member_of_bodies("single_body")

    @property
    def layer(self) -> float:
        """Shear compliance of the interfacial layer, mm/MPa (`Elasticity.layer`)."""
        return self.compliance

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the influence coefficients of the bodies with the shear of the layer, mm/MPa.

        A traction shears only the layer at its own element.

        Parameters as in `Elasticity.coefficients`.
        """
        table = self.bodies.coefficients(component, offsets, dx, dy)
        if component in ("xx", "yy"):
            table = table.copy()
            table[0, 0] += self.compliance
        return table

    def slip_per_traction(self, dx: float, dy: float) -> float:
        """Return the unit of slip over that of traction, 1/MPa: bodies plus compliance/dx."""
        return self.bodies.slip_per_traction(dx, dy) + self.compliance / dx

    def periodic(
        self, component: str, period: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray | None:
        """Return the spectrum of the bodies plus the compliance of the layer; None if unknown.

        Parameters as in `Elasticity.periodic`.
        """
        spectrum = self.bodies.periodic(component, period, dx, dy)
        if spectrum is not None and component in ("xx", "yy"):
            return spectrum + self.compliance
        return spectrum

    def spanning(self, length: float) -> "InterfacialLayer":
        """Return bodies and layer for a mesh of the given length in x, mm."""
        return InterfacialLayer(self.bodies.spanning(length), self.compliance)

    def worn(self, depths: tuple[float, float], step: float) -> "InterfacialLayer":
        """Return the law with worn bodies (`Elasticity.worn`); the layer between them remains."""
        return InterfacialLayer(self.bodies.worn(depths, step), self.compliance)


@dataclass(frozen=True)
class SpectralHalfSpaces(HalfSpaces):
    """Elasticity of coated or graded half-spaces; a subclass defines `surface` and `spectrum`.

    Parameters
    ----------
    A, B : Material
        The materials far below the surface.
    length : float
        Depth over which the material changes, mm, for example the thickness of a coating.

    Examples
    --------
    >>> class Same(ts.SpectralHalfSpaces):
    ...     @property
    ...     def surface(self):
    ...         return ts.HalfSpaces(self.A, self.B)
    ...
    ...     def spectrum(self, component, kx, ky):
    ...         return self.surface.response(component, kx, ky)
    >>> bodies = ts.Laws.of(scene).elasticity
    >>> same = Same(bodies.A, bodies.B, 0.5)
    >>> table = same.coefficients("zz", (9, 9), 0.1, 0.1)
    >>> bool(np.allclose(table, bodies.coefficients("zz", (9, 9), 0.1, 0.1)))
    True
    """

    odd: ClassVar[Mapping[str, str]] = MappingProxyType({"xy": "xy", "xz": "x", "yz": "y"})
    """Axes along which a component is odd."""

    length: float

    @property
    @abstractmethod
    def surface(self) -> HalfSpaces:
        """Homogeneous half-spaces of the surface materials: the limit for short waves."""

    @abstractmethod
    def spectrum(self, component: str, kx: np.ndarray, ky: np.ndarray) -> np.ndarray | None:
        """Return displacement u_A - u_B over traction at wave numbers; None if as far below.

        Parameters
        ----------
        component : str
            See `Elasticity.coefficients`.
        kx, ky : ndarray, shapes (n, 1) and (1, m)
            Wave numbers of at least 0, not both 0, 1/mm.

        Returns
        -------
        ndarray, shape (n, m), or None
            mm/MPa; imaginary for "xz" and "yz". None: as for the materials far below.
        """

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return influence coefficients: displacement u_A - u_B per unit traction on an element.

        Parameters as in `Elasticity.coefficients`.
        """
        below = HalfSpaces(self.A, self.B)
        if self.spectrum(component, np.ones((1, 1)), np.ones((1, 1))) is None:
            return below.coefficients(component, offsets, dx, dy)
        # A rectangle around the contact has the elements of its mesh.
        nx, ny = offsets
        table = self._tables.get((component, dx, dy), np.empty((0, 0)))
        if nx > table.shape[0] or ny > table.shape[1]:
            wider = max(nx, table.shape[0]), max(ny, table.shape[1])
            # At a height of two elements the kernel is smooth enough for its quadrature over one.
            height = max(self.length, 2.0 * dx, 2.0 * dy)
            table = self.surface.coefficients(component, wider, dx, dy)
            table = table + _raised(below, self.surface, component, wider, dx, dy, height)
            table = table + self._remainder(below, component, wider, dx, dy, height)
            self._tables[component, dx, dy] = table
            if len(self._tables) > 48:  # six components of eight meshes
                del self._tables[next(iter(self._tables))]
        return table[:nx, :ny]

    @cached_property
    def _tables(self) -> dict[tuple[str, float, float], np.ndarray]:
        """Coefficients that were computed so far, by component and sides."""
        return {}

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """Return length / E*, the scale of gaps over pressures, of the materials far below.

        Parameters as in `Elasticity.gap_per_pressure`.

        Raises
        ------
        ValueError
            If elements are longer than 12 times the depth over which the material changes.
        """
        # The shortest waves of `_remainder` then miss 1e-4 of the influence of an element on
        # itself; at 50 times the depth .6 %, for a soft coating (1/10).
        if max(dx, dy) > 12.0 * self.length:
            raise ValueError(
                f"grid.elements: elements of {dx:g} x {dy:g} mm are longer than 12 times the depth "
                f"over which the material changes, {self.length:g} mm; use smaller elements, or "
                "layers, [[body.A.layer]], which may be thinner"
            )
        return super().gap_per_pressure(length, dx, dy)

    def _remainder(
        self,
        below: HalfSpaces,
        component: str,
        offsets: tuple[int, int],
        dx: float,
        dy: float,
        height: float,
    ) -> np.ndarray:
        """Return the part of the influence coefficients without closed form, by sums over waves."""
        odd = self.odd.get(component, "")
        kx, along = _waves(offsets[0], dx, self.length, height, "x" in odd)
        ky, across = _waves(offsets[1], dy, self.length, height, "y" in odd)
        values = self._rest(below, component, kx[:, None], ky[None, :], height)
        return (-1.0 if odd else 1.0) * (along @ values @ across.T)

    def _rest(
        self, below: HalfSpaces, component: str, kx: np.ndarray, ky: np.ndarray, height: float
    ) -> np.ndarray:
        """Return the part of the response at wave numbers that has no closed form, real values."""
        at_surface = self.surface.response(component, kx, ky)
        far = below.response(component, kx, ky) - at_surface
        values = self.spectrum(component, kx, ky) - at_surface
        values = values - far * np.exp(-height * np.hypot(kx, ky))
        return np.array(values.imag if component in ("xz", "yz") else values.real)


def _waves(
    count: int, side: float, length: float, height: float, odd: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return wave numbers (m,), 1/mm, and weighted cosines (sines if odd) at offsets, (count, m).

    The shortest wave has exp(-k length) = 1e-8, or a length of an eighth of an element: the mean
    over an element of shorter waves is negligible. Gauss points in equal intervals resolve the
    waves over the longest offset and the response over the height to 1e-8. For long waves the
    response has a limit that depends on their direction, and a stiff coating bends over many
    heights: the first interval is divided twice more, each time by 32.
    """
    points, weights = np.polynomial.legendre.leggauss(32)
    shortest = min(18.0 / length, 16.0 * np.pi / side)
    width = min(56.0 / (count * side), 16.0 / height)
    equal = np.linspace(0.0, shortest, int(np.ceil(shortest / width)) + 1)
    edges = np.concatenate([[0.0], equal[1] / 32.0 ** np.array([2, 1]), equal[1:]])
    half = 0.5 * np.diff(edges)[:, None]
    k = (edges[:-1, None] + half * (1.0 + points)).ravel()
    phase = np.outer(side * np.arange(count), k)
    mean = side * np.sinc(0.5 * side * k / np.pi)
    return k, (half * weights).ravel() / np.pi * mean * (np.sin(phase) if odd else np.cos(phase))


def _raised(
    below: HalfSpaces,
    surface: HalfSpaces,
    component: str,
    offsets: tuple[int, int],
    dx: float,
    dy: float,
    height: float,
) -> np.ndarray:
    """Return coefficients of (response below - at surface) exp(-k height), by quadrature."""
    points, weights = np.polynomial.legendre.leggauss(6)  # 1e-9 at a height of two elements
    table = np.zeros(offsets)
    x, y = (side * np.arange(n) for side, n in zip((dx, dy), offsets, strict=True))
    for at_x, of_x in zip(points, weights, strict=True):
        for at_y, of_y in zip(points, weights, strict=True):
            place = (x + 0.5 * dx * at_x)[:, None], (y + 0.5 * dy * at_y)[None, :]
            kernels = (
                _kernel(spectrum, component, *place, height) for spectrum in (below, surface)
            )
            far, near = kernels
            table += 0.25 * of_x * of_y * (far - near)
    return dx * dy * table


def _kernel(
    bodies: HalfSpaces, component: str, x: np.ndarray, y: np.ndarray, height: float
) -> np.ndarray:
    """Return the displacement at (x, y) due to a unit force, its waves damped by exp(-k height)."""
    nu, K = bodies.material.poisson, bodies.material.coupling
    r = np.sqrt(x**2 + y**2 + height**2)
    reach = r + height
    match component:
        case "zz":
            entry = (1.0 - nu) / r
        case "xx" | "yy":
            along = x if component == "xx" else y
            entry = 1.0 / r - nu * (1.0 / reach - along**2 / (r * reach**2))
        case "xy":
            entry = nu * x * y / (r * reach**2)
        case "xz":
            entry = -K * x / (r * reach)
        case "yz":
            entry = -K * y / (r * reach)
    return entry / (np.pi * bodies.material.shear)
