"""Stress below the surface: sections with contours on planes of one body or both, and maxima."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator

from tractive_sam.mechanics import CRITERIA, VON_MISES, StressCriterion
from tractive_sam.plot.contact_map import (
    TICK_SPACE,
    ContactView,
    MapFrame,
    MapLayout,
    add_axes,
    add_bar_axes,
    draw_contact_edge,
    new_map_figure,
    share_y_axis,
)
from tractive_sam.plot.figure import (
    LOOK,
    MICRON,
    Figure,
    Scale,
    apply_style,
    current_options,
    new_figure,
    set_title,
)
from tractive_sam.plot.registry import contact_figure, history_figure
from tractive_sam.results import History, PlaneStress, State
from tractive_sam.scene import Plane


@dataclass(frozen=True)
class StressMaximum:
    """Maximum of a quantity on a plane: kind, value and position.

    Attributes
    ----------
    kind : str
        "interior", "surface", or "largest".
    value : float
        Value of the maximum, in the unit of the values.
    at : tuple of float
        Coordinates along the axes of the plane, in their unit.

    Examples
    --------
    >>> values, axes = np.array([[1.0, 2.0], [0.0, -3.0]]), (np.arange(2.0), np.arange(2.0))
    >>> plot.StressMaximum.largest("largest", values, axes)
    StressMaximum(kind='largest', value=-3.0, at=(1.0, 1.0))
    """

    kind: str
    value: float
    at: tuple[float, float]

    @classmethod
    def largest(cls, kind: str, values: np.ndarray, axes: tuple[np.ndarray, np.ndarray]) -> Self:
        """Return the maximum of the largest magnitude in values (n, m) over two axes."""
        i, j = np.unravel_index(np.argmax(np.abs(values)), values.shape)
        return cls(kind, float(values[i, j]), (float(axes[0][i]), float(axes[1][j])))


def stress_maxima(values: np.ndarray, axes: tuple[np.ndarray, np.ndarray]) -> list[StressMaximum]:
    """Return the largest local maximum inside and the surface maximum; if neither, the largest.

    As in `subsurface.Maximum`, points closer to the surface than one element are ignored: there
    every edge between elements has a local maximum.

    Parameters
    ----------
    values : ndarray, shape (n, m)
        Positive values on a plane through the depth.
    axes : (ndarray of shape (n,), ndarray of shape (m,))
        Centres of elements along the plane, and ascending depths.

    Returns
    -------
    list of StressMaximum
        Both, if the plane has them; else its largest value.

    Examples
    --------
    >>> stress = ts.stress_on_plane(contact, "y=0", "A")
    >>> maxima = plot.stress_maxima(stress.von_mises, tuple(stress.axes.values()))
    >>> [maximum.kind for maximum in maxima]
    ['interior', 'surface']
    """
    along, depth = axes
    neighbours = np.lib.stride_tricks.sliding_window_view(np.pad(values, 1, "edge"), (3, 3))
    tops = values == neighbours.max(axis=(2, 3))
    # Beyond the edges of the plane the stress is unknown.
    tops[[0, -1]] = tops[:, -1] = False
    inside = np.where(tops & (depth >= along[1] - along[0]), values, 0.0)
    at_surface = np.where(depth == 0.0, values, 0.0)
    maxima = [
        StressMaximum.largest(kind, part, axes)
        for kind, part in (("interior", inside), ("surface", at_surface))
        if part.any()
    ]
    return maxima or [StressMaximum.largest("largest", values, axes)]


@dataclass(frozen=True)
class PlaneSection:
    """Quantity on a plane of one body as figures draw it, with its scale.

    Attributes
    ----------
    stress : PlaneStress
        The plane.
    quantity : str or StressCriterion
        A component of the stress, a criterion, or the name of one of `CRITERIA`.
    scale : Scale or None
        Half widths and pressure by which figures divide; None for mm and MPa.

    Raises
    ------
    ValueError
        If the quantity is unknown, or the plane is only a line.
    """

    stress: PlaneStress
    quantity: str | StressCriterion
    scale: Scale | None

    def __post_init__(self) -> None:
        allowed = (*CRITERIA, *self.stress.components)
        if self.criterion is None and self.quantity not in allowed:
            raise ValueError(f"quantity: one of {', '.join(allowed)}; not {self.quantity!r}")
        if min(self.values.shape) < 2:
            raise ValueError("a plane needs at least 2 depths, and 2 points along it")

    @property
    def body(self) -> str:
        """Name of the body, "A" or "B"."""
        return self.stress.body

    @property
    def parallel(self) -> bool:
        """Whether the plane is parallel to the surface."""
        return "depth" not in self.stress.axes

    @property
    def criterion(self) -> StressCriterion | None:
        """Criterion of the stress; None for a component."""
        if isinstance(self.quantity, StressCriterion):
            return self.quantity
        return CRITERIA.get(self.quantity)

    @property
    def signed(self) -> bool:
        """Whether the quantity may have both signs, like a stress component."""
        return self.criterion is None

    @property
    def mesh_dependent(self) -> bool:
        """Whether the plane includes the surface and values there depend on the mesh.

        The components zz, xz and yz are the tractions there, which do not.
        """
        return self.quantity not in ("zz", "xz", "yz") and float(self.stress.depth.min()) == 0.0

    @cached_property
    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Ascending coordinates along both axes, over half width a, or in mm without a scale."""
        unit = self.scale.a if self.scale else 1.0
        first, second = self.stress.axes.values()
        return first / unit, np.sort(second) / unit

    @cached_property
    def values(self) -> np.ndarray:
        """Values of the quantity over the scale's pressure, or MPa, in the shape of the axes."""
        if self.criterion is None:
            values = self.stress.components[str(self.quantity)]
        elif self.criterion == VON_MISES:  # without the compiled one: it takes long to load
            values = self.stress.von_mises
        else:
            values = self.stress.by(self.criterion)
        _, second = self.stress.axes.values()
        return values[:, np.argsort(second)] / (self.scale.p if self.scale else 1.0)

    @cached_property
    def stress_maxima(self) -> list[StressMaximum]:
        """Maxima that a figure marks: the largest magnitude, or interior and surface maxima."""
        if self.parallel or self.signed:
            return [StressMaximum.largest("largest", self.values, self.axes)]
        return stress_maxima(self.values, self.axes)

    @property
    def symbol(self) -> str:
        """Symbol of the quantity with its unit, for math text."""
        criterion = self.criterion
        symbol = rf"\sigma_{{{self.quantity}}}" if criterion is None else criterion.symbol
        unit = "MPa" if criterion is None else criterion.unit
        return rf"${symbol}/{self.scale.p_symbol}$" if self.scale else f"${symbol}$ ({unit})"

    @property
    def description(self) -> str:
        """Name of the quantity, for titles."""
        criterion = self.criterion
        return f"stress component {self.quantity}" if criterion is None else criterion.long_name

    @property
    def place(self) -> str:
        """Position of the plane, as math text."""
        plane = self.stress.plane
        if plane.label:
            return f"around {plane.label.replace('-', ' ')}"
        unit = {"": r"\,\mathrm{mm}", "a": r"\,a", "b": r"\,b"}[plane.unit]
        if plane.unit and self.scale:
            unit = rf"\,{self.scale.a_symbol if plane.unit == 'a' else self.scale.b_symbol}"
        return f"${plane.axis} = {plane.number:g}{unit if plane.number else ''}$"

    @property
    def names(self) -> tuple[str, str]:
        """Names of the axes: "x", "y" or "depth"."""
        first, second = self.stress.axes
        return first, second

    @property
    def touching(self) -> np.ndarray:
        """Mask of the points in contact along a plane; all False for one below the surface."""
        depth = self.stress.depth
        if depth.min() > 0.0:
            return np.zeros(self.values.shape[0], dtype=bool)
        zz = self.stress.components["zz"]
        return (
            zz[:, np.argmin(depth)] < -1e-9 * np.abs(zz).max()
        )  # smaller ones are rounding errors

    def length_label(self, name: str) -> str:
        """Return the label of an axis or length, as math text."""
        name = name.replace("along", r"\Delta x")
        return f"${name}/{self.scale.a_symbol}$" if self.scale else f"${name}$ (mm)"

    def format_coordinate(self, name: str, value: float) -> str:
        """Return a coordinate of a point, as math text."""
        name = name.replace("along", r"\Delta x")
        if value == 0.0:
            return f"${name} = 0$"
        if self.scale is None:
            return rf"${name} = {value:.3g}\,\mathrm{{mm}}$"
        return rf"${name} = {value:.2f}\,{self.scale.a_symbol}$"

    def format_value(self, value: float) -> str:
        """Return a value of the quantity, as math text."""
        return f"${value:.3f}$" if self.scale else rf"${value:.4g}\,\mathrm{{MPa}}$"

    def draw_contours(self, axes: Axes, levels: np.ndarray, upwards: bool = True) -> ContourSet:
        """Fill axes with contours of the quantity, and draw interfaces; return the contour set."""
        first, second = self.axes
        # Both sides of an interface are depths, a part in 1e9 from each other.
        for face in second[1:][np.diff(second) < 1e-8 * second[1:]]:
            axes.axhline(face if upwards else -face, color="black", lw=0.6, ls="--", zorder=0.7)
        second = second if upwards else -second
        colours = LOOK.signed if self.signed else LOOK.stress
        filled = axes.contourf(first, second, self.values.T, levels, cmap=colours, zorder=0.5)
        filled.set_edgecolor("face")  # no gaps between the bands
        style: dict[str, Any] = {
            "colors": "black",
            "linewidths": 0.35,
            "linestyles": "-",
            "alpha": 0.35,
        }
        axes.contour(first, second, self.values.T, levels, zorder=0.6, **style)
        return filled


