"""Damage in the material while wear carries it away.

The material of a body keeps its place zeta below the *unworn* surface while the surface comes down
to E(y, N): in revolution N it lies zeta - E deep, and a pass does it the damage d there, by Miner's
rule. Where zeta < E it is gone, and its damage with it:

    D(y, zeta; N) = sum of d(zeta - E(y, n); y, n) over n = 1 ... N while zeta > E.

Records are many revolutions apart. By Euler and Maclaurin the sum over a jump from N_0 to N_1 is
the integral of d dN + (d(N_1) - d(N_0))/2; of a jump of one it is the pass itself. Within a jump E
is the cubic through both profiles and rates, and the utilisation at a depth below the surface is
the parabola through this record and the two before. What a straight line between two of them would
give instead is told as the error, and jumps are made shorter where it is too large.

In a duty cycle d is the mean over its revolutions of what each block does, and in a revolution of
one block that of the block. The order of the blocks adds to the error of such a mean
(`rolling.block_order`).

With steady d(z) and wear w' of a revolution, what reaches the surface has D = integral of d dz/w':
cracks start there if and only if w' is below w'_bal(y) = integral of d dz.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.mechanics import VolumeLife, Woehler, interpolate_over_depth
from tractive_sam.results import BODIES, BodyFatigue, widened
from tractive_sam.rolling.block_order import BlockOrder, block_orders
from tractive_sam.rolling.observer import Observer
from tractive_sam.rolling.passage import Passage
from tractive_sam.rolling.process import StoredStep
from tractive_sam.scene import FatigueVolume, Scene
from tractive_sam.subsurface import cycle_depths, cycle_fatigue, semi_axes

WORN, FINE, GROWTH, COARSE = 0.2, 180, 1.05, 0.25
"""Depth, over the semi-axis a, down to which places of the material lie at squares of their number:
what a depth goes through falls with its root from the surface on, and a surface that is hardly worn
is still followed. So many places; further down their distances grow by a factor, up to a share of
the first depth below the surface, which is one element."""

NEAR = 0.9
"""Damage, over the largest one, whose error makes jumps shorter."""

CELLS = 8
"""Of an integral over the depth, between two depths."""

FARTHEST = 400
"""Most parts of a jump: as many as it wears off places of a row, as far as that goes."""

NODES, WEIGHTS = (
    np.array([0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15)]),
    np.array([5, 8, 5]) / 18,
)
"""Quadrature of Gauss on a part."""

BARRED = ("utilisation", "stressed_volume")
"""Columns whose error bars on the mesh are those of others, too."""

MISSED = 0.3
"""What a jump may miss of the largest damage, by its estimate, over fatigue.tolerance."""

AT_TOP = 0.9
"""`VolumeLife.surface_density_ratio` from which the mesh decides on the life of a volume."""

WORKS = 0.1
"""Share of the largest balancing wear from which a row counts where wear is compared with it."""


@dataclass(frozen=True, eq=False)
class Followed:
    """The material of one body.

    Attributes
    ----------
    now : BodyFatigue
        The last passes, and the damage so far.
    used, before : ndarray, shape (blocks, n_y, n)
        Utilisation in each block, in this record and in the one before.
    rate : ndarray, shape (n_y,)
        Depth that a revolution wears off it, mm.
    passes : float
        In a revolution; 0 of a flat body, whose material comes but once.
    error : ndarray, shape (n_y, m)
        Of the damage.
    initiation : float
        Revolution at which the damage reached 1; nan before.
    missed : float
        What the last jump added to the error, over the largest damage.
    offset : ndarray, shape (n_y,), optional
        Depth that the blocks of a duty cycle in their order have worn off it, less that of their
        mean, mm; None of a single load.
    """

    now: BodyFatigue
    used: np.ndarray
    before: np.ndarray
    rate: np.ndarray
    passes: float
    error: np.ndarray
    initiation: float = math.nan
    missed: float = 0.0
    offset: np.ndarray | None = None

    @property
    def damage_error(self) -> float:
        """How far the largest damage may be off.

        Of a duty cycle the error is large where the largest damage is not: just below the surface.
        There the largest damage is looked for with more and with less of it everywhere, also at
        the worn depth of the blocks in their order.
        """
        now, error = self.now, self.error
        if self.offset is None:
            return float(error[_left(now)].max(initial=0.0))
        top, _ = now.damage_max
        others = (
            now.with_damage(now.zeta, np.maximum(now.damage + sign * error, 0.0), worn)
            for worn in (now.worn, np.maximum(now.worn + self.offset, 0.0))
            for sign in (-1.0, 1.0)
        )
        return max(abs(one.damage_max[0] - top) for one in others)

    def path_error(self, life: Woehler) -> float:
        """Return the error of the largest damage by the finite number of points of stress paths.

        It is systematic: jumps of any length leave it as it is, and do not depend on it.
        """
        criterion = self.now.criterion
        error = 0.0 if criterion is None else criterion.path_error
        return self.now.damage_max[0] * life.relative_error(error)

    def columns(self, life: Woehler | None, shares: tuple[float, ...] = (1.0,)) -> dict[str, Any]:
        """Numbers of a record, by the names of its columns without those of the body."""
        if life is None:
            return {}
        top, at = self.now.damage_max
        each = self.passes or 1.0
        # By the same points as the damage, so that without wear one is the inverse of the other.
        new = each * _per_pass(life, shares, self.now.depth, self.used, self.now.zeta)
        most, _ = self.now.with_damage(self.now.zeta, new, 0.0 * self.rate).damage_max
        balance = each * _down(self.now.depth, self.used, life, shares)
        works = balance > WORKS * balance.max()
        margin = (self.rate[works] / balance[works]).min() if works.any() else math.inf
        return {
            "damage": top,
            "damage_at": at,
            "damage_error": self.damage_error + self.path_error(life),
            "initiation": self.initiation,
            "fatigue_life": 1.0 / most if most > 0.0 else math.inf,
            "wear_margin": float(margin) if self.passes and self.rate.any() else math.nan,
            "balancing_wear": balance,
        }


@dataclass(frozen=True, eq=False)
class Damage(Observer):
    """The material of the bodies of a scene with [fatigue], after a number of revolutions.

    Attributes
    ----------
    revolution, earlier : int
        Of the last record and the one before.
    bodies : mapping of str to Followed
        By body.
    """

    name, key = "damage", "fatigue"

    revolution: int = 0
    earlier: int = 0
    bodies: Mapping[str, Followed] = field(default_factory=dict)

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
        longest = max(passage.contacts, key=lambda one: semi_axes(one)[0])
        turns, bodies = passage.turns[0], {}
        for body, (found, used) in _cycled(passage, model, cycle_depths(longest)).items():
            worn, rate = passage.off(body)
            zeta = _below_the_unworn_surface(found.depth, WORN * semi_axes(longest)[0])
            none = np.zeros((found.y.size, zeta.size))
            now = found.with_damage(zeta, none, worn)
            bodies[body] = Followed(now, used, used, rate, turns.per_count[body], none)
        return Damage(passage.revolution, passage.revolution, bodies)

    def after(self, passage: Passage, model: Model) -> "Damage":
        """See `Observer.after`: after the passes up to a later one."""
        before = {body: _on(one, passage.grid.y) for body, one in self.bodies.items()}
        depths = next(iter(before.values())).now.depth  # those of all
        jump = passage.revolution - self.revolution, self.revolution - self.earlier
        bodies, life, orders = {}, model.laws.life, _block_orders(passage, model)
        for body, (found, used) in _cycled(passage, model, depths).items():
            worn, rate = passage.off(body)
            rolled = found, used, worn, rate, passage.weights
            order = orders.get(body)
            bodies[body] = _rolled(before[body], *rolled, jump, life, self.revolution, order)
        return Damage(passage.revolution, self.revolution, bodies)

    def missed(self, model: Model) -> float:
        """See `Observer.missed`: what the last jump missed of the largest damage."""
        most = max(one.missed for one in self.bodies.values())
        return most / (MISSED * model.scene.fatigue.tolerance)

    def remark(self, model: Model) -> str:
        """See `Observer.remark`: stress above shakedown, and lives that the mesh decides on."""
        tops = {} if model.laws.volume is None else self.at_the_top(model)
        hinge = [body for body, top in tops.items() if top > AT_TOP]
        remark = shakedown_remark({body: one.now for body, one in self.bodies.items()})
        if hinge:
            remark += (
                f"; in body {' and '.join(hinge)} what counts for the stressed volume is largest "
                "one element deep: smaller elements find more, and a shorter life"
            )
        return remark

    def at_the_top(self, model: Model) -> dict[str, float]:
        """`VolumeLife.surface_density_ratio` of each body, the largest of all blocks."""
        law, limit = model.laws.volume, model.scene.fatigue.limit
        return {
            body: max(law.surface_density_ratio(one.now.depth, used * limit) for used in one.used)
            for body, one in self.bodies.items()
        }

    @property
    def cycles(self) -> tuple[BodyFatigue, ...]:
        """See `Observer.cycles`."""
        return tuple(one.now for one in self.bodies.values())

    @property
    def state(self) -> dict[str, np.ndarray]:
        """See `Observer.state`."""
        return {
            f"{name}_{body}": values
            for body, one in self.bodies.items()
            for name, values in (
                ("depth", one.now.depth),
                ("zeta", one.now.zeta),
                ("damage", one.now.damage),
                ("utilisation", one.used),
                ("utilisation_before", one.before),
                ("damage_error", one.error),
            )
        }

    def record(self, model: Model, recorded: Mapping[str, Any]) -> dict[str, Any]:
        """See `Observer.record`; error bars of jumps and mesh are put together."""
        found = fatigue_columns(self, model)
        bars = {name: recorded.get(f"{name}_error") for name in ("damage", *BARRED)}
        if "damage_error" in found:
            mesh = bars["damage"] or {}
            found["damage_error"] = {
                body: value + mesh.get(body, 0.0) for body, value in found["damage_error"].items()
            }
        if "fatigue_life" in found and bars["utilisation"] is not None:
            found["fatigue_life_error"] = life_bars(found, bars["utilisation"], model.laws.life)
        if "stressed_volume" in found and bars["stressed_volume"] is not None:
            volume = volume_bars(found, bars["stressed_volume"], model.laws.volume)
            found |= {f"{name}_error": values for name, values in volume.items()}
        return found

    def record_block(self, block: int) -> dict[str, Any]:
        """See `Observer.record_block`."""
        each = self.bodies.items()
        return _used({body: replace(one.now, utilisation=one.used[block]) for body, one in each})

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
                _wider(state[f"{name}_{body}"], grid.elements[1])
                for name in ("damage", "damage_error", "utilisation", "utilisation_before")
            )
            worn, rate = passage.off(body)
            top, unknown = used.max(axis=0), np.full(used.shape[1:], np.nan)
            now = BodyFatigue(
                body, grid.y, depth, top, unknown, unknown, None, math.nan if k is None else k
            ).with_damage(zeta, damage, worn)
            bodies[body] = Followed(
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
    """Describe the life of the whole volume under stress."""
    text = f"stress^{law.stress_exponent:.4g} / depth^{law.depth_exponent:.4g}"
    text += f" above {law.limit:g} MPa" if law.limit else ""
    text += f", Weibull's slope {law.slope:.4g}; from one element deep on"
    if table.constant is None:
        return f"{text}; no life: there is no constant"
    return f"{text}; life with a survival of {table.survival:g}"


def _cycled(
    passage: Passage, model: Model, depths: np.ndarray
) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    laws = [block.laws for block in model.blocks]
    return cycle_fatigue(passage.contacts, depths, laws)


def _block_orders(passage: Passage, model: Model) -> dict[str, BlockOrder]:
    """Return the order of the blocks of a cycle that is rolled as its mean, by body."""
    spectrum = model.scene.spectrum
    if spectrum is None or passage.rolled is not None:
        return {}
    rates = passage.gained_by / np.reshape(passage.weights, (-1, 1, 1))
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
    """Damage (n_y, m) of a pass at depths, of several blocks by their shares."""
    each = zip(shares, used, strict=True)
    return sum(
        share * life.damage(interpolate_over_depth(depth, one, at)) for share, one in each if share
    )


def _wider(values: np.ndarray, elements: int) -> np.ndarray:
    """Rows (..., n_y, n) on a mesh with more of them; nothing has happened there."""
    return widened(values, (elements, values.shape[-1]))


def _below_the_unworn_surface(depth: np.ndarray, fine: float) -> np.ndarray:
    """Places of the material: every depth, and others between them; to `fine` at squares, mm."""
    places = list(fine * np.linspace(0.0, 1.0, FINE) ** 2)
    step = places[-1] - places[-2]
    while places[-1] < depth[-1]:
        step = max(step, min(GROWTH * step, COARSE * depth[1]))
        places.append(places[-1] + step)
    even = np.array([one for one in places if one < depth[-1]])
    beside = even[np.abs(even[:, None] - depth).min(axis=1) > 1e-6 * depth[1]]
    return np.union1d(depth, beside)


def _on(one: Followed, y: np.ndarray) -> Followed:
    """The same on a mesh with more rows; nothing has happened there."""
    names = ("damage", "utilisation")
    wider = {name: _wider(getattr(one.now, name), y.size) for name in names}
    now = replace(one.now, y=y, worn=widened(one.now.worn, y.shape), **wider)
    wider = {name: _wider(getattr(one, name), y.size) for name in ("used", "before", "error")}
    return replace(one, now=now, rate=widened(one.rate, y.shape), **wider)


def _rolled(
    one: Followed,
    now: BodyFatigue,
    used: np.ndarray,
    worn: np.ndarray,
    rate: np.ndarray,
    shares: tuple[float, ...],
    jump: tuple[int, int],
    life: Woehler | None,
    revolution: int,
    order: BlockOrder | None = None,
) -> Followed:
    """The material after a jump; `jump` tells its length and that of the one before."""
    zeta, before = one.now.zeta, one.now
    now = now.with_damage(zeta, before.damage, worn)
    offset = None if order is None else order.offset
    later = replace(one, now=now, used=used, before=one.used, rate=rate, missed=0.0, offset=offset)
    if life is None:
        return later
    if not one.passes:  # it comes but once
        single = np.max(
            [life.damage(interpolate_over_depth(now.depth, own, zeta)) for own in used], axis=0
        )
        return replace(later, now=now.with_damage(zeta, single, 0.0 * worn))
    added, missed = _added(one, later, shares, jump, life)
    now = now.with_damage(zeta, before.damage + one.passes * added, worn)
    missed *= one.passes
    initiation, (top, _), (was, _) = one.initiation, now.damage_max, before.damage_max
    if math.isnan(initiation) and top >= 1.0:
        initiation = revolution + jump[0] * (1.0 - was) / (top - was)
    # Of the places: at the surface, to which the top is taken on, there may be more than at any.
    left = np.where(_left(now), now.damage, 0.0)
    most = float(missed[left >= NEAR * left.max()].max(initial=0.0))
    if order is not None:  # shorter jumps do not make it smaller
        missed = missed + one.passes * _order_error(one, later, order, jump[0], life)
    return replace(
        later,
        now=now,
        initiation=initiation,
        error=one.error + missed,
        missed=most / top if top > 0.0 else 0.0,
    )


def _left(now: BodyFatigue) -> np.ndarray:
    """Where there is material, (n_y, m)."""
    return now.zeta >= now.worn[:, None]


def _added(
    one: Followed,
    later: Followed,
    shares: tuple[float, ...],
    jump: tuple[int, int],
    life: Woehler,
) -> tuple[np.ndarray, np.ndarray]:
    """Damage (n_y, m) of one pass a revolution over a jump, and how far it may be off."""
    before, now, (length, last) = one.now, later.now, jump
    zeta, depth = before.zeta, before.depth

    def damage(used: np.ndarray, worn: np.ndarray) -> np.ndarray:
        deep = zeta - worn[:, None]
        per_pass = _per_pass(life, shares, depth, used, np.maximum(deep, 0.0))
        return np.where(deep >= 0.0, per_pass, 0.0)

    end = damage(later.used, now.worn)
    if length == 1:
        return end, np.zeros_like(end)
    first, second = one.used, later.used
    # Newton's second difference: u = straight line + t (t - 1) bend goes through the record before.
    bend = np.zeros_like(first)
    if last:
        bend = (second - first) * last - (first - one.before) * length
        bend *= length / (last * (length + last))
    # In as many pieces as places are worn off the row that loses most of them: the damage of a
    # place ends where wear takes it away, and no Gauss rule holds across that.
    steps = np.searchsorted(zeta, now.worn) - np.searchsorted(zeta, before.worn)
    parts = int(min(max(1, steps.max()), FARTHEST))
    total, missed = np.zeros_like(end), np.zeros_like(end)
    for part in range(parts):
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            t = (part + node) / parts
            worn = _between(before.worn, one.rate, now.worn, later.rate, t, length)
            even = (1.0 - t) * first + t * second
            here = damage(np.maximum(even + t * (t - 1.0) * bend, 0.0), worn)
            total += weight * length / parts * here
            if last and node == NODES[1]:
                # Parabola and straight line differ by what the next order would: an estimate.
                missed += length / parts * (here - damage(even, worn))
    # By Euler and Maclaurin the sum over the passes is the integral and half the difference of the
    # ends. Nor may it be less than nothing, where the course is rough.
    total += 0.5 * (end - damage(first, before.worn))
    return np.maximum(total, 0.0), np.abs(missed)


def _order_error(
    one: Followed, later: Followed, order: BlockOrder, length: int, life: Woehler
) -> np.ndarray:
    """Error (n_y, m) of the damage of one pass a revolution by the order of blocks."""
    zeta, depth = one.now.zeta, one.now.depth

    def damage(used: np.ndarray, worn: np.ndarray) -> np.ndarray:
        deep = zeta - worn[:, None]
        return np.where(
            deep >= 0.0,
            life.damage(interpolate_over_depth(depth, used, np.maximum(deep, 0.0))),
            0.0,
        )

    ends = (one.used, later.used), (one.now.worn, later.now.worn)
    return order.damage_error(damage, *ends, length, order.load_factors(one.now.y, depth))


def _between(
    first: np.ndarray, rate: np.ndarray, last: np.ndarray, end: np.ndarray, t: float, length: int
) -> np.ndarray:
    """The cubic through two profiles with their rates, not beyond either."""
    s = 1.0 - t
    cubic = first * s * s * (1.0 + 2.0 * t) + last * t * t * (1.0 + 2.0 * s)
    cubic += length * s * t * (rate * s - end * t)
    return np.clip(cubic, first, last)


def _down(
    depth: np.ndarray, used: np.ndarray, life: Woehler, shares: tuple[float, ...]
) -> np.ndarray:
    """Integral of the damage of a pass over the depth, shape (n_y,), mm."""
    number = np.arange(depth.size)
    between = np.linspace(0, depth.size - 1, CELLS * (depth.size - 1) + 1)
    edges = np.interp(between, number, np.sqrt(depth))  # dz = 2 root d(root)
    widths = np.diff(edges)
    root = (edges[:-1, None] + NODES * widths[:, None]).ravel()
    weights = 2.0 * root * np.outer(widths, WEIGHTS).ravel()
    return _per_pass(life, shares, depth, used, root**2) @ weights


def fatigue_columns(damage: Damage, model: Model) -> dict[str, Any]:
    """Columns of what rolling does to the material of each body."""
    life, shares = model.laws.life, model.weights
    columns = cycle_columns({body: one.now for body, one in damage.bodies.items()})
    if model.laws.volume is not None:
        columns |= _of_volume(damage, model, model.laws.volume)
    for body, one in damage.bodies.items():
        for name, value in one.columns(life, shares).items():
            if name == "balancing_wear":
                columns[f"{name}_{body}"] = value
            else:
                columns.setdefault(name, {})[body] = value
    return columns


def cycle_columns(cycled: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    """Return the columns of utilisation and shakedown, by name and body."""
    left = {body: one.largest("residual_shear") for body, one in cycled.items()}

    def factors(name: str) -> dict[str, float]:
        return {body: one.load_factor(getattr(left[body], name)) for body, one in cycled.items()}

    return _used(cycled) | {
        "shakedown_lower": factors("value"),
        "shakedown_interior": factors("interior"),
        "shakedown_surface": factors("surface"),
        "shakedown_lower_at": {body: one.at for body, one in left.items()},
        "shakedown_upper": {body: one.shakedown_upper for body, one in cycled.items()},
    }


def shakedown_remark(cycled: Mapping[str, BodyFatigue]) -> str:
    """Return the remark on bodies whose stress is above the shakedown limit, or none."""
    factors = {body: one.shakedown_lower for body, one in cycled.items()}
    above = [f"{body} {factor:.2f}" for body, factor in factors.items() if factor < 1.0]
    if not above:
        return ""
    return (
        f"; stress is above the shakedown limit (load factor of body {', of '.join(above)}): the "
        "material yields, and its stress is not this elastic one"
    )


def _of_volume(damage: Damage, model: Model, law: VolumeLife) -> dict[str, Any]:
    """Columns of the life of a volume: of several blocks, lives add up by Miner's rule."""
    survival = model.scene.fatigue.volume.survival
    columns: dict[str, Any] = {"stressed_volume": {}, "volume_life": {}}
    for body, one in damage.bodies.items():
        volumes = [
            stressed_volume(replace(one.now, utilisation=used), model.scene, law)
            for used in one.used
        ]
        lives = [law.life(volume, survival) for volume in volumes]
        used = sum(share / each for share, each in zip(model.weights, lives, strict=True))
        columns["stressed_volume"][body] = float(np.dot(model.weights, volumes))
        columns["volume_life"][body] = 1.0 / (used * (one.passes or 1.0)) if used else math.inf
    return columns | {"volume_at_top": damage.at_the_top(model)}


