"""Contact area in elements, bounded by lines between the points of the contact edge."""

from math import sqrt

from tractive_sam.kernels.compiled import compiled
from tractive_sam.kernels.contact_edge import edge_place

_edge_place = compiled(edge_place, inner=True)


@compiled(inner=True)
def _covered(pressure, i, j, di, dj):
    """Return the length of a side of a cell from its corner in contact to the edge, 0 to 1.

    The side joins the centres of the elements (i, j) and (i + di, j + dj). It is 0 where both or
    none of them are in contact.
    """
    first, second = pressure[i, j], pressure[i + di, j + dj]
    if (first > 0.0) == (second > 0.0):
        return 0.0
    if first > 0.0:
        return _edge_place(first, pressure[i - di, j - dj])
    return _edge_place(second, pressure[i + 2 * di, j + 2 * dj])


@compiled
def covered_area(pressure):
    """Return the area in contact, in elements; the outer two rows and columns must be free of it.

    It is summed over cells. They have the centres of four elements at their corners, and the edge
    crosses their sides.
    """
    area = 0.0
    for i in range(1, pressure.shape[0] - 2):
        for j in range(1, pressure.shape[1] - 2):
            first, opposite = pressure[i, j] > 0.0, pressure[i + 1, j + 1] > 0.0
            corners = first + opposite + (pressure[i + 1, j] > 0.0) + (pressure[i, j + 1] > 0.0)
            if corners == 4:
                area += 1.0
            elif corners > 0:
                left, right = _covered(pressure, i, j, 1, 0), _covered(pressure, i, j + 1, 1, 0)
                lower, upper = _covered(pressure, i, j, 0, 1), _covered(pressure, i + 1, j, 0, 1)
                if corners == 1:  # a triangle; sides without the edge are 0
                    area += 0.5 * (left + right) * (lower + upper)
                elif corners == 3:
                    area += 1.0 - 0.5 * (1.0 - left - right) * (1.0 - lower - upper)
                elif first != opposite:
                    area += 0.5 * (left + right + lower + upper)
                elif first:
                    area += 0.5 * (left * lower + right * upper)
                else:
                    area += 0.5 * (left * upper + right * lower)
    return area


@compiled
def bound_reserve(pressure, traction, sliding, scaling, reserve):
    """Set `reserve` to the pressure less the scaled traction of elements that stick, else to zero.

    Parameters
    ----------
    pressure, sliding, reserve : ndarray, shape (n_x, n_y)
        Pressure, mask of the elements that slide, and output, at least zero.
    traction : ndarray, shape (2, n_x, n_y)
        Traction.
    scaling : ndarray, shape (2, 2)
        Matrix from tractions to scaled ones (`mechanics.frame`).

    Returns
    -------
    stuck, slid : int
        Elements in contact that stick and that slide.
    lacks : float
        Largest distance of the scaled traction from the pressure in elements that slide.
    """
    stuck, slid, lacks = 0, 0, 0.0
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[1]):
            reserve[i, j] = 0.0
            if not pressure[i, j] > 0.0:
                continue
            x, y = traction[0, i, j], traction[1, i, j]
            first = scaling[0, 0] * x + scaling[0, 1] * y
            second = scaling[1, 0] * x + scaling[1, 1] * y
            lack = pressure[i, j] - sqrt(first * first + second * second)
            if sliding[i, j]:
                slid += 1
                lacks = max(lacks, abs(lack))
            else:
                stuck += 1
                reserve[i, j] = max(lack, 0.0)
    return stuck, slid, lacks
