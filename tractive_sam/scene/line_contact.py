"""Checks of line contacts: bodies infinitely long across the rolling direction, in plane strain."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tractive_sam.schema import Check, Fault, ValidEntries, shorten

_CROWN = "give one body a finite radius_y for a contact of finite width"


def is_line(entries: ValidEntries) -> bool:
    """Return whether a scene of these entries is a line contact."""
    return entries["gap"] is None and all(entries[f"body.{b}.radius_y"] == math.inf for b in "AB")


def _load_is_given(entries: ValidEntries) -> Iterator[Fault]:
    if is_line(entries) and entries["load.approach"] is not None:
        cure = (
            "load.normal, in N/mm: the load per length of a line contact does not follow from an "
            f"approach, which is infinite relative to distant points; or {_CROWN}"
        )
        yield Fault("load.approach", shorten(entries["load.approach"]), cure)


def _no_spin(entries: ValidEntries) -> Iterator[Fault]:
    if is_line(entries) and entries["creepage.spin"] != 0:
        cure = f"0 in a line contact, which is the same all along y as spin is not; or {_CROWN}"
        yield Fault("creepage.spin", shorten(entries["creepage.spin"]), cure)


def _grid_has_its_directions(entries: ValidEntries) -> Iterator[Fault]:
    if entries["grid"] is None:
        return
    line = is_line(entries)
    for key, what in (("half_length", "numbers above 0"), ("elements", "whole numbers from 3")):
        given = entries[f"grid.{key}"]
        if given is None:
            continue
        if line and len(given) == 2:
            cure = f"one number, that in x: a line contact is the same all along y; or {_CROWN}"
            yield Fault(f"grid.{key}", shorten(given), cure)
        elif not line and len(given) == 1:
            cure = f"a pair of {what}, in x and y; one number is for line contacts"
            yield Fault(f"grid.{key}", shorten(given[0]), cure)


def _planes_need_no_width(entries: ValidEntries) -> Iterator[Fault]:
    if entries["subsurface"] is None or not is_line(entries):
        return
    for plane in entries["subsurface.planes"]:
        if plane.unit == "b":
            cure = "planes in mm or in a: the semi-axis b of a line contact is infinite"
            yield Fault("subsurface.planes", shorten(str(plane)), cure)


LINE_CHECKS: tuple[Check, ...] = (
    _load_is_given,
    _no_spin,
    _grid_has_its_directions,
    _planes_need_no_width,
)
"""What only line contacts ask for or exclude."""
