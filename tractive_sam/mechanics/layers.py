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

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, Protocol

import numpy as np

from tractive_sam.kernels.half_space import (
    integrate_logarithm,
    integrate_sign,
    raised_antiderivatives,
)
from tractive_sam.mechanics.elasticity import (
    Elasticity,
    HalfSpaces,
    Material,
    Strips,
    integrals_of,
)


class SurfaceResponse(Protocol):
    """Protocol of a half-space that is isotropic in its surface."""

    @property
    def compliances(self) -> np.ndarray:
        """Limits of k (S_zz, S_LL, S_TT, |S_Lz|) for short waves, 1/MPa, shape (4,)."""

    @property
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights d_i, mm, shape (m,), and amplitudes c_i, 1/MPa, shape (4, m), without c_0."""


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

    Raises
    ------
    ValueError
        If the thickness is not positive and finite, or if the gradient is unknown.

    Examples
    --------
    >>> ts.Layer(0.003, ts.Material.from_young(300e3, 0.2)).material.shear
    125000.0
    """

    thickness: float
    material: Material
    gradient: str = "none"

    def __post_init__(self) -> None:
        if not 0.0 < self.thickness < np.inf:
            raise ValueError(f"the thickness must be above 0 and finite, not {self.thickness}")
        if self.gradient not in ("none", "exponential"):
            raise ValueError(f'the gradient must be "none" or "exponential", not {self.gradient!r}')


@dataclass(frozen=True)
class LayeredBody:
    """Half-space with layers that are bonded to each other and to the material below.

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
        _, displacement, stress = _waves(self.base, k, 0.0, -1)
        stiffness = stress @ np.linalg.inv(displacement)  # over k
        across, below = np.full(k.shape, self.base.shear), self.base.shear
        for layer in reversed(self.layers):
            # Stress over displacement at the upper face, from that at the lower face.
            decay = np.log(layer.material.shear / below) / layer.thickness
            graded = layer.gradient == "exponential" and abs(decay * layer.thickness) > 1e-6
            down, up = _graded_waves(layer, k, decay) if graded else _even_waves(layer, k)
            (top, bottom), (raised, lower) = down, up
            # Amplitudes of the waves from below, over those of the waves from above.
            ahead, back = bottom[1] - stiffness @ bottom[0], lower[1] - stiffness @ lower[0]
            reflected = -np.linalg.solve(back, ahead)
            displacement, stress = (a + b @ reflected for a, b in zip(top, raised, strict=True))
            stiffness = np.real(stress @ np.linalg.inv(displacement))
            across = _raise_shear(layer, k, across, decay if graded else 0.0)
            below = layer.material.shear
        (LL, Lz), (_, zz) = np.moveaxis(-np.linalg.inv(stiffness), 0, 2)
        return np.stack((zz, LL, 1.0 / across, Lz))

    @property
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights d_i, mm, shape (m,), and amplitudes c_i, 1/MPa, shape (4, m), without c_0.

        Raises
        ------
        ValueError
            If exponentials do not fit the response.
        """
        return _fit_images(self)


