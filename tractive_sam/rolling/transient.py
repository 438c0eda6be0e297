"""Transient rolling: steps through the courses of [transient], heat, and the state at one time.

Between the knots all prescribed quantities are linear in the distance. A stretch without length is
a jump: the loads that jump take a shift, a step without distance. So is the place between two
stages; each stage rolls or shifts. Steps end at every knot
(`rolling.process.Stops`). A distance to save between two steps is reached by a shorter step from
the first of them, from which nothing continues: what is stored does not change what is computed.

Within a stretch tractions change smoothly, so they can be extrapolated. A step starts its search at
the extrapolated tractions; for adaptive steps the error is the difference from them.

The frictional heat of a step is its work over its time. At the end of a step both surfaces have
equal temperatures in contact; the heat that each body took up before makes them differ (see
`operators.heat` and `contact.heat`). A shift takes no time: its heat appears at once, and
divides as between two half-spaces, by the root of conductivity, density and heat capacity.
"""

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np

from tractive_sam.contact import (
    Model,
    Remembered,
    StepInput,
    Stepper,
    StepResult,
    Worn,
    divide_heat,
    equilibrium,
    not_resolved,
    shares_of_instant_heat,
)
from tractive_sam.operators import HeatMemory
from tractive_sam.results import BODIES, FlashTemperature, Grid, State, Status, widen_field
from tractive_sam.rolling.courses import CLOSE, PARTS, Courses, creepages_of, expected_steps
from tractive_sam.rolling.observers import StressHistory
from tractive_sam.rolling.process import (
    ErrorControl,
    Observer,
    Process,
    Step,
    StepRecord,
    Stops,
    StoredStep,
    Trial,
)
from tractive_sam.scene import FewestElements, Scene
from tractive_sam.schema import required


@lru_cache(maxsize=4)
def _memory(grid: Grid, speed: float, diffusivity: float, conductivity: float) -> HeatMemory:
    """Return the heat memory of a body; calls with equal arguments share one object."""
    return HeatMemory(grid, speed, diffusivity, conductivity)


def heat_memories(model: Model) -> dict[str, HeatMemory]:
    """Return the heat memories of both bodies; bodies of equal material share one object."""
    speed, grid = model.scene.creepage.speed, model.grid
    return {
        body: _memory(grid, speed, thermal.diffusivity, thermal.conductivity)
        for body, thermal in model.scene.thermal.items()
    }


