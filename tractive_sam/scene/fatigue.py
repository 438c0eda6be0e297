"""The [fatigue] table: shakedown, fatigue criterion and Wöhler curve of the material."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator

from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    LawTable,
    NamedLaw,
    NotNegative,
    Positive,
    Row,
    Table,
    ValidEntries,
    describe_law_names,
    entry,
    not_both,
    optional,
    shorten,
)

from .tables import check_distinct

_MAX_EXPONENT = 100.0
"""Exponent of a Wöhler curve for which 1 % of the stress changes the life by a factor of e."""


def _check_table_has_purpose(entries: ValidEntries) -> Iterator[Fault]:
    """Report a table with neither a yield stress nor a limit."""
    if not entries.given & {"shear_yield", "yield_strength", "limit"}:
        cure = "[fatigue] shear_yield or yield_strength (shakedown), limit (utilisation), in MPa"
        yield Fault("limit", "nothing, and no yield stress", cure)


def _check_sensitivity(entries: ValidEntries) -> Iterator[Fault]:
    """Report a sensitivity that is missing, too large or unused by the fatigue criterion."""
    # Upper bound and definition of the sensitivity, for each criterion with a sensitivity. At the
    # bounds of the first two the fatigue limit in torsion equals that in bending.
    sensitivities = {
        "dang-van": (1.5, "3 (tau_e/sigma_e - 1/2), torsion and bending limits"),
        "crossland": (3.0 - math.sqrt(3.0), "3 tau_e/sigma_e - sqrt 3, torsion, bending limits"),
        "findley": (10.0, "k, sigma_e/tau_e = 2 / (1 + k/sqrt(1 + k²)), bending, torsion limits"),
        "fatemi-socie": (10.0, "k"),
    }
    criterion, value = entries["criterion"], entries["sensitivity"]
    if isinstance(criterion, NamedLaw):
        return
    if criterion not in sensitivities:
        if value is not None:
            yield Fault("sensitivity", shorten(value), f'nothing: "{criterion}" has no sensitivity')
        return
    upper, meaning = sensitivities[criterion]
    allowed = f'from 0 to below {upper:.4g} for "{criterion}" ({meaning})'
    if value is None:
        if entries["limit"] is not None:
            yield Fault("sensitivity", "nothing", allowed)
    elif value >= upper:
        yield Fault("sensitivity", shorten(value), allowed)


def _check_yield_of_criterion(entries: ValidEntries) -> Iterator[Fault]:
    """Report a missing yield stress that "fatemi-socie" needs, if a fatigue limit is set."""
    if entries["criterion"] != "fatemi-socie" or entries["limit"] is None:
        return
    if not entries.given & {"shear_yield", "yield_strength"}:
        yield Fault("yield_strength", "nothing", 'a number above 0, which "fatemi-socie" needs')


class FatigueVolume(Table):
    """Fatigue life of the stressed volume, with a Weibull slope.

    The law is that of Lundberg and Palmgren or, with a stress limit, the law of Ioannides and
    Harris; see `ts.VolumeLife`.

    Examples
    --------
    >>> ts.FatigueVolume(constant=1e-34).survival
    0.9
    """

    constant: float | None = optional(
        "material constant A, in N, mm and cycles; without this key, no life is computed",
        ge=1e-100,
        le=1e100,
    )
    survival: float = entry(
        "survival probability of the complete volume", default=0.9, gt=0.0, lt=1.0
    )
    slope: Positive | None = optional(
        "Weibull slope; the default is 10/9, or 9/8 for a line contact"
    )
    limit: NotNegative = entry("stress below which there is no damage, MPa", default=0.0)
    stress_exponent: Positive = entry(
        "exponent of the stress", default=31.0 / 3.0, le=_MAX_EXPONENT
    )
    depth_exponent: NotNegative = entry("exponent of the depth", default=7.0 / 3.0, le=10.0)


def _check_limit_is_given(entries: ValidEntries) -> Iterator[Fault]:
    """Report a user-defined criterion, or [fatigue.volume], without the limit of the criterion."""
    if entries["limit"] is not None:
        return
    if isinstance(entries["criterion"], NamedLaw):
        yield Fault("limit", "nothing", f"a number above 0, which {entries['criterion']} needs")
    if entries["volume"] is not None:
        cure = "a number above 0: [fatigue.volume] needs the utilisation of the criterion"
        yield Fault("limit", "nothing", cure)


CriterionName = Literal["dang-van", "crossland", "findley", "fatemi-socie", "orthogonal-shear"]


class Fatigue(LawTable):
    """Shakedown limits, fatigue criterion, life, and damage during wear.

    The shakedown limits follow from a yield stress. The utilisation follows from the fatigue limit
    of the criterion, and the damage from the utilisation and a Wöhler curve. The stress is
    computed for elastic material.

    The parameters of a criterion of another package are further keys. If the criterion has a
    parameter `yield_stress` (in tension), it receives the value from the scene.

    Examples
    --------
    >>> steel = ts.Fatigue(shear_yield=300.0, sensitivity=0.333, limit=250.0)
    >>> steel.criterion, round(steel.yield_stress, 1)
    ('dang-van', 519.6)
    """

    shear_yield: Positive | None = optional("yield stress in shear k, MPa")
    yield_strength: Positive | None = optional("yield stress in tension, sqrt 3 k, MPa")
    criterion: CriterionName | NamedLaw = entry(
        "fatigue criterion", describe_law_names(get_args(CriterionName)), "dang-van"
    )
    sensitivity: NotNegative | None = optional(
        "sensitivity of the criterion to normal stress: a for Dang Van and Crossland, k for "
        "Findley and Fatemi-Socie",
        "a number of at least 0; the upper bound depends on the criterion",
    )
    limit: Positive | None = optional(
        "fatigue limit of the criterion, MPa; the utilisation is the equivalent stress divided "
        "by this limit"
    )
    cycles: Positive = entry("number of cycles to failure at a utilisation of 1", default=1e7)
    exponent: Positive = entry(
        "exponent of the Wöhler curve, life = cycles * utilisation ** -exponent",
        default=10.0,
        le=_MAX_EXPONENT,
    )
    knee: bool = entry("whether life is infinite below a utilisation of 1", default=False)
    depth: Positive = entry("depth, in units of the semi-axis a", default=1.5)
    elements: int = entry("number of points along the depth", default=24, ge=8, le=10**4)
    bodies: Annotated[tuple[Literal["A", "B"], ...], AfterValidator(check_distinct)] = entry(
        "bodies for which fatigue is computed", default=("A", "B"), min_length=1
    )
    volume: InnerTable[FatigueVolume | None] = optional("life of the stressed volume")
    tolerance: float = entry(
        "error of the damage, divided by the largest damage; a jump is shortened if its error "
        "exceeds 0.3 times this tolerance; the column damage_error contains the total error",
        default=1e-2,
        ge=1e-6,
        le=1.0,
    )
    law_key: ClassVar[str] = "criterion"
    law_names: ClassVar[tuple[str, ...]] = get_args(CriterionName)
    law_fields: ClassVar[tuple[str, ...]] = ("sensitivity",)
    checks: ClassVar[tuple[Check, ...]] = (
        not_both("shear_yield", "yield_strength"),
        _check_table_has_purpose,
        _check_sensitivity,
        _check_yield_of_criterion,
        _check_limit_is_given,
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: bodies, shakedown limits, life and depths of the fatigue analysis."""
        k, hertz = self.shear_yield_stress, scene.hertz
        shakedown = "left out: neither shear_yield nor yield_strength is given"
        if k is not None:
            bounds = "certain by Melan (rho_xx and rho_yy), impossible by Koiter"
            shakedown = f"k = {k:.6g} MPa: {bounds}"
        yield Row("bodies", ", ".join(self.bodies))
        yield Row("shakedown", shakedown)
        if k is not None and hertz is not None:
            ratio = f"{hertz.p0 / k:.3g} unworn; shakedown limit of a frictionless line contact: 4"
            yield Row("p0/k", ratio)
        if self.limit is None:
            yield Row("utilisation and damage", "left out: limit is not given")
        else:
            life = f"{self.cycles:g} cycles at {self.limit:g} MPa, to the power -{self.exponent:g}"
            yield Row("life", f"{life}, infinite below" if self.knee else life)
        yield Row(
            "depths",
            f"{self.elements} down to {self.depth:g} a; between the surface and the depth of one "
            "element the stress changes with the square root of the depth",
        )
        plastic = "yielding above the shakedown limit is not modelled"
        yield Row("stress", f"elastic: {plastic}")
        missing = "bending, residual stress from manufacture, hardness over the depth"
        yield Row("not included", missing)

    @property
    def yield_stress(self) -> float | None:
        """Yield stress in tension, MPa, as set or sqrt(3) times k; None if neither is set."""
        if self.yield_strength is not None:
            return self.yield_strength
        return None if self.shear_yield is None else math.sqrt(3.0) * self.shear_yield

    @property
    def shear_yield_stress(self) -> float | None:
        """Yield stress in shear k, MPa, as set or from tension over sqrt(3); None without both."""
        return None if self.yield_stress is None else self.yield_stress / math.sqrt(3.0)
