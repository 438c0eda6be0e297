"""State of a transient at one time: the contact, and all that the next step needs."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.contact import StepResult, Worn
from tractive_sam.results import BODIES, Grid, State
from tractive_sam.rolling.courses import Courses
from tractive_sam.rolling.process import Step, StepRecord, StoredStep
from tractive_sam.scene import Scene


@dataclass(frozen=True, eq=False)
class Moment(Step):
    """State of a transient at one rolling distance, with all that the next step needs.

    Attributes
    ----------
    distance : float
        Distance rolled, mm; for shifts their parameter, which then is the unit of lengths below.
    stretch : int
        The stretch between two knots that it lies in or ends; -1 at the first knot.
    result : StepResult
        The contact, and the work of the step to it.
    length : float
        Length of the step to it, mm; 0 if it cannot be extrapolated.
    wish : float
        Length of the next step, mm; 0 at the beginning of a stretch.
    shifts : ndarray, shape (3,)
        Shifts of A over B in x and y, mm, and turn, radians, since the start: without the
        creepages that were rolled at, unless these are what is sought.
    before : StepResult, optional
        The contact one step before.
    solves : int
        Contacts solved for it.
    friction : float
        Work of friction since the start, N mm.
    volumes : ndarray, shape (2,)
        Worn off A and B since they were new, mm³.
    deepest : float
        Largest depth worn off both bodies so far, mm, including the material behind the contact.
    began : Worn, optional
        Worn bodies with which it began; None for new ones.
    earlier : StepResult, optional
        The contact of the record before, if that is between two steps.
    courses : Courses
        Courses of the scene.
    """

    contacts: tuple[State, ...] = field(init=False)
    distance: float
    stretch: int
    result: StepResult
    length: float = 0.0
    wish: float = 0.0
    shifts: np.ndarray = field(default_factory=lambda: np.zeros(3))
    before: StepResult | None = None
    solves: int = 1
    friction: float = 0.0
    volumes: np.ndarray = field(default_factory=lambda: np.zeros(2))
    deepest: float = 0.0
    began: Worn | None = None
    earlier: StepResult | None = None
    courses: Courses = field(kw_only=True, repr=False)

    @classmethod
    def from_stored(cls, scene: Scene, stored: StoredStep) -> "Moment":
        """Return the moment of a stored record, without what the model adds (see `adopt`)."""
        history, row, state = stored.history, stored.row, stored.state
        names = ("distance", "stretch", "next_step", "approach", "xi_x", "xi_y")
        columns = {name: history[name] for name in names}
        contact = stored.contact(scene)
        last, before = stored.earlier_row, None
        length = columns["distance"][row] - columns["distance"][last]
        if length:
            earlier = replace(
                contact,
                pressure=state.get("before_pressure", contact.pressure),
                traction=np.stack((state["before_x"], state["before_y"])),
                approach=float(columns["approach"][last]),
                xi_x=columns["xi_x"][last],
                xi_y=columns["xi_y"][last],
            )
            before = StepResult(earlier)
        none, depths = np.zeros((2, *contact.grid.elements)), {}
        worn: dict[str, Any] = {"friction": float(np.nansum(history["step_friction"][: row + 1]))}
        if "step_worn" in history.columns:
            depths = {name: state[name] for name in ("worn", "gained")}
            worn |= {"volumes": history["worn_volume"][row], "deepest": history["wear_max"][row]}
        energy = float(history["elastic_energy"][row])
        result = StepResult(contact, energy=energy, **{"worn": none, "gained": none} | depths)
        shifts = np.array([history[name][row] for name in ("shift_x", "shift_y", "turn")])
        return cls(
            float(columns["distance"][row]),
            int(columns["stretch"][row]),
            result,
            length,
            float(columns["next_step"][row]),
            shifts,
            before,
            **worn,
            courses=Courses(scene),
        )

    def __post_init__(self) -> None:
        object.__setattr__(self, "contacts", (self.result.contact,))

    @property
    def place(self) -> float:
        """Distance rolled, mm, or parameter of the shifts: the coordinate of its record."""
        return self.distance

    def on(self, grid: Grid) -> "Moment":
        """Return the moment on a wider mesh of equal elements.

        `Transient` computes the gap outside of the former mesh.
        """
        before = None if self.before is None else StepResult(self.before.contact.on(grid))
        return replace(self, result=self.result.on(grid), before=before)

    @property
    def own_state(self) -> Mapping[str, np.ndarray]:
        """Arrays, by name, to resume: tractions and pressure one step before, and the wear."""
        before = self.contact if self.before is None else self.before.contact
        traction = before.traction
        state = {
            "before_pressure": before.pressure,
            "before_x": traction[0],
            "before_y": traction[1],
        }
        if self.contact.scene.wear is not None:
            state |= {"worn": self.result.worn, "gained": self.result.gained}
        return state

    def record(self, block: int | None = None) -> StepRecord:
        """Return the contact and its values; values per rolling distance are nan during a shift."""
        course, contact = self.courses, self.contact
        step, rolls = self.result.since(self.earlier), course.rolled_to(self.stretch)
        distance = step.distance
        per_distance: dict[str, Any] = {}
        if rolls and distance > 0.0:
            per_distance["work_supplied"] = step.supplied / distance
            per_distance["dissipation"] = step.friction / distance
        elif step.shifted or not rolls:
            # A shift has no creepage, and its work is not per distance.
            of_rolling = ("xi_x", "xi_y", "spin", "t_gamma", "work_supplied", "dissipation")
            per_distance = dict.fromkeys((*of_rolling, "t_gamma_over_area"), np.nan)
            per_distance["creepage_found"] = np.full(2, np.nan)
        if contact.scene.wear is not None:
            per_distance |= self._worn(course.table.rolls, step)
            per_distance |= {} if rolls else {"worn_area": np.nan}
            contact = replace(contact, volumes=dict(zip(BODIES, self.volumes, strict=True)))
        values = {
            "distance": self.distance,
            "stretch": self.stretch,
            "next_step": self.wish if self.continues else np.nan,
            "shift_x": self.shifts[0],
            "shift_y": self.shifts[1],
            "turn": self.shifts[2],
            "step_work": step.supplied,
            "step_friction": step.friction,
            "friction_work": self.friction,
            "elastic_energy": step.energy,
            "solves": self.solves,
            **per_distance,
        }
        if course.table.stage:
            values["stage"] = course.stage_index(self.stretch)
        may_store = not course.shift_comes_next(self.stretch, self.distance)
        return StepRecord(contact, values, may_store)

    def _worn(self, rolls: bool, step: StepResult) -> dict[str, Any]:
        """Return the wear columns of the record, from the last step and all before."""
        wear, grid, each = self.contact.wear, self.contact.grid, self.result.worn
        # Shifts leave no track behind the contact: it is the deepest place of each row of elements.
        at, rows = 0 if rolls else wear.argmax(axis=0), np.arange(grid.elements[1])
        new = np.zeros((2, grid.elements[1])) if self.began is None else self.began.on(grid)
        columns = {
            "wear_max": self.deepest,
            "wear_profile": wear[at, rows],
            "entering_profile": wear[-1] if rolls else new.sum(axis=0),
            "step_worn": float(step.gained.sum() * grid.element_area),
        }
        for body, before, depth in zip(BODIES, new, each[:, at, rows], strict=True):
            columns[f"wear_profile_{body}"] = before + depth
        return columns
