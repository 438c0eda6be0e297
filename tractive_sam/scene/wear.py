"""The [wear] table: the wear law, its coefficients and the revolutions."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator, Field

from tractive_sam.schema import (
    Check,
    Fault,
    Integer,
    LawTable,
    NamedLaw,
    OptionalOrthotropicNotNegative,
    Positive,
    Real,
    Row,
    ValidEntries,
    describe_law_names,
    entry,
    optional,
)

from .describe import format_pair
from .friction import Factors, describe_factors
from .schedule import RevolutionSchedule, Schedule
from .wear_course import describe_densities, describe_stepping, describe_turns
from .wear_laws import (
    ALL_LAWS,
    BY_COEFFICIENT,
    COEFFICIENT_SETS,
    PER_INTENSITY,
    Coefficients,
    LawName,
    Sets,
    SpecificWearRate,
    WearLaws,
    check_coefficients,
    check_sets,
    laws_of_bodies,
)


def _check_save(entries: ValidEntries) -> Iterator[Fault]:
    """Report revolutions to be stored that lie beyond the last one."""
    save, last = entries["save"], entries["revolutions"]
    if save[-1] > last:
        yield Fault("save", str(save[-1]), f"at most {last}, the number of revolutions")


def _check_ascending(save: tuple[int, ...]) -> tuple[int, ...]:
    """Return revolutions unchanged; raise a ValueError unless they ascend."""
    if any(late <= early for early, late in pairwise(save)):
        raise ValueError("a list of ascending integers, each once: the revolutions to store")
    return save


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
        tuple[Annotated[Integer, Field(ge=0)], ...], AfterValidator(_check_ascending)
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
        "adaptive jumps over many revolutions, every revolution, or one jump to each revolution "
        "of save without error control",
        default="adaptive",
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
            inputs = "pressure and slip" if slip == "upwind" else "frictional work"
            return f"Archard, from {inputs}"
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