@dataclass(frozen=True)
class TransverseMaterial:
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
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Heights (0,) and amplitudes (4, 0) of the response that depends on wave numbers: none."""
        return np.empty(0), np.empty((4, 0))

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


def _even_waves(layer: Layer, k: np.ndarray) -> tuple[Any, Any]:
    """Return waves (displacement, stress/k) of a layer at its upper and lower face.

    First those that decay with the depth, then those that grow; each is 1 at the face from which
    it decays. See `_waves`.
    """
    h, material = layer.thickness, layer.material
    fall, *bottom = _waves(material, k, h, -1)
    _, *top = _waves(material, k, 0.0, -1)
    _, *raised = _waves(material, k, -h, 1)
    _, *lower = _waves(material, k, 0.0, 1)
    bottom, raised = ([fall * values for values in pair] for pair in (bottom, raised))
    return (top, bottom), (raised, lower)


def _graded_waves(layer: Layer, k: np.ndarray, decay: float) -> tuple[Any, Any]:
    """Return the waves of a graded layer as `_even_waves` does, complex.

    With the modulus G exp(-g z) the equations of equilibrium have constant coefficients. Their
    solutions are exp(l z) with l = g/2 +- sqrt(g²/4 + m), m = k² +- i k g sqrt(nu/(1 - nu)).

    Parameters
    ----------
    layer : Layer
        The layer.
    k : ndarray, shape (n,)
        Wave numbers, 1/mm.
    decay : float
        g, 1/mm.
    """
    h, shear = layer.thickness, layer.material.shear
    nu = max(layer.material.poisson, 1e-8)  # at 0 two solutions are equal
    part = (0.5 - nu) / (1.0 - nu)  # of the moduli G and lambda + 2 G
    m = k**2 + 1j * k * decay * np.sqrt(nu / (1.0 - nu)) * np.array([[1.0], [-1.0]])
    root = np.sqrt(0.25 * decay**2 + m)

    def at_faces(power: np.ndarray, place: float) -> list[list[np.ndarray]]:
        """Return the waves at the upper and the lower face, 1 at the face at `place`."""
        x = -((1.0 - part) * power - part * decay) / k
        z = part * m / k**2 - 1.0
        xz = (power * x + k * z) / k
        zz = (power * (m - k**2) - k**2 * decay) / k**3 + 2.0 * x
        waves = (np.moveaxis(np.array(rows), 2, 0) for rows in ([x, z], [xz, zz]))
        u, s = waves
        each = []
        for depth in (0.0, h):
            fall = np.exp(power * (depth - place)).T[:, None, :]
            each.append([u * fall, shear * np.exp(-decay * depth) * s * fall])
        return each

    return tuple(at_faces(0.5 * decay - root, 0.0)), tuple(at_faces(0.5 * decay + root, h))


def _raise_shear(layer: Layer, k: np.ndarray, below: np.ndarray, decay: float) -> np.ndarray:
    """Return stress over displacement across the waves, over k, from the lower to the upper face.

    Parameters
    ----------
    layer : Layer
        The layer.
    k : ndarray, shape (n,)
        Wave numbers, 1/mm.
    below : ndarray, shape (n,)
        The value at the lower face, MPa.
    decay : float
        g of the modulus G exp(-g z), 1/mm.
    """
    h, shear = layer.thickness, layer.material.shear
    root = np.sqrt(0.25 * decay**2 + k**2)
    down, up = (0.5 * decay - root) / k, (0.5 * decay + root) / k
    lower = shear * np.exp(-decay * h)
    reflected = -(lower * down + below) / (lower * up + below) * np.exp(-2.0 * root * h)
    return -shear * (down + up * reflected) / (1.0 + reflected)


def _fit_at_ratio(
    body: LayeredBody, ratio: float, per_height: int = 4
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return heights in geometric progression, amplitudes that fit the response, and the error.

    Parameters
    ----------
    body : LayeredBody
        The body.
    ratio : float
        Ratio of successive heights.
    per_height : int
        Wave numbers at which the response is fitted, for each height.
    """
    first, depth = body.layers[0].thickness, sum(layer.thickness for layer in body.layers)
    moduli = [layer.material.shear for layer in body.layers] + [body.base.shear]
    # A soft layer is felt up to waves of its depth times the ratio of the moduli.
    longest = 100.0 * depth * max(moduli) / min(moduli)
    smallest, largest = 0.01 / longest, 40.0 / first
    if any(layer.gradient != "none" for layer in body.layers):
        smallest = max(smallest, 1e-3 / depth)  # longer ones lose digits
    if body.layers[0].gradient != "none":  # the response tends to that of the surface as 1/k
        first, largest = 1e-3 * first, 4e3 / first
    heights = 0.5 * first * ratio ** np.arange(np.log(longest / (0.5 * first)) / np.log(ratio))
    k = np.geomspace(
        smallest, largest, per_height * int(np.log(largest / smallest) / np.log(ratio))
    )
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
        return _coefficients(self, component, offsets, dx, dy)

    def periodic(
        self, component: str, period: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray | None:
        """Return the spectrum of displacements that repeat with a period, from the response.

        It is positive. Where a coating is stiff, that of the coefficients within a period is not:
        their slope jumps at the end of the period.

        Parameters as in `Elasticity.periodic`.
        """
        heights, amplitudes = self.images
        zz, LL, TT, _ = amplitudes
        if component not in ("zz", "xx", "xy", "yy"):
            return None
        nx, ny = (np.fft.fftfreq(period[0]), np.fft.rfftfreq(period[1]))
        # The load of an element also has waves that are shorter than two elements.
        shorter = np.arange(-1.0, 2.0)
        kx = 2.0 * np.pi * (nx + shorter[:, None]) / dx
        ky = 2.0 * np.pi * (ny + shorter[:, None]) / dy
        if self.datum is not None:
            ky, dy = np.zeros((1, ny.size)), 1.0
        longest = np.pi / (dx * period[0])  # half of the first wave number stands for 0
        k = np.maximum(np.hypot(kx[:, None, :, None], ky[:, None, :]), longest)
        sample = np.geomspace(longest, k.max(), 400)
        fall = np.exp(-np.outer(sample, heights))
        mean = np.sinc(kx * dx / (2.0 * np.pi))[:, None, :, None]
        mean = mean * np.sinc(ky * dy / (2.0 * np.pi))[:, None, :] / k

        def interpolate(amplitude: np.ndarray) -> np.ndarray:
            return mean * np.interp(np.log(k), np.log(sample), fall @ amplitude)

        along, across = (kx[:, None, :, None] / k) ** 2, (ky[:, None, :] / k) ** 2
        match component:
            case "zz":
                waves = interpolate(zz)
            case "xx":
                waves = interpolate(TT) + along * interpolate(LL - TT)
            case "yy":
                waves = interpolate(TT) + across * interpolate(LL - TT)
            case "xy":
                waves = kx[:, None, :, None] * ky[:, None, :] / k**2 * interpolate(LL - TT)
        # A line displaces by LL along x alone, also in the longest wave.
        if self.datum is not None and component != "zz":
            waves = interpolate({"xx": LL, "yy": TT}.get(component, 0.0 * LL))
        return waves.sum(axis=(0, 1))

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """Return length / E*, E* for waves that are as long as the contact, mm/MPa.

        Parameters as in `Elasticity.gap_per_pressure`.
        """
        return length / contact_modulus(self.A, self.B, length)

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """Return tangential over normal displacement ahead of an edge, of an element's waves.

        Parameters as in `Elasticity.opening`.
        """
        heights, amplitudes = self.images
        zz, LL, TT, _ = amplitudes @ np.exp(-np.pi / max(dx, dy) * heights)
        across = np.einsum("am,bm->mab", normal, normal)
        return (TT * np.eye(2) + (LL - TT) * across) / zz

    def spanning(self, length: float) -> "LinearHalfSpaces":
        """Return the law with the datum of strips of a mesh of the given length, mm (`Strips`)."""
        if self.datum is None:
            return self
        return replace(self, datum=max(self.datum, 2.0 * length))

    def single_body(self, body: str) -> Elasticity:
        """Return the half-spaces for the stress in one body, "A" or "B", if it is homogeneous.

        Raises
        ------
        ValueError
            If the stress in the body is not known: if it has layers or is not isotropic.
        """
        if body not in ("A", "B"):
            raise ValueError(f'a body is "A" or "B", not {body!r}')
        material = getattr(self, body)
        if not isinstance(material, Material):
            raise ValueError(
                f"the stress below the surface is known for homogeneous isotropic bodies only, and "
                f"body {body} is {material!r}: remove {body} from subsurface.bodies and "
                "fatigue.bodies, or these tables"
            )
        pair = Material(1.0, material.poisson), Material(np.inf, material.poisson)
        return HalfSpaces(*pair) if self.datum is None else Strips(*pair, self.datum)


@lru_cache(24)
def _coefficients(
    law: LinearHalfSpaces, component: str, offsets: tuple[int, int], dx: float, dy: float
) -> np.ndarray:
    """Return influence coefficients (`Elasticity.coefficients`); the last ones are stored."""
    heights, amplitudes = law.images
    if law.datum is not None:
        return _load_strips(component, offsets, dx, heights, amplitudes, law.datum)
    zz, LL, TT, Lz = amplitudes[:, 0]
    r1, xx, yy, xy, x2, y2 = integrals_of(dx, dy).at(*offsets)
    surface = {
        "zz": zz * r1,
        "xx": LL * r1 + (TT - LL) * xx,
        "yy": LL * r1 + (TT - LL) * yy,
        "xy": (TT - LL) * xy,
        "xz": -Lz * x2,
        "yz": -Lz * y2,
    }[component] / (2.0 * np.pi)
    if heights.size == 1:
        return surface
    return surface + _load_rectangles(component, offsets, (dx, dy), heights[1:], amplitudes[:, 1:])


def contact_modulus(A: SurfaceResponse, B: SurfaceResponse, length: float) -> float:
    """Return the contact modulus E* of two bodies for waves as long as a contact, MPa.

    The wave number is 2.2 / a: with its modulus, the Hertz contact of a sphere is as large as that
    of a body with a coating, with errors of 8 % for moduli of the coating from 1/10 to 50 times
    that of the body.

    Parameters
    ----------
    A, B : SurfaceResponse
        The bodies.
    length : float
        Half length of the contact, mm.
    """
    compliance = 0.0
    for body in (A, B):
        heights, amplitudes = body.images
        compliance += body.compliances[0] + amplitudes[0] @ np.exp(-2.2 / length * heights)
    return float(2.0 / compliance)


def _load_rectangles(
    component: str,
    offsets: tuple[int, int],
    sides: tuple[float, float],
    heights: np.ndarray,
    amplitudes: np.ndarray,
    near: float = 12.0,
) -> np.ndarray:
    """Return the displacement of surfaces at heights by a unit traction on an element, mm/MPa.

    Near the element, closed forms are added over the heights. Far from it the kernels are functions
    of the distance, which are added once and interpolated.

    Parameters
    ----------
    component, offsets, sides
        See `Elasticity.coefficients`.
    heights : ndarray, shape (m,)
        mm.
    amplitudes : ndarray, shape (4, m)
        See `SurfaceResponse.images`.
    near : float
        Distance from an element, in its longest side, beyond which Gauss points integrate over it.
    """
    table = np.empty(offsets)
    x, y = (side * np.arange(n) for side, n in zip(sides, offsets, strict=True))
    distance, longest = np.hypot(x[:, None], y), max(sides)
    close = np.nonzero(distance <= near * longest)
    columns, rows = close[0].max() + 1, close[1].max() + 1
    low = heights <= near * longest
    corners = _add_corners(component, (columns, rows), sides, heights[low], amplitudes[:, low])
    table[close] = corners[close]
    high = _Radial(component, heights[~low], amplitudes[:, ~low])
    table[close] += _integrate(high.at, x[close[0]], y[close[1]], sides, 3)
    radial = _Radial(component, heights, amplitudes)
    radial = radial.interpolated((near - 1.0) * longest, distance[-1, -1] + longest)
    for least, most, points in ((near, 40.0, 3), (40.0, np.inf, 2)):
        part = np.nonzero((distance > least * longest) & (distance <= most * longest))
        table[part] = _integrate(radial.interpolate, x[part[0]], y[part[1]], sides, points)
    return table / (2.0 * np.pi)


def _add_corners(
    component: str,
    offsets: tuple[int, int],
    sides: tuple[float, float],
    heights: np.ndarray,
    amplitudes: np.ndarray,
) -> np.ndarray:
    """Return sums of closed forms over heights, times 2 pi; see `_load_rectangles`."""
    x, y = (side * (np.arange(n + 1) - 0.5) for side, n in zip(sides, offsets, strict=True))
    kernels = raised_antiderivatives(x[:, None, None], y[:, None], heights)
    inverse, fall_x, fall_y, fall_xy, over_x, over_y = kernels
    zz, LL, TT, Lz = amplitudes
    values = {
        "zz": lambda: inverse @ zz,
        "xx": lambda: inverse @ TT + fall_x @ (LL - TT),
        "yy": lambda: inverse @ TT + fall_y @ (LL - TT),
        "xy": lambda: -fall_xy @ (LL - TT),
        "xz": lambda: -over_x @ Lz,
        "yz": lambda: -over_y @ Lz,
    }[component]()
    return np.diff(np.diff(values, axis=0), axis=1)


def _integrate(
    kernel: Callable[[np.ndarray, np.ndarray], np.ndarray],
    x: np.ndarray,
    y: np.ndarray,
    sides: tuple[float, float],
    points: int,
) -> np.ndarray:
    """Return the integrals of a kernel over elements with centres x, y (n,) by Gauss points."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    (dx, dy), total = sides, np.zeros(x.shape)
    for i, j in np.ndindex(points, points):
        share = 0.25 * dx * dy * weights[i] * weights[j]
        total += share * kernel(x + 0.5 * dx * nodes[i], y + 0.5 * dy * nodes[j])
    return total


@dataclass(eq=False)
class _Radial:
    """Displacement of surfaces at heights by a unit force, times 2 pi, by functions of distance.

    Parameters
    ----------
    component : str
        See `Elasticity.coefficients`.
    heights : ndarray, shape (m,)
        mm.
    amplitudes : ndarray, shape (4, m)
        See `SurfaceResponse.images`.
    """

    component: str
    heights: np.ndarray
    amplitudes: np.ndarray

    def at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the displacement at (x, y)."""
        r = np.maximum(np.hypot(x, y), 1e-60)  # the values at 0 are limits
        return self._combine(x, y, r, self._functions(r))

    def _functions(self, r: np.ndarray) -> list[np.ndarray]:
        """Return the one or two functions of the distance, of order 1, times its powers."""
        zz, LL, TT, Lz = self.amplitudes
        r = r[:, None]
        R = np.sqrt(r**2 + self.heights**2)
        reach = R + self.heights
        match self.component:
            case "zz":
                return [(r / R) @ zz]
            case "xz" | "yz":
                return [(r**2 / (R * reach)) @ Lz]
        bend = (r**3 / (R * reach**2)) @ (LL - TT)
        if self.component == "xy":
            return [bend]
        return [(r / R) @ TT + (r / reach) @ (LL - TT), bend]

    def _combine(
        self, x: np.ndarray, y: np.ndarray, r: np.ndarray, functions: list[np.ndarray]
    ) -> np.ndarray:
        """Return the displacement from the functions of the distance r."""
        first, *bend = functions
        match self.component:
            case "zz":
                return first / r
            case "xz" | "yz":
                return -first * (x if self.component == "xz" else y) / r**2
            case "xy":
                return -first * x * y / r**3
        along = x if self.component == "xx" else y
        return (first - (along / r) ** 2 * bend[0]) / r

    def interpolated(self, nearest: float, farthest: float, step: float = 0.01) -> "_Radial":
        """Tabulate the functions between two distances, in equal steps of their logarithm."""
        self._start, self._step = np.log(nearest) - step, step
        count = int((np.log(farthest) - self._start) / step) + 4
        nodes = np.exp(self._start + step * np.arange(count))
        self._table = self._functions(nodes)
        return self

    def interpolate(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the displacement at (x, y) by cubic interpolation (error 1e-10)."""
        square = x * x + y * y
        place = (0.5 * np.log(square) - self._start) / self._step
        first = place.astype(int) - 1
        t = place - (first + 1)
        weights = (
            -t * (t - 1.0) * (t - 2.0) / 6.0,
            (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0,
        )
        values = [
            sum(weight * table[first + i] for i, weight in enumerate(weights))
            for table in self._table
        ]
        return self._combine(x, y, np.sqrt(square), values)


def _load_strips(
    component: str,
    offsets: tuple[int, int],
    dx: float,
    heights: np.ndarray,
    amplitudes: np.ndarray,
    datum: float,
    near: float = 12.0,
) -> np.ndarray:
    """Return the displacement of strips at heights by a unit traction on a strip, mm/MPa.

    As in `Strips`, displacements are zero on average at the distance `datum` from each load, and
    columns other than the first are zero. The first height is 0.

    Parameters as in `Elasticity.coefficients` and `_load_rectangles`.
    """
    table, x = np.zeros(offsets), dx * np.arange(offsets[0])
    rows = {"zz": amplitudes[0], "xx": amplitudes[1], "yy": amplitudes[2], "xz": -amplitudes[3]}
    if component not in rows:
        return table
    (first, *_), d = rows[component], heights[1:]
    odd = component == "xz"
    surface = integrate_sign(x, dx) if odd else integrate_logarithm(x, dx, datum)

    def kernel(x: np.ndarray) -> np.ndarray:
        """Return the displacement by a force at the distances x, (n, m)."""
        if odd:
            return 2.0 * np.arctan(x[:, None] / d)
        return -np.log1p((x[:, None] ** 2 - datum**2) / (d**2 + datum**2))

    def antiderivative(x: np.ndarray) -> np.ndarray:
        """Return the antiderivative of the kernel."""
        x = x[:, None]
        if odd:
            return 2.0 * x * np.arctan(x / d) - d * np.log((x**2 + d**2) / (d**2 + datum**2))
        return x * (kernel(x[:, 0]) + 2.0) - 2.0 * d * np.arctan(x / d)

    nodes, weights = np.polynomial.legendre.leggauss(3)
    raised = sum(
        0.5 * dx * w * kernel(x + 0.5 * dx * t) for t, w in zip(nodes, weights, strict=True)
    )
    close = (x <= near * dx)[:, None] & (d <= near * dx)
    corners = dx * (np.arange(offsets[0] + 1) - 0.5)
    raised = np.where(close, np.diff(antiderivative(corners), axis=0), raised)
    table[:, 0] = (first * surface + raised @ rows[component][1:]) / (2.0 * np.pi)
    return table
