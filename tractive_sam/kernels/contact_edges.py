"""Edges of a contact between the centres of elements, and its area (`results.edges`)."""

import numpy as np

from tractive_sam.kernels.compiled import compiled


@compiled
def edge_place(here, before):
    """Return the distance of the contact edge beyond the outermost element's centre, in elements.

    A cubic in the ratio r of both pressures, see `results.edges`; peaks at a rim are cut at `last`.

    Parameters
    ----------
    here : float
        Pressure of the outermost element, positive.
    before : float
        Pressure of its neighbour in the contact; 0 if there is none.
    """
    # Place of the edge of an element without neighbours in contact: half its width.
    single = 0.5
    # Largest place of an edge: there, the next element comes into contact.
    last = 0.8246
    if before <= 0.0:
        return single
    r = here / max(before, here)
    return min(-0.1754 + r * (1.0173 + r * (0.3268 + r * 0.3638)), last)


@compiled
def find_ends(pressure, out):
    """Set `out` to how far contact reaches beyond each last element along i; elsewhere to nan.

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
def find_extent(pressure):
    """Return first and last contact edge along the first axis, in elements; (inf, -inf) if none.

    Without contact the first place is larger than the last.

    Parameters
    ----------
    pressure : ndarray, shape (n, m)
        Zero outside the contact.
    """
    n, m = pressure.shape
    first, last = np.inf, -np.inf
    for i in range(n):
        for j in range(m):
            here = pressure[i, j]
            if here <= 0.0:
                continue
            before = pressure[i - 1, j] if i else 0.0
            after = pressure[i + 1, j] if i + 1 < n else 0.0
            if before <= 0.0:
                first = min(first, i - edge_place(here, after))
            if after <= 0.0:
                last = max(last, i + edge_place(here, before))
    return first, last


@compiled(inner=True)
def _side(pressure, i, j, di, dj):
    """Return how far contact reaches between two element centres, 0 to 1; 0 if both or none touch.

    In lengths of the side, from its corner in contact; 0 if both corners are in contact or none.
    The elements before and behind the side exist.
    """
    first, second = pressure[i, j], pressure[i + di, j + dj]
    if (first > 0.0) == (second > 0.0):
        return 0.0
    if first > 0.0:
        return edge_place(first, pressure[i - di, j - dj])
    return edge_place(second, pressure[i + 2 * di, j + 2 * dj])


@compiled
def count_covered(pressure):
    """Return the contact area in elements (not an integer), bounded by lines between edge points.

    Cells have the centres of four elements at their corners; the edge crosses their sides.

    Parameters
    ----------
    pressure : ndarray, shape (n, m)
        Zero outside the contact.
    """
    n, m = pressure.shape
    wide = np.zeros((n + 4, m + 4))  # two elements more on every side
    for i in range(n):
        for j in range(m):
            wide[i + 2, j + 2] = pressure[i, j]
    inside, total = 0, 0.0
    for i in range(1, n + 2):
        for j in range(1, m + 2):
            first, opposite = wide[i, j] > 0.0, wide[i + 1, j + 1] > 0.0
            second, third = wide[i, j + 1] > 0.0, wide[i + 1, j] > 0.0
            corners = int(first) + int(second) + int(third) + int(opposite)
            if corners == 0 or corners == 4:  # noqa: PLR1714 - compiles to what is fast
                inside += corners == 4
                continue
            left, right = _side(wide, i, j, 1, 0), _side(wide, i, j + 1, 1, 0)
            lower, upper = _side(wide, i, j, 0, 1), _side(wide, i + 1, j, 0, 1)
            if corners == 1:  # a triangle; the sides without the edge are 0
                total += 0.5 * (left + right) * (lower + upper)
            elif corners == 3:
                total += 1.0 - 0.5 * (1.0 - left - right) * (1.0 - lower - upper)
            elif first == opposite:
                pairs = left * lower + right * upper, left * upper + right * lower
                total += 0.5 * (pairs[0] if first else pairs[1])
            else:
                total += 0.5 * (left + right + lower + upper)
    return inside + total