def common_levels(sections: Sequence[PlaneSection], bands: int = 14) -> np.ndarray:
    """Return round contour levels for about `bands` bands in all sections together.

    Raises
    ------
    ValueError
        If none of them has any stress.
    """
    highest = max(float(np.abs(section.values).max()) for section in sections)
    if highest == 0.0:
        raise ValueError("nothing to draw: there is no stress on the plane; choose another one")
    lowest = -highest if sections[0].signed else 0.0
    locator = MaxNLocator(bands, symmetric=sections[0].signed)
    return np.asarray(locator.tick_values(lowest, highest))


Source: TypeAlias = "State | History | PlaneStress | Iterable[PlaneStress]"
"""Stress on a plane, or a contact or history from which it is computed or read."""

SURFACE_NOTE = "At the surface, values depend on the mesh."


@apply_style
def von_mises_section(
    source: Source,
    body: str = "A",
    plane: "Plane | str" = "y=0",
    at: float | None = None,
    *,
    quantity: str | StressCriterion = VON_MISES,
    scale: Scale | None = None,
    **named: float,
) -> Figure:
    """Contours of the equivalent stress of von Mises on a plane of one body, and its maxima.

    On a plane through the depth these are the largest local maxima inside the body and at its
    surface. A plane parallel to the surface is drawn with the edge of the contact.

    Parameters
    ----------
    source : State, History or PlaneStress
        A contact to compute the stress of; a history that stored it; or the stress on one plane,
        which is drawn in mm and MPa unless there is a scale.
    body : "A" or "B"
        The body concerned.
    plane : Plane or str
        Plane as in a scene: "y=0", "x=-0.3" (mm), "y=0.75a", "z=0.48a".
    at : float, optional
        One of the values that the history saved, also by the name of its coordinate:
        ``revolution=2``; the last by default.
    quantity : str or StressCriterion
        Another quantity: a criterion, "max_shear", or a component, "xx", "yy", "zz", "xy", "xz" or
        "yz".
    scale : Scale, optional
        Half widths and pressure by which the figure divides; by default the scale of the contact.

    Raises
    ------
    ValueError
        If the body, plane or quantity is unknown, or there is no stress.

    Examples
    --------
    >>> plot.von_mises_section(contact, "B", "y=0.5a")
    <Figure size ...>
    """
    stresses, view = _read_stresses(source, (body,), plane, at, **named)
    return _draw_planes(stresses, view, quantity, scale)


