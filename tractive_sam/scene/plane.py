"""Planes on which the subsurface stress is computed."""

import re
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Plane:
    """Plane x, y or z = number below the contact, with the text form ``y=0.75a``.

    Parameters
    ----------
    axis : "x", "y" or "z"
        The normal of the plane; z is the depth below the surface of a body.
    number : float
        The position; mm, or multiples of `unit`.
    unit : "", "a" or "b"
        Empty for mm, or the semi-axis of the unworn contact in x or in y.
    """

    axis: Literal["x", "y", "z"]
    number: float
    unit: Literal["", "a", "b"] = ""

    @classmethod
    def parse(cls, text: object) -> "Plane":
        """Return the plane that a text ``<axis>=<number>[a|b]`` describes.

        Raises
        ------
        ValueError
            If the text has another form, or the plane is above the surface (z < 0).
        """
        if isinstance(text, Plane):
            return text
        number_form = r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?"
        form = rf"(?P<axis>[xyz])\s*=\s*(?P<number>{number_form})\s*(?P<unit>[ab]?)"
        parts = re.fullmatch(form, text.strip(), re.ASCII) if isinstance(text, str) else None
        if not parts:
            examples = '"y=0", "x=-0.3" (mm), "y=0.75a" or "z=0.5b" (semi-axes of the contact)'
            raise ValueError(f"planes like {examples}")
        number = float(parts["number"]) + 0.0  # no negative zero
        if parts["axis"] == "z" and number < 0:
            raise ValueError("a depth z of at least 0")
        if abs(number) > 1e30:
            raise ValueError("a plane at a finite distance")
        # The form allows no other names.
        return cls(parts["axis"], number, parts["unit"])  # type: ignore[arg-type]

    def value_in(self, a: float, b: float) -> float:
        """Return the position of the plane in mm, for a contact with the semi-axes a, b in mm."""
        return self.number * {"": 1.0, "a": a, "b": b}[self.unit]

    def __str__(self) -> str:
        return f"{self.axis}={repr(self.number).removesuffix('.0')}{self.unit}"
