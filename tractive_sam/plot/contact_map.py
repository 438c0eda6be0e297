"""A contact as figures draw it: scale, zones and place in a history, and its map.

The boundaries of contact and stick are zero lines of functions that are about linear across them.
A map is true to scale unless it is too slender.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NoReturn, Self, TypeAlias

import numpy as np
import scipy  # its parts are loaded when first used
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from tractive_sam.description import format_place, math_value
from tractive_sam.lazy_names import renamed_attributes
from tractive_sam.plot.figure import (
    LOOK,
    Figure,
    Scale,
    current_options,
    describe_friction,
    format_title,
    set_title,
    wrap_title,
)
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
            describe_friction(self.contact.frame, self.contact.scene),
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


TICK_SPACE = 0.3
"""Height or width of a tick with its number, inches."""


@dataclass(frozen=True)
class MapFrame:
    """Rectangle around contacts that a map shows, true to scale unless too slender.

    Attributes
    ----------
    left, right, bottom, top : float
        Sides of the frame.
    width, height : float
        Size on paper, inches.
    """

    left: float
    right: float
    bottom: float
    top: float
    width: float
    height: float

    @classmethod
    def from_contacts(cls, *views: ContactView, width: float, margin: float = 0.15) -> Self:
        """Return the frame around several contacts, at most this wide on paper, inches.

        Parameters
        ----------
        *views : ContactView
            The contacts.
        width : float
            Largest width on paper, inches.
        margin : float
            Margin around the contact, in parts of its smaller half width.

        Raises
        ------
        ValueError
            If nothing touches in any of them.
        """
        check_touching(views)
        x = np.concatenate([v.x_over_a[v.contact.touching.any(axis=1)] for v in views])
        y = np.concatenate([v.y_over_a[v.contact.touching.any(axis=0)] for v in views])
        # An additional element, as the contact may be one element wide.
        around = margin * min(np.ptp(x), np.ptp(y)) / 2 + np.diff(views[0].x_over_a)[0]
        sides = x.min() - around, x.max() + around, y.min() - around, y.max() + around
        frame = cls.from_sides(*map(float, sides), width=width)
        # A low figure becomes as high as any other by room above and below the contact.
        layout, has_title = MapLayout.current(), bool(wrap_title("title", width))
        room = layout.bottom + layout.top - layout.line * (not has_title)
        height = max(frame.height, LOOK.least_height / 25.4 - room)
        added = 0.5 * (height - frame.height) * frame.units_per_inch[1]
        return replace(frame, bottom=frame.bottom - added, top=frame.top + added, height=height)

    @classmethod
    def from_sides(
        cls,
        left: float,
        right: float,
        bottom: float,
        top: float,
        *,
        width: float,
        longest: float = 5.5,
        shortest: float = 0.85,
    ) -> Self:
        """Return the frame between four sides, at most this wide on paper, inches.

        Parameters
        ----------
        left, right, bottom, top : float
            The sides.
        width, longest : float
            Largest width and height on paper, inches.
        shortest : float
            Smallest width and height on paper, inches: a more slender frame is stretched.
        """
        scale = current_options().scale
        ratio = (top - bottom) / (right - left)
        shortest = min(scale * shortest, width)
        width = min(width, scale * longest / ratio)
        frame = cls(left, right, bottom, top, width, width * ratio)
        return replace(frame, width=max(frame.width, shortest), height=max(frame.height, shortest))

    @property
    def units_per_inch(self) -> tuple[float, float]:
        """Length in x and in y that an inch of paper represents."""
        return (self.right - self.left) / self.width, (self.top - self.bottom) / self.height

    @property
    def stretch_note(self) -> str:
        """Note that the map is not true to scale; empty if it is."""
        x, y = self.units_per_inch
        if abs(y / x - 1.0) < 1e-6:  # rounding
            return ""
        axis, times = ("horizontally", y / x) if y > x else ("vertically", x / y)
        return f", stretched {times:.2g} times {axis}"

    def apply_to(self, axes: Axes, xlabel: str, ylabel: str) -> None:
        """Set limits, aspect, ticks and labels of axes as the frame defines them."""
        for axis, length in ((axes.xaxis, self.width), (axes.yaxis, self.height)):
            count = min(5, int(length / (current_options().font_scale * TICK_SPACE)))
            axis.set_major_locator(
                MaxNLocator(max(count, 2), steps=[1, 2, 4, 5, 10], min_n_ticks=3)
            )
            if count < 3:
                axis.set_major_formatter("{x:g}")  # three labels fit if zero has no decimals
        axes.set(xlim=(self.left, self.right), ylim=(self.bottom, self.top))
        axes.set_aspect("auto" if self.stretch_note else "equal")
        axes.set(xlabel=xlabel, ylabel=ylabel)


@dataclass(frozen=True)
class MapLayout:
    """Distances between maps, labels and edges of a figure, inches."""

    left: float = 0.65
    right: float = 1.15
    bottom: float = 0.55
    top: float = 0.35
    gap: float = 0.12  # between maps side by side
    line: float = 0.22  # height of a line of the title or legend
    bar: float = 0.13  # width of a colour bar
    bar_gap: float = 0.08
    shortest_bar: float = 0.7
    narrow: float = 1.6  # below narrower maps, there is room for the name of the axis only

    @classmethod
    def current(cls) -> Self:
        """Return the distances for the present size of fonts."""
        scale = current_options().font_scale
        return cls(*(scale * distance for distance in vars(cls()).values()))

    def row_width(self, frame: MapFrame, count: int) -> float:
        """Return the width, inches, of a figure with `count` maps side by side."""
        return self.left + count * (frame.width + self.gap) - self.gap + self.right


class ContactMap:
    """Axes on which one contact is drawn as a map, with its edge.

    Parameters
    ----------
    figure : Figure
        Figure of the map.
    left : float
        Distance of the map from the left of the figure, inches.
    view : ContactView
        The contact.
    frame : MapFrame
        The part that is shown.
    """

    def __init__(self, figure: Figure, left: float, view: ContactView, frame: MapFrame) -> None:
        layout = MapLayout.current()
        self.figure, self.left, self.view, self.frame = figure, left, view, frame
        self.axes = add_axes(figure, left, layout.bottom, frame.width, frame.height)
        note = view.edge_note if frame.width > layout.narrow else ""
        frame.apply_to(self.axes, view.scale.length_label("x") + note, view.scale.length_label("y"))
        self.contact = draw_contact_edge(self.axes, view, colors="black", linewidths=0.9)

    @classmethod
    def single(cls, view: ContactView, quantity: str, scaled: bool = True) -> tuple[Figure, Self]:
        """Return a figure with one map of a contact, and the map."""
        layout, frame = MapLayout.current(), MapFrame.from_contacts(view, width=0.72 * LOOK.width)
        width = max(layout.left + frame.width + layout.right, 0.72 * LOOK.width)
        quantity += (view.edge_note if frame.width <= layout.narrow else "") + frame.stretch_note
        figure = new_map_figure(width, frame, view.describe(quantity, scaled))
        middle = (layout.left + width - layout.right - frame.width) / 2
        return figure, cls(figure, middle, view, frame)

    @classmethod
    def row(cls, views: Sequence[ContactView], quantity: str) -> tuple[Figure, list[Self]]:
        """Return a figure with the maps of several contacts side by side, and the maps."""
        layout = MapLayout.current()
        frame = MapFrame.from_contacts(*views, width=1.7 * LOOK.width / len(views))
        first = views[0]
        quantity += first.edge_note + frame.stretch_note
        friction = describe_friction(first.contact.frame, first.contact.scene)
        title = format_title(first.title, quantity, friction, first.scale.note)
        # A line of room for the positions of the maps.
        figure = new_map_figure(layout.row_width(frame, len(views)), frame, title, positions=True)
        step = frame.width + layout.gap
        maps = [cls(figure, layout.left + k * step, view, frame) for k, view in enumerate(views)]
        for chart in maps:
            narrow = frame.width < layout.narrow / 2 and chart.view is not first
            at = format_place(first.coordinate, chart.view.at) if narrow else chart.view.position
            chart.axes.set_title(at, loc="center")
        share_y_axis([chart.axes for chart in maps])
        return figure, maps

    def fill(self, values: np.ndarray, *, finest: int = 600, **style: Any) -> QuadMesh:
        """Colour the contact area by element values, at most `finest` on a side; return the mesh.

        A print has no more dots than `finest` elements on a side: of finer meshes some are omitted.
        """
        every = 1 + max(values.shape) // finest
        # From one step before the contact to one step past it.
        i, j = (
            slice(max(int(places.min()) - every, 0), int(places.max()) + every + 1, every)
            for places in np.nonzero(self.view.contact.touching)
        )
        style |= {"shading": "gouraud", "rasterized": True, "zorder": 0.5}
        x, y = self.view.x_over_a[i], self.view.y_over_a[j]
        mesh = self.axes.pcolormesh(x, y, values[i, j].T, **style)
        mesh.set_clip_path(self.contact, self.axes.transData)
        return mesh

    def fill_up_to_edge(self, values: np.ndarray, **style: Any) -> QuadMesh:
        """Colour the contact area by values that are extended up to its edge."""
        return self.fill(extend_outwards(values, self.view.contact.touching), **style)

    def fill_surface(self, values: np.ndarray, label: str, **style: Any) -> None:
        """Colour all elements by their values, with the white edge of the contact and a bar."""
        x, y = self.view.x_over_a, self.view.y_over_a
        mesh = self.axes.pcolormesh(x, y, values.T, shading="gouraud", rasterized=True, **style)
        edge = {"fill": False, "edgecolor": "white", "linewidth": 1.0, "zorder": 5}
        self.axes.add_patch(PathPatch(self.contact, **edge))
        self.add_colour_bar(mesh, label)

    def fill_zones(self, stick: str, slip: str) -> None:
        """Colour the zones of stick and of slip, up to the boundary between them."""
        fill_zones(self.axes, self.view, self.contact, (slip, stick))

    def draw_stick_edge(self, **style: Any) -> None:
        """Draw the boundary between stick and slip."""
        look: dict[str, Any] = {"colors": "white", "linewidths": 1.2, "linestyles": "--"} | style
        draw_stick_edge(self.axes, self.view, self.contact, **look)

    def add_colour_bar(self, mesh: QuadMesh, label: str) -> None:
        """Add a colour bar next to the map."""
        bottom = MapLayout.current().bottom
        axes = add_bar_axes(self.figure, self.left + self.frame.width, bottom, self.frame.height)
        length = 0.07 * current_options().font_scale * len(label.replace("$", ""))  # inches
        if length > self.frame.height:  # the title of the map names the quantity, too
            label = label[max(label.find("$"), 0) :]
        self.figure.colorbar(mesh, cax=axes, label=label)
        _fit_label(axes, self.frame.height, self.frame.height + bottom)
        power = axes.yaxis.get_offset_text()  # away from the map's title and the label
        power.set(x=0.5, horizontalalignment="center")

    def draw_arrows(
        self, vectors: np.ndarray, where: np.ndarray, color: str, *, across: int = 14
    ) -> None:
        """Draw vectors as arrows at some elements; the longest one spans their distance.

        Parameters
        ----------
        vectors : ndarray, shape (2, n_x, n_y)
            The vectors.
        where : ndarray of bool, shape (n_x, n_y)
            Elements with arrows.
        color : str
            Colour of the arrows.
        across : int
            Number of arrows across a contact that is as wide as long.
        """
        view, frame = self.view, self.frame
        spacing = float(np.sqrt(frame.width * frame.height)) / across  # inches
        longest = np.hypot(*vectors)[where].max(initial=0.0)
        if longest == 0.0:
            return
        x_step, y_step = (spacing * units for units in self.frame.units_per_inch)
        rows = np.ix_(_select_spaced(view.x_over_a, x_step), _select_spaced(view.y_over_a, y_step))
        i, j = (index[where[rows]] for index in np.broadcast_arrays(*rows))
        u, v = vectors[:, i, j] * (0.85 * spacing / longest)
        look: dict[str, Any] = {
            "scale_units": "inches",
            "scale": 1.0,
            "units": "inches",
            "width": 0.014,
        }
        heads: dict[str, Any] = {"headwidth": 4.0, "headlength": 4.5, "headaxislength": 4.0}
        x, y = view.x_over_a[i], view.y_over_a[j]
        self.axes.quiver(x, y, u, v, color=color, pivot="mid", **look, **heads)


def add_axes(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Return new axes at a position in a figure, inches."""
    figure_width, figure_height = figure.get_size_inches().tolist()
    box = left / figure_width, bottom / figure_height, width / figure_width, height / figure_height
    return figure.add_axes(box)


