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

from tractive_sam.kernels.contact_edge import edge_place


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
    rows = np.flatnonzero(pressure.any(axis=1))
    if not rows.size:
        return 0.0
    first, last = rows[0], rows[-1]
    ahead, behind = pressure[max(last - 2, 0) : last + 1], pressure[first : first + 3][::-1]
    return float(last - first + _last_edge(ahead) + _last_edge(behind))


def _last_edge(pressure: np.ndarray) -> float:
    """Return where the last edge ahead lies, in elements beyond the centres of the last row.

    It belongs to an element of the last two rows.
    """
    i, _, place = _edges_ahead(pressure)
    return (i + place).max() - (len(pressure) - 1)


def covered_elements(pressure: np.ndarray) -> float:
    """Return the contact area in elements, bounded by straight lines between its edge points.

    The edges lie on the lines between the centres of elements; on a mesh one element wide along
    the first axis alone.
    """
    if pressure.shape[1] == 1:
        beyond = np.array(distances_to_edges(pressure)) - 0.5
        return np.count_nonzero(pressure > 0.0) + float(np.nansum(beyond))
    # Reading and drawing results needs no compiler, which takes long to load.
    from tractive_sam.kernels.contact_area import covered_area  # noqa: PLC0415

    wide: np.ndarray = np.zeros((pressure.shape[0] + 4, pressure.shape[1] + 4))
    wide[2:-2, 2:-2] = pressure
    return covered_area(wide)
