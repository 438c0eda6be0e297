"""The largest stress of a body, and its place."""

from dataclasses import dataclass

from tractive_sam.mechanics import Criterion

Point = tuple[float, float, float]
"""(x, y, depth), mm."""


@dataclass(frozen=True)
class Maximum:
    """Largest stress in a body by a criterion, inside and at the surface, with positions in mm.

    Attributes
    ----------
    criterion : StressCriterion or CycleCriterion
        Criterion that gives one number of the stress, in the unit of the values. For a cycle, which
        covers all x, the place has no x.
    value, at : float, tuple of float
        The larger of the two below.
    interior, interior_at : float, tuple of float
        The largest local maximum at least two elements below the surface; nan if the stress falls
        monotonically from the surface. A maximum exactly two elements deep is a bound: the actual
        one is closer to the surface.
    surface, surface_at : float, tuple of float
        The largest value at the surface; see `subsurface.multilevel.largest_at_surface`.

    Examples
    --------
    >>> top = ts.stress_maximum(contact)
    >>> top.value == max(top.interior, top.surface)
    True
    """

    criterion: Criterion | None
    value: float
    at: Point
    interior: float
    interior_at: Point
    surface: float
    surface_at: Point
