"""Smooth boundaries of contact and stick, drawn from values at the centres of elements.

Both are zero lines of a function that is about linear across the boundary.
"""

from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used
from matplotlib.axes import Axes
from matplotlib.path import Path

from tractive_sam.plot.contact_view import ContactView


def draw_contact_edge(axes: Axes, view: ContactView, **style: Any) -> Path:
    """Draw the edge of contact, and return it as a path to clip by."""
    x, y = _add_ends(view.x_over_a), _add_ends(view.y_over_a)
    level = edge_level(np.pad(view.contact.pressure, 1))
    return axes.contour(x, y, level.T, levels=[0.0], **style).get_paths()[0]


def draw_stick_edge(axes: Axes, view: ContactView, contact: Path, **style: Any) -> None:
    """Draw the boundary between stick and slip, within the contact."""
    stick = view.contact.touching & ~view.slip_zone
    if not stick.any() or not view.slip_zone.any():
        return
    level = extend_outwards(stick_level(view, stick), view.contact.touching)
    lines = axes.contour(view.x_over_a, view.y_over_a, level.T, levels=[0.0], **style)
    lines.set_clip_path(contact, axes.transData)


def fill_zones(axes: Axes, view: ContactView, contact: Path, colours: tuple[str, str]) -> None:
    """Colour the zones of slip and of stick within the contact."""
    stick = view.contact.touching & ~view.slip_zone
    level = np.where(stick, 1.0, -1.0)
    if stick.any() and view.slip_zone.any():
        level = extend_outwards(stick_level(view, stick), view.contact.touching)
    x, y = _add_ends(view.x_over_a), _add_ends(view.y_over_a)
    edges = np.pad(level, 1, "edge").T
    filled = axes.contourf(x, y, edges, [-2.0, 0.0, 2.0], colors=colours, zorder=0.5)
    filled.set_clip_path(contact, axes.transData)


def extend_outwards(values: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return values that are extended, outside a mask, from the nearest element in it.

    Examples
    --------
    >>> bool(plot.extend_outwards(contact.pressure, contact.touching).min() > 0.0)
    True
    """
    distances = scipy.ndimage.distance_transform_edt
    nearest = distances(~where, return_distances=False, return_indices=True)
    return values[tuple(nearest)]


def _add_ends(centres: np.ndarray) -> np.ndarray:
    """Return coordinates with one more at each end, equally spaced."""
    step = centres[1] - centres[0]
    return np.concatenate(([centres[0] - step], centres, [centres[-1] + step]))


def edge_level(pressure: np.ndarray) -> np.ndarray:
    """Return squared pressure, extrapolated to negative values outside: zero at the contact edge.

    Near a smooth edge the pressure is proportional to the root of the distance, so its square is
    linear.

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
            # The edge lies before the next centre; if the pressure increases towards it, midway.
            beyond = np.where(near < far, np.minimum(2.0 * near - far, -tiny), -near)
            # The steeper the pressure falls along a direction, the larger is its weight.
            steepness = np.where(near > 0.0, np.abs(far - near) + tiny, 0.0)
            total += steepness * beyond
            weight += steepness
    outside = np.where(weight > 0.0, total / np.maximum(weight, tiny or 1.0), -square.max())
    return np.where(square > 0.0, square, outside)[2:-2, 2:-2]


def stick_level(view: ContactView, stick: np.ndarray) -> np.ndarray:
    """Return a level field, zero at the boundary of stick: positive in stick, else negative.

    Both vanish at the boundary, and are proportional to the roots of the distance from it before
    they are squared; shapes (n_x, n_y).

    Examples
    --------
    >>> view = plot.ContactView.from_source(contact)
    >>> stick = view.contact.touching & ~view.slip_zone
    >>> bool((plot.stick_level(view, stick)[stick] >= 0.0).all())
    True
    """
    contact, touching = view.contact, view.contact.touching
    used = contact.utilisation / np.where(touching, contact.bound, 1.0)
    reserve = np.where(stick, np.maximum(1.0 - used, 0.0), 0.0)
    slip = np.where(touching & ~stick, np.hypot(*contact.slip), 0.0)
    tiny = np.finfo(float).tiny
    return (reserve / max(reserve.max(), tiny)) ** 2 - (slip / max(slip.max(), tiny)) ** 2
