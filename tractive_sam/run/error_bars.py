"""Error bars from meshes that each have twice the elements of the last, against an accuracy.

With an error C h^p, results on two meshes with element sizes in the ratio sqrt(2) differ by
(2^(p/2) - 1) C h^p. So the error of the finer one is their difference times 1.0 if it falls with h²
(equal bodies), and times 2.4 if it falls with h (different bodies; see `operators.stencil`). The
positions of the edges of contact and of stick within their elements scatter the results by about as
much, and a small difference may be chance. So the previous difference counts as well, and the
relative error bar of each force is at least 0.4 times the largest one of all forces, since one
traction causes them.

The largest stress at a surface may converge more slowly. If slip turns about its pole, or no
elements resolve the end of stick, the stress has a cusp: its error falls with the root of h.

A peak contact pressure that grows on two refinements faster than these errors may have no limit, as
at the edge of a step, and the stress below it may have none. Their error bars are infinite.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.contact import Gap, Laws, choose_grid
from tractive_sam.results import BodyFatigue, Grid, History, Maximum, State
from tractive_sam.rolling import stressed_volume
from tractive_sam.scene import Scene
from tractive_sam.schema import required


class Levels:
    """Meshes to refine a scene with [accuracy]: a level has twice the total elements of the last.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy].
    measured : Gap, optional
        Measured separation of the scene.
    """

    first: ClassVar[int] = -4
    """Coarsest level: a quarter of the usual elements along each axis."""

    needed: ClassVar[int] = 3
    """Number of meshes that an error bar needs."""

    def __init__(self, scene: Scene, measured: Gap | None):
        self._scene, self._measured = scene, measured

    def grid(self, level: int) -> Grid:
        """Return the mesh of a level (0: the usual one), before it grows with the contact."""
        return choose_grid(self._scene, self._measured, finer=2.0 ** (0.5 * level))

    def allowed(self, level: int) -> bool:
        """Return whether a level has few enough elements for the scene; the first levels always."""
        few = level < self.first + self.needed
        most = required(self._scene.accuracy, "accuracy").elements
        return few or math.prod(self.grid(level).elements) <= most

    def find_level(self, grid: Grid) -> int:
        """Return the level of a mesh, which may have grown; raise a LookupError for other meshes.

        Raises
        ------
        LookupError
            If the mesh is of no level of this scene.
        """
        level = self.first
        while self.grid(level).dx > 0.99 * grid.dx:
            equal = math.isclose(self.grid(level).dx, grid.dx, rel_tol=1e-9)
            if equal and math.isclose(self.grid(level).dy, grid.dy, rel_tol=1e-9):
                return level
            level += 1
        raise LookupError(f"{grid} is none of the meshes that the scene gives")


def set_tolerances(scene: Scene) -> Scene:
    """Return the scene with solver and wear tolerances for its accuracy, unless it sets them."""
    tolerance = required(scene.accuracy, "accuracy").tolerance
    entries = scene.entries()
    changes = {}
    if "tolerance" not in entries.get("solver", {}):
        changes["solver.tolerance"] = max(0.01 * tolerance, 1e-8)  # of the contact conditions
    if "wear" in entries and "tolerance" not in entries["wear"]:
        # With adaptive steps this accurate, meshes differ by their resolution only.
        changes["wear.tolerance"] = min(tolerance, 2e-4)
    return scene.replace(**changes)


FORCES = ("Qx", "Qy", "Mz")


@dataclass(frozen=True)
class BodyStress:
    """Name of a largest stress in a `Sample`: its column, its body, inside or at the surface.

    Attributes
    ----------
    column : str
        Column that records the larger of both.
    body : "A" or "B"
        The body.
    surface : bool
        Whether it is the largest stress at the surface, or inside.
    """

    column: str
    body: str
    surface: bool


@dataclass(frozen=True)
class BodyColumn:
    """Name of a quantity of one body in a `Sample`: its column and its body.

    Attributes
    ----------
    column : str
        Name of the column.
    body : "A" or "B"
        The body.
    """

    column: str
    body: str


Name = str | BodyStress | BodyColumn
"""Name of a quantity, or one of the two stresses behind it."""


@dataclass(frozen=True)
class Sample:
    """Values of the quantities of a contact on one mesh, with their scales.

    Attributes
    ----------
    values : mapping of Name to float
        Quantities by name; stresses by `BodyStress`.
    scales : mapping of Name to float
        Reference of the relative error of each quantity; zero for prescribed quantities. Forces:
        the integral of the magnitude of the traction, times the mean radius of the contact for the
        moment. Temperatures: the largest rise above the bulk of a body.
    residual : float
        Relative residual of the contact conditions.
    factors : mapping of (str, str) to float
        Load factors of shakedown, by column and body.
    floors : mapping of Name to float
        Relative errors that do not depend on the mesh: of utilisation and stressed volume by the
        points of a path.
    """

    values: Mapping[Name, float]
    scales: Mapping[Name, float]
    residual: float
    factors: Mapping[tuple[str, str], float] = field(default_factory=dict)
    floors: Mapping[Name, float] = field(default_factory=dict)

    @classmethod
    def from_contact(
        cls,
        contact: State,
        maxima: Mapping[str, Maximum],
        fatigue: Mapping[str, BodyFatigue] | None = None,
    ) -> Self:
        """Return the sample of a contact: its values, largest stresses and fatigue values."""
        fatigue = fatigue or {}
        numbers = _contact_numbers(contact)
        for body, stress in maxima.items():
            interior = float(np.nan_to_num(stress.interior))
            column = f"{required(stress.criterion, 'criterion').name}_max"
            numbers |= _largest_stresses(column, body, interior, stress.surface, stress.value)
        for body, cycle in fatigue.items():
            numbers |= _fatigue_numbers(contact, body, cycle)
        values = {name: value for name, (value, _) in numbers.items()}
        scales = {name: scale for name, (_, scale) in numbers.items()}
        factors = {
            (column, body): getattr(cycle, column)
            for body, cycle in fatigue.items()
            for column in ("shakedown_lower", "shakedown_upper")
        }
        return cls(
            values, scales, contact.residual, factors, _path_errors(contact, values, fatigue)
        )


Numbers = dict[Name, tuple[float, float]]
"""Values with the scales of their errors."""


def _contact_numbers(contact: State) -> Numbers:
    """Return (value, scale) of forces, pressure, wear depth and the like, by name."""
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
    scales |= dict.fromkeys(deviations_from_prescribed(contact), 0.0)
    if contact.heat is not None:
        hottest = contact.heat.temperature_max
        bulks = required(contact.scene.heat, "heat").bulks
        rise = max(abs(hottest - bulk) for bulk in bulks.values())
        for name in ("temperature_max", "temperature_mean"):
            values[name], scales[name] = getattr(contact.heat, name), rise
    return {name: (value, scales[name]) for name, value in values.items()}


def _largest_stresses(
    column: str, body: str, interior: float, surface: float, largest: float
) -> Numbers:
    """Return (value, scale) of the largest stress inside a body and at its surface, by name."""
    inside, outside = (BodyStress(column, body, at_surface) for at_surface in (False, True))
    return {inside: (interior, largest), outside: (surface, largest)}


def _fatigue_numbers(contact: State, body: str, fatigue: BodyFatigue) -> Numbers:
    """Return (value, scale) of the fatigue of a body, by name; missing values are left out."""
    # Fields of `BodyFatigue`, and the columns of their largest values.
    fatigue_columns = {
        "utilisation": "utilisation",
        "residual_shear": "shakedown_lower",
        "path_radius": "shakedown_upper",
    }
    numbers: Numbers = {}
    for name, column in fatigue_columns.items():
        largest = fatigue.largest(name)
        if not math.isnan(largest.value):
            numbers |= _largest_stresses(
                column, body, largest.interior, largest.surface, largest.value
            )
    damage = fatigue.damage_max[0] if fatigue.damage.size else 0.0
    numbers[BodyColumn("damage", body)] = damage, damage
    if (law := Laws.of(contact.scene).volume) is not None:
        volume = stressed_volume(fatigue, contact.scene, law)
        numbers[BodyColumn("stressed_volume", body)] = volume, volume
    return numbers


def _path_errors(
    contact: State, values: Mapping[Name, float], fatigue: Mapping[str, BodyFatigue]
) -> dict[Name, float]:
    """Return relative errors, by name, of fatigue values due to the sampling of stress paths."""
    floors: dict[Name, float] = {}
    for body, cycle in fatigue.items():
        if cycle.criterion is None:
            continue
        error = cycle.criterion.path_error
        floors |= {BodyStress("utilisation", body, at): error for at in (False, True)}
        volume = values.get(BodyColumn("stressed_volume", body), 0.0)
        law = Laws.of(contact.scene).volume
        if law is not None and volume > 0.0:
            stressed = replace(cycle, utilisation=cycle.utilisation * (1.0 + error))
            more = stressed_volume(stressed, contact.scene, law)
            floors[BodyColumn("stressed_volume", body)] = more / volume - 1.0
    return floors


def deviations_from_prescribed(contact: State) -> dict[str, float]:
    """Return the distance of each prescribed quantity from its prescribed value, by name."""
    load, creepage = contact.scene.load, contact.scene.creepage
    prescribed = {
        "P": contact.scene.normal_load,
        "approach": load.approach,
        "Qx": load.force_x,
        "xi_x": creepage.longitudinal if load.force_x is None else None,
        "Qy": load.force_y,
        "xi_y": creepage.lateral if load.force_y is None else None,
    }
    return {
        name: abs(float(getattr(contact, name)) - value)
        for name, value in prescribed.items()
        if value is not None
    }


def relative_error_bars(coarse: Sample, middle: Sample, fine: Sample) -> dict[Name, float]:
    """Return the relative error bars of the finest of three samples, by name.

    Parameters
    ----------
    coarse, middle, fine : Sample
        Samples of one state on meshes with element sizes in the ratio sqrt(2).

    Returns
    -------
    dict of Name to float
        Relative error bars; inf for a peak that may have no limit.
    """
    sharing = (*FORCES, "p_max")
    seen = {
        name: _error_bar(name, *(mesh.values[name] for mesh in (coarse, middle, fine))) / scale
        if scale > 0.0
        else 0.0
        for name, scale in fine.scales.items()
    }
    if math.isinf(seen["p_max"]):
        seen |= {name: math.inf for name in seen if _at_surface(name)}
    # Least bar of a force and of the pressure, over the largest bar of all forces.
    shared = 0.4 * max(seen[name] for name in FORCES)
    for name, scale in fine.scales.items():
        if scale > 0.0:
            floor = max(shared, fine.residual) if name in sharing else fine.residual
            seen[name] = max(seen[name], floor, fine.floors.get(name, 0.0))
    return seen


def _at_surface(name: Name) -> bool:
    """Return whether a name stands for the largest stress at a surface."""
    return isinstance(name, BodyStress) and name.surface


def _error_bar(name: Name, coarse: float, middle: float, fine: float) -> float:
    """Return a value's error bar on the finest of three meshes; infinite for a diverging peak."""
    if isinstance(name, BodyStress) and not name.surface and 0.0 in (coarse, middle):
        return 0.0  # there was no maximum; once it appears, it is well resolved
    early, late = middle - coarse, fine - middle
    # A peak that grows by more than chance, nearly as much as before, nears no limit.
    if name == "p_max" and late > 0.02 * fine and late > 0.9 * early > 0.0:
        return math.inf
    # The safety on the last difference (benchmarks/error_bars.py), and the weight of the previous
    # one: 2^(-1/2), by which errors of first order fall. At a surface they fall with the root of
    # the element size: 1/(2^(1/4) - 1) = 5.3, and 2^(-1/4).
    safety, previous = (6.0, 0.84) if _at_surface(name) else (3.0, 0.7)
    return safety * max(abs(late), previous * abs(early))


