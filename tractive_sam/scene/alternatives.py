"""Entries of which only one may be given."""

from __future__ import annotations

from collections.abc import Iterator

from .faults import Fault
from .table import Check, Known

_GAP_ARRAYS = ("gap.x", "gap.y", "gap.separation")
_PAIRS = (
    (("body.A.young",), ("body.A.shear",)),
    (("body.B.young",), ("body.B.shear",)),
    (("load.normal",), ("load.approach",)),
    (("load.force_x",), ("creepage.longitudinal",)),
    (("load.force_y",), ("creepage.lateral",)),
    (("gap.file",), _GAP_ARRAYS),
    (
        ("accuracy", "accuracy.tolerance", "accuracy.elements"),
        ("grid", "grid.half_length", "grid.elements"),
    ),
)

RIVALS = {key: others for pair in _PAIRS for keys, others in (pair, pair[::-1]) for key in keys}
"""For each entry that has an alternative: the entries that it excludes."""


def exactly_one(first: str, second: str) -> Check:
    """Make the check that exactly one of two entries of a table is given."""

    def check(known: Known) -> Iterator[Fault]:
        given = [key for key in (first, second) if key in known.given]
        if not given:
            yield Fault(first, "nothing", f"exactly one of {first} and {second}")
        yield from not_both(first, second)(known)

    return check


def not_both(first: str, second: str) -> Check:
    """Make the check that at most one of two entries is given."""

    def check(known: Known) -> Iterator[Fault]:
        if {first, second} <= known.given:
            yield Fault(first, f"together with {second}", f"only one of {first} and {second}")

    return check