@apply_style
def von_mises_sections(
    source: Source,
    plane: "Plane | str" = "y=0",
    bodies: Sequence[str] = ("A", "B"),
    at: float | None = None,
    *,
    quantity: str | StressCriterion = VON_MISES,
    scale: Scale | None = None,
    **named: float,
) -> Figure:
    """Contours as by `von_mises_section` for both bodies in one colour scale, A above B.

    Planes parallel to the surface are drawn side by side.

    Parameters
    ----------
    source : State, History or iterable of PlaneStress
        Source as for `von_mises_section`; stresses must be on one plane, one for each body.
    plane, at, quantity, scale
        As for `von_mises_section`.
    bodies : sequence of "A" and "B"
        The bodies concerned.

    Raises
    ------
    ValueError
        As `von_mises_section`.

    Examples
    --------
    >>> plot.von_mises_sections(history, "x=0", revolution=0)
    <Figure size ...>
    """
    stresses, view = _read_stresses(source, bodies, plane, at, **named)
    return _draw_planes(stresses, view, quantity, scale)


def _stored_planes(view: ContactView) -> Iterator[Mapping[str, Any]]:
    """Yield {"plane", "bodies"} of each plane with stored stress that is more than a line."""
    planes: dict[str, list[str]] = {}
    if view.history is not None:
        for body, plane in view.history.planes:
            sides = view.history.stress(body, plane, view.at).axes.values()
            if min(map(len, sides)) > 1:
                planes.setdefault(plane, []).append(body)
    yield from ({"plane": plane, "bodies": tuple(bodies)} for plane, bodies in planes.items())


