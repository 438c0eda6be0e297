"""Temperature of a transient: the heat of each step and of all steps before.

The frictional heat of a step is its work over its time. At the end of a step both surfaces have
equal temperatures in contact; the heat that each body took up before makes them differ (see
`operators.heat` and `contact.heat`). A shift takes no time: its heat appears at once, and
divides as between two half-spaces, by the root of conductivity, density and heat capacity.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np

from tractive_sam.contact import Model, StepResult, divide_heat, shares_of_instant_heat
from tractive_sam.operators import HeatMemory
from tractive_sam.results import BODIES, FlashTemperature, Grid, State, widen_field
from tractive_sam.rolling.process import Observer
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


def _per_body(
    objects: Mapping[str, Any],
    function: Callable[[Any, np.ndarray], Any],
    arrays: Mapping[str, np.ndarray],
) -> dict[str, Any]:
    """Return function(object, array) for "A" and "B"; one call if both have equal arguments."""
    value = function(objects["A"], arrays["A"])
    equal = objects["B"] is objects["A"] and np.array_equal(arrays["B"], arrays["A"])
    return {"A": value, "B": value if equal else function(objects["B"], arrays["B"])}
