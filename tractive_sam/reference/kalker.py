"""Kalker's linear theory with his tabulated coefficients, and his simplified theory (FASTSIM).

Convention: a is the semi-axis in the rolling direction x, c² = a b, forces act on body A:

    F_x = -G c² C11 xi_x
    F_y = -G (c² C22 xi_y + c³ C23 phi)
    M_z = -G (-c³ C23 xi_y + c⁴ C33 phi)

Source: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990).
"""

import functools
import math
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

POISSON_RATIOS = (0.0, 0.25, 0.5)
"""Combined Poisson's ratios of the three columns of every coefficient."""

CREEP_COEFFICIENTS = (
    # a/b,       C11,               C22,               C23,                C33
    (0.1, (2.51, 3.31, 4.85), (2.51, 2.52, 2.53), (0.334, 0.473, 0.731), (6.42, 8.28, 11.7)),
    (0.2, (2.59, 3.37, 4.81), (2.59, 2.63, 2.66), (0.483, 0.603, 0.809), (3.46, 4.27, 5.66)),
    (0.3, (2.68, 3.44, 4.8), (2.68, 2.75, 2.81), (0.607, 0.715, 0.889), (2.49, 2.96, 3.72)),
    (0.4, (2.78, 3.53, 4.82), (2.78, 2.88, 2.98), (0.72, 0.823, 0.977), (2.02, 2.32, 2.77)),
    (0.5, (2.88, 3.62, 4.83), (2.88, 3.01, 3.14), (0.827, 0.929, 1.07), (1.74, 1.93, 2.22)),
    (0.6, (2.98, 3.72, 4.91), (2.98, 3.14, 3.31), (0.93, 1.03, 1.18), (1.56, 1.68, 1.86)),
    (0.7, (3.09, 3.81, 4.97), (3.09, 3.28, 3.48), (1.03, 1.14, 1.29), (1.43, 1.5, 1.6)),
    (0.8, (3.19, 3.91, 5.05), (3.19, 3.41, 3.65), (1.13, 1.25, 1.4), (1.34, 1.37, 1.42)),
    (0.9, (3.29, 4.01, 5.12), (3.29, 3.54, 3.82), (1.23, 1.36, 1.51), (1.27, 1.27, 1.27)),
    (1.0, (3.4, 4.12, 5.2), (3.4, 3.67, 3.98), (1.33, 1.47, 1.63), (1.21, 1.19, 1.16)),
    (1 / 0.9, (3.51, 4.22, 5.3), (3.51, 3.81, 4.16), (1.44, 1.59, 1.77), (1.16, 1.11, 1.06)),
    (1 / 0.8, (3.65, 4.36, 5.42), (3.65, 3.99, 4.39), (1.58, 1.75, 1.94), (1.1, 1.04, 0.954)),
    (1 / 0.7, (3.82, 4.54, 5.58), (3.82, 4.21, 4.67), (1.76, 1.95, 2.18), (1.05, 0.965, 0.852)),
    (1 / 0.6, (4.06, 4.78, 5.8), (4.06, 4.5, 5.04), (2.01, 2.23, 2.5), (1.01, 0.892, 0.751)),
    (1 / 0.5, (4.37, 5.1, 6.11), (4.37, 4.9, 5.56), (2.35, 2.62, 2.96), (0.958, 0.819, 0.65)),
    (1 / 0.4, (4.84, 5.57, 6.57), (4.84, 5.48, 6.31), (2.88, 3.24, 3.7), (0.912, 0.747, 0.549)),
    (1 / 0.3, (5.57, 6.34, 7.34), (5.57, 6.4, 7.51), (3.79, 4.32, 5.01), (0.868, 0.674, 0.446)),
    (1 / 0.2, (6.96, 7.78, 8.82), (6.96, 8.14, 9.79), (5.72, 6.63, 7.89), (0.828, 0.601, 0.341)),
    (1 / 0.1, (10.7, 11.7, 12.9), (10.7, 12.8, 16.0), (12.2, 14.6, 18.0), (0.795, 0.526, 0.228)),
)
"""Rows (a/b, C11, C22, C23, C33), each coefficient for the three `POISSON_RATIOS`.

Source: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), Table E.3.
"""


