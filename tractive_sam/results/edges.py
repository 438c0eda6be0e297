"""Positions of the edges of a contact between the centres of elements.

Towards the edge of a contact the square of the pressure falls in proportion to the distance. The
outermost element in contact and its neighbour determine the place at which it extrapolates to zero.
If the pressures were samples at points, the edge would lie r²/(1 - r²) elements beyond the centre
of the outermost one, with r the quotient of both pressures. For elements of constant pressure the
distance is a cubic in r. One cubic serves all bodies and meshes, since any edge is straight on the
scale of an element, and any contact is in plane strain along it. Its coefficients are fitted to
line contacts with edges in all positions within an element of size a/728;
`tests/results/test_edges.py` checks them. When an element comes into contact r is zero, so the edge
does not jump.
"""

import numpy as np


def edge_place(here: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return the distances of the contact edge beyond the centres of outermost elements, elements.

    A cubic in the ratio of both pressures; peaks at a rim are cut where the next element touches.

    Parameters
    ----------
    here : ndarray
        Pressures of outermost elements, positive.
    before : ndarray
        Pressures of their neighbours in the contact; 0 if there is none.
    """
    # Place of the edge of an element without neighbours in contact: half its width.
    single = 0.5
    # Largest place of an edge: there, the next element comes into contact.
    last = 0.8246
    r = here / np.maximum(before, here)
    place = np.minimum(-0.1754 + r * (1.0173 + r * (0.3268 + r * 0.3638)), last)
    return np.where(before > 0.0, place, single)


def distance_to_edge(pressure: np.ndarray) -> np.ndarray:
    """Return where the edge lies ahead (+x) of outermost centres, in elements; nan elsewhere.

    Parameters
    ----------
    pressure : ndarray, shape (n, m)
        p_n, MPa; zero outside the contact.

    Returns
    -------
    ndarray, shape (n, m)
        Distance towards larger indices, in elements; nan for elements without an edge ahead.
    """
    distances = np.full(pressure.shape, np.nan)
    i, j, place = _edges_ahead(pressure)
    distances[i, j] = place
    return distances


def _edges_ahead(pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return indices i, j of elements with an edge ahead (+x), and its distances, in elements."""
    touching = pressure > 0.0
    last = touching.copy()
    last[:-1] &= ~touching[1:]
    i, j = np.nonzero(last)
    before = np.where(i > 0, pressure[i - 1, j], 0.0)
    return i, j, edge_place(pressure[i, j], before)


def distances_to_edges(pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where edges lie ahead (+x) and behind outermost centres, elements; nan elsewhere."""
    return distance_to_edge(pressure), distance_to_edge(pressure[::-1])[::-1]


def contact_extent(pressure: np.ndarray) -> float:
    """Return the length along x from first to last edge, in elements; 0 without contact."""
    i, _, ahead = _edges_ahead(pressure)
    from_end, _, behind = _edges_ahead(pressure[::-1])
    if i.size == 0:
        return 0.0
    return float((i + ahead).max() + (from_end + behind).max() - (len(pressure) - 1))


def covered_elements(pressure: np.ndarray) -> float:
    """Return the contact area in elements, bounded by straight lines between its edge points.

    The edges lie on the lines between the centres of elements; on a mesh one element wide along
    the first axis alone.
    """
    if pressure.shape[1] == 1:
        beyond = np.array(distances_to_edges(pressure)) - 0.5
        return np.count_nonzero(pressure > 0.0) + float(np.nansum(beyond))
    # Cells have the centres of four elements at their corners; the edge crosses their sides.
    wide: np.ndarray = np.zeros((pressure.shape[0] + 4, pressure.shape[1] + 4))
    wide[2:-2, 2:-2] = pressure
    touching = wide > 0.0
    pairs = touching[:-1].view(np.int8) + touching[1:]
    corners = pairs[:, :-1] + pairs[:, 1:]
    i, j = cells = np.nonzero((corners > 0) & (corners < 4))
    row = wide.shape[1]
    begin = i * row + j + np.array([[0], [1], [0], [row]])
    left, right, lower, upper = _covered_sides(
        wide.ravel(), begin, np.array([[row], [row], [1], [1]])
    )
    first, count = touching[cells], corners[cells]
    # Two corners in contact are neighbours (2), the first and its opposite (0), or the others (4).
    diagonal = (count == 2) & (first == touching[i + 1, j + 1])
    areas = np.choose(
        np.where(diagonal, np.where(first, 0, 4), count),
        (
            0.5 * (left * lower + right * upper),
            0.5 * (left + right) * (lower + upper),  # a triangle; sides without the edge are 0
            0.5 * (left + right + lower + upper),
            1.0 - 0.5 * (1.0 - left - right) * (1.0 - lower - upper),
            0.5 * (left * upper + right * lower),
        ),
    )
    return np.count_nonzero(corners == 4) + float(areas.sum())


def _covered_sides(pressure: np.ndarray, begin: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Return the lengths of sides of cells from their corner in contact to the edge, 0 to 1.

    The sides join the centres `begin` and `begin + step` of elements, indices of a flat array. They
    are 0 where both or none of their ends are in contact.
    """
    first, second = pressure[begin], pressure[begin + step]
    inside = first > 0.0
    crossed = inside != (second > 0.0)
    before = pressure[np.where(inside, begin - step, begin + 2 * step)]
    here = np.where(crossed, np.maximum(first, second), 1.0)
    return np.where(crossed, edge_place(here, before), 0.0)
