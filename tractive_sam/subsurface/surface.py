"""Where a surface is stressed most: between elements, at the edge of the contact, where stick ends.

Friction and pressure have roots of the distance on either side of the last two, which no mesh
follows; but each stress has its root on one side only, and is smooth on the other.
"""

from collections.abc import Sequence

import numpy as np

from tractive_sam.mechanics import HalfSpaces, StressCriterion
from tractive_sam.operators import Lattice, between, slopes, surface_stress

FARTHEST = 2.0
"""Most elements from a corner that all four elements touch to the edge of the contact, where that
lies straight ahead; half of one less where it lies across a diagonal. An element is loaded about as
soon as the edge has passed its centre, one and a half from the corner before: with no more than
that, an edge that moves would come and go."""

EVENLY = 1.0 - 1e-6
"""Slope towards the edge over that along it, from which a corner is taken: on a diagonal both are
the same but for rounding."""

EVEN = 2.0
"""Most by which the slope of the square of the pressure may change from that corner to the next."""

WIDEST = 3
"""Most elements from a corner that slips to one that sticks."""

_FARTHEST_SHIFT = WIDEST + 1

_IN_PLANE = [0, 1, 3]
"""Components xx, yy, xy; the others are the tractions."""


def corner_stress(
    lattice: Lattice, bodies: Sequence[HalfSpaces], tractions: np.ndarray
) -> np.ndarray:
    """Stress (bodies, 6, ...) between elements under tractions (bodies, 3, n_x, n_y), MPa.

    See `operators.surface_stress`.
    """
    if all(body == bodies[0] for body in bodies):
        return surface_stress(lattice, bodies[0], tractions)
    each = zip(bodies, tractions, strict=True)
    return np.stack([surface_stress(lattice, body, own) for body, own in each])


def largest_at_surface(
    lattice: Lattice,
    poisson: Sequence[float],
    tractions: np.ndarray,
    stress: np.ndarray,
    sliding: np.ndarray,
    criterion: StressCriterion,
) -> list[tuple[float, float, float]]:
    """The largest equivalent stress at the surface of each body under a contact, and where.

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
    poisson : sequence of float
        Poisson's ratios.
    tractions : ndarray, shape (bodies, 3, n_x, n_y)
        (p_x, p_y, p_n) on each half-space, MPa; bodies under one contact share p_n.
    stress : ndarray, shape (bodies, 6, n_x - 1, n_y - 1)
        That of `corner_stress`, MPa.
    sliding : ndarray of bool, shape (n_x, n_y)
        Loaded elements that slip.
    criterion : StressCriterion
        What makes one number of a stress.

    Returns
    -------
    list of (float, float, float)
        The stress, MPa, and its place from the centre of the first element, in elements.
    """
    pressure = tractions[0, 2]
    loaded = _whole(pressure > 0.0)
    if not loaded.any():  # nowhere wider than an element
        loaded[:] = True
    found = (
        (stress[:, :, loaded], np.array(np.nonzero(loaded), dtype=float)),
        _where_it_is_rough(lattice, poisson, pressure, sliding, stress, loaded),
    )
    each, places = (np.concatenate(parts, axis=-1) for parts in zip(*found, strict=True))
    middle = np.array((0.5, 0.5 if pressure.shape[1] > 1 else 0.0))
    largest = []
    for values in criterion(each.swapaxes(0, 1)):
        k = np.argmax(values)
        largest.append((float(values[k]), *map(float, places[:, k] + middle)))
    return largest


