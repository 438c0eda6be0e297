"""A map of the contact, true to scale where it is not too slender."""

from collections.abc import Sequence
from typing import Self

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh

from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.frame import Frame
from tractive_sam.plot.style import WIDTH, friction_label, set_title, wrapped
from tractive_sam.plot.style import told as titled
from tractive_sam.plot.zones import contact_edge, continued, fill_zones, stick_edge

ARROWS = 14
"""Across a contact that is as wide as long."""

FINEST = 600
"""Elements on a side beyond which some are left out: a print has no more dots."""

LEFT, RIGHT, BOTTOM, TOP = 0.65, 1.15, 0.55, 0.35
"""Around maps, for their labels, colour bar and title, inches."""

ROOM_TO_TELL = 1.6
"""Width of a map below which there is room for the name of its axis only, inches."""

LINE, APART = 0.22, 0.12
"""Height of a line of the title, and distance of maps side by side, inches."""

BAR, BAR_GAP, SHORTEST_BAR = 0.13, 0.08, 0.7
"""Width of a colour bar, its distance from the map, and its least height, inches."""


class Map:
    """Axes over one contact, with its edge drawn.

    Maps are placed by the inch: automatic layouts know no fixed ratio of the sides.

    Parameters
    ----------
    figure : Figure
        Where to draw.
    left : float
        Distance of the map from the left of the figure, inches.
    state : Drawn
        The contact.
    frame : Frame
        What to show of it.
    """

    def __init__(self, figure: Figure, left: float, state: Drawn, frame: Frame) -> None:
        self.figure, self.left, self.state, self.frame = figure, left, state, frame
        self.axes = self._axes(left, frame.width)
        across = state.scale.of_length("x") + ("" if _narrow(frame) else state.ahead)
        frame.apply(self.axes, across, state.scale.of_length("y"))
        self.contact = contact_edge(self.axes, state, colors="black", linewidths=0.9)

    @classmethod
    def single(cls, state: Drawn, told: str, scaled: bool = True) -> tuple[Figure, Self]:
        """Make a figure with one map, under the title of the scene and what it shows."""
        frame = Frame.around(state, width=0.72 * WIDTH)
        width = max(LEFT + frame.width + RIGHT, 0.72 * WIDTH)
        told += (state.ahead if _narrow(frame) else "") + frame.stretched
        figure = paper(width, frame, state.told(told, scaled))
        middle = (LEFT + width - RIGHT - frame.width) / 2
        return figure, cls(figure, middle, state, frame)

    @classmethod
    def row(cls, states: Sequence[Drawn], told: str) -> tuple[Figure, list[Self]]:
        """Make a figure with maps side by side, each under its place in the course."""
        frame = Frame.around(*states, width=1.7 * WIDTH / len(states))
        step = frame.width + APART
        width = LEFT + len(states) * step - APART + RIGHT
        scale, friction = states[0].scale, friction_label(states[0].contact.frame)
        told += states[0].ahead + frame.stretched
        title = titled(states[0].title, told, friction, scale.told)
        figure = paper(width, frame, f"{title}\n")
        charts = [cls(figure, LEFT + k * step, state, frame) for k, state in enumerate(states)]
        for chart in charts:
            chart.axes.set_title(chart.state.place, loc="center")
        for chart in charts[1:]:
            chart.axes.set_ylabel("")
            chart.axes.tick_params(labelleft=False)
        return figure, charts

    def _axes(self, left: float, width: float) -> Axes:
        """Axes as high as the map."""
        return placed(self.figure, left, BOTTOM, width, self.frame.height)

    def fill(self, values: np.ndarray, **style) -> QuadMesh:
        """Colour the contact by values at the elements, which may be anything outside."""
        every = slice(None, None, 1 + max(values.shape) // FINEST)
        x, y, values = self.state.x_over_a[every], self.state.y_over_a[every], values[every, every]
        style |= {"shading": "gouraud", "rasterized": True, "zorder": 0.5}
        mesh = self.axes.pcolormesh(x, y, values.T, **style)
        mesh.set_clip_path(self.contact, self.axes.transData)
        return mesh

    def fill_up_to_edge(self, values: np.ndarray, **style) -> QuadMesh:
        """Colour the contact by values that do not vanish at its edge."""
        return self.fill(continued(values, self.state.contact.touching), **style)

    def fill_zones(self, stick: str, slip: str) -> None:
        """Colour the zones of stick and of slip, up to the boundary between them."""
        fill_zones(self.axes, self.state, self.contact, (slip, stick))

    def stick_edge(self, **style) -> None:
        """Draw the boundary between stick and slip."""
        stick_edge(self.axes, self.state, self.contact, **style)

    def colour_bar(self, mesh: QuadMesh, label: str) -> None:
        """Put a colour bar beside the map."""
        beside = bar(self.figure, self.left + self.frame.width, BOTTOM, self.frame.height)
        self.figure.colorbar(mesh, cax=beside, label=label)
        power = beside.yaxis.get_offset_text()  # away from the map's title and the label
        power.set(x=0.5, horizontalalignment="center")

    def arrows(self, vectors: np.ndarray, where: np.ndarray, color: str) -> None:
        """Draw vectors, shape (2, n_x, n_y), at some elements; the longest spans their distance."""
        state, spacing = self.state, self.frame.spacing(ARROWS)
        longest = np.hypot(*vectors)[where].max(initial=0.0)
        if longest == 0.0:
            return
        across, along = (spacing * inch for inch in self.frame.inch)
        chosen = np.ix_(_every(state.x_over_a, across), _every(state.y_over_a, along))
        i, j = (index[where[chosen]] for index in np.broadcast_arrays(*chosen))
        self.axes.quiver(
            state.x_over_a[i],
            state.y_over_a[j],
            *vectors[:, i, j] * (0.85 * spacing / longest),
            color=color,
            pivot="mid",
            scale_units="inches",
            scale=1.0,
            units="inches",
            width=0.014,
            headwidth=4.0,
            headlength=4.5,
            headaxislength=4.0,
        )


def placed(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Axes at a place of a figure, inches."""
    whole_width, whole_height = figure.get_size_inches()
    box = left / whole_width, bottom / whole_height, width / whole_width, height / whole_height
    return figure.add_axes(box)


def bar(figure: Figure, right: float, bottom: float, height: float) -> Axes:
    """Axes for a colour bar beside a map that ends there, inches; beside a flat map they hang."""
    longer = max(height, SHORTEST_BAR)
    return placed(figure, right + BAR_GAP, bottom + height - longer, BAR, longer)


def paper(width: float, frame: Frame, title: str, below: float = 0.0) -> Figure:
    """Make a figure for maps of that frame under a title, of as many lines as it needs.

    Parameters
    ----------
    width : float
        Of the figure, inches.
    frame : Frame
        Of the maps.
    title : str
        Text, no math.
    below : float
        Room below the labels of the maps, inches.
    """
    height = below + BOTTOM + frame.height + TOP + LINE * (len(wrapped(title, width)) - 1)
    figure = Figure(figsize=(width, height), layout="none")
    set_title(figure, title, y=1 - 0.08 / height)
    return figure


def _narrow(frame: Frame) -> bool:
    """Whether below a map there is room for the name of its axis only."""
    return frame.width <= ROOM_TO_TELL


def _every(centres: np.ndarray, spacing: float) -> np.ndarray:
    """Indices of centres about that far apart, the same on both sides of the middle."""
    step = max(1, round(spacing / (centres[1] - centres[0])))
    return np.arange(len(centres) // 2 % step, len(centres), step)
