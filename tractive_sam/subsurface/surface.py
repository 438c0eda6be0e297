"""Where a surface is stressed most: between elements, at the edge of the contact, where stick ends.

Friction and pressure have roots of the distance on either side of the last two, which no mesh
follows; but each stress has its root on one side only, and is smooth on the other.
"""

import numpy as np

from tractive_sam.mechanics import HalfSpaces, StressCriterion
from tractive_sam.operators import Lattice, between, slopes, surface_stress

FARTHEST = 1.5
"""Most elements from a corner that all four elements touch to the edge of the contact."""

EVEN = 2.0
"""Most by which the slope of the square of the pressure may change from that corner to the next."""

WIDEST = 3
"""Most elements from a corner that slips to one that sticks."""

_IN_PLANE = [0, 1, 3]
"""Components xx, yy, xy; the others are the tractions."""


def largest_at_surface(
    lattice: Lattice,
    body: HalfSpaces,
    tractions: np.ndarray,
    sliding: np.ndarray,
    criterion: StressCriterion,
) -> tuple[float, float, float]:
    """The largest equivalent stress at a loaded surface, and where.

    Of the corners at which four loaded elements meet, of the edge of the contact, and of the border
    between stick and slip. Towards the edge the pressure falls with the root of the distance, and
    so does the stress that it makes right below itself, -p across the edge and -2 nu p along it
    (plane strain). The rest is smooth: it is taken on to the edge along a straight line. Towards
    the border the traction has a root on the side that sticks, the stress in the plane one on the
    side that slips (as in Carter's solution): each is taken on to it from its smooth side.

    Parameters
    ----------
    lattice : Lattice
        Elements, or strips; lengths in mm.
    body : HalfSpaces
        The half-space, as `HalfSpaces.alone` gives it.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on the half-space, MPa.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.
    criterion : StressCriterion
        What makes one number of a stress.

    Returns
    -------
    (float, float, float)
        The stress, MPa, and its place from the centre of the first element, in elements.
    """
    stress = surface_stress(lattice, body, tractions)
    loaded = _whole(tractions[2] > 0.0)
    if not loaded.any():  # nowhere wider than an element
        loaded[:] = True
    found = (
        (stress[:, loaded], np.array(np.nonzero(loaded), dtype=float)),
        _where_it_is_rough(lattice, body, tractions, sliding, stress, loaded),
    )
    stress, places = (np.concatenate(parts, axis=1) for parts in zip(*found, strict=True))
    values = criterion(stress)
    k = np.argmax(values)
    i, j = places[:, k] + (0.5, 0.5 if tractions.shape[-1] > 1 else 0.0)
    return float(values[k]), float(i), float(j)


