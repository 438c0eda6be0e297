"""Where a surface is stressed most, between the elements and at the rim of the contact."""

from collections.abc import Callable

import numpy as np

from tractive_sam.operators import Mesh, surface_stress
from tractive_sam.operators.surface import between, slopes

Criterion = Callable[[np.ndarray], np.ndarray]
"""Stresses (6, ...) -> equivalent stress (...)."""

FARTHEST = 1.5
"""Most elements from a corner that all four elements touch to the edge of the contact."""

EVEN = 2.0
"""Most by which the slope of the square of the pressure may change from that corner to the next."""

_IN_PLANE = [0, 1, 3]
"""Components xx, yy, xy; the others vanish at the edge, as the tractions do."""


def largest_at_surface(
    mesh: Mesh, tractions: np.ndarray, poisson: float, criterion: Criterion
) -> tuple[float, float, float]:
    """The largest equivalent stress at a loaded surface, and where.

    Of the corners at which four loaded elements meet, and of the edge of the contact. Towards the
    edge the pressure falls with the root of the distance, and so does the stress that it makes
    right below itself, -p across the edge and -2 nu p along it (plane strain). The rest is smooth:
    it is taken on to the edge along a straight line.

    Parameters
    ----------
    mesh : Mesh
        Elements, or strips; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on the half-space, MPa.
    poisson : float
        Poisson's ratio.
    criterion : callable
        Equivalent stress of stresses (6, ...).

    Returns
    -------
    (float, float, float)
        The stress, MPa, and its place from the centre of the first element, in elements.
    """
    stress = surface_stress(mesh, tractions, poisson)
    loaded = between((tractions[2] > 0.0).astype(float)) == 1.0
    if not loaded.any():  # nowhere wider than an element
        loaded[:] = True
    values = np.where(loaded, criterion(stress), 0.0)
    i, j = np.unravel_index(np.argmax(values), values.shape)
    half = 0.5 if tractions.shape[-1] > 1 else 0.0
    best = float(values[i, j]), i + 0.5, j + half
    at, place = _at_edge(mesh, tractions[2], stress, loaded, poisson)
    if place.size:
        k = np.argmax(criterion(at))
        if criterion(at)[k] > best[0]:
            return float(criterion(at)[k]), place[0, k] + 0.5, place[1, k] + half
    return best


def _at_edge(
    mesh: Mesh, pressure: np.ndarray, stress: np.ndarray, loaded: np.ndarray, poisson: float
) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (6, n) at points of the edge, and the points (2, n), in corners.

    From every loaded corner that has one neighbour, in x or in y, that is not, and another one
    across from it that is. The square of the pressure is a straight line near the edge, which ends
    there.
    """
    p, square = between(pressure), between(pressure**2)
    slope = slopes(pressure**2, mesh.dx, mesh.dy)
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
    per_element = slope * np.array([mesh.dx, mesh.dy])[:, None, None]
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


def _shifted(loaded: np.ndarray, steps: int, axis: int) -> np.ndarray:
    """What is so many corners further along an axis; nothing beyond the last."""
    moved = np.roll(loaded, -steps, axis)
    end = np.moveaxis(moved, axis, 0)
    end[-1 if steps > 0 else 0] = False
    return moved
