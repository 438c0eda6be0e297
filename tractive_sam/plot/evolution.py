"""Maps side by side, one for each stored revolution."""

from collections.abc import Callable

import numpy as np

from tractive_sam.plot.conditions import WIDE, in_pictures, worn_in_pictures
from tractive_sam.plot.drawn import Drawn, chosen
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.map import Map
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.style import MICRON, PRESSURE, SLIP, WEAR
from tractive_sam.results import History

MOST = 6
"""Maps of a figure; of more revolutions some are left out."""


@history_figure("pressure-over-{coordinate}", needs=[WIDE], shown=in_pictures)
def pressure_over_revolutions(history: History) -> Figure:
    """Pressure p_n/p_0 at the stored revolutions.

    Examples
    --------
    >>> plot.pressure_over_revolutions(history)
    <Figure size ...>
    """
    return _maps(history, _pressure, "contact pressure", "p_n", PRESSURE, Map.fill)


@history_figure("slip-over-{coordinate}", needs=[WIDE], shown=in_pictures)
def slip_over_revolutions(history: History) -> Figure:
    """Slip |s|/V at the stored revolutions, of shifts |s| in the step, with the edge of stick.

    Examples
    --------
    >>> plot.slip_over_revolutions(history)
    <Figure size ...>
    """
    shifts = history.scene.schedule.shifts
    told = ("slip of the step", "$|s|$ (mm)") if shifts else ("slip over speed", "$|s|/V$")
    return _maps(history, _slip, *told, SLIP, Map.fill_up_to_edge, True)


@history_figure(
    "wear-over-{coordinate}",
    needs=[WIDE],
    shown=lambda history: worn_in_pictures(history) and in_pictures(history),
)
def wear_over_revolutions(history: History) -> Figure:
    """Wear depth of both bodies together, in the contact, at the stored revolutions.

    Examples
    --------
    >>> plot.wear_over_revolutions(history)
    <Figure size ...>
    """
    return _maps(history, _wear, "wear depth", r"$w$ ($\mathrm{\mu m}$)", WEAR, Map.fill_up_to_edge)


def _maps(
    history: History,
    values: Callable[[Drawn], np.ndarray],
    told: str,
    symbol: str,
    colours: str,
    fill: Callable,
    stick: bool = False,
) -> Figure:
    states = [Drawn.of(history, at) for at in chosen(history.saved, MOST)]
    states = [state for state in states if state.contact.touching.any()] or states
    figure, charts = Map.row(states, told)
    highest = max(values(state)[state.contact.touching].max() for state in states)
    for chart in charts:
        mesh = fill(chart, values(chart.state), cmap=colours, vmin=0.0, vmax=highest)
        if stick:
            chart.stick_edge(colors="white", linewidths=1.2, linestyles="--")
    label = symbol if "$" in symbol else states[0].scale.of_pressure(symbol)
    charts[-1].colour_bar(mesh, f"{told} {label}")
    return figure


def _pressure(state: Drawn) -> np.ndarray:
    return state.contact.pressure / state.scale.pressure


def _slip(state: Drawn) -> np.ndarray:
    return np.hypot(*state.contact.slip)


def _wear(state: Drawn) -> np.ndarray:
    return MICRON * state.contact.wear
