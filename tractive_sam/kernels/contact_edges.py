"""Where a contact ends between the centres of elements, and what it covers (`results.edges`)."""

import numpy as np

from tractive_sam.kernels.compiled import compiled

LAST = 0.8246
"""Largest place of an edge: there, the next element comes into contact."""

SINGLE = 0.5
"""Place of the edge of an element whose neighbours are not in contact: half its width."""


@compiled
def edge_place(here, before):
    """Return the place of an edge, in elements beyond the centre of the outermost one.

    A cubic in the ratio r of both pressures, see `results.edges`; peaks at a rim are cut at `LAST`.

    Parameters
    ----------
    here : float
        Pressure of the outermost element, positive.
    before : float
        That of its neighbour in the contact; 0 if there is none.
    """
    if before <= 0.0:
        return SINGLE
    r = here / max(before, here)
    return min(-0.1754 + r * (1.0173 + r * (0.3268 + r * 0.3638)), LAST)


@compiled
def find_ends(pressure, out):
    """Set `out` to the places of the edges towards larger first indices, nan elsewhere.

    Parameters
    ----------
    pressure, out : ndarray, shape (n, m)
        Zero outside the contact; in elements beyond their centres.
    """
    n, m = pressure.shape
    for i in range(n):
        for j in range(m):
            here, out[i, j] = pressure[i, j], np.nan
            if here > 0.0 and (i + 1 == n or pressure[i + 1, j] <= 0.0):
                out[i, j] = edge_place(here, pressure[i - 1, j] if i else 0.0)


@compiled
def _side(pressure, i, j, di, dj):
    """Return how far a contact reaches into the side from (i, j) to (i + di, j + dj).

    In lengths of the side, from its corner in contact; 0 if both corners are in contact or none.
    """
    first, second = _value(pressure, i, j), _value(pressure, i + di, j + dj)
    if (first > 0.0) == (second > 0.0):
        return 0.0
    if first > 0.0:
        return edge_place(first, _value(pressure, i - di, j - dj))
    return edge_place(second, _value(pressure, i + 2 * di, j + 2 * dj))


@compiled
def _value(pressure, i, j):
    """Return the pressure of an element, zero beyond the mesh."""
    n, m = pressure.shape
    return pressure[i, j] if 0 <= i < n and 0 <= j < m else 0.0


@compiled
def count_covered(pressure):
    """Return the number of elements that a contact covers within lines from edge to edge.

    Cells have the centres of four elements at their corners; the edge crosses their sides.

    Parameters
    ----------
    pressure : ndarray, shape (n, m)
        Zero outside the contact.
    """
    n, m = pressure.shape
    total = 0.0
    for i in range(-1, n):
        for j in range(-1, m):
            first = _value(pressure, i, j) > 0.0
            corners = int(first) + int(_value(pressure, i, j + 1) > 0.0)
            corners += int(_value(pressure, i + 1, j) > 0.0)
            corners += int(_value(pressure, i + 1, j + 1) > 0.0)
            if corners in (0, 4):
                total += corners / 4
                continue
            left, right = _side(pressure, i, j, 1, 0), _side(pressure, i, j + 1, 1, 0)
            lower, upper = _side(pressure, i, j, 0, 1), _side(pressure, i + 1, j, 0, 1)
            if corners == 1:  # a triangle; the sides without the edge are 0
                total += 0.5 * (left + right) * (lower + upper)
            elif corners == 3:
                total += 1.0 - 0.5 * (1.0 - left - right) * (1.0 - lower - upper)
            elif first == (_value(pressure, i + 1, j + 1) > 0.0):  # two that are opposite
                pairs = left * lower + right * upper, left * upper + right * lower
                total += 0.5 * (pairs[0] if first else pairs[1])
            else:
                total += 0.5 * (left + right + lower + upper)
    return total
