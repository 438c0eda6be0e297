"""Displacement inside a half-space under a uniform traction on a rectangle.

The solutions of Boussinesq and Cerruti for a point load (Johnson 1985, Contact Mechanics, section
3.2 and 3.6) are integrated over the rectangle in closed form. With m = 1 - 2 nu and R² = x² + y² +
z² the displacement of the half-space z >= 0 by a unit force, times 4 pi G, is

    u_x by p_x   1/R + x²/R³ + m (1/(R + z) - x²/(R (R + z)²))
    u_x by p_y   x y/R³ - m x y/(R (R + z)²)
    u_x by p_z   x z/R³ - m x/(R (R + z))
    u_z by p_x   x z/R³ + m x/(R (R + z))
    u_z by p_z   z²/R³ + 2 (1 - nu)/R

and the others follow by exchange of x and y.
"""

import numpy as np

PARITY = {
    "xx": (1, 1), "xy": (-1, -1), "yy": (1, 1), "xz": (-1, 1), "yz": (1, -1),
    "zx": (-1, 1), "zy": (1, -1), "zz": (1, 1),
}  # fmt: skip
"""Parity in x and in y of each component; "xz" is u_x by p_z."""


def displacement_quadrant(
    offsets: tuple[int, int], dx: float, dy: float, depth: float, poisson: float
) -> dict[str, np.ndarray]:
    """Return the displacements at a depth, times shear modulus, by unit tractions on a rectangle.

    Parameters
    ----------
    offsets : tuple of int
        Number of offsets (i dx, j dy) from the centre of the rectangle, from 0 on.
    dx, dy : float
        Sides of the rectangle, mm.
    depth : float
        Depth z below the surface, mm.
    poisson : float
        Poisson's ratio.

    Returns
    -------
    dict of str to ndarray of shape `offsets`
        Components of `PARITY`, mm.
    """
    x = dx * (np.arange(offsets[0] + 1) - 0.5)[:, None]
    y = dy * (np.arange(offsets[1] + 1) - 0.5)[None, :]
    corners = _antiderivatives(x, y, depth, poisson)
    return {
        name: np.diff(np.diff(values, axis=0), axis=1) / (4.0 * np.pi)
        for name, values in corners.items()
    }


def _antiderivatives(
    x: np.ndarray, y: np.ndarray, z: float, poisson: float
) -> dict[str, np.ndarray]:
    """Return the antiderivative of each displacement component by name, at corners x, y != 0."""
    m, R = 1.0 - 2.0 * poisson, np.sqrt(x**2 + y**2 + z**2)
    log_x, log_y = _log_sum(x, R, y, z), _log_sum(y, R, x, z)  # ln(R + x), ln(R + y)
    solid_angle = np.arctan2(x * y, z * R)
    # atan(y z/(x R)) - atan(y/x), and with x and y exchanged.
    turn_x = np.arctan2(x * y * (z - R), x**2 * R + y**2 * z)
    turn_y = np.arctan2(x * y * (z - R), y**2 * R + x**2 * z)
    over_x = y * np.log(R + z) + z * log_y - x * turn_x  # of x/(R (R + z))
    over_y = x * np.log(R + z) + z * log_x - y * turn_y
    inverse = x * log_y + y * log_x - z * solid_angle  # of 1/R
    return {
        "xx": inverse + y * log_x - z * solid_angle + m * (x * log_y + z * turn_x),
        "xy": -R + m * (R - z * np.log(R + z)),
        "yy": inverse + x * log_y - z * solid_angle + m * (y * log_x + z * turn_y),
        "xz": -z * log_y - m * over_x,
        "yz": -z * log_x - m * over_y,
        "zx": -z * log_y + m * over_x,
        "zy": -z * log_x + m * over_y,
        "zz": z * solid_angle + 2.0 * (1.0 - poisson) * inverse,
    }


def _log_sum(a: np.ndarray, R: np.ndarray, b: np.ndarray, c: float) -> np.ndarray:
    """Return ln(R + a) without cancellation for a < 0; R² = a² + b² + c²."""
    return np.where(a >= 0.0, np.log(R + np.abs(a)), np.log(b**2 + c**2) - np.log(R + np.abs(a)))