def error_bars(relative: Mapping[Name, float], fine: Sample) -> dict[str, Any]:
    """Return error bars in units of the quantities, by name (and by body).

    Parameters
    ----------
    relative : mapping of Name to float
        Relative error bars, from `relative_error_bars`.
    fine : Sample
        The sample on the finest mesh.
    """
    bars: dict[str, Any] = {}
    for name, share in relative.items():
        if isinstance(name, str):
            bars[name] = share * fine.scales[name]
        elif isinstance(name, BodyColumn):
            bars.setdefault(name.column, {})[name.body] = share * fine.scales[name]
        elif name.surface:
            inside = replace(name, surface=False)
            high, deep = fine.values[name], fine.values[inside]
            by_high, by_deep = (relative[k] * fine.scales[k] for k in (name, inside))
            top = max(deep, high)
            # Inside or surface: each may turn out to be the larger one.
            above = max(deep + by_deep, high + by_high) - top
            below = top - max(deep - by_deep, high - by_high)
            bar = float(max(above, below))
            factor = fine.factors.get((name.column, name.body))
            if factor is not None:
                # A load factor is inverse to a shear stress.
                bar = factor * bar / (top - bar) if bar < top else math.inf
            bars.setdefault(name.column, {})[name.body] = bar
    return bars


