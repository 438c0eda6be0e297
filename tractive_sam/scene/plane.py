"""The planes on which subsurface stress is wanted."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

_GRAMMAR = re.compile(
    r"(?P<axis>[xyz])\s*=\s*(?P<number>[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?)\s*(?P<unit>[ab]?)",
    re.ASCII,
)
_ALLOWED = 'planes like "y=0", "x=-0.3" (mm), "y=0.75a" or "z=0.5b" (semi-axes of the contact)'


@dataclass(frozen=True)
class Plane:
    """The plane x, y or z = number; its text, as in ``y=0.75a``, is `str(plane)`.

    Parameters
    ----------
    axis : "x", "y" or "z"
        The normal of the plane; z is the depth below the surface of either body.
    number : float
        The position; mm, or multiples of `unit`.
    unit : "", "a" or "b"
        Nothing for mm, or the semi-axis of the unworn contact in x or in y.
    """

    axis: Literal["x", "y", "z"]
    number: float
    unit: Literal["", "a", "b"] = ""

    @classmethod
    def parse(cls, text: object) -> Plane:
        """Read ``<axis>=<number>[a|b]``; a plane is returned as it is.

        Raises
        ------
        ValueError
            If the text is no such plane, or lies above the surface (z < 0).
        """
        if isinstance(text, Plane):
            return text
        found = _GRAMMAR.fullmatch(text.strip()) if isinstance(text, str) else None
        if not found:
            raise ValueError(_ALLOWED)
        number = float(found["number"]) + 0.0  # no negative zero
        if found["axis"] == "z" and number < 0:
            raise ValueError("a depth z of 0 or more")
        if abs(number) > 1e30:
            raise ValueError("a plane at a finite distance")
        # The grammar lets no other words pass.
        return cls(found["axis"], number, found["unit"])  # type: ignore[arg-type]

    def value_in(self, a: float, b: float) -> float:
        """Position of the plane in mm, for a contact with the semi-axes a, b in mm."""
        return self.number * {"": 1.0, "a": a, "b": b}[self.unit]

    def __str__(self) -> str:
        return f"{self.axis}={repr(self.number).removesuffix('.0')}{self.unit}"