def surface_cycles(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What the surface goes through, along every row of corners.

    At the places of `largest_at_surface` in the row, and where no element is loaded; the material
    counts as unloaded elsewhere.

    Parameters
    ----------
    lattice, body, tractions, sliding
        As of `largest_at_surface`.

    Returns
    -------
    cycles : ndarray, shape (6, n, n_y - 1), of strips (6, n, 1)
        Stresses, in no order along the row, MPa.
    known : ndarray of bool, shape (n_y - 1,), of strips (1,)
        Rows in which that tells something: of those that only graze the contact it does not.
    """
    stress = surface_stress(lattice, body, tractions)
    touching = tractions[2] > 0.0
    loaded, away = _whole(touching), _whole(~touching)
    rough, places = _where_it_is_rough(lattice, body, tractions, sliding, stress, loaded)
    in_row = places[1] == np.rint(places[1])
    rough, row = rough[:, in_row], places[1, in_row].astype(int)
    order = np.argsort(row, kind="stable")
    rough, row = rough[:, order], row[order]
    count = np.bincount(row, minlength=stress.shape[2])
    among = np.arange(row.size) - (np.cumsum(count) - count)[row]
    added = np.zeros((6, count.max(initial=0), stress.shape[2]))
    added[:, among, row] = rough
    known = loaded.any(axis=0) | away.all(axis=0)
    return np.concatenate((np.where(loaded | away, stress, 0.0), added), axis=1), known


def _where_it_is_rough(
    lattice: Lattice,
    body: HalfSpaces,
    tractions: np.ndarray,
    sliding: np.ndarray,
    stress: np.ndarray,
    loaded: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (6, n) at the edge of the contact and where stick ends, and where, in corners."""
    touching = tractions[2] > 0.0
    found = (
        _at_edge(lattice, tractions[2], stress, loaded, body.A.poisson),
        _at_border(stress, _whole(touching & sliding), _whole(touching & ~sliding)),
    )
    return tuple(np.concatenate(parts, axis=1) for parts in zip(*found, strict=True))


def _whole(elements: np.ndarray) -> np.ndarray:
    """Corners all of whose elements are among these."""
    return between(elements.astype(float)) == 1.0


def _at_border(
    stress: np.ndarray, slips: np.ndarray, sticks: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (6, n) where stick ends, and the points (2, n), in corners.

    Midway between a corner that slips and the next one that sticks, in x or in y, where there are
    at most `WIDEST` steps between them and another one of the same kind behind each.
    """
    found, places = [np.zeros((6, 0))], [np.zeros((2, 0))]
    for axis in (0, 1) if slips.shape[1] > 1 else (0,):
        for sign in (1, -1):
            ends = slips & _shifted(slips, -sign, axis)
            for steps in range(1, WIDEST + 1):
                there, beyond = (_shifted(sticks, sign * k, axis) for k in (steps, steps + 1))
                i = np.stack(np.nonzero(ends & there & beyond))
                ends &= ~_shifted(sticks | slips, sign * steps, axis)
                on = np.zeros_like(i)
                on[axis] = sign
                slip, behind = stress[:, *i], stress[:, *(i - on)]
                stick, further = (stress[:, *(i + k * on)] for k in (steps, steps + 1))
                at = slip + 0.5 * steps * (slip - behind)
                at[_IN_PLANE] = (stick + 0.5 * steps * (stick - further))[_IN_PLANE]
                found.append(at)
                places.append(i + 0.5 * steps * on)
    return np.concatenate(found, axis=1), np.concatenate(places, axis=1)


def _at_edge(
    lattice: Lattice, pressure: np.ndarray, stress: np.ndarray, loaded: np.ndarray, poisson: float
) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (6, n) at points of the edge, and the points (2, n), in corners.

    From every loaded corner that has one neighbour, in x or in y, that is not, and another one
    across from it that is. The square of the pressure is a straight line near the edge, which ends
    there.
    """
    p, square = between(pressure), between(pressure**2)
    slope = slopes(pressure**2, lattice.dx, lattice.dy)
    steep = np.hypot(*slope)
    normal = np.divide(slope, steep, out=np.zeros_like(slope), where=steep > 0.0)
    # sigma + p (n n + 2 nu t t), in the plane: t t = 1 - n n.
    k = 1.0 - 2.0 * poisson
    smooth = stress[_IN_PLANE]
    smooth += p * np.stack(
        (
            k * normal[0] ** 2 + 2.0 * poisson,
            k * normal[1] ** 2 + 2.0 * poisson,
            k * normal[0] * normal[1],
        )
    )
    found, places = [np.zeros((3, 0))], [np.zeros((2, 0))]
    per_element = slope * np.array([lattice.dx, lattice.dy])[:, None, None]
    for axis in (0, 1) if loaded.shape[1] > 1 else (0,):
        steeper = np.abs(per_element[axis]) >= np.abs(per_element[1 - axis])
        for sign in (1, -1):
            within, without = _shifted(loaded, sign, axis), _shifted(loaded, -sign, axis)
            rising = sign * per_element[axis]
            ends = loaded & within & ~without & steeper & (rising > 0.0)
            ends &= square <= FARTHEST * rising
            i = np.stack(np.nonzero(ends))
            inner = i.copy()
            inner[axis] += sign
            # As steep further inside, or the edge is sharper than the mesh.
            even = rising[*inner] / rising[*i]
            i, inner = (k[:, (even > 1.0 / EVEN) & (even < EVEN)] for k in (i, inner))
            away = square[*i] / rising[*i]
            here = smooth[:, *i]
            found.append(here + away * (here - smooth[:, *inner]))
            place = i.astype(float)
            place[axis] -= sign * away
            places.append(place)
    flat = np.concatenate(found, axis=1)
    edge = np.zeros((6, flat.shape[1]))
    edge[_IN_PLANE] = flat
    return edge, np.concatenate(places, axis=1)


def _shifted(corners: np.ndarray, steps: int, axis: int) -> np.ndarray:
    """What is so many corners further along an axis; nothing beyond the last."""
    moved = np.roll(corners, -steps, axis)
    end = np.moveaxis(moved, axis, 0)
    end[slice(-steps, None) if steps > 0 else slice(None, -steps)] = False
    return moved
