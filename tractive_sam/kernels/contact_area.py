"""Contact area in elements, bounded by lines between the points of the contact edge."""

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
