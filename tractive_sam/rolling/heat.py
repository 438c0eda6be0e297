"""Temperature of a transient: the heat of each step, and that of all steps before.

Friction makes heat by its work in a step over the time that it takes. Surfaces are equally warm at
the end of a step where they touch; what each body took up before makes them differ (see
`operators.heat_memory` and `contact.heat`). A shift takes no time: its heat is there at once, and
divides as that of two half-spaces does, by the root of conductivity, density and heat capacity.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np

from tractive_sam.contact import Model, StepResult, divide_heat
from tractive_sam.operators import HeatMemory
from tractive_sam.results import BODIES, FlashTemperature, Grid, State, widened
from tractive_sam.rolling.observer import Observer


@lru_cache(maxsize=4)
def _memory(grid: Grid, speed: float, diffusivity: float, conductivity: float) -> HeatMemory:
    return HeatMemory(grid, speed, diffusivity, conductivity)


def _memories(model: Model) -> dict[str, HeatMemory]:
    """Return the operators of both bodies, one and the same of alike ones."""
    speed, grid = model.scene.creepage.speed, model.grid
    return {
        body: _memory(grid, speed, one.diffusivity, one.conductivity)
        for body, one in model.scene.thermal.items()
    }


@dataclass(frozen=True, eq=False)
class TransientHeat(Observer):
    """Temperature by the heat of all steps, which stays in the material.

    Attributes
    ----------
    heat : FlashTemperature
        Temperatures at the end of the last step, and the heat that went into the bodies in it; of
        a shift, which takes no time, the temperatures before, and no heat.
    past : mapping of str to ndarray, shape (m, elements in x, elements in y)
        Fields of `HeatMemory` of "A" and "B": one and the same of alike bodies.
    """

    name = "heat"
    key = "heat"

    heat: FlashTemperature | None = None
    past: Mapping[str, np.ndarray] = field(default_factory=dict)

    def bytes_needed(self, model: Model) -> float:
        """See `Observer.bytes_needed`: of both bodies before, after and during a step."""
        return 8.0 * 3 * sum(math.prod(memory.shape) for memory in _memories(model).values())

    def begin(self, step: Any, model: Model) -> "TransientHeat":
        """See `Observer.begin`.

        A contact that rolled steadily has its temperature. Other bodies are as warm as their bulk,
        and where they are pressed together as two half-spaces that are put together.
        """
        heat = step.stepped.contact.heat or _put_together(step.stepped.contact, model)
        begun = TransientHeat(heat, _each(_memories(model), HeatMemory.settled, heat.flux))
        return begun._after_shift(step.stepped, model) if step.stepped.shifted else begun

    def after(self, step: Any, model: Model) -> "TransientHeat":
        """See `Observer.after`."""
        memories = _memories(model)
        known = replace(self, past=_each(memories, HeatMemory.adopt, self.past))
        if step.stepped.shifted:
            return known._after_shift(step.stepped, model)
        contact, speed = step.stepped.contact, model.scene.creepage.speed
        # Equal steps differ by rounding; their operators are made once.
        time = float(f"{step.stepped.distance / speed:.10g}")
        carried = _each(memories, lambda memory, past: memory.step(past, time), known.past)
        bulks = model.scene.heat.bulks
        before = {body: bulks[body] + one.temperature for body, one in carried.items()}
        heat = divide_heat(model, contact, _made(step.stepped) / time, before, time)
        return replace(
            known, heat=heat, past=_each(carried, lambda one, q: one.after(q), heat.flux)
        )

    def _after_shift(self, stepped: StepResult, model: Model) -> "TransientHeat":
        contact, none = stepped.contact, np.zeros(stepped.contact.grid.elements)
        made = _made(stepped)
        warmth = {
            body: widened(self.heat.temperature[body], none.shape, bulk)
            for body, bulk in model.scene.heat.bulks.items()
        }
        heat = FlashTemperature(contact.grid, contact.touching, warmth, dict.fromkeys(BODIES, none))
        past = {
            body: _memories(model)[body].after_shock(self.past[body], share * made)
            for body, share in _share_at_once(model).items()
        }
        return replace(self, heat=heat, past=past)

    def restore(self, step: Any, stored: Any) -> "TransientHeat":
        """See `Observer.restore`."""
        state, contact = stored.state_of(self), step.stepped.contact
        past = {body: state[body] for body in BODIES}
        temperature = state["temperature"]
        if "mesh" in state:  # a file of an earlier version has them in one dimension
            past = {k: one.reshape(state[f"shape_{k}"].astype(int)) for k, one in past.items()}
            temperature = temperature.reshape(2, *state["mesh"].astype(int))
        warmth = dict(zip(BODIES, temperature, strict=True))
        none = dict.fromkeys(BODIES, np.zeros(temperature.shape[1:]))
        return TransientHeat(FlashTemperature(contact.grid, contact.touching, warmth, none), past)

    def complete(self, contact: State, block: int) -> State:
        """See `Observer.complete`: columns and fields of the temperature are read from it."""
        return replace(contact, heat=self.heat)

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """See `Observer.state`; fields of the past have a margin around the mesh."""
        heat = self.heat
        if heat is None:
            return {}
        return {"temperature": np.stack([heat.temperature[k] for k in BODIES]), **self.past}


def _put_together(contact: State, model: Model) -> FlashTemperature:
    """Return the temperatures of bodies that have just been pressed together."""
    none, bulk = np.zeros(contact.grid.elements), model.scene.heat.bulks
    share = _share_at_once(model)
    apart = contact.touching * (bulk["B"] - bulk["A"])
    warmth = {"A": bulk["A"] + share["B"] * apart, "B": bulk["B"] - share["A"] * apart}
    return FlashTemperature(contact.grid, contact.touching, warmth, dict.fromkeys(BODIES, none))


def _made(stepped: StepResult) -> np.ndarray:
    """Return the heat that friction makes in a step per area, mJ/mm², shape (n_x, n_y).

    By the tractions at its end, scaled to the work of friction of the step.
    """
    contact = stepped.contact
    local = -(contact.traction * contact.slip).sum(axis=0)
    total = float(local.sum() * contact.grid.element_area)
    if total <= 0.0 or stepped.friction <= 0.0:
        return np.zeros_like(local)
    return stepped.friction / total * local


def _share_at_once(model: Model) -> dict[str, float]:
    """Return the shares of both bodies in heat that is there at once, by their effusivities."""
    effusivity = {
        body: one.conductivity / one.diffusivity**0.5 for body, one in model.scene.thermal.items()
    }
    return {body: one / sum(effusivity.values()) for body, one in effusivity.items()}


def _each(
    known: Mapping[str, Any],
    function: Callable[[Any, np.ndarray], Any],
    given: Mapping[str, np.ndarray],
) -> dict[str, Any]:
    """Return a function of an object and an array of each body; once, where both are the same."""
    found = {"A": function(known["A"], given["A"])}
    alike = known["B"] is known["A"] and np.array_equal(given["B"], given["A"])
    return found | {"B": found["A"] if alike else function(known["B"], given["B"])}