@contact_figure("von-mises-{plane}", each=_stored_planes)
def _stored_sections(view: ContactView, plane: str, bodies: Sequence[str]) -> Figure:
    """Equivalent stress of von Mises on a plane with stored stress, in each of its bodies."""
    return von_mises_sections(view.history or view.contact, plane, bodies, view.at)


def _each_passage(history: History) -> list[dict[str, str]]:
    """Return the arguments of the figures of each inclusion that wear has not uncovered."""
    return [
        {"body": body, "inclusion": inclusion}
        for (body, inclusion), rows in history.passages.items()
        if len(rows) and np.isfinite(rows[len(rows) - 1].von_mises).any()
    ]


@history_figure("passage-{inclusion}", each=_each_passage)
def inclusion_passage(
    history: History,
    body: str = "A",
    inclusion: str = "inclusion-1",
    at: float | None = None,
    **named: float,
) -> Figure:
    """Peak pressure, lift of the surface and largest stress by the position of an inclusion.

    Dots are the positions at which the contact is solved above the lifted surface. Without `lifts`,
    the panel of the pressure is missing. The lift is that above the centre of the inclusion, over
    the approach of the bodies.

    Parameters
    ----------
    history : History
        History of a scene with [[inclusion]].
    body : "A" or "B"
        The body that contains it.
    inclusion : str
        Its name; the first one of the scene is "inclusion-1".
    at : float, optional
        One of the saved values, as for `History.field`; the last by default.

    Raises
    ------
    LookupError
        If the passage was not stored.
    ValueError
        If wear has uncovered the inclusion.

    Examples
    --------
    >>> hole = ts.Inclusion(at=[0.0, 0.0, 1.5], radii=0.1, young=0.0, cells=5)
    >>> plot.inclusion_passage(ts.roll(scene.replace(inclusion=[hole])))
    <Figure size ...>
    """
    passage = history.passage(body, inclusion, at, **named)
    view = ContactView.from_source(history, at, **named)
    scale, contact = view.scale, view.contact
    if np.isnan(passage.von_mises).all():
        raise ValueError("nothing to draw: wear has uncovered the inclusion")
    unit, label = 1.0 / MICRON, r"lift ($\mathrm{\mu m}$)"
    if scale.relative:
        unit, label = contact.approach, r"lift $/\,\delta$"
    curves = [
        (passage.lift / unit, label),
        (passage.von_mises / scale.pressure, scale.pressure_label(VON_MISES.symbol)),
    ]
    if has_pressure := bool(np.isfinite(passage.p_max).any()):
        pressure = scale.pressure_label(r"p_\mathrm{max}")
        curves.insert(0, (passage.p_max / scale.pressure, pressure))
    figure = new_figure(1.0, 0.42 * len(curves) + 0.12)
    panels = figure.subplots(len(curves), sharex=True)
    edges = view.x_over_a[contact.touching.any(axis=1)][[0, -1]]
    for axes, (values, name) in zip(panels, curves, strict=True):
        axes.axvspan(*edges, color="0.93", linewidth=0.0, label="contact")
        known, style = np.isfinite(values), {"color": LOOK.bodies[body]}
        style |= {} if known.all() else {"marker": ".", "label": "solved contacts"}
        axes.plot(passage.place[known] / scale.length, values[known], **style)
        axes.set_ylabel(name)
    if has_pressure:
        look: dict[str, Any] = {"color": LOOK.grey, "linestyle": "--"}
        level = contact.p_max / scale.pressure
        panels[0].axhline(level, label="without the inclusion", **look)
    panels[-2].axhline(0.0, color=LOOK.grey, linewidth=0.6)
    panels[-1].set_ylim(bottom=0.0)
    panels[-1].set_xlabel(f"position of {inclusion.replace('-', ' ')}, {scale.length_label('x')}")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    set_title(figure, view.describe(f"passage of {inclusion.replace('-', ' ')} of body {body}"))
    return figure


