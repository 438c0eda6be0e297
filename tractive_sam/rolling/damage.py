"""Damage in the material while wear carries it away.

The material of a body keeps its place zeta below the *unworn* surface while the surface comes down
to E(y, N): in revolution N it lies zeta - E deep, and a pass does it the damage d there, by Miner's
rule. Where zeta < E it is gone, and its damage with it:

    D(y, zeta; N) = sum of d(zeta - E(y, n); y, n) over n = 1 ... N while zeta > E.

Records are many revolutions apart. By Euler and Maclaurin the sum over a jump from N_0 to N_1 is
the integral of d dN + (d(N_1) - d(N_0))/2; of a jump of one it is the pass itself. Within a jump E
is the cubic through both profiles and rates, and the utilisation at a depth below the surface is
the parabola through this record and the two before. What a straight line between two of them would
give instead is told as the error.

With steady d(z) and wear w' of a revolution, what reaches the surface has D = integral of d dz/w':
cracks start there if and only if w' is below w'_bal(y) = integral of d dz.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.contact import Laws
from tractive_sam.mechanics import Woehler
from tractive_sam.results import BodyFatigue, widened
from tractive_sam.rolling.passage import Passage
from tractive_sam.subsurface import fatigue

FINE, DEEP, COARSE = 16, 4, 4
"""Steps of the material's grid over the first depth below the surface, which is one element: so
many down to some such depths, and fewer below. Friction makes damage fall to a thousandth within
one element, and what wear brings to the surface has gone through that."""

FARTHEST = 400
"""Most parts of a jump: each wears no more than a fine step, as far as that goes."""

NODES, WEIGHTS = (
    np.array([0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15)]),
    np.array([5, 8, 5]) / 18,
)
"""Quadrature of Gauss on a part."""

WORKS = 0.1
"""Share of the largest balancing wear from which a row counts where wear is compared with it."""


@dataclass(frozen=True, eq=False)
class Followed:
    """The material of one body.

    Attributes
    ----------
    now : BodyFatigue
        The last pass, and the damage so far.
    before : ndarray, shape (n_y, n)
        Utilisation in the record before.
    rate : ndarray, shape (n_y,)
        Depth that a revolution wears off it, mm.
    passes : float
        In a revolution; 0 of a flat body, whose material comes but once.
    initiation : float
        Revolution at which the damage reached 1; nan before.
    error : ndarray, shape (n_y, m)
        Of the damage.
    """

    now: BodyFatigue
    before: np.ndarray
    rate: np.ndarray
    passes: float
    error: np.ndarray
    initiation: float = math.nan

    def columns(self, life: Woehler | None) -> dict[str, Any]:
        """Numbers of a record, by the names of its columns without those of the body."""
        if life is None:
            return {}
        top, at = self.now.damage_max
        each = self.passes or 1.0
        # By the same points as the damage, so that without wear one is the inverse of the other.
        fresh = self.now.with_damage(
            self.now.zeta, each * self._per_pass(life, 0.0), 0.0 * self.rate
        )
        most, _ = fresh.damage_max
        balance = each * _over_depth(self.now, life)
        works = balance > WORKS * balance.max()
        margin = (self.rate[works] / balance[works]).min() if works.any() else math.inf
        return {
            "damage": top,
            "damage_at": at,
            "damage_error": float(self.error[_left(self.now)].max(initial=0.0)),
            "initiation": self.initiation,
            "fatigue_life": 1.0 / most if most > 0.0 else math.inf,
            "wear_margin": float(margin) if self.passes else math.nan,
            "balancing_wear": balance,
        }

    def _per_pass(self, life: Woehler, worn: Any) -> np.ndarray:
        return life.damage(_at(self.now.depth, self.now.utilisation, self.now.zeta - worn))


@dataclass(frozen=True, eq=False)
class Damage:
    """The material of the bodies of a scene with [fatigue], after a number of revolutions.

    Attributes
    ----------
    revolution, earlier : int
        Of the last record and the one before.
    bodies : mapping of str to Followed
        By body.
    """

    revolution: int
    earlier: int
    bodies: Mapping[str, Followed]

    @classmethod
    def begun(cls, passage: Passage, laws: Laws, depths: np.ndarray | None = None) -> "Damage":
        """Undamaged bodies in their first pass."""
        turns, bodies = passage.turns[0], {}
        for body, found in fatigue(passage.contact, depths=depths, laws=laws).items():
            zeta = _below_the_unworn_surface(found.depth)
            none = np.zeros((found.y.size, zeta.size))
            worn, rate = passage.off(body)
            now = found.with_damage(zeta, none, worn)
            bodies[body] = Followed(now, now.utilisation, rate, turns.per_count[body], none)
        return cls(passage.revolution, passage.revolution, bodies)

    def after(self, passage: Passage, laws: Laws) -> "Damage":
        """The same after the passes up to a later passage, on its mesh."""
        elements = passage.contact.grid.elements[1]
        before = {body: _on(one, elements) for body, one in self.bodies.items()}
        depths = next(iter(before.values())).now.depth  # those of all
        found = fatigue(passage.contact, depths=depths, laws=laws)
        jump = passage.revolution - self.revolution, self.revolution - self.earlier
        bodies = {}
        for body, one in before.items():
            worn, rate = passage.off(body)
            bodies[body] = _rolled(one, found[body], worn, rate, jump, laws.life, self.revolution)
        return Damage(passage.revolution, self.revolution, bodies)

    @property
    def warning(self) -> str:
        """Where stress is above the shakedown limit, that it is; else empty."""
        factors = {body: one.now.shakedown_lower for body, one in self.bodies.items()}
        above = [f"{body} {factor:.2f}" for body, factor in factors.items() if factor < 1.0]
        if not above:
            return ""
        return (
            f"; stress is above the shakedown limit (load factor of body {', of '.join(above)}): "
            "elastic as it is, it is not what the material sees"
        )

    @property
    def fields(self) -> tuple[BodyFatigue, ...]:
        """What is kept of it with the fields of a record."""
        return tuple(one.now for one in self.bodies.values())

    @property
    def state(self) -> dict[str, np.ndarray]:
        """What rolling goes on from, beside the columns of the record, by name."""
        return {
            f"{name}_{body}": values
            for body, one in self.bodies.items()
            for name, values in (
                ("depth", one.now.depth),
                ("zeta", one.now.zeta),
                ("damage", one.now.damage),
                ("utilisation", one.now.utilisation),
                ("utilisation_before", one.before),
                ("damage_error", one.error),
            )
        }

    @classmethod
    def restored(
        cls,
        passage: Passage,
        state: Mapping[str, np.ndarray],
        initiation: Mapping[str, float],
        earlier: int,
    ) -> "Damage":
        """As it was after a record.

        Parameters
        ----------
        passage : Passage
            The last one.
        state : mapping of str to ndarray
            As of `state`.
        initiation : mapping of str to float
            As of `Followed`, of each body.
        earlier : int
            Revolution of the record before.

        Raises
        ------
        LookupError
            If something is missing.
        """
        scene, grid = passage.contact.scene, passage.contact.grid
        bodies, k = {}, scene.fatigue.shear_yield_stress
        for body in scene.fatigue.bodies:
            depth, zeta = (state[f"{name}_{body}"] for name in ("depth", "zeta"))
            damage, error, used, before = (
                _wider(state[f"{name}_{body}"], grid.elements[1])
                for name in ("damage", "damage_error", "utilisation", "utilisation_before")
            )
            worn, rate = passage.off(body)
            unknown = np.full(used.shape, np.nan)
            now = BodyFatigue(
                body, grid.y, depth, used, unknown, unknown, None, math.nan if k is None else k
            ).with_damage(zeta, damage, worn)
            bodies[body] = Followed(
                now,
                before,
                rate,
                passage.turns[0].per_count[body],
                error,
                float(initiation[body]),
            )
        return cls(passage.revolution, earlier, bodies)


def _wider(values: np.ndarray, elements: int) -> np.ndarray:
    """Rows (n_y, ...) on a mesh with more of them; nothing has happened there."""
    return widened(values.T, (elements,)).T


def _below_the_unworn_surface(depth: np.ndarray) -> np.ndarray:
    """Places of the material: every depth, and equal steps between them."""
    element = depth[1]
    fine = np.arange(DEEP * FINE) * element / FINE
    coarse = np.arange(DEEP * COARSE, math.ceil(COARSE * depth[-1] / element)) * element / COARSE
    even = np.concatenate((fine, coarse))
    even = even[even < depth[-1]]
    beside = even[np.abs(even[:, None] - depth).min(axis=1) > 0.25 * element / FINE]
    return np.union1d(depth, beside)


def _on(one: Followed, elements: int) -> Followed:
    """The same on a mesh with more rows; nothing has happened there."""
    names = ("damage", "worn", "utilisation")
    now = replace(one.now, **{name: _wider(getattr(one.now, name), elements) for name in names})
    names = ("before", "rate", "error")
    return replace(one, now=now, **{k: _wider(getattr(one, k), elements) for k in names})


def _rolled(
    one: Followed,
    now: BodyFatigue,
    worn: np.ndarray,
    rate: np.ndarray,
    jump: tuple[int, int],
    life: Woehler | None,
    revolution: int,
) -> Followed:
    """The material after a jump; `jump` tells its length and that of the one before."""
    zeta, before = one.now.zeta, one.now
    now = now.with_damage(zeta, before.damage, worn)
    if life is None:
        return replace(one, now=now, before=before.utilisation, rate=rate)
    if not one.passes:  # it comes but once
        single = life.damage(_at(now.depth, now.utilisation, zeta))
        flat = now.with_damage(zeta, np.broadcast_to(single, before.damage.shape), 0.0 * worn)
        return replace(one, now=flat, before=before.utilisation, rate=rate)
    added, straight = _added(one, now, rate, jump, life)
    now = now.with_damage(zeta, before.damage + one.passes * added, worn)
    # Parabola and straight line differ by what the next order would: an estimate, added up.
    error = one.error + one.passes * np.abs(added - straight)
    initiation, (top, _), (was, _) = one.initiation, now.damage_max, before.damage_max
    if math.isnan(initiation) and top >= 1.0:
        initiation = revolution + jump[0] * (1.0 - was) / (top - was)
    return replace(
        one, now=now, before=before.utilisation, rate=rate, initiation=initiation, error=error
    )


def _left(now: BodyFatigue) -> np.ndarray:
    """Where there is material, (n_y, m)."""
    return now.zeta >= now.worn[:, None]


def _added(
    one: Followed, now: BodyFatigue, rate: np.ndarray, jump: tuple[int, int], life: Woehler
) -> tuple[np.ndarray, np.ndarray]:
    """Damage (n_y, m) of one pass a revolution over a jump, by parabola and by straight line."""
    zeta, before, (length, last) = one.now.zeta, one.now, jump

    def damage(utilisation: np.ndarray, worn: np.ndarray) -> np.ndarray:
        deep = zeta - worn[:, None]
        per_pass = life.damage(_at(now.depth, utilisation, np.maximum(deep, 0.0)))
        return np.where(deep >= 0.0, per_pass, 0.0)

    end = damage(now.utilisation, now.worn)
    if length == 1:
        return end, end
    first, second = before.utilisation, now.utilisation
    # Newton's second difference: u = straight line + t (t - 1) bend goes through the record before.
    bend = np.zeros_like(first)
    if last:
        bend = (second - first) * last - (first - one.before) * length
        bend *= length / (last * (length + last))
    # In pieces that each wear off no more than one step of the material: the damage of a place ends
    # where wear takes it away, and no Gauss rule holds across that.
    worn_off = float((now.worn - before.worn).max(initial=0.0))
    parts = int(min(max(1, math.ceil(worn_off * FINE / now.depth[1])), FARTHEST))
    total, straight = np.zeros_like(end), np.zeros_like(end)
    for part in range(parts):
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            t = (part + node) / parts
            worn = _between(before.worn, one.rate, now.worn, rate, t, length)
            even = (1.0 - t) * first + t * second
            bent = np.maximum(even + t * (t - 1.0) * bend, 0.0) if last else even
            total += weight * length / parts * damage(bent, worn)
            if last:
                straight += weight * length / parts * damage(even, worn)
    # By Euler and Maclaurin the sum over the passes is the integral and half the difference of the
    # ends.
    ends = 0.5 * (end - damage(first, before.worn))
    # By neither may the sum be less than nothing, where the course is rough.
    total, straight = np.maximum(total + ends, 0.0), np.maximum(straight + ends, 0.0)
    return total, straight if last else total


def _between(
    first: np.ndarray, rate: np.ndarray, last: np.ndarray, end: np.ndarray, t: float, length: int
) -> np.ndarray:
    """The cubic through two profiles with their rates, not beyond either."""
    s = 1.0 - t
    cubic = first * s * s * (1.0 + 2.0 * t) + last * t * t * (1.0 + 2.0 * s)
    cubic += length * s * t * (rate * s - end * t)
    return np.clip(cubic, first, last)


def _at(depth: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values (n_y, n) at depths, in between by monotone cubics, at others (m,) or (n_y, m)."""
    cubics = scipy.interpolate.PchipInterpolator(depth, values, axis=1).c
    k = np.clip(np.searchsorted(depth, at, side="right") - 1, 0, depth.size - 2)
    row = np.arange(len(values))[:, None]
    k = np.broadcast_to(k, (len(values), k.shape[-1]))
    past = at - depth[k]
    found = cubics[0][k, row]
    for one in cubics[1:]:
        found = found * past + one[k, row]
    return found


