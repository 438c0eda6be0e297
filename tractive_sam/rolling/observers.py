"""Observers: stress, damage in the material that wear removes, and fatigue of a transient.

The stress of every point follows from the tractions of the steps, and only these are stored. It is
computed when it is recorded: with the stored fields, and at the end. The course counts as one
cycle: the damage belongs to a single course, and the life is a number of equal courses.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import attrgetter
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.compute import ConvolutionMeter
from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.mechanics import VolumeLife
from tractive_sam.results import (
    BODIES,
    BodyFatigue,
    InclusionPassage,
    Maximum,
    PlaneStress,
    Quantity,
    State,
    stress_columns,
    widen_field,
)
from tractive_sam.rolling.body_damage import (
    AT_TOP,
    WORN,
    BlockOrder,
    BodyDamage,
    after_jump,
    block_orders,
    cycle_columns,
    damage_remark,
    fatigue_columns,
    layer_column,
    life_error_bars,
    material_depths,
    shakedown_remark,
    surface_density_ratios,
    utilisation_columns,
    widen_body,
)
from tractive_sam.rolling.courses import expected_steps
from tractive_sam.rolling.passage import Passage
from tractive_sam.rolling.process import Observer, StoredStep
from tractive_sam.scene import FatigueVolume
from tractive_sam.schema import Fault, SceneError, required
from tractive_sam.subsurface import (
    Course,
    InclusionGroup,
    InclusionStress,
    LiftedPass,
    around_inclusions,
    check_depths,
    course_fatigue,
    cycle_depths,
    cycle_fatigue,
    displacement,
    elastic_energy,
    inclusion_groups,
    maxima_by_body,
    semi_axes,
    stress_on_planes,
)


@dataclass(frozen=True, eq=False)
class _ContactObserver(Observer):
    """Observer of the contacts of the last step alone, computed when it is recorded.

    Steps that are refused take no time.

    Attributes
    ----------
    contacts : tuple of State
        Contacts of the last step, one for each block.
    model : Model
        The scene in numbers.
    """

    contacts: tuple[State, ...] = ()
    model: Model | None = None

    def begin(self, step: Any, model: Model) -> Self:
        """Return the observer with the contacts of the first step; see `Observer.begin`."""
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> Self:
        """Return the observer with the contacts of a later step."""
        return type(self)(step.contacts, model)


@dataclass(frozen=True, eq=False)
class LargestStress(_ContactObserver):
    """Observer of the largest equivalent stress of each body, and of stress on planes."""

    name, key, unsolved = "stress", "subsurface", True

    def describe(self, model: Model) -> Iterator[Row]:
        """Yield the rows (label, text) that `explain` prints for the observer."""
        name = model.laws.criterion.long_name
        yield Row(f"largest {name}", "inside and at the surface, with every record")

    @property
    def columns(self) -> tuple[Quantity, ...]:
        """Columns of the largest stress, inside and at the surface; none before the first step.

        They are the columns of the fatigue criterion of the laws.
        """
        return () if self.model is None else stress_columns(self.model.blocks[0].laws.criterion)

    @cached_property
    def maxima(self) -> tuple[dict[str, Maximum], ...]:
        """Largest stresses below the contact of each block, by body; empty at the beginning."""
        if self.model is None:
            return ()
        blocks = zip(self.contacts, self.model.blocks, strict=True)
        return tuple(maxima_by_body(contact, block.laws) for contact, block in blocks)

    def record_block(self, block: int) -> dict[str, dict[str, Any]]:
        """Return the largest stresses of a block, by column and then by body."""
        maxima, columns = self.maxima[block].items(), self.columns
        stress: dict[str, dict[str, Any]] = {
            getattr(columns, name).name: {body: getattr(maximum, name) for body, maximum in maxima}
            for name in (("value", "interior", "surface", "at") if columns else ())
        }
        for name in ("shear", "tension"):
            tops = {b: max(m.interfaces, key=attrgetter(name)) for b, m in maxima if m.interfaces}
            if tops:
                for field_name in (name, f"{name}_at"):
                    values = {body: getattr(top, field_name) for body, top in tops.items()}
                    stress[f"interface_{field_name}"] = values
        return stress

    def record_stress(self, block: int) -> tuple[PlaneStress, ...]:
        """Return the stress on planes below the contact of a block; none before the first step.

        The planes are listed in the scene.
        """
        if self.model is None:
            return ()
        laws = self.model.blocks[block].laws
        return tuple(stress_on_planes(self.contacts[block], laws=laws))


@dataclass(frozen=True, eq=False)
class AroundInclusions(_ContactObserver):
    """Observer of the stress around inclusions, as they pass below the contact ([[inclusion]])."""

    name, key, unsolved = "inclusions", "inclusion", True

    def bytes_needed(self, model: Model) -> float:
        """Return the memory, bytes, of the largest box of cells, and of contacts by position.

        Measured: spectra of 144 kernels take a third of a box, fields while they are computed the
        rest.
        """
        inclusions = model.scene.inclusion
        lifted = any(one.lifts for one in inclusions)
        box = (1.7e3 + 0.3e3 * lifted) * max(InclusionGroup.transformed_cells(inclusions))
        return box + lifted * LiftedPass.fields * 8.0 * math.prod(model.grid.elements)

    def applications(self, model: Model) -> float:
        """Return the elastic responses for contacts that inclusions lift, by record.

        Measured on meshes of 21 to 121; boxes of cells are counted apart.
        """
        lifted = sum(
            any(model.scene.inclusion[k].lifts for k in group)
            for group in inclusion_groups(model.scene.inclusion)
        )
        return 7e3 * lifted * len(model.blocks)

    def describe(self, model: Model) -> Iterator[Row]:
        """Yield the rows (label, text) that `explain` prints for the observer."""
        text = "the equivalent inclusion method, with every record; the bodies stay elastic"
        yield Row("stress around inclusions", f"{text}{self._unresolved(model)}")

    @staticmethod
    def _unresolved(model: Model) -> str:
        """Return a remark on inclusions that lift the surface over less than an element, or ""."""
        inclusions, side = enumerate(model.scene.inclusion), max(model.grid.dx, model.grid.dy)
        shallow = [k for k, one in inclusions if one.lifts and one.at[2] < side]
        if not shallow:
            return ""
        listed = ", ".join(str(k + 1) for k in shallow)
        return (
            f"; the lift of inclusion {listed} is not resolved: its depth is less than an element, "
            f"{side:.2g} mm; refine grid.elements"
        )

    @cached_property
    def solved(self) -> tuple[tuple[tuple[InclusionStress, ...], float], ...]:
        """Stress around the inclusions below the contact of each block, and its convolutions."""
        results = []
        for contact, block in zip(self.contacts, required(self.model, "model").blocks, strict=True):
            meter = ConvolutionMeter(block.operators.lattice.padded)
            around = around_inclusions(contact, block.laws, block)
            results.append((around, meter.convolutions))
        return tuple(results)

    def record_block(self, block: int) -> dict[str, Any]:
        """Return the columns of a block, by name and body."""
        kinds = ["von_mises", "tension", "lift"]
        if required(self.model, "model").scene.has("fatigue.limit"):
            kinds.append("utilisation")
        around, convolutions = self.solved[block]
        values: dict[str, Any] = {"inclusion_convolutions": convolutions}
        for body in BODIES:
            here = [one for one in around if one.body == body]
            above = [one.above for one in here if one.above is not None]
            of_lift = {
                "p_max": [passing.peaks.max() for passing in above],
                "p_min": [-passing.peaks.min() for passing in above],
                "iterations": [passing.iterations for passing in above],
                "residual": [passing.residual for passing in above],
            }
            for name, each in of_lift.items() if above else ():
                values.setdefault(f"inclusion_{name}", {})[body] = abs(max(each))
            for name in kinds if here else ():
                top = max(here, key=lambda one: np.nan_to_num(getattr(one, name), nan=-math.inf))
                values.setdefault(f"inclusion_{name}", {})[body] = getattr(top, name)
                if name in ("von_mises", "utilisation"):
                    at = top.at if name == "von_mises" else top.utilisation_at
                    values.setdefault(f"inclusion_{name}_at", {})[body] = at
        return values

    def record_stress(self, block: int) -> tuple[PlaneStress | InclusionPassage, ...]:
        """Return the stress around each inclusion when it is largest, and during the passage."""
        return tuple(table for one in self.solved[block][0] for table in (one.plane, one.passage))

    def remark(self, model: Model) -> str:
        """Return a remark on inclusions that wear has uncovered, or whose lift has not settled."""
        remark, around = self._unresolved(model), self.solved[0][0]
        if open_ones := [one.inclusion + 1 for one in around if math.isnan(one.von_mises)]:
            listed = ", ".join(map(str, open_ones))
            remark += f"; wear has uncovered inclusion {listed}, or one beside it"
        moving = {
            one.inclusion + 1: one.above.residual
            for one in around
            if one.above and one.above.residual > LiftedPass.tolerance
        }
        if moving:
            remark += (
                f"; the lift of inclusion {', '.join(map(str, moving))} and the pressure above it "
                f"do not agree (residual {max(moving.values()):.0e}): it is too large or too close "
                "to the surface; inclusion.lifts = false leaves the contact as it is"
            )
        return remark


@dataclass(frozen=True, eq=False)
class ElasticFields(Observer):
    """Observer of the bodies' elastic energy and of their displacement at a depth.

    Parameters
    ----------
    depth : float
        Depth of the stored displacement below the surface of each body, mm.

    Raises
    ------
    ValueError
        If the depth is negative or not finite.

    Examples
    --------
    >>> from tractive_sam.rolling import ElasticFields
    >>> history = ts.roll(scene, observers=[ElasticFields()])
    >>> history.field("displacement_z_A").shape, bool(history["stored_energy"][0] > 0.0)
    ((91, 91), True)
    """

    depth: float = 0.0
    contacts: tuple[State, ...] = ()
    weights: tuple[float, ...] = ()

    name = "elastic_fields"
    columns = (
        Quantity("stored_energy", "N mm", "elastic energy of both bodies, a mean of blocks"),
    )
    fields = tuple(
        Quantity(f"displacement_{axis}_{body}", "mm", f"displacement of body {body} in {axis}")
        for body in BODIES
        for axis in "xyz"
    )

    def __post_init__(self) -> None:
        check_depths([self.depth])

    def begin(self, step: Any, model: Model) -> Self:
        """Return the observer with the contacts of the first step.

        Raises
        ------
        SceneError
            For a line contact: its displacement relative to distant points is infinite.
        """
        if model.scene.line:
            cure = "a finite radius_y of a body: the displacement of a line contact is infinite"
            raise SceneError([Fault("observer", f"{self.name} in a line contact", cure)])
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> Self:
        """Return the observer with the contacts of a later step instead of the earlier ones."""
        return replace(self, contacts=step.contacts, weights=step.weights)

    def record(self, model: Model, recorded: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the column `stored_energy`, the weighted sum over blocks, by name."""
        each = zip(self.weights, self.contacts, strict=True)
        return {"stored_energy": sum(w * elastic_energy(contact) for w, contact in each if w)}

    def record_fields(self, block: int) -> Mapping[str, np.ndarray]:
        """Return the displacements of both bodies at `depth`, by name, (n_x, n_y)."""
        return {
            f"displacement_{axis}_{body}": values
            for body in BODIES
            for axis, values in zip(
                "xyz", displacement(self.contacts[block], body, self.depth), strict=True
            )
        }


