"""Anisotropic half-spaces: homogeneous bodies with any elastic stiffness.

A wave of traction with the wave number k in the direction theta displaces the surface by S(theta)/k
times the traction. S is Hermitian; its real part, which is even, and its imaginary part, which is
odd, change with the direction. Displacements of the form a exp(i k (x + p z)) satisfy equilibrium
for three p with a positive imaginary part (Stroh). The sum of their spaces determines S, also where
two or three p are equal, as in an isotropic material; single eigenvectors do not exist there. It is
found without them, by the sign function of Stroh's matrix N: the limit J of

    J <- (J - J^-1)/2,    J = N at first,

has the eigenvalue i on this space and -i on the conjugate one. Its blocks are the integrals of
Barnett and Lothe (Ting, Anisotropic Elasticity (1996), chapters 5 to 7).

A harmonic exp(i n theta)/k of the response is the displacement i^n exp(i n phi)/(2 pi r) by a unit
force, in polar coordinates, as the integral of a Bessel function J_n over its argument is 1 for
every n. The Fourier series of S is therefore that of the displacement. Its integral over an element
has a closed form for each harmonic, so that neither a quadrature nor a period changes the result.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.kernels.half_space import integrate_logarithm, integrate_sign
from tractive_sam.mechanics.elasticity import PARITIES, Elasticity, Material, SurfaceResponse
from tractive_sam.mechanics.hertz_contact import HertzContact, HertzLine, hertz_line
from tractive_sam.mechanics.layers import LinearHalfSpaces

_VOIGT = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
"""Component in the notation of Voigt of the axes i, j of a stress."""


@dataclass(frozen=True)
class AnisotropicMaterial(SurfaceResponse):
    """Linear elastic material with any stiffness.

    Parameters
    ----------
    stiffness : tuple of 6 tuples of 6 float
        Symmetric matrix C_ij of Voigt, MPa; the indices 1, 2, 3 are the axes x, y, z of the contact
        and 4, 5, 6 the shears yz, xz, xy.

    Raises
    ------
    ValueError
        If the matrix is not symmetric, or if the elastic energy is not positive.

    Examples
    --------
    >>> iron = ts.AnisotropicMaterial.from_matrix(
    ...     [[226e3, 140e3, 140e3, 0, 0, 0], [140e3, 226e3, 140e3, 0, 0, 0],
    ...      [140e3, 140e3, 226e3, 0, 0, 0], [0, 0, 0, 116e3, 0, 0],
    ...      [0, 0, 0, 0, 116e3, 0], [0, 0, 0, 0, 0, 116e3]])
    >>> round(2.0 / iron.compliances[0])
    207037
    """

    stiffness: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        C = np.array(self.stiffness)
        if C.shape != (6, 6) or not np.array_equal(C, C.T):
            raise ValueError("the stiffness must be a symmetric matrix of 6 x 6 numbers")
        if not np.linalg.eigvalsh(C)[0] > 0.0:
            raise ValueError(f"the stiffness {C.tolist()} is not that of a stable material")

    @classmethod
    def from_matrix(cls, stiffness: Any, rotation: Any = None) -> "AnisotropicMaterial":
        """Return the material of a stiffness, rotated to the axes of the contact.

        Parameters
        ----------
        stiffness : array_like, shape (6, 6)
            Matrix of Voigt in the axes of the material, MPa.
        rotation : array_like, shape (3, 3), optional
            The axes x, y, z of the contact as rows, in the axes of the material.
        """
        C = np.array(stiffness, float)
        if rotation is not None:
            R, c = np.array(rotation, float), C[_VOIGT][:, :, _VOIGT]
            c = np.einsum("ia,jb,kc,ld,abcd->ijkl", R, R, R, R, c, optimize=True)
            pairs = np.array([[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]])
            C = c[*pairs][:, *pairs]
            C = 0.5 * (C + C.T)
        return cls(tuple(map(tuple, C.tolist())))

    def response(self, angle: np.ndarray) -> np.ndarray:
        """Return k S, displacement of the surface over traction times the wave number.

        Parameters
        ----------
        angle : ndarray, shape (n,)
            Directions of the waves exp(i k (x cos + y sin)).

        Returns
        -------
        ndarray of complex, shape (n, 3, 3)
            1/MPa, Hermitian; for a body at z > 0. That of a body at z < 0 is the conjugate.
        """
        C = np.array(self.stiffness)
        unit = float(np.trace(C)) / 6.0
        c = C[_VOIGT][:, :, _VOIGT] / unit
        m = np.stack((np.cos(angle), np.sin(angle), np.zeros_like(angle)), axis=1)
        Q = np.einsum("ijkl,nj,nl->nik", c, m, m)
        R, T = np.einsum("ijk,nj->nik", c[..., 2], m), np.linalg.inv(c[:, 2, :, 2])
        N = np.block([[-T @ R.swapaxes(1, 2), np.broadcast_to(T, R.shape)], [-Q, -R @ T]])
        N[:, 3:, :3] += R @ T @ R.swapaxes(1, 2)
        for _ in range(60):
            size = np.abs(np.linalg.det(N)) ** (-1.0 / 6.0)  # 1 in the limit; fewer iterations
            last, N = N, N * size[:, None, None]
            N = 0.5 * (N - np.linalg.inv(N))
            if np.abs(N - last).max() <= 1e-13 * np.abs(N).max():
                break
        S = np.linalg.solve(-N[:, 3:, :3], np.eye(3) + 1j * N[:, 3:, 3:]) / unit
        return 0.5 * (S + S.swapaxes(1, 2).conj())

    def waves(self, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return P and W of the displacement exp(i k z P) u and the stress i k W u of waves.

        u is the displacement of the surface z = 0 of a body at z > 0, times exp(i k (x cos + y
        sin)); the eigenvalues of P are those of Stroh.

        Parameters
        ----------
        angle : ndarray, shape (n,)
            Directions of the waves.

        Returns
        -------
        P : ndarray of complex, shape (n, 3, 3)
            Without unit.
        W : ndarray of complex, shape (n, 6, 3)
            xx, yy, zz, xy, xz, yz by u at the same depth, MPa.
        """
        c = np.array(self.stiffness)[_VOIGT][:, :, _VOIGT]
        m = np.stack((np.cos(angle), np.sin(angle), np.zeros_like(angle)), axis=1)
        R = np.einsum("ijk,nj->nik", c[..., 2], m)
        traction = 1j * np.linalg.inv(self.response(angle)) - R.swapaxes(1, 2)
        P = np.linalg.solve(c[:, 2, :, 2], traction)
        W = np.einsum("ijkl,nl->nijk", c, m) + np.einsum("ijk,nkl->nijl", c[..., 2], P)
        return P, W[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]

    @property
    def unit_body(self) -> "AnisotropicMaterial":
        """The material itself: its stress is computed with its stiffness."""
        return self

    @property
    def harmonics(self) -> int:
        """Number of harmonics exp(i n angle) of the response to waves."""
        return len(_harmonics(self))

    @property
    def mirrored(self) -> "AnisotropicMaterial":
        """The material in axes with the opposite z."""
        return self.from_matrix(self.stiffness, np.diag([1.0, 1.0, -1.0]))

    @property
    def in_surface(self) -> tuple[np.ndarray, np.ndarray]:
        """Stress xx, yy, xy by the strain xx, yy, 2 xy, MPa, and by the stress zz, yz, xz."""
        C = np.array(self.stiffness)
        inside, outside = [0, 1, 5], [2, 3, 4]
        crossed = np.linalg.solve(C[np.ix_(outside, outside)], C[np.ix_(outside, inside)])
        return C[np.ix_(inside, inside)] - crossed.T @ C[np.ix_(outside, inside)], crossed.T

    def below_edge(self, normal: np.ndarray) -> np.ndarray:
        """Return the stress xx, yy, xy at the surface inside an edge of pressure, over it, (3, n).

        It is the part that has the root of the distance from the edge, as the pressure has: the
        strain across the edge follows the pressure by the imaginary part of the response, and there
        is none along the edge.

        Parameters
        ----------
        normal : ndarray, shape (2, n)
            Unit vectors across the edge.
        """
        by_strain, by_stress = self.in_surface
        x, y = normal
        in_x, in_y = -self.response(np.arctan2(y, x))[:, :2, 2].imag.T
        strain = np.stack((x * in_x, y * in_y, x * in_y + y * in_x))
        return by_strain @ strain - by_stress[:, :1]

    @property
    def compliances(self) -> np.ndarray:
        """Means of k (S_zz, S_LL, S_TT, |S_Lz|) over all directions, 1/MPa, shape (4,)."""
        s = _harmonics(self)
        # In the axes along and across the waves: means of products with cos² and sin cos.
        half = 0.5 * (s[0, 0, 0] + s[0, 1, 1]).real
        turned = 0.5 * (s[2, 0, 0] - s[2, 1, 1]).real - s[2, 0, 1].imag
        lift = s[1, 0, 2].imag + s[1, 1, 2].real
        return np.array((s[0, 2, 2].real, half + turned, half - turned, lift))

    @property
    def laws(self) -> frozenset[type[LinearHalfSpaces]]:
        """Laws that a pair with this body needs: `AnisotropicHalfSpaces`."""
        return frozenset((AnisotropicHalfSpaces,))

    @property
    def tangential(self) -> Material:
        """Isotropic material with the mean tangential response, or the nearest one."""
        _, along, across, _ = self.compliances
        return Material(1.0 / float(across), float(np.clip(1.0 - along / across, -0.99, 0.5)))