def surface_cycles(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, sliding: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What the surface goes through, along every row of corners.

    At the places of `largest_at_surface` in the row, and where no element is loaded; the material
    counts as unloaded elsewhere.

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
    poisson = (body.A.poisson,)
    (rough,), places = _where_it_is_rough(
        lattice, poisson, tractions[2], sliding, stress[None], loaded
    )
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
    poisson: Sequence[float],
    pressure: np.ndarray,
    sliding: np.ndarray,
    stress: np.ndarray,
    loaded: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (bodies, 6, n) at the edge of the contact and where stick ends, and the corners."""
    touching = pressure > 0.0
    found = (
        _at_edge(lattice, pressure, stress, loaded, poisson),
        _at_border(stress, _whole(touching & sliding), _whole(touching & ~sliding)),
    )
    stresses, places = zip(*found, strict=True)
    return np.concatenate(stresses, axis=-1), np.concatenate(places, axis=1)


def _whole(elements: np.ndarray) -> np.ndarray:
    """Corners all of whose elements are among these."""
    along = elements[1:] & elements[:-1]
    return along[:, 1:] & along[:, :-1] if along.shape[1] > 1 else along


def _at_border(
    stress: np.ndarray, slips: np.ndarray, sticks: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (bodies, 6, n) where stick ends, and the points (2, n), in corners.

    Midway between a corner that slips and the next one that sticks, in x or in y, where there are
    at most `WIDEST` steps between them and another one of the same kind behind each.
    """
    if not (slips.any() and sticks.any()):
        return stress[:, :, :0, 0], np.zeros((2, 0))
    slip_at, stick_at, either_at = map(_Shifted, (slips, sticks, sticks | slips))
    ways, steps, ends = [], [], []
    for way in _ways(slips.shape):
        last = slips & slip_at(-way)
        for step in range(1, WIDEST + 1):
            ends.append(last & stick_at(step * way) & stick_at((step + 1) * way))
            ways.append(way)
            steps.append(step)
            last = last & ~either_at(step * way)
    k, *i = np.nonzero(ends)
    on, apart = np.array(ways)[k].T, np.array(steps)[k]
    slip, behind = stress[:, :, *i], stress[:, :, *(i - on)]
    stick, further = stress[:, :, *(i + apart * on)], stress[:, :, *(i + (apart + 1) * on)]
    at = slip + 0.5 * apart * (slip - behind)
    at[:, _IN_PLANE] = (stick + 0.5 * apart * (stick - further))[:, _IN_PLANE]
    return at, i + 0.5 * apart * on


def _at_edge(
    lattice: Lattice,
    pressure: np.ndarray,
    stress: np.ndarray,
    loaded: np.ndarray,
    poisson: Sequence[float],
) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (bodies, 6, n) at points of the edge, and the points (2, n), in corners.

    From every loaded corner that has one neighbour, in x or in y, that is not, and another one
    across from it that is. The square of the pressure is a straight line near the edge, which ends
    there.
    """
    ways, loaded_at = _ways(loaded.shape), _Shifted(loaded)
    k, *i = np.nonzero([loaded & loaded_at(way) & ~loaded_at(-way) for way in ways])
    on, i = ways[k].T, np.array(i)
    square = pressure**2
    slope = slopes(square, lattice.dx, lattice.dy)
    sides = np.array([[lattice.dx], [lattice.dy]])
    here = between(square)[*i]
    rising, inner = ((on * slope[:, *at] * sides).sum(axis=0) for at in (i, i + on))
    along = np.abs((~on.astype(bool) * slope[:, *i] * sides).sum(axis=0))
    # As steep further inside, or the edge is sharper than the mesh.
    known = (rising >= EVENLY * along) & (rising > 0.0) & (here <= FARTHEST * rising - 0.5 * along)
    known &= (inner > rising / EVEN) & (inner < EVEN * rising)
    i, on, away = i[:, known], on[:, known], here[known] / rising[known]
    pressures = between(pressure)
    smooth, further = (
        _smooth(stress[..., *at], pressures[*at], slope[:, *at], poisson) for at in (i, i + on)
    )
    edge = np.zeros((len(stress), 6, away.size))
    edge[:, _IN_PLANE] = smooth + away * (smooth - further)
    return edge, i - away * on


def _ways(corners: tuple[int, int]) -> np.ndarray:
    """Steps (ways, 2) from a corner to its neighbours, in x and, if there are any, in y."""
    ways = np.array(((1, 0), (-1, 0), (0, 1), (0, -1)))
    return ways if corners[1] > 1 else ways[:2]


def _smooth(
    stress: np.ndarray, pressure: np.ndarray, slope: np.ndarray, poisson: Sequence[float]
) -> np.ndarray:
    """Stresses (bodies, 3, n) in the plane, less those that fall with the root of the distance."""
    steep = np.hypot(*slope)
    normal = np.divide(slope, steep, out=np.zeros_like(slope), where=steep > 0.0)
    tensor = np.stack((normal[0] ** 2, normal[1] ** 2, normal[0] * normal[1]))
    nu = np.array(poisson)[:, None, None]
    # sigma + p (n n + 2 nu t t), in the plane: t t = 1 - n n.
    own = (1.0 - 2.0 * nu) * tensor
    own[:, :2] += 2.0 * nu
    return stress[:, _IN_PLANE] + pressure * own


class _Shifted:
    """Corners that are a step (in x, in y) further; none beyond the last."""

    def __init__(self, corners: np.ndarray) -> None:
        self._shape = corners.shape
        self._within = np.zeros(np.add(corners.shape, 2 * _FARTHEST_SHIFT), dtype=bool)
        self._within[self._view(0, 0)] = corners

    def __call__(self, step: np.ndarray) -> np.ndarray:
        return self._within[self._view(*step)]

    def _view(self, *steps: int) -> tuple[slice, ...]:
        first = (_FARTHEST_SHIFT + k for k in steps)
        return tuple(slice(k, k + n) for k, n in zip(first, self._shape, strict=True))