class CreepCoefficients(NamedTuple):
    """Kalker's creep coefficients C11, C22, C23 and C33.

    Examples
    --------
    >>> creep_coefficients(1.0, 0.25).C11
    4.12
    """

    C11: float
    C22: float
    C23: float
    C33: float


class CreepForces(NamedTuple):
    """Resultant tractions on body A: F_x, F_y in N and the moment M_z in N mm.

    Examples
    --------
    >>> linear_creep_forces(1.0, 1.0, 80e3, 0.25, xi_x=-1e-4).Fx
    32.96
    """

    Fx: float
    Fy: float
    Mz: float


def creep_coefficients(a_over_b: float, poisson: float) -> CreepCoefficients:
    """Return Kalker's creep coefficients, interpolated from his table.

    Cubic splines of the logarithms over log(a/b), then the parabola through the three tabulated
    Poisson's ratios: exact at every entry of the table.

    Parameters
    ----------
    a_over_b : float
        Semi-axis in the rolling direction over the lateral one, 0.1 to 10.
    poisson : float
        Combined Poisson's ratio, 0 to 0.5.

    Raises
    ------
    ValueError
        If an argument lies outside the table.

    Examples
    --------
    >>> round(creep_coefficients(a_over_b=1.0, poisson=0.28).C11, 2)
    4.23
    """
    if not 0.1 <= a_over_b <= 10:
        raise ValueError(f"Kalker's table covers a/b from 0.1 to 10, not {a_over_b}")
    if not 0 <= poisson <= 0.5:
        raise ValueError(f"Kalker's table covers Poisson's ratios from 0 to 0.5, not {poisson}")
    columns = np.exp(_log_coefficients()(math.log(a_over_b)))
    return CreepCoefficients(*map(float, columns @ _parabola_weights(poisson)))


def linear_creep_forces(
    a: float,
    b: float,
    shear: float,
    poisson: float,
    *,
    xi_x: float = 0.0,
    xi_y: float = 0.0,
    spin: float = 0.0,
) -> CreepForces:
    """Return force (N) and moment (N mm) on body A by Kalker's linear theory, without sliding.

    Parameters
    ----------
    a, b : float
        Semi-axes of the contact in x and y, mm.
    shear, poisson : float
        Combined shear modulus G, MPa, and Poisson's ratio.
    xi_x, xi_y : float
        Longitudinal and lateral creepage.
    spin : float
        Spin creepage phi, 1/mm.

    Raises
    ------
    ValueError
        If a/b or the Poisson's ratio lies outside Kalker's table.

    Examples
    --------
    >>> forces = linear_creep_forces(1.0, 1.0, 80e3, 0.25, spin=1e-5)
    >>> round(forces.Fy, 3), round(forces.Mz, 3)
    (-1.176, -0.952)
    """
    C11, C22, C23, C33 = creep_coefficients(a / b, poisson)
    c = math.sqrt(a * b)
    return CreepForces(
        Fx=-shear * c**2 * C11 * xi_x,
        Fy=-shear * (c**2 * C22 * xi_y + c**3 * C23 * spin),
        Mz=-shear * (-(c**3) * C23 * xi_y + c**4 * C33 * spin),
    )


@functools.cache
def _log_coefficients() -> CubicSpline:
    """Spline of the logarithms of the creep coefficients, (4, 3), over log(a/b)."""
    ratios, *coefficients = zip(*CREEP_COEFFICIENTS, strict=True)
    return CubicSpline(np.log(ratios), np.log(np.moveaxis(np.array(coefficients), 0, 1)))


def _parabola_weights(poisson: float) -> list[float]:
    """Return the weights of the three tabulated Poisson's ratios in a parabola through them."""
    return [
        math.prod((poisson - ratio) / (node - ratio) for ratio in POISSON_RATIOS if ratio != node)
        for node in POISSON_RATIOS
    ]


