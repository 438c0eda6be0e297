"""The [fatigue] table: what the cycles of stress do to the material."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator

from tractive_sam.schema import (
    Check,
    Fault,
    LawTable,
    NamedLaw,
    NotNegative,
    Positive,
    Row,
    Table,
    ValidEntries,
    allow_laws,
    entry,
    not_both,
    shorten,
)

from .tables import distinct

SENSITIVITIES = {
    "dang-van": (1.5, "3 (tau_e/sigma_e - 1/2)"),
    "crossland": (3.0 - math.sqrt(3.0), "3 tau_e/sigma_e - sqrt 3"),
    "findley": (10.0, "k, sigma_e/tau_e = 2 / (1 + k/sqrt(1 + k²))"),
    "fatemi-socie": (10.0, "k"),
}
"""Of each criterion that has one: up to which sensitivity it is valid, and what that is. The first
two have the fatigue limit in torsion reach that in bending there."""

MOST_EXPONENT = 100.0
"""Of a Woehler line: with more, a per cent of the stress is a factor of e in the life."""


def _something_asked(entries: ValidEntries) -> Iterator[Fault]:
    if not entries.given & {"shear_yield", "yield_strength", "limit"}:
        cure = "shear_yield or yield_strength for shakedown, limit for utilisation and damage"
        yield Fault("limit", "nothing, and no yield", cure)


def _sensitivity_of_the_criterion(entries: ValidEntries) -> Iterator[Fault]:
    criterion, given = entries["criterion"], entries["sensitivity"]
    if isinstance(criterion, NamedLaw):
        return
    if criterion not in SENSITIVITIES:
        if given is not None:
            yield Fault("sensitivity", shorten(given), f'nothing: "{criterion}" has none')
        return
    most, meaning = SENSITIVITIES[criterion]
    allowed = f'from 0 to below {most:.4g} for "{criterion}" ({meaning})'
    if given is None:
        if entries["limit"] is not None:
            yield Fault("sensitivity", "nothing", allowed)
    elif given >= most:
        yield Fault("sensitivity", shorten(given), allowed)


def _yield_of_the_criterion(entries: ValidEntries) -> Iterator[Fault]:
    if entries["criterion"] != "fatemi-socie" or entries["limit"] is None:
        return
    if not entries.given & {"shear_yield", "yield_strength"}:
        yield Fault("yield_strength", "nothing", 'a number above 0: "fatemi-socie" divides by it')


class FatigueVolume(Table):
    """Life of the whole volume under stress, with the probability that all of it survives.

    By Lundberg and Palmgren, or with a stress that does no harm by Ioannides and Harris; see
    `ts.VolumeLife`.

    Examples
    --------
    >>> ts.FatigueVolume(constant=1e-34).survival
    0.9
    """

    constant: float | None = entry(
        "constant of the material, N, mm and cycles; without it there is no life",
        "a number from 1e-100 to 1e100",
        None,
        ge=1e-100,
        le=1e100,
    )
    survival: float = entry(
        "probability that all of the volume survives the life",
        "a number above 0 and below 1",
        0.9,
        gt=0.0,
        lt=1.0,
    )
    slope: Positive | None = entry("slope of Weibull; by itself 10/9, of a line 9/8", default=None)
    limit: NotNegative = entry("stress that does no harm, MPa", "a number of at least 0", 0.0)
    stress_exponent: Positive = entry(
        "exponent of the stress", "a number above 0, at most 100", 31.0 / 3.0, le=MOST_EXPONENT
    )
    depth_exponent: NotNegative = entry(
        "exponent of the depth", "a number from 0 to 10", 7.0 / 3.0, le=10.0
    )


def _limit_of_the_volume(entries: ValidEntries) -> Iterator[Fault]:
    if entries["volume"] is not None and entries["limit"] is None:
        yield Fault("limit", "nothing", "a number above 0: [fatigue.volume] takes the criterion")


CriterionName = Literal["dang-van", "crossland", "findley", "fatemi-socie", "orthogonal-shear"]


class Fatigue(LawTable):
    """What rolling does to the material: shakedown, fatigue, and damage while it wears.

    With a yield stress there are the loads up to which the material can become elastic; with the
    limit of a criterion there are its utilisation and, by a Woehler line, the damage. All stress
    is elastic.

    A criterion of another package has its parameters as further keys. It takes the `yield_stress`
    in tension from the scene if it has a parameter of this name.

    Examples
    --------
    >>> steel = ts.Fatigue(shear_yield=300.0, sensitivity=0.333, limit=250.0)
    >>> steel.criterion, round(steel.yield_stress, 1)
    ('dang-van', 519.6)
    """

    shear_yield: Positive | None = entry("yield stress in shear k, MPa", default=None)
    yield_strength: Positive | None = entry("yield stress in tension, sqrt 3 k, MPa", default=None)
    criterion: CriterionName | NamedLaw = entry(
        "fatigue criterion",
        allow_laws(get_args(CriterionName)),
        "dang-van",
    )
    sensitivity: NotNegative | None = entry(
        "sensitivity of the criterion to normal stress: a of Dang Van and Crossland, k of Findley "
        "and Fatemi-Socie",
        "a number of at least 0, its upper bound depends on the criterion",
        None,
    )
    limit: Positive | None = entry(
        "limit of the criterion, MPa: utilisation is the equivalent stress over it", default=None
    )
    cycles: Positive = entry("life at a utilisation of 1, cycles", default=1e7)
    exponent: Positive = entry(
        "exponent of the Woehler line, life = cycles * utilisation ** -exponent",
        f"a number above 0, at most {MOST_EXPONENT:g}",
        10.0,
        le=MOST_EXPONENT,
    )
    knee: bool = entry("whether life is infinite below a utilisation of 1", "true or false", False)
    depth: Positive = entry("depth, in units of the semi-axis a", default=1.5)
    elements: int = entry(
        "points over the depth", "a whole number from 8 to 1e4", 24, ge=8, le=10**4
    )
    bodies: Annotated[tuple[Literal["A", "B"], ...], AfterValidator(distinct)] = entry(
        "bodies that are followed", 'a list of "A" and "B"', ("A", "B"), min_length=1
    )
    volume: FatigueVolume | None = entry("life of the whole volume under stress", default=None)
    tolerance: float = entry(
        "share of the largest damage: a jump of the stepping that would miss more than 0.3 of it "
        "is made shorter; what all miss together is the column damage_error, "
        "with the effects of the order of blocks and of the points of stress paths",
        "a number from 1e-6 to 1",
        1e-2,
        ge=1e-6,
        le=1.0,
    )
    law_key: ClassVar[str] = "criterion"
    law_names: ClassVar[tuple[str, ...]] = get_args(CriterionName)
    law_fields: ClassVar[tuple[str, ...]] = ("sensitivity",)
    checks: ClassVar[tuple[Check, ...]] = (
        not_both("shear_yield", "yield_strength"),
        _something_asked,
        _sensitivity_of_the_criterion,
        _yield_of_the_criterion,
        _limit_of_the_volume,
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`."""
        k, hertz = self.shear_yield_stress, scene.hertz
        shakedown = "left out: there is no shear_yield or yield_strength"
        if k is not None:
            bounds = "certain by Melan (rho_xx and rho_yy), impossible by Koiter"
            shakedown = f"k = {k:.6g} MPa: {bounds}"
        yield Row("bodies", ", ".join(self.bodies))
        yield Row("shakedown", shakedown)
        if k is not None and hertz is not None:
            ratio = f"{hertz.p0 / k:.3g} unworn; without friction a line shakes down up to 4"
            yield Row("p0/k", ratio)
        if self.limit is None:
            yield Row("utilisation and damage", "left out: there is no limit")
        else:
            life = f"{self.cycles:g} cycles at {self.limit:g} MPa, to the power -{self.exponent:g}"
            yield Row("life", f"{life}, infinite below" if self.knee else life)
        yield Row(
            "depths",
            f"{self.elements} to {self.depth:g} a; between the surface and one element below it "
            "stress changes with the root of the depth",
        )
        plastic = "above the shakedown limit the material yields, which is not modelled"
        yield Row("stress", f"elastic: {plastic}")
        yield Row("records", "every one; fields over (y, depth) with the fields that are stored")
        missing = "bending, residual stress from manufacture, hardness over the depth"
        yield Row("missing", missing)

    @property
    def yield_stress(self) -> float | None:
        """Yield stress in tension, MPa, by whichever is given; None without."""
        if self.yield_strength is not None:
            return self.yield_strength
        return None if self.shear_yield is None else math.sqrt(3.0) * self.shear_yield

    @property
    def shear_yield_stress(self) -> float | None:
        """Yield stress in shear k, MPa, by whichever is given; None without."""
        return None if self.yield_stress is None else self.yield_stress / math.sqrt(3.0)
