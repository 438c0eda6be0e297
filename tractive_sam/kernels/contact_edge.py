"""The edge of a contact within elements, and stress at edges of contact and stick, with NumPy.

A mesh does not resolve the stress at the surface there. Towards the edge the pressure falls with
the root of the distance, and so does the stress right below it, -p across the edge and -2 nu p
along it (plane strain). The rest is smooth and is extrapolated to the edge along a straight line.
Towards the end of stick the traction has a root on the side that sticks, the stress in the plane
one on the side that slips (as in Carter's solution): each is extrapolated from its smooth side.
"""

from typing import NamedTuple

import numpy as np


def edge_place(here, before):
    """Return the distances of the contact edge beyond the centres of outermost elements, elements.

    A cubic in the ratio of both pressures; peaks at a rim are cut where the next element touches.

    Parameters
    ----------
    here : float or ndarray
        Pressures of outermost elements, positive.
    before : float or ndarray
        Pressures of their neighbours in the contact; 0 if there is none.
    """
    # Place of the edge of an element without neighbours in contact: half its width.
    single = 0.5
    # Largest place of an edge: there, the next element comes into contact.
    last = 0.8246
    r = here / np.maximum(before, here)
    place = -0.1754 + r * (1.0173 + r * (0.3268 + r * 0.3638))
    return np.minimum(place, last + (single - last) * (before <= 0.0))


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


def stresses_at_edges(stress, pressure, kinds, materials, dx, dy):
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
    materials : sequence of float or callable
        Of each body Poisson's ratio, or if it is anisotropic the stress xx, yy, xy (3, n) inside an
        edge over its pressure, of vectors (2, n) across the edge.
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
    directions = np.array(((1, -1, 0, 0), (0, 0, 1, -1)))
    ahead = np.array(
        [around[ROOM + a : ROOM + a + nx, ROOM + b : ROOM + b + ny] for a, b in directions.T]
    )
    behind = ahead[[1, 0, 3, 2]]

    def starts(chosen):
        direction, i, j = np.nonzero(chosen)
        return np.concatenate(((i, j), directions[:, direction]))

    pressures = _PressureAtCorners.from_elements(pressure)
    towards = starts((kinds != UNLOADED) & (behind == UNLOADED) & (ahead != UNLOADED))
    away, towards = _steps_to_edge(pressures, towards)
    at_edge = _stresses_at_edge(stress, pressures, towards, away, materials, dx, dy)
    slipping = starts((kinds == SLIPS) & (behind == SLIPS) & (ahead != SLIPS))
    apart, slipping = _steps_to_stick(around, slipping)
    at_border = _stresses_at_border(stress, slipping, apart)
    places = _moved(towards, -away), _moved(slipping, 0.5 * apart)
    return np.concatenate((at_edge, at_border), axis=2), np.concatenate(places, axis=1)


def _moved(starts, count):
    """Return the places (2, n) that are a number of steps from corners, see `_steps_to_edge`."""
    return starts[:2] + count * starts[2:]


class _PressureAtCorners(NamedTuple):
    """Pressure at the corners between elements, each array of shape (n_x - 1, n_y - 1).

    Attributes
    ----------
    mean, mean_square : ndarray
        Means of the pressure, and of its square, over the elements around a corner.
    in_x, in_y : ndarray
        Differences of the squared pressure, per element.
    """

    mean: np.ndarray
    mean_square: np.ndarray
    in_x: np.ndarray
    in_y: np.ndarray

    @classmethod
    def from_elements(cls, pressure):
        """Return the pressure at corners from the pressure (n_x, n_y) on elements."""
        square = pressure**2
        if pressure.shape[1] == 1:  # strips do not change in y
            pressure, square = pressure.repeat(2, axis=1), square.repeat(2, axis=1)
        before, after = square[:-1], square[1:]
        rise, total = after - before, after + before
        along = pressure[:-1] + pressure[1:]
        return cls(
            0.25 * (along[:, :-1] + along[:, 1:]),
            0.25 * (total[:, :-1] + total[:, 1:]),
            0.5 * (rise[:, :-1] + rise[:, 1:]),
            0.5 * (total[:, 1:] - total[:, :-1]),
        )


