"""Fatigue of a transient: the effect of its course on the material of both bodies.

The stress of every point follows from the tractions of the steps, and only these are stored. It is
computed when it is recorded: with the stored fields, and at the end. The course counts as one
cycle: the damage belongs to a single course, and the life is a number of equal courses.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.mechanics import Woehler
from tractive_sam.results import BodyFatigue, State, widen_field
from tractive_sam.rolling.body_damage import cycle_columns, shakedown_remark
from tractive_sam.rolling.courses import expected_steps
from tractive_sam.rolling.process import Observer
from tractive_sam.schema import required
from tractive_sam.subsurface import Course, course_fatigue, cycle_depths

Fields = tuple[np.ndarray, ...]
"""Pressure, traction in x and y, and sliding elements, each of shape (n_x, n_y)."""


@dataclass(frozen=True, eq=False)
class StressHistory(Observer):
    """Observer of fatigue by the full stress history of each material point in a transient.

    Attributes
    ----------
    places : tuple of float
        Distances of the steps so far, starting at transient.cycle_start.
    loads : tuple of tuple of ndarray
        Pressure, tractions and sliding elements in each of these steps, shape (n_x, n_y).
    contact : State, optional
        The last contact; None before the first step.
    model : Model, optional
        The scene in numbers.
    """

    name, key = "stress_history", "fatigue"

    places: tuple[float, ...] = ()
    loads: tuple[Fields, ...] = ()
    contact: State | None = None
    model: Model | None = None

    def describe(self, model: Model) -> Iterator[Row]:
        """Yield the rows (label, text) that `explain` prints for the observer."""
        scene, criterion = model.scene, model.laws.fatigue
        if criterion is not None:
            yield Row("criterion", criterion.long_name)
        fixed = "fixed in the contact" if scene.schedule.shifts else "rolled over"
        yield Row("stress history", f"of material {fixed}, from {_cycle_start(model):g} on")
        yield Row("cycle", "the history counts as one: the life is in repetitions of it")
        yield Row("records", "those with stored fields, and the last one; fields over (y, depth)")
        room = f"about {self.bytes_needed(model) / 2**20:.0f} MiB for the tractions of all steps"
        yield Row("memory of the history", room)

    def bytes_needed(self, model: Model) -> float:
        """Return the memory, bytes, of the tractions of all steps and of layers of stress.

        It counts stored copies of the tractions as well.
        """
        scene, elements = model.scene, math.prod(model.grid.elements)
        steps = expected_steps(scene, model.grid.dx)
        bodies = required(scene.fatigue, "fatigue").bodies
        layers = 2 * 6 * 2 * len(bodies)  # twice as long as the mesh
        return 8.0 * steps * elements * (2 * 4 + layers)

    def begin(self, step: Any, model: Model) -> "StressHistory":
        """Return the observer after the first step, as after any other."""
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> "StressHistory":
        """Return the observer with the loads of a step added; before the load cycle, only these.

        Before the cycle begins only the last step is stored.
        """
        contact, place = step.contact, step.place
        load = (contact.pressure, *contact.traction, 1.0 * contact.sliding)
        places, loads = (*self.places, place), (*self.loads, load)
        if place <= _cycle_start(model):
            places, loads = places[-1:], loads[-1:]
        return StressHistory(places, loads, contact, model)

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """Distances and loads of all steps in the cycle, by name, for `restore`."""
        grid = self._contact.grid
        loads = [[widen_field(field, grid.elements) for field in load] for load in self.loads]
        return {"places": np.array(self.places), "loads": np.array(loads)}

    def restore(self, step: Any, stored: Any) -> "StressHistory":
        """Return the observer with the stored distances and loads of the cycle, to resume from."""
        state = stored.state_of(self)
        loads = tuple(tuple(load) for load in state["loads"])
        places = tuple(state["places"].tolist())
        return replace(self, places=places, loads=loads, contact=step.contact)

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """Fatigue of the bodies by the load cycle so far, stored with the fields."""
        return tuple(cycle for cycle, _ in self._fatigue.values())

    def record(self, model: Model, recorded: Mapping[str, Any]) -> dict[str, Any]:
        """Return the fatigue columns at a saved or the last distance; no columns elsewhere.

        Only records with stored fields, and the last one, have values.
        """
        schedule = model.scene.schedule
        if self.places[-1] not in (*schedule.save, schedule.end):
            return {}
        columns = cycle_columns({cycle.body: cycle for cycle in self.cycles})
        life = model.laws.life
        columns["utilisation_at"] = {
            body: _with_x(columns["utilisation_at"][body], cycle, x)
            for body, (cycle, x) in self._fatigue.items()
        }
        if life is None:
            return columns
        for body, (cycle, x) in self._fatigue.items():
            damage, at = cycle.damage_max
            error = 0.0 if cycle.criterion is None else cycle.criterion.path_error
            each = {
                "damage": damage,
                "damage_at": _with_x(at, cycle, x),
                "damage_error": damage * life.relative_error(error),
                "fatigue_life": 1.0 / damage if damage > 0.0 else math.inf,
            }
            for name, value in each.items():
                columns.setdefault(name, {})[body] = value
        return columns

    def remark(self, model: Model) -> str:
        """Return a remark on shakedown for the message of a history; empty if there is none.

        It warns of stress above shakedown.
        """
        return shakedown_remark({cycle.body: cycle for cycle in self.cycles})

    @property
    def _contact(self) -> State:
        """Last contact; a LookupError is raised before the first step."""
        if self.contact is None:
            raise LookupError("contact")
        return self.contact

    @cached_property
    def _fatigue(self) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
        """Fatigue of each body so far, and x of the material that is loaded most."""
        contact, model = self._contact, self.model
        if model is None:
            return {}
        table, schedule = required(model.scene.transient, "transient"), model.scene.schedule
        contacts = []
        for load in self.loads:
            pressure, x, y, sliding = (widen_field(field, contact.grid.elements) for field in load)
            loaded = replace(contact, pressure=pressure, traction=np.stack((x, y)))
            contacts.append(replace(loaded, sliding=sliding > 0.0))
        places = schedule.rolled(np.array(self.places))
        steady = table.start == "steady" and self.places[0] == table.knots[0]
        course = Course(contacts, places, model.laws, schedule.rolls, steady)
        cycles = course_fatigue(course, cycle_depths(contact))
        life = model.laws.life
        if life is None:
            return cycles
        return {body: (_with_damage(cycle, life), x) for body, (cycle, x) in cycles.items()}


def _with_damage(cycle: BodyFatigue, life: Woehler) -> BodyFatigue:
    """Return the fatigue of a body with the damage of one load cycle."""
    damage = life.damage(cycle.utilisation)
    return cycle.with_damage(cycle.depth, damage, np.zeros(cycle.y.size))


def _cycle_start(model: Model) -> float:
    """Return the distance at which the load cycle begins; by default at the first knot."""
    table = required(model.scene.transient, "transient")
    return table.knots[0] if table.cycle_start is None else table.cycle_start


def _with_x(at: tuple[float, ...], cycle: BodyFatigue, x: np.ndarray) -> tuple[float, ...]:
    """Return a position (nan, y, depth) with x of the most loaded material for nan, mm."""
    if not np.isfinite(at[1:]).all():
        return at
    row, depth = int(np.argmin(abs(cycle.y - at[1]))), int(np.argmin(abs(cycle.depth - at[2])))
    return (float(x[row, depth]), *at[1:])