@dataclass(frozen=True)
class Assessment:
    """Error bars of one contact, and a note if they are wider than the tolerance.

    Attributes
    ----------
    error_bars : mapping of str to float
        See `State`; empty if too few meshes were solved.
    missed : str
        The error bar that is too wide, and what to do; empty if all are within the tolerance.
    """

    error_bars: Mapping[str, Any]
    missed: str


def assess(contact: State, samples: Sequence[Sample | None], peak: bool) -> Assessment:
    """Estimate the error bars of a contact from its samples on coarser meshes.

    Parameters
    ----------
    contact : State
        Contact on the finest mesh.
    samples : sequence of Sample or None
        Samples on this and coarser meshes, the finest last; None for a mesh that was not solved.
    peak : bool
        Whether the peak contact pressure must be within the tolerance as well.
    """
    solved = [sample for sample in samples[-Levels.needed :] if sample is not None]
    if len(solved) < Levels.needed:
        note = f"error bars need {Levels.needed} meshes, and only {len(solved)} could be solved"
        return Assessment({}, _add_advice(contact.scene, note))
    relative = relative_error_bars(*solved)
    worst, name = worst_error_bar(relative, peak)
    bars = (
        error_bars(relative, solved[-1]) | deviations_from_prescribed(contact) | {"relative": worst}
    )
    if worst <= required(contact.scene.accuracy, "accuracy").tolerance:
        return Assessment(bars, "")
    if math.isinf(worst):
        note = f"{name} grows with every finer mesh and may have no limit: round sharp edges"
        return Assessment(bars, note)
    note = f"{name} has a relative error bar of {worst:.1e}"
    return Assessment(bars, _add_advice(contact.scene, note))


