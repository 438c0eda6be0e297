"""Observer of the damage of both bodies, in the material that wear removes (`body_damage`)."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.mechanics import VolumeLife
from tractive_sam.results import BODIES, BodyFatigue
from tractive_sam.rolling.body_damage import (
    AT_TOP,
    WORN,
    BlockOrder,
    BodyDamage,
    after_jump,
    block_orders,
    fatigue_columns,
    life_error_bars,
    material_depths,
    shakedown_remark,
    surface_density_ratios,
    utilisation_columns,
    volume_error_bars,
    widen_body,
    widen_rows,
)
from tractive_sam.rolling.passage import Passage
from tractive_sam.rolling.process import Observer, StoredStep
from tractive_sam.scene import FatigueVolume
from tractive_sam.schema import required
from tractive_sam.subsurface import cycle_depths, cycle_fatigue, semi_axes


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
        remark = shakedown_remark({body: damage.fatigue for body, damage in self.bodies.items()})
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
        return {
            f"{name}_{body}": values
            for body, damage in self.bodies.items()
            for name, values in (
                ("depth", damage.fatigue.depth),
                ("zeta", damage.fatigue.zeta),
                ("damage", damage.fatigue.damage),
                ("utilisation", damage.utilisation),
                ("utilisation_before", damage.utilisation_before),
                ("damage_error", damage.error),
                ("residual_shear", damage.fatigue.residual_shear),
                ("path_radius", damage.fatigue.path_radius),
            )
        }

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
            columns["fatigue_life_error"] = life_error_bars(columns, bars["utilisation"], life)
        if "stressed_volume" in columns and bars["stressed_volume"] is not None:
            law = required(model.laws.volume, "fatigue.volume")
            volume = volume_error_bars(columns, bars["stressed_volume"], law)
            columns |= {f"{name}_error": values for name, values in volume.items()}
        return columns

    def record_block(self, block: int) -> dict[str, Any]:
        """Return the columns of the largest utilisation in a block, by name and body."""
        each = self.bodies.items()
        cycles = {k: replace(d.fatigue, utilisation=d.utilisation[block]) for k, d in each}
        return utilisation_columns(cycles)

    def restore(self, passage: Passage, stored: StoredStep) -> Self:
        """Return the observer with the stored damage of each body, to resume from."""
        history, row, state = stored.history, stored.row, stored.state_of(self)
        unknown = np.full((len(history), len(BODIES)), np.nan)  # without a limit
        by_body = history.values.get("initiation", unknown)[row]
        initiation = dict(zip(BODIES, by_body, strict=True))
        earlier = int(history["revolution"][max(row - 1, 0)])
        scene, grid = passage.contact.scene, passage.grid
        table = required(scene.fatigue, "fatigue")
        bodies, k = dict[str, BodyDamage](), table.shear_yield_stress
        shear_yield = math.nan if k is None else k
        for body in table.bodies:
            depth, zeta = (state[f"{name}_{body}"] for name in ("depth", "zeta"))
            damage, error, used, before = (
                widen_rows(state[f"{name}_{body}"], grid.elements[1])
                for name in ("damage", "damage_error", "utilisation", "utilisation_before")
            )
            worn, rate = passage.worn_depths(body)
            missing = np.full(used.shape[1:], np.nan)  # in files of earlier versions
            shear, radius = (
                widen_rows(state.get(f"{name}_{body}", missing), grid.elements[1])
                for name in ("residual_shear", "path_radius")
            )
            fatigue = BodyFatigue(
                body, grid.y, depth, used.max(axis=0), shear, radius, None, shear_yield
            ).with_damage(zeta, damage, worn)
            passes, began = passage.turns[0].per_count[body], float(initiation[body])
            bodies[body] = BodyDamage(fatigue, used, before, rate, passes, error, began)
        return replace(self, revolution=passage.revolution, earlier=earlier, bodies=bodies)


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
    return cycle_fatigue(passage.contacts, depths, laws)


def _block_orders(passage: Passage, model: Model) -> dict[str, BlockOrder]:
    """Return the `BlockOrder` of each body, if a duty cycle is rolled as the mean of its blocks."""
    spectrum = model.scene.spectrum
    if spectrum is None or passage.rolled is not None:
        return {}
    rates = passage.gained_by_block / np.reshape(passage.weights, (-1, 1, 1))
    orders = block_orders(spectrum, rates, passage.responses, passage.revolution)
    return dict(zip("AB", orders, strict=True))