def add_bar_axes(figure: Figure, right: float, bottom: float, height: float) -> Axes:
    """Return new axes for a colour bar next to a map that ends at `right`, inches.

    It has at least its shortest height, and extends below a flat map.
    """
    layout = MapLayout.current()
    longer = max(height, layout.shortest_bar)
    return add_axes(figure, right + layout.bar_gap, bottom + height - longer, layout.bar, longer)


def _fit_label(bar: Axes, height: float, room: float) -> None:
    """Fit the label of a colour bar beside a flat map between its top and the end of the figure.

    Parameters
    ----------
    bar : Axes
        Axes of the colour bar.
    height, room : float
        Height of the map, and from its top to the bottom of the figure, inches.
    """
    label, dpi = bar.yaxis.label, bar.figure.dpi

    def length() -> float:
        return label.get_window_extent().height / dpi

    if length() <= height:
        return
    label.set_text("\n".join(label.get_text().rsplit(" ", 1)))
    if (longest := length()) > height:
        label.set_fontsize(float(label.get_fontsize()) * min(1.0, 0.95 * room / longest))
        label.set_y(1.0 - room / 2 / (bar.get_window_extent().height / dpi))


def share_y_axis(charts: Sequence[Axes]) -> None:
    """Remove the y labels of all but the first of several axes side by side."""
    for axes in charts[1:]:
        axes.set_ylabel("")
        axes.tick_params(labelleft=False)


def new_map_figure(
    width: float, frame: MapFrame, title: str, below: float = 0.0, positions: bool = False
) -> Figure:
    """Return a figure for maps with a wrapped title, as high as both need.

    Parameters
    ----------
    width : float
        Width of the figure, inches.
    frame : MapFrame
        Frame of the maps.
    title : str
        Text without math.
    below : float
        Room below the labels of the maps, inches.
    positions : bool
        Whether each map has a title as well.
    """
    layout, lines = MapLayout.current(), len(wrap_title(title, width)) + positions
    height = below + layout.bottom + frame.height + layout.top + layout.line * (lines - 1)
    figure = Figure(figsize=(width, height), layout="none")
    set_title(figure, title, y=1 - 0.08 / height)
    return figure


def _select_spaced(centres: np.ndarray, spacing: float) -> np.ndarray:
    """Return indices of elements at about this spacing, symmetric about the middle."""
    step = max(1, round(spacing / (centres[1] - centres[0])))
    return np.arange(len(centres) // 2 % step, len(centres), step)
