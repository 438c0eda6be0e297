"""Displacement by a pressure near the free end of a wide body, and the factor on mirror images.

A uniform pressure acts on a square of side 2 whose near side is at a distance from the end. The
script computes the displacement at its centre, and at the end of the body, over that of a
half-space, for free ends and for a factor on mirror images, on two meshes.

    python benchmarks/free_ends.py

Page: docs/howto/roller.md
"""

import math

import numpy as np
from timing import show, write

from tractive_sam.mechanics import FreeEnds, HalfSpaces, Material
from tractive_sam.operators import Lattice, Operators

WIDTH = 1e4


def displacement(poisson: float, distance: float, n: int, quick: bool) -> tuple[float, float]:
    """Return the displacement over that of a half-space at the centre, and at the end.

    Parameters
    ----------
    poisson : float
        Poisson's ratio.
    distance : float
        Distance of the square from the end.
    n : int
        Elements on a side of the square.
    quick : bool
        Whether a factor on mirror images stands for the end.
    """
    side, rows = 2.0 / n, n + round(0.5 * n * distance)
    A, rigid = Material(0.5 * (1.0 - poisson), poisson), Material(math.inf, poisson)
    law = FreeEnds(A, rigid, (WIDTH, math.inf), (quick, False), WIDTH)
    ends = law.ends_on((n, rows), side, side, 0.5 * side - 0.5 * WIDTH)
    pressure = np.zeros((n, rows))
    pressure[:, -n:] = 1.0
    lattice = Lattice((n, rows), side, side)
    half_space = Operators(lattice, HalfSpaces(A, rigid), 1.0, 1.0).normal(pressure[None])[0]
    added, middle = ends(pressure), slice(n // 2 - 1, n // 2 + 1)
    near = slice(rows - n // 2 - 1, rows - n // 2 + 1)
    centre = 1.0 + added[middle, near].mean() / half_space[middle, near].mean()
    y = side * (np.arange(4) + 0.5)
    moved, still = ((half_space + each)[middle, :4].mean(axis=0) for each in (added, 0.0))
    at_end = [np.polynomial.Polynomial.fit(y, u, 3)(0.0) for u in (moved, still)]
    return centre, at_end[0] / at_end[1]


def table() -> list[dict[str, float]]:
    """Return the ratios by Poisson's ratio and distance."""
    rows = []
    for poisson in (0.0, 0.3):
        for distance in (0.0, 1.0, 3.0):
            coarse, fine = (displacement(poisson, distance, n, False) for n in (16, 32))
            quick = displacement(poisson, distance, 32, True)
            rows.append(
                {
                    "poisson": poisson,
                    "distance": distance,
                    "centre": fine[0],
                    "change": fine[0] - coarse[0],
                    "quick_centre": quick[0],
                    "end": fine[1],
                    "quick_end": quick[1],
                    "quick_error": 100.0 * (quick[1] / fine[1] - 1.0),
                }
            )
    return rows


if __name__ == "__main__":
    rows = table()
    write("free_ends", rows)
    show("free_ends", rows)
