"""The patches of a wheel on a rail, one record each, and the wear of both profiles in a duty.

The depths worn off both profiles, along their normals and over their arc lengths, follow

    dE/dN = F(E) = sum over positions of w_j D_j R_j(I_j E)

with the share w_j of a position in the revolutions, the depth R_j that its patches wear in a pass,
the depths I_j E of both bodies together at the rows of a patch, and D_j, which distributes the
depth at rows over the nodes of the profiles so that the worn section is exactly that of the rows.

Short waves of a profile decay fast (`rolling.passage`). Steps are linearly implicit in the
response J_j of R_j, so that stability does not limit them, whatever the error of J_j:

    (1 - dN A) dE = dN F(E),  A = sum w_j D_j J_j I_j.

A step of dN and two of dN/2 together, extrapolated, are of second order: 2 (dE_1 + dE_2) - dE (see
Hairer and Wanner, Solving Ordinary Differential Equations II, IV.9). Rates at the beginning, the
middle and the end are then known. The difference between Simpson's rule for them and the step,
damped by (1 - dN A)^-1, is the error of a step, of third order.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from tractive_sam.contact import Model, solve_patches_on_fitted_mesh, wear_law_at
from tractive_sam.rail import Patch, Profile
from tractive_sam.results import (
    COORDINATE,
    Grid,
    Quantity,
    Record,
    State,
    WornProfiles,
    columns,
    cycle_record,
)
from tractive_sam.rolling.observers import Damage
from tractive_sam.rolling.passage import start_passage, wear_response
from tractive_sam.rolling.process import (
    ErrorControl,
    FixedSteps,
    Process,
    Recorder,
    Step,
    StepRecord,
    Stops,
    StoredStep,
)
from tractive_sam.scene import Scene, WheelRail, unworn_profiles
from tractive_sam.schema import Fault, SceneError, required

WHEEL_COLUMNS = (
    Quantity("contact_y", "mm", "lateral position of the patch on the rail, outward", label="y"),
    Quantity(
        "contact_angle",
        "degrees",
        "angle between the tangent plane of the patch and the horizontal",
    ),
    Quantity("angle_range", "degrees", "range of the contact angle over the patch"),
    Quantity("rolling_radius", "mm", "rolling radius of the wheel at the patch"),
    Quantity("pitch", "1", "ratio of the angular velocity of the wheelset to V / radius, minus 1"),
    Quantity("patches", "1", "number of patches of the wheel that carry load", format="d"),
)
"""Columns of a patch of a wheel."""


def describe_patch(patch: Patch, contact: State, patches: int) -> dict[str, Any]:
    """Return the values of `WHEEL_COLUMNS`, by name, of a solved wheel-rail patch."""
    rows, scene = contact.grid.y[contact.touching.any(axis=0)], contact.scene
    follows = scene.wheel_rail.is_motion(scene.creepage)
    return {
        "contact_y": float(patch.origin[1]),
        "contact_angle": math.degrees(patch.angle),
        "angle_range": math.degrees(patch.angle_range_over(rows)) if rows.size else math.nan,
        "rolling_radius": patch.rolling_radius,
        "pitch": patch.pitch_at(contact.xi_x) if follows else math.nan,
        "patches": patches,
    }


@dataclass(frozen=True, eq=False)
class PatchStep(Step):
    """Step of `WheelRailPatches`: one solved contact patch of a wheel on a rail.

    Attributes
    ----------
    patch : Patch
        Geometry of the patch.
    number : int
        Its place among the patches by increasing load, from 1.
    patches : int
        Number of patches.
    """

    patch: Patch | None = None
    number: int = 1
    patches: int = 1

    @property
    def place(self) -> float:
        """Number of the patch by increasing load, from 1: the coordinate of its record."""
        return self.number

    def on(self, grid: Grid) -> Self:
        """Return the step on a wider mesh of equal elements (`Step.on`)."""
        return replace(self, contacts=tuple(contact.on(grid) for contact in self.contacts))

    def record(self, block: int | None = None) -> StepRecord:
        """Return the contact of the patch, with its number and geometry, for its record."""
        assert self.patch is not None
        values = {"patch": self.number, "jump": 1, "solves": 1}
        values |= describe_patch(self.patch, self.contact, self.patches)
        return StepRecord(self.contact, values)


@dataclass(frozen=True, eq=False)
class PatchDamage(Damage):
    """Observer of the fatigue of wheel and rail, separately for each patch.

    Patches load different material, so that no damage adds up from one record to the next.
    """

    def begin(self, passage: Step, model: Model) -> Self:
        """Return the observer after the pass of a patch, which begins undamaged."""
        return super().begin(start_passage(model, passage.contacts), model)

    def after(self, passage: Step, model: Model) -> Self:
        """Return the observer after another patch, without the damage of previous patches."""
        return self.begin(passage, model)

    def restore(self, passage: Step, stored: StoredStep) -> Self:
        """Return an observer without damage: later patches do not depend on it."""
        return self


class WheelRailPatches(Process[PatchStep]):
    """Process that solves all contact patches of a wheel on a rail, which share its load."""

    columns = (
        Quantity(
            "patch", "1", "patches by increasing load", format="d", whole=True, role=COORDINATE
        ),
        *WHEEL_COLUMNS,
    )
    observers = (PatchDamage,)
    first_applications = 240.0  # each trial of the load of a patch is a contact

    def begin(self) -> PatchStep:
        """Return the first step: the solved patch with the least load."""
        return self.begin_fitted()[1]

    def begin_fitted(self) -> tuple[Self, PatchStep]:
        """Solve all patches on a fitted mesh; return the process on it, and its first step."""
        model, steps = solve_patch_steps(self.model)
        process = self._copy_with(model)
        process.solved = steps
        return process, steps[0]

    solved: tuple[PatchStep, ...] = ()

    def advance(self, last: PatchStep) -> Iterator[PatchStep]:
        """Yield the solved patches with more load than the patch `last`."""
        steps = self.solved or solve_patch_steps(self.model)[1]
        yield from (step for step in steps if step.number > last.number and last.converged)

    @classmethod
    def restore(cls, scene: Scene, stored: StoredStep) -> PatchStep:
        """Return the step of a stored record: number and contact, without the patch geometry."""
        number = int(stored.history["patch"][stored.row])
        return PatchStep((stored.contact(scene),), number=number)

    @classmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return the number of contact patches: each patch is a record."""
        return len(scene.wheel_rail.patches)


