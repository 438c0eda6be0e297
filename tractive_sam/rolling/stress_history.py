"""Fatigue of a transient: what its course does to the material of both bodies.

The stress of every point follows from the tractions of the steps, and only these are stored. It is
computed where it is recorded: with the stored fields, and at the end. The course counts as one
cycle: the damage is that of a single course, and the life is a number of equal courses.
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
from tractive_sam.results import BodyFatigue, State, widened
from tractive_sam.rolling.courses import expected_steps
from tractive_sam.rolling.damage import cycle_columns, shakedown_remark
from tractive_sam.rolling.observer import Observer
from tractive_sam.subsurface import Course, course_fatigue, cycle_depths

Fields = tuple[np.ndarray, ...]
"""Pressure, traction in x and y, and where it slides, each of shape (n_x, n_y)."""


@dataclass(frozen=True, eq=False)
class StressHistory(Observer):
    """Fatigue by the stress of every point of the material, from the start of the course on.

    Attributes
    ----------
    places : tuple of float
        Distances of the steps so far, from transient.cycle_start on.
    fields : tuple of tuple of ndarray
        Pressure, tractions and where it slides in each of these steps, shape (n_x, n_y).
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
        """See `Observer.describe`."""
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
        """See `Observer.bytes_needed`: tractions as they are and as they are stored, and layers."""
        scene, elements = model.scene, math.prod(model.grid.elements)
        steps = expected_steps(scene, model.grid.dx)
        layers = 2 * 6 * 2 * len(scene.fatigue.bodies)  # twice as long as the mesh
        return 8.0 * steps * elements * (2 * 4 + layers)

    def begin(self, step: Any, model: Model) -> "StressHistory":
        """See `Observer.begin`."""
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> "StressHistory":
        """See `Observer.after`; before the cycle begins only the last step is kept."""
        contact, place = step.contact, step.place
        load = (contact.pressure, *contact.traction, 1.0 * contact.sliding)
        places, loads = (*self.places, place), (*self.loads, load)
        if place <= _cycle_start(model):
            places, loads = places[-1:], loads[-1:]
        return StressHistory(places, loads, contact, model)

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """See `Observer.state`."""
        grid = self._contact.grid
        loads = [[widened(one, grid.elements) for one in load] for load in self.loads]
        return {"places": np.array(self.places), "loads": np.array(loads)}

    def restore(self, step: Any, stored: Any) -> "StressHistory":
        """See `Observer.restore`."""
        known = stored.state_of(self)
        loads = tuple(tuple(load) for load in known["loads"])
        return replace(
            self, places=tuple(known["places"].tolist()), loads=loads, contact=step.contact
        )

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """See `Observer.cycles`."""
        return tuple(cycled for cycled, _ in self._found.values())

    def record(self, model: Model, recorded: Mapping[str, Any]) -> dict[str, Any]:
        """See `Observer.record`: of records with stored fields, and of the last one."""
        schedule = model.scene.schedule
        if self.places[-1] not in (*schedule.save, schedule.end):
            return {}
        columns, life = (
            cycle_columns({cycled.body: cycled for cycled in self.cycles}),
            model.laws.life,
        )
        columns["utilisation_at"] = {
            body: _with_x(columns["utilisation_at"][body], cycled, x)
            for body, (cycled, x) in self._found.items()
        }
        if life is None:
            return columns
        for body, (cycled, x) in self._found.items():
            damage, at = cycled.damage_max
            error = 0.0 if cycled.criterion is None else cycled.criterion.path_error
            each = {
                "damage": damage,
                "damage_at": _with_x(at, cycled, x),
                "damage_error": damage * life.relative_error(error),
                "fatigue_life": 1.0 / damage if damage > 0.0 else math.inf,
            }
            for name, value in each.items():
                columns.setdefault(name, {})[body] = value
        return columns

    def remark(self, model: Model) -> str:
        """See `Observer.remark`: stress above shakedown."""
        return shakedown_remark({cycled.body: cycled for cycled in self.cycles})

    @property
    def _contact(self) -> State:
        if self.contact is None:
            raise LookupError("contact")
        return self.contact

    @cached_property
    def _found(self) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
        """By body: what the material went through so far, and the places x of the worst points."""
        contact, model = self._contact, self.model
        if model is None:
            return {}
        table, rolls = model.scene.transient, model.scene.schedule.rolls
        contacts = []
        for load in self.loads:
            pressure, x, y, sliding = (widened(one, contact.grid.elements) for one in load)
            fields = {"pressure": pressure, "traction": np.stack((x, y)), "sliding": sliding > 0.0}
            contacts.append(replace(contact, **fields))
        places = np.array(self.places) if rolls else np.zeros(len(self.places))
        steady = table.start == "steady" and self.places[0] == table.distance[0]
        course = Course(contacts, places, model.laws, rolls, steady)
        found = course_fatigue(course, cycle_depths(contact))
        life = model.laws.life
        if life is None:
            return found
        return {body: (_damaged(cycled, life), x) for body, (cycled, x) in found.items()}


def _damaged(cycled: BodyFatigue, life: Woehler) -> BodyFatigue:
    """Return the same with the damage of one cycle."""
    damage = life.damage(cycled.utilisation)
    return cycled.with_damage(cycled.depth, damage, np.zeros(cycled.y.size))


def _cycle_start(model: Model) -> float:
    """Return the distance from which on the history counts."""
    table = model.scene.transient
    return table.distance[0] if table.cycle_start is None else table.cycle_start


def _with_x(at: tuple[float, ...], cycled: BodyFatigue, x: np.ndarray) -> tuple[float, ...]:
    """Return a place (no x, y, depth) with the x of the worst material there, mm."""
    if not np.isfinite(at[1:]).all():
        return at
    row, depth = (
        int(np.argmin(abs(one - k))) for one, k in ((cycled.y, at[1]), (cycled.depth, at[2]))
    )
    return (float(x[row, depth]), *at[1:])
