"""Damage of material that wear removes.

The material of a body stays at its depth zeta below the *unworn* surface while the surface recedes
to E(y, N): in revolution N it lies zeta - E deep, and a pass adds the damage d there, by Miner's
rule. Where zeta < E the material and its damage are removed:

    D(y, zeta; N) = sum of d(zeta - E(y, n); y, n) over n = 1 ... N while zeta > E.

Records are many revolutions apart. By Euler and Maclaurin the sum over a jump from N_0 to N_1 is
the integral of d dN + (d(N_1) - d(N_0))/2; for a jump of one it is the pass. Within a jump E is the
cubic through both profiles and rates, and the utilisation at a depth below the surface is the
parabola through this record and the two before. The difference from a straight line between two
records is reported as the error, and jumps become shorter if it is too large.

In a duty cycle d is the mean over the revolutions of all blocks, and in a revolution of one block
that of the block. The order of the blocks adds to the error of such a mean
(`rolling.block_order`).

With steady d(z) and wear w' of a revolution, material that reaches the surface has D = integral of
d dz/w': cracks start there if and only if w' is below w'_bal(y) = integral of d dz.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.mechanics import VolumeLife, Woehler, interpolate_over_depth
from tractive_sam.results import BODIES, BodyFatigue, widen_field
from tractive_sam.rolling.block_order import BlockOrder, block_orders
from tractive_sam.rolling.observer import Observer
from tractive_sam.rolling.passage import Passage
from tractive_sam.rolling.process import StoredStep
from tractive_sam.scene import FatigueVolume, Scene
from tractive_sam.subsurface import cycle_depths, cycle_fatigue, semi_axes

WORN, FINE, GROWTH, COARSE = 0.2, 180, 1.05, 0.25
"""Depth, over the semi-axis a, down to which material depths are squares of their number: the
stress falls with the root of the depth from the surface, and a surface with little wear is still
resolved. Number of such depths; factor by which distances grow further down, and their bound over
the first depth below the surface, which is one element."""

NEAR = 0.9
"""Damage, over the largest one, from which its error makes jumps shorter."""

CELLS = 8
"""Cells of an integral over the depth, between two depths."""

FARTHEST = 400
"""Largest number of parts of a jump: one for each material depth that it wears off."""

NODES, WEIGHTS = (
    np.array([0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15)]),
    np.array([5, 8, 5]) / 18,
)
"""Quadrature of Gauss on a part."""

WITH_ERROR_BAR = ("utilisation", "stressed_volume")
"""Columns whose error bars on the mesh also give those of others."""

MISSED = 0.3
"""Allowed estimated error of the largest damage by a jump, over fatigue.tolerance."""

AT_TOP = 0.9
"""`VolumeLife.surface_density_ratio` above which the life of a volume depends on the mesh."""

WORKS = 0.1
"""Share of the largest balancing wear above which a row counts for the wear margin."""


@dataclass(frozen=True, eq=False)
class BodyDamage:
    """Damage of the material of one body.

    Attributes
    ----------
    fatigue : BodyFatigue
        The last passes, and the damage so far.
    utilisation, utilisation_before : ndarray, shape (blocks, n_y, n)
        Utilisation in each block, in this record and in the one before.
    rate : ndarray, shape (n_y,)
        Depth that a revolution wears off it, mm.
    passes : float
        Passes in a revolution; 0 for a flat body, whose material passes the contact once.
    error : ndarray, shape (n_y, m)
        Error of the damage.
    initiation : float
        Revolution at which the damage reached 1; nan before.
    missed : float
        Error that the last jump added, over the largest damage.
    offset : ndarray, shape (n_y,), optional
        Depth that the blocks of a duty cycle in their order have worn off it, minus that of their
        mean, mm; None for a single load.
    """

    fatigue: BodyFatigue
    utilisation: np.ndarray
    utilisation_before: np.ndarray
    rate: np.ndarray
    passes: float
    error: np.ndarray
    initiation: float = math.nan
    missed: float = 0.0
    offset: np.ndarray | None = None

    @property
    def damage_error(self) -> float:
        """Estimated error of the largest damage.

        In a duty cycle the error is large just below the surface, where the damage may not be
        largest. So the largest damage is found for more and for less damage everywhere, also at
        the worn depth of the blocks in their order.
        """
        now, error = self.fatigue, self.error
        if self.offset is None:
            return float(error[_remaining(now)].max(initial=0.0))
        top, _ = now.damage_max
        bounds = (
            now.with_damage(now.zeta, np.maximum(now.damage + sign * error, 0.0), worn)
            for worn in (now.worn, np.maximum(now.worn + self.offset, 0.0))
            for sign in (-1.0, 1.0)
        )
        return max(abs(bound.damage_max[0] - top) for bound in bounds)

    def path_error(self, life: Woehler) -> float:
        """Return the error of the largest damage by the finite number of points of stress paths.

        It is systematic and does not depend on the length of jumps.
        """
        criterion = self.fatigue.criterion
        error = 0.0 if criterion is None else criterion.path_error
        return self.fatigue.damage_max[0] * life.relative_error(error)

    def columns(self, life: Woehler | None, shares: tuple[float, ...] = (1.0,)) -> dict[str, Any]:
        """Return the values of columns of a record, by their names without that of the body."""
        if life is None:
            return {}
        top, at = self.fatigue.damage_max
        each = self.passes or 1.0
        # At the depths of the damage, so that without wear the life is the inverse of the damage.
        new = each * _per_pass(
            life, shares, self.fatigue.depth, self.utilisation, self.fatigue.zeta
        )
        largest, _ = self.fatigue.with_damage(self.fatigue.zeta, new, 0.0 * self.rate).damage_max
        balance = each * _integrate_damage(self.fatigue.depth, self.utilisation, life, shares)
        works = balance > WORKS * balance.max()
        margin = (self.rate[works] / balance[works]).min() if works.any() else math.inf
        return {
            "damage": top,
            "damage_at": at,
            "damage_error": self.damage_error + self.path_error(life),
            "initiation": self.initiation,
            "fatigue_life": 1.0 / largest if largest > 0.0 else math.inf,
            "wear_margin": float(margin) if self.passes and self.rate.any() else math.nan,
            "balancing_wear": balance,
        }


@dataclass(frozen=True, eq=False)
class Damage(Observer):
    """Damage of the bodies of a scene with [fatigue], after a number of revolutions.

    Attributes
    ----------
    revolution, earlier : int
        Revolutions of the last record and of the one before.
    bodies : mapping of str to BodyDamage
        Damage of each body.
    """

    name, key = "damage", "fatigue"

    revolution: int = 0
    earlier: int = 0
    bodies: Mapping[str, BodyDamage] = field(default_factory=dict)

    def describe(self, model: Model) -> Iterator[Row]:
        """See `Observer.describe`."""
        laws, table = model.laws, model.scene.fatigue
        yield Row("records", "all; fields over (y, depth) with the stored fields")
        if table.limit is None:
            return
        yield Row("criterion", laws.fatigue.long_name)
        if laws.volume is not None:
            yield Row("volume", _describe_volume(table.volume, laws.volume))
        if len(model.blocks) > 1:
            rule = "by Miner's rule, in any order (damage_error estimates its effect)"
            yield Row("duty cycle", f"the damage of its blocks {rule}")
        if model.scene.schedule.adaptive:
            missed = f"each misses up to {MISSED * table.tolerance:g} of the largest damage"
            yield Row("jumps", f"{missed}, by its estimate; all together damage_error")

    def begin(self, passage: Passage, model: Model) -> "Damage":
        """See `Observer.begin`: undamaged bodies in their first pass."""
        longest = max(passage.contacts, key=lambda contact: semi_axes(contact)[0])
        turns, bodies = passage.turns[0], {}
        for body, (cycle, used) in _cycle_fatigue(passage, model, cycle_depths(longest)).items():
            worn, rate = passage.worn_depths(body)
            zeta = material_depths(cycle.depth, WORN * semi_axes(longest)[0])
            none = np.zeros((cycle.y.size, zeta.size))
            now = cycle.with_damage(zeta, none, worn)
            bodies[body] = BodyDamage(now, used, used, rate, turns.per_count[body], none)
        return Damage(passage.revolution, passage.revolution, bodies)

    def after(self, passage: Passage, model: Model) -> "Damage":
        """See `Observer.after`: after the passes up to a later one."""
        before = {body: _widen_body(damage, passage.grid.y) for body, damage in self.bodies.items()}
        depths = next(iter(before.values())).fatigue.depth  # common to both bodies
        jump = passage.revolution - self.revolution, self.revolution - self.earlier
        bodies, life, orders = {}, model.laws.life, _block_orders(passage, model)
        for body, (cycle, used) in _cycle_fatigue(passage, model, depths).items():
            worn, rate = passage.worn_depths(body)
            rolled = cycle, used, worn, rate, passage.weights
            order = orders.get(body)
            bodies[body] = after_jump(before[body], *rolled, jump, life, self.revolution, order)
        return Damage(passage.revolution, self.revolution, bodies)

    def missed(self, model: Model) -> float:
        """See `Observer.missed`: the error of the largest damage by the last jump."""
        largest = max(damage.missed for damage in self.bodies.values())
        return largest / (MISSED * model.scene.fatigue.tolerance)

    def remark(self, model: Model) -> str:
        """See `Observer.remark`: stress above shakedown, and lives that depend on the mesh."""
        tops = {} if model.laws.volume is None else self.surface_density_ratios(model)
        shallow = [body for body, top in tops.items() if top > AT_TOP]
        remark = shakedown_remark({body: damage.fatigue for body, damage in self.bodies.items()})
        if shallow:
            remark += (
                f"; in body {' and '.join(shallow)} the density of the stressed volume is largest "
                "one element deep: smaller elements give a larger volume, and a shorter life"
            )
        return remark

    def surface_density_ratios(self, model: Model) -> dict[str, float]:
        """Return `VolumeLife.surface_density_ratio` of each body, the largest of all blocks."""
        law, limit = model.laws.volume, model.scene.fatigue.limit
        return {
            body: max(
                law.surface_density_ratio(damage.fatigue.depth, used * limit)
                for used in damage.utilisation
            )
            for body, damage in self.bodies.items()
        }

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """See `Observer.cycles`."""
        return tuple(damage.fatigue for damage in self.bodies.values())

    @property
    def state(self) -> dict[str, np.ndarray]:
        """See `Observer.state`."""
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
            )
        }

    def record(self, model: Model, recorded: Mapping[str, Any]) -> dict[str, Any]:
        """See `Observer.record`; error bars of jumps and of the mesh are added."""
        columns = fatigue_columns(self, model)
        bars = {name: recorded.get(f"{name}_error") for name in ("damage", *WITH_ERROR_BAR)}
        if "damage_error" in columns:
            mesh = bars["damage"] or {}
            columns["damage_error"] = {
                body: value + mesh.get(body, 0.0) for body, value in columns["damage_error"].items()
            }
        if "fatigue_life" in columns and bars["utilisation"] is not None:
            columns["fatigue_life_error"] = life_error_bars(
                columns, bars["utilisation"], model.laws.life
            )
        if "stressed_volume" in columns and bars["stressed_volume"] is not None:
            volume = volume_error_bars(columns, bars["stressed_volume"], model.laws.volume)
            columns |= {f"{name}_error": values for name, values in volume.items()}
        return columns

    def record_block(self, block: int) -> dict[str, Any]:
        """See `Observer.record_block`."""
        each = self.bodies.items()
        return _utilisation_columns(
            {k: replace(d.fatigue, utilisation=d.utilisation[block]) for k, d in each}
        )

    def restore(self, passage: Passage, stored: StoredStep) -> "Damage":
        """See `Observer.restore`."""
        history, row, state = stored.history, stored.row, stored.state_of(self)
        unknown = np.full((len(history), len(BODIES)), np.nan)  # without a limit
        by_body = history.values.get("initiation", unknown)[row]
        initiation = dict(zip(BODIES, by_body, strict=True))
        earlier = int(history["revolution"][max(row - 1, 0)])
        scene, grid = passage.contact.scene, passage.grid
        bodies, k = {}, scene.fatigue.shear_yield_stress
        for body in scene.fatigue.bodies:
            depth, zeta = (state[f"{name}_{body}"] for name in ("depth", "zeta"))
            damage, error, used, before = (
                _widen_rows(state[f"{name}_{body}"], grid.elements[1])
                for name in ("damage", "damage_error", "utilisation", "utilisation_before")
            )
            worn, rate = passage.worn_depths(body)
            top, unknown = used.max(axis=0), np.full(used.shape[1:], np.nan)
            now = BodyFatigue(
                body, grid.y, depth, top, unknown, unknown, None, math.nan if k is None else k
            ).with_damage(zeta, damage, worn)
            bodies[body] = BodyDamage(
                now,
                used,
                before,
                rate,
                passage.turns[0].per_count[body],
                error,
                float(initiation[body]),
            )
        return Damage(passage.revolution, earlier, bodies)


def _describe_volume(table: FatigueVolume, law: VolumeLife) -> str:
    """Describe the law for the life of a stressed volume."""
    text = f"stress^{law.stress_exponent:.4g} / depth^{law.depth_exponent:.4g}"
    text += f" above {law.limit:g} MPa" if law.limit else ""
    text += f", Weibull slope {law.slope:.4g}; starts one element deep"
    if table.constant is None:
        return f"{text}; no life: there is no constant"
    return f"{text}; life with a survival of {table.survival:g}"


def _cycle_fatigue(
    passage: Passage, model: Model, depths: np.ndarray
) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    """Return the fatigue of each body in a cycle, and its utilisation in each block."""
    laws = [block.laws for block in model.blocks]
    return cycle_fatigue(passage.contacts, depths, laws)


def _block_orders(passage: Passage, model: Model) -> dict[str, BlockOrder]:
    """Return the order of the blocks of a cycle that is rolled as its mean, by body."""
    spectrum = model.scene.spectrum
    if spectrum is None or passage.rolled is not None:
        return {}
    rates = passage.gained_by_block / np.reshape(passage.weights, (-1, 1, 1))
    return dict(
        zip("AB", block_orders(spectrum, rates, passage.responses, passage.revolution), strict=True)
    )


def _per_pass(
    life: Woehler,
    shares: tuple[float, ...],
    depth: np.ndarray,
    used: np.ndarray,
    at: np.ndarray,
) -> np.ndarray:
    """Return the damage (n_y, m) of a pass at depths, from several blocks by their shares."""
    each = zip(shares, used, strict=True)
    return sum(
        share * life.damage(interpolate_over_depth(depth, block, at))
        for share, block in each
        if share
    )


def _widen_rows(values: np.ndarray, elements: int) -> np.ndarray:
    """Return rows (..., n_y, n) on a mesh with more rows; the new rows are undamaged."""
    return widen_field(values, (elements, values.shape[-1]))


def material_depths(depth: np.ndarray, fine: float) -> np.ndarray:
    """Return material depths, mm: all depths, and others between them; squares down to `fine`."""
    places = list(fine * np.linspace(0.0, 1.0, FINE) ** 2)
    step = places[-1] - places[-2]
    while places[-1] < depth[-1]:
        step = max(step, min(GROWTH * step, COARSE * depth[1]))
        places.append(places[-1] + step)
    even = np.array([place for place in places if place < depth[-1]])
    between = even[np.abs(even[:, None] - depth).min(axis=1) > 1e-6 * depth[1]]
    return np.union1d(depth, between)


def _widen_body(damage: BodyDamage, y: np.ndarray) -> BodyDamage:
    """Return the damage on a mesh with more rows; the new rows are undamaged."""
    names = ("damage", "utilisation")
    wider = {name: _widen_rows(getattr(damage.fatigue, name), y.size) for name in names}
    now = replace(damage.fatigue, y=y, worn=widen_field(damage.fatigue.worn, y.shape), **wider)
    wider = {
        name: _widen_rows(getattr(damage, name), y.size)
        for name in ("utilisation", "utilisation_before", "error")
    }
    return replace(damage, fatigue=now, rate=widen_field(damage.rate, y.shape), **wider)


def after_jump(
    last: BodyDamage,
    now: BodyFatigue,
    used: np.ndarray,
    worn: np.ndarray,
    rate: np.ndarray,
    shares: tuple[float, ...],
    jump: tuple[int, int],
    life: Woehler | None,
    revolution: int,
    order: BlockOrder | None = None,
) -> BodyDamage:
    """Return the damage after a jump; `jump` is its length and that of the jump before."""
    zeta, before = last.fatigue.zeta, last.fatigue
    now = now.with_damage(zeta, before.damage, worn)
    offset = None if order is None else order.offset
    later = replace(last, utilisation=used, utilisation_before=last.utilisation, rate=rate)
    later = replace(later, fatigue=now, missed=0.0, offset=offset)
    if life is None:
        return later
    if not last.passes:  # a flat body passes the contact only once
        each = [life.damage(interpolate_over_depth(now.depth, block, zeta)) for block in used]
        return replace(later, fatigue=now.with_damage(zeta, np.max(each, axis=0), 0.0 * worn))
    added, missed = _damage_of_jump(last, later, shares, jump, life)
    now = now.with_damage(zeta, before.damage + last.passes * added, worn)
    missed *= last.passes
    initiation, (top, _), (was, _) = last.initiation, now.damage_max, before.damage_max
    if math.isnan(initiation) and top >= 1.0:
        initiation = revolution + jump[0] * (1.0 - was) / (top - was)
    # At the material depths: the extrapolated damage at the surface may exceed all of them.
    remaining = np.where(_remaining(now), now.damage, 0.0)
    largest = float(missed[remaining >= NEAR * remaining.max()].max(initial=0.0))
    if order is not None:  # shorter jumps do not reduce this error
        missed = missed + last.passes * _block_order_error(last, later, order, jump[0], life)
    return replace(
        later,
        fatigue=now,
        initiation=initiation,
        error=last.error + missed,
        missed=largest / top if top > 0.0 else 0.0,
    )


def _remaining(now: BodyFatigue) -> np.ndarray:
    """Return a mask of the material that is not worn off, (n_y, m)."""
    return now.zeta >= now.worn[:, None]


def _damage_of_jump(
    previous: BodyDamage,
    later: BodyDamage,
    shares: tuple[float, ...],
    jump: tuple[int, int],
    life: Woehler,
) -> tuple[np.ndarray, np.ndarray]:
    """Return damage (n_y, m) of one pass a revolution over a jump, and its estimated error."""
    before, now, (length, last) = previous.fatigue, later.fatigue, jump
    zeta, depth = before.zeta, before.depth

    def damage(used: np.ndarray, worn: np.ndarray) -> np.ndarray:
        deep = zeta - worn[:, None]
        per_pass = _per_pass(life, shares, depth, used, np.maximum(deep, 0.0))
        return np.where(deep >= 0.0, per_pass, 0.0)

    end = damage(later.utilisation, now.worn)
    if length == 1:
        return end, np.zeros_like(end)
    first, second = previous.utilisation, later.utilisation
    # Newton's second difference: u = straight line + t (t - 1) bend goes through the record before.
    bend = np.zeros_like(first)
    if last:
        bend = (second - first) * last - (first - previous.utilisation_before) * length
        bend *= length / (last * (length + last))
    # One part for each material depth that the fastest row loses: the damage of material ends
    # when wear removes it, and no Gauss rule holds across that.
    steps = np.searchsorted(zeta, now.worn) - np.searchsorted(zeta, before.worn)
    parts = int(min(max(1, steps.max()), FARTHEST))
    total, missed = np.zeros_like(end), np.zeros_like(end)
    for part in range(parts):
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            t = (part + node) / parts
            worn = _interpolate_profile(before.worn, previous.rate, now.worn, later.rate, t, length)
            even = (1.0 - t) * first + t * second
            here = damage(np.maximum(even + t * (t - 1.0) * bend, 0.0), worn)
            total += weight * length / parts * here
            if last and node == NODES[1]:
                # The difference between parabola and straight line estimates the error.
                missed += length / parts * (here - damage(even, worn))
    # By Euler and Maclaurin the sum over the passes is the integral plus half the difference of the
    # ends. It cannot be negative, however rough the course is.
    total += 0.5 * (end - damage(first, before.worn))
    return np.maximum(total, 0.0), np.abs(missed)


def _block_order_error(
    previous: BodyDamage, later: BodyDamage, order: BlockOrder, revolutions: int, life: Woehler
) -> np.ndarray:
    """Return the damage error (n_y, m) of a jump that replaces the block order by the mean."""
    zeta, depth = previous.fatigue.zeta, previous.fatigue.depth

    def damage(used: np.ndarray, worn: np.ndarray) -> np.ndarray:
        deep = zeta - worn[:, None]
        return np.where(
            deep >= 0.0,
            life.damage(interpolate_over_depth(depth, used, np.maximum(deep, 0.0))),
            0.0,
        )

    ends = (previous.utilisation, later.utilisation), (previous.fatigue.worn, later.fatigue.worn)
    return order.damage_error(
        damage, *ends, revolutions, order.load_factors(previous.fatigue.y, depth)
    )


def _interpolate_profile(
    first: np.ndarray, rate: np.ndarray, last: np.ndarray, end: np.ndarray, t: float, length: int
) -> np.ndarray:
    """Interpolate between two profiles by the cubic through both and their rates, within both."""
    s = 1.0 - t
    cubic = first * s * s * (1.0 + 2.0 * t) + last * t * t * (1.0 + 2.0 * s)
    cubic += length * s * t * (rate * s - end * t)
    return np.clip(cubic, first, last)


def _integrate_damage(
    depth: np.ndarray, used: np.ndarray, life: Woehler, shares: tuple[float, ...]
) -> np.ndarray:
    """Return the integral of the damage of a pass over the depth, shape (n_y,), mm."""
    number = np.arange(depth.size)
    between = np.linspace(0, depth.size - 1, CELLS * (depth.size - 1) + 1)
    edges = np.interp(between, number, np.sqrt(depth))  # dz = 2 root d(root)
    widths = np.diff(edges)
    root = (edges[:-1, None] + NODES * widths[:, None]).ravel()
    weights = 2.0 * root * np.outer(widths, WEIGHTS).ravel()
    return _per_pass(life, shares, depth, used, root**2) @ weights


def fatigue_columns(damage: Damage, model: Model) -> dict[str, Any]:
    """Return the columns of the fatigue of each body, by name."""
    life, shares = model.laws.life, model.weights
    columns = cycle_columns({body: part.fatigue for body, part in damage.bodies.items()})
    if model.laws.volume is not None:
        columns |= _volume_columns(damage, model, model.laws.volume)
    for body, part in damage.bodies.items():
        for name, value in part.columns(life, shares).items():
            if name == "balancing_wear":
                columns[f"{name}_{body}"] = value
            else:
                columns.setdefault(name, {})[body] = value
    return columns


def cycle_columns(cycles: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    """Return the columns of utilisation and shakedown, by name and body."""
    residual = {body: cycle.largest("residual_shear") for body, cycle in cycles.items()}

    def factors(name: str) -> dict[str, float]:
        return {k: cycle.load_factor(getattr(residual[k], name)) for k, cycle in cycles.items()}

    return _utilisation_columns(cycles) | {
        "shakedown_lower": factors("value"),
        "shakedown_interior": factors("interior"),
        "shakedown_surface": factors("surface"),
        "shakedown_lower_at": {body: maximum.at for body, maximum in residual.items()},
        "shakedown_upper": {body: cycle.shakedown_upper for body, cycle in cycles.items()},
    }


def shakedown_remark(cycles: Mapping[str, BodyFatigue]) -> str:
    """Return the remark on bodies with stress above the shakedown limit; "" if there are none."""
    factors = {body: cycle.shakedown_lower for body, cycle in cycles.items()}
    above = [f"{body} {factor:.2f}" for body, factor in factors.items() if factor < 1.0]
    if not above:
        return ""
    return (
        f"; stress is above the shakedown limit (load factor of body {', of '.join(above)}): the "
        "material yields, and this elastic stress is not its stress"
    )


def _volume_columns(damage: Damage, model: Model, law: VolumeLife) -> dict[str, Any]:
    """Return the columns of the life of a volume; lives of several blocks add by Miner's rule."""
    survival = model.scene.fatigue.volume.survival
    columns: dict[str, Any] = {"stressed_volume": {}, "volume_life": {}}
    for body, part in damage.bodies.items():
        volumes = [
            stressed_volume(replace(part.fatigue, utilisation=used), model.scene, law)
            for used in part.utilisation
        ]
        lives = [law.life(volume, survival) for volume in volumes]
        used = sum(share / each for share, each in zip(model.weights, lives, strict=True))
        columns["stressed_volume"][body] = float(np.dot(model.weights, volumes))
        life = 1.0 / (used * (part.passes or 1.0)) if used else math.inf
        columns["volume_life"][body] = life
    return columns | {"volume_at_top": damage.surface_density_ratios(model)}


