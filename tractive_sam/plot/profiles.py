"""Functions of y, one line for each record that kept its fields."""

from collections.abc import Callable

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from tractive_sam.plot.conditions import WIDE, Need, in_pictures, worn_in_pictures
from tractive_sam.plot.drawn import chosen
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.line_contact import line_pressures
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import GREY, MICRON, WIDTH, set_title, symbol_of, told_of
from tractive_sam.results import History

BESIDE = 0.15
"""Shown on either side of the worn track, over its half width."""

UNWORN = 2.0
"""Shown of bodies that do not wear, over the half width of the contact."""


@history_figure("wear-profiles", needs=[WIDE], shown=worn_in_pictures)
def wear_profiles(history: History) -> Figure:
    """Wear depth of both bodies together across the track, at the stored revolutions.

    Examples
    --------
    >>> plot.wear_profiles(history)
    <Figure size ...>
    """
    figure, axes = across(history, "wear of both bodies together")
    depth = _stored(history, "wear_profile")
    _lines(axes, history, lambda N: MICRON * depth[N])
    axes.invert_yaxis()
    axes.set_ylabel(r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure


def _measured_body(history: History) -> str:
    """The body on which the measured gap is drawn; none where there is none."""
    gap = history.scene.gap
    if gap is None or np.isnan(history["measured_profile"]).any():  # a file that lacks it
        return ""
    return gap.body or "A"


_UNEVEN = Need(
    lambda history: (history["wear_profile"] > 0.0).any() or bool(_measured_body(history)),
    "wear, or a measured [gap]",
)


def _same_all_around(history: History) -> bool:
    """Whether worn sections are the same all around the bodies: not along a course."""
    all_around = np.isfinite(history["wear_per_revolution"]).any()
    return worn_in_pictures(history) and (history["wear_profile"] > 0.0).any() and all_around


@history_figure("worn-profiles", needs=[WIDE, _UNEVEN], shown=_same_all_around)
def worn_profiles(history: History) -> Figure:
    """Cross sections of both bodies across the track, undeformed, at the stored revolutions.

    A above B, as they touch before they wear: the radii R_y, the depth worn off each and a measured
    [gap] at x = 0, on the body that it is of, else on A. Heights are exaggerated.

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
    figure, axes = across(history, "sections of the bodies")
    y = history.y / Scale.of_history(history).across
    half = np.abs(worn_at).max() if worn_at.size else UNWORN * history["half_width_y"].max()
    shown = np.abs(history.y) <= (1.0 + BESIDE) * half
    surfaces = {body: _surfaces(history, body) for body in "AB"}
    _lines(axes, history, *(lambda N, one=one: one[N] for one in surfaces.values()))
    last = history.saved[-1].item()
    heights = np.array([one[N][shown] for one in surfaces.values() for N in (0, last) if N in one])
    margin = 0.12 * np.ptp(heights)
    ends = {"A": heights.max() + margin, "B": heights.min() - margin}
    for body, end in ends.items():
        axes.fill_between(y, surfaces[body][last], end, color=GREY, alpha=0.12, linewidth=0.0)
        place = {"va": "top", "y": 0.96} if body == "A" else {"va": "bottom", "y": 0.04}
        name = f"{body}, with the measured profile" if body == _measured_body(history) else body
        axes.text(x=0.02, s=name, transform=axes.transAxes, fontsize=13, **place)
    axes.set(xlim=(y[shown].min(), y[shown].max()), ylim=(ends["B"], ends["A"]))
    axes.set_ylabel(r"height $z$ ($\mathrm{\mu m}$)")
    return figure


@history_figure(
    "profiles", needs=[WIDE], columns=["measured_profile"], shown=lambda history: len(history) == 1
)
def _measured_profiles(history: History) -> Figure:
    """Cross sections of both bodies across the track, with the measured profile."""
    return worn_profiles(history)


def _surfaces(history: History, body: str) -> dict[float, np.ndarray]:
    """Height of the surface of a body at every record, micrometres, shape (n_y,)."""
    upwards = 1.0 if body == "A" else -1.0
    crowns = {b: history.y**2 / (2.0 * getattr(history.scene.body, b).radius_y) for b in "AB"}
    crown = crowns[body]
    if body == _measured_body(history):
        measured = _stored(history, "measured_profile")[history.saved[-1].item()]
        crown = crown + measured - (measured + sum(crowns.values())).min()  # as they touch
    depth = _stored(history, f"wear_profile_{body}")
    return {N: upwards * MICRON * (crown + worn) for N, worn in depth.items()}


@history_figure("pressure-profiles", line=line_pressures, shown=in_pictures)
def pressure_profiles(history: History) -> Figure:
    """Largest pressure in every row along the rolling direction, at the stored revolutions.

    Examples
    --------
    >>> plot.pressure_profiles(history)
    <Figure size ...>
    """
    figure, axes = across(history, "peak pressure in each row")
    scale = Scale.of_history(history)
    _lines(axes, history, lambda N: history.field("pressure", N).max(axis=0) / scale.pressure)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(scale.of_pressure(r"\max_x\, p_n"))
    return figure


def across(history: History, told: str) -> tuple[Figure, Axes]:
    """An empty figure over the place across the track."""
    figure = Figure(figsize=(1.25 * WIDTH, 0.7 * WIDTH))
    axes = figure.add_subplot()
    scale = Scale.of_history(history)
    axes.set_xlabel(scale.of_length("y", across=True))
    set_title(figure, told_of(history, told, scale.told))
    return figure, axes


def _stored(history: History, name: str) -> dict[float, np.ndarray]:
    """A function of y of every record, by the coordinate."""
    return dict(zip(history[history.coordinate.name].tolist(), history[name], strict=True))


def _lines(axes: Axes, history: History, *values: Callable[[float], np.ndarray]) -> None:
    """Draw values(coordinate), from light to dark in its order."""
    y = history.y / Scale.of_history(history).across
    places = chosen(history.saved).tolist()
    shades = colormaps["viridis_r"](np.linspace(0.08, 1.0, len(places)))
    for at, shade in zip(places, shades, strict=True):
        lines = axes.plot(y, np.transpose([of(at) for of in values]), color=shade)
        lines[0].set_label(format(at, history.coordinate.format))
    axes.set_xlim(y.min(), y.max())
    if len(places) > 1:
        axes.figure.legend(title=symbol_of(history.coordinate), loc="outside right center")
