"""Stress below the surface: contours on planes through one body or both."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from tractive_sam.mechanics import VON_MISES, StressCriterion
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.frame import TICK_ROOM, Frame
from tractive_sam.plot.map import APART, BOTTOM, LEFT, LINE, RIGHT, bar, paper, placed
from tractive_sam.plot.plane_maxima import StressMaximum
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.section import Section, common_levels
from tractive_sam.plot.style import WIDTH, styled
from tractive_sam.plot.zones import contact_edge
from tractive_sam.results import History, PlaneStress, State
from tractive_sam.scene import Plane

Source: TypeAlias = "State | History | PlaneStress | Iterable[PlaneStress]"
"""What holds stress on a plane, or lets it be computed."""

AROUND = 0.5
"""Shown beside the contact, in half widths a."""

PLACE = 0.22
"""Room for the name of the plane above it, inches."""

NARROWEST = 3.6
"""Width of a figure that has room for its legend, inches."""

NOTE = "At the surface, values depend on the mesh."


@styled
def von_mises(
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
        A contact, whose stress is computed; a history that stored it; or the stress on one plane,
        which is drawn in mm and MPa unless there is a scale.
    body : "A" or "B"
        The body concerned.
    plane : Plane or str
        As in a scene: "y=0", "x=-0.3" (mm), "y=0.75a", "z=0.48a".
    at : float, optional
        One of the values that the history saved, also by the name of its coordinate,
        ``revolution=2``; the last by default.
    quantity : str or StressCriterion
        What else to draw: another criterion, "max_shear", or a component, "xx", "yy", "zz", "xy",
        "xz" or "yz".
    scale : Scale, optional
        Half widths and pressure that stand for one; by default those of the contact.

    Raises
    ------
    ValueError
        If there is no such body, plane or quantity, or no stress.

    Examples
    --------
    >>> plot.von_mises(contact, "B", "y=0.5a")
    <Figure size ...>
    """
    stresses, state = _resolved(source, (body,), plane, at, **named)
    return _drawn(stresses, state, quantity, scale)


@styled
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
    """Contours as by `von_mises` for both bodies in the same colours, A above B.

    Planes parallel to the surface are drawn side by side.

    Parameters
    ----------
    source : State, History or iterable of PlaneStress
        As for `von_mises`; of stresses one plane, a body at a time.
    plane, at, quantity, scale
        As for `von_mises`.
    bodies : sequence of "A" and "B"
        The bodies concerned.

    Raises
    ------
    ValueError
        As by `von_mises`.

    Examples
    --------
    >>> plot.von_mises_sections(history, "x=0", revolution=0)
    <Figure size ...>
    """
    stresses, state = _resolved(source, bodies, plane, at, **named)
    return _drawn(stresses, state, quantity, scale)


def _stored_planes(state: Drawn) -> Iterator[dict[str, object]]:
    """Planes of the stored stress, each with its bodies; none that are lines."""
    planes: dict[str, list[str]] = {}
    for body, plane in state.history.planes:
        sides = state.history.stress(body, plane, state.at).axes.values()
        if min(map(len, sides)) > 1:
            planes.setdefault(plane, []).append(body)
    yield from ({"plane": plane, "bodies": tuple(of)} for plane, of in planes.items())


@contact_figure("von-mises-{plane}", each=_stored_planes)
def _stored_sections(state: Drawn, plane: str, bodies: Sequence[str]) -> Figure:
    """Equivalent stress of von Mises on a plane below the surface."""
    return von_mises_sections(state.history, plane, bodies, state.at)


def _resolved(
    source: Source,
    bodies: Sequence[str],
    plane: "Plane | str",
    at: float | None,
    **named: float,
) -> tuple[list["PlaneStress"], Drawn | None]:
    """Stress on the plane in each body, and the state of the contact where it is known."""
    if isinstance(source, History):
        stored = [source.stress(body, plane, at, **named) for body in bodies]
        return stored, Drawn.of(source, at, **named)
    # Stored results are to be drawn without loading what computes them.
    from tractive_sam.subsurface import stress_on_planes  # noqa: PLC0415

    if isinstance(source, PlaneStress):
        return [source], None
    if isinstance(source, Iterable):
        return list(source), None
    return list(stress_on_planes(source, (plane,), bodies)), Drawn.of(source)


def _drawn(
    stresses: Sequence["PlaneStress"], state: Drawn | None, quantity: str, scale: Scale | None
) -> Figure:
    bodies, planes = {stress.body for stress in stresses}, {stress.plane for stress in stresses}
    if len(planes) != 1 or len(bodies) < len(stresses):
        given = ", ".join(f"{stress.plane} of {stress.body}" for stress in stresses) or "nothing"
        raise ValueError(f"one plane is drawn, of each body once; not {given}")
    if state is not None and scale is None:
        scale = state.scale if state.scale.relative else None
    elif state is not None:
        state = replace(state, scale=scale)
    sections = [Section(stress, quantity, scale) for stress in stresses]
    levels = common_levels(sections)
    if sections[0].parallel:
        return _side_by_side(sections, state, levels)
    return _through_the_depth(sections, state, levels)