@dataclass(frozen=True, eq=False)
class TransientHeat(Observer):
    """Observer of surface temperatures due to the heat of all steps so far (heat memory).

    Attributes
    ----------
    heat : FlashTemperature
        Temperatures at the end of the last step, and its heat flux into the bodies; for a shift,
        which takes no time, the temperatures before, and no flux.
    past : mapping of str to ndarray, shape (m, elements in x, elements in y)
        Fields of `HeatMemory` of "A" and "B"; bodies of equal material share them.
    """

    name = "heat"
    key = "heat"

    heat: FlashTemperature | None = None
    past: Mapping[str, np.ndarray] = field(default_factory=dict)

    def bytes_needed(self, model: Model) -> float:
        """Return the memory, bytes, of the heat memories of both bodies during a step.

        It counts fields before, after and during the step.
        """
        return 8.0 * 3 * sum(math.prod(memory.shape) for memory in heat_memories(model).values())

    def begin(self, step: Any, model: Model) -> "TransientHeat":
        """Return the observer with the first temperatures: of steady rolling or first touch.

        A contact that rolled steadily has its steady temperature. Other bodies have their bulk
        temperature, and in contact the temperature of two half-spaces put together.
        """
        heat = step.result.contact.heat or _first_temperatures(step.result.contact, model)
        past = _per_body(heat_memories(model), HeatMemory.steady_fields, heat.flux)
        first = TransientHeat(heat, past)
        return first._after_shift(step.result, model) if step.result.shifted else first

    def after(self, step: Any, model: Model) -> "TransientHeat":
        """Return the observer with the temperatures and stored heat after a later step."""
        memories = heat_memories(model)
        adopted = replace(self, past=_per_body(memories, HeatMemory.widen, self.past))
        if step.result.shifted:
            return adopted._after_shift(step.result, model)
        contact, speed = step.result.contact, model.scene.creepage.speed
        # Equal steps differ by rounding; their operators are made once.
        time = float(f"{step.result.distance / speed:.10g}")
        carried = _per_body(memories, lambda memory, past: memory.step(past, time), adopted.past)
        bulks = required(model.scene.heat, "heat").bulks
        before = {body: bulks[body] + memory.temperature for body, memory in carried.items()}
        heat = divide_heat(model, contact, _friction_heat(step.result) / time, before, time)
        worst = np.maximum(heat.residual, required(self.heat, "heat").residual)
        heat = replace(heat, residual=float(worst))
        past = _per_body(carried, lambda memory, flux: memory.after(flux), heat.flux)
        return replace(adopted, heat=heat, past=past)

    def _after_shift(self, result: StepResult, model: Model) -> "TransientHeat":
        """Return the observer after a shift: friction heats in no time, temperatures stay."""
        contact, none = result.contact, np.zeros(result.contact.grid.elements)
        total, last = _friction_heat(result), required(self.heat, "heat")
        warmth = {
            body: widen_field(last.temperature[body], none.shape, bulk)
            for body, bulk in required(model.scene.heat, "heat").bulks.items()
        }
        flux = dict.fromkeys(BODIES, none)
        heat = FlashTemperature(contact.grid, contact.touching, warmth, flux, last.residual)
        past = {
            body: heat_memories(model)[body].after_shock(self.past[body], share * total)
            for body, share in shares_of_instant_heat(model).items()
        }
        return replace(self, heat=heat, past=past)

    def restore(self, step: Any, stored: Any) -> "TransientHeat":
        """Return the observer with stored temperatures and heat memories, to resume from."""
        state, contact = stored.state_of(self), step.result.contact
        past = {body: state[body] for body in BODIES}
        temperature = state["temperature"]
        if "mesh" in state:  # a file of an earlier version stores them in one dimension
            past = {k: v.reshape(state[f"shape_{k}"].astype(int)) for k, v in past.items()}
            temperature = temperature.reshape(2, *state["mesh"].astype(int))
        warmth = dict(zip(BODIES, temperature, strict=True))
        none = dict.fromkeys(BODIES, np.zeros(temperature.shape[1:]))
        return TransientHeat(FlashTemperature(contact.grid, contact.touching, warmth, none), past)

    def complete(self, contact: State, block: int) -> State:
        """Return the contact with the surface temperatures after the last step.

        Its columns and fields of temperature read this heat.
        """
        return replace(contact, heat=self.heat)

    @property
    def shortfall(self) -> str:
        """Message if the heat shares of a step were not solved."""
        return "" if self.heat is None else self.heat.shortfall

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """Temperatures and heat memories by name, for `restore`; empty before the first step.

        Fields of the past have a margin around the mesh.
        """
        heat = self.heat
        if heat is None:
            return {}
        return {"temperature": np.stack([heat.temperature[k] for k in BODIES]), **self.past}


def _first_temperatures(contact: State, model: Model) -> FlashTemperature:
    """Return temperatures at first touch: bulk, and in contact a common one of both surfaces."""
    none, bulk = np.zeros(contact.grid.elements), required(model.scene.heat, "heat").bulks
    share = shares_of_instant_heat(model)
    difference = contact.touching * (bulk["B"] - bulk["A"])
    warmth = {"A": bulk["A"] + share["B"] * difference, "B": bulk["B"] - share["A"] * difference}
    return FlashTemperature(contact.grid, contact.touching, warmth, dict.fromkeys(BODIES, none))


def _friction_heat(result: StepResult) -> np.ndarray:
    """Return the frictional heat of a step per area, mJ/mm², shape (n_x, n_y).

    It is distributed by the tractions at its end, scaled to the work of friction of the step.
    """
    contact = result.contact
    local = -(contact.traction * contact.slip).sum(axis=0)
    total = float(local.sum() * contact.grid.element_area)
    if total <= 0.0 or result.friction <= 0.0:
        return np.zeros_like(local)
    return result.friction / total * local


def _by_body(values: np.ndarray) -> dict[str, float]:
    """Return the values of A and B by name."""
    return dict(zip(BODIES, values.tolist(), strict=True))


