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
    from tractive_sam.kernels.contact_edges import find_ends  # noqa: PLC0415

    found = np.empty(pressure.shape)
    find_ends(np.ascontiguousarray(pressure), found)
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
    if pressure.shape[1] == 1:
        touching = float(np.count_nonzero(pressure > 0.0))
        return touching + float(sum(np.nansum(e - 0.5) for e in both_ends(pressure)))
    from tractive_sam.kernels.contact_edges import count_covered  # noqa: PLC0415

    return float(count_covered(np.ascontiguousarray(pressure)))
