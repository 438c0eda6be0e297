"""Conditions that a history or a contact has to meet so that a figure can be drawn."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from tractive_sam.plot.contact_view import ContactView
from tractive_sam.results import History


@dataclass(frozen=True)
class Need:
    """Condition on a history or contact without which a figure cannot be drawn.

    Attributes
    ----------
    holds : callable
        Whether the `History`, or the `ContactView` of a figure of one contact, meets it.
    text : str
        The need and how to meet it: the end of "it needs ...".

    Examples
    --------
    >>> wide = plot.Need(lambda history: len(history.y) > 1, "elements across the track")
    >>> wide.holds(history)
    True
    """

    holds: Callable[[Any], bool]
    text: str

    def check(self, subject: ContactView | History) -> None:
        """Raise a ValueError if the condition is not met."""
        if not self.holds(subject):
            refuse("", [self.text])


WIDE = Need(
    lambda subject: len(subject.y) > 1,
    "elements across the track; this is a line contact: use line_pressure, line_traction, "
    "line_slip or line_pressures",
)
"""Need of maps, and of functions of y."""

SINGLE_ROW = Need(
    lambda subject: len(subject.y) == 1,
    "a single row of elements; this is no line contact: use pressure, traction or stick_slip_map",
)
"""Need of functions of x that do not depend on y."""


def refuse(name: str, missing: Iterable[str]) -> NoReturn:
    """Raise a ValueError that lists what a figure lacks."""
    figure = f"the figure {name}".strip()
    raise ValueError(f"{figure} cannot be drawn: it needs {'; '.join(missing)}")


def check_touching(views: Iterable[ContactView]) -> None:
    """Raise a ValueError if the bodies touch in none of several contacts."""
    if not any(view.contact.touching.any() for view in views):
        raise ValueError("nothing to draw: the bodies do not touch")


def has_traction(view: ContactView) -> bool:
    """Return whether a contact has tangential tractions."""
    return bool(view.contact.traction.any())


def touching_records(history: History) -> list[float]:
    """Return the coordinates of the first and last stored record with contact; [] with blocks.

    A single record is returned even without contact: its figures report that there is nothing to
    draw. A duty cycle has none: its records have a contact for each block.
    """
    stored = [] if history.block_names else history.saved.tolist()
    if len(history) == 1:
        return stored

    def touches(at: float) -> bool:
        return bool(history.field("pressure", at).any())

    ends = (next(filter(touches, places), None) for places in (stored, stored[::-1]))
    return [*dict.fromkeys(at for at in ends if at is not None)]


def has_course(history: History) -> bool:
    """Return whether a history has several records that follow each other."""
    return len(history) > 1 and history.scene.schedule.in_sequence


def has_contacts(history: History) -> bool:
    """Return whether several records have stored contacts, and bodies touch in one."""
    return len(history.saved) > 1 and bool(touching_records(history))


def is_worn(history: History) -> bool:
    """Return whether a history has any wear."""
    return bool(np.nan_to_num(history["wear_max"]).any())


def has_worn_contacts(history: History) -> bool:
    """Return whether a history has wear, and several stored contacts."""
    return is_worn(history) and len(history.saved) * max(1, len(history.block_names)) > 1