def _per_body(
    objects: Mapping[str, Any],
    function: Callable[[Any, np.ndarray], Any],
    arrays: Mapping[str, np.ndarray],
) -> dict[str, Any]:
    """Return function(object, array) for "A" and "B"; one call if both have equal arguments."""
    value = function(objects["A"], arrays["A"])
    equal = objects["B"] is objects["A"] and np.array_equal(arrays["B"], arrays["A"])
    return {"A": value, "B": value if equal else function(objects["B"], arrays["B"])}


@dataclass(frozen=True, eq=False)
class Moment(Step):
    """State of a transient at one rolling distance, with all that the next step needs.

    Attributes
    ----------
    distance : float
        Distance rolled, mm; for shifts their parameter, which then is the unit of lengths below.
    stretch : int
        The stretch between two knots that it lies in or ends; -1 at the first knot.
    result : StepResult
        The contact, and the work of the step to it.
    length : float
        Length of the step to it, mm; 0 if it cannot be extrapolated.
    wish : float
        Length of the next step, mm; 0 at the beginning of a stretch.
    shifts : ndarray, shape (3,)
        Shifts of A over B in x and y, mm, and turn, radians, since the start: without the
        creepages that were rolled at, unless these are what is sought.
    before : StepResult, optional
        The contact one step before.
    solves : int
        Contacts solved for it.
    friction : float
        Work of friction since the start, N mm.
    volumes : ndarray, shape (2,)
        Worn off A and B since they were new, mm³.
    deepest : float
        Largest depth worn off both bodies so far, mm, including the material behind the contact.
    began : Worn, optional
        Worn bodies with which it began; None for new ones.
    earlier : StepResult, optional
        The contact of the record before, if that is between two steps.
    courses : Courses
        Courses of the scene.
    """

    contacts: tuple[State, ...] = field(init=False)
    distance: float
    stretch: int
    result: StepResult
    length: float = 0.0
    wish: float = 0.0
    shifts: np.ndarray = field(default_factory=lambda: np.zeros(3))
    before: StepResult | None = None
    solves: int = 1
    friction: float = 0.0
    volumes: np.ndarray = field(default_factory=lambda: np.zeros(2))
    deepest: float = 0.0
    began: Worn | None = None
    earlier: StepResult | None = None
    courses: Courses = field(kw_only=True, repr=False)

    @classmethod
    def from_stored(cls, scene: Scene, stored: StoredStep) -> "Moment":
        """Return the moment of a stored record, without what the model adds (see `adopt`)."""
        history, row, state = stored.history, stored.row, stored.state
        names = ("distance", "stretch", "next_step", "approach", "xi_x", "xi_y")
        columns = {name: history[name] for name in names}
        contact = stored.contact(scene)
        last, before = stored.earlier_row, None
        length = columns["distance"][row] - columns["distance"][last]
        if length:
            earlier = replace(
                contact,
                pressure=state.get("before_pressure", contact.pressure),
                traction=np.stack((state["before_x"], state["before_y"])),
                approach=float(columns["approach"][last]),
                xi_x=columns["xi_x"][last],
                xi_y=columns["xi_y"][last],
            )
            before = StepResult(earlier)
        none, depths = np.zeros((2, *contact.grid.elements)), {}
        worn: dict[str, Any] = {"friction": float(np.nansum(history["step_friction"][: row + 1]))}
        if "step_worn" in history.columns:
            depths = {name: state[name] for name in ("worn", "gained")}
            worn |= {"volumes": history["worn_volume"][row], "deepest": history["wear_max"][row]}
        energy = float(history["elastic_energy"][row])
        memory = None
        if "memory_rest" in state:
            places, rest = state["memory_places"], state["memory_rest"]
            memory = Remembered(places, rest, state["memory_datum"], state["memory_stored"])
        worn_fields = {"worn": none, "gained": none} | depths
        missed = state.get("extrapolation_error")
        result = StepResult(
            contact, energy=energy, memory=memory, extrapolation_error=missed, **worn_fields
        )
        shifts = np.array([history[name][row] for name in ("shift_x", "shift_y", "turn")])
        return cls(
            float(columns["distance"][row]),
            int(columns["stretch"][row]),
            result,
            length,
            float(columns["next_step"][row]),
            shifts,
            before,
            **worn,
            courses=Courses(scene),
        )

    def __post_init__(self) -> None:
        object.__setattr__(self, "contacts", (self.result.contact,))

    @property
    def place(self) -> float:
        """Distance rolled, mm, or parameter of the shifts: the coordinate of its record."""
        return self.distance

    def on(self, grid: Grid) -> "Moment":
        """Return the moment on a wider mesh of equal elements.

        `Transient` computes the gap outside of the former mesh.
        """
        before = None if self.before is None else StepResult(self.before.contact.on(grid))
        return replace(self, result=self.result.on(grid), before=before)

    @property
    def own_state(self) -> Mapping[str, np.ndarray]:
        """Arrays, by name, to resume: fields one step before, wear, and what bodies remember."""
        before = self.contact if self.before is None else self.before.contact
        traction = before.traction
        state = {
            "before_pressure": before.pressure,
            "before_x": traction[0],
            "before_y": traction[1],
        }
        if self.contact.scene.wear is not None:
            state |= {"worn": self.result.worn, "gained": self.result.gained}
        if (memory := self.result.memory) is not None:
            state |= {"memory_places": memory.places, "memory_rest": memory.rest}
            state |= {"memory_datum": memory.datum, "memory_stored": memory.stored}
        if (missed := self.result.extrapolation_error) is not None:
            state["extrapolation_error"] = missed
        return state

    def record(self, block: int | None = None) -> StepRecord:
        """Return the contact and its values; values per rolling distance are nan during a shift."""
        course, contact = self.courses, self.contact
        step, rolls = self.result.since(self.earlier), course.rolled_to(self.stretch)
        distance = step.distance
        per_distance: dict[str, Any] = {}
        if rolls and distance > 0.0:
            per_distance["work_supplied"] = step.supplied / distance
            per_distance["dissipation"] = step.friction / distance
            per_distance["bulk_dissipation"] = _by_body(step.bulk / distance)
        elif step.shifted or not rolls:
            # A shift has no creepage, and its work is not per distance.
            of_rolling = ("xi_x", "xi_y", "spin", "t_gamma", "work_supplied", "dissipation")
            per_distance = dict.fromkeys((*of_rolling, "t_gamma_over_area"), np.nan)
            per_distance["creepage_found"] = np.full(2, np.nan)
            per_distance["bulk_dissipation"] = _by_body(np.full(2, np.nan))
        if contact.scene.wear is not None:
            per_distance |= self._worn(course.table.rolls, step)
            per_distance |= {} if rolls else {"worn_area": np.nan}
            contact = replace(contact, volumes=_by_body(self.volumes))
        values = {
            "distance": self.distance,
            "stretch": self.stretch,
            "next_step": self.wish if self.continues else np.nan,
            "shift_x": self.shifts[0],
            "shift_y": self.shifts[1],
            "turn": self.shifts[2],
            "step_work": step.supplied,
            "step_friction": step.friction,
            "step_bulk": _by_body(step.bulk),
            "friction_work": self.friction,
            "elastic_energy": step.energy,
            "solves": self.solves,
            **per_distance,
        }
        if course.table.stage:
            values["stage"] = course.table.stages.index(course.stage(self.stretch))
        may_store = not course.shift_comes_next(self.stretch, self.distance)
        return StepRecord(contact, values, may_store)

    def _worn(self, rolls: bool, step: StepResult) -> dict[str, Any]:
        """Return the wear columns of the record, from the last step and all before."""
        wear, grid, each = self.contact.wear, self.contact.grid, self.result.worn
        # Shifts leave no track behind the contact: it is the deepest place of each row of elements.
        at, rows = 0 if rolls else wear.argmax(axis=0), np.arange(grid.elements[1])
        new = np.zeros((2, grid.elements[1])) if self.began is None else self.began.on(grid)
        columns = {
            "wear_max": self.deepest,
            "wear_profile": wear[at, rows],
            "entering_profile": wear[-1] if rolls else new.sum(axis=0),
            "step_worn": float(step.gained.sum() * grid.element_area),
        }
        for body, before, depth in zip(BODIES, new, each[:, at, rows], strict=True):
            columns[f"wear_profile_{body}"] = before + depth
        return columns