def fastsim(
    a: float,
    b: float,
    shear: float,
    poisson: float,
    *,
    load: float,
    mu: float,
    xi_x: float = 0.0,
    xi_y: float = 0.0,
    spin: float = 0.0,
    elements: tuple[int, int] = (50, 50),
) -> CreepForces:
    """Return the creep forces by FASTSIM, Kalker's theory with an independent spring per point.

    The flexibilities L_1 = 8 a / (3 G C11), L_2 = 8 a / (3 G C22) and
    L_3 = pi a sqrt(a/b) / (4 G C23) give the forces of the linear theory without slip. In every
    strip along x the traction increases from the leading edge by the rigid slip over the
    flexibility, and is limited to mu p, with the paraboloid p =
    2 P / (pi a b) (1 - x²/a² - y²/b²) of equal load. As the flexibilities differ, the direction of
    full slip is (xi_x / L_1, xi_y / L_2), which differs slightly from the direction of the bodies.

    Source: Kalker, A Fast Algorithm for the Simplified Theory of Rolling Contact, Vehicle System
    Dynamics 11 (1982) 1-13.

    Parameters
    ----------
    a, b : float
        Semi-axes of the contact in x and y, mm.
    shear, poisson : float
        Combined shear modulus G, MPa, and Poisson's ratio.
    load : float
        Normal load P, N.
    mu : float
        Friction coefficient.
    xi_x, xi_y : float
        Longitudinal and lateral creepage.
    spin : float
        Spin creepage phi, 1/mm.
    elements : tuple of int
        Number of elements along x, and of strips.

    Raises
    ------
    ValueError
        If a/b or the Poisson's ratio lies outside Kalker's table.

    Examples
    --------
    >>> contact = dict(a=1.0, b=1.0, shear=80e3, poisson=0.25, load=1e3, mu=0.3)
    >>> linear = linear_creep_forces(1.0, 1.0, 80e3, 0.25, xi_x=-1e-6).Fx
    >>> round(fastsim(**contact, xi_x=-1e-6).Fx / linear, 2)
    1.0
    >>> round(fastsim(**contact, xi_x=-1.0).Fx)
    300
    """
    C11, C22, C23, _ = creep_coefficients(a / b, poisson)
    L1, L2 = (8.0 * a / (3.0 * shear * coefficient) for coefficient in (C11, C22))
    L3 = math.pi * a * math.sqrt(a / b) / (4.0 * shear * C23)
    along, strips = elements
    y = b * ((2.0 * np.arange(strips) + 1.0) / strips - 1.0)
    half = a * np.sqrt(1.0 - (y / b) ** 2)
    step, area = 2.0 * half / along, 2.0 * half / along * (2.0 * b / strips)
    # So that the pressures at the centres of all elements carry the load.
    middles = half * ((2.0 * np.arange(along)[:, None] + 1.0) / along - 1.0)
    shape = 1.0 - (middles / a) ** 2 - (y / b) ** 2
    bound = mu * load * shape / (shape * area).sum()
    traction, Q, moment = np.zeros((2, strips)), np.zeros(2), 0.0
    for k in range(along - 1, -1, -1):
        x = middles[k]
        # From the face ahead to the centre of the first one, from centre to centre of others.
        dx = 0.5 * step if k == along - 1 else step
        at = x + 0.5 * dx
        rigid = np.stack([xi_x / L1 - spin * y / L3, xi_y / L2 + spin * at / L3])
        traction = traction - rigid * dx
        size = np.hypot(*traction)
        traction = traction * np.where(size > bound[k], bound[k] / np.maximum(size, 1e-300), 1.0)
        Q += (traction * area).sum(axis=1)
        moment += float(((x * traction[1] - y * traction[0]) * area).sum())
    return CreepForces(float(Q[0]), float(Q[1]), moment)
