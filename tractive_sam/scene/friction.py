"""The [friction] table: the friction law and what it depends on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, get_args

from tractive_sam.mechanics import Frame
from tractive_sam.schema import (
    Check,
    Fault,
    LawTable,
    NamedLaw,
    NotNegative,
    OptionalOrthotropicPositive,
    OrthotropicPositive,
    Positive,
    Real,
    Row,
    ValidEntries,
    ascending,
    describe_law_names,
    entry,
    exactly_one,
    optional,
)

from .tables import format_pair


def without_zero_friction(tables: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """Return the tables of a scene, without [friction] if it only states mu = 0: frictionless."""
    match tables.get("friction"):
        case {"mu": 0 | [0, 0], **others} if not {*others} - {"angle"}:
            return {**tables, "friction": None}
    return tables


def _mu_at_rest(friction: dict[str, Any]) -> tuple[float, float]:
    """Return the `static` coefficients, the default of `mu`; a KeyError without them."""
    if friction["static"] is None:
        raise KeyError("static")
    return friction["static"]


def _check_ratio_of_coefficients(entries: ValidEntries, largest: float = 100.0) -> Iterator[Fault]:
    """Report mu1 and mu2 with a ratio that is larger than the solvers are tested for."""
    mu = entries["mu"]
    if max(mu) > largest * min(mu) * (1.0 + 1e-12):
        allowed = f"one coefficient at most {largest:g} times the other"
        yield Fault("mu", f"{mu[0]:g} and {mu[1]:g}", allowed)


_FALLING = ("kinetic", "half_speed")
"""Keys of a law that falls with the sliding speed."""

_POLACH = ("A", "B")
"""Keys of Polach's law that may replace them."""


Factors = Annotated[
    tuple[tuple[Real, Positive], ...],
    ascending("pairs [temperature, factor] with ascending temperatures"),
]

LateralFactors = Annotated[
    tuple[tuple[Real, Positive], ...], ascending("pairs [y, factor] with ascending y")
]


def describe_factors(factors: tuple[tuple[float, float], ...] | None) -> str:
    """Describe factors over temperature by their first and last pair; "" for None."""
    if factors is None:
        return ""
    (cold, first), (hot, last) = factors[0], factors[-1]
    ends = f"times {first:g} at {cold:g} degC to {last:g} at {hot:g} degC"
    return f"; {ends} of surface temperature"


def _check_parameters_of_law(entries: ValidEntries) -> Iterator[Fault]:
    """Report missing and superfluous parameters of a friction law."""
    law, keys_of_table = entries["law"], entries.given
    if isinstance(law, NamedLaw):
        return
    if law == "constant":
        if entries["memory"] and entries["temperature"] is None:
            cure = (
                "friction.temperature, or a law that falls with the sliding speed: constant "
                "friction has nothing to adapt to"
            )
            yield Fault("memory", f'{entries["memory"]:g} with law = "constant"', cure)
        keys = ("static", *_FALLING, *_POLACH, "start")
        if unused := [key for key in keys if key in keys_of_table]:
            cure = 'only with a falling law: law = "exponential", "rational" or "polach"'
            yield Fault(", ".join(unused), 'with law = "constant"', cure)
        return
    polach = [key for key in _POLACH if key in keys_of_table]
    if polach and law != "polach":
        yield Fault(", ".join(polach), f'with law = "{law}"', f"{' and '.join(_FALLING)}")
        return
    if polach and keys_of_table.intersection(_FALLING):
        falling = f"with {', '.join(key for key in _FALLING if key in keys_of_table)}"
        allowed = f"{' and '.join(_FALLING)}, or {' and '.join(_POLACH)}"
        yield Fault(", ".join(polach), falling, allowed)
        return
    needed = _POLACH if polach else _FALLING
    for key in needed:
        if key not in keys_of_table:
            allowed = f"{' and '.join(needed)}: the limit at high speed, and how fast it falls"
            yield Fault(key, f'nothing, and law = "{law}"', allowed)


def _check_kinetic(entries: ValidEntries) -> Iterator[Fault]:
    """Report kinetic coefficients above those at rest, or in another ratio mu1/mu2."""
    mu, kinetic = entries["mu"], entries["kinetic"]
    if kinetic is None or entries["law"] == "constant":
        return
    if any(low > high for low, high in zip(kinetic, mu, strict=True)):
        allowed = f"at most the coefficient at rest, {_format_pair(mu)}"
        yield Fault("kinetic", _format_pair(kinetic), allowed)
    elif not math.isclose(kinetic[0] * mu[1], kinetic[1] * mu[0], rel_tol=1e-9):
        allowed = "a pair in the ratio of the coefficients at rest: both fall in proportion"
        yield Fault("kinetic", _format_pair(kinetic), allowed)


def _format_pair(mu: tuple[float, float]) -> str:
    """Return coefficients as in a scene file: one number if they are equal."""
    return f"{mu[0]:g}" if mu[0] == mu[1] else f"[{mu[0]:g}, {mu[1]:g}]"


FrictionName = Literal["constant", "exponential", "rational", "polach"]