def _read_stresses(
    source: Source, bodies: Sequence[str], plane: "Plane | str", at: float | None, **named: float
) -> tuple[list[PlaneStress], ContactView | None]:
    """Return the stress on a plane in each body, and the view of the contact, if any."""
    if isinstance(source, History):
        stored = [source.stress(body, str(plane), at, **named) for body in bodies]
        return stored, ContactView.from_source(source, at, **named)
    # Stored results must be drawn without loading the modules that compute them.
    from tractive_sam.subsurface import stress_on_planes  # noqa: PLC0415

    if isinstance(source, PlaneStress):
        return [source], None
    if isinstance(source, Iterable):
        return list(source), None
    return list(stress_on_planes(source, (plane,), bodies)), ContactView.from_source(source)


def _draw_planes(
    stresses: Sequence[PlaneStress],
    view: ContactView | None,
    quantity: str | StressCriterion,
    scale: Scale | None,
) -> Figure:
    """Return the figure of a quantity on one plane, in one or two bodies."""
    bodies, planes = {stress.body for stress in stresses}, {stress.plane for stress in stresses}
    if len(planes) != 1 or len(bodies) < len(stresses):
        named = ", ".join(f"{stress.plane} of {stress.body}" for stress in stresses) or "nothing"
        raise ValueError(f"stresses of one plane are needed, one for each body; not {named}")
    if view is not None and scale is None:
        scale = view.scale if view.scale.relative else None
    elif view is not None and scale is not None:
        view = replace(view, scale=scale)
    sections = [PlaneSection(stress, quantity, scale) for stress in stresses]
    levels = common_levels(sections)
    draw = _draw_side_by_side if sections[0].parallel else _draw_through_depth
    return draw(sections, view, levels)


