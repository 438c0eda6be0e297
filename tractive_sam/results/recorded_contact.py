"""The contact of a record, from its columns and its stored fields."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from tractive_sam.results.heat import FlashTemperature
from tractive_sam.results.history_data import HistoryData
from tractive_sam.results.quantity import BODIES
from tractive_sam.results.state import State
from tractive_sam.results.status import Cost, Status
from tractive_sam.results.stored_fields import BOUND, HEAT_FIELDS
from tractive_sam.schema import required


def contact_of(history: HistoryData, row: int, fields: Mapping[str, np.ndarray]) -> State:
    """Return the contact (`State`) of a record, given its fields by the names of `FIELDS`."""
    number = {name: float(history[name][row]) for name in history.of_dims()}
    creeping = sum(
        number[force] * number[creepage]
        for force, creepage in (("Qx", "xi_x"), ("Qy", "xi_y"), ("Mz", "spin"))
    )
    solved = number["converged"] > 0.0
    contact = State(
        scene=history.scene,
        grid=history.grid,
        pressure=fields["pressure"],
        traction=np.stack((fields["traction_x"], fields["traction_y"])),
        slip=np.stack((fields["slip_x"], fields["slip_y"])),
        gap=fields.get("gap", np.full(history.grid.elements, np.nan)),
        wear=fields["wear"],
        approach=number["approach"],
        xi_x=number["xi_x"],
        xi_y=number["xi_y"],
        spin=number["spin"],
        rolling_resistance=number["work_supplied"] + creeping,
        sliding=fields.get("sliding", np.zeros(history.grid.elements)) > 0.0,
        status=Status.CONVERGED if solved else _reason(history.status),
        note="" if solved else history.message,
        residual=number["residual"],
        cost=_recorded_cost(number),
        revolution=int(number.get("revolution", 0)),
        volumes=_volumes(history, row),
        frame=history.frame,
        traction_bound=_complete_or_none(fields.get(BOUND.name)),
        laws=history.law_records,
    )
    if all(name in fields for name in HEAT_FIELDS):
        into_A = fields["heat_into_A"]
        speed = required(history.scene.creepage.speed, "creepage.speed")
        heat = -speed * (contact.traction * contact.slip).sum(axis=0)
        warm = {"A": fields["temperature_A"], "B": fields["temperature_B"]}
        flux = {"A": into_A, "B": heat - into_A}
        temperatures = FlashTemperature(history.grid, contact.touching, warm, flux)
        contact = replace(contact, heat=temperatures)
    return contact if "sliding" in fields else contact.with_sliding_by_traction()


def _recorded_cost(number: Mapping[str, float]) -> Cost:
    """Return the cost of a record; applications of preconditioners are not stored."""
    convolutions, over_application = number["convolutions"], number["over_application"]
    return Cost(number["operator_applications"], 0.0, convolutions, over_application)


def _volumes(history: HistoryData, row: int) -> dict[str, float] | None:
    """Return the worn volume of each body in a record; None if it was not recorded."""
    volumes = history.values.get("worn_volume")
    return None if volumes is None else dict(zip(BODIES, volumes[row].tolist(), strict=True))


def _complete_or_none(bound: np.ndarray | None) -> np.ndarray | None:
    """Return a stored traction bound, or None if it is missing or has nan."""
    return None if bound is None or np.isnan(bound).any() else bound


def _reason(ended: str) -> Status:
    """Return the `Status` of an unsolved contact from its history, or else out of iterations."""
    return Status(ended) if ended in set(Status) else Status.OUT_OF_ITERATIONS
