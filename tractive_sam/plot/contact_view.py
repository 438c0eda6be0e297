"""A contact as figures draw it: scale, place in a history, conditions of a figure, and zones.

The boundaries of contact and stick are zero lines of functions that are about linear across them.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn, Self, TypeAlias

import numpy as np
import scipy  # its parts are loaded when first used
from matplotlib.axes import Axes
from matplotlib.path import Path

from tractive_sam.deprecation import renamed_attributes
from tractive_sam.description import math_value
from tractive_sam.plot.style import Scale, describe_friction, format_title
from tractive_sam.results import REVOLUTION, History, Quantity, State


@renamed_attributes(
    of="from_source", told="describe", place="position", ahead="edge_note", bounds="bound_ratios"
)
@dataclass(frozen=True, eq=False)
class ContactView:
    r"""Contact as figures draw it: with its scale and its position in a history.

    Attributes
    ----------
    contact : State
        The contact.
    scale : Scale
        Half widths and pressure by which figures divide.
    coordinate : Quantity
        Coordinate of the history.
    at : float
        Value of the coordinate.
    history : History, optional
        History that the contact is a record of.

    Examples
    --------
    >>> view = plot.ContactView.from_source(history, revolution=2)
    >>> view.caption, view.isotropic
    ('Twin discs, orthotropic friction and wear, N\xa0=\xa02', False)
    """

    contact: State
    scale: Scale
    coordinate: Quantity = REVOLUTION
    at: float = 0
    history: History | None = None

    @classmethod
    def from_source(cls, source: "Source", at: float | None = None, **named: float) -> Self:
        """Return the view of a contact, or of a record of a history, by default the last stored.

        Raises
        ------
        TypeError
            If the source is neither a contact nor a history.
        LookupError
            If the history did not store the fields of the record.
        """
        if isinstance(source, cls):
            return source
        if isinstance(source, History):
            saved = source.saved[source.row_of(at, **named)]
            scale = Scale.from_history(source)
            return cls(source.state(saved), scale, source.coordinate, saved, source)
        if isinstance(source, State):
            return cls(source, Scale.from_contact(source), at=source.revolution)
        kind = type(source).__name__
        raise TypeError(f"source: a contact or a history is needed, not {kind}")

    @property
    def x(self) -> np.ndarray:
        """Centres of the elements in the rolling direction, mm, shape (n_x,)."""
        return self.contact.grid.x

    @property
    def y(self) -> np.ndarray:
        """Centres of the elements in the lateral direction, mm, shape (n_y,)."""
        return self.contact.grid.y

    @property
    def columns(self) -> Mapping[str, Quantity]:
        """Columns of the history to which the contact belongs, by name; empty without one."""
        return {} if self.history is None else self.history.columns

    @property
    def title(self) -> str:
        """Title of the scene, with a note if the contact is not solved."""
        note = "" if self.contact.converged else f"not converged: {self.contact.status}"
        return ", ".join(filter(None, (self.contact.scene.title, note)))

    @property
    def caption(self) -> str:
        """Title of the scene and, unless it is 0, the position in the history."""
        position = self.position.replace("$", "").replace(" ", "\u00a0") if self.at else ""
        return ", ".join(filter(None, (self.title, position)))

    def describe(self, quantity: str, scaled: bool = True) -> str:
        """Return the title of a figure: the scene, the quantity, the position and the scale."""
        in_course = self.history is not None and len(self.history) > 1
        return format_title(
            self.title,
            quantity,
            self.position if self.at or in_course else "",
            describe_friction(self.contact.frame),
            self.scale.note if scaled else "",
        )

    @property
    def edge_note(self) -> str:
        """Note on the side of the leading edge, for the label of x; empty for shifts."""
        return "" if self.shifts else ", leading edge right"

    @property
    def shifts(self) -> bool:
        """Whether the bodies shift without rolling in the step of the contact."""
        return self.contact.scene.schedule.shifts_at(self.at)

    @property
    def position(self) -> str:
        """Position of the contact in its history (revolution, distance) as math text."""
        return math_value(self.coordinate, self.at)

    @property
    def isotropic(self) -> bool:
        """Whether friction is equal in all directions."""
        frame = self.contact.frame
        return frame is None or frame.mu[0] == frame.mu[1]

    @property
    def x_over_a(self) -> np.ndarray:
        """Centres in the rolling direction in half widths a, or mm, shape (n_x,)."""
        return self.x / self.scale.length

    @property
    def y_over_a(self) -> np.ndarray:
        """Centres in the lateral direction in half widths a, or mm, shape (n_y,)."""
        return self.y / self.scale.length

    @cached_property
    def slip_zone(self) -> np.ndarray:
        """Mask of slip for maps: slipping elements with a slipping neighbour in x.

        On a mesh the steps of the leading edge slip, because the traction bound nearly vanishes
        there; a layer of one element is no zone.
        """
        sliding = self.contact.sliding
        neighbours = np.pad(sliding, ((1, 1), (0, 0)))
        return sliding & (neighbours[2:] | neighbours[:-2])

    @property
    def bound_ratios(self) -> tuple[float, float]:
        """Largest |p_x|/p_n and |p_y|/p_n that friction allows; zeros without friction."""
        if self.contact.frame is None:
            return 0.0, 0.0
        x, y = np.linalg.norm(self.contact.frame.matrix, axis=0).tolist()
        return x, y


def select_evenly(saved: np.ndarray, count: int = 8) -> np.ndarray:
    """Return at most `count` of some values, evenly spaced, with the first and the last.

    Examples
    --------
    >>> plot.select_evenly(np.arange(100), 4).tolist()
    [0, 33, 66, 99]
    """
    if len(saved) <= count:
        return saved
    return saved[np.linspace(0, len(saved) - 1, count).round().astype(int)]


Source: TypeAlias = "ContactView | State | History"
"""A contact, or a history with a contact in each record with stored fields."""


@dataclass(frozen=True)
class Need:
    """Condition on a history or contact without which a figure cannot be drawn.

    Attributes
    ----------
    holds : callable
        Whether the `History`, or the `ContactView` of a figure of one contact, meets it.
    text : str
        The need and how to meet it: the end of "it needs ...".

    Examples
    --------
    >>> wide = plot.Need(lambda history: len(history.y) > 1, "elements across the track")
    >>> wide.holds(history)
    True
    """

    holds: Callable[[Any], bool]
    text: str

    def check(self, subject: ContactView | History) -> None:
        """Raise a ValueError if the condition is not met."""
        if not self.holds(subject):
            refuse("", [self.text])


WIDE = Need(
    lambda subject: len(subject.y) > 1,
    "elements across the track; this is a line contact: use line_pressure, line_traction, "
    "line_slip or line_pressures",
)
"""Need of maps, and of functions of y."""

SINGLE_ROW = Need(
    lambda subject: len(subject.y) == 1,
    "a single row of elements; this is no line contact: use pressure, traction or stick_slip_map",
)
"""Need of functions of x that do not depend on y."""


def refuse(name: str, missing: Iterable[str]) -> NoReturn:
    """Raise a ValueError that lists what a figure lacks."""
    figure = f"the figure {name}".strip()
    raise ValueError(f"{figure} cannot be drawn: it needs {'; '.join(missing)}")


def check_touching(views: Iterable[ContactView]) -> None:
    """Raise a ValueError if the bodies touch in none of several contacts."""
    if not any(view.contact.touching.any() for view in views):
        raise ValueError("nothing to draw: the bodies do not touch")


def has_traction(view: ContactView) -> bool:
    """Return whether a contact has tangential tractions."""
    return bool(view.contact.traction.any())


def touching_records(history: History) -> list[float]:
    """Return the coordinates of the first and last stored record with contact; [] with blocks.

    A single record is returned even without contact: its figures report that there is nothing to
    draw. A duty cycle has none: its records have a contact for each block.
    """
    stored = [] if history.block_names else history.saved.tolist()
    if len(history) == 1:
        return stored

    def touches(at: float) -> bool:
        return bool(history.field("pressure", at).any())

    ends = (next(filter(touches, places), None) for places in (stored, stored[::-1]))
    return [*dict.fromkeys(at for at in ends if at is not None)]


def has_course(history: History) -> bool:
    """Return whether a history has several records that follow each other."""
    return len(history) > 1 and history.scene.schedule.in_sequence


def has_contacts(history: History) -> bool:
    """Return whether several records have stored contacts, and bodies touch in one."""
    return len(history.saved) > 1 and bool(touching_records(history))


def is_worn(history: History) -> bool:
    """Return whether a history has any wear."""
    return bool(np.nan_to_num(history["wear_max"]).any())


def has_worn_contacts(history: History) -> bool:
    """Return whether a history has wear, and several stored contacts."""
    return is_worn(history) and len(history.saved) * max(1, len(history.block_names)) > 1


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
