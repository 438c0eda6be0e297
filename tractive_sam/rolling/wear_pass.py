"""The contact of a pass, with its wear as a part of its gap."""

from dataclasses import replace

import numpy as np

from tractive_sam.contact import Model, equilibrium, wear_conditions, wear_law_at
from tractive_sam.results import Cost, State, Status
from tractive_sam.schema import required


def solve_pass(
    model: Model,
    revolution: int,
    entering: np.ndarray,
    start: State,
    tolerance: float,
    grown: np.ndarray | float,
) -> tuple[State, int]:
    """Solve the contact of a pass together with its wear; return it and the number of solves.

    The wear of a pass is part of the gap of that pass, and depends on its pressure, traction and
    slip. With ``method = "uzawa"`` it is updated within the iteration, as in the paper (step V).
    The other methods solve the contact for a given wear and correct the wear until the contact
    conditions hold with it; since a pass wears a thousandth of the approach, each correction gains
    three digits.
    """
    law, dx = required(model.wear_law, "wear"), model.grid.dx

    def depth(pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        return law.depth(entering, pressure, traction, slip, dx)

    if model.method.wears_in_pass:  # at the temperature of the pass before
        last = replace(start, revolution=revolution)
        law = law.under(wear_conditions(model, last, entering))
        return replace(equilibrium(model, depth, start), revolution=revolution), 1

    wear = entering + (start.wear - start.wear[-1]) * grown
    contact, cost, solves = start, Cost(), 0
    # So small that it does not affect the error of a jump or of a correction.
    sharp = max(model.scene.solver.tolerance, 1e-3 * tolerance)
    for _ in range(20):
        contact = replace(equilibrium(model, wear, contact, sharp), revolution=revolution)
        solves += 1
        cost = cost + contact.cost
        law = required(wear_law_at(model, contact), "wear")
        corrected = depth(contact.pressure, contact.traction, contact.slip)
        missed = _residual(model, contact, corrected - wear)
        contact = _with_wear_residual(replace(contact, wear=corrected), missed)
        if not contact.converged or missed <= tolerance:
            break
        wear = corrected
    else:
        contact = replace(
            contact,
            status=Status.OUT_OF_ITERATIONS,
            note=f"the wear within revolution {revolution} did not settle: its residual is "
            f"{missed:.1e}; the wear of one pass is too deep for the contact, lower "
            f"wear.{_key_of_wear(model)} or the creepage",
        )
    return replace(contact, cost=cost), solves


def _key_of_wear(model: Model) -> str:
    """Return the key of [wear] that sets the amount of wear in a scene."""
    wear = required(model.scene.wear, "wear")
    if not wear.together or wear.named_law:
        return "law"
    return "intensity" if wear.coefficient is None else "coefficient"


def _with_wear_residual(contact: State, missed: float) -> State:
    """Return the contact with `missed` as residual, if it is solved and that is larger."""
    larger = contact.converged and missed > contact.residual
    return replace(contact, residual=missed) if larger else contact


def _residual(model: Model, contact: State, change: np.ndarray) -> float:
    """Return the relative residual of the normal contact by a change of wear; 0 if none touches."""
    if not contact.touching.any():
        return 0.0
    gap = np.where(contact.touching, change, 0.0) / model.units.gap
    return float(np.linalg.norm(gap) / np.linalg.norm(contact.pressure / model.units.pressure))
