"""How far results on a mesh may be from those on an infinitely fine one.

Of an error C h^p two meshes, of elements sqrt(2) times apart, differ by (2^(p/2) - 1) C h^p. So the
error of the finer one is their difference times 1.0 where it falls with h² (equal bodies),
times 2.4 where it falls with h (different bodies; see `operators.stencil`). On top of that, where
the edges of contact and of stick fall within their elements scatters the results by about as much,
so that a small difference may be mere chance: the difference before is looked at as well, and what
is seen of one force is taken for all, since one traction causes them.

The largest stress at a surface may come closer by less. Where slip turns about its pole, and where
no elements resolve the end of stick, it is a cusp: its error falls with the root of h.

A peak contact pressure that grows on two refinements as no such error does may have no limit at
all, as at the edge of a step, nor has the stress below it then: their bars are infinite.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.results import BodyFatigue, Maximum, State
from tractive_sam.rolling import stressed_volume

SAFETY = 3.0
"""Error bar over the difference between the last two meshes (benchmarks/error_bars.py)."""

FORMER = 0.7
"""Weight of the difference before: 2^(-1/2), by which errors of first order fall."""

SURFACE_SAFETY, SURFACE_FORMER = 6.0, 0.84
"""The same two of the largest stress at a surface: 1/(2^(1/4) - 1) = 5.3, and 2^(-1/4)."""

GROWING = 0.9
"""Last growth of the peak contact pressure over the one before, above which it nears no limit."""

GROWN = 0.02
"""Least relative growth that is no chance."""

SHARED = 0.4
"""Least relative bar of a force over the largest of all forces, and over that for pressure."""

FORCES = ("Qx", "Qy", "Mz")
SHARING = (*FORCES, "p_max")


@dataclass(frozen=True)
class LargestStress:
    """Which of the largest stresses of a body.

    Attributes
    ----------
    column : str
        Where the larger one of both is recorded.
    body : "A" or "B"
        The body.
    surface : bool
        Whether it is that at the surface, or inside.
    """

    column: str
    body: str
    surface: bool


@dataclass(frozen=True)
class OfBody:
    """A column of one body.

    Attributes
    ----------
    column : str
        Where it is recorded.
    body : "A" or "B"
        The body.
    """

    column: str
    body: str


Name = str | LargestStress | OfBody
"""A recorded name, or one of the two stresses behind it."""

CYCLED = {
    "utilisation": "utilisation",
    "residual_shear": "shakedown_lower",
    "path_radius": "shakedown_upper",
}
"""Fields of `BodyFatigue`, and the columns of their largest values."""


@dataclass(frozen=True)
class Sample:
    """The quantities of one state on one mesh.

    Attributes
    ----------
    values : mapping of Name to float
        Those of stress as `LargestStress`.
    scales : mapping of Name to float
        What an error of each is relative to; zero of what the scene gives. Forces: the integral of
        the magnitude of the traction, for the moment times the mean radius of the contact.
        Temperatures: the largest rise above the bulk of a body.
    residual : float
        Relative residual of the contact conditions.
    factors : mapping of (str, str) to float
        Load factors of shakedown, by column and body.
    floors : mapping of Name to float
        Relative errors that no mesh shows: of utilisation and stressed volume by the points of a
        path.
    """

    values: Mapping[Name, float]
    scales: Mapping[Name, float]
    residual: float
    factors: Mapping[tuple[str, str], float] = field(default_factory=dict)
    floors: Mapping[Name, float] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        contact: State,
        maxima: Mapping[str, Maximum],
        cycled: Mapping[str, BodyFatigue] | None = None,
    ) -> Self:
        """Return the sample of a contact, the largest stresses in its bodies, and their fatigue."""
        cycled = cycled or {}
        numbers = _contact_numbers(contact)
        for body, stress in maxima.items():
            interior = float(np.nan_to_num(stress.interior))
            column = f"{stress.criterion.name}_max"
            numbers |= _largest_stresses(column, body, interior, stress.surface, stress.value)
        for body, fatigue in cycled.items():
            numbers |= _fatigue_numbers(contact, body, fatigue)
        values = {name: value for name, (value, _) in numbers.items()}
        scales = {name: scale for name, (_, scale) in numbers.items()}
        factors = {
            (column, body): getattr(fatigue, column)
            for body, fatigue in cycled.items()
            for column in ("shakedown_lower", "shakedown_upper")
        }
        return cls(values, scales, contact.residual, factors, _path_errors(contact, values, cycled))


Numbers = dict[Name, tuple[float, float]]
"""Values with the scales of their errors."""


def _contact_numbers(contact: State) -> Numbers:
    """Return the numbers of the contact itself."""
    names = ("P", *FORCES, "xi_x", "xi_y", "approach", "p_max")
    values = {name: float(getattr(contact, name)) for name in names}
    values["wear_max"] = float(contact.wear.max())
    force = float(np.hypot(*contact.traction).sum() * contact.grid.element_area)
    arm = contact.half_width_x
    if math.isfinite(contact.half_width_y):
        arm = math.sqrt(arm * contact.half_width_y)
    creepage = math.hypot(contact.xi_x, contact.xi_y, contact.spin * arm)
    scales = {name: abs(value) for name, value in values.items()}
    scales |= {"Qx": force, "Qy": force, "Mz": force * arm, "xi_x": creepage, "xi_y": creepage}
    scales |= dict.fromkeys(off_given(contact), 0.0)
    if contact.heat is not None:
        hottest = contact.heat.temperature_max
        rise = max(abs(hottest - bulk) for bulk in contact.scene.heat.bulks.values())
        for name in ("temperature_max", "temperature_mean"):
            values[name], scales[name] = getattr(contact.heat, name), rise
    return {name: (value, scales[name]) for name, value in values.items()}


def _largest_stresses(
    column: str, body: str, interior: float, surface: float, largest: float
) -> Numbers:
    """Return the largest stress inside a body and that at its surface."""
    inside, outside = (LargestStress(column, body, at_surface) for at_surface in (False, True))
    return {inside: (interior, largest), outside: (surface, largest)}


def _fatigue_numbers(contact: State, body: str, fatigue: BodyFatigue) -> Numbers:
    """Return the numbers of the fatigue of a body, without those that have no value."""
    numbers: Numbers = {}
    for name, column in CYCLED.items():
        most = fatigue.largest(name)
        if not math.isnan(most.value):
            numbers |= _largest_stresses(column, body, most.interior, most.surface, most.value)
    damage = fatigue.damage_max[0] if fatigue.damage.size else 0.0
    numbers[OfBody("damage", body)] = damage, damage
    if contact.scene.fatigue.volume is not None:
        volume = stressed_volume(fatigue, contact.scene, Laws.of(contact.scene).volume)
        numbers[OfBody("stressed_volume", body)] = volume, volume
    return numbers


def _path_errors(
    contact: State, values: Mapping[Name, float], cycled: Mapping[str, BodyFatigue]
) -> dict[Name, float]:
    """Return the relative errors of utilisation and stressed volume by the points of a path."""
    floors: dict[Name, float] = {}
    for body, cycle in cycled.items():
        if cycle.criterion is None:
            continue
        error = cycle.criterion.path_error
        floors |= {LargestStress("utilisation", body, at): error for at in (False, True)}
        volume = values.get(OfBody("stressed_volume", body), 0.0)
        if volume > 0.0:
            stressed = replace(cycle, utilisation=cycle.utilisation * (1.0 + error))
            more = stressed_volume(stressed, contact.scene, Laws.of(contact.scene).volume)
            floors[OfBody("stressed_volume", body)] = more / volume - 1.0
    return floors


def off_given(contact: State) -> dict[str, float]:
    """How far the quantities that the scene gives are from what it gives, by their names."""
    load, creepage = contact.scene.load, contact.scene.creepage
    given = {
        "P": contact.scene.normal_load,
        "approach": load.approach,
        "Qx": load.force_x,
        "xi_x": creepage.longitudinal if load.force_x is None else None,
        "Qy": load.force_y,
        "xi_y": creepage.lateral if load.force_y is None else None,
    }
    return {
        name: abs(float(getattr(contact, name)) - value)
        for name, value in given.items()
        if value is not None
    }


def relative_error_bars(coarse: Sample, middle: Sample, fine: Sample) -> dict[Name, float]:
    """Error bars of the finest of three samples, over its scales.

    Parameters
    ----------
    coarse, middle, fine : Sample
        The same state on meshes of elements sqrt(2) times apart.

    Returns
    -------
    dict of Name to float
        By the names of the values; inf of a peak that may have no limit.
    """
    seen = {
        name: _seen(name, *(mesh.values[name] for mesh in (coarse, middle, fine))) / scale
        if scale > 0.0
        else 0.0
        for name, scale in fine.scales.items()
    }
    if math.isinf(seen["p_max"]):
        seen |= {name: math.inf for name in seen if _at_surface(name)}
    shared = SHARED * max(seen[name] for name in FORCES)
    for name, scale in fine.scales.items():
        if scale > 0.0:
            floor = max(shared, fine.residual) if name in SHARING else fine.residual
            seen[name] = max(seen[name], floor, fine.floors.get(name, 0.0))
    return seen


def _at_surface(name: Name) -> bool:
    return isinstance(name, LargestStress) and name.surface


def _seen(name: Name, coarse: float, middle: float, fine: float) -> float:
    """How far the finest value of a quantity may be from its limit, by what meshes differ."""
    if isinstance(name, LargestStress) and not name.surface and 0.0 in (coarse, middle):
        return 0.0  # there was no maximum; where there comes to be one, it is well resolved
    early, late = middle - coarse, fine - middle
    if name == "p_max" and late > GROWN * fine and late > GROWING * early > 0.0:
        return math.inf
    safety, former = (SURFACE_SAFETY, SURFACE_FORMER) if _at_surface(name) else (SAFETY, FORMER)
    return safety * max(abs(late), former * abs(early))


def error_bars(relative: Mapping[Name, float], fine: Sample) -> dict[str, Any]:
    """Error bars in units of the quantities, by their names; of stress a mapping from bodies.

    Parameters
    ----------
    relative : mapping of Name to float
        From `relative_error_bars`.
    fine : Sample
        The sample on the finest mesh.
    """
    bars: dict[str, Any] = {}
    for name, share in relative.items():
        if isinstance(name, str):
            bars[name] = share * fine.scales[name]
        elif isinstance(name, OfBody):
            bars.setdefault(name.column, {})[name.body] = share * fine.scales[name]
        elif name.surface:
            inside = replace(name, surface=False)
            high, deep = fine.values[name], fine.values[inside]
            by_high, by_deep = (relative[k] * fine.scales[k] for k in (name, inside))
            top = max(deep, high)
            # Either may turn out to be the larger one.
            above = max(deep + by_deep, high + by_high) - top
            below = top - max(deep - by_deep, high - by_high)
            bar = float(max(above, below))
            factor = fine.factors.get((name.column, name.body))
            if factor is not None:
                bar = _of_factor(factor, top, bar)
            bars.setdefault(name.column, {})[name.body] = bar
    return bars


def _of_factor(factor: float, shear: float, bar: float) -> float:
    """The bar of a load factor, which goes with one over a shear stress; inf where that is 0."""
    return factor * bar / (shear - bar) if bar < shear else math.inf
