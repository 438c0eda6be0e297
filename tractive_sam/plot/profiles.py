"""Functions of y, one line for each stored record."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from tractive_sam.description import math_label
from tractive_sam.plot.contact_view import select_evenly
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.line_contact import line_pressures
from tractive_sam.plot.needs import WIDE, Need, has_contacts, has_worn_contacts
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import LOOK, MICRON, history_title, new_axes
from tractive_sam.results import BODIES, History


@history_figure("wear-profiles", needs=[WIDE], shown=has_worn_contacts)
def wear_depth_profiles(history: History) -> Figure:
    """Wear depth of both bodies together across the track, at up to eight stored revolutions.

    Examples
    --------
    >>> plot.wear_depth_profiles(history)
    <Figure size ...>
    """
    figure, axes = lateral_axes(history, "wear of both bodies together")
    depth = _profiles_by_coordinate(history, "wear_profile")
    _draw_records(axes, history, lambda at: MICRON * depth[at])
    axes.invert_yaxis()
    axes.set_ylabel(r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure


def _measured_body(history: History) -> str:
    """Return the body to which a measured gap belongs; empty if there is none."""
    gap = history.scene.gap
    if gap is None or np.isnan(history["measured_profile"]).any():  # a file without it
        return ""
    return gap.body or "A"


def _is_worn_evenly(history: History) -> bool:
    """Return whether several contacts are stored and wear is equal around the circumference."""
    worn = (history["wear_profile"] > 0.0).any()
    evenly = np.isfinite(history["wear_per_revolution"]).any()
    return has_worn_contacts(history) and bool(worn and evenly)


@history_figure(
    "worn-profiles",
    needs=[
        WIDE,
        Need(
            lambda history: (history["wear_profile"] > 0.0).any() or bool(_measured_body(history)),
            "wear, or a measured [gap]",
        ),
    ],
    shown=_is_worn_evenly,
)
def worn_profiles(history: History, margin: float = 0.15) -> Figure:
    """Undeformed cross sections of both bodies across the track, at up to eight revolutions.

    A is above B, and they touch before they wear. The heights contain the radii R_y, the wear depth
    of each body, and a measured [gap] at x = 0: on its body, or else on A. They are exaggerated.

    Parameters
    ----------
    history : History
        History with wear or a measured gap.
    margin : float
        Margin on each side of the worn track, over its half width.

    Raises
    ------
    ValueError
        If nothing is worn or measured.

    Examples
    --------
    >>> plot.worn_profiles(history)
    <Figure size ...>
    """
    worn_at = history.y[(history["wear_profile"] > 0.0).any(axis=0)]
    figure, axes = lateral_axes(history, "sections of the bodies")
    y = history.y / Scale.from_history(history).across
    # Of unworn bodies twice the half width of the contact is shown.
    half = np.abs(worn_at).max() if worn_at.size else 2.0 * history["half_width_y"].max()
    shown = np.abs(history.y) <= (1.0 + margin) * half
    surfaces = {body: _surface_heights(history, body) for body in BODIES}
    _draw_records(axes, history, *(surfaces[body].__getitem__ for body in BODIES))
    last = history.saved[-1].item()
    selected = [heights[at] for heights in surfaces.values() for at in (0, last) if at in heights]
    heights = np.array(selected)[:, shown]
    space = 0.12 * np.ptp(heights)
    ends = {"A": heights.max() + space, "B": heights.min() - space}
    for body, end in ends.items():
        look: dict[str, Any] = {"color": LOOK.grey, "alpha": 0.12, "linewidth": 0.0}
        axes.fill_between(y, surfaces[body][last], end, **look)
        name = f"{body}, with the measured profile" if body == _measured_body(history) else body
        place, align = (0.96, "top") if body == "A" else (0.04, "bottom")
        axes.text(0.02, place, name, transform=axes.transAxes, fontsize="large", va=align)
    axes.set(xlim=(y[shown].min(), y[shown].max()), ylim=(ends["B"], ends["A"]))
    axes.set_ylabel(r"height $z$ ($\mathrm{\mu m}$)")
    return figure


@history_figure(
    "profiles", needs=[WIDE], columns=["measured_profile"], shown=lambda history: len(history) == 1
)
def _measured_profiles(history: History) -> Figure:
    """Cross sections of both bodies across the track, with the measured profile."""
    return worn_profiles(history)


def _surface_heights(history: History, body: str) -> dict[float, np.ndarray]:
    """Return heights (n_y,) of a body's surface, micrometres, by the coordinate of each record."""
    upwards = 1.0 if body == "A" else -1.0
    crowns = {b: history.y**2 / (2.0 * getattr(history.scene.body, b).radius_y) for b in BODIES}
    crown = crowns[body]
    if body == _measured_body(history):
        measured = _profiles_by_coordinate(history, "measured_profile")[history.saved[-1].item()]
        crown = crown + measured - (measured + sum(crowns.values())).min()  # as they touch
    depth = _profiles_by_coordinate(history, f"wear_profile_{body}")
    return {at: upwards * MICRON * (crown + worn) for at, worn in depth.items()}


@history_figure("pressure-profiles", line=line_pressures, shown=has_contacts)
def pressure_profiles(history: History) -> Figure:
    """Largest pressure over x at each y, for up to eight of the stored revolutions.

    Examples
    --------
    >>> plot.pressure_profiles(history)
    <Figure size ...>
    """
    figure, axes = lateral_axes(history, "peak pressure in each row")
    scale = Scale.from_history(history)
    _draw_records(
        axes, history, lambda at: history.field("pressure", at).max(axis=0) / scale.pressure
    )
    axes.set(ylim=(0.0, None), ylabel=scale.pressure_label(r"\max_x\, p_n"))
    return figure


def lateral_axes(history: History, quantity: str) -> tuple[Figure, Axes]:
    """Return a figure and its axes over y, the position across the track."""
    scale = Scale.from_history(history)
    figure, axes = new_axes(1.25, 0.7, history_title(history, quantity, scale.note))
    axes.set_xlabel(scale.length_label("y", across=True))
    return figure, axes


def _profiles_by_coordinate(history: History, name: str) -> dict[float, np.ndarray]:
    """Return the values (n_y,) of a profile column by the coordinate of each record."""
    return dict(zip(history[history.coordinate.name].tolist(), history[name], strict=True))


def _draw_records(axes: Axes, history: History, *functions: Callable[[float], np.ndarray]) -> None:
    """Draw functions of the coordinate over y at up to eight stored records, later ones darker."""
    y = history.y / Scale.from_history(history).across
    places = select_evenly(history.saved).tolist()
    shades = colormaps["viridis_r"](np.linspace(0.08, 1.0, len(places)))
    for at, shade in zip(places, shades, strict=True):
        lines = axes.plot(y, np.transpose([function(at) for function in functions]), color=shade)
        lines[0].set_label(format(at, history.coordinate.format))
    axes.set_xlim(y.min(), y.max())
    if len(places) > 1:
        title = math_label(history.coordinate)
        axes.figure.legend(title=title, loc="outside right center")