class Friction(LawTable):
    """Orthotropic Coulomb friction, constant or falling with sliding speed.

    If the law falls with the local sliding speed s, each coefficient is kinetic + (static -
    kinetic) f, with f = exp(-ln 2 s/half_speed), or f = 1/(1 + s/half_speed) for the rational law.
    `angle` also rotates the axes of the wear law. In a scene, `mu` = 0 without a law means that the
    contact is frictionless, as without the table.

    The parameters of a law of another package are further keys. If the law has parameters `mu`,
    `angle` (in radians) or `speed` (rolling speed), it receives them from the scene.

    Examples
    --------
    >>> ts.Friction(mu=(0.6, 0.3), angle=45.0).mu
    (0.6, 0.3)
    >>> ts.Friction(law="exponential", static=0.33, kinetic=0.14, half_speed=1250.0).mu
    (0.33, 0.33)
    """

    key_advice: ClassVar[Mapping[str, str]] = {"mu_s": "static", "mu_k": "kinetic"}
    static: OptionalOrthotropicPositive = optional(
        "friction coefficients at rest, for a law that falls with the sliding speed"
    )
    mu: OrthotropicPositive = entry(
        "friction coefficients along the axes e1, e2", default_factory=_mu_at_rest
    )
    angle: Real = entry("angle from x to e1, degrees", default=0.0, ge=-360, le=360)
    law: FrictionName | NamedLaw = entry(
        "friction law; all laws except the constant one fall with the local sliding speed and "
        "require creepage.speed",
        describe_law_names(get_args(FrictionName)),
        "constant",
    )
    kinetic: OptionalOrthotropicPositive = optional(
        "friction coefficients at high sliding speed",
        "a number above 0, or a pair in the ratio of the coefficients at rest",
    )
    half_speed: Positive | None = optional(
        "sliding speed at which half of the decrease has occurred, mm/s"
    )
    A: Real | None = optional(
        "ratio of the friction at high speed to the friction at rest, for Polach's law instead "
        "of kinetic",
        ge=0,
        le=1,
    )
    B: Positive | None = optional("rate of decay, s/m, for Polach's law instead of half_speed")
    memory: NotNegative = entry(
        "sliding distance over which the coefficients adapt to sliding speed and temperature, mm; "
        "with 0, they adapt immediately",
        default=0.0,
    )
    temperature: Factors | None = optional(
        "factor on the friction coefficients as a function of the surface temperature, degrees "
        "C; linear between the pairs and constant beyond; requires [heat]",
        "pairs [temperature, factor] with ascending temperatures and factors above 0",
        min_length=1,
    )
    across: LateralFactors | None = optional(
        "factor on the friction coefficients as a function of the lateral position y, mm, for "
        "example for a wet stripe; linear between the pairs and constant beyond; with [wheel], the "
        "position on the rail in the track, outward",
        "pairs [y, factor] with ascending y and factors above 0",
        min_length=1,
    )
    strength: Positive | None = optional("shear strength: upper limit of the traction, MPa")
    layer: NotNegative = entry("shear compliance h/G3 of an interfacial layer, mm/MPa", default=0.0)
    start: Literal["rest", "sliding"] = entry(
        "solution to compute if there are several: the one reached from friction at rest, or "
        "from friction at high sliding speed; in a transient, the solution with less or with more "
        "sliding in every step",
        default="rest",
    )
    law_names: ClassVar[tuple[str, ...]] = get_args(FrictionName)
    law_fields: ClassVar[tuple[str, ...]] = ("static", *_FALLING, *_POLACH, "memory", "strength")
    checks: ClassVar[tuple[Check, ...]] = (
        exactly_one("mu", "static"),
        _check_ratio_of_coefficients,
        _check_parameters_of_law,
        _check_kinetic,
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: the friction law, its coefficients and what they depend on.

        Parameters as in `Table.describe`.
        """
        mu1, mu2 = self.mu
        text = f"isotropic, mu = {mu1:g}"
        if mu1 != mu2:
            text = f"orthotropic, mu = ({mu1:g}, {mu2:g}) at {self.angle:g} degrees"
        if self.share is not None:
            text += self._describe_fall(*self.share)
        if self.named_law:
            text += f", with the law {self.named_law}"
        text += describe_factors(self.temperature)
        if self.temperature is not None and self.memory and self.share is None:
            text += f", over {self.memory:g} mm of sliding"
        if self.across is not None:
            (left, first), (right, last) = self.across[0], self.across[-1]
            text += f"; times {first:g} at y = {left:g} mm to {last:g} at {right:g} mm"
        if self.strength is not None:
            text += f"; traction at most {self.strength:g} MPa"
        if self.layer:
            text += f"; interfacial layer with h/G3 = {self.layer:.4g} mm/MPa"
        yield Row("friction", text, brief=True)

    def _describe_fall(self, lowest: float, half_speed: float) -> str:
        """Describe how friction falls with the sliding speed."""
        kinetic = format_pair(lowest * self.mu[0], lowest * self.mu[1])
        memory = f", over {self.memory:g} mm of sliding" if self.memory else ""
        start = "high sliding speed" if self.start == "sliding" else "rest"
        return (
            f" at rest, falls to {kinetic} ({self.law}), by half of the difference at a sliding "
            f"speed of {half_speed:g} mm/s{memory}; of several solutions the one reached from "
            f"{start}"
        )

    @property
    def frame(self) -> Frame:
        """Scaled tribological frame of the coefficients at rest."""
        return Frame(self.mu, math.radians(self.angle))

    @property
    def varies(self) -> bool:
        """Whether the traction bound differs from constant coefficients times pressure."""
        factors = self.temperature, self.across, self.strength
        return self.falls or any(factor is not None for factor in factors)

    @property
    def falls(self) -> bool:
        """Whether the coefficients fall with the sliding speed."""
        return self.share is not None and self.share[0] < 1.0

    @property
    def share(self) -> tuple[float, float] | None:
        """(Friction at high speed over that at rest, half speed in mm/s); None if constant."""
        if self.law == "constant" or self.named_law:
            return None
        if self.A is not None and self.B is not None:
            return self.A, 1e3 * math.log(2.0) / self.B
        assert self.kinetic is not None  # as the checks of the table require
        assert self.half_speed is not None
        return self.kinetic[0] / self.mu[0], self.half_speed