def _through_the_depth(
    sections: Sequence[Section], state: Drawn | None, levels: np.ndarray
) -> Figure:
    """One body downwards, or A upwards and B downwards from the interface."""
    first, one = sections[0], len(sections) == 1
    above = [section.body == "A" and not one for section in sections]
    along, depth = first.axes
    sides = *_shown(first, state, 0), -depth[-1] * (not all(above)), depth[-1] * any(above)
    frame = Frame.within(*map(float, sides), width=0.9 * WIDTH)
    figure, (axes,) = _panels(frame, sections, state, 1)
    name = "depth " if one else ""
    frame.apply(axes, first.length(first.names[0]), name + first.length("z"))
    axes.set_title(f"body {first.body}, {first.place}" if one else first.place)
    if one:
        axes.yaxis.set_major_formatter(FuncFormatter(lambda z, _: f"{abs(z):g}"))
    for section, up in zip(sections, above, strict=True):
        filled = section.fill(axes, levels, up)
        _mark(axes, section, up)
        if not one:
            _letter(axes, section, up)
    axes.axhline(0.0, color="black", linewidth=0.7)
    axes.plot(along, np.where(first.touching, 0.0, np.nan), color="black", linewidth=2.2)
    _colour_bar(figure, axes, filled, first)
    return figure


def _side_by_side(sections: Sequence[Section], state: Drawn | None, levels: np.ndarray) -> Figure:
    """Planes parallel to the surface, one map for each body."""
    first = sections[0]
    sides = *_shown(first, state, 0), *_shown(first, state, 1)
    frame = Frame.within(*sides, width=0.72 * WIDTH)
    figure, charts = _panels(frame, sections, state, len(sections))
    for axes, section in zip(charts, sections, strict=True):
        frame.apply(axes, *map(section.length, section.names))
        axes.set_title(f"body {section.body}, {section.place}")
        filled = section.fill(axes, levels)
        _mark(axes, section)
        if state is not None:
            contact_edge(axes, state, colors="white", linewidths=1.0, linestyles="--")
    for axes in charts[1:]:
        axes.set_ylabel("")
        axes.tick_params(labelleft=False)
    _colour_bar(figure, charts[-1], filled, first)
    return figure


def _shown(section: Section, state: Drawn | None, axis: int) -> tuple[float, float]:
    """Ends of an axis: around the contact where that is known, else all that was computed."""
    first, last = section.axes[axis][[0, -1]].tolist()
    if state is None:
        return first, last
    if section.names[axis] == "x":
        contact = state.x_over_a[state.contact.touching.any(axis=1)]
    else:
        contact = state.y_over_a[state.contact.touching.any(axis=0)]
    around = AROUND * state.scale.a / state.scale.length
    return max(first, float(contact[0]) - around), min(last, float(contact[-1]) + around)


def _panels(
    frame: Frame, sections: Sequence[Section], state: Drawn | None, count: int
) -> tuple[Figure, list[Axes]]:
    """A figure of panels side by side, and below them a legend of what is marked in them."""
    handles = [
        _entry(section, maximum, several=len(sections) > 1)
        for section in sections
        for maximum in section.stress_maxima
    ]
    if any(section.mesh_dependent for section in sections):
        handles.append(Line2D([], [], linestyle="none", label=NOTE))
    below, step = LINE * len(handles), frame.width + APART
    width = max(LEFT + count * step - APART + RIGHT, NARROWEST)
    figure = paper(width, frame, state.told(sections[0].told) if state else "", below + PLACE)
    style = {"loc": "lower left", "borderaxespad": 0.2, "fontsize": 9, "handlelength": 1.0}
    figure.legend(handles=handles, bbox_to_anchor=((LEFT - 0.2) / width, 0.0), **style)
    bottom = BOTTOM + below
    places = (LEFT + k * step for k in range(count))
    return figure, [placed(figure, at, bottom, frame.width, frame.height) for at in places]


def _entry(section: Section, maximum: StressMaximum, *, several: bool) -> Line2D:
    """What the legend tells of a maximum."""
    where = ", ".join(
        section.coordinate(r"\mathrm{depth}" if name == "depth" else name, value)
        for name, value in zip(section.names, maximum.at, strict=True)
        if (name, value) != ("depth", 0.0)
    )
    which = f"{section.body}, {maximum.kind}" if several else maximum.kind
    label = f"{which}: {section.amount(maximum.value)} at {where}"
    return Line2D([], [], linestyle="none", label=label, **_marker(section, maximum))


def _mark(axes: Axes, section: Section, upwards: bool = True) -> None:
    for maximum in section.stress_maxima:
        first, second = maximum.at
        second = second if upwards else -second
        axes.plot(first, second, clip_on=False, zorder=5, **_marker(section, maximum))


def _marker(section: Section, maximum: StressMaximum) -> dict[str, object]:
    """A circle; at the surface a triangle, upright in A and upside down in B."""
    triangle = "^" if section.body == "A" else "v"
    return {
        "marker": triangle if maximum.kind == "surface" else "o",
        "markersize": 6.5,
        "markerfacecolor": "white",
        "markeredgecolor": "black",
        "markeredgewidth": 0.9,
    }


def _letter(axes: Axes, section: Section, upwards: bool) -> None:
    """Name the body in its corner."""
    style = {"va": "top", "y": 0.97} if upwards else {"va": "bottom", "y": 0.03}
    color = "black" if section.signed else "white"
    axes.text(x=0.02, s=section.body, transform=axes.transAxes, color=color, fontsize=13, **style)


def _colour_bar(figure: Figure, axes: Axes, filled: ContourSet, section: Section) -> None:
    """Put a colour bar beside the axes, as high as they are, with ticks at limits of bands."""
    width, height = figure.get_size_inches()
    box = axes.get_position(original=True)
    beside = bar(figure, box.x1 * width, box.y0 * height, box.height * height)
    most = int(beside.get_position().height * height / TICK_ROOM)
    every = 1 + (len(filled.levels) - 2) // most
    first = int(np.argmin(np.abs(filled.levels))) % every  # zero has a tick
    ticks = filled.levels[first::every]
    figure.colorbar(filled, cax=beside, label=section.symbol, ticks=ticks)
