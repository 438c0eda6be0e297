"""Figures of heat and of friction that varies: temperature and local friction."""

from collections.abc import Mapping

import numpy as np

from tractive_sam.plot.contact_map import ContactMap
from tractive_sam.plot.contact_view import ContactView
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.line_contact import rolling_axes
from tractive_sam.plot.needs import Need
from tractive_sam.plot.registry import contact_figure
from tractive_sam.plot.style import LOOK
from tractive_sam.schema import required

_TEMPERATURE = r"temperature $T$ ($^\circ$C)"


def _surface_temperature(view: ContactView) -> Mapping[str, np.ndarray]:
    """Return the temperature of the surface of each body; figures that need it check it."""
    return required(view.contact.heat, "heat").temperature


def _temperature_over_x(view: ContactView) -> Figure:
    """Draw the temperature of both surfaces of a line contact."""
    figure, axes = rolling_axes("surface temperature", view)
    for body, style in (("A", "-"), ("B", "--")):
        values = _surface_temperature(view)[body][:, 0]
        axes.plot(view.x_over_a, values, style, label=f"body {body}")
    axes.set_ylabel(_TEMPERATURE)
    axes.legend()
    return figure


@contact_figure(
    "temperature",
    line=_temperature_over_x,
    needs=[
        Need(
            lambda view: view.contact.heat,
            "the temperature of a contact: add [heat] to the scene, and store the fields of "
            "the record",
        )
    ],
)
def temperature(view: ContactView) -> Figure:
    """Temperature of the surfaces: a map of A, or both surfaces of a line contact over x.

    Raises
    ------
    ValueError
        If the scene has no [heat].

    Examples
    --------
    >>> plot.temperature(ts.solve(ts.Scene.builtin("hot-discs")))
    <Figure size ...>
    """
    figure, chart = ContactMap.single(view, "surface temperature of A")
    chart.fill_surface(_surface_temperature(view)["A"], _TEMPERATURE, cmap=LOOK.slip)
    return figure


def _friction_in_use(view: ContactView) -> tuple[np.ndarray, str]:
    """Return the traction over the bound of static friction, and its label."""
    contact = view.contact
    used = np.divide(contact.utilisation, np.where(contact.touching, contact.pressure, 1.0))
    return used, r"$|p_t|/(\mu p_n)$" if view.isotropic else r"$\|p_t\|_\mu/p_n$"


def _friction_over_x(view: ContactView) -> Figure:
    """Draw the local coefficient of friction in use, in a line contact."""
    used, label = _friction_in_use(view)
    figure, axes = rolling_axes("friction in use", view)
    axes.plot(view.x_over_a, np.where(view.contact.touching, used, np.nan)[:, 0])
    axes.set(ylabel=label, ylim=(0.0, 1.05))
    return figure


@contact_figure("friction", line=_friction_over_x, shown=lambda view: view.contact.friction_varies)
def friction(view: ContactView) -> Figure:
    """Local coefficient of friction in use over the static one, ||p_t||_mu/p_n.

    In slip this is the factor by which speed, temperature and strength reduce friction.

    Examples
    --------
    >>> plot.friction(ts.solve(ts.Scene.builtin("hot-discs")))
    <Figure size ...>
    """
    used, label = _friction_in_use(view)
    figure, chart = ContactMap.single(view, "friction in use, dashed: end of stick")
    mesh = chart.fill_up_to_edge(used, cmap=LOOK.slip, vmin=0.0, vmax=1.0)
    chart.draw_stick_edge()
    chart.add_colour_bar(mesh, f"friction {label}")
    return figure
