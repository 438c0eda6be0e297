"""The [wear] table: the wear law, its coefficients and the revolutions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, get_args

from pydantic import AfterValidator, Field

from tractive_sam.mechanics import BRR, JENDEL, USFD

from .alternatives import exactly_one
from .faults import Fault
from .friction import Factors
from .named_law import ANOTHER, LawTable, NamedLaw
from .quantities import NotNegative, OptionalOrthotropicNotNegative, Real, Whole, entry
from .table import Check, Known, Table


def _saved_within(known: Known) -> Iterator[Fault]:
    save, last = known["save"], known["revolutions"]
    if save[-1] > last:
        yield Fault("save", str(save[-1]), f"at most {last}, the number of revolutions")


def _ascending(save: tuple[int, ...]) -> tuple[int, ...]:
    if any(late <= early for early, late in pairwise(save)):
        raise ValueError("ascending whole numbers")
    return save


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
    from .quantities import Accepting, Pair

    SpecificWearRate = Accepting[
        float | Pair | Coefficients | Mapping[str, float] | None, Pair | Coefficients | None
    ]
else:
    SpecificWearRate = OptionalOrthotropicNotNegative | Coefficients

LawName = Literal["archard", "energy", "usfd", "brr", "jendel"]
LawOrTable = Literal[LawName, "table"]
_LAWS = '"archard", "energy", "usfd", "brr" or "jendel"'

OF_SETS = {"usfd": USFD, "brr": BRR, "jendel": JENDEL}
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


def _laws_of_what(known: Known) -> Iterator[Fault]:
    table, bodies = known["table"], (known["A"], known["B"])
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
        "law of body A; without one it does not wear", f'{_LAWS}, or "table"', None
    )
    B: LawOrTable | None = entry(
        "law of body B; without one it does not wear", f'{_LAWS}, or "table"', None
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


def _laws(law: str | WearLaws | NamedLaw) -> dict[str, str | None]:
    """Name of the law of each body."""
    if not isinstance(law, WearLaws):
        return {"A": str(law), "B": str(law)}
    both = "table" if law.A is None and law.B is None else None
    return {"A": law.A or both, "B": law.B or both}


def _given_what_its_law_takes(known: Known) -> Iterator[Fault]:
    if isinstance(known["law"], NamedLaw):
        return
    laws = _laws(known["law"])
    taking = [body for body, name in laws.items() if name in BY_COEFFICIENT]
    either = known.given & {"intensity", "coefficient"}
    together = known["law"] in BY_COEFFICIENT
    if not taking:
        for key in sorted(either):
            yield Fault(
                key, f"with the law {known['law']!r}", "nothing: its coefficients are known"
            )
        return
    if known["law"] == "archard":
        yield from exactly_one("intensity", "coefficient")(known)
    elif "intensity" in either:
        cure = "coefficient: mm3/J of the energy law, or { A = ..., B = ... } of each body"
        yield Fault("intensity", "not with this law", cure)
    elif "coefficient" not in either:
        yield Fault("coefficient", "nothing", "that of the bodies whose law takes one")
    if "coefficient" not in either:
        return
    k = known["coefficient"]
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


def _sets_are_known(known: Known) -> Iterator[Fault]:
    laws, given = _laws(known["law"]), known["set"]
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


class Wear(LawTable):
    """Wear over many revolutions or a [transient], by Archard's law or by others.

    A law of another package has its parameters as further keys. It takes `mu`, `angle` in radians
    and the rolling speed `speed` from the scene if it has parameters of these names.

    Examples
    --------
    >>> ts.Wear(intensity=2e-6, revolutions=15000).stepping
    'adaptive'
    >>> ts.Wear(coefficient=2e-3, revolutions=15000).intensities
    (2e-06, 2e-06)
    >>> ts.Wear(law="usfd", revolutions=15000).sets
    {'A': 'r8t-uic60', 'B': 'r8t-uic60'}
    """

    law: LawName | WearLaws | NamedLaw = entry(
        "wear law: by pressure and slip, by frictional work, or by measured regimes; or a law of "
        "another package",
        f"{_LAWS}, {{ table = [[W, rate], ...] }}, {{ A = ..., B = ... }}, {ANOTHER}",
        "archard",
    )
    set: str | Sets | None = entry(
        "named set of coefficients of a measured law",
        "a name, or { A = ..., B = ... }",
        None,
    )
    by: Literal["element", "contact"] = entry(
        "whether a law of T-gamma/A is taken by each element, or by the whole contact",
        '"element" or "contact"',
        "element",
    )
    intensity: OptionalOrthotropicNotNegative = entry(
        "wear intensities along the axes e1, e2, of both bodies together, 1/MPa",
        "a number of at least 0, or a pair of them",
        None,
    )
    coefficient: SpecificWearRate = entry(
        "specific wear rates k along the axes e1, e2, mm3/(N m), or of the energy law, in mm3/J of "
        "the work along each axis; of both bodies together, or of each on its own",
        "a number of at least 0, a pair of them, or { A = ..., B = ... }",
        None,
    )
    revolutions: Whole = entry(
        "number of revolutions of body A, of B where A is flat; none with [transient]",
        "a whole number from 1 to 1e12, which only a scene with [transient] may leave out",
        0,
        ge=1,
        le=10**12,
    )
    save: Annotated[tuple[Annotated[Whole, Field(ge=0)], ...], AfterValidator(_ascending)] = entry(
        "revolutions whose fields are stored",
        "ascending whole numbers from 0",
        default_factory=lambda wear: tuple(sorted({0, wear["revolutions"]})),
        min_length=1,
    )
    temperature: Factors | None = entry(
        "factor on the wear over the surface temperature, degrees C, linear between the pairs and "
        "constant beyond; needs [heat]",
        "pairs [temperature, factor], the temperatures ascending, the factors above 0",
        None,
        min_length=1,
    )
    stepping: Literal["adaptive", "every-revolution"] = entry(
        "stepping through the revolutions", '"adaptive" or "every-revolution"', "adaptive"
    )
    turns: Literal["each", "equal"] = entry(
        "whether each body meets its wear again at its own turns, or both at those of A",
        '"each" or "equal" (the paper\'s, for bodies of equal circumference)',
        "each",
    )
    tolerance: Real = entry(
        "error of the adaptive stepping, relative to the wear depth",
        "a number above 0, at most 0.1",
        1e-3,
        gt=0,
        le=0.1,
    )
    law_names: ClassVar[tuple[str, ...]] = get_args(LawName)
    law_fields: ClassVar[tuple[str, ...]] = ("set", "by", "intensity", "coefficient")
    checks: ClassVar[tuple[Check, ...]] = (
        _given_what_its_law_takes,
        _sets_are_known,
        _saved_within,
    )

    @property
    def laws(self) -> dict[str, str | None]:
        """Name of the law of each body; None of one that does not wear."""
        return _laws(self.law)

    @property
    def together(self) -> bool:
        """Whether one law wears both bodies together, each by its share."""
        return self.law in BY_COEFFICIENT or self.named_law is not None

    @property
    def sets(self) -> dict[str, str | None]:
        """Name of the set of coefficients of each body, where its law has sets."""
        found = {}
        for body, law in self.laws.items():
            given = self.set if isinstance(self.set, str | None) else getattr(self.set, body)
            found[body] = (given or next(iter(OF_SETS[law]))) if law in OF_SETS else None
        return found

    @property
    def intensities(self) -> tuple[float, float]:
        """Wear intensities (i1, i2) of both bodies together, 1/MPa, by whichever key is given."""
        if self.intensity is not None:
            return self.intensity
        k = self.coefficient
        if isinstance(k, Coefficients):
            k = ((k.A or 0.0) + (k.B or 0.0),) * 2
        return (k[0] / PER_INTENSITY, k[1] / PER_INTENSITY)

    def per_work(self, mu: tuple[float, float]) -> tuple[float, float] | None:
        """Depth worn over frictional work per area along the axes, 1/MPa; None of other laws."""
        if self.law not in BY_COEFFICIENT:
            return None
        i = self.intensities
        return i if self.law == "energy" else (i[0] / mu[0], i[1] / mu[1])

    @property
    def share(self) -> dict[str, float] | None:
        """Share of each body in the depth worn; None where only hardness tells it."""
        k = self.coefficient
        if not (isinstance(k, Coefficients) and self.together):
            return None
        share = k.A / (k.A + k.B) if k.A + k.B else 0.5
        return {"A": share, "B": 1.0 - share}
