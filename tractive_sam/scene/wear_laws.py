"""Wear laws that a scene names: their coefficients, points and published sets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator

from tractive_sam.mechanics import BRR, JENDEL, USFD
from tractive_sam.schema import (
    Check,
    Fault,
    NamedLaw,
    NotNegative,
    OptionalOrthotropicNotNegative,
    Table,
    ValidEntries,
    entry,
    exactly_one,
)

PER_INTENSITY = 1e3
"""Coefficient in mm3/(N m) of a wear intensity of 1/MPa = 1 mm3/(N mm)."""


class Coefficients(Table):
    """Specific wear rate of each body on its own, in place of one number for both together.

    Examples
    --------
    >>> ts.Wear(coefficient={"A": 1e-3, "B": 3e-3}, revolutions=100).coefficient.B
    0.003
    """

    A: NotNegative | None = entry(
        "specific wear rate k of body A, mm3/(N m)", "a number of at least 0", None
    )
    B: NotNegative | None = entry(
        "specific wear rate k of body B, mm3/(N m)", "a number of at least 0", None
    )


if TYPE_CHECKING:
    from tractive_sam.schema import Accepting, Pair

    SpecificWearRate = Accepting[
        float | Pair | Coefficients | Mapping[str, float] | None, Pair | Coefficients | None
    ]
else:
    SpecificWearRate = OptionalOrthotropicNotNegative | Coefficients

LawName = Literal["archard", "energy", "usfd", "brr", "jendel"]
LawOrTable = Literal[LawName, "table"]
ALL_LAWS = '"archard", "energy", "usfd", "brr" or "jendel"'

OF_SETS: dict[str, Mapping[str, Any]] = {"usfd": USFD, "brr": BRR, "jendel": JENDEL}
"""Published sets of coefficients by the law that they are of; the first one is the default."""

BY_COEFFICIENT = ("archard", "energy")
"""Laws whose coefficient the scene gives."""


def _rising(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    works = [work for work, _ in points]
    if not any(works) or any(late <= early for early, late in pairwise(works)):
        raise ValueError("pairs [W, rate] with ascending W")
    if works[0] == 0.0 and points[0][1]:
        raise ValueError("no rate at W = 0: what does not slip does not wear")
    return points


def _laws_of_what(entries: ValidEntries) -> Iterator[Fault]:
    table, bodies = entries["table"], (entries["A"], entries["B"])
    if table is None and bodies == (None, None):
        yield Fault("table", "nothing", "a table, or laws A and B of the bodies")
    if "table" in bodies and table is None:
        yield Fault("table", "nothing", "points of the law, as a body goes by them")
    if table is not None and any(bodies) and "table" not in bodies:
        yield Fault("table", "no body that goes by it", 'A = "table", B = "table", or no table')


class WearLaws(Table):
    """A wear law of one's own as points, or laws of each body on its own.

    Examples
    --------
    >>> laws = ts.WearLaws(A="usfd", B="archard")
    >>> ts.Wear(law=laws, coefficient={"B": 1e-4}, revolutions=100).laws
    {'A': 'usfd', 'B': 'archard'}
    """

    table: (
        Annotated[tuple[tuple[NotNegative, NotNegative], ...], AfterValidator(_rising)] | None
    ) = entry(
        "mass worn over frictional work: W = T-gamma/A, N/mm2, and rate, ug/(m mm2) of each body; "
        "straight from the origin through the points, and on beyond the last",
        "a list of pairs [W, rate] with ascending W",
        None,
        min_length=1,
    )
    A: LawOrTable | None = entry(
        "law of body A; without one it does not wear", f'{ALL_LAWS}, or "table"', None
    )
    B: LawOrTable | None = entry(
        "law of body B; without one it does not wear", f'{ALL_LAWS}, or "table"', None
    )
    checks: ClassVar[tuple[Check, ...]] = (_laws_of_what,)


class Sets(Table):
    """Named sets of coefficients of each body on its own.

    Examples
    --------
    >>> ts.Sets(A="low", B="high").A
    'low'
    """

    A: str | None = entry("set of coefficients of body A", "a name", None)
    B: str | None = entry("set of coefficients of body B", "a name", None)


def laws_of_bodies(law: str | WearLaws | NamedLaw) -> dict[str, str | None]:
    """Return the name of the law of each body; None of one that does not wear."""
    if not isinstance(law, WearLaws):
        return {"A": str(law), "B": str(law)}
    both = "table" if law.A is None and law.B is None else None
    return {"A": law.A or both, "B": law.B or both}


def check_coefficients(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of the coefficients that the wear laws need, or do not take."""
    if isinstance(entries["law"], NamedLaw):
        return
    laws = laws_of_bodies(entries["law"])
    taking = [body for body, name in laws.items() if name in BY_COEFFICIENT]
    either = entries.given & {"intensity", "coefficient"}
    together = entries["law"] in BY_COEFFICIENT
    if not taking:
        for key in sorted(either):
            yield Fault(
                key, f"with the law {entries['law']!r}", "nothing: its coefficients are known"
            )
        return
    if entries["law"] == "archard":
        yield from exactly_one("intensity", "coefficient")(entries)
    elif "intensity" in either:
        cure = "coefficient: mm3/J of the energy law, or { A = ..., B = ... } of each body"
        yield Fault("intensity", "not with this law", cure)
    elif "coefficient" not in either:
        yield Fault("coefficient", "nothing", "that of the bodies whose law takes one")
    if "coefficient" not in either:
        return
    k = entries["coefficient"]
    if not isinstance(k, Coefficients):
        if not together and k is not None:
            listed = ", ".join(f"{body} = ..." for body in taking)
            yield Fault("coefficient", str(k), f"that of each body: {{ {listed} }}")
        return
    for body, name in laws.items():
        value = getattr(k, body)
        if body in taking and value is None:
            yield Fault(f"coefficient.{body}", "nothing", f"that of its law, {name}")
        if body not in taking and value is not None:
            yield Fault(f"coefficient.{body}", str(value), "nothing: its law takes none")


def check_sets(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of the names of sets of coefficients."""
    laws, given = laws_of_bodies(entries["law"]), entries["set"]
    for body in "AB" if given is not None else ():
        name = given if isinstance(given, str) else getattr(given, body)
        sets = OF_SETS.get(laws[body] or "", {})
        if name is not None and name not in sets and not (isinstance(given, str) and not sets):
            key = "set" if isinstance(given, str) else f"set.{body}"
            allowed = f"one of {', '.join(sets)}" if sets else "nothing: its law has no sets"
            yield Fault(key, repr(name), allowed)
            if isinstance(given, str):
                return
    if isinstance(given, str) and not any(laws[body] in OF_SETS for body in "AB"):
        yield Fault("set", repr(given), f"only with one of {', '.join(OF_SETS)}")
