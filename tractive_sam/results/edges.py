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
    from tractive_sam.kernels.contact_edges import find_ends  # noqa: PLC0415

    distances = np.empty(pressure.shape)
    find_ends(np.ascontiguousarray(pressure), distances)
    return distances


def distances_to_edges(pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where edges lie ahead (+x) and behind outermost centres, elements; nan elsewhere."""
    return distance_to_edge(pressure), distance_to_edge(pressure[::-1])[::-1]


def contact_extent(pressure: np.ndarray) -> float:
    """Return the length along x from first to last edge, in elements; 0 without contact."""
    from tractive_sam.kernels.contact_edges import find_extent  # noqa: PLC0415

    first, last = find_extent(np.ascontiguousarray(pressure))
    return max(last - first, 0.0)


def covered_elements(pressure: np.ndarray) -> float:
    """Return the contact area in elements, bounded by straight lines between its edge points.

    The edges lie on the lines between the centres of elements; on a mesh one element wide along
    the first axis alone.
    """
    if pressure.shape[1] == 1:
        touching = float(np.count_nonzero(pressure > 0.0))
        return touching + float(sum(np.nansum(e - 0.5) for e in distances_to_edges(pressure)))
    from tractive_sam.kernels.contact_edges import count_covered  # noqa: PLC0415

    return float(count_covered(np.ascontiguousarray(pressure)))
