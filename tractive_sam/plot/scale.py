"""What lengths and pressures of a figure are divided by, and how that is written."""

import math
from dataclasses import dataclass
from typing import Self

from tractive_sam.results import History, State


@dataclass(frozen=True)
class Scale:
    """Half widths and pressure that stand for one.

    Attributes
    ----------
    a, b : float
        Half widths in x and in y, mm.
    p : float
        Pressure, MPa.
    hertz : bool
        Whether they are those of the unworn contact by Hertz; else they were read off the first
        contact computed.

    Examples
    --------
    >>> plot.Scale.of_contact(contact).p_symbol
    'p_0'
    """

    a: float
    b: float
    p: float
    hertz: bool

    @classmethod
    def of_contact(cls, contact: "State") -> Self:
        """Scale of a contact."""
        hertz = contact.scene.hertz
        if hertz is not None:
            return cls(hertz.a, hertz.b, hertz.p0, hertz=True)
        return cls(contact.half_width_x, contact.half_width_y, contact.p_max, hertz=False)

    @classmethod
    def of_history(cls, history: History) -> Self:
        """Scale of a history."""
        if math.isfinite(history.p0):
            return cls(history.a0, history.b0, history.p0, hertz=True)
        first = (history[name][0] for name in ("half_width_x", "half_width_y", "p_max"))
        return cls(*map(float, first), hertz=False)

    @property
    def a_symbol(self) -> str:
        """Symbol of the half width in x, for math text."""
        return "a_0" if self.hertz else "a"

    @property
    def b_symbol(self) -> str:
        """Symbol of the half width in y, for math text."""
        return "b_0" if self.hertz else "b"

    @property
    def p_symbol(self) -> str:
        """Symbol of the pressure, for math text."""
        return "p_0" if self.hertz else r"p_\mathrm{max}"
