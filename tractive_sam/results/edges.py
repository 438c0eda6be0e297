"""Where a contact ends between the centres of elements.

Towards the edge of a contact the square of the pressure falls in proportion to the distance. Where
it extrapolates to zero is told by the outermost element in contact and its neighbour: of a point
sample it would be r²/(1 - r²) elements beyond the centre of the outermost one, r their pressures'
quotient. Elements of constant pressure follow that law only further in; of them it is a cubic in r,
the same for all bodies and meshes, as any edge is straight against an element, and any contact
along it in plane strain. Its coefficients are fitted to line contacts whose edge is known, on
elements of a/728 in all places within one (`tests/results/test_edges.py` sees that it holds). As an
element comes into contact r is zero, so that the edge does not jump.
"""

import numpy as np


def _place(r):
    """Place of the edge by r, in elements beyond the centre of the outermost one."""
    return -0.1754 + r * (1.0173 + r * (0.3268 + r * 0.3638))


_LAST = _place(0.0) + 1.0
"""Its largest value: there, the next element comes into contact. Peaks at a rim are beyond it."""

_ALONE = 0.5
"""That of an element whose neighbours are not in contact: nothing tells more than its own width."""


def beyond(pressure: np.ndarray) -> np.ndarray:
    """How far a contact goes beyond the centres of elements before it ends, along the first axis.

    Parameters
    ----------
    pressure : ndarray, shape (n, m)
        p_n, MPa; zero outside.

    Returns
    -------
    ndarray, shape (n, m)
        In elements, towards larger indices; nan where it does not end at that element.
    """
    touching = pressure > 0.0
    last = touching.copy()
    last[:-1] &= ~touching[1:]
    i, j = np.nonzero(last)
    here, before = pressure[i, j], pressure[i - 1, j] * (i > 0)
    place = np.minimum(_place(here / np.maximum(before, here)), _LAST)
    place[before <= 0.0] = _ALONE
    found = np.full(pressure.shape, np.nan)
    found[i, j] = place
    return found


def both_ends(pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`beyond` towards larger and towards smaller indices."""
    return beyond(pressure), beyond(pressure[::-1])[::-1]


def extent(pressure: np.ndarray) -> float:
    """Elements from the first to the last edge of a contact along the first axis; 0 without any."""
    if not (pressure > 0.0).any():
        return 0.0
    ahead, behind = both_ends(pressure)
    at = np.arange(len(pressure))[:, None]
    return float(np.nanmax(at + ahead) - np.nanmin(at - behind))


def covered(pressure: np.ndarray) -> float:
    """Elements that a contact covers: what is within the straight lines from edge to edge.

    These lie on the lines between the centres of elements, of a mesh that is one element wide along
    the first axis alone.
    """
    touching = pressure > 0.0
    if pressure.shape[1] == 1:
        return float(
            np.count_nonzero(touching) + sum(np.nansum(e - 0.5) for e in both_ends(pressure))
        )
    # Cells with centres of elements at their corners, and the edge on their sides, as far from the
    # corner in contact as a side is long: two sides along the first axis, two along the second.
    padded = np.pad(pressure, 1)
    inside = padded > 0.0
    corners = inside[:-1, :-1].astype(int) + inside[1:, :-1] + inside[:-1, 1:] + inside[1:, 1:]
    cells = (corners > 0) & (corners < 4)
    sides = (*_on_sides(padded), *(side.T for side in _on_sides(padded.T)))
    sides = np.stack([side[cells] for side in sides])
    cut = np.isfinite(sides)
    left, right, lower, upper = places = np.where(cut, sides, 0.0)
    one = 0.5 * np.where(cut, sides, 1.0).prod(axis=0)  # a triangle at the only corner in contact
    three = 1.0 - 0.5 * (1.0 - places).prod(axis=0)  # and at the only one without
    across = 0.5 * places.sum(axis=0)
    opposite = 0.5 * np.where(
        inside[:-1, :-1][cells], left * lower + right * upper, left * upper + right * lower
    )
    shares = [corners[cells] == 1, corners[cells] == 3, cut.sum(axis=0) == 4]
    share = np.select(shares, [one, three, opposite], across)
    return float(np.count_nonzero(corners == 4) + share.sum())


def _on_sides(pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The edge on the sides along the first axis of each cell, those before and those after it."""
    ahead, behind = both_ends(pressure)
    side = np.where(np.isfinite(ahead[:-1]), ahead[:-1], behind[1:])
    return side[:, :-1], side[:, 1:]
