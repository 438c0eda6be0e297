"""Checks of line contacts: bodies infinitely long in y, in plane strain."""

import math
from collections.abc import Iterator

from tractive_sam.schema import Check, Fault, ValidEntries, shorten

_CROWN = "or a finite radius_y of one body, for a contact of finite width"


def is_line(entries: ValidEntries) -> bool:
    """Return whether the entries of a scene describe a line contact."""
    gap = entries["gap"]
    long = all(entries[f"body.{b}.radius_y"] == math.inf for b in "AB")
    return long and (gap is None or gap.profile == "x")


def _check_keys_of_points(entries: ValidEntries) -> Iterator[Fault]:
    """Report an approach, spin, or friction that varies across, in a line contact."""
    even = f"in a line contact, which is constant in y; {_CROWN}"
    infinite = "the approach of a line contact relative to distant points is infinite"
    excluded = (
        ("load.approach", None, f"load.normal, in N/mm: {infinite}; {_CROWN}"),
        ("creepage.spin", 0, f"0 {even}"),
        ("friction.across", None, f"nothing {even}"),
    )
    for key, default, cure in excluded:
        if is_line(entries) and entries[key] not in (None, default):
            yield Fault(key, shorten(entries[key]), cure)


def _check_directions_of_grid(entries: ValidEntries) -> Iterator[Fault]:
    """Report grid entries with two numbers in a line contact, or with one in another."""
    if entries["grid"] is None:
        return
    line = is_line(entries)
    for key, values in (("half_length", "numbers above 0"), ("elements", "integers from 3")):
        value = entries[f"grid.{key}"]
        if value is None:
            continue
        if line and len(value) == 2:
            cure = f"one number, for x: a line contact is constant in y; {_CROWN}"
            yield Fault(f"grid.{key}", shorten(value), cure)
        elif not line and len(value) == 1:
            cure = f"a pair of {values}, in x and y; one number is for line contacts"
            if entries["body"].infinitely_long:
                cure += ', which a [gap] with profile = "x" allows'
            yield Fault(f"grid.{key}", shorten(value[0]), cure)


def _check_unit_of_planes(entries: ValidEntries) -> Iterator[Fault]:
    """Report stress planes in units of the semi-axis b, which a line contact lacks."""
    if entries["subsurface"] is None or not is_line(entries):
        return
    for plane in entries["subsurface.planes"]:
        if plane.unit == "b":
            cure = "a plane in mm or in a: the semi-axis b of a line contact is infinite"
            yield Fault("subsurface.planes", shorten(str(plane)), cure)


LINE_CHECKS: tuple[Check, ...] = (
    _check_keys_of_points,
    _check_directions_of_grid,
    _check_unit_of_planes,
)
"""Checks of line contacts."""
