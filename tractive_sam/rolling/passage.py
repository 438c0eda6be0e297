"""One revolution: the contacts of a cycle, their wear, and its response to the profile.

A cycle is the contact of a scene, or the contacts of the blocks of its [[duty]]. The wear of a
cycle is one pass for each block. The state of the worn bodies is the profile with which material
enters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from tractive_sam.contact import Model, Worn, equilibrium, wear_conditions, wear_law_at
from tractive_sam.mechanics import Turns
from tractive_sam.operators import row_compliance
from tractive_sam.results import PARTS, Cost, Grid, State, Status
from tractive_sam.rolling.process import Step, StepRecord
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
        residual = max(contact.residual, missed) if contact.converged else contact.residual
        contact = replace(contact, wear=corrected, residual=residual)
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


def _residual(model: Model, contact: State, change: np.ndarray) -> float:
    """Return the relative residual of the normal contact by a change of wear; 0 if none touches."""
    if not contact.touching.any():
        return 0.0
    gap = np.where(contact.touching, change, 0.0) / model.units.gap
    return float(np.linalg.norm(gap) / np.linalg.norm(contact.pressure / model.units.pressure))


@dataclass(frozen=True, eq=False)
class ProfilePoint:
    """Profile and wear rate at a revolution, from which later revolutions are extrapolated.

    Attributes
    ----------
    revolution : int
        Number of the revolution.
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
        """Profile halfway through the revolution, shape (n_y,), mm."""
        return self.profile + 0.5 * self.rate

    def on(self, elements: int) -> "ProfilePoint":
        """Return the profile and rate on a wider mesh, with zeros at both ends."""
        more = (elements - self.profile.size) // 2
        return ProfilePoint(self.revolution, np.pad(self.profile, more), np.pad(self.rate, more))