def solve_patch_steps(model: Model) -> tuple[Model, tuple[PatchStep, ...]]:
    """Return (model, touching patches by load) on a fitted mesh; only the unsolved one, if any."""
    model, contacts = solve_patches_on_fitted_mesh(model)
    pairs = [*zip(contacts, model.scene.wheel_rail.patches, strict=True)]
    touching = [pair for pair in pairs if pair[0].touching.any()] or pairs[:1]
    ordered: list[tuple[State, Patch]] = sorted(touching, key=lambda pair: pair[0].P)
    failed = next((contact for contact in contacts if not contact.converged), None)
    if failed is not None:  # the history ends with it
        ordered = [(failed, ordered[0][1])]
    return model, tuple(
        PatchStep((contact,), patch=patch, number=k + 1, patches=len(ordered))
        for k, (contact, patch) in enumerate(ordered)
    )


Depths = tuple[np.ndarray, np.ndarray]
"""Depths worn off the wheel and off the rail at the nodes of their profiles, mm."""


@dataclass(frozen=True, eq=False)
class PatchWear:
    """Wear rates of wheel and rail in one contact patch, and their response to the wear.

    Attributes
    ----------
    rates : ndarray, shape (2, n_y)
        Depth of wheel and rail at each row per revolution of the wheel, mm.
    response : ndarray, shape (n_y, n_y)
        Derivative of the depth of both with respect to the profile, 1/revolution.
    places : ndarray, shape (2, n_y)
        Arc lengths of the new wheel and of the new rail at the rows, mm.
    width : float
        Width of a row, mm.
    work : float
        Frictional work per length of track, N.
    area : float
        Cross-section that a single pass wears off both, mm2; it is not stored.
    """

    rates: np.ndarray
    response: np.ndarray
    places: np.ndarray
    width: float
    work: float
    area: float = math.nan


