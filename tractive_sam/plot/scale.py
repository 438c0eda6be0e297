"""The units of lengths and pressures in a figure, and how axes name them."""

import math
from dataclasses import dataclass, field
from typing import Self

from tractive_sam.deprecation import renamed_attributes
from tractive_sam.plot.options import current_options
from tractive_sam.results import History, State
from tractive_sam.scene import Scene


@renamed_attributes(of_contact="from_contact", of_history="from_history", told="note")
@dataclass(frozen=True)
class Scale:
    """Half widths and pressure by which figures make lengths and stresses relative.

    Attributes
    ----------
    a, b : float
        Half widths in x and in y, mm.
    p : float
        Pressure, MPa.
    hertz : bool
        Whether they belong to the unworn contact by Hertz; else to the first contact that was
        computed.
    units : str
        "hertz" if figures divide by them; "si-mm" if lengths are in mm and pressures in MPa, as for
        every wheel: its patches are no Hertz contacts.

    Examples
    --------
    >>> plot.Scale.from_contact(contact).p_symbol
    'p_0'
    """

    a: float
    b: float
    p: float
    hertz: bool
    units: str = field(default_factory=lambda: current_options().units)

    @classmethod
    def from_contact(cls, contact: State) -> Self:
        """Return the scale of a contact: half widths and pressure by Hertz, or else its values."""
        a, b, p = contact.half_width_x, contact.half_width_y, contact.p_max
        return cls._from_scene(contact.scene, (a, b, p))

    @classmethod
    def from_history(cls, history: History) -> Self:
        """Return the scale of a history: Hertz's values, or values of its first contact."""
        names = ("half_width_x", "half_width_y", "p_max")
        a, b, p = (float(history[name][0]) for name in names)
        return cls._from_scene(history.scene, (a, b, p))

    @classmethod
    def _from_scene(cls, scene: Scene, values: tuple[float, float, float]) -> Self:
        """Return the scale of a scene by Hertz, else these values; mm and MPa with [wheel]."""
        if scene.wheelset is not None:
            return cls(*values, hertz=False, units="si-mm")
        hertz = scene.hertz
        if hertz is None:
            return cls(*values, hertz=False)
        return cls(hertz.a, hertz.b, hertz.p0, hertz=True)

    @property
    def relative(self) -> bool:
        """Whether figures divide by the scale; otherwise they are in mm and MPa."""
        return self.units == "hertz"

    @property
    def length(self) -> float:
        """Divisor of lengths in figures: the half width a, or 1 for figures in mm."""
        return self.a if self.relative else 1.0

    @property
    def across(self) -> float:
        """Divisor of lengths across the track in figures: the half width b, or 1 for mm."""
        return self.b if self.relative else 1.0

    @property
    def pressure(self) -> float:
        """Divisor of pressures in figures: the pressure p, or 1 for figures in MPa."""
        return self.p if self.relative else 1.0

    def length_label(self, name: str, across: bool = False) -> str:
        """Return the label of a length in the units of the scale, as math text."""
        divisor = self.b_symbol if across else self.a_symbol
        return f"${name}/{divisor}$" if self.relative else f"${name}$ (mm)"

    def pressure_label(self, symbol: str) -> str:
        """Return the label of a pressure or stress in the units of the scale."""
        return f"${symbol}/{self.p_symbol}$" if self.relative else f"${symbol}$ (MPa)"

    def describe(self) -> str:
        """Return the half widths and the pressure in numbers, for titles."""
        names = ("a₀", "b₀", "p₀") if self.hertz else ("a", "b", "largest p")
        b = "" if math.isinf(self.b) else f", {names[1]} = {self.b:.3g} mm"
        return f"{names[0]} = {self.a:.3g} mm{b}, {names[2]} = {self.p:.4g} MPa"

    @property
    def note(self) -> str:
        """Values of the scale as text if figures divide by it; else empty."""
        return self.describe() if self.relative else ""

    @property
    def a_symbol(self) -> str:
        """Symbol of the half width in x for math text: "a_0" of Hertz's contact, else "a"."""
        return "a_0" if self.hertz else "a"

    @property
    def b_symbol(self) -> str:
        """Symbol of the half width in y for math text: "b_0" of Hertz's contact, else "b"."""
        return "b_0" if self.hertz else "b"

    @property
    def p_symbol(self) -> str:
        """Symbol of the pressure for math text: "p_0" of Hertz's contact, else "p_max"."""
        return "p_0" if self.hertz else r"p_\mathrm{max}"
