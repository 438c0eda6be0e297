"""One revolution: a contact and the wear that happens in it."""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.contact import Model, equilibrium, fitted
from tractive_sam.results import Cost, Grid, State, Status

CORRECTIONS = 20


@dataclass(frozen=True, eq=False)
class Milestone:
    """A revolution that later ones extrapolate from.

    Attributes
    ----------
    revolution : int
        Its number.
    profile : ndarray, shape (n_y,)
        Depth with which material enters, mm.
    rate : ndarray, shape (n_y,)
        Depth by which the profile deepens in this revolution, mm.
    """

    revolution: int
    profile: np.ndarray
    rate: np.ndarray

    @property
    def halfway(self) -> np.ndarray:
        """Profile in the middle of the revolution, shape (n_y,), mm."""
        return self.profile + 0.5 * self.rate

    def on(self, elements: int) -> "Milestone":
        """The same on a mesh of more elements in y."""
        more = (elements - self.profile.size) // 2
        return Milestone(self.revolution, np.pad(self.profile, more), np.pad(self.rate, more))


@dataclass(frozen=True, eq=False)
class Passage:
    """State after a revolution; all that the next one needs.

    Attributes
    ----------
    revolution : int
        Revolutions rolled so far.
    contact : State
        The contact during the last of them; its `wear` includes what it wore itself.
    solves : int
        Contacts solved since the passage before.
    jump : int
        Revolutions that adaptive stepping takes next.
    course : tuple of Milestone
        The last two revolutions of adaptive stepping, this one last; one only where it begins.
    """

    revolution: int
    contact: State
    solves: int
    jump: int = 1
    course: tuple[Milestone, ...] = ()

    def __post_init__(self) -> None:
        if not self.course:
            here = Milestone(self.revolution, self.contact.wear[-1], self.gained)
            object.__setattr__(self, "course", (here,))

    def on(self, grid: Grid) -> "Passage":
        """The same on a wider mesh of the same elements."""
        course = tuple(milestone.on(grid.elements[1]) for milestone in self.course)
        return replace(self, contact=self.contact.on(grid), course=course)

    @property
    def entering(self) -> np.ndarray:
        """Depth with which material enters the contact, shape (n_y,), mm.

        After a jump it is corrected by what the contact told; `contact` is the one before.
        """
        return self.course[-1].profile

    @property
    def leaving(self) -> np.ndarray:
        """Depth behind the contact, shape (n_y,), mm."""
        return self.contact.wear[0] + (self.entering - self.contact.wear[-1])

    @property
    def worn(self) -> np.ndarray:
        """Depth that the pass wears off both bodies, shape (n_y,), mm."""
        return self.contact.wear[0] - self.contact.wear[-1]

    @property
    def gain(self) -> float:
        """Part of it that is in the way again, as the bodies come round (see `Turns`)."""
        return self.contact.scene.turns.gain

    @property
    def gained(self) -> np.ndarray:
        """Depth by which this revolution deepens the entering profile, shape (n_y,), mm."""
        return self.gain * self.worn


def unworn(model: Model) -> Passage:
    """Revolution zero: the unworn bodies."""
    return Passage(0, equilibrium(model), 1)


def first_passage(model: Model) -> tuple[Model, Passage]:
    """Revolution zero on a mesh that holds the contact, and the model on that mesh."""
    model, contact = fitted(model)
    return model, Passage(0, contact, 1)


def next_passage(model: Model, last: Passage) -> Passage:
    """Roll one more revolution (paper, section 7)."""
    entering = model.scene.turns.next(last.entering, last.leaving)
    tolerance = model.scene.solver.tolerance
    return passage_at(model, last.revolution + 1, entering, last.contact, tolerance)


def passage_at(
    model: Model,
    revolution: int,
    entering: np.ndarray,
    start: State,
    tolerance: float,
    expected: np.ndarray | None = None,
) -> Passage:
    """Roll through the contact with a given profile.

    The wear of a pass is part of the gap of that pass, and depends on its pressure, traction and
    slip. With ``method = "uzawa"`` it is updated within the iteration, as in the paper (step V).
    The other methods solve the contact for a given wear and correct the wear until the contact
    conditions hold with it; since a pass wears a thousandth of the approach, each correction gains
    three digits.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    revolution : int
        Number of the revolution.
    entering : ndarray, shape (n_y,)
        Depth with which material enters, mm.
    start : State
        A contact nearby, as first guess.
    tolerance : float
        Residual that the wear within the pass may leave in the contact conditions.
    expected : ndarray, shape (n_y,), optional
        Depth that the pass is expected to add, mm; by default that of `start`.
    """
    law, dx = model.wear_law, model.grid.dx

    def depth(pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        return law.depth(entering, pressure, traction, slip, dx)

    if model.method.wears_in_pass:
        return Passage(revolution, equilibrium(model, depth, start), 1)

    wear = entering + _gained(start, expected)
    contact, cost, solves = start, Cost(), 0
    for _ in range(CORRECTIONS):
        contact = equilibrium(model, wear, contact)
        solves += 1
        cost = cost + contact.cost
        corrected = depth(contact.pressure, contact.traction, contact.slip)
        missed = _residual(model, contact, corrected - wear)
        contact = _with_lag(replace(contact, wear=corrected), missed)
        if not contact.converged or missed <= tolerance:
            break
        wear = corrected
    else:
        contact = replace(
            contact,
            status=Status.OUT_OF_ITERATIONS,
            note=f"the wear within revolution {revolution} did not settle: its residual is "
            f"{missed:.1e}; the wear of one pass is too deep for the contact, lower "
            f"wear.{_given_key(model)} or the creepage",
        )
    return Passage(revolution, replace(contact, cost=cost), solves)


def _gained(start: State, expected: np.ndarray | None) -> np.ndarray:
    """Depth that material gains within the pass, at first guess as it did in the one before, mm."""
    gained = start.wear - start.wear[-1]
    if expected is None:
        return gained
    return gained * np.where(gained[0] > 0.0, expected / np.maximum(gained[0], 1e-300), 0.0)


def off_grid(passage: Passage) -> bool:
    """Whether the contact has reached the edge of the mesh."""
    return passage.contact.status is Status.OFF_GRID


def _given_key(model: Model) -> str:
    """Key by which the scene gives how much wears."""
    return "intensity" if model.scene.wear.coefficient is None else "coefficient"


def _with_lag(contact: State, missed: float) -> State:
    """The contact with the residual that its own wear leaves, where that is the larger one."""
    larger = contact.converged and missed > contact.residual
    return replace(contact, residual=missed) if larger else contact


def _residual(model: Model, contact: State, change: np.ndarray) -> float:
    """Natural residual of the normal contact that a change of the wear leaves, relative."""
    if not contact.touching.any():
        return 0.0
    gap = np.where(contact.touching, change, 0.0) / model.units.gap
    return float(np.linalg.norm(gap) / np.linalg.norm(contact.pressure / model.units.pressure))
