"""Point and line contacts: units, motions and constants that depend on the width of a contact."""

from typing import ClassVar


class PointContact:
    """Units and motions of a contact of finite width, as opposed to a line contact.

    Attributes
    ----------
    creepages : tuple of str
        Relative motions of the rigid bodies.
    weibull_slope : float
        Usual slope of the Weibull distribution of lives, for ball bearings (Lundberg and Palmgren
        1947).
    """

    creepages: ClassVar[tuple[str, ...]] = ("xi_x", "xi_y", "spin")
    weibull_slope: ClassVar[float] = 10.0 / 9.0

    def unit(self, unit: str) -> str:
        """Return the unit of a quantity of the full contact, unchanged for a point contact."""
        return unit


class LineContact(PointContact):
    """Units and motions of a line contact: bodies infinitely long in y, plane strain.

    Resultants, areas and volumes are per length, mm. The slip by spin would vary in y. The usual
    slope of lives is for roller bearings (Lundberg and Palmgren 1952).
    """

    creepages = ("xi_x", "xi_y")
    weibull_slope = 9.0 / 8.0

    def unit(self, unit: str) -> str:
        """Return the unit per length of a quantity: N/mm for N."""
        return {"mm3": "mm2", "mm2": "mm"}.get(unit, f"{unit}/mm")
