"""Stress at a surface that a mesh does not resolve: at the edges of contact and of stick.

Towards the edge the pressure falls with the root of the distance, and so does the stress right
below it, -p across the edge and -2 nu p along it (plane strain). The rest is smooth and is
extrapolated to the edge along a straight line. Towards the end of stick the traction has a root on
the side that sticks, the stress in the plane one on the side that slips (as in Carter's solution):
each is extrapolated from its smooth side.
"""

import math

import numpy as np

from tractive_sam.kernels.compiled import compiled

WIDEST = 3
"""Most elements from a corner that slips to one that sticks."""

ROOM = WIDEST + 1
"""Corners outside the elements that steps may lead to."""

UNLOADED, SLIPS, STICKS, BOTH = range(4)
"""Kinds of corners: an element there is unloaded; all slip; all stick; some slip and some stick."""


def kinds_of_corners(pressure, sliding):
    """Return the kind of each element corner (n_x - 1, n_y - 1): unloaded, slip, stick or both."""
    loaded = pressure > 0.0
    slipping, sticking = _around_corners(loaded & sliding), _around_corners(loaded & ~sliding)
    kinds = np.where(slipping + sticking < 4, np.uint8(UNLOADED), np.uint8(BOTH))
    kinds[slipping == 4] = SLIPS
    kinds[sticking == 4] = STICKS
    return kinds


def _around_corners(elements):
    """Return the number of marked elements around each corner, shape (n_x - 1, n_y - 1)."""
    marked = elements.view(np.uint8)
    pairs = marked[:-1] + marked[1:]
    return pairs[:, :-1] + pairs[:, 1:] if pairs.shape[1] > 1 else 2 * pairs


def stresses_at_loaded_corners(stress, kinds):
    """Return stresses (6, bodies, n) at the n loaded corners, and their indices (2, n)."""
    bodies = len(stress)
    (loaded,) = np.nonzero(kinds.ravel() != UNLOADED)
    stresses = stress.reshape(bodies, 6, -1).take(loaded, axis=2)
    places = np.array(np.divmod(loaded, kinds.shape[1]), dtype=float)
    return stresses.swapaxes(0, 1), places


def stresses_at_edges(stress, pressure, kinds, poisson, dx, dy):
    """Return stresses extrapolated to edges of the contact and between slip and stick, and places.

    Points of the edge start from a loaded corner with an unloaded neighbour, in x or in y, and a
    loaded one across from it: near the edge the square of the pressure is a straight line, which is
    zero there. Points of the end of stick lie midway between a corner that slips and the next one
    that sticks, in x or in y, at most `WIDEST` steps apart and each with another corner of its kind
    behind.

    Parameters
    ----------
    stress : ndarray, shape (bodies, 6, n_x - 1, n_y - 1), for strips (bodies, 6, n_x - 1, 1)
        Stress at the corners between the elements.
    pressure : ndarray, shape (n_x, n_y)
        Pressure on the elements; the bodies share it.
    kinds : ndarray, shape (n_x - 1, n_y - 1), for strips (n_x - 1, 1)
        Kinds from `kinds_of_corners`.
    poisson : sequence of float
        Poisson's ratios.
    dx, dy : float
        Sides of the elements.

    Returns
    -------
    stresses : ndarray, shape (6, bodies, n)
        Stresses at the points, in the unit of `stress`.
    places : ndarray, shape (2, n)
        Places of the points, in elements from the first corner.
    """
    # With room for all steps: beyond the last corners there is no contact.
    nx, ny = kinds.shape
    around = np.full((nx + 2 * ROOM, ny + 2 * ROOM), UNLOADED, dtype=np.uint8)
    around[ROOM:-ROOM, ROOM:-ROOM] = kinds
    return _stresses_at_edges(stress, pressure, around, poisson, dx, dy)


@compiled
def _stresses_at_edges(stress, pressure, around, poisson, dx, dy):
    """Return the results of `stresses_at_edges`, for kinds with a margin of `ROOM` corners."""
    directions = ((1, 0), (-1, 0), (0, 1), (0, -1))
    bodies, _, nx, ny = stress.shape
    count = 0
    stresses, places = np.zeros((6, bodies, count)), np.zeros((2, count))
    for counted in (False, True):
        if counted:
            stresses, places = np.zeros((6, bodies, count)), np.zeros((2, count))
        count = 0
        for i in range(nx):
            for j in range(ny):
                k, h = ROOM + i, ROOM + j
                here = around[k, h]
                # A corner among others of its kind, as most are, has no edge.
                alike = here == around[k - 1, h] == around[k + 1, h]
                if here == UNLOADED or (alike and here == around[k, h - 1] == around[k, h + 1]):
                    continue
                for a, b in directions:
                    ahead, behind = around[k + a, h + b], around[k - a, h - b]
                    away, apart = -1.0, 0
                    if behind == UNLOADED and ahead != UNLOADED:
                        away = _steps_to_edge(pressure, i, j, a, b)
                    elif here == behind == SLIPS and ahead != SLIPS:
                        apart = _steps_to_stick(around, k, h, a, b)
                    if away < 0.0 and apart == 0:
                        continue
                    if counted:
                        out = stresses[:, :, count]
                        if apart > 0:
                            _set_at_border(out, stress, i, j, a, b, apart)
                        else:
                            _set_at_edge(out, stress, pressure, i, j, a, b, away, poisson, dx, dy)
                        steps = 0.5 * apart if apart > 0 else -away
                        places[0, count], places[1, count] = i + steps * a, j + steps * b
                    count += 1
    return stresses, places


