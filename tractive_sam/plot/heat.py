"""Figures of heat and of friction that varies: temperature, local friction, the traction curve."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle

import numpy as np
from matplotlib.patches import PathPatch
from numpy.typing import ArrayLike

from tractive_sam.plot.conditions import Need
from tractive_sam.plot.creep_force import MARKERS
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.line_contact import over_x
from tractive_sam.plot.map import Map
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.style import GREY, SLIP, VERMILLION, WIDTH, styled

Points = tuple[ArrayLike, ArrayLike]


_TEMPERATURE = r"temperature $T$ ($^\circ$C)"

_WARM = Need(
    lambda state: state.contact.heat,
    "the temperature of a contact: add [heat] to the scene, and keep the fields of the record",
)


def _temperature_over_x(state: Drawn) -> Figure:
    """Temperature of both surfaces of a line contact."""
    figure, axes = over_x("surface temperature", state)
    for body, style in (("A", "-"), ("B", "--")):
        values = state.contact.heat.temperature[body][:, 0]
        axes.plot(state.x_over_a, values, style, label=f"body {body}")
    axes.set_ylabel(_TEMPERATURE)
    axes.legend()
    return figure


@contact_figure("temperature", line=_temperature_over_x, needs=[_WARM])
def temperature(state: Drawn) -> Figure:
    """Temperature of the surfaces: a map of that of A, or of a line contact both over x.

    Raises
    ------
    ValueError
        If the scene has no [heat].

    Examples
    --------
    >>> plot.temperature(ts.solve(ts.Scene.builtin("hot-discs")))
    <Figure size ...>
    """
    figure, chart = Map.single(state, "surface temperature of A")
    mesh = chart.axes.pcolormesh(
        state.x_over_a,
        state.y_over_a,
        state.contact.heat.temperature["A"].T,
        cmap=SLIP,
        shading="gouraud",
    )
    # It is cold, and dark, around.
    white = {"fill": False, "edgecolor": "white", "linewidth": 1.0, "zorder": 5}
    chart.axes.add_patch(PathPatch(chart.contact, **white))
    chart.colour_bar(mesh, _TEMPERATURE)
    return figure


def _friction_in_use(state: Drawn) -> tuple[np.ndarray, str]:
    """Traction over what the coefficient at rest allows, and its label."""
    contact = state.contact
    used = np.divide(contact.utilisation, np.where(contact.touching, contact.pressure, 1.0))
    return used, r"$|p_t|/(\mu p_n)$" if state.isotropic else r"$\|p_t\|_\mu/p_n$"


def _friction_over_x(state: Drawn) -> Figure:
    """Local coefficient of friction in use, in a line contact."""
    used, label = _friction_in_use(state)
    figure, axes = over_x("friction in use", state)
    axes.plot(state.x_over_a, np.where(state.contact.touching, used, np.nan)[:, 0])
    axes.set_ylabel(label)
    axes.set_ylim(0.0, 1.05)
    return figure


@contact_figure(
    "friction", line=_friction_over_x, shown=lambda state: state.contact.friction_varies
)
def friction(state: Drawn) -> Figure:
    """Local coefficient of friction in use over that at rest, ||p_t||_mu/p_n.

    Where the contact slips it is what speed, temperature and strength leave of friction.

    Examples
    --------
    >>> plot.friction(ts.solve(ts.Scene.builtin("hot-discs")))
    <Figure size ...>
    """
    used, label = _friction_in_use(state)
    figure, chart = Map.single(state, "friction in use, dashed: end of stick")
    mesh = chart.fill_up_to_edge(used, cmap=SLIP, vmin=0.0, vmax=1.0)
    chart.stick_edge(colors="white", linewidths=1.2, linestyles="--")
    chart.colour_bar(mesh, f"friction {label}")
    return figure


@styled
def traction_curve(computed: Mapping[str, Points], printed: Points | None = None) -> Figure:
    """Force over load against creepage, each curve with its top marked.

    Parameters
    ----------
    computed : mapping of str to pair of array_like
        Name of a curve, its creepages and its Q_x/P.
    printed : pair of array_like, optional
        Points of another program.

    Examples
    --------
    >>> curve = ([0.0, 0.01, 0.016, 0.05], [0.0, 0.301, 0.312, 0.285])
    >>> plot.traction_curve({"falling": curve})
    <Figure size ...>
    """
    figure = Figure(figsize=(WIDTH, 0.72 * WIDTH))
    axes = figure.add_subplot()
    for marker, (name, (xi, force)) in zip(cycle(MARKERS), computed.items(), strict=False):
        percent, share = 100.0 * np.asarray(xi), np.asarray(force)
        (line,) = axes.plot(percent, share, marker + "-", ms=3, label=name)
        top = int(np.argmax(share))
        if share[top] > 1.001 * share[-1]:
            told = f"top {share[top]:.3f} at {percent[top]:.2g} %"
            spot = {"xytext": (8, -34), "textcoords": "offset points", "color": line.get_color()}
            axes.annotate(told, (percent[top], share[top]), **spot)
    if printed is not None:
        style = {"color": GREY, "mec": VERMILLION, "ms": 6, "label": "CONTACT 25.1, printed"}
        axes.plot(100.0 * np.asarray(printed[0]), printed[1], "x", **style)
    axes.set(xlabel=r"creepage $|\xi_x|$ (%)", ylabel=r"$Q_x/P$")
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0, top=1.12 * max(np.max(force) for _, force in computed.values()))
    axes.legend(loc="lower right")
    return figure