def stressed_volume(cycled: BodyFatigue, scene: Scene, law: VolumeLife) -> float:
    """Integral of stress over the volume of a body, of a flat one over 1 mm of track."""
    radius = getattr(scene.body, cycled.body).radius_x
    around = 2.0 * math.pi * abs(radius) if math.isfinite(radius) else 1.0
    return law.volume(cycled.y, cycled.depth, cycled.utilisation * scene.fatigue.limit, around)


def volume_bars(
    columns: Mapping[str, Any], bars: Mapping[str, float], law: VolumeLife
) -> dict[str, dict[str, float]]:
    """Error bars of `stressed_volume` and `volume_life`, by that of the mesh; by body.

    Where the mesh decides on the integral, it has no limit.
    """
    told: dict[str, dict[str, float]] = {"stressed_volume": {}, "volume_life": {}}
    for body, volume in columns["stressed_volume"].items():
        bar = math.inf if columns["volume_at_top"][body] > AT_TOP else bars.get(body, math.nan)
        told["stressed_volume"][body] = bar
        if volume > 0.0:
            left = 1.0 - bar / volume
            longer = math.inf if left <= 0.0 else left ** (-1.0 / law.slope) - 1.0
            told["volume_life"][body] = columns["volume_life"][body] * longer
    return told


def life_bars(columns: Mapping[str, Any], bars: Mapping[str, float], life: Woehler) -> dict:
    """Error bars of `fatigue_life` by those of the utilisation: how much longer it is with less.

    The other way it changes by less.
    """
    told = {}
    for body, most in columns["utilisation"].items():
        low, here = life.damage(np.array([most - bars[body], most]))
        if here > 0.0 and not math.isnan(bars[body]):
            longer = here / low - 1.0 if low > 0.0 else math.inf
            told[body] = columns["fatigue_life"][body] * longer
    return told


def _used(cycled: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    used = {body: one.largest() for body, one in cycled.items()}
    return {
        "utilisation": {body: one.value for body, one in used.items()},
        "utilisation_interior": {body: one.interior for body, one in used.items()},
        "utilisation_surface": {body: one.surface for body, one in used.items()},
        "utilisation_at": {body: one.at for body, one in used.items()},
    }
