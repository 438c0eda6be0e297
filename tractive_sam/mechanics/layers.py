"""Half-spaces by their response to waves: layers bonded to a body, transverse isotropy.

Under tractions with the wave number k in the direction L, the surface of a half-space is displaced
along L, across it (T) and along its normal z. Four functions describe the response of a body that
is isotropic in its surface:

    k S_zz, k S_LL, k S_TT and k |S_Lz|, 1/MPa,

of a homogeneous isotropic body (1 - nu)/G, (1 - nu)/G, 1/G and (1 - 2 nu)/(2 G). Only those of
layers depend on k. Each layer has plane waves that decay from its upper face and others that decay
from its lower face, so that no exponential grows. A recursion over the layers from below gives the
traction over the displacement of each face; it is stable for any thickness.

The displacement by a load on an element follows from exponentials of the wave number,

    k S = c_0 + sum_i c_i exp(-k d_i),

since a term exp(-k d)/k is the displacement that a half-space has at the height d above it, in
closed form (Boussinesq and Cerruti). The heights d_i are in geometric progression; the c_i fit the
response by least squares with relative errors of 1e-6 and less. So there is neither a period nor a
longest wave, and distant loads act exactly as on the body below the layers.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from tractive_sam.kernels.half_space import integrals, load_distant, load_rectangles, load_strips
from tractive_sam.mechanics.elasticity import (
    Elasticity,
    HalfSpaces,
    Material,
    Strips,
    SurfaceResponse,
    integrals_of,
)
from tractive_sam.mechanics.hertz_contact import HertzContact, HertzLine, hertz, hertz_line


@dataclass(frozen=True)
class Layer:
    """Layer of a body.

    Parameters
    ----------
    thickness : float
        Thickness, mm; positive.
    material : Material
        Its elastic constants; of a graded layer those at its upper face.
    gradient : str
        "none", or "exponential": the shear modulus changes with the depth as an exponential, up to
        that of the layer or body below.
    compliance : tuple of float
        Compliance of the interface below, in shear and along the normal, mm/MPa: the displacement
        jumps by it times the traction. 0 if bonded.

    Raises
    ------
    ValueError
        If the thickness is not positive and finite, the gradient is unknown, or a compliance is
        negative or infinite.

    Examples
    --------
    >>> ts.Layer(0.003, ts.Material.from_young(300e3, 0.2)).material.shear
    125000.0
    """

    thickness: float
    material: Material
    gradient: str = "none"
    compliance: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not all(0.0 <= value < np.inf for value in self.compliance):
            raise ValueError(f"compliances must be finite and at least 0, not {self.compliance}")
        if not 0.0 < self.thickness < np.inf:
            raise ValueError(f"the thickness must be above 0 and finite, not {self.thickness}")
        if self.gradient not in ("none", "exponential"):
            raise ValueError(f'the gradient must be "none" or "exponential", not {self.gradient!r}')


@dataclass(frozen=True)
class LayeredBody(SurfaceResponse):
    """Half-space with layers on each other and on the material below, bonded or with springs.

    Source of the waves: potentials of Papkovich and Neuber, for example Barber, Elasticity (2010),
    chapter 20; the closed form for one layer is that of O'Sullivan & King, J. Tribol. 110 (1988)
    235-240.

    Parameters
    ----------
    layers : tuple of Layer
        Layers from the surface down; at least one.
    base : Material
        Material below.

    Examples
    --------
    >>> steel = ts.Material.from_young(208e3, 0.3)
    >>> thick = ts.LayeredBody((ts.Layer(1e9, steel),), ts.Material(1.0, 0.3))
    >>> bool(np.allclose(thick.response(np.ones(1))[:, 0], steel.compliances))
    True
    """

    layers: tuple[Layer, ...]
    base: Material

    @property
    def compliances(self) -> np.ndarray:
        """Limits of k (S_zz, S_LL, S_TT, |S_Lz|) for short waves, 1/MPa, shape (4,)."""
        return self.layers[0].material.compliances

    def response(self, k: np.ndarray) -> np.ndarray:
        """Return k (S_zz, S_LL, S_TT, |S_Lz|) at wave numbers.

        Parameters
        ----------
        k : ndarray, shape (n,)
            Wave numbers, above 0, 1/mm.

        Returns
        -------
        ndarray, shape (4, n)
            1/MPa.
        """
        *_, (_, _, stiffness, across) = self._from_below(k)
        (LL, Lz), (_, zz) = np.moveaxis(-np.linalg.inv(stiffness), 0, 2)
        return np.stack((zz, LL, 1.0 / across, Lz))

    def _from_below(
        self, k: np.ndarray
    ) -> Iterator[tuple[float, np.ndarray, np.ndarray, np.ndarray]]:
        """Yield (decay, reflected, stiffness, across) of each layer from below, then of all.

        Stiffness is the stress over the displacement, over k, in the plane of the waves, (n, 2, 2),
        and across them, (n,), of what lies below the layer with its interface, at last of the body.
        The layer's waves from below have the amplitudes `reflected` (n, 2, 2) times those from
        above; its modulus is G exp(-decay z).
        """
        _, displacement, stress = _waves(self.base, k, 0.0, -1)
        stiffness = stress @ np.linalg.inv(displacement)
        across, below = np.full(k.shape, self.base.shear), self.base.shear
        for layer in reversed(self.layers):
            decay = np.log(layer.material.shear / below) / layer.thickness
            if layer.gradient != "exponential" or abs(decay * layer.thickness) <= 1e-6:
                decay = 0.0
            if any(layer.compliance):
                opened = k[:, None, None] * np.diag(layer.compliance)
                stiffness = np.linalg.inv(np.linalg.inv(stiffness) - opened)
                across = across / (1.0 + across * k * layer.compliance[0])
            (top, raised), (bottom, lower) = (
                _waves_at(layer, k, decay, z) for z in (0.0, layer.thickness)
            )
            # Amplitudes of the waves from below, over those of the waves from above.
            ahead, back = bottom[1] - stiffness @ bottom[0], lower[1] - stiffness @ lower[0]
            reflected = -np.linalg.solve(back, ahead)
            yield decay, reflected, stiffness, across
            # Stress over displacement at the upper face, from that at the lower face.
            displacement, stress = (a + b @ reflected for a, b in zip(top, raised, strict=True))
            stiffness = np.real(stress @ np.linalg.inv(displacement))
            moved, sheared = _shear_at(layer, k, across, decay, 0.0)
            across, below = -sheared / moved, layer.material.shear
        yield 0.0, np.zeros_like(stiffness), stiffness, across

    @property
    def poisson(self) -> float:
        """Poisson's ratio at the surface."""
        return self.layers[0].material.poisson

    @property
    def interfaces(self) -> np.ndarray:
        """Depths of the lower faces of the layers, mm, shape (layers,)."""
        return np.cumsum([layer.thickness for layer in self.layers])

    def materials(self, depths: np.ndarray) -> list[Material]:
        """Return the materials at depths (m,), mm; those at an interface lie above it."""
        each = [*(layer.material for layer in self.layers), self.base]
        return [each[k] for k in np.searchsorted(self.interfaces, depths)]

    @property
    def unit_body(self) -> "LayeredBody":
        """Body with the shear modulus 1 at the surface."""
        return self.scaled(1.0 / self.layers[0].material.shear)

    def scaled(self, factor: float) -> "LayeredBody":
        """Return the body with moduli times a factor, and compliances of interfaces over it."""

        def change(material: Material) -> Material:
            return Material(factor * material.shear, material.poisson)

        layers = (
            replace(
                layer,
                material=change(layer.material),
                compliance=(layer.compliance[0] / factor, layer.compliance[1] / factor),
            )
            for layer in self.layers
        )
        return LayeredBody(tuple(layers), change(self.base))

    def worn(self, depth: float, step: float) -> "LayeredBody | Material":
        """Return the body without a worn depth, mm, in steps; the base if all layers are worn.

        Parameters as in `SurfaceResponse.worn`.

        Examples
        --------
        >>> hard, steel = ts.Material(2e5, 0.2), ts.Material(8e4, 0.3)
        >>> coated = ts.LayeredBody((ts.Layer(0.1, hard),), steel)
        >>> round(coated.worn(0.037, 0.1).layers[0].thickness, 3), coated.worn(0.2, 0.1) == steel
        (0.07, True)
        """
        for number, layer in enumerate(self.layers):
            worn = depth / layer.thickness
            if worn < 1.0 - 1e-9:
                share = step * np.floor(worn / step + 1e-9)
                below = (*self.layers[number + 1 :], Layer(1.0, self.base))[0].material.shear
                material = layer.material
                if layer.gradient != "none":
                    shear = material.shear * (below / material.shear) ** share
                    material = Material(float(shear), material.poisson)
                thickness = float(layer.thickness * (1.0 - share))
                thinner = replace(layer, thickness=thickness, material=material)
                return LayeredBody((thinner, *self.layers[number + 1 :]), self.base)
            depth -= layer.thickness
        return self.base

    def stress(self, k: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return the stress at depths by waves of traction on the surface.

        Tractions (p_L, p_T, p_n) on the surface z = 0, exp(i k x) along L, cause

            sigma_zz = i c_zL p_L - c_zz p_n,   sigma_Lz = -c_LL p_L - i c_Lz p_n,
            sigma_LL = i c_L p_L - c_n p_n,     sigma_Tz = -c_TT p_T,   sigma_LT = i c_T p_T,

        and sigma_TT is Poisson's ratio times sigma_LL + sigma_zz.

        Parameters
        ----------
        k : ndarray, shape (n,)
            Wave numbers, above 0, 1/mm.
        depths : ndarray, shape (m,)
            mm; an interface belongs to the layer above it.

        Returns
        -------
        ndarray, shape (m, 8, n)
            c_LL, c_Lz, c_zL, c_zz, c_L, c_n, c_TT, c_T.

        Examples
        --------
        >>> hard = ts.Layer(0.1, ts.Material(1e6, 0.3))
        >>> coated = ts.LayeredBody((hard,), ts.Material(1e5, 0.3))
        >>> coated.stress(np.ones(1), np.array([0.0, 0.1]))[:, 3, 0].round(3)
        array([1.   , 0.996])
        """
        values = np.empty((len(depths), 8, k.size))
        *levels, (_, none, _, _) = self._from_below(k)
        levels = [*reversed(levels), (0.0, none, none, np.full(k.shape, self.base.shear))]
        pieces = [*self.layers, Layer(1e30, self.base)]
        place = np.searchsorted(self.interfaces, depths)
        stress, along = np.broadcast_to(np.eye(2), none.shape), np.ones_like(k)
        top = 0.0
        for number, (layer, (decay, reflected, _, across)) in enumerate(
            zip(pieces, levels, strict=True)
        ):
            (_, fall), (_, grow) = _waves_at(layer, k, decay, 0.0)
            amplitude = np.linalg.solve(fall + grow @ reflected, stress)
            sheared = along / -_shear_at(layer, k, across, decay, 0.0)[1]
            nu, plane = layer.material.poisson, 1.0 - layer.material.poisson
            here = np.flatnonzero(place == number)
            inside = [(int(m), float(depths[m] - top)) for m in here]
            for m, z in [*inside, (-1, layer.thickness)]:
                down, up = _waves_at(layer, k, decay, z)
                u, stress = (
                    np.real((a + b @ reflected) @ amplitude) for a, b in zip(down, up, strict=True)
                )
                moved, across_z = (part * sheared for part in _shear_at(layer, k, across, decay, z))
                along = -across_z
                if m >= 0:
                    G = layer.material.shear * np.exp(-decay * z)
                    stretched = (nu * stress[:, 1] - 2.0 * G * u[:, 0]) / plane
                    values[m] = *stress.reshape(-1, 4).T, *stretched.T, along, G * moved
            top += layer.thickness
        return values

    @property
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights d_i, mm, shape (m,), and amplitudes c_i, 1/MPa, shape (4, m), without c_0.

        Raises
        ------
        ValueError
            If exponentials do not fit the response.
        """
        return _fit_images(self)

    def reach(self, speed: float) -> float:
        """Return the thickness of all layers, mm (`SurfaceResponse.reach`)."""
        return sum(layer.thickness for layer in self.layers)

    def stress_images(self, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return heights d_i and amplitudes c_i of the stress at depths, less that without layers.

        The stress (`stress`) is that in a homogeneous body with the material at the depth, and
        sum_i c_i exp(-k d_i) from the layers, with errors below 1e-6 of the largest stress.

        Parameters
        ----------
        depths : ndarray, shape (m,)
            mm.

        Returns
        -------
        heights : ndarray, shape (n,)
            mm.
        amplitudes : ndarray, shape (m, 8, n)
            Without unit.
        """
        return _fit_stress(self, tuple(depths.tolist()))


@dataclass(frozen=True)
class TransverseMaterial(SurfaceResponse):
    """Material that is isotropic in its surface, with the axis of symmetry along the normal.

    With g = sqrt(C11 C33) the response is k S_zz = 2/E*, k S_LL = k S_zz sqrt(C33/C11), k S_TT =
    1/sqrt(C44 C66), k |S_Lz| = 1/(g + C13), and

        E* = 2 sqrt(((g² - C13²)/C11) / (1/C44 + 2/(g + C13))).

    The tangential problem is therefore that of an isotropic material with other constants (Turner,
    Int. J. Solids Struct. 16 (1980) 409-419).

    Parameters
    ----------
    C11, C12, C13, C33, C44 : float
        Elastic stiffness, MPa; the index 3 is the normal of the surface.

    Raises
    ------
    ValueError
        If the elastic energy is not positive.

    Examples
    --------
    >>> zinc = ts.TransverseMaterial(165e3, 31.1e3, 50e3, 61.8e3, 39.6e3)
    >>> round(2.0 / zinc.compliances[0])
    69618
    """

    C11: float
    C12: float
    C13: float
    C33: float
    C44: float

    def __post_init__(self) -> None:
        stable = abs(self.C12) < self.C11 and self.C44 > 0.0 and self.C33 > 0.0
        if not (stable and self.C33 * (self.C11 + self.C12) > 2.0 * self.C13**2):
            raise ValueError(
                f"the stiffness {self} is not that of a stable material: C11 > |C12|, C33 and C44 "
                "above 0 and C33 (C11 + C12) > 2 C13² must hold"
            )

    @property
    def compliances(self) -> np.ndarray:
        """Response k (S_zz, S_LL, S_TT, |S_Lz|) at all wave numbers, 1/MPa, shape (4,)."""
        g, C66 = np.sqrt(self.C11 * self.C33), 0.5 * (self.C11 - self.C12)
        lift = 1.0 / (g + self.C13)
        zz = np.sqrt((1.0 / self.C44 + 2.0 * lift) * self.C11 / (g**2 - self.C13**2))
        return np.array(
            (zz, zz * np.sqrt(self.C33 / self.C11), 1.0 / np.sqrt(self.C44 * C66), lift)
        )

    @property
    def stiffness(self) -> tuple[tuple[float, ...], ...]:
        """Matrix of Voigt, MPa, as that of `AnisotropicMaterial`."""
        matrix = np.diag((self.C11, self.C11, self.C33, self.C44, self.C44, 0.0))
        matrix[[0, 1], [1, 0]] = self.C12
        matrix[[0, 1, 2, 2], [2, 2, 0, 1]] = self.C13
        matrix[5, 5] = 0.5 * (self.C11 - self.C12)
        return tuple(map(tuple, matrix.tolist()))

    @property
    def unit_body(self) -> "TransverseMaterial":
        """The material itself: its stress is computed with its stiffness."""
        return self

    @property
    def tangential(self) -> Material:
        """Isotropic material with the same tangential response, or the nearest with -1 < nu <= 0.5.

        It describes the material; an elastic law uses `compliances`.
        """
        _, along, across, _ = self.compliances
        return Material(1.0 / float(across), float(np.clip(1.0 - along / across, -0.99, 0.5)))


def _waves(
    material: Material, k: np.ndarray, z: float, sign: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return plane waves that decay (sign -1) or grow (1) with the depth.

    They are grad exp(i k x + s k z)/k and, with the harmonic function psi of the same form,
    (3 - 4 nu) psi e_z - z grad psi.

    Parameters
    ----------
    material : Material
        The material.
    k : ndarray, shape (n,)
        Wave numbers, 1/mm.
    z : float
        Depth below the face at which their exponential is 1, mm.
    sign : int
        s.

    Returns
    -------
    fall : ndarray, shape (n, 1, 1)
        exp(-k abs(z)), which is left out in the following.
    displacement : ndarray, shape (n, 2, 2)
        (u_x/i, u_z) of each wave.
    stress : ndarray, shape (n, 2, 2)
        (sigma_xz/i, sigma_zz)/k of each wave, MPa.
    """
    one, kz, nu = np.ones_like(k), k * z, material.poisson
    displacement = np.array([[one, -kz], [sign * one, 3.0 - 4.0 * nu - sign * kz]])
    stress = 2.0 * np.array(
        [
            [sign * one, 1.0 - 2.0 * nu - sign * kz],
            [one, sign * 2.0 * (1.0 - nu) - kz],
        ]
    )
    fall = np.exp(-np.abs(kz))[:, None, None]
    return fall, np.moveaxis(displacement, 2, 0), material.shear * np.moveaxis(stress, 2, 0)


@lru_cache(64)
def _fit_images(
    body: LayeredBody, good: float = 1e-6, largest_error: float = 3e-4
) -> tuple[np.ndarray, np.ndarray]:
    """Return heights and amplitudes of exponentials that fit the response of a body.

    Parameters
    ----------
    body : LayeredBody
        The body.
    good : float
        Error, relative to the response, above which heights closer to each other are tried. They
        make amplitudes larger, which costs digits.
    largest_error : float
        Error above which the fit is refused.

    Returns
    -------
    heights : ndarray, shape (m,)
        mm.
    amplitudes : ndarray, shape (4, m)
        1/MPa.

    Raises
    ------
    ValueError
        If the error is larger.
    """
    error = np.inf
    for ratio in (1.2, 1.12):
        heights, amplitudes, error = _fit_at_ratio(body, ratio)
        if error <= good:
            break
    if error > largest_error:
        raise ValueError(
            f"the response of the layers {body!r} is not resolved (error {error:.2g}): use moduli "
            "that differ less, or fewer layers"
        )
    return heights, amplitudes


def _waves_at(layer: Layer, k: np.ndarray, decay: float, depth: float) -> tuple[Any, Any]:
    """Return waves (displacement, stress/k) of a layer at a depth below its upper face.

    First those that decay with the depth, then those that grow; each is 1 at the face from which
    it decays. See `_waves`.

    With the modulus G exp(-g z) the equations of equilibrium have constant coefficients. Their
    solutions are exp(l z) with l = g/2 +- sqrt(g²/4 + m), m = k² +- i k g sqrt(nu/(1 - nu)).

    Parameters
    ----------
    layer : Layer
        The layer.
    k : ndarray, shape (n,)
        Wave numbers, 1/mm.
    decay : float
        g, 1/mm; 0 for constant moduli.
    depth : float
        mm.
    """
    h, shear = layer.thickness, layer.material.shear
    if not decay:
        each = (_waves(layer.material, k, z, s) for z, s in ((depth, -1), (depth - h, 1)))
        down, up = ([fall * u, fall * s] for fall, u, s in each)
        return down, up
    nu = max(layer.material.poisson, 1e-8)  # at 0 two solutions are equal
    part = (0.5 - nu) / (1.0 - nu)  # of the moduli G and lambda + 2 G
    m = k**2 + 1j * k * decay * np.sqrt(nu / (1.0 - nu)) * np.array([[1.0], [-1.0]])
    root = np.sqrt(0.25 * decay**2 + m)

    def at(power: np.ndarray, face: float) -> list[np.ndarray]:
        """Return the waves exp(power z) that are 1 at a face."""
        x = -((1.0 - part) * power - part * decay) / k
        z = part * m / k**2 - 1.0
        xz = (power * x + k * z) / k
        zz = (power * (m - k**2) - k**2 * decay) / k**3 + 2.0 * x
        u, s = (np.moveaxis(np.array(rows), 2, 0) for rows in ([x, z], [xz, zz]))
        fall = np.exp(power * (depth - face)).T[:, None, :]
        return [u * fall, shear * np.exp(-decay * depth) * s * fall]

    return at(0.5 * decay - root, 0.0), at(0.5 * decay + root, h)


def _shear_at(
    layer: Layer, k: np.ndarray, below: np.ndarray, decay: float, depth: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement and stress/k across the waves at a depth below a layer's upper face.

    Parameters as in `_waves_at`; `below` (n,) is minus the stress over the displacement
    at the lower face, over k, MPa.
    """
    h, shear = layer.thickness, layer.material.shear
    root = np.sqrt(0.25 * decay**2 + k**2)
    down, up = (0.5 * decay - root) / k, (0.5 * decay + root) / k
    lower = shear * np.exp(-decay * h)
    reflected = -(lower * down + below) / (lower * up + below)
    growing = reflected * np.exp(up * k * depth - 2.0 * root * h)
    falling = np.exp(down * k * depth)
    here = shear * np.exp(-decay * depth)
    return falling + growing, here * (down * falling + up * growing)


def _sample(
    body: LayeredBody, ratio: float, per_height: int = 4, deepest: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return heights with a ratio of successive ones, mm, and wave numbers of a fit, 1/mm.

    There are `per_height` wave numbers for each height. The largest height is in proportion to the
    depth `deepest`, mm, at which the stress is needed, or longer.
    """
    first, depth = body.layers[0].thickness, sum(layer.thickness for layer in body.layers)
    moduli = [layer.material.shear for layer in body.layers] + [body.base.shear]
    # A soft layer is felt up to waves of its depth times the ratio of the moduli.
    longest = 100.0 * depth * max(moduli) / min(moduli)
    springs = [max(layer.compliance) for layer in body.layers]
    longest = max(longest, 100.0 * max(springs) * max(moduli), 30.0 * deepest)
    if any(layer.gradient != "none" for layer in body.layers):
        longest = min(longest, 1e3 * depth)  # longer waves lose digits
    smallest, largest = 0.01 / longest, 40.0 / first
    if body.layers[0].gradient != "none":  # the response tends to that of the surface as 1/k
        first, largest = 1e-3 * first, 4e3 / first
    heights = 0.5 * first * ratio ** np.arange(np.log(longest / (0.5 * first)) / np.log(ratio))
    k = np.geomspace(
        smallest, largest, per_height * int(np.log(largest / smallest) / np.log(ratio))
    )
    return heights, k


def _fit_at_ratio(body: LayeredBody, ratio: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Return heights in geometric progression, amplitudes that fit the response, and the error.

    Parameters
    ----------
    body : LayeredBody
        The body.
    ratio : float
        Ratio of successive heights.
    """
    heights, k = _sample(body, ratio)
    response, surface = body.response(k), body.compliances
    change = body.base.compliances - surface
    # The response is positive, except for S_Lz, whose error counts against that of S_LL.
    size = response[[0, 1, 2, 1]]
    amplitudes = np.empty((4, heights.size))
    fall = np.exp(-np.outer(k, heights))
    for row, values, limit, total, scale in zip(
        amplitudes, response, surface, change, size, strict=True
    ):
        # The last row: the longest waves respond like the material below.
        left = np.vstack((fall / scale[:, None], np.full(heights.size, 1.0 / scale[0])))
        right = np.append((values - limit) / scale, total / scale[0])
        row[:] = np.linalg.lstsq(left, right, rcond=1e-15)[0]
    error = np.abs(surface[:, None] + amplitudes @ fall.T - response) / size
    return heights, amplitudes, float(error.max())


@lru_cache(32)
def _fit_stress(
    body: LayeredBody, depths: tuple[float, ...], largest_error: float = 3e-4
) -> tuple[np.ndarray, np.ndarray]:
    """Return heights and amplitudes of exponentials (`LayeredBody.stress_images`)."""
    z = np.array(depths)
    heights, k = _sample(body, 1.2, deepest=z.max())
    # Up to waves that no height feels, as the amplitudes are not bounded beyond.
    k = np.append(k, k[-1] * 1.05 ** np.arange(1, np.log(20.0 / k[-1] / heights[0]) / 0.048))
    change = body.stress(k, z)
    fall = np.exp(-np.outer(k, heights))
    amplitudes, error = np.zeros((z.size, 8, heights.size)), 0.0
    for m, material in enumerate(body.materials(z)):
        plain = LayeredBody((), Material(1.0, material.poisson))
        values = (change[m] - plain.stress(k, z[m : m + 1])[0]).T
        # The last row: the limit for long waves.
        limit = values[0] + (values[0] - values[1]) * k[0] / (k[1] - k[0])
        used = heights >= 0.4 * z[m]  # less deep ones would only cancel
        left = np.vstack((fall[:, used], np.ones(np.count_nonzero(used))))
        found = np.linalg.lstsq(left, np.vstack((values, limit)), rcond=1e-15)[0]
        amplitudes[m, :, used] = found
        largest = max(1.0, np.abs(values).max())
        error = max(error, np.abs(fall[:, used] @ found - values).max() / largest)
    if error > largest_error:
        raise ValueError(
            f"the stress in the layers {body!r} is not resolved (error {error:.2g}): use moduli "
            "that differ less, or fewer layers"
        )
    return heights, amplitudes


@dataclass(frozen=True)
class LinearHalfSpaces(Elasticity):
    """Elasticity of two half-spaces that are isotropic in their surface, for example with layers.

    Parameters
    ----------
    A, B : Material, LayeredBody or TransverseMaterial
        The upper and the lower body.
    datum : float, optional
        For line contacts, see `Strips`; None for contacts of finite width.

    Examples
    --------
    >>> bodies = ts.Laws.of(scene).elasticity
    >>> hard = ts.Layer(0.5, ts.Material(10.0 * bodies.A.shear, bodies.A.poisson))
    >>> law = ts.LinearHalfSpaces(ts.LayeredBody((hard,), bodies.A), bodies.B)
    >>> laws = ts.Laws.of(scene).replace(elasticity=law)
    >>> ts.solve(scene, laws=laws).approach < contact.approach
    True
    """

    A: SurfaceResponse
    B: SurfaceResponse
    datum: float | None = None
    shared = True

    @property
    def coupled(self) -> bool:
        """Whether pressure causes tangential displacement: unless the bodies are alike."""
        return self.A != self.B and bool(self.images[1][3].any())

    @cached_property
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights (m,), mm, and amplitudes (4, m), 1/MPa, of both bodies; the first height is 0."""
        (of_A, A), (of_B, B) = self.A.images, self.B.images
        opposite = np.array([1.0, 1.0, 1.0, -1.0])
        surface = self.A.compliances + opposite * self.B.compliances
        heights = np.concatenate(([0.0], of_A, of_B))
        return heights, np.concatenate((surface[:, None], A, opposite[:, None] * B), axis=1)

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return influence coefficients: displacement u_A - u_B per unit traction on an element.

        Parameters as in `Elasticity.coefficients`.
        """
        (heights, amplitudes), (nx, ny) = self.images, offsets
        if self.datum is not None:
            table = np.zeros(offsets)
            x = dx * np.arange(nx)
            table[:, 0] = load_strips(component, x, dx, heights, amplitudes, self.datum)
            return table
        table = dx * _combine(component, integrals_of(dy / dx).at(nx, ny), amplitudes[:, 0])
        if heights.size > 1:
            together = _share_functions(component)
            images = _image_coefficients(self, together, _round_up(nx), _round_up(ny), dx, dy)
            table += images[together.index(component), :nx, :ny]
        return table

    def distant_coefficients(
        self, component: str, x: tuple[float, ...], rows: int, dx: float, dy: float
    ) -> np.ndarray:
        """Return influence coefficients at other places than `coefficients`, ahead of the load.

        Parameters
        ----------
        component, dx, dy
            See `coefficients`.
        x : tuple of float
            Distances, mm; of bodies with layers above 12 of the longest side.
        rows : int
            Number of offsets in y, from 0 on.

        Returns
        -------
        ndarray, shape (len(x), rows)
            mm/MPa.
        """
        heights, amplitudes = self.images
        if self.datum is not None:
            line = load_strips(component, np.array(x), dx, heights, amplitudes, self.datum)
            return np.outer(line, np.arange(rows) == 0)
        table = _combine(component, _distant_integrals(x, rows, dx, dy), amplitudes[:, 0])
        if heights.size > 1:
            at_x, at_y = np.repeat(x, rows), np.tile(dy * np.arange(rows), len(x))
            together, raised = _share_functions(component), (heights[1:], amplitudes[:, 1:])
            each = load_distant(together, at_x, at_y, (dx, dy), *raised)
            table += each[together.index(component)].reshape(table.shape)
        return table

    def periodic(
        self, component: str, period: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray | None:
        """Return the spectrum of displacements that repeat with a period, from the response.

        It is positive. Where a coating is stiff, that of the coefficients within a period is not:
        their slope jumps at the end of the period.

        Parameters as in `Elasticity.periodic`.
        """
        return _periodic_spectra(self, period, dx, dy).get(component)

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """Return length / E*, E* for waves that are as long as the contact, mm/MPa.

        Parameters as in `Elasticity.gap_per_pressure`.
        """
        return length / self.contact_modulus(length)

    def at_speed(self, speed: float | None) -> "LinearHalfSpaces":
        """Return the law at a rolling speed, mm/s, without one at rest; default: this law."""
        return self

    @property
    def speed(self) -> float:
        """Rolling speed, mm/s; 0 of bodies whose response does not depend on it."""
        return 0.0

    @property
    def reach(self) -> float:
        """Length of the waves at which the response changes, mm; 0 if it does not."""
        return self.A.reach(self.speed) + self.B.reach(self.speed)

    def contact_modulus(self, length: float) -> float:
        """Return the contact modulus E* for waves as long as a contact, MPa.

        The wave number is 2.2 / a: with its modulus, the Hertz contact of a sphere is as large as
        that of a body with a coating, with errors of 8 % for moduli of the coating from 1/10 to 50
        times that of the body.

        Parameters
        ----------
        length : float
            Half length of the contact, mm.
        """
        compliance, k = 0.0, 2.2 / length
        for body in (self.A, self.B):
            heights, amplitudes = body.images
            part = body.compliances[0] + amplitudes[0] @ np.exp(-k * heights)
            compliance += part * body.factor(k, self.speed).real
        return float(2.0 / compliance)

    def hertz(
        self, radius_x: float, radius_y: float, **given: float | None
    ) -> HertzContact | HertzLine:
        """Return the Hertz contact whose modulus is that of the bodies for waves of its length.

        For homogeneous bodies it is exact.

        Parameters
        ----------
        radius_x, radius_y : float
            Combined radii, mm; an infinite `radius_y` is that of a line contact.
        **given : float or None
            One of `load`, N (N/mm in a line contact), `approach`, mm, and `pressure`, MPa.
        """

        def contact(modulus: float) -> HertzContact | HertzLine:
            if radius_y == np.inf:
                load, pressure = given.get("load"), given.get("pressure")
                return hertz_line(modulus, radius_x, load, pressure=pressure)
            return hertz(modulus, radius_x, radius_y, **given)

        if not (depth := self.reach):
            return contact(self.contact_modulus(1.0))
        # With a larger modulus the contact is smaller and meets more of the layers; the moduli of
        # all lengths enclose the solution.
        lengths = [depth * 10.0 ** (0.25 * k) for k in range(-24, 25)]
        moduli = [math.log(self.contact_modulus(length)) for length in lengths]
        low, high = min(moduli), max(moduli)
        for _ in range(30):
            middle = 0.5 * (low + high)
            length = contact(math.exp(middle)).mean_semi_axis
            if math.log(self.contact_modulus(length)) > middle:
                low = middle
            else:
                high = middle
        return contact(math.exp(0.5 * (low + high)))

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """Return tangential over normal displacement ahead of an edge, of an element's waves.

        Parameters as in `Elasticity.opening`.
        """
        zz, LL, TT = self.shortest(dx, dy)
        across = np.einsum("am,bm->mab", normal, normal)
        return (TT * np.eye(2) + (LL - TT) * across) / zz

    def shortest(self, dx: float, dy: float) -> np.ndarray:
        """Return k (S_zz, S_LL, S_TT) for waves two elements long, 1/MPa; in a line along x."""
        heights, amplitudes = self.images
        side = max(dx, dy) if self.datum is None else dx
        return (amplitudes @ np.exp(-np.pi / side * heights))[:3]

    def worn(self, depths: tuple[float, float], step: float) -> "LinearHalfSpaces":
        """Return the law without worn depths of both bodies, mm, see `SurfaceResponse.worn`."""
        return replace(self, A=self.A.worn(depths[0], step), B=self.B.worn(depths[1], step))

    def spanning(self, length: float) -> "LinearHalfSpaces":
        """Return the law with the datum of strips of a mesh of the given length, mm (`Strips`)."""
        if self.datum is None:
            return self
        return replace(self, datum=max(self.datum, 2.0 * length))

    def single_body(self, body: str) -> Elasticity:
        """Return the law for the stress in one body, "A" or "B".

        The modulus at the surface of isotropic bodies is one.

        Raises
        ------
        ValueError
            If `body` is neither "A" nor "B", or the stress in it is not known.
        """
        if body not in ("A", "B"):
            raise ValueError(f'a body is "A" or "B", not {body!r}')
        material = getattr(self, body)
        unit = material.unit_body
        if unit is None:
            raise ValueError(
                f"the stress below the surface is not known in body {body}, {material!r}: remove "
                f"{body} from subsurface.bodies and fatigue.bodies, or these tables"
            )
        if not unit.is_isotropic:
            return LinearHalfSpaces(unit, Material(np.inf, 0.0), self.datum)
        pair = unit, Material(np.inf, unit.poisson)
        return HalfSpaces(*pair) if self.datum is None else Strips(*pair, self.datum)


def _combine(component: str, integrals: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
    """Return influence coefficients from integrals of a surface (6, ...) and amplitudes (4,)."""
    zz, LL, TT, Lz = amplitudes / (2.0 * np.pi)
    r1, xx, yy, xy, x2, y2 = integrals
    match component:
        case "zz":
            return zz * r1
        case "xx" | "yy":
            return LL * r1 + (TT - LL) * (xx if component == "xx" else yy)
        case "xy":
            return (TT - LL) * xy
    return -Lz * (x2 if component == "xz" else y2)


@lru_cache(4)
def _periodic_spectra(
    law: LinearHalfSpaces, period: tuple[int, int], dx: float, dy: float
) -> dict[str, np.ndarray]:
    """Return the spectra by component of `LinearHalfSpaces.periodic`."""
    (heights, amplitudes), (px, py) = law.images, period
    zz, LL, TT, _ = amplitudes
    # The load of an element also has waves that are shorter than two elements.
    shorter, half = np.arange(-1.0, 2.0)[:, None], (px - 1) // 2
    kx = 2.0 * np.pi * (np.fft.fftfreq(px)[: px // 2 + 1] + shorter) / dx
    ky = 2.0 * np.pi * (np.fft.rfftfreq(py) + shorter) / dy
    if law.datum is not None:
        ky, dy = np.zeros((1, ky.shape[1])), 1.0
    mean_x, mean_y = (np.sinc(k * d / (2.0 * np.pi)) for k, d in ((kx, dx), (ky, dy)))
    kx, ky, mean_x = kx[:, None, :, None], ky[:, None], mean_x[:, None, :, None]
    longest = np.pi / (dx * px)  # half of the first wave number stands for 0
    square = np.maximum(kx * kx + ky * ky, longest**2)
    mean = mean_x * mean_y[:, None] / np.sqrt(square)
    if heights.size > 1:
        sample = np.linspace(np.log(longest), 0.5 * np.log(square.max()), 400)
        fall, place = np.exp(-np.outer(np.exp(sample), heights)), 0.5 * np.log(square)

    def respond(amplitude: np.ndarray) -> np.ndarray:
        if heights.size == 1:
            return amplitude[0] * mean
        return mean * np.interp(place, sample, fall @ amplitude)

    def add(waves: np.ndarray, parity: int = 1) -> np.ndarray:
        total = waves.sum(axis=(0, 1))
        return np.concatenate((total, parity * total[half:0:-1]))

    spectra = {"zz": add(respond(zz))}
    if law.datum is not None:  # a line displaces by LL along x alone, also in the longest wave
        spectra |= {"xx": add(respond(LL)), "yy": add(respond(TT)), "xy": 0.0 * spectra["zz"]}
        return spectra
    across, difference = add(respond(TT)), respond(LL - TT) / square
    spectra |= {"xx": across + add(kx * kx * difference), "yy": across + add(ky * ky * difference)}
    return spectra | {"xy": add(kx * ky * difference, -1)}


def _share_functions(component: str) -> tuple[str, ...]:
    """Return the components that share functions of the distance with a component."""
    if component in ("zz", "xz", "yz"):
        return ("zz",) if component == "zz" else ("xz", "yz")
    return "xx", "xy", "yy"


_distant_integrals = lru_cache(4)(
    lambda x, rows, dx, dy: integrals(np.array(x)[:, None], dy * np.arange(rows), dx, dy)
)
"""The kernel integrals at distances x and offsets in y, (6, len(x), rows), mm."""


def _round_up(count: int) -> int:
    """Return the number of offsets in a table: few sizes, and none depends on earlier tables."""
    return -(-count // 32) * 32


@lru_cache(48)
def _image_coefficients(
    law: LinearHalfSpaces, components: tuple[str, ...], nx: int, ny: int, dx: float, dy: float
) -> np.ndarray:
    """Return influence coefficients of images, see `LinearHalfSpaces.coefficients`."""
    heights, amplitudes = law.images
    return load_rectangles(components, (nx, ny), (dx, dy), heights[1:], amplitudes[:, 1:])


def pair(A: SurfaceResponse, B: SurfaceResponse, datum: float | None = None) -> LinearHalfSpaces:
    """Return the elastic law of two bodies: `LinearHalfSpaces`, or the law that one of them needs.

    Parameters as in `LinearHalfSpaces`.

    Raises
    ------
    ValueError
        If the bodies need different laws.
    """
    if len(laws := A.laws | B.laws) > 1:
        names = " and ".join(sorted(law.__name__ for law in laws))
        raise ValueError(f"{names} do not combine: give bodies that need at most one of them")
    (law,) = laws or (LinearHalfSpaces,)
    return law(A, B, datum)
