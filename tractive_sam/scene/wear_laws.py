"""Wear laws of a scene: their coefficients, points and published sets of coefficients."""

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
    exactly_one,
    optional,
)

PER_INTENSITY = 1e3
"""Coefficient in mm3/(N m) of a wear intensity of 1/MPa = 1 mm3/(N mm)."""


class Coefficients(Table):
    """Specific wear rate of each body, mm3/(N m), instead of the sum of both bodies.

    Examples
    --------
    >>> ts.Wear(coefficient={"A": 1e-3, "B": 3e-3}, revolutions=100).coefficient.B
    0.003
    """

    A: NotNegative | None = optional("specific wear rate k of body A, mm3/(N m)")
    B: NotNegative | None = optional("specific wear rate k of body B, mm3/(N m)")


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

COEFFICIENT_SETS: dict[str, Mapping[str, Any]] = {"usfd": USFD, "brr": BRR, "jendel": JENDEL}
"""Published sets of coefficients by the name of their law; the first set is the default."""

BY_COEFFICIENT = ("archard", "energy")
"""Laws for which the scene gives the coefficients."""


def _check_points(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    """Return points (W, rate) of a wear law; raise a ValueError unless W ascends from 0."""
    works = [work for work, _ in points]
    if not any(works) or any(late <= early for early, late in pairwise(works)):
        raise ValueError("pairs [W, rate] with ascending W")
    if works[0] == 0.0 and points[0][1]:
        raise ValueError("a rate of 0 at W = 0: without slip there is no wear")
    return points


def _check_table_of_rates(entries: ValidEntries) -> Iterator[Fault]:
    """Report a table of wear rates that is missing or unused."""
    table, bodies = entries["table"], (entries["A"], entries["B"])
    if table is None and bodies == (None, None):
        yield Fault("table", "nothing", "a table, or laws A and B of the bodies")
    if "table" in bodies and table is None:
        yield Fault("table", "nothing", 'points of the law, as a body has the law "table"')
    if table is not None and any(bodies) and "table" not in bodies:
        yield Fault("table", "a table that no body uses", 'A = "table", B = "table", or no table')


class WearLaws(Table):
    """Wear law given by points (T-gamma/A, rate), or a separate law for each body.

    Examples
    --------
    >>> laws = ts.WearLaws(A="usfd", B="archard")
    >>> ts.Wear(law=laws, coefficient={"B": 1e-4}, revolutions=100).laws
    {'A': 'usfd', 'B': 'archard'}
    """

    table: (
        Annotated[tuple[tuple[NotNegative, NotNegative], ...], AfterValidator(_check_points)] | None
    ) = optional(
        "wear rate of each body as a function of the frictional work: pairs of W = T-gamma/A, "
        "N/mm2, and rate, ug/(m mm2); linear from the origin through the points, and "
        "extrapolated beyond the last point",
        "a list of pairs [W, rate] with ascending W",
        min_length=1,
    )
    A: LawOrTable | None = optional("law of body A; without a law, the body does not wear")
    B: LawOrTable | None = optional("law of body B; without a law, the body does not wear")
    checks: ClassVar[tuple[Check, ...]] = (_check_table_of_rates,)


class Sets(Table):
    """Name of the set of published wear coefficients for each body.

    Examples
    --------
    >>> ts.Sets(A="low", B="high").A
    'low'
    """

    A: str | None = optional("coefficient set of body A", "a name")
    B: str | None = optional("coefficient set of body B", "a name")


def laws_of_bodies(law: str | WearLaws | NamedLaw) -> dict[str, str | None]:
    """Return the name of each body's wear law; None for a body that does not wear."""
    if not isinstance(law, WearLaws):
        return {"A": str(law), "B": str(law)}
    both = "table" if law.A is None and law.B is None else None
    return {"A": law.A or both, "B": law.B or both}


def check_coefficients(entries: ValidEntries) -> Iterator[Fault]:
    """Report wear coefficients that are missing, or that the wear laws do not use."""
    if isinstance(entries["law"], NamedLaw):
        return
    laws = laws_of_bodies(entries["law"])
    users = [body for body, name in laws.items() if name in BY_COEFFICIENT]
    keys = entries.given & {"intensity", "coefficient"}
    together = entries["law"] in BY_COEFFICIENT
    if not users:
        for key in sorted(keys):
            yield Fault(
                key, f"with the law {entries['law']!r}", "nothing: its coefficients are published"
            )
        return
    if entries["law"] == "archard":
        yield from exactly_one("intensity", "coefficient")(entries)
    elif "intensity" in keys:
        cure = "coefficient: mm3/J for the energy law, or { A = ..., B = ... } for each body"
        yield Fault("intensity", "not with this law", cure)
    elif "coefficient" not in keys:
        yield Fault(
            "coefficient", "nothing", "a coefficient for each body with the law archard or energy"
        )
    if "coefficient" not in keys:
        return
    k = entries["coefficient"]
    if not isinstance(k, Coefficients):
        if not together and k is not None:
            listed = ", ".join(f"{body} = ..." for body in users)
            yield Fault("coefficient", str(k), f"a coefficient for each body: {{ {listed} }}")
        return
    for body, name in laws.items():
        value = getattr(k, body)
        if body in users and value is None:
            yield Fault(f"coefficient.{body}", "nothing", f"the coefficient of its law, {name}")
        if body not in users and value is not None:
            yield Fault(f"coefficient.{body}", str(value), "nothing: its law has no coefficient")


def check_sets(entries: ValidEntries) -> Iterator[Fault]:
    """Report names of coefficient sets that do not exist."""
    laws, chosen = laws_of_bodies(entries["law"]), entries["set"]
    for body in "AB" if chosen is not None else ():
        name = chosen if isinstance(chosen, str) else getattr(chosen, body)
        sets = COEFFICIENT_SETS.get(laws[body] or "", {})
        if name is not None and name not in sets and not (isinstance(chosen, str) and not sets):
            key = "set" if isinstance(chosen, str) else f"set.{body}"
            allowed = f"one of {', '.join(sets)}" if sets else "nothing: its law has no sets"
            yield Fault(key, repr(name), allowed)
            if isinstance(chosen, str):
                return
    if isinstance(chosen, str) and not any(laws[body] in COEFFICIENT_SETS for body in "AB"):
        yield Fault("set", repr(chosen), f"only with one of {', '.join(COEFFICIENT_SETS)}")
