"""One revolution: a contact and the wear that happens in it."""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.contact import Contact, Model, equilibrium
from tractive_sam.solvers import Cost, Status

CORRECTIONS = 20


@dataclass(frozen=True)
class Passage:
    """State after a revolution; all that the next one needs.

    Attributes
    ----------
    revolution : int
        Revolutions rolled so far.
    contact : Contact
        The contact during the last of them; its `wear` includes what it wore itself.
    solves : int
        Contacts solved for it.
    """

    revolution: int
    contact: Contact
    solves: int

    @property
    def leaving(self) -> np.ndarray:
        """Depth behind the contact, with which the next revolution begins, shape (n_y,), mm."""
        return self.contact.wear[0]


def unworn(model: Model) -> Passage:
    """Revolution zero: the new bodies."""
    return Passage(0, equilibrium(model), 1)


def next_passage(model: Model, last: Passage) -> Passage:
    """Roll one more revolution (paper, section 7).

    The wear of a pass is part of the gap of that pass, and depends on its pressure and slip. With
    ``method = "uzawa"`` it is updated within the iteration, as in the paper (step V). The other
    methods solve the contact for a given wear and correct the wear until the contact conditions
    hold with it; since a pass wears a thousandth of the approach, each correction gains three
    digits.
    """
    law, entering, dx = model.wear_law, last.leaving, model.grid.dx

    def depth(pressure: np.ndarray, slip: np.ndarray) -> np.ndarray:
        return law.depth(entering, pressure, slip, dx)

    if model.scene.solver.method == "uzawa":
        return Passage(last.revolution + 1, equilibrium(model, depth, last.contact), 1)

    before = last.contact.wear
    # The first guess: as much more as material gained in the last pass.
    wear = before + (entering - before[-1])
    start, cost = last.contact, Cost()
    contact, solves = start, 0
    for _ in range(CORRECTIONS):
        contact = equilibrium(model, wear, start)
        solves += 1
        cost = cost + contact.cost
        corrected = depth(contact.pressure, contact.slip)
        missed = _residual(model, contact, corrected - wear)
        contact = replace(contact, wear=corrected, residual=max(contact.residual, missed))
        if not contact.converged or missed <= model.scene.solver.tolerance:
            break
        wear, start = corrected, contact
    else:
        contact = replace(
            contact,
            status=Status.OUT_OF_ITERATIONS,
            message=f"the wear within revolution {last.revolution + 1} did not settle: its "
            f"residual is {missed:.1e}; the wear of one pass is too deep for the contact, lower "
            "wear.intensity or the creepage",
        )
    return Passage(last.revolution + 1, replace(contact, cost=cost), solves)


def _residual(model: Model, contact: Contact, change: np.ndarray) -> float:
    """Natural residual of the normal contact that a change of the wear leaves, relative."""
    gap = np.where(contact.touching, change, 0.0) / model.units.gap
    return float(np.linalg.norm(gap) / np.linalg.norm(contact.pressure / model.units.pressure))
