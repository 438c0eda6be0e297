"""Wear of the profiles of wheel and rail over the positions of a duty, see `profile_step`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.contact import Model, solve_patches_on_fitted_mesh, wear_law_at
from tractive_sam.rail import Profile
from tractive_sam.results import Grid, Record, State, WornProfiles, columns, cycle_record
from tractive_sam.rolling.process import Process, Recorder, Step, StepRecord, StoredStep
from tractive_sam.rolling.profile_step import Depths, PatchWear, PositionWear, implicit_step
from tractive_sam.rolling.response import wear_response
from tractive_sam.rolling.wheel_rail import WHEEL_COLUMNS, describe_patch
from tractive_sam.scene import Scene, WheelRail
from tractive_sam.schema import Fault, SceneError, required


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
    change : tuple of ndarray
        Change of the depths in the next step, mm.
    jump : int
        Revolutions of the next step; 0 at the end.
    """

    contacts: tuple[State, ...] = field(init=False)
    revolution: int
    depths: Depths
    positions: tuple[PositionWear, ...]
    mesh: Grid
    change: Depths
    jump: int

    @classmethod
    def from_positions(
        cls,
        scene: Scene,
        revolution: int,
        depths: Depths,
        positions: tuple[PositionWear, ...],
        mesh: Grid,
    ) -> "WornStep":
        """Return the step of solved positions, with the wear depths that the next step adds."""
        schedule = scene.schedule
        lengths = [stop - revolution for stop in schedule.stops if stop > revolution]
        if not lengths or not all(position.contact.converged for position in positions):
            return cls(revolution, depths, positions, mesh, depths, 0)
        longest = lengths[0] if schedule.adaptive or schedule.fixed else 1
        deepest = required(scene.wear, "wear").largest_step if schedule.adaptive else np.inf
        worn = [(position.share, patch) for position in positions for patch in position.worn]
        change, jump = implicit_step(worn, _nodes(scene), int(longest), deepest)
        return cls(revolution, depths, positions, mesh, change, jump)

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
        wheel, rail = self._nodes
        return self._step(0, (np.zeros(wheel.size), np.zeros(rail.size)), {})

    def advance(self, last: WornStep) -> Iterator[WornStep]:
        """Yield the steps of worn profiles, to the last revolution or an unsolved contact."""
        while last.jump:
            depths = last.depths[0] + last.change[0], last.depths[1] + last.change[1]
            starts = {k: position.start for k, position in enumerate(last.positions)}
            last = self._step(last.revolution + last.jump, depths, starts)
            yield last

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
        sections = [np.trapezoid(d, s) for d, s in zip(step.depths, self._nodes, strict=True)]
        wheel = required(scene.wheel, "wheel")
        around = 2.0 * np.pi * (wheel.radius + wheel.curve.points[:, 1])
        volume = float(np.trapezoid(around * step.depths[0], self._nodes[0]))
        return {
            "revolution": step.revolution,
            "jump": max(1, step.jump),
            "solves": sum(max(1, len(position.worn)) for position in step.positions),
            "wear_max": float(max(depth.max() for depth in step.depths)),
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
        revolution = int(history["revolution"][row])
        return WornStep.from_positions(scene, revolution, depths, tuple(positions), history.grid)

    @classmethod
    def expected_records(cls, scene: Scene, dx: float) -> int:
        """Return an estimate of the number of records, from the expected wear depth.

        The number is an estimate for a contact that slides entirely and does not move.
        """
        schedule = scene.schedule
        if not schedule.adaptive:
            return 1 + int(len(schedule.stops) if schedule.fixed else schedule.end)
        wear = required(scene.wear, "wear")
        per_work = scene.friction and wear.per_work(scene.friction.mu)
        if not per_work:
            return 50
        depth = 0.0
        for share, local in _positions(scene):
            patch, motion = required(local.wheel_rail, "wheel").patches[0], local.creepage
            load = required(local.load.normal, "load.normal")
            mu = required(local.friction, "friction").mu[0]
            width = 2.0 * patch.half_length[1]
            slip = abs(motion.spin) * width / 4.0 + np.hypot(motion.longitudinal, motion.lateral)
            depth += share * max(per_work) * mu * load * slip / width
        return 1 + int(np.ceil(0.5 * depth * schedule.end / wear.largest_step))

    @property
    def _nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Arc lengths of the nodes of both unworn profiles, mm."""
        return _nodes(self.model.scene)

    def _step(self, revolution: int, depths: Depths, starts: Mapping[int, State]) -> WornStep:
        """Solve all positions with worn profiles, and return the step.

        Raises
        ------
        SceneError
            If the worn profiles have no contact.
        """
        scene = self.model.scene
        wheel = required(scene.wheel, "wheel").curve.worn(depths[0], 1.0)
        rail = required(scene.rail, "rail").curve.worn(depths[1], -1.0)
        try:
            positions = tuple(
                self._position(share, local, (wheel, rail), starts.get(k))
                for k, (share, local) in enumerate(_positions(scene))
            )
        except ValueError as error:
            raise SceneError([Fault("wear", f"revolution {revolution}", str(error))]) from error
        return WornStep.from_positions(scene, revolution, depths, positions, self.model.grid)

    def _position(
        self, share: float, scene: Scene, profiles: tuple[Profile, Profile], start: State | None
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
            self._wear_of_patch(model.of_patch(patch), state, profiles[0])
            for state, patch in touching
        )
        values = describe_patch(patch, contact, len(touching))
        main = next(k for k, (state, _) in enumerate(touching) if state is contact)
        values["worn_area"] = worn[main].area
        values |= {"solves": 1, "jump": 1}
        return PositionWear(share, contact, contacts[0], worn, values)

    @property
    def _passes(self) -> np.ndarray:
        """Passes of wheel and rail through the contact per wheel revolution, shape (2, 1)."""
        return np.array([[1.0], [required(self.model.scene.rail, "rail").passes_per_revolution]])

    def _wear_of_patch(self, model: Model, contact: State, wheel: Profile) -> PatchWear:
        """Return the wear rates and the response of one solved patch."""
        law, y = required(wear_law_at(model, contact), "wear"), contact.grid.y
        patch = required(model.patch, "wheel")
        fields = contact.pressure, contact.traction, contact.slip
        rates = law.rates(model.scene.wear_share, *fields).sum(axis=1)
        new_wheel, new_rail = self._nodes
        places = (
            np.interp(patch.wheel_profile(y)[1], wheel.s, new_wheel),
            np.interp(patch.rail_at(np.zeros(1), y)[2], patch.rail.section(0.0).s, new_rail),
        )
        single, rates = rates.sum(axis=0), rates * self._passes
        passes = rates.sum(axis=0) / np.where(single > 0.0, single, 1.0)  # mean of both, by wear
        response = passes[:, None] * wear_response(model, contact)
        dx, dy = contact.grid.dx, contact.grid.dy
        return PatchWear(rates * dx, response, np.stack(places), float(single.sum() * dx * dy))


def _still_fits(before: Grid, chosen: Grid, least: float = 0.7, most: float = 1.08) -> bool:
    """Return whether the mesh of the last step is close enough to the chosen one to be used.

    Contacts can then start from the step before. Within these ratios of the half lengths, the
    margin around the contact is between half and three times the usual one.
    """
    pairs = zip(chosen.half_length, before.half_length, strict=True)
    alike = before.elements == chosen.elements
    return alike and all(least <= new / old <= most for new, old in pairs)


def _nodes(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the arc lengths of the nodes of the unworn profiles of wheel and rail, mm."""
    wheel, rail = required(scene.wheel, "wheel"), required(scene.rail, "rail")
    return wheel.curve.s, rail.unplaced_curve.s


def _positions(scene: Scene) -> list[tuple[float, Scene]]:
    """Return (share of the revolutions, scene) of each different position of a duty cycle."""
    spectrum = scene.spectrum
    if spectrum is None:
        return [(1.0, scene)]
    shares = [number / spectrum.cycle for number in spectrum.revolutions]
    return [*zip(shares, spectrum.scenes, strict=True)]
