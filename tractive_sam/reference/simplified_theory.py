"""Kalker's simplified theory, by his algorithm FASTSIM."""

import math

import numpy as np

from .kalker import CreepForces, creep_coefficients


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
