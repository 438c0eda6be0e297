"""The [wear] table: wear laws and their coefficients, the revolutions and their steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator, Field

from tractive_sam.mechanics import BRR, JENDEL, USFD
from tractive_sam.schema import (
    Check,
    Fault,
    Integer,
    LawTable,
    NamedLaw,
    NotNegative,
    OptionalOrthotropicNotNegative,
    Positive,
    Real,
    Row,
    Table,
    ValidEntries,
    ascending,
    describe_law_names,
    entry,
    exactly_one,
    optional,
)

from .friction import Factors, describe_factors
from .schedule import RevolutionSchedule, Schedule
from .tables import format_pair

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


def check_layers_wear(entries: ValidEntries) -> Iterator[Fault]:
    """Report wear that thins layers in scenes for which it is not computed."""
    if entries["wear"] is None or entries["wear.layer_step"] is None:
        return
    value, laws = f"{entries['wear.layer_step']:g}", entries["wear.law"]
    if not entries["body"].is_layered:
        yield Fault("wear.layer_step", f"{value}, without layers", "[[body.A.layer]], or no key")
    if isinstance(laws, WearLaws):
        yield Fault("wear.layer_step", f"{value}, with laws of each body", "one law for both")


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


def describe_stepping(wear: Any, scene: Any) -> str:
    """Describe how [wear] proceeds: each revolution, adaptive jumps, or stored ones only."""
    if wear.stepping == "every-revolution":
        return "one by one"
    if wear.stepping == "saved":
        return f"in {len(wear.save)} jumps, without control of their error"
    if scene.has("wheel"):
        depth = f" of at most {wear.step_depth:g} mm" if wear.step_depth else ""
        return f"in adaptive steps{depth}, with an error of {wear.tolerance:g} of the wear depth"
    return (
        f"in adaptive jumps, with an error of {wear.tolerance:g} of the wear depth; "
        "the residual of their contacts is at most this value"
    )


def describe_turns(counting: str, turns: Mapping[str, float]) -> str:
    """Describe which revolutions N counts, and when worn material returns to the contact.

    Parameters
    ----------
    counting : str
        The key wear.turns.
    turns : mapping of str to float
        Turns of "A" and "B" per counted revolution.
    """
    if counting == "equal":
        return "equal: N counts the revolutions of body A; both bodies turn once in each"
    counted, second = "AB" if turns["A"] else "BA"
    count = f"N counts the revolutions of body {counted}"
    if turns[second] == 0.0:
        return (
            f"{count}; {second} is flat and passes the contact only once: it enters unworn, and "
            "its depth is the wear of a single pass"
        )
    times = "once" if turns[second] == 1.0 else f"{turns[second]:.6g} times"
    return (
        f"{count}; {second} turns {times} in each. Worn material returns after a turn of its body, "
        "averaged over the phase; slip is not counted"
    )


def describe_densities(bodies: Any) -> str:
    """Describe the densities that turn worn volume into mass, and whether they are assumed."""
    densities = []
    for name in "AB":
        body = getattr(bodies, name)
        origin = "" if "density" in body.model_fields_set else " (steel, by default)"
        densities.append(f"{name} {body.density:g} kg/m3{origin}")
    return ", ".join(densities)


def _check_save(entries: ValidEntries) -> Iterator[Fault]:
    """Report revolutions to be stored that lie beyond the last one."""
    save, last = entries["save"], entries["revolutions"]
    if save[-1] > last:
        yield Fault("save", str(save[-1]), f"at most {last}, the number of revolutions")


class Wear(LawTable):
    """Wear law, its coefficients, and the revolutions to roll.

    The law is Archard's law, or a law based on frictional work or on measured wear regimes. With
    [transient], the bodies wear over the rolling distance of the transient.

    The parameters of a law of another package are further keys. If the law has parameters `mu`,
    `angle` (in radians) or `speed` (rolling speed), it receives them from the scene.

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
        "wear law: archard (pressure and slip), energy (frictional work), or usfd, brr and jendel "
        "(measured regimes)",
        f"{ALL_LAWS}, {{ table = [[W, rate], ...] }}, {{ A = ..., B = ... }}, "
        + describe_law_names(()),
        "archard",
    )
    set: str | Sets | None = optional(
        "name of the coefficient set of a measured law", "a name, or { A = ..., B = ... }"
    )
    by: Literal["element", "contact"] = entry(
        "area A for laws that depend on T-gamma/A: each element, or the complete contact",
        default="element",
    )
    intensity: OptionalOrthotropicNotNegative = optional(
        "wear intensities along the axes e1, e2 for the sum of both bodies, 1/MPa"
    )
    coefficient: SpecificWearRate = optional(
        "specific wear rates k along the axes e1, e2, mm3/(N m), or for the energy law, mm3/J "
        "of the work along each axis; for the sum of both bodies, or for each body",
        "a number of at least 0, a pair of them, or { A = ..., B = ... }",
    )
    revolutions: Integer = entry(
        "number of revolutions of body A, or of body B if A is flat; not with [transient]",
        "an integer from 1 to 1e12; required without [transient]",
        0,
        ge=1,
        le=10**12,
    )
    save: Annotated[
        tuple[Annotated[Integer, Field(ge=0)], ...],
        ascending("a list of ascending integers, each once: the revolutions to store"),
    ] = entry(
        "revolutions at which fields are stored",
        "ascending whole numbers from 0",
        default_factory=lambda wear: tuple(sorted({0, wear["revolutions"]})),
        min_length=1,
    )
    temperature: Factors | None = optional(
        "factor on the wear depth as a function of the surface temperature, degrees C; linear "
        "between the pairs and constant beyond; requires [heat]",
        "pairs [temperature, factor] with ascending temperatures and factors above 0",
        min_length=1,
    )
    stepping: Literal["adaptive", "every-revolution", "saved"] = entry(
        "adaptive jumps over many revolutions, every revolution, or revolution 1 and one jump to "
        "each revolution of save without error control",
        default="adaptive",
    )
    layer_step: Real | None = optional(
        "share of the thickness of a layer, [[body.A.layer]], at whose wear the layer becomes "
        "thinner; where it is worn through, the contact continues with what lies below; without "
        "it, layers remain as thick as they are",
        "a number above 0, at most 0.5",
        gt=0,
        le=0.5,
    )
    turns: Literal["each", "equal"] = entry(
        "return of the worn profiles to the contact: each after one revolution of its body, or "
        "both after one revolution of A",
        '"each" or "equal" (the paper\'s, for bodies of equal circumference)',
        "each",
    )
    tolerance: Real = entry(
        "error of the adaptive stepping, divided by the wear depth", default=1e-3, gt=0, le=0.1
    )
    step_depth: Positive | None = optional(
        "largest depth that an adaptive step removes from the profiles of wheel and rail, mm; "
        "by default, only the tolerance limits it"
    )
    law_names: ClassVar[tuple[str, ...]] = get_args(LawName)
    law_fields: ClassVar[tuple[str, ...]] = ("set", "by", "intensity", "coefficient")
    checks: ClassVar[tuple[Check, ...]] = (check_coefficients, check_sets, _check_save)

    effect: ClassVar[str] = "wear"

    @property
    def schedule(self) -> Schedule:
        """Schedule over the revolutions: last one, ones to store, and kind of steps."""
        adaptive, fixed = self.stepping == "adaptive", self.stepping == "saved"
        return RevolutionSchedule(self.revolutions, self.save, adaptive, fixed)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: wear coefficients, law, revolutions, share of each body, density.

        Parameters as in `Table.describe`.
        """
        rates = f"{self._describe_rates()}{describe_factors(self.temperature)}"
        counted = f"; {self.revolutions} revolutions" if self.revolutions else ""
        yield Row("wear", rates + counted, brief=True)
        yield Row("law", self._describe_law(scene.solver.slip))
        yield Row("wear depth", self._describe_share(scene), brief=True)
        yield from self._describe_course(scene)
        yield Row("density", describe_densities(scene.body), brief=True)
        if scene.solver.slip == "upwind":
            yield Row("slip", "the upwind difference of the paper: frictional work is too small")

    def _describe_course(self, scene: Any) -> Iterator[Row]:
        """Yield rows on the revolutions to roll, or on the wear of a [transient]."""
        if not self.revolutions:
            place = "material" if scene.schedule.rolls else "place, as nothing rolls"
            yield Row("depth", f"remains at its {place}, and is part of the gap of the next step")
            return
        yield Row("revolutions", f"{self.revolutions}, {describe_stepping(self, scene)}")
        if scene.has("wheel"):
            passes = scene.rail.passes_per_revolution
            text = "worn along their normals, without smoothing; fields are not stored"
            yield Row("profiles", text)
            yield Row("passes", f"{passes:g} over the rail per revolution of the wheel")
            return
        yield Row("fields stored at", ", ".join(map(str, self.save)))
        yield Row("turns", describe_turns(self.turns, scene.turns.per_count), brief=True)

    def _describe_rates(self) -> str:
        """Describe the wear coefficients, and whether they apply to both bodies together."""
        if self.named_law:
            return str(self.named_law)
        if not self.together:
            of_A, of_B = (self._describe_body(body) for body in "AB")
            return f"A and B: {of_A}" if of_A == of_B else f"A: {of_A}; B: {of_B}"
        i1, i2 = self.intensities
        k = self.coefficient
        unit = "mm3/J" if self.law == "energy" else "mm3/(N m)"
        both = f"k = {format_pair(PER_INTENSITY * i1, PER_INTENSITY * i2)} {unit}"
        if self.law == "archard":
            both = f"i = {format_pair(i1, i2)} /MPa, {both}"
        if isinstance(k, Coefficients):
            return f"k = {k.A:g} {unit} for body A and {k.B:g} for B; sum of both bodies {both}"
        return f"{both}, sum of both bodies"

    def _describe_body(self, body: str) -> str:
        """Describe the wear law and coefficients of one body."""
        law, name = self.laws[body], self.sets[body]
        if law in BY_COEFFICIENT:
            k = f"k = {getattr(self.coefficient, body):g}"
            return f"Archard, {k} mm3/(N m)" if law == "archard" else f"energy, {k} mm3/J"
        if isinstance(self.law, WearLaws) and law == "table":
            return f"T-gamma/A of each {self.by}, a table of {len(self.law.table or ())} points"
        if law is None or name is None:
            return "does not wear"
        inputs = {"usfd": f"T-gamma/A of each {self.by}", "brr": "T-gamma of the contact"}
        sets = COEFFICIENT_SETS[law]
        source = sets[name][1] if law == "jendel" else sets[name].source
        return f"{inputs.get(law, 'sliding speed and p/H')}, {name}: {source}"

    def _describe_law(self, slip: str) -> str:
        """Describe the quantity on which the wear law depends, for a discretisation of the slip."""
        if self.named_law:
            return "from another package"
        if self.law == "energy":
            return "energy: depth proportional to the frictional work"
        if self.law == "archard":
            through = "" if slip == "upwind" else ", computed from the frictional work"
            return f"Archard, from pressure and slip{through}"
        return "a separate law for each body"

    def _describe_share(self, scene: Any) -> str:
        """Describe the share of each body in the wear depth, and its reason."""
        if not self.together:
            return "computed for each body from its law"
        share, bodies = scene.wear_share, scene.body
        reason = "equal, as no hardness is given"
        if self.share is not None:
            reason = "from their coefficients"
        elif "hardness" in bodies.A.model_fields_set:
            reason = f"inverse to the hardness, {bodies.A.hardness:g} and {bodies.B.hardness:g}"
        return f"{share['A']:.3g} from body A, {share['B']:.3g} from B: {reason}"

    @property
    def laws(self) -> dict[str, str | None]:
        """Name of the wear law of each body; None for a body that does not wear."""
        return laws_of_bodies(self.law)

    @property
    def together(self) -> bool:
        """Whether one wear law gives the depth of both bodies, which they then share."""
        return self.law in BY_COEFFICIENT or self.named_law is not None

    @property
    def sets(self) -> dict[str, str | None]:
        """Set of published coefficients of each body, by default the first; None without sets."""
        names: dict[str, str | None] = {}
        for body, law in self.laws.items():
            name = getattr(self.set, body) if isinstance(self.set, Sets) else self.set
            sets = COEFFICIENT_SETS.get(law or "")
            names[body] = None if sets is None else name or next(iter(sets))
        return names

    @property
    def intensities(self) -> tuple[float, float]:
        """Wear intensities along both axes, 1/MPa, sum of both bodies."""
        if self.intensity is not None:
            return self.intensity
        k = self.coefficient
        if isinstance(k, Coefficients):
            k = ((k.A or 0.0) + (k.B or 0.0),) * 2
        assert k is not None  # as the checks of the table require
        return (k[0] / PER_INTENSITY, k[1] / PER_INTENSITY)

    def per_work(self, mu: tuple[float, float]) -> tuple[float, float] | None:
        """Return wear depth per work and area along both axes, 1/MPa; None without coefficients."""
        if self.law not in BY_COEFFICIENT:
            return None
        i = self.intensities
        return i if self.law == "energy" else (i[0] / mu[0], i[1] / mu[1])

    @property
    def share(self) -> dict[str, float] | None:
        """Share of each body in the wear depth from coefficients A and B; None without them."""
        k = self.coefficient
        if not (isinstance(k, Coefficients) and self.together):
            return None
        A, B = k.A or 0.0, k.B or 0.0
        share = A / (A + B) if A + B else 0.5
        return {"A": share, "B": 1.0 - share}