def _over_depth(now: BodyFatigue, life: Woehler) -> np.ndarray:
    """Integral of the damage of a pass over the depth, shape (n_y,), mm."""
    edges = _below_the_unworn_surface(now.depth)
    widths = np.diff(edges)
    total = np.zeros(now.y.size)
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        there = life.damage(_at(now.depth, now.utilisation, edges[:-1] + node * widths))
        total += weight * (there @ widths)
    return total


def fatigue_columns(tired: Damage, life: Woehler | None) -> dict[str, Any]:
    """Columns of what rolling does to the material of each body."""
    cycled = {body: one.now for body, one in tired.bodies.items()}
    used = {body: one.largest() for body, one in cycled.items()}
    left = {body: one.largest("residual_shear") for body, one in cycled.items()}

    def factors(of: str) -> dict[str, float]:
        return {body: one.load_factor(getattr(left[body], of)) for body, one in cycled.items()}

    columns: dict[str, Any] = {
        "shakedown_lower": factors("value"),
        "shakedown_interior": factors("interior"),
        "shakedown_surface": factors("surface"),
        "shakedown_lower_at": {body: one.at for body, one in left.items()},
        "shakedown_upper": {body: one.shakedown_upper for body, one in cycled.items()},
        "utilisation": {body: one.value for body, one in used.items()},
        "utilisation_interior": {body: one.interior for body, one in used.items()},
        "utilisation_surface": {body: one.surface for body, one in used.items()},
        "utilisation_at": {body: one.at for body, one in used.items()},
    }
    for body, one in tired.bodies.items():
        for name, value in one.columns(life).items():
            if name == "balancing_wear":
                columns[f"{name}_{body}"] = value
            else:
                columns.setdefault(name, {})[body] = value
    return columns
