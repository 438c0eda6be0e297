"""The [friction] table: the friction law and what it depends on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator

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
    allow_laws,
    entry,
    exactly_one,
)

from .describe import format_pair

MOST_ORTHOTROPIC = 100.0
"""Ratio of the friction coefficients up to which contacts are known to be solved."""


def _at_rest(friction: dict[str, Any]) -> tuple[float, float]:
    """The coefficients at rest, where only they are given; without them mu is not known."""
    if friction["static"] is None:
        raise KeyError("static")
    return friction["static"]


def _axes_alike(entries: ValidEntries) -> Iterator[Fault]:
    mu = entries["mu"]
    if max(mu) > MOST_ORTHOTROPIC * min(mu) * (1.0 + 1e-12):
        allowed = f"one coefficient at most {MOST_ORTHOTROPIC:g} times the other"
        yield Fault("mu", f"{mu[0]:g} and {mu[1]:g}", allowed)


FALLING = ("kinetic", "half_speed")
"""What a law that falls with the speed of sliding is given by."""

POLACH = ("A", "B")
"""What Polach's may be given by in its place."""


def _warmer(pairs: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(late[0] <= early[0] for early, late in pairwise(pairs)):
        raise ValueError("pairs [temperature, factor] whose temperatures ascend")
    return pairs


Factors = Annotated[tuple[tuple[Real, Positive], ...], AfterValidator(_warmer)]


def describe_factors(factors: tuple[tuple[float, float], ...] | None) -> str:
    """Describe factors over the surface temperature by the first and the last; empty without."""
    if factors is None:
        return ""
    (cold, least), (hot, most) = factors[0], factors[-1]
    ends = f"times {least:g} at {cold:g} degC to {most:g} at {hot:g} degC"
    return f"; {ends} of the surface"


def _law_is_given(entries: ValidEntries) -> Iterator[Fault]:
    law, given = entries["law"], entries.given
    if isinstance(law, NamedLaw):
        return
    if law == "constant":
        idle = [key for key in ("static", *FALLING, *POLACH, "memory", "start") if key in given]
        if idle:
            cure = 'only with a law that falls: law = "exponential", "rational" or "polach"'
            yield Fault(", ".join(idle), 'with law = "constant"', cure)
        return
    polach = [key for key in POLACH if key in given]
    if polach and law != "polach":
        yield Fault(", ".join(polach), f'with law = "{law}"', f"{' and '.join(FALLING)}")
        return
    if polach and given.intersection(FALLING):
        told = f"together with {', '.join(key for key in FALLING if key in given)}"
        yield Fault(", ".join(polach), told, f"{' and '.join(FALLING)}, or {' and '.join(POLACH)}")
        return
    for key in POLACH if polach else FALLING:
        if key not in given:
            yield Fault(key, f'nothing, and law = "{law}"', "what the law falls to, and how fast")


def _kinetic_is_less(entries: ValidEntries) -> Iterator[Fault]:
    mu, kinetic = entries["mu"], entries["kinetic"]
    if kinetic is None or entries["law"] == "constant":
        return
    if any(less > more for less, more in zip(kinetic, mu, strict=True)):
        allowed = f"at most the coefficient at rest, {_pair(mu)}"
        yield Fault("kinetic", _pair(kinetic), allowed)
    elif not math.isclose(kinetic[0] * mu[1], kinetic[1] * mu[0], rel_tol=1e-9):
        allowed = "a pair in the ratio of that at rest: one law scales both coefficients"
        yield Fault("kinetic", _pair(kinetic), allowed)


def _pair(mu: tuple[float, float]) -> str:
    return f"{mu[0]:g}" if mu[0] == mu[1] else f"[{mu[0]:g}, {mu[1]:g}]"


FrictionName = Literal["constant", "exponential", "rational", "polach"]


class Friction(LawTable):
    """Orthotropic Coulomb friction; `angle` also turns the axes of the wear law.

    Both coefficients may fall with the local speed of sliding s, in the same ratio:
    kinetic + (static - kinetic) exp(-ln 2 s/half_speed), or .../(1 + s/half_speed).

    A law of another package has its parameters as further keys. It takes `mu`, `angle` in radians
    and the rolling speed `speed` from the scene if it has parameters of these names.

    Examples
    --------
    >>> ts.Friction(mu=(0.6, 0.3), angle=45.0).mu
    (0.6, 0.3)
    >>> ts.Friction(law="exponential", static=0.33, kinetic=0.14, half_speed=1250.0).mu
    (0.33, 0.33)
    """

    static: OptionalOrthotropicPositive = entry(
        "friction coefficients at rest, of a law that falls with sliding",
        "a number above 0, or a pair of them",
        None,
    )
    mu: OrthotropicPositive = entry(
        "friction coefficients along the axes e1, e2",
        "a number above 0, or a pair of them",
        default_factory=_at_rest,
    )
    angle: Real = entry(
        "angle from x to e1, degrees", "a number from -360 to 360", 0.0, ge=-360, le=360
    )
    law: FrictionName | NamedLaw = entry(
        "how friction falls with the local speed of sliding; all but the constant one need "
        "creepage.speed; or a law of another package",
        allow_laws(get_args(FrictionName)),
        "constant",
    )
    kinetic: OptionalOrthotropicPositive = entry(
        "friction coefficients at great speed",
        "a number above 0, or a pair in the ratio of that at rest",
        None,
    )
    half_speed: Positive | None = entry(
        "speed of sliding at which half of the way to it is gone, mm/s", default=None
    )
    A: Real | None = entry(
        "of Polach's law, in place of kinetic: what is left at great speed over that at rest",
        "a number from 0 to 1",
        None,
        ge=0,
        le=1,
    )
    B: Positive | None = entry(
        "of Polach's law, in place of half_speed: its rate of decay, s/m", default=None
    )
    memory: NotNegative = entry(
        "distance slid over which the coefficients follow the speed, mm; 0: at once",
        "a number of at least 0",
        0.0,
    )
    temperature: Factors | None = entry(
        "factor on the coefficients over the surface temperature, degrees C, linear between the "
        "pairs and constant beyond; needs [heat]",
        "pairs [temperature, factor], the temperatures ascending, the factors above 0",
        None,
        min_length=1,
    )
    strength: Positive | None = entry("shear strength that no traction exceeds, MPa", default=None)
    layer: NotNegative = entry(
        "shear compliance h/G3 of an interfacial layer, mm/MPa", "a number of at least 0", 0.0
    )
    start: Literal["rest", "sliding"] = entry(
        "where a falling law has several solutions: the one reached from friction at rest, or "
        "that from friction at great speed",
        '"rest" or "sliding"',
        "rest",
    )
    law_names: ClassVar[tuple[str, ...]] = get_args(FrictionName)
    law_fields: ClassVar[tuple[str, ...]] = ("static", *FALLING, *POLACH, "memory", "strength")
    checks: ClassVar[tuple[Check, ...]] = (
        exactly_one("mu", "static"),
        _axes_alike,
        _law_is_given,
        _kinetic_is_less,
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`: the law, and all that it depends on."""
        mu1, mu2 = self.mu
        text = f"isotropic, mu = {mu1:g}"
        if mu1 != mu2:
            text = f"orthotropic, mu = ({mu1:g}, {mu2:g}) at {self.angle:g} degrees"
        if self.share is not None:
            text += self._describe_fall(*self.share)
        if self.named_law:
            text += f", by the law {self.named_law}"
        text += describe_factors(self.temperature)
        if self.strength is not None:
            text += f"; no more than {self.strength:g} MPa"
        if self.layer:
            text += f"; through a layer of h/G3 = {self.layer:.4g} mm/MPa"
        yield Row("friction", text, brief=True)

    def _describe_fall(self, least: float, half: float) -> str:
        """Describe how friction falls with the sliding speed."""
        kinetic = format_pair(least * self.mu[0], least * self.mu[1])
        slid = f", after {self.memory:g} mm of sliding" if self.memory else ""
        first = "great speed" if self.start == "sliding" else "rest"
        return (
            f" at rest, falls to {kinetic}, {self.law}, half of the difference at {half:g} mm/s of "
            f"sliding{slid}; of several solutions the one reached from {first}"
        )

    @property
    def frame(self) -> Frame:
        """Scaled tribological frame of the coefficients at rest."""
        return Frame(self.mu, math.radians(self.angle))

    @property
    def varies(self) -> bool:
        """Whether the coefficients are other than at rest anywhere."""
        falls = self.share is not None
        return falls or self.strength is not None or self.temperature is not None

    @property
    def share(self) -> tuple[float, float] | None:
        """Share left at great speed, and the half speed, mm/s; None of what does not fall."""
        if self.law == "constant" or self.named_law:
            return None
        if self.A is not None:
            return self.A, 1e3 * math.log(2.0) / self.B
        return self.kinetic[0] / self.mu[0], self.half_speed
