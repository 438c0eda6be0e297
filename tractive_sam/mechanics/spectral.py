"""Coated and graded half-spaces, defined by their response at wave numbers.

Short waves respond like the surface material, long waves like the material far below. With the
responses c_s and c_f of homogeneous half-spaces of these materials, the response c(k) is split into

    c = c_s + (c_f - c_s) exp(-k d) + g.

`HalfSpaces` has the influence coefficients of the first term. The second term is smooth: it is the
displacement at a height d (Boussinesq and Cerruti) in closed form. The remainder g decreases fast
with the wave number, and is integrated over the wave numbers. At the wave number 0 it has a cone
and a limit that depends on the direction, so that it is felt at long distances: sums over equally
spaced waves would add its periodic images.
"""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from tractive_sam.mechanics.elasticity import HalfSpaces


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
        # At a height of two elements the kernel is smooth enough for its quadrature over one.
        height = max(self.length, 2.0 * dx, 2.0 * dy)
        table = self.surface.coefficients(component, offsets, dx, dy)
        table = table + _raised(below, self.surface, component, offsets, dx, dy, height)
        return table + self._remainder(below, component, offsets, dx, dy, height)

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