def worst_error_bar(relative: Mapping[Name, float], peak: bool) -> tuple[float, str]:
    """Return the widest relative error bar among the quantities that decide the mesh, and its name.

    `peak` includes the peak pressure.
    """
    # Quantities that must be within the tolerance; for unworn bodies the peak pressure as well.
    governing = ("P", "Qx", "Qy", "Mz", "xi_x", "xi_y", "wear_max")
    names = (*governing, "p_max") if peak else governing
    return max((relative[name], name) for name in names)


def describe_missed_accuracy(history: History, scene: Scene) -> str:
    """Describe the last stored revolution with too wide error bars; empty if there is none.

    Parameters
    ----------
    history : History
        History of this scene, complete or not.
    scene : Scene
        Scene with [accuracy].
    """
    if "relative_error" not in history.columns:
        return ""
    missed, saved = "", scene.schedule
    tolerance = required(scene.accuracy, "accuracy").tolerance
    for revolution, worst in zip(history["revolution"], history["relative_error"], strict=True):
        # Not "greater": the error bar is nan if coarser meshes could not be solved.
        if int(revolution) in saved and not worst <= tolerance:
            bar = "no error bars" if math.isnan(worst) else f"a relative error bar of {worst:.1e}"
            missed = f"revolution {revolution:.0f} has {bar}"
    return missed and _add_advice(scene, missed)


def _add_advice(scene: Scene, note: str) -> str:
    """Return a note followed by advice how to reach the requested accuracy."""
    accuracy = required(scene.accuracy, "accuracy")
    return (
        f"{note}; accuracy.tolerance is {accuracy.tolerance:.1e}, and accuracy.elements "
        f"allows no more than {accuracy.elements} elements: raise one of them"
    )
