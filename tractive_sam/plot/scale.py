"""What lengths and pressures of a figure are divided by, and how that is written."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Literal, Self

from tractive_sam.results import History, State

UNITS = ("hertz", "si-mm")
"""What lengths and pressures are drawn in: over those of Hertz, or in mm and MPa."""

_UNITS: ContextVar[str] = ContextVar("units of figures", default="hertz")


@contextmanager
def units(name: Literal["hertz", "si-mm"]) -> Iterator[None]:
    """Draw lengths over the half widths of Hertz and pressures over p_0, or all in mm and MPa.

    Parameters
    ----------
    name : str
        "hertz", the default of figures, or "si-mm".

    Raises
    ------
    ValueError
        If there are no such units.

    Examples
    --------
    >>> with plot.units("si-mm"):
    ...     plot.pressure(contact).axes[0].get_ylabel()
    '$y$ (mm)'
    """
    if name not in UNITS:
        raise ValueError(f"units: one of {', '.join(UNITS)} is needed, not {name!r}")
    before = _UNITS.set(name)
    try:
        yield
    finally:
        _UNITS.reset(before)


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
    drawn_in : str
        "hertz" where these stand for one in figures; "si-mm" where 1 mm and 1 MPa do.

    Examples
    --------
    >>> plot.Scale.of_contact(contact).p_symbol
    'p_0'
    """

    a: float
    b: float
    p: float
    hertz: bool
    drawn_in: str = field(default_factory=_UNITS.get)

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
    def length(self) -> float:
        """What lengths are divided by, mm."""
        return self.a if self.relative else 1.0

    @property
    def across(self) -> float:
        """What lengths across the track are divided by where only they are drawn, mm."""
        return self.b if self.relative else 1.0

    @property
    def pressure(self) -> float:
        """What pressures are divided by, MPa."""
        return self.p if self.relative else 1.0

    @property
    def relative(self) -> bool:
        """Whether figures draw what is over these half widths and this pressure."""
        return self.drawn_in == "hertz"

    def of_length(self, name: str, across: bool = False) -> str:
        """Label of a length, as math text."""
        over = self.b_symbol if across else self.a_symbol
        return f"${name}/{over}$" if self.relative else f"${name}$ (mm)"

    def of_pressure(self, symbol: str) -> str:
        """Label of a pressure or stress, as math text."""
        return f"${symbol}/{self.p_symbol}$" if self.relative else f"${symbol}$ (MPa)"

    @property
    def told(self) -> str:
        """The half widths and the pressure in numbers, for captions; empty in mm and MPa."""
        if not self.relative:
            return ""
        names = ("a₀", "b₀", "p₀") if self.hertz else ("a", "b", "largest p")
        b = "" if math.isinf(self.b) else f", {names[1]} = {self.b:.3g} mm"
        return f"{names[0]} = {self.a:.3g} mm{b}, {names[2]} = {self.p:.4g} MPa"

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
