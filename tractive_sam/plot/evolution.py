"""Maps side by side, one for each stored record."""

from collections.abc import Callable

import numpy as np

from tractive_sam.plot.contact_map import ContactMap
from tractive_sam.plot.contact_view import ContactView, select_evenly
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.needs import WIDE, has_contacts, has_worn_contacts
from tractive_sam.plot.registry import history_figure
from tractive_sam.plot.style import LOOK, MICRON
from tractive_sam.results import History


@history_figure("pressure-over-{coordinate}", needs=[WIDE], shown=has_contacts)
def pressure_over_revolutions(history: History) -> Figure:
    """Maps of the contact pressure p_n/p_0, one for each of up to six stored revolutions.

    Examples
    --------
    >>> plot.pressure_over_revolutions(history)
    <Figure size ...>
    """

    def pressure(view: ContactView) -> np.ndarray:
        return view.contact.pressure / view.scale.pressure

    charts, highest = _map_row(history, "contact pressure", pressure)
    for chart in charts:
        mesh = chart.fill(pressure(chart.view), cmap=LOOK.pressure, vmin=0.0, vmax=highest)
    label = f"contact pressure {chart.view.scale.pressure_label('p_n')}"
    chart.add_colour_bar(mesh, label)
    return chart.figure


def _has_slip_of_one_unit(history: History) -> bool:
    """Return whether all stored contacts roll or all shift, so that their slips have one unit."""
    schedule = history.scene.schedule
    kinds = {schedule.shifts_at(place) for place in history.saved}
    return has_contacts(history) and len(kinds) == 1


@history_figure("slip-over-{coordinate}", needs=[WIDE], shown=_has_slip_of_one_unit)
def slip_over_revolutions(history: History) -> Figure:
    """Maps of the slip |s|/V (|s| in shifts) and the edge of stick, for up to six revolutions.

    Examples
    --------
    >>> plot.slip_over_revolutions(history)
    <Figure size ...>
    """

    def slip(view: ContactView) -> np.ndarray:
        return np.hypot(*view.contact.slip)

    shifts = all(map(history.scene.schedule.shifts_at, history.saved))
    quantity, symbol = (
        ("slip of the step", "$|s|$ (mm)") if shifts else ("slip over speed", "$|s|/V$")
    )
    charts, highest = _map_row(history, quantity, slip)
    for chart in charts:
        mesh = chart.fill_up_to_edge(slip(chart.view), cmap=LOOK.slip, vmin=0.0, vmax=highest)
        chart.draw_stick_edge()
    chart.add_colour_bar(mesh, f"{quantity} {symbol}")
    return chart.figure


@history_figure(
    "wear-over-{coordinate}",
    needs=[WIDE],
    shown=lambda history: has_worn_contacts(history) and has_contacts(history),
)
def wear_over_revolutions(history: History) -> Figure:
    """Maps of the wear depth of both bodies together, for up to six of the stored revolutions.

    Examples
    --------
    >>> plot.wear_over_revolutions(history)
    <Figure size ...>
    """

    def wear(view: ContactView) -> np.ndarray:
        return MICRON * view.contact.wear

    charts, highest = _map_row(history, "wear depth", wear)
    for chart in charts:
        mesh = chart.fill_up_to_edge(wear(chart.view), cmap=LOOK.wear, vmin=0.0, vmax=highest)
    chart.add_colour_bar(mesh, r"wear depth $w$ ($\mathrm{\mu m}$)")
    return chart.figure


def _map_row(
    history: History, quantity: str, values: Callable[[ContactView], np.ndarray], count: int = 6
) -> tuple[list[ContactMap], float]:
    """Return maps of at most `count` stored contacts, and the largest value in them."""
    views = [ContactView.from_source(history, at) for at in select_evenly(history.saved, count)]
    views = [view for view in views if view.contact.touching.any()] or views
    _, charts = ContactMap.row(views, quantity)
    return charts, float(max(values(view)[view.contact.touching].max() for view in views))
