"""Conforming bodies: a body in a groove, or a cylinder in a bore, with a contact that is curved.

The patch is part of a cylinder of the mean radius R, and the position across it is an arc, R times
an angle. A point contact curves across the track (y = R theta, x along the axis of the cylinder), a
line contact along it (x = R theta). Both bodies respond as a solid cylinder and as a cylindrical
hole in an infinite body.

Under tractions exp(i (n theta + k x)), the displacement of a cylinder or a hole is a sum of three
fields of the harmonic functions phi = I_n(k r) or K_n(k r): grad phi, curl(phi e_x), and the field
of Papkovich and Neuber with the vector B = (d_y, d_z) phi,

    4 (1 - nu) B - grad(r d phi/dr).

All three, and their stress, follow from the logarithmic derivative k phi'/phi alone, and this from
the ratio of neighbouring Bessel functions, by recursions that neither overflow nor lose digits.

The influence coefficients are those of half-spaces at the distance of points in space (the chord)
plus a sum over the waves of the difference of both responses. The latter decreases with the third
power of the wave number. By Graf's addition theorem, the response of the chord is 4 R (1 - nu)/G
times I_n K_n. The waves n = 0 and n = 1 are those of the chord: a cylinder as long as it is thick
is neither pinched as a ring nor bent as a beam by its neighbours.

In the plane the sum of both bodies is n/(n² - 1) in place of 1/n (Michell), and its kernel
-cos t ln(2 sin(t/2)) in place of -ln t.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.kernels.half_space import integrate_logarithm
from tractive_sam.mechanics.elasticity import PARITIES, HalfSpaces, Material, Strips
from tractive_sam.mechanics.hertz_contact import ContactPatch


@dataclass(frozen=True)
class CurvedPatch(ContactPatch):
    """Geometry and motion of a contact that curves across the track, or along it in the plane.

    Parameters
    ----------
    A, B : tuple of float
        R_x and R_y of each body at the middle of the patch, mm; negative if concave.
    angle : float
        Contact angle at the middle of the patch, rad: between its normal and the plane in which the
        bodies roll. It grows with y.
    line : bool
        Whether the patch curves along x, in the plane.

    Examples
    --------
    >>> patch = ts.mechanics.CurvedPatch((10.0, 10.0), (np.inf, -10.2))
    >>> patch.radius, round(patch.clearance, 6), patch.concave
    (10.1, 0.2, 'B')
    """

    A: tuple[float, float]
    B: tuple[float, float]
    angle: float = 0.0
    line: bool = False
    is_flat = False

    @property
    def across(self) -> tuple[float, float]:
        """Radii of A and of B in the plane in which the patch curves, mm."""
        k = 0 if self.line else 1
        return self.A[k], self.B[k]

    @property
    def concave(self) -> str:
        """The concave body, "A" or "B"."""
        return "A" if self.across[0] < self.across[1] else "B"

    @property
    def rise(self) -> float:
        """1 if the patch rises into A beside its middle (B is concave), else -1."""
        return 1.0 if self.concave == "B" else -1.0

    @property
    def clearance(self) -> float:
        """Radius of the hole less that of the body in it, mm."""
        return -float(sum(self.across))

    @property
    def radius(self) -> float:
        """Mean radius R of both surfaces, mm: that of the patch."""
        return 0.5 * (max(self.across) - min(self.across))

    def normal(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return -rise sin(theta) and cos(theta) (`ContactPatch.normal`)."""
        theta = ((x if self.line else y) + 0.0 * (y if self.line else x)) / self.radius
        return -self.rise * np.sin(theta), np.cos(theta)

    def gap(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the separation of the undeformed surfaces along the normal, mm.

        It is c (1 - cos theta), with a term of the third order in the clearance c, plus x²/2 times
        the curvatures of the surfaces of revolution in the plane of x and the normal (Meusnier).
        """
        lateral, cosine = self.normal(x, y)
        # The centres of both circles are c/2 from that of the patch; rays from it meet both.
        aside = 0.5 * self.clearance * lateral
        reach = sum(np.sqrt(radius**2 - aside**2) for radius in self.across)
        gap = self.clearance * (1.0 - cosine + (2.0 * self.radius / reach - 1.0))
        if self.line:
            return gap
        theta, curvature = y / self.radius, 0.0
        cosine = np.cos(self.angle + theta)
        for (radius_x, radius_y), away in ((self.A, -1.0), (self.B, 1.0)):
            # Distance from the axis of revolution, with the sign of the curvature.
            raised = self.rise * abs(radius_y) * (np.cos(self.angle) - cosine)
            curvature = curvature + cosine / (radius_x * np.cos(self.angle) + away * raised)
        return gap + 0.5 * x**2 * curvature

    def slip(
        self, x: np.ndarray, y: np.ndarray, longitudinal: float, lateral: float, spin: float
    ) -> np.ndarray:
        """Return the slip s/V by creepages at the middle of the patch, without `rolling_slip`.

        A lateral creepage is that of a yaw: a velocity in the plane that the contact angle is
        measured from, with this component in the plane of the middle.

        Parameters as in `ContactPatch.slip`.
        """
        if self.line:
            return super().slip(x, y, longitudinal, lateral, spin)
        theta = y / self.radius
        turned = np.cos(self.angle + theta) / np.cos(self.angle)
        along = longitudinal - spin * self.radius * np.sin(theta)
        across = lateral * turned + spin * x * np.cos(theta)
        return np.stack(np.broadcast_arrays(along, across))

    def rolling_slip(self, x: np.ndarray, y: np.ndarray) -> np.ndarray | float:
        """Return the slip s/V of bodies that roll without creepage (Heathcote), (2, n_x, n_y).

        Points beside the middle have other distances from the axes of rotation. The local spin is
        -rise sin(theta)/R_x, with R_x the combined radius in the rolling direction.
        """
        if self.line:
            return 0.0
        theta = y / self.radius
        curvature = self.rise * (1.0 / self.A[0] + 1.0 / self.B[0])
        along = curvature * self.radius * (1.0 - np.cos(theta)) + 0.0 * x
        return np.stack(np.broadcast_arrays(along, -curvature * x * np.sin(theta)))

    def elasticity(self, A: Material, B: Material) -> HalfSpaces:
        """Return the elastic law of bodies of two materials."""
        law = ConformalLine if self.line else ConformalBodies
        return law(A, B, self.radius, self.concave)


@dataclass(frozen=True)
class ConformalBodies(HalfSpaces):
    """Elasticity of a cylinder in a cylindrical groove, of a patch that curves across the track.

    Pressure causes tangential displacement also in bodies of equal material, as one is convex and
    the other one concave.

    Parameters
    ----------
    A, B : Material
        The upper and the lower body.
    radius : float
        Mean radius R of both, mm.
    concave : str
        The body with the groove, "A" or "B".

    Examples
    --------
    >>> steel = ts.Material.from_young(208e3, 0.3)
    >>> bodies = ts.ConformalBodies(steel, steel, 10.0)
    >>> here, there = bodies.coefficients("yz", (1, 9), 0.1, 0.1)[0, [0, 8]]
    >>> bool(here == 0.0 and there != 0.0)
    True
    """

    radius: float
    concave: str = "B"

    @property
    def coupled(self) -> bool:
        """Whether pressure causes tangential displacement: True."""
        return True

    @property
    def coupling(self) -> str:
        """Text for the bodies, with K."""
        return f"a convex and a concave body (K = {self.material.coupling:.4g})"

    def spectrum(self, n: np.ndarray, k: np.ndarray) -> Mapping[str, np.ndarray]:
        """Return displacement u_A - u_B over traction at waves around and along the cylinder.

        Parameters
        ----------
        n : ndarray of int, shape (m,)
            Waves around the circumference, at least 2, ascending.
        k : ndarray, shape (l,)
            Wave numbers along the axis, above 0, 1/mm.

        Returns
        -------
        dict of str to ndarray, shape (m, l)
            By component, mm/MPa; of "xz" and "yz" the imaginary parts.
        """
        return self._components(*_logarithmic_derivatives(n, k * self.radius), n, k)

    def _components(
        self, solid: np.ndarray, hole: np.ndarray, n: np.ndarray, k: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Return the response by component, from the logarithmic derivatives of I_n and K_n."""
        inner, outer = (self.A, self.B) if self.concave == "B" else (self.B, self.A)
        kappa, n = np.broadcast_arrays(k * self.radius, n[:, None])
        C = _compliance(n, kappa, solid, inner.poisson) / inner.shear
        C = (C - _compliance(n, kappa, hole, outer.poisson) / outer.shear) * self.radius
        # The pressure on A acts against the radius if A is the cylinder.
        turned = -1.0 if self.concave == "B" else 1.0
        return {
            "zz": C[0, 0],
            "yy": C[1, 1],
            "xx": C[2, 2],
            "xy": C[2, 1],
            "xz": turned * C[2, 0],
            "yz": turned * C[1, 0],
        }

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return influence coefficients: displacement u_A - u_B per unit traction on an element.

        Parameters as in `Elasticity.coefficients`.
        """
        flat = super().coefficients(component, offsets, dx, dy)
        return flat + _differences(self, offsets, dx, dy)[component]


@lru_cache(16)
def _differences(
    law: ConformalBodies, offsets: tuple[int, int], dx: float, dy: float, most: int = 200
) -> dict[str, np.ndarray]:
    """Return the influence coefficients less those of half-spaces, by component.

    Waves up to the length of an element are added, at most 200 around the circumference: the
    difference of shorter ones is less than 1e-6 of the displacement by an element.
    """
    (nx, ny), R = offsets, law.radius
    x, y = dx * np.arange(nx), dy * np.arange(ny)
    nu, G, K = law.material.poisson, law.material.shear, law.material.coupling
    n = np.arange(2, int(min(2.0 * np.pi * R / dy, most)) + 2)
    # Intervals that resolve the waves over the longest offset, and the response around k R = n.
    shortest, edges = min(2.0 * np.pi / dx, most / R), [0.0]
    while edges[-1] < shortest:
        edges.append(edges[-1] + min(20.0 / (nx * dx), max(6.0 / R, 0.5 * edges[-1])))
    points, weights = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(edges)[:, None]
    k = (np.array(edges[:-1])[:, None] + half * (1.0 + points)).ravel()
    # Mean over an element, and both signs of n and of k.
    along = (half * weights).ravel() * dx * np.sinc(0.5 * dx * k / np.pi)
    across = dy * np.sinc(0.5 * dy * n / (np.pi * R)) / (np.pi**2 * R)
    solid, hole = _logarithmic_derivatives(n, k * R)
    values, product = law._components(solid, hole, n, k), 1.0 / (solid - hole)
    slope, waves = product * (solid + hole), n[:, None]
    square = (waves / R) ** 2 + k**2
    chord = {
        "zz": (1.0 - nu) * product,
        "xx": product + nu * slope,
        "yy": (1.0 - nu) * product - nu * slope,
        "xy": nu * waves * slope / (k * R),
        "xz": 0.5 * K * k / (R * square),
        "yz": 0.5 * K * waves / R**2 / square,
    }
    phase_x, phase_y = np.outer(k, x), np.outer(n, y / R)
    table = {}
    for component, (even_x, even_y) in PARITIES.items():
        difference = values[component] - 4.0 * R / G * chord[component]
        waves_x = (np.cos if even_x > 0 else np.sin)(phase_x) * along[:, None]
        waves_y = (np.cos if even_y > 0 else np.sin)(phase_y) * across[:, None]
        sign = min(even_x, even_y)
        table[component] = sign * (waves_x.T @ difference.T @ waves_y)
    _add_chord(table, law, (x, y), (dx, dy))
    return table


def _add_chord(
    table: dict[str, np.ndarray],
    law: ConformalBodies,
    offsets: tuple[np.ndarray, np.ndarray],
    sides: tuple[float, float],
) -> None:
    """Add the displacement by loads at the distance of the chord less that at the arc, in place.

    The difference is of the order of the distance over R². The coupling of unlike bodies is that of
    loads at all turns around the cylinder; only its mean (n = 0) is that of one turn.
    """
    points, weights = np.polynomial.legendre.leggauss(4)  # an even number: no point is the centre
    nu, c = law.material.poisson, 0.25 * np.prod(sides) / (np.pi * law.material.shear)
    K, R = law.material.coupling, law.radius
    for i, j in np.ndindex(4, 4):
        x = (offsets[0] + 0.5 * sides[0] * points[i])[:, None]
        y = (offsets[1] + 0.5 * sides[1] * points[j])[None, :]
        arc = np.hypot(x, y)
        chord = np.hypot(x, 2.0 * law.radius * np.sin(0.5 * y / law.radius))
        near, along = 1.0 / chord - 1.0 / arc, x**2 * (1.0 / chord**3 - 1.0 / arc**3)
        share = c * weights[i] * weights[j]
        table["zz"] += share * (1.0 - nu) * near
        table["xx"] += share * ((1.0 - nu) * near + nu * along)
        table["yy"] += share * (near - nu * along)
        turned = law.radius * np.sin(y / law.radius) / chord**3 - y / arc**3
        table["xy"] += share * nu * x * turned
        if K:
            turns = 2.0 * R * (np.cosh(np.minimum(np.abs(x / R), 300.0)) - np.cos(y / R))
            along_x = np.sinh(np.clip(x / R, -300.0, 300.0)) / turns - x / arc**2
            table["xz"] -= share * K * (along_x - np.arctan(x / (np.pi * R)) / (np.pi * R))
            table["yz"] -= share * K * (np.sin(y / R) / turns - y / arc**2)


def _logarithmic_derivatives(n: np.ndarray, kappa: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return kappa I_n'/I_n and kappa K_n'/K_n at waves n (m,) and kappa (l,), both (m, l).

    The ratios of neighbouring functions follow downwards for I, upwards for K (both stable). Their
    difference is 1/(I_n K_n), the Wronskian.
    """
    last = int(n[-1])
    solid, hole = np.empty((2, last + 1, kappa.size))
    first = last + 30
    ratio = kappa / (first + np.hypot(first, kappa))
    for m in range(first - 1, -1, -1):
        ratio = 1.0 / (2.0 * (m + 1) / kappa + ratio)  # I_(m+1)/I_m
        if m <= last:
            solid[m] = m + kappa * ratio
    ratio = scipy.special.k1e(kappa) / scipy.special.k0e(kappa)
    hole[0] = -kappa * ratio
    for m in range(1, last + 1):
        ratio = 2.0 * m / kappa + 1.0 / ratio  # K_(m+1)/K_m
        hole[m] = m - kappa * ratio
    return solid[n], hole[n]


def _compliance(n: np.ndarray, kappa: np.ndarray, a: np.ndarray, nu: float) -> np.ndarray:
    """Return displacement over stress at the surface of a cylinder with R = G = 1, (3, 3, m, l).

    Displacements (u_r, u_theta/i, u_x/i) over stresses (s_rr, s_rtheta/i, s_rx/i), both of
    exp(i (n theta + kappa x)).

    Parameters
    ----------
    n, kappa, a : ndarray, shape (m, l)
        Waves, and the logarithmic derivative of I_n or K_n at kappa.
    nu : float
        Poisson's ratio.
    """
    square, zero = n * n + kappa * kappa, np.zeros_like(a)
    second = square - a  # of Bessel's equation, and its derivative
    third = a - second - 2.0 * n * n + square * a
    u = np.stack((a, n + zero, (3.0 - 4.0 * nu) * a - second))
    v = np.stack((n + zero, a, n * (4.0 * (1.0 - nu) - a)))
    w = np.stack((kappa + zero, zero, -kappa * a))
    du = np.stack((second, n * (a - 1.0), (2.0 - 4.0 * nu) * second - third))
    dv = np.stack((n * (a - 1.0), second, n * (4.0 * (1.0 - nu) * (a - 1.0) - second)))
    dw = np.stack((kappa * a, zero, -kappa * (a + second)))
    # Only the third field changes the volume.
    pressed = np.stack((zero, zero, 4.0 * nu * kappa * kappa + zero))
    stress = np.stack((pressed + 2.0 * du, n * u + dv - v, kappa * u + dw), axis=-1)
    first, other, last = stress
    cofactors = np.stack((np.cross(other, last), np.cross(last, first), np.cross(first, other)))
    determinant = (first * cofactors[0]).sum(axis=-1)
    return np.einsum("ifml,fmlj->ijml", np.stack((u, v, w)), cofactors / determinant[..., None])


@dataclass(frozen=True)
class ConformalLine(Strips):
    """Elasticity of a disc in a hole in plane strain, of a line contact that curves along x.

    The approach is relative to surface points at the distance R, as for `Strips`.

    Parameters
    ----------
    A, B : Material
        The upper and the lower body.
    datum : float
        Mean radius R of both, mm.
    concave : str
        The body with the hole, "A" or "B".
    """

    concave: str = "B"

    @property
    def coupled(self) -> bool:
        """Whether pressure causes tangential displacement that matters: False, without friction."""
        return False

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the normal displacement of a strip per unit pressure on another, mm/MPa.

        Parameters as in `Elasticity.coefficients`.

        Raises
        ------
        ValueError
            If the component is not "zz": the law is for contacts without friction.
        """
        if component != "zz":
            raise ValueError(
                f'{component}: a line contact that curves has normal coefficients "zz"'
            )
        inner, outer = (self.A, self.B) if self.concave == "B" else (self.B, self.A)
        shears = [(0.5 - body.poisson) / body.shear for body in (inner, outer)]
        mismatch, uniform = shears[1] - shears[0], 0.125 / outer.shear - 0.125 / inner.shear
        x, table = dx * np.arange(offsets[0]), np.zeros(offsets)
        c = (1.0 - self.material.poisson) / (np.pi * self.material.shear)
        table[:, 0] = c * integrate_logarithm(x, dx, self.datum)
        points, weights = np.polynomial.legendre.leggauss(4)
        for point, weight in zip(points, weights, strict=True):
            t = np.abs(x + 0.5 * dx * point) / self.datum
            t = np.minimum(t, 2.0 * np.pi - 1e-9)
            cosine = np.cos(t)
            smooth = np.log(t) - cosine * np.log(2.0 * np.sin(0.5 * t)) - 0.25 * (1.0 - cosine)
            # Of unequal bodies the waves 1/(n² - 1), n >= 2, and the uniform pressure.
            unequal = mismatch * (0.25 * (1.0 - cosine) - 0.5 * (np.pi - t) * np.sin(t))
            unequal += uniform * (1.0 - cosine)
            table[:, 0] += 0.5 * dx * weight * (2.0 * c * smooth + unequal / np.pi)
        return table

    def spanning(self, length: float) -> "ConformalLine":
        """Return the law itself: its operator is positive definite for any mesh on the circle."""
        return self
