"""The largest stress of a body, and where it is."""

from dataclasses import dataclass

from tractive_sam.mechanics import CycleCriterion, StressCriterion

Point = tuple[float, float, float]
"""(x, y, depth), mm."""


@dataclass(frozen=True)
class Maximum:
    """Largest stress in a body by a criterion, and where, (x, y, depth) in mm.

    Attributes
    ----------
    criterion : StressCriterion or CycleCriterion
        What makes one number of the stress; its unit is that of the values. Of a cycle, along all
        x, the place has no x.
    value, at : float, tuple of float
        The larger one of the two below.
    interior, interior_at : float, tuple of float
        The largest local maximum at least two elements below the surface; nan where the stress
        falls from the surface down. Two elements deep it is a bound: a maximum nearer to the
        surface than that.
    surface, surface_at : float, tuple of float
        The largest value at the surface; see `subsurface.surface.largest_at_surface`.

    Examples
    --------
    >>> top = ts.stress_maximum(contact)
    >>> top.value == max(top.interior, top.surface)
    True
    """

    criterion: StressCriterion | CycleCriterion | None
    value: float
    at: Point
    interior: float
    interior_at: Point
    surface: float
    surface_at: Point
