"""Forces of a Hertz contact in full slip with spin."""

import math

import numpy as np


def full_slip_with_spin(
    a_over_b: float, slip: tuple[float, float], spin: float, points: int = 128, most: int = 20_000
) -> tuple[float, float, float]:
    """Return (Q_x, Q_y, M_z / c) / (mu P) of full slip, c = sqrt(a b), isotropic friction.

    The traction -mu p s/|s| against the slip s = (xi_x - phi y, xi_y + phi x) of rigid bodies,
    integrated over the ellipse of Hertz in polar coordinates around the pole at which the slip
    vanishes. There its direction depends on the angle alone, and the integral along the radius is
    elementary. It is the limit of rolling for increasing creepages.

    Parameters
    ----------
    a_over_b : float
        Semi-axis in the rolling direction over the lateral one.
    slip : tuple of float
        (xi_x, xi_y), in any unit.
    spin : float
        c phi, in the unit of `slip`.
    points : int
        Integration points over the angle if the pole of the slip is outside the contact; if it is
        inside, their number increases towards the edge.
    most : int
        Largest number of integration points.

    Examples
    --------
    >>> full_slip_with_spin(1.0, (1.0, 0.0), 0.0)
    (-1.0, 0.0, 0.0)
    >>> round(full_slip_with_spin(1.0, (0.0, 0.0), 1.0)[2] / (-3 * np.pi / 16), 6)
    1.0
    """
    size = math.hypot(*slip)
    if spin == 0.0:
        return 0.0 - slip[0] / size, 0.0 - slip[1] / size, 0.0
    stretch = math.sqrt(a_over_b)
    # Coordinates in which the ellipse is the unit circle; the pole is at distance d.
    pole = np.array([-slip[1] / spin / stretch, slip[0] / spin * stretch])
    d = math.hypot(*pole)
    angle, weight = _angles_around(pole, d, points, most)
    n = np.stack([np.cos(angle), np.sin(angle)])
    m = -(pole @ n)
    h2 = np.maximum(1.0 - (pole[0] * n[1] - pole[1] * n[0]) ** 2, 0.0)
    # Integrals of rho p and rho² p over rho, p = sqrt(h² - (rho - m)²).
    if d < 1.0:
        g, h = math.sqrt(1.0 - d * d), np.sqrt(h2)
        arc = 0.5 * math.pi + np.arcsin(np.clip(m / h, -1.0, 1.0))
        zeroth = 0.5 * (h2 * arc + m * g)
        first = g**3 / 3.0
        second = h2**2 / 8.0 * arc + m * (2.0 * m * m - h2) * g / 8.0
    else:
        zeroth, first, second = 0.5 * math.pi * h2, 0.0, math.pi / 8.0 * h2**2
    radial = first + m * zeroth
    moment = second + 2.0 * m * first + m * m * zeroth
    v = n * np.array([[stretch], [1.0 / stretch]])
    length = np.hypot(*v)
    factor = -math.copysign(3.0 / (2.0 * math.pi), spin)
    Qx = factor * (weight * radial * -v[1] / length).sum()
    Qy = factor * (weight * radial * v[0] / length).sum()
    about_pole = factor * (weight * moment * length).sum()
    x, y = pole[0] * stretch, pole[1] / stretch
    return float(Qx), float(Qy), float(about_pole + x * Qy - y * Qx)


def _angles_around(
    pole: np.ndarray, distance: float, points: int, max_points: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the angles of rays from a pole that meet the unit disc, and their weights."""
    if distance < 1.0:
        # Near the edge the integrand has a peak as wide as the distance of the pole from it.
        count = int(min(max_points, points * (1.0 + 0.3 / (1.0 - distance))))
        return np.arange(count) * (2.0 * math.pi / count), np.full(count, 2.0 * math.pi / count)
    nodes, weights = np.polynomial.legendre.leggauss(points)
    half = math.asin(min(1.0, 1.0 / distance))
    return math.atan2(-pole[1], -pole[0]) + half * nodes, half * weights
