"""One revolution: the contacts of a cycle and the wear that happens in them.

A cycle is the contact of a scene, or those of the blocks of its [[duty]]. What a cycle wears is
made of one pass for each block; of the worn bodies a pass knows the profile with which material
enters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.contact import Model, Worn, equilibrium, wear_law_in
from tractive_sam.mechanics import Turns, WearConditions
from tractive_sam.results import PARTS, Cost, Grid, State, Status
from tractive_sam.rolling.process import Step, StepRecord

CORRECTIONS = 20

SHARPER = 1e-3
"""Residual that a contact may leave, over that which the wear of its pass may leave: no jump or
correction is told apart from its error by so little."""


@dataclass(frozen=True, eq=False)
class ProfilePoint:
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

    def on(self, elements: int) -> "ProfilePoint":
        """The same on a mesh of more elements in y."""
        more = (elements - self.profile.size) // 2
        return ProfilePoint(self.revolution, np.pad(self.profile, more), np.pad(self.rate, more))


@dataclass(frozen=True, eq=False)
class Passage(Step):
    """State after a revolution; all that the next one needs.

    Attributes
    ----------
    contacts : tuple of State
        The contact of each block during the last revolution; its `wear` includes what it wore
        itself. Of a scene without [[duty]] there is one.
    revolution : int
        Revolutions rolled so far.
    solves : int
        Contacts solved since the passage before.
    jump : int
        Revolutions that adaptive stepping takes next.
    course : tuple of ProfilePoint
        The last two revolutions of adaptive stepping, this one last; one only where it begins.
    weights : tuple of float
        Share of each block in this revolution: that in a cycle, or one for the block that is
        rolled.
    turns : tuple of Turns
        What lasts of the pass of each block, as the law of wear shares it between the bodies;
        empty: as the scene says.
    began : Worn, optional
        Worn bodies with which the roll began; None of new ones.
    parts : ndarray, shape (blocks, 2, n_y), optional
        Depth with which A and B enter, worn by each block, mm; None where the turns tell it.
    responses : sequence of ndarray, shape (n_y, n_y)
        How the wear of each block answers the profile, 1/revolution; empty where no jump led here.
    """

    revolution: int
    solves: int
    jump: int = 1
    course: tuple[ProfilePoint, ...] = ()
    weights: tuple[float, ...] = (1.0,)
    turns: tuple[Turns, ...] = ()
    began: Worn | None = None
    parts: np.ndarray | None = None
    responses: Sequence[np.ndarray] = ()

    def __post_init__(self) -> None:
        if not self.turns:
            turns = tuple(contact.scene.turns for contact in self.contacts)
            object.__setattr__(self, "turns", turns)
        if not self.course:
            profile = self.contacts[self.rolled or 0].wear[-1]
            here = ProfilePoint(self.revolution, profile, self.gained)
            object.__setattr__(self, "course", (here,))

    @property
    def rolled(self) -> int | None:
        """Which block this revolution is of; None where it is the mean of a cycle."""
        (blocks,) = np.nonzero(self.weights)
        return int(blocks[0]) if blocks.size == 1 else None

    @property
    def contact(self) -> State:
        """The contact of this revolution: of several one that was not solved, or the first."""
        failed = [contact for contact in self.contacts if not contact.converged]
        return failed[0] if failed else self.contacts[self.rolled or 0]

    @property
    def place(self) -> int:
        """Value of the coordinate of its record."""
        return self.revolution

    def record(self, block: int | None = None) -> StepRecord:
        """See `Step.record`."""
        contact = self.contact if block is None else self.contacts[block]
        contact = replace(contact, revolution=self.revolution)
        # The adaptive stepping has corrected the profile with which the material enters.
        entering = self.course[-1].profile
        shift = entering - contact.wear[-1]
        volumes = contact.volumes_of({body: self.around(body) for body in "AB"})
        worn = replace(contact, wear=contact.wear + shift, volumes=volumes)
        given = {
            "revolution": self.revolution,
            "jump": self.jump,
            "solves": self.solves,
            "wear_max": float(worn.wear.max()),
            "worn_volume": worn.worn_volume,
            "worn_mass": worn.worn_mass,
            "wear_profile": self.leaving,
            "entering_profile": entering,
            "wear_per_revolution": self.course[-1].rate,
            "wear_profile_A": self.behind("A"),
            "wear_profile_B": self.behind("B"),
        }
        if self.parts is not None:
            given[PARTS.name] = self.parts
        return StepRecord(contact, given)

    def on(self, grid: Grid) -> "Passage":
        """The same on a wider mesh of the same elements."""
        before = self.grid
        course = tuple(point.on(grid.elements[1]) for point in self.course)
        if self.began is not None:  # it is known beside the mesh, too
            beside = self.began.on(grid).sum(axis=0)
            beside[np.isin(np.arange(len(grid.y)), _middle(before, grid))] = 0.0
            course = tuple(replace(one, profile=one.profile + beside) for one in course)
        contacts = tuple(contact.on(grid.shifted(contact.grid.shift)) for contact in self.contacts)
        more = (grid.elements[1] - before.elements[1]) // 2
        turns = tuple(
            replace(one, share={k: _wider(v, more, "edge") for k, v in one.share.items()})
            for one in self.turns
        )
        parts = _wider(self.parts, more, "constant")
        return replace(self, contacts=contacts, course=course, turns=turns, parts=parts)

    @property
    def entering(self) -> np.ndarray:
        """Depth with which material enters the contact, shape (n_y,), mm.

        After a jump it is corrected by what the contact told; `contact` is the one before.
        """
        return self.course[-1].profile

    @property
    def leaving(self) -> np.ndarray:
        """Depth behind the contact, of a cycle on the mean, shape (n_y,), mm."""
        if self.rolled is None:
            return self.entering + self.worn
        contact = self.contacts[self.rolled]
        return contact.wear[0] + (self.entering - contact.wear[-1])

    @property
    def worn(self) -> np.ndarray:
        """Depth that the pass wears off both bodies, of a cycle on the mean, shape (n_y,), mm."""
        return _mean(self.weights, map(_worn, self.contacts))

    @property
    def gained(self) -> np.ndarray:
        """Depth by which this revolution deepens the entering profile, shape (n_y,), mm.

        Of what each pass wears the part that is in the way again, as the bodies come round (see
        `Turns`).
        """
        gained = (one.gain * _worn(c) for one, c in zip(self.turns, self.contacts, strict=True))
        return _mean(self.weights, gained)

    @property
    def gained_by(self) -> np.ndarray:
        """The same of each body in each block, shape (blocks, 2, n_y), mm."""
        each = zip(self.weights, self.turns, self.contacts, strict=True)
        return np.array(
            [
                [w * one.per_count[body] * one.share[body] * _worn(c) for body in "AB"]
                for w, one, c in each
            ]
        )

    def _before(self, body: str | None = None) -> np.ndarray | float:
        """Depth with which the roll began, of one body or of both, mm."""
        if self.began is None:
            return 0.0
        both = self.began.on(self.grid)
        return both.sum(axis=0) if body is None else both["AB".index(body)]

    @property
    def lost(self) -> np.ndarray:
        """As `parts`, where the turns tell it, too."""
        if self.parts is not None:
            return self.parts
        turns, since = self.turns[0], self.entering - self._before()
        return np.array(
            [[turns.share[body] * turns.per_count[body] / turns.gain * since for body in "AB"]]
        )

    def _entering_of(self, body: str) -> np.ndarray:
        """Depth of one body before the contact, shape (n_y,), mm; where parts are known."""
        return self._before(body) + self.parts[:, "AB".index(body)].sum(axis=0)

    def off(self, body: str) -> tuple[np.ndarray, np.ndarray]:
        """Depth (n_y,) worn off one body before this revolution, and in it, mm; 0 of a flat one."""
        if self.parts is not None:
            return self._entering_of(body), self.gained_by[:, "AB".index(body)].sum(axis=0)
        lasting = self.turns[0].share_of_entering(body)
        here = lasting * (self.entering - self._before())
        return self._before(body) + here, lasting * self.course[-1].rate

    def behind(self, body: str) -> np.ndarray:
        """Depth of one body behind the contact, mm; of a flat one what a single pass wears."""
        if self.parts is None:
            depths = (depth - self._before() for depth in (self.entering, self.leaving))
            return self._before(body) + self.turns[0].of_body(body, *depths)
        each = zip(self.turns, self.contacts, strict=True)
        return self._entering_of(body) + _mean(
            self.weights, (one.share[body] * _worn(contact) for one, contact in each)
        )

    def around(self, body: str) -> np.ndarray:
        """Mean depth worn off one body all around after this revolution, mm (see `Turns.worn`)."""
        if self.parts is None:
            depths = (depth - self._before() for depth in (self.entering, self.leaving))
            return self._before(body) + self.turns[0].worn(body, *depths)
        return self._entering_of(body) + self.gained_by[:, "AB".index(body)].sum(axis=0)


def _worn(contact: State) -> np.ndarray:
    """Depth that a pass of a contact wears off both bodies, shape (n_y,), mm."""
    return contact.wear[0] - contact.wear[-1]


def _mean(weights: Sequence[float], values) -> np.ndarray:
    """Mean by the weights; of one it is itself."""
    return sum(w * value for w, value in zip(weights, values, strict=True) if w)


def _wider(values, more: int, mode: str):
    """Values over y with more elements on either side; a number is the same everywhere."""
    if not isinstance(values, np.ndarray):
        return values
    return np.pad(values, [(0, 0)] * (values.ndim - 1) + [(more, more)], mode=mode)


def _middle(narrow: Grid, wide: Grid) -> np.ndarray:
    """Rows of a mesh that are those of a narrower one."""
    more = (wide.elements[1] - narrow.elements[1]) // 2
    return np.arange(more, more + narrow.elements[1])


def unworn(model: Model) -> Passage:
    """Revolution zero: the bodies as they are."""
    return begun(model, tuple(equilibrium(one, one.worn_before) for one in model.blocks))


def begun(model: Model, contacts: tuple[State, ...]) -> Passage:
    """Revolution zero, of solved contacts."""
    return Passage(contacts, 0, len(contacts), **_of_model(model, contacts))


def adopted(model: Model, last: Passage) -> Passage:
    """Return a passage that was stored, with what its model knows of it."""
    known = _of_model(model, last.contacts, last.rolled)
    return replace(last, **known | {"parts": last.parts if "parts" in known else None})


def _of_model(model: Model, contacts: tuple[State, ...], rolled: int | None = None) -> dict:
    """What a passage takes from its model; `rolled` is the only block of the revolution."""
    turns = tuple(_turns(*one) for one in zip(model.blocks, contacts, strict=True))
    known = {"turns": turns, "began": model.began, "weights": model.weights}
    if rolled is not None:
        known["weights"] = tuple(float(k == rolled) for k in range(len(contacts)))
    apart = any(isinstance(share, np.ndarray) for one in turns for share in one.share.values())
    if apart or len(contacts) > 1:
        known["parts"] = np.zeros((len(contacts), 2, contacts[0].grid.elements[1]))
    return known


def _turns(model: Model, contact: State) -> Turns:
    """What of a pass lasts, as the law of wear shares its depth between the bodies."""
    law, turns = model.wear_law, contact.scene.turns
    if law is None:
        return turns
    temperature = None if contact.heat is None else contact.heat.temperature["A"]
    law = law.under(WearConditions(contact.wear[-1], float(contact.revolution), temperature))
    shares = law.shares(contact.pressure, contact.traction, contact.slip)
    return turns if shares is None else replace(turns, share=dict(zip("AB", shares, strict=True)))


def credited(last: Passage, now: Passage) -> Passage:
    """The next passage, with what each body lost in each block since the one before.

    The profile tells how much that is together; it is shared as the rates are, over a jump as they
    are on the mean of its ends.
    """
    if last.parts is None:
        return now
    by = last.gained_by
    if now.revolution > last.revolution + 1:
        by = by + now.gained_by
    whole, together = by.sum(), by.sum(axis=(0, 1))
    share = by.sum(axis=2, keepdims=True) / whole if whole else np.zeros((*by.shape[:2], 1))
    share = np.where(together > 0.0, by / np.where(together > 0.0, together, 1.0), share)
    return replace(now, parts=last.parts + share * (now.entering - last.entering))


def next_passage(model: Model, last: Passage) -> Passage:
    """Roll one more revolution (paper, section 7); with [[duty]] that of the block in turn."""
    k = last.rolled or 0
    entering = last.turns[k].next(last.entering, last.leaving)
    tolerance, revolution = model.scene.solver.tolerance, last.revolution + 1
    rolled = model.block_at(revolution)
    now = passage_at(model, revolution, entering, last.contacts, tolerance, rolled=rolled)
    return credited(last, now)


def passage_at(
    model: Model,
    revolution: int,
    entering: np.ndarray,
    start: State | Sequence[State],
    tolerance: float,
    grown: np.ndarray | float = 1.0,
    rolled: int | None = None,
) -> Passage:
    """Roll through the contacts of a cycle with a given profile.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    revolution : int
        Number of the revolution.
    entering : ndarray, shape (n_y,)
        Depth with which material enters, mm.
    start : State, or a sequence of one for each block
        Contacts nearby, as first guess.
    tolerance : float
        Residual that the wear within the pass may leave in the contact conditions.
    grown : ndarray, shape (n_y,), or float
        Depth that the pass is expected to add, over that of `start`.
    rolled : int, optional
        The only block to roll through; the contacts of the others stay as they are, at no cost.
    """
    contacts = [start] if isinstance(start, State) else list(start)
    solves = 0
    for k, block in enumerate(model.blocks):
        if rolled in (None, k):
            contacts[k], taken = _pass(block, revolution, entering, contacts[k], tolerance, grown)
            solves += taken
        else:
            contacts[k] = replace(contacts[k], cost=Cost())
    of_model = _of_model(model, tuple(contacts), rolled)
    return Passage(tuple(contacts), revolution, solves, **of_model)


def _pass(
    model: Model,
    revolution: int,
    entering: np.ndarray,
    start: State,
    tolerance: float,
    grown: np.ndarray | float,
) -> tuple[State, int]:
    """What a pass wears, and the contacts solved for it; arguments as of `passage_at`.

    The wear of a pass is part of the gap of that pass, and depends on its pressure, traction and
    slip. With ``method = "uzawa"`` it is updated within the iteration, as in the paper (step V).
    The other methods solve the contact for a given wear and correct the wear until the contact
    conditions hold with it; since a pass wears a thousandth of the approach, each correction gains
    three digits.
    """
    conditions = WearConditions(entering, float(revolution))
    law, dx = model.wear_law.under(conditions), model.grid.dx

    def depth(pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        return law.depth(entering, pressure, traction, slip, dx)

    if model.method.wears_in_pass:
        return replace(equilibrium(model, depth, start), revolution=revolution), 1

    wear = entering + (start.wear - start.wear[-1]) * grown
    contact, cost, solves = start, Cost(), 0
    sharp = max(model.scene.solver.tolerance, SHARPER * tolerance)
    for _ in range(CORRECTIONS):
        contact = replace(equilibrium(model, wear, contact, sharp), revolution=revolution)
        solves += 1
        cost = cost + contact.cost
        law = wear_law_in(model, contact)
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
    return replace(contact, cost=cost), solves


def _given_key(model: Model) -> str:
    """Key by which the scene gives how much wears."""
    wear = model.scene.wear
    if not wear.together or wear.named_law:
        return "law"
    return "intensity" if wear.coefficient is None else "coefficient"


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
