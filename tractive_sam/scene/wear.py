"""The [wear] table: the wear law, its coefficients and the revolutions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator, Field

from tractive_sam.schema import (
    Check,
    Fault,
    LawTable,
    NamedLaw,
    OptionalOrthotropicNotNegative,
    Real,
    Row,
    ValidEntries,
    Whole,
    allow_laws,
    entry,
)

from .describe import format_pair
from .friction import Factors, describe_factors
from .wear_laws import (
    ALL_LAWS,
    BY_COEFFICIENT,
    OF_SETS,
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


def _saved_within(entries: ValidEntries) -> Iterator[Fault]:
    save, last = entries["save"], entries["revolutions"]
    if save[-1] > last:
        yield Fault("save", str(save[-1]), f"at most {last}, the number of revolutions")


def _ascending(save: tuple[int, ...]) -> tuple[int, ...]:
    if any(late <= early for early, late in pairwise(save)):
        raise ValueError("ascending whole numbers")
    return save


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
        f"{ALL_LAWS}, {{ table = [[W, rate], ...] }}, {{ A = ..., B = ... }}, {allow_laws(())}",
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
        check_coefficients,
        check_sets,
        _saved_within,
    )

    effect: ClassVar[str] = "wear"

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`: coefficients, law, revolutions, and the share of each body."""
        rates = f"{self._describe_rates()}{describe_factors(self.temperature)}"
        counted = f"; {self.revolutions} revolutions" if self.revolutions else ""
        yield Row("wear", rates + counted, brief=True)
        yield Row("law", self._describe_law(scene.solver.slip))
        yield Row("worn depth", self._describe_share(scene), brief=True)
        yield from self._describe_course(scene)
        yield Row("density", _describe_densities(scene.body), brief=True)
        if scene.solver.slip == "upwind":
            yield Row("slip", "the paper's upwind difference: frictional work comes out too small")

    def _describe_course(self, scene: Any) -> Iterator[Row]:
        """Yield the rows about revolutions, or about the distance of a [transient]."""
        if not self.revolutions:
            place = "the material" if scene.schedule.rolls else "its place, as nothing rolls,"
            yield Row("depth", f"stays with {place} and is part of the gap of the next step")
            return
        stepping = "one by one"
        if self.stepping == "adaptive":
            stepping = (
                f"in adaptive jumps, with an error of {self.tolerance:g} of the wear depth, and "
                "their contacts to a residual of no more"
            )
        yield Row("revolutions", f"{self.revolutions}, {stepping}")
        yield Row("fields stored at", ", ".join(map(str, self.save)))
        yield Row("turns", self._describe_turns(scene.turns.per_count), brief=True)

    def _describe_rates(self) -> str:
        """Describe the coefficients, and whether they are of both bodies together."""
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
            return f"k = {k.A:g} {unit} of body A and {k.B:g} of B; of both together {both}"
        return f"{both}, of both bodies together"

    def _describe_body(self, body: str) -> str:
        """Describe the law of one body."""
        law, chosen = self.laws[body], self.sets[body]
        if law in BY_COEFFICIENT:
            k = f"k = {getattr(self.coefficient, body):g}"
            return f"Holm-Archard, {k} mm3/(N m)" if law == "archard" else f"by work, {k} mm3/J"
        if law == "table":
            return f"T-gamma/A of each {self.by}, a table of {len(self.law.table)} points"
        if law is None:
            return "does not wear"
        inputs = {"usfd": f"T-gamma/A of each {self.by}", "brr": "T-gamma of each contact"}
        sets = OF_SETS[law]
        source = sets[chosen][1] if law == "jendel" else sets[chosen].source
        return f"{inputs.get(law, 'sliding speed and p/H')}, {chosen}: {source}"

    def _describe_law(self, slip: str) -> str:
        """Describe the quantity that the wear law uses, with a discretisation of the slip."""
        if self.named_law:
            return "from another package"
        if self.law == "energy":
            return "by the work of friction"
        if self.law == "archard":
            inputs = "pressure and slip" if slip == "upwind" else "the work of friction"
            return f"Holm-Archard by {inputs}"
        return "each body has a law"

    def _describe_share(self, scene: Any) -> str:
        """Describe the share of each body in the worn depth, and its reason."""
        if not self.together:
            return "of each body by its law"
        share, bodies = scene.wear_share, scene.body
        reason = "no hardness is given"
        if self.share is not None:
            reason = "by their coefficients"
        elif "hardness" in bodies.A.model_fields_set:
            reason = f"inverse to their hardness, {bodies.A.hardness:g} and {bodies.B.hardness:g}"
        return f"{share['A']:.3g} from body A, {share['B']:.3g} from B: {reason}"

    def _describe_turns(self, turns: Mapping[str, float]) -> str:
        """Describe which revolutions N counts, and how often each body meets its wear again."""
        if self.turns == "equal":
            return "equal: N counts the revolutions of body A; both return to the contact in each"
        counted, other = "AB" if turns["A"] else "BA"
        count = f"N counts the revolutions of body {counted}"
        if turns[other] == 0.0:
            return (
                f"{count}; {other} is flat and never returns to the contact: it enters unworn, and "
                "its depth is that of a single pass"
            )
        return (
            f"{count}; {other} turns {turns[other]:.6g} times in each. Each body meets its own "
            "wear again, averaged over the phase; slip is not counted"
        )

    @property
    def laws(self) -> dict[str, str | None]:
        """Name of the law of each body; None of one that does not wear."""
        return laws_of_bodies(self.law)

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


def _describe_densities(bodies: Any) -> str:
    """Describe the densities that turn worn volume into mass, and whether they are assumed."""
    densities = []
    for name in "AB":
        body = getattr(bodies, name)
        given = "" if "density" in body.model_fields_set else " (of steel, not given)"
        densities.append(f"{name} {body.density:g} kg/m3{given}")
    return ", ".join(densities)
