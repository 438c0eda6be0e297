"""Stress below the Hertz contact of two parallel cylinders, at rest and sliding.

Half-space z >= 0 with z into the body; tractions act on the body, so that at the surface a pressure
p gives sigma_zz = -p and a shear q along +x gives sigma_xz = -q. Plane strain in (x, z). Lengths
in one unit, stresses in the unit of p0 or q0; arguments broadcast. Results have the shape (6, ...)
with the components xx, yy, zz, xy, xz, yz.

Sources: McEwen, Phil. Mag. 40 (1949) 454; Johnson, Contact Mechanics (1985), (4.49) and section
7.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Stress = NDArray[np.float64]


def line_pressure_stress(x: ArrayLike, z: ArrayLike, a: float, p0: float, nu: float) -> Stress:
    """Return plane-strain stresses (6, ...) below the pressure p0 sqrt(1 - x²/a²) on a strip.

    With (m + i n)² = a² + (z + i x)² and f = (z² + n²) / (m² + n²):

        sigma_xx = -(p0/a) (m (1 + f) - 2 z),    sigma_zz = -(p0/a) m (1 - f)
        sigma_xz = -(p0/a) n (m² - z²) / (m² + n²)

    Examples
    --------
    >>> sigma = line_pressure_stress(0.0, 0.704, a=1.0, p0=1.0, nu=0.3)
    >>> round(float(von_mises(sigma)), 4)
    0.5575
    """
    x, z = np.asarray(x, float), np.asarray(z, float)
    m, n, sum2 = _coordinates(x, z, a)
    f = (z * z + n * n) / sum2
    xx = -p0 / a * (m * (1.0 + f) - 2.0 * z)
    zz = -p0 / a * m * (1.0 - f)
    xz = -p0 / a * n * (m * m - z * z) / sum2
    return _plane_strain(xx, zz, xz, nu)


def line_shear_stress(x: ArrayLike, z: ArrayLike, a: float, q0: float, nu: float) -> Stress:
    """Return plane-strain stresses (6, ...) below the shear q0 sqrt(1 - x²/a²) on a strip.

    With m, n of `line_pressure_stress`: sigma_zz and sigma_xz are the sigma_xz and sigma_xx of the
    pressure q0, and sigma_xx = (q0/a) (n (2 - (z² - m²) / (m² + n²)) - 2 x).

    Examples
    --------
    >>> line_shear_stress(0.0, 0.5, a=1.0, q0=1.0, nu=0.3).shape
    (6,)
    """
    x, z = np.asarray(x, float), np.asarray(z, float)
    m, n, sum2 = _coordinates(x, z, a)
    xx = q0 / a * (n * (2.0 - (z * z - m * m) / sum2) - 2.0 * x)
    pressed = line_pressure_stress(x, z, a, q0, nu)
    return _plane_strain(xx, pressed[4], pressed[0], nu)


def _coordinates(x: Stress, z: Stress, a: float) -> tuple[Stress, Stress, Stress]:
    """Return m, n and m² + n² of McEwen's solution at points (x, z).

    The sum is 1 instead of 0 on the edges of the contact: it only divides 0 there.
    """
    root = np.sqrt(a * a + (z + 1j * x) ** 2)
    m, n = root.real, np.copysign(root.imag, x)
    sum2 = m * m + n * n
    return m, n, np.where(sum2 > 0.0, sum2, 1.0)


def _plane_strain(xx: Stress, zz: Stress, xz: Stress, nu: float) -> Stress:
    """Return all six stress components from xx, zz and xz in plane strain."""
    zero = np.zeros_like(xx)
    return np.stack([xx, nu * (xx + zz), zz, zero, xz, zero])