@compiled(inner=True)
def _steps_to_edge(pressure, i, j, a, b):
    """Return the distance, in elements, from a loaded corner to the contact edge; -1 if unknown."""
    # Most by which the slope of the square of the pressure may change from that corner to the next.
    even = 2.0
    # Slope towards the edge over that along it, from which a corner is taken: on a diagonal both
    # are equal except for rounding.
    evenly = 1.0 - 1e-6
    # Most elements from a corner that all four elements touch to an edge of the contact straight
    # ahead; half an element less if the edge lies across a diagonal. An element is loaded about as
    # soon as the edge has passed its centre, one and a half from the corner before: with only 1.5,
    # an edge that moves would come and go.
    farthest = 2.0
    in_x, in_y = _differences(pressure, i, j)
    rising, along = a * in_x + b * in_y, abs(b * in_x + a * in_y)
    if rising <= 0.0 or rising < evenly * along:
        return -1.0
    here = _mean_square(pressure, i, j)
    if here > farthest * rising - 0.5 * along:
        return -1.0
    # As steep further inside, or the edge is sharper than the mesh.
    in_x, in_y = _differences(pressure, i + a, j + b)
    inner = a * in_x + b * in_y
    return here / rising if rising / even < inner < even * rising else -1.0


@compiled(inner=True)
def _set_at_edge(out, stress, pressure, i, j, a, b, away, poisson, dx, dy):
    """Set stresses xx, yy, xy (bodies) at the contact edge, extrapolated from two corners."""
    for body in range(len(stress)):
        here = _smooth(stress[body], pressure, i, j, poisson[body], dx, dy)
        further = _smooth(stress[body], pressure, i + a, j + b, poisson[body], dx, dy)
        out[0, body] = here[0] + away * (here[0] - further[0])
        out[1, body] = here[1] + away * (here[1] - further[1])
        out[3, body] = here[2] + away * (here[2] - further[2])


@compiled(inner=True)
def _smooth(stress, pressure, i, j, nu, dx, dy):
    """Return the stresses xx, yy, xy at a corner without their singular parts."""
    in_x, in_y = _differences(pressure, i, j)
    x, y = in_x / dx, in_y / dy
    steep = math.sqrt(x * x + y * y)
    if steep > 0.0:
        x, y = x / steep, y / steep
    # sigma + p (n n + 2 nu t t), in the plane: t t = 1 - n n.
    p, k = _mean(pressure, i, j), 1.0 - 2.0 * nu
    return (
        stress[0, i, j] + p * (k * x * x + 2.0 * nu),
        stress[1, i, j] + p * (k * y * y + 2.0 * nu),
        stress[3, i, j] + p * k * x * y,
    )


@compiled(inner=True)
def _steps_to_stick(kinds, i, j, a, b):
    """Return the steps along (a, b) from a slipping corner to two sticking ones; 0 if not found."""
    for step in range(1, WIDEST + 1):
        kind = kinds[i + step * a, j + step * b]
        if kind == SLIPS:
            return 0
        if kind == STICKS:
            return step if kinds[i + (step + 1) * a, j + (step + 1) * b] == STICKS else 0
    return 0


@compiled(inner=True)
def _set_at_border(out, stress, i, j, a, b, apart):
    """Set stresses midway between slip and stick: xx, yy, xy from stick, others from slip."""
    for component in range(6):
        if component in (0, 1, 3):
            k, h, m, n = i + apart * a, j + apart * b, a, b
        else:
            k, h, m, n = i, j, -a, -b
        for body in range(len(stress)):
            here, behind = stress[body, component, k, h], stress[body, component, k + m, h + n]
            out[component, body] = here + 0.5 * apart * (here - behind)


@compiled(inner=True)
def _mean(pressure, i, j):
    """Return the mean pressure of the elements around a corner."""
    k = min(j + 1, pressure.shape[1] - 1)
    return 0.25 * (pressure[i, j] + pressure[i + 1, j] + pressure[i, k] + pressure[i + 1, k])


@compiled(inner=True)
def _mean_square(pressure, i, j):
    """Return the mean of the squared pressure of the elements around a corner."""
    k = min(j + 1, pressure.shape[1] - 1)
    total = pressure[i, j] ** 2 + pressure[i + 1, j] ** 2
    return 0.25 * (total + pressure[i, k] ** 2 + pressure[i + 1, k] ** 2)


@compiled(inner=True)
def _differences(pressure, i, j):
    """Return differences of the squared pressure at a corner, per element in x and in y."""
    k = min(j + 1, pressure.shape[1] - 1)
    a, b = pressure[i, j] ** 2, pressure[i + 1, j] ** 2
    c, d = pressure[i, k] ** 2, pressure[i + 1, k] ** 2
    return 0.5 * (b - a + d - c), 0.5 * (c - a + d - b)
