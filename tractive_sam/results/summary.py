"""Contacts and histories in a few lines, and as tables with a picture for notebooks."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from tractive_sam.markup import Html, html_table

if TYPE_CHECKING:
    from tractive_sam.results.history import History
    from tractive_sam.results.state import State

WIDE, NARROW = 380, 230
"""Width of a picture, pixels."""

LAST = (
    ("Qx_over_P", "Qy_over_P", "p_max", "half_width_x", "half_width_y", "stick_fraction"),
    ("wear_max", "worn_mass A", "worn_mass B", "xi_x", "xi_y"),
)
"""Numbers of the last record: always, and where they are not zero."""


def of_contact(contact: "State") -> dict[str, str]:
    """What is told of a contact."""
    unit = contact.scene.contact_type.unit
    wide = {"a": contact.half_width_x, "b": contact.half_width_y}
    widths = [f"{name} = {half:.4g} mm" for name, half in wide.items() if math.isfinite(half)]
    at = f", revolution {contact.revolution}" if contact.revolution else ""
    return {
        "scene": (contact.scene.title or "no title") + at,
        "status": f"{contact.status}: {contact.message}",
        "forces": f"P = {contact.P:.4g}, Qx = {contact.Qx:.4g}, Qy = {contact.Qy:.4g} "
        f"{unit('N')}, Mz = {contact.Mz:.3g} {unit('N mm')}",
        "creepages": f"xi_x = {contact.xi_x:.4g}, xi_y = {contact.xi_y:.4g}, "
        f"spin = {contact.spin:.4g} /mm",
        "contact": f"{', '.join(widths)}, p_max = {contact.p_max:.4g} MPa, "
        f"{contact.stick_fraction:.0%} sticks",
        "mesh": contact.grid.describe_size(),
    }


def of_history(history: "History") -> dict[str, str]:
    """What is told of a history, numbers of its last record."""
    from tractive_sam.results.describe import numbers  # noqa: PLC0415 - which knows contacts itself

    along = history.coordinate
    rows = {
        "scene": history.title or "no title",
        "status": history.status + (f": {history.message}" if history.message else ""),
        "records": f"{len(history)}, {len(history.saved)} with fields",
    }
    if not len(history):
        return rows
    first, last = (format(history[along.name][k], along.format) for k in (0, -1))
    rows[along.name] = first if len(history) == 1 else f"{first} to {last}"
    told = {name: (value, one.unit) for name, value, one in numbers(history, -1)}
    always, others = LAST
    for name in (*always, *others):
        value, unit = told.get(name, ("nan", ""))
        if value not in ("nan", "none", "inf") and (name in always or value != "0"):
            rows[name] = value if unit == "1" else f"{value} {unit}"
    return rows


def shown(rows: Mapping[str, str], source: "State | History") -> Html:
    """What is told as a table, beside a figure."""
    return html_table(rows, _picture(source))


def _picture(source: Any) -> Html:
    """The figure that tells most of a contact or a history; none where nothing touches."""
    # What draws is above this room: it is taken from the package's own door, as a user does.
    import tractive_sam  # noqa: PLC0415

    plot = tractive_sam.plot
    try:
        if hasattr(source, "saved") and len(source) > 1:
            figure = plot.forces(source)
        elif source.grid.line:
            figure = plot.line_pressure(source)
        else:
            figure = plot.pressure(source)
    except (LookupError, ValueError):  # no fields, or nothing to draw
        return Html()
    return figure.in_html(WIDE if figure.get_figwidth() > figure.get_figheight() else NARROW)