@lru_cache(64)
def _harmonics(
    material: AnisotropicMaterial, most: int = 2**13, digits: float = 1e-12
) -> np.ndarray:
    """Return s_n of k S = sum of s_n exp(i n angle), (n, 3, 3) for n >= 0, 1/MPa.

    Those of rounding are zero.

    Raises
    ------
    ValueError
        If the response changes too fast with the direction.
    """
    count = 64
    while count <= most:
        half = material.response(np.pi * np.arange(count // 2) / (count // 2))
        s = np.fft.fft(np.concatenate((half, half.conj())), axis=0)[: count // 2] / count
        size = np.abs(s).max(axis=(1, 2))
        if size[count // 4 :].max() <= digits * size[0]:
            for part in (s.real, s.imag):
                part[np.abs(part) <= digits * size[0]] = 0.0
            return s[: max(3, int(np.flatnonzero(size > digits * size[0])[-1]) + 1)]
        count *= 2
    raise ValueError(
        "the response changes too fast with the direction of the waves: use a stiffness that is "
        "less unequal along different axes"
    )


@dataclass(frozen=True)
class AnisotropicHalfSpaces(LinearHalfSpaces):
    """Elasticity of two half-spaces; one or both are anisotropic.

    Pressure may cause tangential displacement also between equal bodies. The other body may be
    isotropic or have layers.

    Parameters
    ----------
    A, B : AnisotropicMaterial, Material, TransverseMaterial or LayeredBody
        The upper and the lower body.
    datum : float, optional
        For line contacts, see `Strips`; None for contacts of finite width.

    Examples
    --------
    >>> bodies = ts.Laws.of(scene).elasticity
    >>> fibres = np.diag([140e3, 10e3, 10e3, 3.5e3, 5e3, 5e3])  # along x
    >>> stiffer = ts.AnisotropicMaterial.from_matrix(fibres)
    >>> laws = ts.Laws.of(scene).replace(elasticity=ts.AnisotropicHalfSpaces(stiffer, bodies.B))
    >>> ts.solve(scene, laws=laws).p_max > contact.p_max
    True
    """

    shared = True

    @cached_property
    def harmonics(self) -> np.ndarray:
        """Sum of s_n of k S = sum of s_n exp(i n angle) over the anisotropic bodies, 1/MPa."""
        total = np.zeros((3, 3, 3), complex)
        for body, sign in ((self.A, 1.0), (self.B, -1.0)):
            if isinstance(body, AnisotropicMaterial):
                s, both = _harmonics(body), total
                total = np.zeros((max(len(s), len(both)), 3, 3), complex)
                total[: len(both)] = both
                # The response of the lower body is the conjugate: odd harmonics change their sign.
                total[: len(s) : 2] += s[::2]
                total[1 : len(s) : 2] += sign * s[1::2]
        return total

    @cached_property
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights and amplitudes of `LinearHalfSpaces.images`, of bodies without `harmonics`."""
        rigid = Material(np.inf, 0.0)
        A, B = (rigid if isinstance(k, AnisotropicMaterial) else k for k in (self.A, self.B))
        return LinearHalfSpaces(A, B).images

    @property
    def coupled(self) -> bool:
        """Whether pressure causes tangential displacement, also of bodies of equal material."""
        return bool(self.harmonics[:, :2, 2].any() or self.images[1][3].any())

    @property
    def coupling(self) -> str:
        """Text for the bodies."""
        return "anisotropic bodies"

    def parts(self, component: str) -> Mapping[str, tuple[int, int]]:
        """Return parts of a component with their parity in x and in y (`Elasticity.parts`)."""
        return _split(self, component)[0]

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return influence coefficients: displacement u_A - u_B per unit traction on an element.

        Parameters as in `Elasticity.coefficients`; also of the parts of a component.
        """
        return _coefficients(self, component, offsets, dx, dy)

    def periodic(
        self, component: str, period: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray | None:
        """Return the spectrum for the mean response of an anisotropic body beside layers, or None.

        Parameters as in `Elasticity.periodic`.
        """
        if self.images[0].size == 1:
            return None
        return LinearHalfSpaces(self.A, self.B, self.datum).periodic(component, period, dx, dy)

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """Return tangential over normal displacement ahead of an edge (`Elasticity.opening`).

        It is the ratio of the responses to waves across the edge.
        """
        zz, LL, TT = self.shortest(dx, dy)
        across = np.einsum("am,bm->mab", normal, normal)
        even, angle = self.harmonics[::2], np.arctan2(normal[1], normal[0])
        waves = np.exp(2j * np.outer(angle, np.arange(len(even))))
        waves[:, 1:] *= 2.0
        S = np.tensordot(waves, even, 1).real
        zz = zz + S[:, 2:, 2:]
        tangential = (TT * np.eye(2) + (LL - TT) * across + S[:, :2, :2]) / zz
        if not self.harmonics[::2, :2, 2].any():
            return tangential
        # Traction opens the gap as well: to first order in its share, which is below one.
        by_pressure = S[:, :2, 2:] / zz
        return np.concatenate(
            (tangential - by_pressure @ by_pressure.swapaxes(1, 2), by_pressure), axis=2
        )

    def single_body(self, body: str) -> Elasticity:
        """Return the law for the stress in one body, "A" or "B" (`LinearHalfSpaces.single_body`).

        An anisotropic body B is in its own axes, with z into the body.
        """
        material = getattr(self, body, None)
        if not isinstance(material, AnisotropicMaterial):
            return super().single_body(body)
        inwards = material if body == "A" else material.mirrored
        return replace(self, A=inwards, B=Material(np.inf, 0.0))

    def hertz(
        self, radius_x: float, radius_y: float, **given: float | None
    ) -> HertzContact | HertzLine:
        """Return the Hertz contact of homogeneous bodies; its ellipse may be turned.

        The pressure p0 sqrt(1 - r.M^-1 r / c²), with det M = 1, displaces the surface by

            (p0 c/8) (int S_zz/lam dtheta - r.[int S_zz m m/lam³ dtheta] r/c²),  lam² = m.M m,

        m the direction theta (Willis, J. Mech. Phys. Solids 14 (1966) 163-176). The half axes of
        the result are half lengths of the ellipse along x and y.

        Parameters as in `LinearHalfSpaces.hertz`.
        """
        if self.reach:  # beside layers, by the mean over directions
            return super().hertz(radius_x, radius_y, **given)
        load, pressure = given.get("load"), given.get("pressure")
        if radius_y == np.inf:
            along_x = self.harmonics[::2, 2, 2].real
            compliance = 2.0 * along_x.sum() - along_x[0] + self.images[1][0, 0]
            return hertz_line(float(2.0 / compliance), radius_x, load, pressure=pressure)
        count = 4096
        s = np.zeros(count // 2 + 1, complex)
        known = min(len(self.harmonics), count // 2)
        s[:known:2] = self.harmonics[:known:2, 2, 2]
        zz = np.fft.irfft(s, count) * count + self.images[1][0, 0]
        angle = 2.0 * np.pi / count * np.arange(count)
        m = np.stack((np.cos(angle), np.sin(angle)))

        def integrate(u: float, v: float) -> tuple[np.ndarray, np.ndarray, float]:
            """Return M = exp([[u, v], [v, -u]]), and both integrals."""
            q = np.hypot(u, v)
            far = min(1.0, 15.0 / max(q, 1e-300))  # no axes differ as much
            grown = np.sinh(far * q) / q if q > 1e-9 else 1.0
            M = np.cosh(far * q) * np.eye(2) + grown * np.array([[u, v], [v, -u]])
            lam = np.sqrt(np.einsum("an,ab,bn->n", m, M, m))
            bend = 2.0 * np.pi / count * np.einsum("n,an,bn->ab", zz / lam**3, m, m)
            return M, bend, 2.0 * np.pi / count * float((zz / lam).sum())

        def miss(shape: np.ndarray) -> list[float]:
            _, bend, _ = integrate(*shape)
            ratio = np.log(bend[0, 0] * radius_x / (bend[1, 1] * radius_y))
            return [ratio, bend[0, 1] / np.sqrt(bend[0, 0] * bend[1, 1])]

        start = np.array([np.log(radius_x / radius_y) * 2.0 / 3.0, 0.0])
        found = scipy.optimize.root(miss, start, tol=1e-13)
        M, bend, depth = integrate(*found.x)
        curving = 0.25 * radius_x * bend[0, 0]  # c over p0
        if pressure is not None:
            p0, c = pressure, pressure * curving
        elif load is not None:
            c = np.cbrt(1.5 * load * curving / np.pi)
            p0 = c / curving
        else:
            c = np.sqrt(8.0 * (given["approach"] or 0.0) * curving / depth)
            p0 = c / curving
        a, b = c * np.sqrt(np.diag(M))
        return HertzContact(
            *map(float, (a, b, p0, p0 * c * depth / 8.0, 2.0 / 3.0 * np.pi * c * c * p0))
        )


@lru_cache(256)
def _split(
    law: AnisotropicHalfSpaces, component: str
) -> tuple[Mapping[str, tuple[int, int]], Mapping[str, np.ndarray]]:
    """Return parities and harmonics of the parts of a component.

    Even harmonics are even or odd in x and in y, cosines and sines; of odd harmonics the cosines
    are odd in x and the sines in y. The part with the parity of isotropic bodies has the name of
    the component, others that with signs. Parts that are zero are left out.

    Returns
    -------
    parities : dict
        Parity in x and in y by name.
    harmonics : dict
        Complex c_n by name: the displacement by a unit force is Re sum of c_n exp(i n phi) / r.
    """
    i, j = ("xyz".index(axis) for axis in component)
    s = law.harmonics[:, i, j]
    n = np.arange(len(s))
    parities, harmonics = {component: PARITIES[component]}, {component: np.zeros_like(s)}
    # On a line all waves go along x, and their sines are zero.
    c = s * 1j**n if law.datum is None else (s * 1j ** (n % 2)).real
    c = np.where(n > 0, 2.0, 1.0) * c / (2.0 * np.pi)
    for odd in (0, 1):
        of_order = np.where(n % 2 == odd, c, 0.0)
        for parity, values in ((1 - 2 * odd, of_order.real), (2 * odd - 1, 1j * of_order.imag)):
            signs = parity, parity * (1 - 2 * odd)
            name = component
            if signs != PARITIES[component]:
                name += "".join("+-"[sign < 0] for sign in signs)
            if values.any():
                parities[name], harmonics[name] = signs, values.astype(complex)
    return parities, harmonics


def _coefficients(
    law: AnisotropicHalfSpaces, part: str, offsets: tuple[int, int], dx: float, dy: float
) -> np.ndarray:
    """Return influence coefficients (`Elasticity.coefficients`); the last ones are stored."""
    parities, harmonics = _split(law, part[:2])
    table = np.zeros(offsets)
    if law.datum is not None:
        x, (even_x, _) = dx * np.arange(offsets[0]), parities[part]
        odd = even_x < 0
        line = integrate_sign(x, dx) if odd else integrate_logarithm(x, dx, law.datum)
        table[:, 0] = harmonics[part].sum().real * line
    elif harmonics[part].any():
        # They are proportional to the size of the elements: those of coarser meshes are the first.
        stored = _stored_tables(law, dy / dx)
        if part not in stored or (np.array(stored[part].shape) < offsets).any():
            # Slip needs one more offset along x than displacement.
            longer = offsets[0] + offsets[0] % 2, offsets[1]
            stored.update(_integrate_elements(law, longer, dy / dx))
        table = dx * stored[part][: offsets[0], : offsets[1]]
    if len(part) == 2 and law.images[1].any():
        table = table + LinearHalfSpaces.coefficients(law, part, offsets, dx, dy)
    return table


_stored_tables = lru_cache(2)(lambda law, aspect: dict[str, np.ndarray]())
"""Results of `_integrate_elements` by law and width over length of the elements."""


def _integrate_elements(
    law: AnisotropicHalfSpaces, offsets: tuple[int, int], aspect: float
) -> dict[str, np.ndarray]:
    """Return the displacement by a unit traction on an element, of all parts that are not zero.

    The element has the length 1 and the width `aspect`.
    """
    parities, spline, *factors = _integrate_corners(law)
    x, y = (side * (np.arange(n) + 0.5) for side, n in zip((1.0, aspect), offsets, strict=True))
    x, r = x[:, None], np.hypot(x[:, None], y)
    ends = x * np.arcsinh(y / x), y * np.arcsinh(x / y), x * np.log(r / x), y * np.log(r / y)
    corners = np.moveaxis(spline(np.arctan2(y, x)), 2, 0) * r
    tables = {}
    for (name, (even_x, even_y)), smooth, *weights in zip(
        parities.items(), corners, *factors, strict=True
    ):
        each = [weight * end for weight, end in zip(weights, ends, strict=True) if weight]
        values = sum(each, start=smooth)
        # By parity at corners beyond the axes.
        values = np.concatenate((-even_x * values[:1], values))
        values = np.concatenate((-even_y * values[:, :1], values), axis=1)
        tables[name] = np.diff(np.diff(values, axis=0), axis=1)
    return tables


@lru_cache(16)
def _integrate_corners(law: AnisotropicHalfSpaces) -> tuple[Any, ...]:
    """Return integrals of the displacement by a unit force from 0 to x and from 0 to y.

    They are, in polar coordinates, integrals over r to the sides, x/cos phi and y/sin phi:
    x int h/cos + y int h/sin. With the complement of phi, the second is of the form of the first.
    Over r, all but logarithms is a smooth function of phi; a spline has it to rounding.

    Returns
    -------
    parities : dict
        Parity in x and y by the name of each part that is not zero.
    spline : callable
        The smooth part over r, of angles, with all parts along the last axis.
    factors : four of ndarray
        Factors of x asinh(y/x), y asinh(x/y), x log(r/x) and y log(r/y).
    """
    split = [_split(law, k) for k in PARITIES if law.coupled or k == "zz" or k[1] != "z"]
    harmonics = {name: c for _, of in split for name, c in of.items() if c.any()}
    parities = {name: of[name] for of, _ in split for name in of if name in harmonics}
    c = np.stack([harmonics[name] for name in parities], axis=1)
    n = np.arange(len(c))
    t = np.linspace(0.0, 0.5 * np.pi, max(2049, 32 * len(c) + 1))
    waves = np.exp(1j * np.outer(t, n))
    first, (over_x, log_x) = _integrate_over_cosine(c, t, waves)
    turned = (c * 1j ** n[:, None]).conj()
    second, (over_y, log_y) = _integrate_over_cosine(turned, t, waves)
    smooth = np.cos(t)[:, None] * first + np.sin(t)[:, None] * second[::-1]
    spline = scipy.interpolate.make_interp_spline(t, smooth, k=5)
    return parities, spline, over_x.real, over_y.real, -log_x.imag, -log_y.imag


def _integrate_over_cosine(
    c: np.ndarray, t: np.ndarray, waves: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the integral of Re sum of c_n exp(i n phi) / cos phi from 0 to angles t.

    exp(i n phi) = 2 cos phi exp(i (n - 1) phi) - exp(i (n - 2) phi) leaves the integrals of
    1/cos phi and of exp(i phi)/cos phi.

    Parameters
    ----------
    c : ndarray of complex, shape (n, m)
        Harmonics of m functions.
    t : ndarray, shape (k,)
        Angles.
    waves : ndarray, shape (k, n)
        exp(i n t).

    Returns
    -------
    smooth : ndarray, shape (k, m)
        The integral without logarithms.
    ends : ndarray of complex, shape (2, m)
        Factors of the integrals of 1/cos phi, with its real part, and tan phi, with -imaginary.
    """
    c, d = c.copy(), np.zeros_like(c)
    for n in range(len(c) - 1, 1, -1):
        d[n - 1] += 2.0 * c[n] / (1j * (n - 1))
        c[n - 2] -= c[n]
    return (waves @ d - d.sum(axis=0)).real + np.outer(t, c[1].real), c[:2]
