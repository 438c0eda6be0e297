"""Entries of which only one may be given."""

from __future__ import annotations

from collections.abc import Iterator

from .faults import Fault
from .table import Check, Known

_GAP_ARRAYS = ("gap.x", "gap.y", "gap.separation")
_ALTERNATIVES: tuple[tuple[tuple[str, ...], ...], ...] = (
    (("body.A.young",), ("body.A.shear",)),
    (("body.B.young",), ("body.B.shear",)),
    (("load.normal",), ("load.approach",), ("load.pressure",)),
    (("load.force_x",), ("creepage.longitudinal",)),
    (("load.force_y",), ("creepage.lateral",)),
    (("friction.mu",), ("friction.static",)),
    (("friction.kinetic", "friction.half_speed"), ("friction.A", "friction.B")),
    (("gap.file",), _GAP_ARRAYS),
    (("fatigue.shear_yield",), ("fatigue.yield_strength",)),
    (("wear.intensity",), ("wear.coefficient", "wear.coefficient.A", "wear.coefficient.B")),
    (
        ("accuracy", "accuracy.tolerance", "accuracy.elements"),
        ("grid", "grid.half_length", "grid.elements"),
    ),
)


def _rivals() -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    for one in _ALTERNATIVES:
        for keys in one:
            others = tuple(other for rest in one if rest is not keys for other in rest)
            found |= {key: (*found.get(key, ()), *others) for key in keys}
    return found


RIVALS = _rivals()
"""For each entry that has alternatives: the entries that it excludes."""

for _own in ("wear.coefficient.A", "wear.coefficient.B"):  # they tell the shares of the bodies
    RIVALS[_own] += ("body.A.hardness", "body.B.hardness")


def exactly_one(*keys: str) -> Check:
    """Make the check that exactly one of some entries of a table is given."""

    def check(known: Known) -> Iterator[Fault]:
        if not known.given.intersection(keys):
            yield Fault(keys[0], "nothing", f"exactly one of {_listed(keys)}")
        yield from not_both(*keys)(known)

    return check


def not_both(*keys: str) -> Check:
    """Make the check that at most one of some entries is given."""

    def check(known: Known) -> Iterator[Fault]:
        first, *others = [key for key in keys if key in known.given] or [""]
        if others:
            told = f"together with {' and '.join(others)}"
            yield Fault(first, told, f"only one of {_listed(keys)}")

    return check


def _listed(keys: tuple[str, ...]) -> str:
    return f"{', '.join(keys[:-1])} and {keys[-1]}"
