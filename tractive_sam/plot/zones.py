"""Smooth boundaries of contact and stick, drawn from values at the centres of elements.

Both are zero lines of a function that runs about linearly through the boundary.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path
from scipy.ndimage import distance_transform_edt

from tractive_sam.plot.drawn import Drawn


def contact_edge(ax: Axes, state: Drawn, **style) -> Path:
    """Draw the edge of contact; its path encloses the contact."""
    x, y = _one_more(state.x_over_a), _one_more(state.y_over_a)
    level = edge_level(np.pad(state.contact.pressure, 1))
    return ax.contour(x, y, level.T, levels=[0.0], **style).get_paths()[0]


def stick_edge(ax: Axes, state: Drawn, contact: Path, **style) -> None:
    """Draw the boundary between stick and slip, within the contact."""
    stick = state.contact.touching & ~state.slip_zone
    if not stick.any() or not state.slip_zone.any():
        return
    level = continued(stick_level(state, stick), state.contact.touching)
    lines = ax.contour(state.x_over_a, state.y_over_a, level.T, levels=[0.0], **style)
    lines.set_clip_path(contact, ax.transData)


def fill_zones(ax: Axes, state: Drawn, contact: Path, colours: tuple[str, str]) -> None:
    """Colour the zones of slip and stick, in this order, within the contact."""
    stick = state.contact.touching & ~state.slip_zone
    level = np.where(stick, 1.0, -1.0)
    if stick.any() and state.slip_zone.any():
        level = continued(stick_level(state, stick), state.contact.touching)
    x, y = _one_more(state.x_over_a), _one_more(state.y_over_a)
    style = {"colors": colours, "zorder": 0.5}
    filled = ax.contourf(x, y, np.pad(level, 1, "edge").T, [-2.0, 0.0, 2.0], **style)
    filled.set_clip_path(contact, ax.transData)


def continued(values: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return the values, elsewhere the one at the nearest element; shapes (n_x, n_y).

    Examples
    --------
    >>> bool(plot.continued(contact.pressure, contact.touching).min() > 0.0)
    True
    """
    nearest = distance_transform_edt(~where, return_distances=False, return_indices=True)
    return values[tuple(nearest)]


def _one_more(centres: np.ndarray) -> np.ndarray:
    """Centres with one more on either side."""
    step = centres[1] - centres[0]
    return np.concatenate(([centres[0] - step], centres, [centres[-1] + step]))


def edge_level(pressure: np.ndarray) -> np.ndarray:
    """Squared pressure, continued linearly to the first elements out of contact.

    At a smooth edge the pressure falls like the root of the distance, its square linearly.

    Examples
    --------
    >>> bool(((plot.edge_level(contact.pressure) > 0.0) == contact.touching).all())
    True
    """
    square = np.pad(pressure**2, 2)
    total, weight = np.zeros_like(square), np.zeros_like(square)
    tiny = np.finfo(float).eps * square.max()
    for axis in (0, 1):
        for step in (1, -1):
            near, far = np.roll(square, step, axis), np.roll(square, 2 * step, axis)
            # The edge lies before the next centre and, where the pressure rises to it, midway.
            beyond = np.where(near < far, np.minimum(2.0 * near - far, -tiny), -near)
            # Directions count by how steeply the pressure falls along them.
            steepness = np.where(near > 0.0, np.abs(far - near) + tiny, 0.0)
            total += steepness * beyond
            weight += steepness
    outside = np.where(weight > 0.0, total / np.maximum(weight, tiny or 1.0), -square.max())
    return np.where(square > 0.0, square, outside)[2:-2, 2:-2]


def stick_level(state: Drawn, stick: np.ndarray) -> np.ndarray:
    """Squared distance to the friction bound where it sticks, minus squared slip where it slips.

    Both vanish at the boundary, and rise like roots of the distance from it.

    Examples
    --------
    >>> state = plot.Drawn.of(contact)
    >>> stick = state.contact.touching & ~state.slip_zone
    >>> bool((plot.stick_level(state, stick)[stick] >= 0.0).all())
    True
    """
    touching = state.contact.touching
    reserve = np.maximum(
        1.0 - state.contact.utilisation / np.where(touching, state.contact.bound, 1.0), 0.0
    )
    reserve = np.where(stick, reserve, 0.0)
    slip = np.where(touching & ~stick, np.hypot(*state.contact.slip), 0.0)
    tiny = np.finfo(float).tiny
    return (reserve / max(reserve.max(), tiny)) ** 2 - (slip / max(slip.max(), tiny)) ** 2
