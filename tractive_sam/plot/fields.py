"""Figures of one state: pressure, traction, stick and slip, wear.

Each is called with a `Drawn`, a solved `State`, or a `History` and one of its `saved` values, also
by the name of its coordinate, ``revolution=2`` (the last by default). Line contacts have functions
of x in place of the maps of pressure and traction.
"""

import numpy as np
from matplotlib.patches import Patch

from tractive_sam.plot.conditions import WIDE, driven
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.line_contact import line_pressure, line_traction
from tractive_sam.plot.map import Map
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.style import MICRON, ORANGE, PRESSURE, SKY, TRACTION, WEAR


@contact_figure("pressure", line=line_pressure)
def pressure(state: Drawn) -> Figure:
    """Map of the pressure.

    Examples
    --------
    >>> plot.pressure(contact)
    <Figure size ...>
    """
    figure, chart = Map.single(state, "contact pressure")
    mesh = chart.fill(state.contact.pressure / state.scale.pressure, cmap=PRESSURE, vmin=0.0)
    chart.colour_bar(mesh, f"contact pressure {state.scale.of_pressure('p_n')}")
    return figure


@contact_figure("traction", line=line_traction, shown=driven)
def traction(state: Drawn) -> Figure:
    """Map of the traction ||p_t||_mu on body A, its directions, and the edge of stick.

    Where friction is isotropic that is |p_t|/mu.

    Examples
    --------
    >>> plot.traction(contact)
    <Figure size ...>
    """
    figure, chart = Map.single(state, "traction on A, dashed: end of stick")
    mesh = chart.fill(state.contact.utilisation / state.scale.pressure, cmap=TRACTION, vmin=0.0)
    chart.stick_edge(colors="white", linewidths=1.2, linestyles="--")
    chart.arrows(state.contact.traction, state.contact.touching, color="white")
    symbol = r"|p_t|/\mu" if state.isotropic else r"\|p_t\|_\mu"
    chart.colour_bar(mesh, f"traction over friction {state.scale.of_pressure(symbol)}")
    return figure


@contact_figure("stick-slip", needs=[WIDE], shown=driven)
def stick_slip_map(state: Drawn) -> Figure:
    """Map of the zones of stick and slip, and the directions of the slip of A over B.

    The shares are those of all elements; the steps of the leading edge, which slip where friction
    can carry next to nothing, are coloured as the zone behind them.

    Examples
    --------
    >>> plot.stick_slip_map(history, revolution=0)
    <Figure size ...>
    """
    figure, chart = Map.single(state, "stick, and slip of A over B")
    chart.fill_zones(SKY, ORANGE)
    chart.arrows(state.contact.slip, state.slip_zone, color="black")
    sliding = np.count_nonzero(state.contact.sliding) / np.count_nonzero(state.contact.touching)
    chart.axes.legend(
        handles=[
            Patch(color=SKY, label=f"stick, {1 - sliding:.0%}"),
            Patch(color=ORANGE, label=f"slip, {sliding:.0%}"),
        ],
        loc="upper left",
        bbox_to_anchor=(1.0, 1.02),
        handlelength=1.0,
    )
    return figure


@contact_figure("wear", needs=[WIDE], shown=lambda state: bool(state.contact.wear.any()))
def wear_map(state: Drawn) -> Figure:
    """Map of the wear depth of both bodies together, in the contact.

    Examples
    --------
    >>> plot.wear_map(history)
    <Figure size ...>
    """
    figure, chart = Map.single(state, "wear of both bodies together")
    mesh = chart.fill_up_to_edge(MICRON * state.contact.wear, cmap=WEAR)
    chart.colour_bar(mesh, r"wear depth $w$ ($\mathrm{\mu m}$)")
    return figure