@dataclass(frozen=True, eq=False)
class Damage(Observer):
    """Observer of the fatigue damage of the bodies over the revolutions ([fatigue]).

    Attributes
    ----------
    revolution, earlier : int
        Revolutions of the last record and of the one before.
    bodies : mapping of str to BodyDamage
        Damage of each body.
    """

    name, key = "damage", "fatigue"

    share_of_jump: ClassVar[float] = 0.3
    """Allowed estimated error of the largest damage by a jump, over fatigue.tolerance."""

    revolution: int = 0
    earlier: int = 0
    bodies: Mapping[str, BodyDamage] = field(default_factory=dict)

    def describe(self, model: Model) -> Iterator[Row]:
        """Yield the rows (label, text) that `explain` prints for the observer."""
        laws, table = model.laws, required(model.scene.fatigue, "fatigue")
        yield Row("records", "all; fields over (y, depth) with the stored fields")
        if table.limit is None:
            return
        yield Row("criterion", required(laws.fatigue, "fatigue.criterion").long_name)
        if table.volume is not None and laws.volume is not None:
            yield Row("volume", _describe_volume(table.volume, laws.volume))
        if len(model.blocks) > 1:
            rule = "by Miner's rule, in any order (damage_error estimates its effect)"
            yield Row("duty cycle", f"the damage of its blocks {rule}")
        if model.scene.schedule.adaptive:
            missed = (
                f"each misses up to {self.share_of_jump * table.tolerance:g} of the largest damage"
            )
            yield Row("jumps", f"{missed}, by its estimate; all together damage_error")

    def begin(self, passage: Passage, model: Model) -> Self:
        """Return the observer of undamaged bodies, with the utilisation of their first pass."""
        longest = max(passage.contacts, key=lambda contact: semi_axes(contact)[0])
        turns, bodies = passage.turns[0], {}
        for body, (cycle, used) in _cycle_fatigue(passage, model, cycle_depths(longest)).items():
            worn, rate = passage.worn_depths(body)
            zeta = material_depths(cycle.depth, WORN * semi_axes(longest)[0])
            none = np.zeros((cycle.y.size, zeta.size))
            fatigue = cycle.with_damage(zeta, none, worn)
            bodies[body] = BodyDamage(fatigue, used, used, rate, turns.per_count[body], none)
        revolution = passage.revolution
        return replace(self, revolution=revolution, earlier=revolution, bodies=bodies)

    def after(self, passage: Passage, model: Model) -> Self:
        """Return the observer with the damage of all passes up to a later step added."""
        before = {body: widen_body(damage, passage.grid.y) for body, damage in self.bodies.items()}
        depths = next(iter(before.values())).fatigue.depth  # common to both bodies
        jump = passage.revolution - self.revolution, self.revolution - self.earlier
        bodies, life, orders = {}, model.laws.life, _block_orders(passage, model)
        for body, (cycle, used) in _cycle_fatigue(passage, model, depths).items():
            worn, rate = passage.worn_depths(body)
            rolled = cycle, used, worn, rate, passage.weights
            order = orders.get(body)
            bodies[body] = after_jump(before[body], *rolled, jump, life, self.revolution, order)
        return replace(self, revolution=passage.revolution, earlier=self.revolution, bodies=bodies)

    def missed(self, model: Model) -> float:
        """Return the error of the largest damage in the last jump over the tolerated one."""
        largest = max(damage.missed for damage in self.bodies.values())
        tolerance = required(model.scene.fatigue, "fatigue").tolerance
        return largest / (self.share_of_jump * tolerance)

    def remark(self, model: Model) -> str:
        """Return a remark on shakedown, and on volumes stressed most at the surface; may be empty.

        It warns of stress above shakedown, and of lives that depend on the mesh.
        """
        law = model.laws.volume
        tops = {} if law is None else surface_density_ratios(self.bodies, model, law)
        shallow = [body for body, top in tops.items() if top > AT_TOP]
        cycles = {body: damage.fatigue for body, damage in self.bodies.items()}
        remark = shakedown_remark(cycles) + damage_remark(cycles)
        if shallow:
            remark += (
                f"; in body {' and '.join(shallow)} the density of the stressed volume is largest "
                "one element deep: smaller elements give a larger volume, and a shorter life"
            )
        return remark

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """Fatigue of the bodies in the last step, stored with the fields."""
        return tuple(damage.fatigue for damage in self.bodies.values())

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Damage, utilisation, shakedown stresses and depths, by name with body, for `restore`."""
        each = (damage.state.items() for damage in self.bodies.values())
        return {name: array for arrays in each for name, array in arrays}

    def record(self, model: Model, recorded: Mapping[str, Any]) -> dict[str, Any]:
        """Return all fatigue columns by name, with error bars from the recorded ones of the mesh.

        Error bars of jumps and of the mesh are added.
        """
        columns = fatigue_columns(self.bodies, model)
        of_mesh = ("damage", "utilisation", "stressed_volume")  # error bars of other columns follow
        bars = {name: recorded.get(f"{name}_error") for name in of_mesh}
        if "damage_error" in columns:
            mesh = bars["damage"] or {}
            columns["damage_error"] = {
                body: value + mesh.get(body, 0.0) for body, value in columns["damage_error"].items()
            }
        if "fatigue_life" in columns and bars["utilisation"] is not None:
            life = required(model.laws.life, "fatigue.limit")
            columns["fatigue_life_error"] = life_error_bars(
                columns, bars["utilisation"], life, model.scene.steel
            )
        if "stressed_volume" in columns and bars["stressed_volume"] is not None:
            law = required(model.laws.volume, "fatigue.volume")
            volume = _volume_error_bars(columns, bars["stressed_volume"], law)
            columns |= {f"{name}_error": values for name, values in volume.items()}
        return columns

    def record_block(self, block: int) -> dict[str, Any]:
        """Return the columns of the largest utilisation in a block, by name and body."""
        each = self.bodies.items()
        cycles = {k: replace(d.fatigue, utilisation=d.blocks[block]) for k, d in each}
        return utilisation_columns(cycles)

    def restore(self, passage: Passage, stored: StoredStep) -> Self:
        """Return the observer with the stored damage of each body, to resume from."""
        history, row, state = stored.history, stored.row, stored.state_of(self)
        unknown = np.full((len(history), len(BODIES)), np.nan)  # without a limit
        by_body = history.values.get("initiation", unknown)[row]
        initiation = dict(zip(BODIES, by_body, strict=True))
        earlier = int(history["revolution"][max(row - 1, 0)])
        contact, per_count = passage.contact, passage.turns[0].per_count
        bodies = dict[str, BodyDamage]()
        for body in required(contact.scene.fatigue, "fatigue").bodies:
            depths, about = passage.worn_depths(body), (per_count[body], float(initiation[body]))
            bodies[body] = BodyDamage.from_state(state, contact, body, depths, *about)
        return replace(self, revolution=passage.revolution, earlier=earlier, bodies=bodies)


def _volume_error_bars(
    columns: Mapping[str, Any], bars: Mapping[str, float], law: VolumeLife
) -> dict[str, dict[str, float]]:
    """Return the error bars of `stressed_volume` and `volume_life` due to the mesh, by body.

    If the integral depends on the mesh, its error bar is infinite.
    """
    errors: dict[str, dict[str, float]] = {"stressed_volume": {}, "volume_life": {}}
    for body, volume in columns["stressed_volume"].items():
        bar = math.inf if columns["volume_at_top"][body] > AT_TOP else bars.get(body, math.nan)
        errors["stressed_volume"][body] = bar
        if volume > 0.0:
            smallest = 1.0 - bar / volume
            longer = math.inf if smallest <= 0.0 else smallest ** (-1.0 / law.slope) - 1.0
            errors["volume_life"][body] = columns["volume_life"][body] * longer
    return errors


def _describe_volume(table: FatigueVolume, law: VolumeLife) -> str:
    """Describe the law for the fatigue life of a stressed volume."""
    text = f"stress^{law.stress_exponent:.4g} / depth^{law.depth_exponent:.4g}"
    text += f" above {law.limit:g} MPa" if law.limit else ""
    text += f", Weibull slope {law.slope:.4g}; starts one element deep"
    if table.constant is None:
        return f"{text}; no life: there is no constant"
    return f"{text}; life with a survival of {table.survival:g}"


def _cycle_fatigue(
    passage: Passage, model: Model, depths: np.ndarray
) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    """Return the fatigue of each body in one load cycle, and its utilisation in each block."""
    laws = [block.laws for block in model.blocks]
    worn = {body: passage.worn_depths(body)[0] for body in "AB"}
    return cycle_fatigue(passage.contacts, depths, laws, worn)


def _block_orders(passage: Passage, model: Model) -> dict[str, BlockOrder]:
    """Return the `BlockOrder` of each body, if a duty cycle is rolled as the mean of its blocks."""
    spectrum = model.scene.spectrum
    if spectrum is None or passage.rolled is not None:
        return {}
    rates = passage.gained_by_block / np.reshape(passage.weights, (-1, 1, 1))
    orders = block_orders(spectrum, rates, passage.responses, passage.revolution)
    return dict(zip("AB", orders, strict=True))


Fields = tuple[np.ndarray, ...]
"""Pressure, traction in x and y, and sliding elements, each of shape (n_x, n_y)."""


@dataclass(frozen=True, eq=False)
class StressHistory(Observer):
    """Observer of fatigue by the full stress history of each material point in a transient.

    Attributes
    ----------
    places : tuple of float
        Distances of the steps so far, starting at transient.cycle_start.
    loads : tuple of tuple of ndarray
        Pressure, tractions and sliding elements in each of these steps, shape (n_x, n_y).
    contact : State, optional
        The last contact; None before the first step.
    model : Model, optional
        The scene in numbers.
    """

    name, key, kept = "stress_history", "fatigue", ("places", "loads")

    places: tuple[float, ...] = ()
    loads: tuple[Fields, ...] = ()
    contact: State | None = None
    model: Model | None = None

    def describe(self, model: Model) -> Iterator[Row]:
        """Yield the rows (label, text) that `explain` prints for the observer."""
        scene, criterion = model.scene, model.laws.fatigue
        if criterion is not None:
            yield Row("criterion", criterion.long_name)
        fixed = "fixed in the contact" if scene.schedule.shifts else "rolled over"
        yield Row("stress history", f"of material {fixed}, from {_cycle_start(model):g} on")
        yield Row("cycle", "the history counts as one: the life is in repetitions of it")
        yield Row("records", "those with stored fields, and the last one; fields over (y, depth)")
        room = f"about {self.bytes_needed(model) / 2**20:.0f} MiB for the tractions of all steps"
        yield Row("memory of the history", room)

    def bytes_needed(self, model: Model) -> float:
        """Return the memory, bytes, of the tractions of all steps and of layers of stress.

        It counts stored copies of the tractions as well.
        """
        scene, elements = model.scene, math.prod(model.grid.elements)
        steps = expected_steps(scene, model.grid.dx)
        bodies = required(scene.fatigue, "fatigue").bodies
        layers = 2 * 6 * 2 * len(bodies)  # twice as long as the mesh
        return 8.0 * steps * elements * (2 * 4 + layers)

    def begin(self, step: Any, model: Model) -> "StressHistory":
        """Return the observer after the first step, as after any other."""
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> "StressHistory":
        """Return the observer with the loads of a step added; before the load cycle, only these.

        Before the cycle begins only the last step is stored.
        """
        contact, place = step.contact, step.place
        load = (contact.pressure, *contact.traction, 1.0 * contact.sliding)
        places, loads = (*self.places, place), (*self.loads, load)
        if place <= _cycle_start(model):
            places, loads = places[-1:], loads[-1:]
        return StressHistory(places, loads, contact, model)

    @property
    def state(self) -> Mapping[str, np.ndarray]:
        """Distances and loads of all steps in the cycle, by name, for `restore`."""
        grid = self._contact.grid
        loads = [[widen_field(field, grid.elements) for field in load] for load in self.loads]
        return {"places": np.array(self.places), "loads": np.array(loads)}

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """Fatigue of the bodies by the load cycle so far, stored with the fields."""
        return tuple(cycle for cycle, _ in self._fatigue.values())

    def record(self, model: Model, recorded: Mapping[str, Any]) -> dict[str, Any]:
        """Return the fatigue columns at a saved or the last distance; no columns elsewhere.

        Only records with stored fields, and the last one, have values.
        """
        schedule = model.scene.schedule
        if self.places[-1] not in (*schedule.save, schedule.end):
            return {}
        columns = cycle_columns({cycle.body: cycle for cycle in self.cycles})
        life = model.laws.life
        columns["utilisation_at"] = {
            body: _with_x(columns["utilisation_at"][body], cycle, x)
            for body, (cycle, x) in self._fatigue.items()
        }
        if life is None:
            return columns
        for body, (cycle, x) in self._fatigue.items():
            damage, at = cycle.damage_max
            error = 0.0 if cycle.criterion is None else cycle.criterion.path_error
            each = {
                "damage": damage,
                "damage_at": _with_x(at, cycle, x),
                "damage_error": damage * life.relative_error(error),
                "fatigue_life": 1.0 / damage if damage > 0.0 else math.inf,
            } | layer_column(cycle.steel, at[2])
            for name, value in each.items():
                columns.setdefault(name, {})[body] = value
        return columns

    def remark(self, model: Model) -> str:
        """Return a remark on shakedown for the message of a history; empty if there is none.

        It warns of stress above shakedown.
        """
        cycles = {cycle.body: cycle for cycle in self.cycles}
        return shakedown_remark(cycles) + damage_remark(cycles)

    @property
    def _contact(self) -> State:
        """Last contact; a LookupError is raised before the first step."""
        if self.contact is None:
            raise LookupError("contact")
        return self.contact

    @cached_property
    def _fatigue(self) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
        """Fatigue of each body so far, and x of the material that is loaded most."""
        model = self.model
        if model is None:  # restored: its next step adds the model
            return {}
        contact = self._contact
        table, schedule = required(model.scene.transient, "transient"), model.scene.schedule
        contacts = []
        for load in self.loads:
            pressure, x, y, sliding = (widen_field(field, contact.grid.elements) for field in load)
            loaded = replace(contact, pressure=pressure, traction=np.stack((x, y)))
            contacts.append(replace(loaded, sliding=sliding > 0.0))
        places = schedule.rolled(np.array(self.places))
        steady = table.start == "steady" and self.places[0] == table.knots[0]
        course = Course(contacts, places, model.laws, schedule.rolls, steady)
        cycles, life = course_fatigue(course, cycle_depths(contact)), model.laws.life
        if life is None:
            return cycles
        for body, (cycle, x) in cycles.items():
            damage = cycle.steel.damage(cycle.utilisation, cycle.local_layer, life)
            cycles[body] = cycle.with_damage(cycle.depth, damage, np.zeros(cycle.y.size)), x
        return cycles


def _cycle_start(model: Model) -> float:
    """Return the distance at which the load cycle begins; by default at the first knot."""
    table = required(model.scene.transient, "transient")
    return table.knots[0] if table.cycle_start is None else table.cycle_start


def _with_x(at: tuple[float, ...], cycle: BodyFatigue, x: np.ndarray) -> tuple[float, ...]:
    """Return a position (nan, y, depth) with x of the most loaded material for nan, mm."""
    if not np.isfinite(at[1:]).all():
        return at
    row, depth = int(np.argmin(abs(cycle.y - at[1]))), int(np.argmin(abs(cycle.depth - at[2])))
    return (float(x[row, depth]), *at[1:])