@dataclass(frozen=True, eq=False)
class PositionWear:
    """Wear of wheel and rail at one lateral position of the wheelset, patch by patch.

    Attributes
    ----------
    share : float
        Share of the position in the revolutions.
    contact : State
        Contact of the patch with most load, or one that was not solved.
    start : State
        Contact of the first patch, from which the next step starts.
    worn : tuple of PatchWear
        Wear of each patch that touches.
    values : mapping of str to object
        Columns of the position that the contact alone does not determine.
    """

    share: float
    contact: State
    start: State
    worn: tuple[PatchWear, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Start contact and wear of each patch as arrays, by name, for `restore`."""
        start = self.start
        numbers = (*start.grid.half_length, start.approach)
        state = {
            "fields": np.stack((start.pressure, *start.traction)),
            "numbers": np.array(numbers),
        }
        for name in ("rates", "response", "places", "width", "work"):
            state[name] = np.stack([getattr(patch, name) for patch in self.worn])
        return state

    @classmethod
    def restore(
        cls, share: float, contact: State, state: Mapping[str, np.ndarray]
    ) -> "PositionWear":
        """Return the wear at a position from its stored arrays and its contact."""
        pressure, *traction = state["fields"]
        *half_length, approach = state["numbers"].tolist()
        grid = Grid((half_length[0], half_length[1]), pressure.shape)
        none = np.zeros(pressure.shape)
        start = replace(
            contact,
            **{"grid": grid, "pressure": pressure, "traction": np.stack(traction)},
            **{"slip": np.stack((none, none)), "gap": none, "wear": none, "approach": approach},
        )
        arrays = [state[name] for name in ("rates", "response", "places")]
        # Files of earlier versions have neither.
        absent = {
            "width": np.full(len(arrays[0]), grid.dy),
            "work": np.full(len(arrays[0]), np.nan),
        }
        arrays += [state.get(name, values) for name, values in absent.items()]
        worn = tuple(PatchWear(*patch) for patch in zip(*arrays, strict=True))
        return cls(share, start, start, worn)


PROFILE_ERROR = 3.0
"""Largest error of a profile over the tolerated error of the wear depth: its edges are less smooth,
and the same holds for other bodies (`rolling.revolutions`)."""


class WearRate:
    """Rate of wear at the nodes of both profiles, with its linear response to the wear.

    Parameters
    ----------
    positions : sequence of PositionWear
        All positions, solved.
    nodes : tuple of ndarray
        Arc lengths of the nodes of both profiles, mm.

    Attributes
    ----------
    rate : ndarray, shape (n,)
        Depth per revolution at the nodes of the wheel and then of the rail, mm.
    work : float
        Frictional work per length of track and revolution, N.
    """

    def __init__(self, positions: Sequence[PositionWear], nodes: Depths):
        patches = [(position.share, patch) for position in positions for patch in position.worn]
        onto = [_distribution(patch, nodes) for _, patch in patches]
        self.rate = np.zeros(sum(at.size for at in nodes))
        for (share, _), matrix in zip(patches, onto, strict=True):
            self.rate += share * matrix.sum(axis=1)
        self.work = sum(share * patch.work for share, patch in patches)
        self._worn = np.flatnonzero(self.rate)
        self._response = np.zeros((self._worn.size,) * 2)
        for (share, patch), matrix in zip(patches, onto, strict=True):
            pairs = zip(patch.places, nodes, strict=True)
            at_rows = np.concatenate([_hats(at, s) for s, at in pairs], axis=1)[:, self._worn]
            total = patch.rates.sum(axis=0)
            onto_worn = matrix[self._worn] / np.where(total > 0.0, total, 1.0)
            self._response += share * onto_worn @ patch.response @ at_rows

    def damp(self, length: float, depths: np.ndarray) -> np.ndarray:
        """Return (1 - length A)^-1 depths, shape (n,): an implicit step if depths = length rate."""
        damped = depths.copy()
        system = np.eye(self._worn.size) - length * self._response
        damped[self._worn] = np.linalg.solve(system, depths[self._worn])
        return damped


def _distribution(patch: PatchWear, nodes: Depths) -> np.ndarray:
    """Return the depths per revolution at all nodes that each row of a patch causes, (n, n_y).

    The depth over a profile is linear between the rows. Each row has the section of its element.
    Weighted by the hat function of a node, the section over the integral of the hat function is the
    depth there: the trapezoidal rule for the depths gives the section of the rows exactly.
    """
    matrices = []
    for rates, places, at in zip(patch.rates, patch.places, nodes, strict=True):
        matrix = np.zeros((at.size, rates.size))
        worn = np.flatnonzero(rates)
        if worn.size:
            rows = np.arange(max(worn[0] - 1, 0), min(worn[-1] + 2, rates.size))
            first, last = np.searchsorted(at, places[rows[[0, -1]]])
            near = slice(max(first - 1, 0), last + 1)
            s = np.union1d(places[rows], np.clip(at[near], *places[rows[[0, -1]]]))
            ends, middle, steps = s[:-1], 0.5 * (s[:-1] + s[1:]), np.diff(s)
            points = np.concatenate((ends, middle, s[1:]))  # Simpson's rule is exact for them
            weights = np.concatenate((steps, 4.0 * steps, steps)) / 6.0
            shares = (_hats(at[near], points) * weights[:, None]).T @ _hats(places[rows], points)
            shares *= patch.width * rates[rows] / shares.sum(axis=0)
            matrix[near, rows[0] : rows[-1] + 1] = shares / np.gradient(at)[near, None]
        matrices.append(matrix)
    return np.concatenate(matrices)


def _hats(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the hat functions of nodes at places, (n, nodes): linear interpolation, 0 beyond."""
    k = np.clip(np.searchsorted(nodes, at) - 1, 0, nodes.size - 2)
    share = (at - nodes[k]) / (nodes[k + 1] - nodes[k])
    matrix, rows = np.zeros((at.size, nodes.size)), np.arange(at.size)
    inside = (share >= 0.0) & (share <= 1.0)
    matrix[rows, k], matrix[rows, k + 1] = inside * (1.0 - share), inside * share
    return matrix


def _without_gain(depths: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return depths of at least 0 with the same integral over the nodes, shape (n,), mm."""
    positive = np.maximum(depths, 0.0)
    section = np.trapezoid(positive, at)
    return positive * (np.trapezoid(depths, at) / section) if section > 0.0 else positive


@dataclass(frozen=True, eq=False)
class WornStep(Step):
    """Worn wheel and rail profiles after some revolutions, with the contacts at all positions.

    Attributes
    ----------
    revolution : int
        Revolutions of the wheel.
    depths : tuple of ndarray
        Depths worn off wheel and rail at the nodes of their profiles, mm.
    positions : tuple of PositionWear
        Each different position of the duty.
    mesh : Grid
        Mesh of the history; the contacts have separate meshes, and their fields are not stored.
    work : float
        Frictional work per length of track since the profiles were new, N.
    error : float
        Sum of the largest errors of all steps, mm.
    jump : float
        Revolutions of the next step that the error of the last one allows; 0 before the first.
    solves : int
        Contacts that the step took.
    """

    contacts: tuple[State, ...] = field(init=False)
    revolution: int
    depths: Depths
    positions: tuple[PositionWear, ...]
    mesh: Grid
    work: float = 0.0
    error: float = 0.0
    jump: float = 0.0
    solves: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "contacts", tuple(position.contact for position in self.positions))

    @property
    def place(self) -> int:
        """Revolutions of the wheel, the coordinate of the step's record."""
        return self.revolution

    @property
    def weights(self) -> tuple[float, ...]:
        """Share of each position of the wheelset in the revolutions."""
        return tuple(position.share for position in self.positions)

    @property
    def grid(self) -> Grid:
        """Mesh of the history; the contacts have other meshes."""
        return self.mesh

    @property
    def is_outgrown(self) -> bool:
        """False: each step chooses the mesh of each position.

        The mesh of each contact has grown with it.
        """
        return False

    def on(self, grid: Grid) -> "WornStep":
        """Raise a ValueError: the contacts of worn profiles have separate meshes."""
        raise ValueError("the contacts of worn profiles have separate meshes")

    @property
    def own_state(self) -> Mapping[str, np.ndarray]:
        """Arrays of each position, by name ("position0_..."), needed to resume."""
        return {
            f"position{k}_{name}": array
            for k, position in enumerate(self.positions)
            for name, array in position.state.items()
        }

    def record(self, block: int | None = None) -> StepRecord:
        """Return contact and values of one position (`block`, default 0) for the record."""
        position = self.positions[block or 0]
        return StepRecord(position.contact, dict(position.values), may_store=False)


class ProfileWear(Process[WornStep]):
    """Process that wears wheel and rail profiles over the positions of a duty cycle."""

    columns = (*WHEEL_COLUMNS, *WornProfiles.columns)
    first_applications = next_applications = 160.0  # all patches of a position
    load_tolerance = 1e-4
    """Relative error of the load that the patches of a wheel carry together."""

    def begin(self) -> WornStep:
        """Return the first step: the contacts of the unworn profiles."""
        wheel, rail = unworn_profiles(self.model.scene)
        depths = np.zeros(wheel.s.size), np.zeros(rail.s.size)
        positions = self._solve(0, depths, {})
        solves = sum(max(1, len(position.worn)) for position in positions)
        return WornStep(0, depths, positions, self.model.grid, solves=solves)

    def advance(self, last: WornStep) -> Iterator[WornStep]:
        """Yield the steps of worn profiles, to the last revolution or an unsolved contact."""
        schedule, wear = self.model.scene.schedule, required(self.model.scene.wear, "wear")
        control: Stops | FixedSteps = Stops(ErrorControl(order=2), schedule.stops)
        if schedule.fixed:
            control = FixedSteps(schedule.stops)
        while last.converged and last.revolution < schedule.end:
            begin = WearRate(last.positions, self._nodes(last))
            deepest, jump = wear.step_depth or np.inf, last.jump
            if not jump:  # a small share of the elastic depth
                jump = 0.02 * last.contact.approach / max(float(begin.rate.max()), 1e-300)
            jump = max(1.0, float(int(min(jump, deepest / max(float(begin.rate.max()), 1e-300)))))
            trial = control.first(last.revolution, jump if schedule.adaptive else 1.0, 0.0)
            solves = 0
            while True:
                step, error = self._jump(last, begin, int(trial.length))
                solves += step.solves
                if control.accepts(error) or trial.length == 1 or not step.converged:
                    break
                trial = control.shorter(trial, error)
            last = replace(step, solves=solves, jump=control.next(trial, error))
            yield last

    def _jump(self, last: WornStep, begin: WearRate, jump: int) -> tuple[WornStep, float]:
        """Return the step after some revolutions, and its error over the tolerated one.

        The step of a single revolution is that of its pass.
        """
        wear, nodes = required(self.model.scene.wear, "wear"), self._nodes(last)
        wheel, before = nodes[0].size, np.concatenate(last.depths)

        def solve(change: np.ndarray, share: float) -> tuple[Depths, tuple[PositionWear, ...]]:
            parts = zip(np.split(change, [wheel]), nodes, strict=True)
            change = np.concatenate([_without_gain(part, at) for part, at in parts])
            depths = before[:wheel] + change[:wheel], before[wheel:] + change[wheel:]
            starts = {k: position.start for k, position in enumerate(last.positions)}
            return depths, self._solve(last.revolution + int(share * jump), depths, starts)

        change, solved = begin.damp(jump, jump * begin.rate), [last.positions]
        if jump > 1:
            first = begin.damp(0.5 * jump, 0.5 * jump * begin.rate)
            solved.append(solve(first, 0.5)[1])
            if all(position.contact.converged for position in solved[-1]):
                middle = WearRate(solved[-1], nodes)
                change = 2.0 * (first + middle.damp(0.5 * jump, 0.5 * jump * middle.rate)) - change
        depths, positions = solve(change, 1.0)
        solved.append(positions)
        solves = sum(max(1, len(p.worn)) for positions in solved[1:] for p in positions)
        step = WornStep(last.revolution + jump, depths, positions, last.mesh, solves=solves)
        if not step.converged or len(solved) == 2:
            work = last.work + jump * begin.work
            return replace(step, work=work, error=last.error), 0.0
        end = WearRate(positions, nodes)
        mean = (begin.rate + 4.0 * middle.rate + end.rate) / 6.0
        change = np.concatenate(depths) - before
        missed = float(np.abs(begin.damp(jump, jump * mean - change)).max())
        work = last.work + jump * (begin.work + 4.0 * middle.work + end.work) / 6.0
        # Rates jump where a patch divides or leaves its mesh: there only short steps are accurate.
        allowed = max(float(change.max()), 0.2 * float(before.max()))
        error = missed / max(PROFILE_ERROR * wear.tolerance * allowed, 1e-300)
        return replace(step, work=work, error=last.error + missed), error

    def state(self, step: WornStep) -> dict[str, np.ndarray]:
        """Return the arrays, by name, to resume after a step; no fields, as meshes differ.

        Fields are left out: they belong to separate meshes.
        """
        return self._state_besides_fields(step)

    def record(self, step: WornStep, recorder: Recorder) -> Record:
        """Return the record of all positions together; no fields are stored, values over y are nan.

        With [[duty]] the positions are those of its blocks.
        """
        scene, spectrum = self.model.scene, self.model.scene.spectrum
        observers = self._observers_of(step)
        extra = [*recorder.columns, *self.columns, *(c for seen in observers for c in seen.columns)]
        records = [
            Record.from_contact(
                position.contact, position.values, user_columns=extra, with_fields=False
            )
            for position in step.positions
        ]
        # Depths are those at the nodes of the profiles; the meshes of the contacts differ.
        across = np.full(step.mesh.elements[1], np.nan)
        values = {name: across for name, column in columns(scene).items() if column.dims == ("y",)}
        values |= self._values(step)
        for seen in observers:
            values |= seen.record(self.model, {})
        if spectrum is None:
            return replace(records[0], values={**records[0].values, **values})
        each = [records[k] for k in spectrum.places]
        return cycle_record(each, spectrum.each, values | {"seconds": np.nan}, scene, extra)

    def _values(self, step: WornStep) -> dict[str, Any]:
        """Return the values of the columns that do not belong to a position, by name."""
        scene = self.model.scene
        profiles = unworn_profiles(scene, *(depth.size for depth in step.depths))
        sections = [np.trapezoid(d, p.s) for d, p in zip(step.depths, profiles, strict=True)]
        radius = required(scene.wheel, "wheel").radius + profiles[0].points[:, 1]
        volume = float(np.trapezoid(2.0 * np.pi * radius * step.depths[0], profiles[0].s))
        return {
            "revolution": step.revolution,
            "jump": max(1.0, step.jump),
            "solves": step.solves,
            "wear_max": float(max(depth.max() for depth in step.depths)),
            "wear_max_error": step.error,
            "profile_work": step.work,
            "worn_volume": {"A": volume, "B": np.nan},
            "worn_mass": {"A": 1e-3 * scene.body.A.density * volume, "B": np.nan},
            "wheel_wear": step.depths[0],
            "rail_wear": step.depths[1],
            "worn_section": dict(zip("AB", map(float, sections), strict=True)),
        }

    @classmethod
    def restore(cls, scene: Scene, stored: StoredStep) -> WornStep:
        """Return the step of a stored record, with its profiles and positions."""
        history, row = stored.history, stored.row
        depths = history["wheel_wear"][row], history["rail_wear"][row]
        stored.require(("wheel_wear", "rail_wear"))
        positions = []
        for k, (share, local) in enumerate(_positions(scene)):
            spectrum = scene.spectrum
            of_block = history.block(spectrum.places.index(k)) if spectrum else history
            none = np.zeros(of_block.grid.elements)
            fields = dict.fromkeys(
                ("pressure", "traction_x", "traction_y", "slip_x", "slip_y"), none
            )
            contact = replace(of_block.contact(row, fields | {"wear": none}), scene=local)
            state = stored.state_under(f"position{k}")
            positions.append(PositionWear.restore(share, contact, state))
        work, error = (
            float(history[name][row]) if name in history.columns else np.nan
            for name in ("profile_work", "wear_max_error")
        )
        place, jump = int(history["revolution"][row]), float(history["jump"][row])
        return WornStep(place, depths, tuple(positions), history.grid, work, error, jump)

    @classmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return an estimate of the number of records, from the order of the steps."""
        schedule = scene.schedule
        if not schedule.adaptive:
            return 1 + int(len(schedule.stops) if schedule.fixed else schedule.end)
        wear = required(scene.wear, "wear")
        return 2 + len(schedule.stops) + int(0.7 / np.sqrt(wear.tolerance))

    def _nodes(self, step: WornStep) -> Depths:
        """Return the arc lengths of the nodes of both unworn profiles, mm."""
        wheel, rail = unworn_profiles(self.model.scene, *(depth.size for depth in step.depths))
        return wheel.s, rail.s

    def _solve(
        self, revolution: int, depths: Depths, starts: Mapping[int, State]
    ) -> tuple[PositionWear, ...]:
        """Solve all positions with profiles worn by depths.

        Raises
        ------
        SceneError
            If the worn profiles have no contact.
        """
        scene = self.model.scene
        new = unworn_profiles(scene, *(depth.size for depth in depths))
        wheel = new[0].worn(depths[0], 1.0)
        rail = required(scene.rail, "rail").curve.with_nodes(new[1].s).worn(depths[1], -1.0)
        try:
            return tuple(
                self._position(share, local, (wheel, rail), (new[0].s, new[1].s), starts.get(k))
                for k, (share, local) in enumerate(_positions(scene))
            )
        except ValueError as error:
            raise SceneError([Fault("wear", f"revolution {revolution}", str(error))]) from error

    def _position(
        self,
        share: float,
        scene: Scene,
        profiles: tuple[Profile, Profile],
        nodes: Depths,
        start: State | None,
    ) -> PositionWear:
        """Solve the patches of one position, and return the wear in them."""
        model = Model(scene, wheel_rail=WheelRail.of_profiles(scene, *profiles))
        if start is not None and _still_fits(start.grid, model.grid):
            model = model.on(start.grid)
        model, contacts = solve_patches_on_fitted_mesh(model, start, self.load_tolerance)
        patches = required(model.wheel_rail, "wheel").patches
        pairs = [*zip(contacts, patches, strict=True)]
        touching = [(state, patch) for state, patch in pairs if state.touching.any()] or pairs[:1]
        contact, patch = max(touching, key=lambda pair: (not pair[0].converged, pair[0].P))
        if not contact.converged:
            return PositionWear(share, contact, contacts[0])
        worn = tuple(
            self._wear_of_patch(model.of_patch(patch), state, profiles[0], nodes)
            for state, patch in touching
        )
        values = describe_patch(patch, contact, len(touching))
        main = next(k for k, (state, _) in enumerate(touching) if state is contact)
        values["worn_area"] = worn[main].area
        values |= {"solves": 1, "jump": 1}
        return PositionWear(share, contact, contacts[0], worn, values)

    def _wear_of_patch(
        self, model: Model, contact: State, wheel: Profile, nodes: Depths
    ) -> PatchWear:
        """Return the wear rates and the response of one solved patch."""
        law, y = required(wear_law_at(model, contact), "wear"), contact.grid.y
        patch = required(model.patch, "wheel")
        fields = contact.pressure, contact.traction, contact.slip
        rates = law.rates(model.scene.wear_share, *fields).sum(axis=1)
        places = (
            np.interp(patch.wheel_profile(y)[1], wheel.s, nodes[0]),
            np.interp(patch.rail_at(np.zeros(1), y)[2], patch.rail.section(0.0).s, nodes[1]),
        )
        passes = np.array([1.0, required(model.scene.rail, "rail").passes_per_revolution])
        single, rates = rates.sum(axis=0), rates * passes[:, None]
        mean = rates.sum(axis=0) / np.where(single > 0.0, single, 1.0)  # passes of both, by wear
        response = mean[:, None] * wear_response(model, contact)
        dx, dy = contact.grid.dx, contact.grid.dy
        area = float(single.sum() * dx * dy)
        return PatchWear(rates * dx, response, np.stack(places), dy, contact.dissipation, area)


def _still_fits(before: Grid, chosen: Grid, least: float = 0.7, most: float = 1.08) -> bool:
    """Return whether the mesh of the last step is close enough to the chosen one to be used.

    Contacts can then start from the step before. Within these ratios of the half lengths, the
    margin around the contact is between half and three times the usual one.
    """
    pairs = zip(chosen.half_length, before.half_length, strict=True)
    alike = before.elements == chosen.elements
    return alike and all(least <= new / old <= most for new, old in pairs)


def _positions(scene: Scene) -> list[tuple[float, Scene]]:
    """Return (share of the revolutions, scene) of each different position of a duty cycle."""
    spectrum = scene.spectrum
    if spectrum is None:
        return [(1.0, scene)]
    shares = [number / spectrum.cycle for number in spectrum.revolutions]
    return [*zip(shares, spectrum.scenes, strict=True)]