def _draw_through_depth(
    sections: Sequence[PlaneSection], view: ContactView | None, levels: np.ndarray
) -> Figure:
    """Return the figure of a plane through the depth, A upwards and B downwards."""
    first, single = sections[0], len(sections) == 1
    above = [section.body == "A" and not single for section in sections]
    along, depth = first.axes
    left, right = _visible_range(first, view, 0)
    ends = -float(depth[-1]) * (not all(above)), float(depth[-1]) * any(above)
    if first.stress.plane.label:
        ends = -float(depth[-1]), -float(depth[0])
    frame = MapFrame.from_sides(left, right, *ends, width=0.9 * LOOK.width)
    figure, (axes,) = _new_panels(frame, sections, view, 1)
    name = "depth " if single else ""
    frame.apply_to(axes, first.length_label(first.names[0]), name + first.length_label("z"))
    place = first.place + frame.stretch_note
    axes.set_title(f"body {first.body}, {place}" if single else place)
    if single:
        axes.yaxis.set_major_formatter(FuncFormatter(lambda z, _: f"{abs(z):g}"))
    for section, upwards in zip(sections, above, strict=True):
        filled = section.draw_contours(axes, levels, upwards)
        _mark_maxima(axes, section, upwards)
        if not single:
            _name_body(axes, section, upwards)
    if not first.stress.plane.label:
        axes.axhline(0.0, color="black", linewidth=0.7)
    axes.plot(along, np.where(first.touching, 0.0, np.nan), color="black", linewidth=2.2)
    _add_colour_bar(figure, axes, filled, first)
    return figure


def _draw_side_by_side(
    sections: Sequence[PlaneSection], view: ContactView | None, levels: np.ndarray
) -> Figure:
    """Return the figure of a plane parallel to the surface, one map for each body."""
    first = sections[0]
    sides = *_visible_range(first, view, 0), *_visible_range(first, view, 1)
    frame = MapFrame.from_sides(*sides, width=0.72 * LOOK.width)
    figure, charts = _new_panels(frame, sections, view, len(sections))
    for axes, section in zip(charts, sections, strict=True):
        x, y = section.names
        frame.apply_to(axes, section.length_label(x), section.length_label(y))
        axes.set_title(f"body {section.body}, {section.place}{frame.stretch_note}")
        filled = section.draw_contours(axes, levels)
        _mark_maxima(axes, section)
        if view is not None:
            draw_contact_edge(axes, view, colors="white", linewidths=1.0, linestyles="--")
    share_y_axis(charts)
    _add_colour_bar(figure, charts[-1], filled, first)
    return figure


def _visible_range(
    section: PlaneSection, view: ContactView | None, axis: int, margin: float = 0.5
) -> tuple[float, float]:
    """Return the limits of an axis: around the contact, or all of the plane.

    The margin next to the contact is in half widths a.
    """
    first, last = section.axes[axis][[0, -1]].tolist()
    if view is None or section.names[axis] not in ("x", "y"):
        return first, last
    if section.names[axis] == "x":
        contact = view.x_over_a[view.contact.touching.any(axis=1)]
    else:
        contact = view.y_over_a[view.contact.touching.any(axis=0)]
    around = margin * view.scale.a / view.scale.length
    return max(first, float(contact[0]) - around), min(last, float(contact[-1]) + around)


