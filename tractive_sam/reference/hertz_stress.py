"""Stress below Hertz contacts of spheres and cylinders, at rest and sliding, in closed form.

Half-space z >= 0 with z into the body; tractions act on the body, so that at the surface a pressure
p gives sigma_zz = -p and a shear q along +x gives sigma_xz = -q. Lengths in one unit, stresses in
the unit of p0 or q0; arguments broadcast. Results have the shape (6, ...) with the components xx,
yy, zz, xy, xz, yz. Below cylinders (`line_...`) strain is plane in (x, z).

Sources: circle: Huber (1904), Hamilton & Goodman, J. Appl. Mech. 33 (1966) 371, and Hamilton, Proc.
IMechE C 197 (1983) 53, with the derivation in `_moments`; cylinders: McEwen, Phil. Mag. 40 (1949)
454; Johnson, Contact Mechanics (1985), (4.49) and section 7.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Stress = NDArray[np.float64]


def hertz_axis_stress(z: ArrayLike, a: float, p0: float, nu: float) -> Stress:
    """Return stresses (6, ...) on the z axis below a Hertz pressure on a circle of radius a.

    With s = z/a: sigma_zz = -p0 / (1 + s²) and
    sigma_xx = sigma_yy = -p0 ((1 + nu) (1 - s atan(1/s)) - 1 / (2 (1 + s²))).
    Source: Johnson, Contact Mechanics (1985), (3.45).

    Examples
    --------
    >>> sigma = hertz_axis_stress(0.4809, a=1.0, p0=1.0, nu=0.3)
    >>> round(float(von_mises(sigma)), 2)
    0.62
    """
    s = np.asarray(z, float) / a
    zz = -p0 / (1.0 + s * s)
    rr = -p0 * (1.0 + nu) * (1.0 - s * np.arctan2(1.0, s)) - 0.5 * zz
    zero = np.zeros_like(s)
    return np.stack([rr, rr, zz, zero, zero, zero])


def circle_pressure_stress(
    x: ArrayLike, y: ArrayLike, z: ArrayLike, a: float, p0: float, nu: float
) -> Stress:
    """Return stresses (6, ...) below the pressure p0 sqrt(1 - r²/a²) on the circle of radius a.

    Boussinesq, Love: 2 pi sigma_ij = -S_ijz + (1 - 2 nu) (A - psi_xx, psi_xx, 0, -psi_xy, 0, 0)
    with the moments of the load and A = (S_xxz + S_yyz + S_zzz) / 3.

    Examples
    --------
    >>> sigma = circle_pressure_stress(0.0, 0.0, 0.48, a=1.0, p0=1.0, nu=0.3)
    >>> round(float(von_mises(sigma)), 3)
    0.62
    """
    S = _moments(x, y, z, a)
    k = 1.0 - 2.0 * nu
    A = (S["xxz"] + S["yyz"] + S["zzz"]) / 3.0
    stress = [
        -S["xxz"] + k * (A - S["psi_xx"]),
        -S["yyz"] + k * S["psi_xx"],
        -S["zzz"],
        -S["xyz"] - k * S["psi_xy"],
        -S["xzz"],
        -S["yzz"],
    ]
    return p0 / (2.0 * np.pi) * np.stack(stress)


def circle_shear_stress(
    x: ArrayLike, y: ArrayLike, z: ArrayLike, a: float, q0: float, nu: float
) -> Stress:
    """Return stresses (6, ...) below the shear q0 sqrt(1 - r²/a²) along +x on a circle.

    Cerruti: 2 pi sigma_ij = -S_ijx + (1 - 2 nu) (chi_xyy, P - chi_xyy, 0, -chi_xxy, 0, 0) with the
    moments of the load and P = (S_xxx + S_xyy + S_xzz) / 3. In full sliding under the pressure p0,
    q0 = mu p0, the largest tension at the surface is p0 ((1 - 2 nu) / 3 + (4 + nu) pi mu / 8), at
    x = -a (Hamilton & Goodman 1966).

    Examples
    --------
    >>> sigma = circle_shear_stress(0.0, 0.0, 0.5, a=1.0, q0=1.0, nu=0.3)
    >>> sigma.shape
    (6,)
    """
    S = _moments(x, y, z, a)
    k = 1.0 - 2.0 * nu
    P = (S["xxx"] + S["xyy"] + S["xzz"]) / 3.0
    stress = [
        -S["xxx"] + k * S["chi_xyy"],
        -S["xyy"] + k * (P - S["chi_xyy"]),
        -S["xzz"],
        -S["xxy"] - k * S["chi_xxy"],
        -S["xxz"],
        -S["xyz"],
    ]
    return q0 / (2.0 * np.pi) * np.stack(stress)


def _moments(x: ArrayLike, y: ArrayLike, z: ArrayLike, a: float) -> dict[str, Stress]:
    """Return potentials of the load sqrt(1 - r²/a²) on a circle and their derivatives, by name.

    S_ijk is the integral of 3 r_i r_j r_k / R^5 times the load over the circle; psi_xx, psi_xy,
    chi_xxy and chi_xyy are the integrals of the derivatives of psi = ln(R + z) and chi = z psi - R.

    The potential of this load equals the potential of point sources at imaginary depths,

        integral of load / R = pi / (2 a) integral_-a^a (a² - t²) / R(x, y, z + i t) dt,

    since at z = 0 the right side is pi² / (4 a) (2 a² - r²) for r < a and its z-derivative vanishes
    for r > a. This weight transforms every harmonic function F of a point source into the function
    of the load. Three integrations by parts leave, with Z = z + i a,

        pi / (2 a) (4 Im F_3(Z) - 4 a Re F_2(Z)),        F_n the n-th antiderivative of F in Z.

    Needed are radial derivatives, D = (1/r) d/dr, of the chain G_0 = 1/R, G_1 = ln(R + Z),
    G_2 = Z G_1 - R, ..., each the Z-derivative of the next; with T = R + Z they have the closed
    forms below. Antiderivatives may differ by real functions of r, which drop out. The far field
    is a small difference: the relative error grows as 1e-16 (distance / a)³.
    """
    x, y, z = (np.asarray(v, float) for v in np.broadcast_arrays(x, y, z))
    Z = np.abs(z) + 1j * a
    R = np.sqrt(x * x + y * y + Z * Z)
    R = np.where(R == 0.0, 1e-300, R)  # the contact's edge: 1/R occurs times z = 0 only
    T = R + Z
    L = np.log(T)

    def of_load(third, second):
        return 2.0 * np.pi / a * (third.imag - a * second.real)

    # name_n: n-th radial derivative D; V = 1/R, Vz = dV/dz, Vzz = d²V/dz², psi and chi.
    V_1 = of_load(-0.5 * (Z / T + L), -1.0 / T)
    V_2 = of_load(-0.5 / T**2, 1.0 / (R * T**2))
    Vz_0 = of_load(Z * L - R, L)
    Vz_1 = of_load(-1.0 / T, 1.0 / (R * T))
    Vzz_0 = of_load(L, 1.0 / R)
    psi_1 = of_load(-0.5 * ((R * R + R * Z + Z * Z) / (3.0 * T) + Z * L - R), -0.5 * (Z / T + L))
    psi_2 = of_load((2.0 * R + Z) / (6.0 * T**2), -0.5 / T**2)
    psi_3 = of_load(-1.0 / (3.0 * T**3), 1.0 / (R * T**3))
    chi_2 = of_load(Z * (5.0 * R + 4.0 * Z) / (24.0 * T**2) + L / 8.0, (2.0 * R + Z) / (6.0 * T**2))
    chi_3 = of_load((3.0 * R + Z) / (24.0 * T**3), -1.0 / (3.0 * T**3))

    # R is not harmonic, R = z psi - chi: third derivatives of it are z * psi's - chi's.
    rest_2, rest_3 = z * psi_2 - chi_2, z * psi_3 - chi_3
    return {
        "xxx": x * (3.0 * rest_2 + x * x * rest_3 - 3.0 * V_1),
        "xxy": y * (rest_2 + x * x * rest_3 - V_1),
        "xyy": x * (rest_2 + y * y * rest_3 - V_1),
        "xxz": z * (V_1 + x * x * V_2) - Vz_0,
        "xyz": z * x * y * V_2,
        "yyz": z * (V_1 + y * y * V_2) - Vz_0,
        "xzz": z * x * Vz_1,
        "yzz": z * y * Vz_1,
        "zzz": z * Vzz_0 - Vz_0,
        "psi_xx": psi_1 + x * x * psi_2,
        "psi_xy": x * y * psi_2,
        "chi_xxy": y * (chi_2 + x * x * chi_3),
        "chi_xyy": x * (chi_2 + y * y * chi_3),
    }


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
