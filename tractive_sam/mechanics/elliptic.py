"""Elliptic integrals of numbers, in Carlson's symmetric forms.

Those of scipy take a tenth of a second to load, and every scene needs them.

Source: Carlson, Numer. Algorithms 10 (1995) 13, sections 2 and 4 (DLMF 19.36.1): arguments are made
alike by the duplication theorem, each step a quarter as far apart.
"""

from math import sqrt

_ALIKE = 1e-8
"""What they end apart, over their mean: its square is what the integral misses."""


def elliprf(x: float, y: float, z: float) -> float:
    """R_F, half the integral of ((t + x) (t + y) (t + z))^-1/2 over t > 0; one of them may be 0."""
    while True:
        mean = (x + y + z) / 3.0
        if max(abs(mean - x), abs(mean - y), abs(mean - z)) < _ALIKE * mean:
            return 1.0 / sqrt(mean)
        step = sqrt(x) * sqrt(y) + sqrt(x) * sqrt(z) + sqrt(y) * sqrt(z)
        x, y, z = (x + step) / 4.0, (y + step) / 4.0, (z + step) / 4.0


def elliprd(x: float, y: float, z: float) -> float:
    """R_D, 3/2 the integral of ((t + x) (t + y))^-1/2 (t + z)^-3/2 over t > 0; x or y may be 0."""
    found, share = 0.0, 1.0
    while True:
        mean = (x + y + 3.0 * z) / 5.0
        if max(abs(mean - x), abs(mean - y), abs(mean - z)) < _ALIKE * mean:
            return found + share / (mean * sqrt(mean))
        step = sqrt(x) * sqrt(y) + sqrt(x) * sqrt(z) + sqrt(y) * sqrt(z)
        found += 3.0 * share / (sqrt(z) * (z + step))
        share /= 4.0
        x, y, z = (x + step) / 4.0, (y + step) / 4.0, (z + step) / 4.0