class TransientProcess(Process[Moment]):
    """Process of transient rolling or shifting along the prescribed courses of a scene."""

    observers = (TransientHeat, StressHistory)
    next_applications = 15.0

    def __init__(self, model: Model):
        super().__init__(model)
        self.courses, self.stepper = Courses(model.scene), Stepper(model)
        if self.stepper.memory is not None:
            made, applied = self.stepper.memory.work_of_steps
            self.first_applications += made
            self.next_applications += applied

    @classmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return the (approximate) number of records for elements of the length dx, mm."""
        return expected_steps(scene, dx)

    @classmethod
    def restore(cls, scene: Scene, stored: StoredStep) -> Moment:
        """Return the moment of a stored record, without what the model adds (see `adopt`)."""
        return Moment.from_stored(scene, stored)

    def adopt(self, step: Moment, stored: StoredStep) -> Moment:
        """Return a restored step with its observers and with the initial wear of the model."""
        return super().adopt(replace(step, began=self.model.began), stored)

    def end(self, step: Moment, half_widths: np.ndarray) -> tuple[str, str]:
        """Return (status, message); not resolved if the contact had few elements at all times.

        A contact may have few elements for some time, but not during all of the course.
        """
        contact, grid = step.contact, step.contact.grid
        sides = np.array((grid.dx, grid.dy))
        few = (half_widths > 0.0) & (2.0 * half_widths < FewestElements.contact * sides)
        if contact.converged and np.any(few):
            across = np.ceil(2.0 * half_widths / sides)
            return str(Status.NOT_RESOLVED), not_resolved(contact, across)
        status, message = super().end(step, half_widths)
        return status, message + self._remark_on_steps(float(half_widths[0]))

    def _remark_on_steps(self, half_width: float) -> str:
        """Return a remark on wear in steps of a fraction of an element between dissimilar bodies.

        The bound is that of measured differences from steps of one element, near free rolling; see
        docs/theory/transient.md.
        """
        dx, stages = self.model.grid.dx, self.courses.table.stages
        parts = [stage.step / dx for stage in stages if stage.rolls and stage.step]
        fraction = any(abs(part - round(part)) > CLOSE for part in parts)
        if not (fraction and self.model.elasticity.coupled and self.model.wear_law):
            return ""
        share = 15.0 * (dx / half_width) ** 2 if half_width > 0.0 else 0.0
        return (
            f"; transient.step is not a whole number of elements of {dx:.4g} mm: near free rolling "
            f"of dissimilar bodies, work and wear may differ by up to about {share:.1%}, "
            f"and at the creepage of free rolling by {8.0 * share:.0%}, from those in steps of one "
            "element; refine grid.elements, or omit transient.step"
        )

    def _input(
        self,
        distance: float,
        inputs: Mapping[str, float | None],
        creepages: tuple[float, float, float],
        at: float,
        before: Mapping[str, float | None] | None = None,
        time: float = 0.0,
    ) -> StepInput:
        """Return the `StepInput` (distance, loads, creepages, friction) of a step."""
        return StepInput(
            distance,
            creepages,
            inputs["load.normal"],
            inputs["load.approach"],
            (inputs["load.force_x"], inputs["load.force_y"]),
            self.courses.friction_factor(inputs),
            self.courses.friction_factor(before or inputs),
            self._separation(at),
            time,
        )

    def _separation(self, distance: float) -> np.ndarray | float:
        """Return the gap that moving profiles add at a distance, mm; none moves in a shift."""
        return self.model.profile_offset(self.model.scene.schedule.rolled(distance))

    def begin(self) -> Moment:
        """Return the first moment: the contact at the first knot, at rest or rolling steadily."""
        first, at = self.courses.first(), self.courses.knots[0]
        if self.courses.table.start == "steady":
            moment = self._first_moment(self._steady(), at, True)
            shifted = self.courses.shifts_from_steady
        else:
            moment = self._first_moment(
                self.stepper.press(self._input(0.0, first, (0.0, 0.0, 0.0), at)), at
            )
            shifted = any((first["load.force_x"], first["load.force_y"], *self.courses.first_shift))
        if not moment.contact.converged or not shifted:
            return moment
        inputs = self._input(0.0, first, self.courses.first_shift, at)
        return self._moment(moment, self.stepper.step(moment.result, inputs), at, -1, 0.0)

    def _steady(self) -> State:
        """Return the contact in steady rolling before the first knot."""
        model, scene = self.model, self.courses.steady_scene()
        # Before a shift, the values of the tables apply, not the values of the first knot.
        rolls = self.courses.rolls(-1)
        factor = self.courses.friction_factor(self.courses.first()) if rolls else 1.0
        laws = model.laws.replace(friction=model.friction_law.weakened(factor))
        steady = Model(scene, model.measured, model.grid, laws, datum=model.datum)
        worn, depth = model.add_initial_wear(0.0), self._separation(self.courses.knots[0])
        contact = equilibrium(steady, worn + depth, check_resolution=False)
        return replace(contact, scene=model.scene, wear=worn, laws=model.laws)

    def _first_moment(self, contact: State, at: float, steady: bool = False) -> Moment:
        """Return the first moment from the first contact, of new or worn bodies."""
        model, volumes = self.model, np.zeros(2)
        if model.began is not None:
            lost = contact.volumes_of(dict(zip(BODIES, model.began.on(model.grid), strict=True)))
            volumes = np.nan_to_num([lost[body] for body in BODIES])
        result, deepest = self.stepper.at_rest(contact, steady), float(contact.wear.max())
        worn: dict[str, Any] = {"volumes": volumes, "deepest": deepest, "began": model.began}
        return Moment(at, -1, result, courses=self.courses, **worn)

    def advance(self, last: Moment) -> Iterator[Moment]:
        """Yield the moments after one, with jumps at knots, to the end or an unsolved contact."""
        courses, separation = self.courses, self._separation(last.distance)
        last = replace(last, result=self.stepper.with_gap_outside(last.result, separation))
        while last.contact.converged:
            if last.distance == courses.knots[last.stretch + 1]:
                if last.stretch + 1 == courses.stretches:
                    return
                rolled = courses.rolls(last.stretch)
                last = replace(last, stretch=last.stretch + 1, wish=0.0)
                if courses.rolls(last.stretch) != rolled:  # nothing to extrapolate from
                    last = replace(last, before=None, length=0.0)
                if courses.shifted(last.stretch):  # a step without distance
                    stretch, at = last.stretch, last.distance
                    inputs = self._input(0.0, courses.at(at, stretch), courses.jump(stretch), at)
                    jumped = self.stepper.step(last.result, inputs)
                    last = self._moment(last, jumped, at, stretch, 0.0)
                    yield last
            else:
                for moment in self._roll_stretch(last):
                    last = moment
                    yield last

    def _roll_stretch(self, last: Moment) -> Iterator[Moment]:
        """Yield the moments from one knot to the next, including those to save."""
        courses, stage = self.courses, self.courses.stage(last.stretch)
        first, end = courses.knots[last.stretch], courses.knots[last.stretch + 1]
        saves = tuple(s for s in courses.table.save if first < s < end)
        adaptive = stage.stepping == "adaptive"
        unit = self.model.grid.dx if stage.rolls else (end - first) / (PARTS * 100)
        control = Stops(ErrorControl(order=2, unit=unit), (end,))
        longest = stage.step or self._longest(stage.rolls, adaptive, end - first)
        usual = longest if not adaptive else min(longest, unit * (1 if stage.rolls else 100))
        while last.contact.converged and last.distance < end:
            wish = min(last.wish or usual, longest)
            moment = self._take_step(last, control, wish, adaptive, end)
            near = [s for s in saves if abs(s - moment.distance) <= CLOSE * unit]
            if near and moment.distance not in courses.knots:  # there but for rounding
                moment = replace(moment, distance=near[0])
            between = self._moments_to_save(last, moment, saves) if moment.converged else []
            if between and not between[-1].converged:
                yield between[-1]
                return
            yield from between
            yield replace(moment, earlier=between[-1].result) if between else moment
            last = moment

    def _moments_to_save(self, last: Moment, end: Moment, saves: tuple[float, ...]) -> list[Moment]:
        """Return moments to save in a step, each solved from `last`; an unsolved one is last."""
        moments: list[Moment] = []
        for place in (s for s in saves if last.distance < s < end.distance):
            moment, _ = self._try_step(last, place, None, end)
            earlier = moments[-1].result if moments else None
            moment = replace(moment, earlier=earlier, continues=False)
            moments.append(moment)
            if not moment.converged:
                break
        return moments

    def _longest(self, rolls: bool, adaptive: bool, stretch: float) -> float:
        """Return the longest step, mm: an element, a quarter of the contact, or part of a shift."""
        if not rolls:
            return stretch / (1 if adaptive else PARTS)
        dx = self.model.grid.dx
        if not adaptive:
            return dx
        hertz, half = self.model.scene.hertz, self.model.grid.half_length[0]
        length = 2.0 * (half if hertz is None else min(hertz.a, half))
        return max(dx, int(0.25 * length / dx) * dx)

    def _take_step(
        self, last: Moment, control: Stops, wish: float, adaptive: bool, end: float
    ) -> Moment:
        """Return the next moment: in adaptive stepping, after the longest accurate step."""
        here, stops = last.distance, control.stops
        stop = stops[bisect_left(stops, here + CLOSE * wish)]
        step, solves = Trial(min(wish, stop - here), wish), 0
        while True:
            at = here + step.length
            if abs(stop - at) <= CLOSE * wish:
                at = stop
            moment, error = self._try_step(last, at, control if adaptive else None)
            solves += 1
            shortest = step.length <= 1.000001 * control.control.unit
            unsolved = not moment.contact.converged and moment.result.deep <= 1.0
            if error <= 1.0 or shortest or unsolved:
                break
            step = control.shorter(step, error)
        after = control.next(step, error) if adaptive else wish
        after = after if at < end else 0.0
        return replace(moment, wish=after, solves=solves)

    def _try_step(
        self, last: Moment, at: float, control: Stops | None, beyond: Moment | None = None
    ) -> tuple[Moment, float]:
        """Take a step to a distance; return the moment there and its error over the tolerance.

        Parameters
        ----------
        last : Moment
            Moment at which the step begins.
        at : float
            The distance.
        control : Stops, optional
            Error control of adaptive steps; without it, as for a first step, the error is zero.
        beyond : Moment, optional
            End of a longer step, from which the initial guess is interpolated.
        """
        courses, stretch, contact = self.courses, last.stretch, last.contact
        begin, end = courses.at(last.distance, stretch), courses.at(at, stretch)
        length, rolls = at - last.distance, courses.rolls(stretch)
        xi_x, xi_y, spin = (
            0.5 * (final + first) if rolls else final - first
            for first, final in zip(creepages_of(begin), creepages_of(end), strict=True)
        )
        distance, time = (length, 0.0) if rolls else (0.0, courses.time(length, stretch))
        inputs = self._input(distance, end, (xi_x, xi_y, spin), at, begin, time)
        ratio = length / last.length if last.before is not None and last.length > 0.0 else 0.0
        earlier = last.before
        if beyond is not None:
            earlier, ratio = beyond.result, -length / beyond.length
        result = self.stepper.step(last.result, inputs, earlier, ratio)
        moment = self._moment(last, result, at, stretch, length)
        error = 0.0
        # An extrapolation from before a knot gives no error beyond it.
        judged = control is not None and last.wish > 0.0 and ratio > 0.0
        if judged and last.before is not None and moment.contact.converged:
            traction, before = moment.contact.traction, last.before.contact.traction
            expected = contact.traction + ratio * (contact.traction - before)
            missed, size = np.linalg.norm(traction - expected), np.linalg.norm(traction)
            error = float(missed / size / courses.stage(stretch).tolerance) if size > 0.0 else 0.0
        if control is not None and result.deep > 1.0:
            error = max(error, result.deep**2)  # half the distance wears half as deep
        return moment, error

    def _moment(
        self, last: Moment, result: StepResult, at: float, stretch: int, length: float
    ) -> Moment:
        """Return the moment that the result of a step leads to."""
        contact = result.contact
        by = np.array([contact.xi_x, contact.xi_y, contact.spin])
        shifts = last.shifts + by * (result.distance if result.distance else 1.0)
        before, gained = last.result if length else None, result.gained.sum(axis=(1, 2))
        return replace(
            last,
            distance=at,
            stretch=stretch,
            result=result,
            length=length,
            wish=0.0,
            shifts=shifts,
            earlier=None,
            observed={},
            before=before,
            solves=1,
            friction=last.friction + result.friction,
            volumes=last.volumes + gained * contact.grid.element_area,
            deepest=max(last.deepest, float(contact.wear.max())),
        )