def stressed_volume(cycle: BodyFatigue, scene: Scene, law: VolumeLife) -> float:
    """Return the integral of stress over the volume of a body; if flat, over 1 mm of track."""
    radius = getattr(scene.body, cycle.body).radius_x
    around = 2.0 * math.pi * abs(radius) if math.isfinite(radius) else 1.0
    return law.volume(cycle.y, cycle.depth, cycle.utilisation * scene.fatigue.limit, around)


def volume_error_bars(
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


def life_error_bars(columns: Mapping[str, Any], bars: Mapping[str, float], life: Woehler) -> dict:
    """Return the error bars of `fatigue_life` from those of the utilisation, by body.

    They are the increase of the life for the smallest utilisation; for the largest it changes less.
    """
    errors = {}
    for body, used in columns["utilisation"].items():
        low, here = life.damage(np.array([used - bars[body], used]))
        if here > 0.0 and not math.isnan(bars[body]):
            longer = here / low - 1.0 if low > 0.0 else math.inf
            errors[body] = columns["fatigue_life"][body] * longer
    return errors


def _utilisation_columns(cycles: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    """Return the columns of the utilisation, by name and body."""
    maxima = {body: cycle.largest() for body, cycle in cycles.items()}
    return {
        "utilisation": {body: maximum.value for body, maximum in maxima.items()},
        "utilisation_interior": {body: maximum.interior for body, maximum in maxima.items()},
        "utilisation_surface": {body: maximum.surface for body, maximum in maxima.items()},
        "utilisation_at": {body: maximum.at for body, maximum in maxima.items()},
    }
