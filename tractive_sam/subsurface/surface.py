"""Where a surface is stressed most: between elements, at the edge of the contact, where stick ends.

Friction and pressure have roots of the distance on either side of the last two, which no mesh
follows; but each stress has its root on one side only, and is smooth on the other
(`kernels.surface_edges`).
"""

from collections.abc import Sequence

import numpy as np

from tractive_sam.kernels.surface_edges import (
    BOTH,
    UNLOADED,
    kinds_of_corners,
    where_loaded,
    where_rough,
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
    """The largest equivalent stress at the surface of each body under a contact, and where.

    Of the corners at which four loaded elements meet, of the edge of the contact, and of the border
    between stick and slip.

    Parameters
    ----------
    lattice : Lattice
        Elements, or strips; lengths in mm.
    bodies : sequence of HalfSpaces
        The half-spaces, as `HalfSpaces.single_body` gives them.
    signs : sequence of float
        Those of `SIGNS` for each body.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.
    criterion : StressCriterion
        What makes one number of a stress.

    Returns
    -------
    list of (float, float, float)
        The stress, MPa, and its place from the centre of the first element, in elements.
    """
    stress, pressure = _between_elements(lattice, bodies, signs, tractions), tractions[2]
    kinds = kinds_of_corners(pressure, sliding)
    if not kinds.any():  # nowhere wider than an element
        kinds[:] = BOTH
    poisson = tuple(body.A.poisson for body in bodies)
    found = (
        where_loaded(stress, kinds),
        where_rough(stress, pressure, kinds, poisson, lattice.dx, lattice.dy),
    )
    each, places = (np.concatenate(parts, axis=-1) for parts in zip(*found, strict=True))
    values = criterion(each)
    at = values.argmax(axis=1)
    i, j = places[:, at] + np.array(((0.5,), (0.5 if pressure.shape[1] > 1 else 0.0,)))
    return list(zip(values[range(len(at)), at].tolist(), i.tolist(), j.tolist(), strict=True))


def _between_elements(
    lattice: Lattice,
    bodies: Sequence[HalfSpaces],
    signs: Sequence[float],
    tractions: np.ndarray,
) -> np.ndarray:
    """Stress (bodies, 6, ...) of `operators.surface_stress`, at once where bodies are alike."""
    if all(body == bodies[0] for body in bodies):
        return surface_stress(lattice, bodies[0], tractions, signs)
    each = zip(bodies, signs, strict=True)
    return np.concatenate([surface_stress(lattice, body, tractions, (s,)) for body, s in each])


def surface_cycles(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sign: float, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What the surface goes through, along every row of corners.

    At the places of `largest_at_surface` in the row, and where no element is loaded; the material
    counts as unloaded elsewhere.

    Parameters
    ----------
    lattice : Lattice
        Elements, or strips; lengths in mm.
    body : HalfSpaces
        The half-space, as `HalfSpaces.single_body` gives it.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    sign : float
        That of `SIGNS` for the body.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.

    Returns
    -------
    cycles : ndarray, shape (6, n, n_y - 1), of strips (6, n, 1)
        Stresses, in no order along the row, MPa.
    known : ndarray of bool, shape (n_y - 1,), of strips (1,)
        Rows in which that tells something: of those that only graze the contact it does not.
    """
    (stress,) = surface_stress(lattice, body, tractions, (sign,))
    pressure = tractions[2]
    kinds = kinds_of_corners(pressure, sliding)
    loaded = kinds != UNLOADED
    away = kinds_of_corners(1.0 * (pressure <= 0.0), sliding) != UNLOADED
    nu, sides = (body.A.poisson,), (lattice.dx, lattice.dy)
    rough, places = where_rough(stress[None], pressure, kinds, nu, *sides)
    in_row = places[1] == np.rint(places[1])
    rough, row = rough[:, 0, in_row], places[1, in_row].astype(int)
    order = np.argsort(row, kind="stable")
    rough, row = rough[:, order], row[order]
    count = np.bincount(row, minlength=stress.shape[2])
    among = np.arange(row.size) - (np.cumsum(count) - count)[row]
    added = np.zeros((6, count.max(initial=0), stress.shape[2]))
    added[:, among, row] = rough
    known = loaded.any(axis=0) | away.all(axis=0)
    return np.concatenate((np.where(loaded | away, stress, 0.0), added), axis=1), known
