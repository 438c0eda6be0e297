"""Figures of one contact: pressure, traction, stick and slip, wear.

Each function takes a `ContactView`, a solved `State`, or a `History` and one of its `saved` values,
also by the name of its coordinate: ``revolution=2`` (the last by default). For line contacts,
functions of x replace the maps of pressure and traction.
"""

from typing import Any

import numpy as np
from matplotlib.patches import Patch

from tractive_sam.plot.contact_map import ContactMap
from tractive_sam.plot.contact_view import ContactView
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.line_contact import line_pressure, line_traction
from tractive_sam.plot.needs import WIDE, has_traction
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.style import LOOK, MICRON
from tractive_sam.schema import required


@contact_figure("pressure", line=line_pressure)
def pressure(view: ContactView) -> Figure:
    """Map of the contact pressure p_n.

    Examples
    --------
    >>> plot.pressure(contact)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "contact pressure")
    mesh = chart.fill(view.contact.pressure / view.scale.pressure, cmap=LOOK.pressure, vmin=0.0)
    chart.add_colour_bar(mesh, f"contact pressure {view.scale.pressure_label('p_n')}")
    return figure


@contact_figure("traction", line=line_traction, shown=has_traction)
def traction(view: ContactView) -> Figure:
    """Map of the traction ||p_t||_mu on body A, its directions, and the edge of stick.

    With isotropic friction this is |p_t|/mu.

    Examples
    --------
    >>> plot.traction(contact)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "traction on A, dashed: end of stick")
    mesh = chart.fill(view.contact.utilisation / view.scale.pressure, cmap=LOOK.traction, vmin=0.0)
    chart.draw_stick_edge()
    chart.draw_arrows(view.contact.traction, view.contact.touching, color="white")
    symbol = r"|p_t|/\mu" if view.isotropic else r"\|p_t\|_\mu"
    chart.add_colour_bar(mesh, f"traction over friction {view.scale.pressure_label(symbol)}")
    return figure


@contact_figure("stick-slip", needs=[WIDE], shown=has_traction)
def stick_slip_map(view: ContactView) -> Figure:
    """Map of the zones of stick and slip, and the directions of the slip of A over B.

    The percentages count all elements. The steps of the leading edge, which slip because the
    traction bound nearly vanishes there, have the colour of the zone behind them.

    Examples
    --------
    >>> plot.stick_slip_map(history, revolution=0)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "stick, and slip of A over B")
    chart.fill_zones(LOOK.sky, LOOK.orange)
    chart.draw_arrows(view.contact.slip, view.slip_zone, color="black")
    sliding = np.count_nonzero(view.contact.sliding) / np.count_nonzero(view.contact.touching)
    stick = Patch(color=LOOK.sky, label=f"stick, {1 - sliding:.0%}")
    slip = Patch(color=LOOK.orange, label=f"slip, {sliding:.0%}")
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.02)}
    chart.axes.legend(handles=[stick, slip], handlelength=1.0, **place)
    return figure


@contact_figure("wear", needs=[WIDE], shown=lambda view: bool(view.contact.wear.any()))
def wear_map(view: ContactView) -> Figure:
    """Map of the wear depth of both bodies together, in the contact.

    Examples
    --------
    >>> plot.wear_map(history)
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "wear of both bodies together")
    mesh = chart.fill_up_to_edge(MICRON * view.contact.wear, cmap=LOOK.wear)
    chart.add_colour_bar(mesh, r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure


def _stored_fields(view: ContactView) -> list[dict[str, str]]:
    """Return the name of each field of an observer of the history, as arguments of its figure."""
    return [] if view.history is None else [{"field": k} for k in view.history.user_fields]


@contact_figure("{field}", needs=[WIDE], each=_stored_fields)
def _observed_field(view: ContactView, field: str) -> Figure:
    """Map of a field that an observer of the scene computes, for example of a displacement."""
    history = required(view.history, "history")
    quantity = history.user_fields[field]
    figure, chart = ContactMap.single(view, quantity.long_name)
    label = f"{field} ({quantity.unit})"
    chart.fill_surface(history.field(field, view.at), label, cmap=LOOK.pressure)
    return figure
