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


def _check_load_is_present(entries: ValidEntries) -> Iterator[Fault]:
    """Report an approach in a line contact, which needs a load per length."""
    if is_line(entries) and entries["load.approach"] is not None:
        cure = (
            "load.normal, in N/mm: the approach of a line contact relative to distant points is "
            f"infinite; {_CROWN}"
        )
        yield Fault("load.approach", shorten(entries["load.approach"]), cure)


def _check_no_spin(entries: ValidEntries) -> Iterator[Fault]:
    """Report spin in a line contact."""
    if is_line(entries) and entries["creepage.spin"] != 0:
        cure = f"0 in a line contact, which is constant in y; {_CROWN}"
        yield Fault("creepage.spin", shorten(entries["creepage.spin"]), cure)


def _check_friction_is_even(entries: ValidEntries) -> Iterator[Fault]:
    """Report friction that varies across a line contact."""
    if is_line(entries) and entries["friction.across"] is not None:
        cure = f"nothing in a line contact, which is constant in y; {_CROWN}"
        yield Fault("friction.across", shorten(entries["friction.across"]), cure)


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
    _check_load_is_present,
    _check_no_spin,
    _check_friction_is_even,
    _check_directions_of_grid,
    _check_unit_of_planes,
)
"""Checks of line contacts."""
