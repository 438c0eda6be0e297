"""Kalker's linear theory: creep forces while nothing slips.

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

from .kalker_table import CREEP_COEFFICIENTS, POISSON_RATIOS


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
