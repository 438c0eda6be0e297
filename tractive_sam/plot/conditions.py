"""Conditions of figures: what a history or a contact has to contain for them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from tractive_sam.plot.drawn import Drawn
from tractive_sam.results import History


@dataclass(frozen=True)
class Need:
    """A condition on the history or the contact that a figure draws.

    Attributes
    ----------
    holds : callable
        Whether the `History`, or the `Drawn` of a figure of one contact, meets it.
    text : str
        What is needed, and how to get it: the end of "it needs ...".

    Examples
    --------
    >>> wide = plot.Need(lambda history: len(history.y) > 1, "elements across the track")
    >>> wide.holds(history)
    True
    """

    holds: Callable[[Any], bool]
    text: str

    def check(self, subject: Drawn | History) -> None:
        """Raise ValueError where the condition is not met."""
        if not self.holds(subject):
            refuse("", [self.text])


WIDE = Need(
    lambda subject: len(subject.y) > 1,
    "elements across the track; this is a line contact, which line_pressure, line_traction, "
    "line_slip and line_pressures draw",
)
"""Of maps, and of functions of y."""

ONE_ROW = Need(
    lambda subject: len(subject.y) == 1,
    "a single row of elements; this is no line contact: pressure, traction and stick_slip_map "
    "draw it",
)
"""Of functions of x that are the same for all y."""


def refuse(name: str, missing: Iterable[str]) -> NoReturn:
    """Raise ValueError with what a figure needs."""
    raise ValueError(
        f"the figure {name}".strip() + f" cannot be drawn: it needs {'; '.join(missing)}"
    )


def driven(state: Drawn) -> bool:
    """Return whether there are tractions."""
    return bool(state.contact.traction.any())


def touching_records(history: History) -> list[float]:
    """Return the first and the last stored record in which the bodies touch; of one record itself.

    None of a duty cycle, whose records have a contact for each block.
    """
    stored = [] if history.block_names else history.saved.tolist()
    if len(history) == 1:
        return stored  # without contact its figures tell that there is nothing to draw

    def touch(at: float) -> bool:
        return bool(history.field("pressure", at).any())

    found = (next(filter(touch, one), None) for one in (stored, stored[::-1]))
    return [*dict.fromkeys(at for at in found if at is not None)]


def in_course(history: History) -> bool:
    """Return whether there are several records."""
    return len(history) > 1


def in_pictures(history: History) -> bool:
    """Return whether contacts of several records are stored, and bodies touch in one."""
    return len(history.saved) > 1 and bool(touching_records(history))


def worn(history: History) -> bool:
    """Return whether anything is worn."""
    return bool(np.nan_to_num(history["wear_max"]).any())


def worn_in_pictures(history: History) -> bool:
    """Return whether anything is worn, and several contacts are stored, or those of blocks."""
    return worn(history) and len(history.saved) * max(1, len(history.block_names)) > 1
