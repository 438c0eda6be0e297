"""Largest stress at the surface: between elements, at the contact edge, at the border of stick.

At the last two, traction and pressure depend on the root of the distance, which no mesh resolves;
but each stress has the root on one side only, and is smooth on the other side
(`kernels.surface_edges`).
"""

from collections.abc import Sequence

import numpy as np

from tractive_sam.kernels.surface_edges import (
    BOTH,
    UNLOADED,
    kinds_of_corners,
    stresses_at_edges,
    stresses_at_loaded_corners,
)
from tractive_sam.mechanics import HalfSpaces, StressCriterion
from tractive_sam.operators import Lattice, surface_stress


def largest_at_surface(
    lattice: Lattice,
    bodies: Sequence[HalfSpaces],
    signs: Sequence[float],
    tractions: np.ndarray,
    sliding: np.ndarray,
    criterion: StressCriterion,
) -> list[tuple[float, float, float]]:
    """Return (value, i, j), in elements, of the largest surface stress of each body.

    Positions are the corners of four loaded elements, the edge of the contact, and the border
    between stick and slip.

    Parameters
    ----------
    lattice : Lattice
        Elements, or strips; lengths in mm.
    bodies : sequence of HalfSpaces
        The half-spaces, see `HalfSpaces.single_body`.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.
    criterion : StressCriterion
        Criterion of the stress.

    Returns
    -------
    list of (float, float, float)
        The stress, MPa, and its position (i, j) from the centre of the first element, in elements.
    """
    stress, pressure = _between_elements(lattice, bodies, signs, tractions), tractions[2]
    kinds = kinds_of_corners(pressure, sliding)
    if not kinds.any():  # nowhere wider than an element
        kinds[:] = BOTH
    poisson = tuple(body.A.poisson for body in bodies)
    candidates = (
        stresses_at_loaded_corners(stress, kinds),
        stresses_at_edges(stress, pressure, kinds, poisson, lattice.dx, lattice.dy),
    )
    each, places = (np.concatenate(parts, axis=-1) for parts in zip(*candidates, strict=True))
    values = criterion(each)
    at = values.argmax(axis=1)
    i, j = places[:, at] + np.array(((0.5,), (0.5 if pressure.shape[1] > 1 else 0.0,)))
    return list(zip(values[range(len(at)), at].tolist(), i.tolist(), j.tolist(), strict=True))


def _between_elements(
    lattice: Lattice, bodies: Sequence[HalfSpaces], signs: Sequence[float], tractions: np.ndarray
) -> np.ndarray:
    """Return the surface stress (bodies, 6, ...) between elements; equal bodies share work."""
    if all(body == bodies[0] for body in bodies):
        return surface_stress(lattice, bodies[0], tractions, signs)
    each = zip(bodies, signs, strict=True)
    return np.concatenate([surface_stress(lattice, body, tractions, (s,)) for body, s in each])


def surface_cycles(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sign: float, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return (surface stress paths (6, n, rows) along corner rows, mask of valid rows).

    It contains the positions of `largest_at_surface` in the row, and corners without load;
    elsewhere the material counts as unloaded.

    Parameters
    ----------
    lattice : Lattice
        Elements, or strips; lengths in mm.
    body : HalfSpaces
        The half-space, see `HalfSpaces.single_body`.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    sign : float
        Sign of the body, see `SIGNS`.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.

    Returns
    -------
    cycles : ndarray, shape (6, n, n_y - 1), for strips (6, n, 1)
        Stresses, in no order along the row, MPa.
    is_valid : ndarray of bool, shape (n_y - 1,), for strips (1,)
        Rows with a valid path: not those that only touch the edge of the contact.
    """
    stress, even, is_valid, rough, (_, row) = _surface_stresses(
        lattice, body, tractions, sign, sliding
    )
    order = np.argsort(row, kind="stable")
    rough, row = rough[:, order], row[order]
    count = np.bincount(row, minlength=stress.shape[2])
    among = np.arange(row.size) - (np.cumsum(count) - count)[row]
    added = np.zeros((6, count.max(initial=0), stress.shape[2]))
    added[:, among, row] = rough
    return np.concatenate((np.where(even, stress, 0.0), added), axis=1), is_valid


def surface_points(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sign: float, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (surface stresses (6, n), corner columns, corner rows, mask of valid rows).

    At an edge of the contact or of stick it is the stress on the smooth side, at the nearest
    corner; if this is not known, the stress between the elements. Parameters as for
    `surface_cycles`.

    Returns
    -------
    stress : ndarray, shape (6, n)
        MPa.
    column, row : ndarray of int, shape (n,)
        Numbers of the corners in x and in y.
    is_valid : ndarray of bool, shape (n_y - 1,), for strips (1,)
        As by `surface_cycles`.
    """
    stress, even, is_valid, rough, places = _surface_stresses(
        lattice, body, tractions, sign, sliding
    )
    edge = np.zeros_like(even)
    edge[tuple(places)] = True
    column, row = np.nonzero(even | ~edge)
    every = np.concatenate((stress[:, column, row], rough), axis=1)
    return every, np.append(column, places[0]), np.append(row, places[1]), is_valid


def _surface_stresses(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sign: float, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (corner stresses, smooth corners, valid rows, edge stresses, their nearest corners).

    Parameters as for `surface_cycles`; `sliding` is a mask.

    Returns
    -------
    stress : ndarray, shape (6, n_x - 1, n_y - 1)
        Stress at the corners.
    is_smooth : ndarray of bool, shape (n_x - 1, n_y - 1)
        Corners with smooth stress.
    is_valid : ndarray of bool, shape (n_y - 1,)
        Rows with a valid path.
    edge_stress : ndarray, shape (6, n)
        Stress at the edges in the rows of corners.
    nearest : ndarray of int, shape (2, n)
        Numbers of the nearest corner of each edge.
    """
    (stress,) = surface_stress(lattice, body, tractions, (sign,))
    pressure = tractions[2]
    kinds = kinds_of_corners(pressure, sliding)
    loaded = kinds != UNLOADED
    away = kinds_of_corners(1.0 * (pressure <= 0.0), sliding) != UNLOADED
    nu, sides = (body.A.poisson,), (lattice.dx, lattice.dy)
    rough, places = stresses_at_edges(stress[None], pressure, kinds, nu, *sides)
    in_row = places[1] == np.rint(places[1])
    is_valid = loaded.any(axis=0) | away.all(axis=0)
    last = np.array(stress.shape[1:])[:, None] - 1
    nearest = np.clip(np.rint(places[:, in_row]).astype(int), 0, last)
    return stress, loaded | away, is_valid, rough[:, 0, in_row], nearest
