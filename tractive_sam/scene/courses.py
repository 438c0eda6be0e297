"""Courses of keys at the knots of a distance, and profiles that move with the bodies."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BeforeValidator, Field

from tractive_sam.schema import InnerTable, Positive, Real, Table, entry, number_to_tuple, optional

from .gap import Gap


def _check_knots(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return knots unchanged; raise a ValueError if they descend, or if three are equal."""
    if any(late < early for early, late in pairwise(places)):
        raise ValueError("a list of ascending numbers; two equal numbers are a jump")
    if any(first == last for first, _, last in zip(places, places[1:], places[2:], strict=False)):
        raise ValueError("each number at most twice: two equal numbers are a jump")
    return places


def check_ascending(places: tuple[float, ...]) -> tuple[float, ...]:
    """Return numbers unchanged; raise a ValueError unless they ascend."""
    if any(late <= early for early, late in pairwise(places)):
        raise ValueError("a list of ascending numbers, each once")
    return places


NotBelowZero = Annotated[Real, Field(ge=0)]
Knots = Annotated[tuple[NotBelowZero, ...], AfterValidator(_check_knots)]
Saved = Annotated[tuple[NotBelowZero, ...], AfterValidator(check_ascending)]
Course = Annotated[tuple[Real, ...], BeforeValidator(number_to_tuple)]
PositiveCourse = Annotated[tuple[Positive, ...], BeforeValidator(number_to_tuple)]


def course(meaning: str, allowed: str = "a number, or a list of numbers, one for each knot") -> Any:
    """Return the definition of a field for a course: one number for each knot."""
    return entry(meaning, allowed, None)


class LoadCourse(Table):
    """Courses over the rolling distance of the keys of [load], in a [transient].

    Examples
    --------
    >>> ts.LoadCourse(force_x=[0.0, 0.1]).force_x
    (0.0, 0.1)
    """

    normal: PositiveCourse | None = course(
        "normal load P, N or N/mm",
        "a number above 0, or a list of them, one for each knot; for separated bodies use "
        "load.approach",
    )
    approach: Course | None = course(
        "approach of the bodies, mm, from the first touch of the unworn bodies without moving "
        "profiles; at values up to 0, bodies without profiles are separated"
    )
    force_x: Course | None = course("prescribed tangential force Q_x on body A, N or N/mm")
    force_y: Course | None = course("prescribed tangential force Q_y on body A, N or N/mm")


class CreepageCourse(Table):
    """Courses over the rolling distance of the keys of [creepage], or of shifts.

    Examples
    --------
    >>> ts.CreepageCourse(longitudinal=[0.0, -0.003]).spin is None
    True
    """

    shifts: ClassVar[Mapping[str, str]] = {
        "longitudinal": "the shift of A relative to B in x, mm",
        "lateral": "the shift of A relative to B in y, mm",
        "spin": "the rotation of A relative to B, radians",
    }
    """Meaning of each course in a shift."""

    longitudinal: Course | None = course(
        f"longitudinal creepage xi_x; in a shift, {shifts['longitudinal']}"
    )
    lateral: Course | None = course(f"lateral creepage xi_y; in a shift, {shifts['lateral']}")
    spin: Course | None = course(f"spin creepage phi, 1/mm; in a shift, {shifts['spin']}")


class FrictionCourse(Table):
    """Courses over the rolling distance of the keys of [friction], in a [transient].

    Examples
    --------
    >>> ts.FrictionCourse(mu=[0.4, 0.1]).mu
    (0.4, 0.1)
    """

    mu: PositiveCourse | None = course(
        "friction coefficient mu1; mu2 changes in proportion",
        "a number above 0, or a list of them, one for each knot",
    )


class Profiles(Table):
    """Height profiles that are fixed to the bodies and move through the contact with them.

    As in [gap], a profile adds to the separation: a bump is negative. The point x of the profile is
    at the centre of the contact at the rolling distance x.

    Examples
    --------
    >>> bump = {"x": [-1, 0, 1], "y": [-9, 9], "separation": [[0, 0], [-1e-3, -1e-3], [0, 0]]}
    >>> ts.Profiles(A=bump).B is None
    True
    """

    A: InnerTable[Gap | None] = optional("profile of the upper body")
    B: InnerTable[Gap | None] = optional("profile of the lower body")

    @property
    def by_table(self) -> dict[str, Gap]:
        """Moving profiles of the bodies that have one, by the names of their tables."""
        profiles = {f"transient.profile.{body}": getattr(self, body) for body in "AB"}
        return {table: profile for table, profile in profiles.items() if profile is not None}