def _steps_to_edge(pressures, starts):
    """Return distances (n,), in elements, to contact edges behind loaded corners, and the corners.

    A corner and its direction are a column (i, j, a, b) of `starts`. Corners from which the
    distance cannot be extrapolated are left out.
    """
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
    (i, j, a, b), (k, h) = starts, _moved(starts, 1)
    in_x, in_y, here = pressures.in_x[i, j], pressures.in_y[i, j], pressures.mean_square[i, j]
    rising, along = a * in_x + b * in_y, abs(b * in_x + a * in_y)
    # As steep further inside, or the edge is sharper than the mesh.
    inner = a * pressures.in_x[k, h] + b * pressures.in_y[k, h]
    known = (rising > 0.0) & (rising >= evenly * along) & (here <= farthest * rising - 0.5 * along)
    known &= (rising < even * inner) & (inner < even * rising)
    return here[known] / rising[known], starts[:, known]


def _stresses_at_edge(stress, pressures, starts, away, materials, dx, dy):
    """Return stresses (6, bodies, n) at the contact edge, extrapolated from two corners each.

    These are xx, yy and xy; the others are zero.
    """
    i, j = np.stack((starts[:2], _moved(starts, 1)), axis=1)
    x, y = pressures.in_x[i, j] / dx, pressures.in_y[i, j] / dy
    square = x * x + y * y
    square[square == 0.0] = 1.0
    p, out = pressures.mean[i, j], np.zeros((6, len(stress), away.size))
    for body, below in enumerate(materials):
        if callable(below):
            normal = np.stack((x, y)) / np.sqrt(square)
            added = -p * below(normal.reshape(2, -1)).reshape(3, *p.shape)
            evenly = 0.0
        else:
            # The smooth part is sigma + p (n n + 2 nu t t), in the plane: t t = 1 - n n.
            p_n = p * (1.0 - 2.0 * below) / square
            added, evenly = (p_n * x * x, p_n * y * y, p_n * x * y), 2.0 * below * p
        for component, part in zip((0, 1, 3), added, strict=True):
            smooth = stress[body, component, i, j] + part
            if component != 3:
                smooth += evenly
            near, far = smooth
            out[component, body] = near + away * (near - far)
    return out


def _steps_to_stick(kinds, starts):
    """Return the steps (n,) from slipping corners to two sticking ones, and the corners.

    Corners are left out if another corner slips before, or none sticks within `WIDEST`.
    """
    within = starts + np.array(((ROOM,), (ROOM,), (0,), (0,)))
    course = np.array([kinds[tuple(_moved(within, n))] for n in range(1, WIDEST + 2)])
    ends = (course == SLIPS) | (course == STICKS)
    first = ends.argmax(axis=0)
    at = np.arange(first.size)
    found = (first < WIDEST) & (course[first, at] == STICKS)
    found[found] = course[first[found] + 1, at[found]] == STICKS
    return first[found] + 1, starts[:, found]


def _stresses_at_border(stress, starts, apart):
    """Return stresses (6, bodies, n) midway between slip and stick.

    The components xx, yy and xy follow from the side that sticks, the others from slip.
    """
    sides = []
    for i, j, k, h in (
        (*_moved(starts, apart), *_moved(starts, apart + 1)),
        (*_moved(starts, 0), *_moved(starts, -1)),
    ):
        here = stress[:, :, i, j]
        sides.append(here + 0.5 * apart * (here - stress[:, :, k, h]))
    from_stick, out = sides
    out[:, [0, 1, 3]] = from_stick[:, [0, 1, 3]]
    return out.swapaxes(0, 1)
