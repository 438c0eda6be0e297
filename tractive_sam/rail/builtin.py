"""Standard profiles, generated from their published geometry.

S1002 is the wheel profile of UIC 510-2 and EN 13715: its pieces, with the coefficients by which
H. Netter (DLR) published it for simulation, are also listed by Polach, Berg & Iwnicki (2006) in the
Handbook of Railway Vehicle Dynamics. 60E1 (formerly UIC 60) is the rail head of EN 13674-1:
tangent arcs of the radii 300, 80 and 13 mm. The rail of the Manchester benchmark (Shackleton &
Iwnicki 2008, Vehicle System Dynamics 46, 129-149) has these radii with slightly different limits;
inclined by 1:20, it is within 4 um the rail S-UIC 519-A of EN 15302.
"""

from collections.abc import Callable, Mapping
from functools import cache, partial

import numpy as np

from .profile import Array, Profile

Piece = tuple[Array, Array]
"""Points and unit tangents, shape (n, 2) each."""


def s1002_pieces(spacing: float = 0.1) -> list[Piece]:
    """Return the pieces of the wheel profile S1002, from the flange back to the field side.

    Neighbouring pieces differ by up to 1.2e-4 mm at their joints, due to rounded coefficients.
    """
    c: tuple[float, ...] = (-4.320221063e3, -1.038384026e3, -1.065501873e2, -6.051367875)
    c += (-2.054332446e-1, -4.169739389e-3, -4.687195829e-5, -2.252755540e-7)
    b: tuple[float, ...] = (0.0, -3.358537058e-2, 1.565681624e-3, -2.810427944e-5, 5.844240864e-8)
    b += (-1.562379023e-8, 5.309217349e-15, -5.957839843e-12, 2.646656573e-13)
    return [
        _arc((-49.5, 9.519259302), 20.5, -70.0, -62.764705882, spacing),
        _arc((-55.0, 16.0), 12.0, -62.764705882, -49.662510381, spacing),
        _arc((-58.558326413, 8.834924130), 20.0, -49.662510381, -39.764473993, spacing),
        _polynomial((-93.576667419, -2.747477419), -39.764473993, -38.426669071, spacing),
        _arc((-26.210665, 16.446), -13.0, -38.426669071, -35.0, spacing),
        _polynomial(c, -35.0, -26.0, spacing),
        _polynomial(b, -26.0, 32.15796, spacing),
        _polynomial((1.364323640, -0.066666667), 32.15796, 60.0, spacing),
    ]


def _s1002() -> Profile:
    """Return the wheel profile S1002 with gaps between its pieces closed (up to 9e-5 mm)."""
    closed = s1002_pieces()
    for k in range(len(closed) - 2, -1, -1):
        points, tangents = closed[k]
        closed[k] = (points + (closed[k + 1][0][0] - points[-1]), tangents)
    return Profile.from_pieces(closed)


def _rail_head(first: float, second: float) -> Profile:
    """Return a rail head of arcs R 300, R 80 and R 13 mm that meet at `first` and `second`, mm.

    Parameters
    ----------
    first, second : float
        Half widths at which R 300 changes to R 80, and R 80 to R 13, mm.
    """
    half, angle, point = list[Piece](), 0.0, np.zeros(2)
    steepest = np.arctan(20.0)
    for radius, end in ((300.0, first), (80.0, second), (13.0, None)):
        centre = point + radius * np.array([-np.sin(angle), np.cos(angle)])
        last = steepest if end is None else np.arcsin((end - centre[0]) / radius)
        angles = np.linspace(angle, last, _number(radius * (last - angle), 0.1))
        around = np.stack((np.sin(angles), -np.cos(angles)), axis=1)
        half.append((centre + radius * around, np.stack((np.cos(angles), np.sin(angles)), axis=1)))
        point, angle = half[-1][0][-1], last
    direction = np.array([np.cos(steepest), np.sin(steepest)])
    lengths = np.linspace(0.0, 20.0, 41)[:, None]
    half.append((point + lengths * direction, np.tile(direction, (41, 1))))
    mirror = np.array([-1.0, 1.0])
    inner = [(points[::-1] * mirror, -tangents[::-1] * mirror) for points, tangents in half[::-1]]
    return Profile.from_pieces(inner + half)


def _arc(
    centre: tuple[float, float], radius: float, first: float, last: float, spacing: float
) -> Piece:
    """Return (points, unit tangents) of a circular arc between two lateral positions."""
    start, end = (np.arcsin(np.clip((y - centre[0]) / abs(radius), -1, 1)) for y in (first, last))
    angles = np.linspace(start, end, _number(abs(radius) * (end - start), spacing))
    points = np.stack(
        (centre[0] + abs(radius) * np.sin(angles), centre[1] + radius * np.cos(angles)), axis=1
    )
    tangents = np.stack((np.cos(angles), -np.sign(radius) * np.sin(angles)), axis=1)
    return points, tangents


def _polynomial(
    coefficients: tuple[float, ...], first: float, last: float, spacing: float
) -> Piece:
    """Return (points, unit tangents) of a polynomial z(y) between two lateral positions."""
    y = np.linspace(first, last, _number(last - first, spacing))
    shape = np.polynomial.Polynomial(coefficients)
    slope = shape.deriv()(y)
    tangents = np.stack((np.ones_like(y), slope), axis=1) / np.hypot(1.0, slope)[:, None]
    return np.stack((y, shape(y)), axis=1), tangents


def _number(length: float, spacing: float) -> int:
    """Return the number of points that divide a length with at most this spacing."""
    return int(np.ceil(length / spacing)) + 1


BUILTIN: Mapping[str, Callable[[], Profile]] = {
    "S1002": cache(_s1002),
    "60E1": cache(partial(_rail_head, 10.228, 26.0265)),
    "UIC60-manchester": cache(partial(_rail_head, 10.49975, 25.98806)),
}
"""Built-in profiles by name: S1002 is a wheel, the others are rails."""


def builtin_profile(name: str) -> Profile:
    """Return a built-in wheel or rail profile, by one of the names in `BUILTIN`.

    Raises
    ------
    ValueError
        If there is none of this name.
    """
    if name not in BUILTIN:
        raise ValueError(f"profile {name!r}; allowed: {', '.join(BUILTIN)}, or a file")
    return BUILTIN[name]()