def _new_panels(
    frame: MapFrame, sections: Sequence[PlaneSection], view: ContactView | None, count: int
) -> tuple[Figure, list[Axes]]:
    """Return a figure with `count` panels side by side and a legend, and the panels."""
    handles = [
        _legend_entry(section, maximum, several=len(sections) > 1)
        for section in sections
        for maximum in section.stress_maxima
    ]
    if any(section.mesh_dependent for section in sections):
        handles.append(Line2D([], [], linestyle="none", label=SURFACE_NOTE))
    layout = MapLayout.current()
    below = layout.line * len(handles)
    # At least as wide as the legend.
    width = max(layout.row_width(frame, count), 3.6 * current_options().scale)
    title = view.describe(sections[0].description) if view else ""
    figure = new_map_figure(width, frame, title, below + layout.line)
    look: dict[str, Any] = {"borderaxespad": 0.2, "fontsize": "small", "handlelength": 1.0}
    place = ((layout.left - 0.2) / width, 0.0)
    figure.legend(handles=handles, loc="lower left", bbox_to_anchor=place, **look)
    lefts = [layout.left + k * (frame.width + layout.gap) for k in range(count)]
    bottom = layout.bottom + below
    return figure, [add_axes(figure, x, bottom, frame.width, frame.height) for x in lefts]


def _legend_entry(section: PlaneSection, maximum: StressMaximum, *, several: bool) -> Line2D:
    """Return the legend entry of a maximum: its value and position."""
    position = ", ".join(
        section.format_coordinate(r"\mathrm{depth}" if name == "depth" else name, value)
        for name, value in zip(section.names, maximum.at, strict=True)
        if (name, value) != ("depth", 0.0)
    )
    kind = f"{section.body}, {maximum.kind}" if several else maximum.kind
    label = f"{kind}: {section.format_value(maximum.value)} at {position}"
    return Line2D([], [], linestyle="none", label=label, **_marker_style(section, maximum))


def _mark_maxima(axes: Axes, section: PlaneSection, upwards: bool = True) -> None:
    """Draw markers at the maxima of a section."""
    for maximum in section.stress_maxima:
        first, second = maximum.at
        second = second if upwards else -second
        axes.plot(first, second, clip_on=False, zorder=5, **_marker_style(section, maximum))


def _marker_style(section: PlaneSection, maximum: StressMaximum) -> dict[str, Any]:
    """Return the style of a maximum's marker: circle inside, triangle on the surface.

    The triangles of both bodies stand on either side of the surface and do not hide each other.
    """
    fonts = current_options().font_scale
    surface, tip = maximum.kind == "surface", 1.6 if section.body == "A" else -1.6
    triangle = [(-1.0, 0.0), (1.0, 0.0), (0.0, tip), (-1.0, 0.0)]
    return {
        "marker": triangle if surface else "o",
        "markersize": fonts * (12.0 if surface else 6.5),
        "markerfacecolor": "white",
        "markeredgecolor": "black",
        "markeredgewidth": 0.9,
    }


def _name_body(axes: Axes, section: PlaneSection, upwards: bool) -> None:
    """Write the name of the body into a corner of the axes."""
    color = "black" if section.signed else "white"
    y, align = (0.97, "top") if upwards else (0.03, "bottom")
    look: dict[str, Any] = {"va": align, "color": color, "fontsize": "large"}
    axes.text(0.02, y, section.body, transform=axes.transAxes, **look)


def _add_colour_bar(figure: Figure, axes: Axes, filled: ContourSet, section: PlaneSection) -> None:
    """Add a colour bar next to axes, with ticks at limits of bands."""
    width, height = figure.get_size_inches().tolist()
    box = axes.get_position(original=True)
    bar_axes = add_bar_axes(figure, box.x1 * width, box.y0 * height, box.height * height)
    max_ticks, levels = (
        int(bar_axes.get_position().height * height / TICK_SPACE),
        np.asarray(filled.levels),
    )
    every = 1 + (len(levels) - 2) // max_ticks
    first = int(np.argmin(np.abs(levels))) % every  # zero has a tick
    figure.colorbar(filled, cax=bar_axes, label=section.symbol, ticks=levels[first::every])