@dataclass(frozen=True, eq=False)
class Passage(Step):
    """State of the rolling bodies after a revolution, with all that the next one needs.

    Attributes
    ----------
    contacts : tuple of State
        The contact of each block during the last revolution; its `wear` includes its own pass. A
        scene without [[duty]] has one.
    revolution : int
        Revolutions rolled so far.
    solves : int
        Contacts solved since the passage before.
    jump : int
        Revolutions that adaptive stepping takes next.
    course : tuple of ProfilePoint
        The last two revolutions of adaptive stepping, this one last; at its beginning only one.
    weights : tuple of float
        Share of each block in this revolution: that in a cycle, or 1 for the rolled block.
    turns : tuple of Turns
        Lasting part of the pass of each block, as the law of wear shares it between the bodies;
        empty: according to the scene.
    began : Worn, optional
        Worn bodies with which the roll began; None for new ones.
    parts : ndarray, shape (blocks, 2, n_y), optional
        Depth with which A and B enter, worn by each block, mm; None if it follows from the turns.
    responses : sequence of ndarray, shape (n_y, n_y)
        Response of the wear of each block to the profile, 1/revolution; empty without a jump.
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
        """Index of the only block in this revolution; None if it stands for the mean of a cycle."""
        (blocks,) = np.nonzero(np.array(self.weights))
        return int(blocks[0]) if blocks.size == 1 else None

    @property
    def contact(self) -> State:
        """Contact of this revolution: the first unsolved one, else the rolled or first block's."""
        failed = [contact for contact in self.contacts if not contact.converged]
        return failed[0] if failed else self.contacts[self.rolled or 0]

    @property
    def place(self) -> int:
        """Revolutions rolled, the coordinate of the passage's record."""
        return self.revolution

    def record(self, block: int | None = None) -> StepRecord:
        """Return a contact (a block's, or the passage's) with corrected wear, and its columns."""
        contact = self.contact if block is None else self.contacts[block]
        contact = replace(contact, revolution=self.revolution)
        # The adaptive stepping has corrected the profile with which the material enters.
        entering = self.course[-1].profile
        shift = entering - contact.wear[-1]
        volumes = contact.volumes_of({body: self.mean_depth(body) for body in "AB"})
        worn = replace(contact, wear=contact.wear + shift, volumes=volumes)
        values = {
            "revolution": self.revolution,
            "jump": self.jump,
            "solves": self.solves,
            "wear_max": float(worn.wear.max()),
            "worn_volume": worn.worn_volume,
            "worn_mass": worn.worn_mass,
            "wear_profile": self.leaving,
            "entering_profile": entering,
            "wear_per_revolution": self.course[-1].rate,
            "wear_profile_A": self.depth_behind("A"),
            "wear_profile_B": self.depth_behind("B"),
        }
        if self.parts is not None:
            values[PARTS.name] = self.parts
        return StepRecord(contact, values)

    def on(self, grid: Grid) -> "Passage":
        """Return the passage on a wider mesh; its new rows have only the initial wear."""
        before = self.grid
        more = (grid.elements[1] - before.elements[1]) // 2
        course = tuple(point.on(grid.elements[1]) for point in self.course)
        if self.began is not None:  # the initial wear is also defined outside the mesh
            margin = self.began.on(grid).sum(axis=0)
            margin[more : more + before.elements[1]] = 0.0
            course = tuple(replace(point, profile=point.profile + margin) for point in course)
        contacts = tuple(contact.on(grid.shifted(contact.grid.shift)) for contact in self.contacts)
        turns = tuple(
            replace(turn, share={k: _pad_rows(v, more, "edge") for k, v in turn.share.items()})
            for turn in self.turns
        )
        parts = _pad_rows(self.parts, more, "constant")
        return replace(self, contacts=contacts, course=course, turns=turns, parts=parts)

    @property
    def entering(self) -> np.ndarray:
        """Wear depth of both bodies with which material enters the contact, shape (n_y,), mm.

        After a jump it is corrected by the rate of its contact; `contact` is not.
        """
        return self.course[-1].profile

    @property
    def leaving(self) -> np.ndarray:
        """Wear depth of both bodies behind the rolled block (else the mean of all), (n_y,), mm."""
        if self.rolled is None:
            return self.entering + self.worn
        contact = self.contacts[self.rolled]
        return contact.wear[0] + (self.entering - contact.wear[-1])

    @property
    def worn(self) -> np.ndarray:
        """Depth that one pass wears off both bodies, weighted mean of blocks, (n_y,), mm."""
        return _weighted_mean(self.weights, map(depth_of_pass, self.contacts))

    @property
    def gained(self) -> np.ndarray:
        """Depth that this revolution adds to the entering profile, shape (n_y,), mm.

        It is the part of the wear of each pass that returns to the contact (see `Turns`).
        """
        contacts = zip(self.turns, self.contacts, strict=True)
        gained = (turns.gain * depth_of_pass(contact) for turns, contact in contacts)
        return _weighted_mean(self.weights, gained)

    @property
    def gained_by_block(self) -> np.ndarray:
        """Depth that each block adds to each body in this revolution, (blocks, 2, n_y), mm."""
        each = zip(self.weights, self.turns, self.contacts, strict=True)
        gained = [
            [w * turns.per_count[body] * turns.share[body] * depth_of_pass(c) for body in "AB"]
            for w, turns, c in each
        ]
        return np.array(gained)

    def _initial_depth(self, body: str | None = None) -> np.ndarray | float:
        """Return the wear depth with which the roll began, of one body or both, mm; or 0."""
        if self.began is None:
            return 0.0
        both = self.began.on(self.grid)
        return both.sum(axis=0) if body is None else both["AB".index(body)]

    @property
    def worn_parts(self) -> np.ndarray:
        """Depth worn off each body by each block so far, shape (blocks, 2, n_y), mm."""
        if self.parts is not None:
            return self.parts
        turns, since = self.turns[0], self.entering - self._initial_depth()
        return np.array(
            [[turns.share[body] * turns.per_count[body] / turns.gain * since for body in "AB"]]
        )

    def _entering_of(self, body: str) -> np.ndarray:
        """Return the entering wear depth of one body, shape (n_y,), mm; `parts` must be set."""
        return self._initial_depth(body) + self.worn_parts[:, "AB".index(body)].sum(axis=0)

    def worn_depths(self, body: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the depths (n_y,), mm, worn off a body before this revolution and in it."""
        if self.parts is not None:
            return self._entering_of(body), self.gained_by_block[:, "AB".index(body)].sum(axis=0)
        lasting = self.turns[0].share_of_entering(body)
        here = lasting * (self.entering - self._initial_depth())
        return self._initial_depth(body) + here, lasting * self.course[-1].rate

    def depth_behind(self, body: str) -> np.ndarray:
        """Return the wear depth of one body behind the contact, shape (n_y,), mm."""
        if self.parts is None:
            depths = (depth - self._initial_depth() for depth in (self.entering, self.leaving))
            return self._initial_depth(body) + self.turns[0].depth_behind(body, *depths)
        each = zip(self.turns, self.contacts, strict=True)
        depths = (turns.share[body] * depth_of_pass(contact) for turns, contact in each)
        return self._entering_of(body) + _weighted_mean(self.weights, depths)

    def mean_depth(self, body: str) -> np.ndarray:
        """Return the wear depth of a body averaged around its circumference, shape (n_y,), mm."""
        if self.parts is None:
            depths = (depth - self._initial_depth() for depth in (self.entering, self.leaving))
            return self._initial_depth(body) + self.turns[0].mean_depth(body, *depths)
        return self._entering_of(body) + self.gained_by_block[:, "AB".index(body)].sum(axis=0)


def depth_of_pass(contact: State) -> np.ndarray:
    """Return the depth that one pass wears off both bodies, shape (n_y,), mm."""
    return contact.wear[0] - contact.wear[-1]


def _weighted_mean(weights: Sequence[float], values) -> np.ndarray:
    """Return the sum of weight times value; values with weight zero are not evaluated."""
    return sum(w * value for w, value in zip(weights, values, strict=True) if w)


def _pad_rows(values: Any, more: int, mode: Literal["constant", "edge"]) -> Any:
    """Return values over y padded by `more` elements at both ends; plain numbers unchanged."""
    if not isinstance(values, np.ndarray):
        return values
    return np.pad(values, [(0, 0)] * (values.ndim - 1) + [(more, more)], mode=mode)


def first_passage(model: Model) -> Passage:
    """Solve the steady contacts with the initial wear; return them as revolution zero."""
    contacts = tuple(equilibrium(block, block.initial_wear) for block in model.blocks)
    return start_passage(model, contacts)


def start_passage(model: Model, contacts: tuple[State, ...]) -> Passage:
    """Return the passage of revolution zero from already solved contacts."""
    return Passage(contacts, 0, len(contacts), **_from_model(model, contacts))


def complete_passage(model: Model, last: Passage) -> Passage:
    """Return a stored passage with the attributes that follow from its model."""
    values = _from_model(model, last.contacts, last.rolled)
    return replace(last, **values | {"parts": last.parts if "parts" in values else None})


def _from_model(model: Model, contacts: tuple[State, ...], rolled: int | None = None) -> dict:
    """Return the attributes of a passage that follow from its model, by name.

    `rolled` is the only block of the revolution, if there is one.
    """
    turns = tuple(_turns_after_wear(*pair) for pair in zip(model.blocks, contacts, strict=True))
    values: dict[str, Any] = {"turns": turns, "began": model.began, "weights": model.weights}
    if rolled is not None:
        values["weights"] = tuple(float(k == rolled) for k in range(len(contacts)))
    shares = [share for turn in turns for share in turn.share.values()]
    if len(contacts) > 1 or any(isinstance(share, np.ndarray) for share in shares):
        values["parts"] = np.zeros((len(contacts), 2, contacts[0].grid.elements[1]))
    return values


def _turns_after_wear(model: Model, contact: State) -> Turns:
    """Return the `Turns` of the scene, with the wear law's shares of the bodies if it has any."""
    law, turns = model.wear_law, contact.scene.turns
    if law is None:
        return turns
    law = law.under(wear_conditions(model, contact))
    shares = law.shares(contact.pressure, contact.traction, contact.slip)
    return turns if shares is None else replace(turns, share=dict(zip("AB", shares, strict=True)))


def attribute_wear(last: Passage, passage: Passage) -> Passage:
    """Return a passage with the wear since the last one by block and body, if `parts` are set.

    The profile determines the total. It is shared in proportion to the rates; over a jump to the
    mean of the rates at its ends.
    """
    if last.parts is None:
        return passage
    by = last.gained_by_block
    if passage.revolution > last.revolution + 1:
        by = by + passage.gained_by_block
    total, rows = by.sum(), by.sum(axis=(0, 1))
    share = by.sum(axis=2, keepdims=True) / total if total else np.zeros((*by.shape[:2], 1))
    share = np.where(rows > 0.0, by / np.where(rows > 0.0, rows, 1.0), share)
    return replace(passage, parts=last.parts + share * (passage.entering - last.entering))


def next_passage(model: Model, last: Passage) -> Passage:
    """Return the next revolution (paper, section 7), of a duty cycle the next block's."""
    k = last.rolled or 0
    entering = last.turns[k].next_entering(last.entering, last.leaving)
    tolerance, revolution = model.scene.solver.tolerance, last.revolution + 1
    rolled = model.block_at(revolution)
    passage = passage_at(model, revolution, entering, last.contacts, tolerance, rolled=rolled)
    return attribute_wear(last, passage)


def passage_at(
    model: Model,
    revolution: int,
    entering: np.ndarray,
    start: State | Sequence[State],
    tolerance: float,
    grown: np.ndarray | float = 1.0,
    rolled: int | None = None,
) -> Passage:
    """Solve the contacts and their wear in a revolution for a prescribed entering profile.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    revolution : int
        Number of the revolution.
    entering : ndarray, shape (n_y,)
        Depth with which material enters, mm.
    start : State, or a sequence of one for each block
        Contacts nearby, as initial guess.
    tolerance : float
        Residual of the contact conditions that the wear within the pass may leave.
    grown : ndarray, shape (n_y,), or float
        Depth that the pass is expected to add, over the depth in `start`.
    rolled : int, optional
        The only block to roll through; the contacts of the others are returned at no cost.
    """
    contacts = [start] if isinstance(start, State) else list(start)
    solves = 0
    for k, block in enumerate(model.blocks):
        if rolled in (None, k):
            contacts[k], taken = solve_pass(
                block, revolution, entering, contacts[k], tolerance, grown
            )
            solves += taken
        else:
            contacts[k] = replace(contacts[k], cost=Cost())
    of_model = _from_model(model, tuple(contacts), rolled)
    return Passage(tuple(contacts), revolution, solves, **of_model)


def wear_response(model: Model, contact: State) -> np.ndarray:
    """Return the approximate Jacobian of the wear of a pass by the entering profile, (n_y, n_y).

    Material that is worn deeper carries less pressure, by the compliance between rows at constant
    load, and wears less: waves of the profile decay at a rate proportional to their wave number, up
    to i |s| a E* q per revolution. That makes rolling stiff. Slip, contact area and the ratio of
    traction to pressure are assumed constant; the method that uses the response is of second order
    for any approximation.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    contact : State
        The contact at the profile.

    Returns
    -------
    ndarray, shape (n_y, n_y)
        1/revolution; zero for rows that are not in contact.
    """
    response = np.zeros((model.grid.elements[1],) * 2)
    if not contact.touching.any():
        return response
    rows = np.flatnonzero(contact.touching.any(axis=0))
    stiffness, _ = _row_stiffness(model, row_compliance(model.operators, contact.touching))
    response[np.ix_(rows, rows)] = -_wear_per_load(model, contact)[rows, None] * stiffness
    return response


def _row_stiffness(model: Model, compliance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return loads of rows by their displacements, and their shares in a prescribed load.

    The compliance is that of the rows in contact. Without a prescribed load the shares are zero.
    """
    stiffness = np.linalg.inv(compliance)
    if model.load is None:
        return stiffness, np.zeros(len(compliance))
    # A uniform depth only moves the bodies closer.
    uniform = stiffness.sum(axis=1)
    shares = uniform / uniform.sum()
    return stiffness - np.outer(shares, stiffness.sum(axis=0)), shares


class RowContact:
    """Wear of the rows of elements of one contact for profiles near its own.

    A row carries load, and wears in proportion to it, or its gap is open. Loads and gaps change by
    the compliance between rows; slip and the ratio of wear to load are those of the contact.

    Parameters
    ----------
    model : Model
        The scene in numbers, of the block of the contact.
    contact : State
        The contact.
    gain : ndarray, shape (n_y,), or float
        Depth that a revolution adds over that of the pass.
    profile, rate : ndarray, shape (n_y,)
        Profile at which the rows wear by `rate`, mm and mm per revolution.
    closing : float
        Rows with a gap up to this may come into contact, mm.
    """

    def __init__(
        self,
        model: Model,
        contact: State,
        gain: np.ndarray | float,
        profile: np.ndarray,
        rate: np.ndarray,
        closing: float,
    ) -> None:
        # Elements beside the contact, once they touch, carry little: a tenth of those that close.
        footprint = 0.1
        gap = np.where(contact.touching, 0.0, contact.gap)
        lowest = gap.min(axis=0)
        near = (gap <= lowest + footprint * closing) & (lowest <= closing)
        touching = contact.touching | (near if contact.touching.any() else False)
        self.rows = np.flatnonzero(touching.any(axis=0))
        """Rows that are or may come into contact."""
        self.touching = rate[self.rows] > 0.0
        """Rows in contact at the profile, shape of `rows`."""
        self._model, self._elements = model, profile.size
        self._cached = dict[bytes, tuple[np.ndarray, np.ndarray]]()
        if not self.rows.size:
            return
        self._compliance = row_compliance(model.operators, touching)
        per_load = (gain * _wear_per_load(model, contact))[self.rows]
        self._per_load = np.maximum(per_load, 1e-300)
        load = rate[self.rows] / self._per_load
        self._load = load.sum()
        open_ = np.where(self.touching, 0.0, lowest[self.rows])
        # Where rows touch, the profile and the displacement by their loads add up to this.
        self._sum = self._compliance @ load + profile[self.rows] - open_

    def linear(self, touching: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return J, (n_y, n_y), and R_0, (n_y,), of the wear rate R_0 + J E of a profile E.

        `touching` are the rows of `rows` in contact; the others do not wear.
        """
        key = touching.tobytes()
        if key not in self._cached:
            response, rate = np.zeros((self._elements,) * 2), np.zeros(self._elements)
            if touching.any():
                stiffness, shares = _row_stiffness(
                    self._model, self._compliance[np.ix_(touching, touching)]
                )
                here, per_load = self.rows[touching], self._per_load[touching]
                response[np.ix_(here, here)] = -per_load[:, None] * stiffness
                load = stiffness @ self._sum[touching] + shares * self._load
                rate[here] = per_load * load
            self._cached[key] = response, rate
        return self._cached[key]

    def update(self, touching: np.ndarray, profile: np.ndarray) -> np.ndarray:
        """Return the rows in contact: of `touching` those with load, of the others the overlapping.

        Both at the profile, with the load on the rows of `touching`.
        """
        if not touching.any():
            return touching
        response, rate = self.linear(touching)
        rate = (rate + response @ profile)[self.rows]
        gap = profile[self.rows] + self._compliance @ (rate / self._per_load) - self._sum
        if self._model.load is not None:
            gap -= gap[touching].mean()
        return np.where(touching, rate > 0.0, gap < -1e-9 * np.abs(self._sum).max())


def _wear_per_load(model: Model, contact: State) -> np.ndarray:
    """Return the wear depth of each row per MPa summed over it, mm; constant beyond the contact."""
    count = contact.touching.sum(axis=0)
    law = required(wear_law_at(model, contact), "wear")
    rate = law.per_load(contact.pressure, contact.traction, contact.slip)
    per_pressure = rate.sum(axis=0)
    inside = np.flatnonzero(count)
    values = model.grid.dx * per_pressure[inside] / count[inside]
    return np.interp(np.arange(count.size), inside, values)
