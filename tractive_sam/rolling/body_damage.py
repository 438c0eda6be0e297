"""Damage of material that wear removes.

The material of a body stays at its depth zeta below the *unworn* surface while the surface recedes
to E(y, N): in revolution N it lies zeta - E deep, and a pass adds the damage d there, by Miner's
rule. If zeta < E the material and its damage are removed:

    D(y, zeta; N) = sum of d(zeta - E(y, n); y, n) over n = 1 ... N while zeta > E.

Records are many revolutions apart. By Euler and Maclaurin the sum over a jump from N_0 to N_1 is
the integral of d dN + (d(N_1) - d(N_0))/2; for a jump of one it is the pass. Within a jump E is the
cubic through both profiles and rates, and the utilisation at a depth below the surface is the
parabola through this record and the two before. The difference from a straight line between two
records is reported as the error, and jumps become shorter if it is too large.

In a duty cycle d is the mean over the revolutions of all blocks, and in a revolution of one block
the damage of the block. The order of the blocks adds to the error of this mean
(`rolling.block_order`).

With steady d(z) and wear w' of a revolution, material that reaches the surface has D = integral of
d dz/w': cracks start there if and only if w' is below w'_bal(y) = integral of d dz.
"""

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from tractive_sam.mechanics import Woehler, interpolate_over_depth
from tractive_sam.results import BodyFatigue, widen_field
from tractive_sam.rolling.block_order import BlockOrder

WORN, FINE, GROWTH, COARSE = 0.2, 180, 1.05, 0.25
"""Depth, over the semi-axis a, down to which material depths are squares of their number: the
stress falls with the root of the depth from the surface, and a surface with little wear is still
resolved. Number of these depths; factor by which distances grow further down, and their bound over
the first depth below the surface, which is one element."""

NODES, WEIGHTS = (
    np.array([0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15)]),
    np.array([5, 8, 5]) / 18,
)
"""Quadrature of Gauss on a part."""


@dataclass(frozen=True, eq=False)
class BodyDamage:
    """Accumulated fatigue damage of the material of one body, and its error.

    Attributes
    ----------
    fatigue : BodyFatigue
        The last passes, and the damage so far.
    utilisation, utilisation_before : ndarray, shape (blocks, n_y, n)
        Utilisation in each block, in this record and in the one before.
    rate : ndarray, shape (n_y,)
        Depth that a revolution wears off it, mm.
    passes : float
        Passes in a revolution; 0 for a flat body: its material passes the contact once.
    error : ndarray, shape (n_y, m)
        Error of the damage.
    initiation : float
        Revolution at which the damage reached 1; nan before.
    missed : float
        Error that the last jump added, over the largest damage.
    offset : ndarray, shape (n_y,), optional
        Depth that the blocks of a duty cycle in their order have worn off it, minus the depth worn
        by their mean, mm; None for a single load.
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

    near_largest: ClassVar[float] = 0.9
    """Damage, over the largest one, from which its error makes jumps shorter."""

    @property
    def damage_error(self) -> float:
        """Estimated error of the largest damage.

        In a duty cycle the error is large just below the surface; the damage may be largest
        elsewhere. So the largest damage is found for more and for less damage everywhere, also at
        the wear depth of the blocks in their order.
        """
        fatigue, error = self.fatigue, self.error
        if self.offset is None:
            return float(error[_remaining(fatigue)].max(initial=0.0))
        top, _ = fatigue.damage_max
        bounds = (
            fatigue.with_damage(fatigue.zeta, np.maximum(fatigue.damage + sign * error, 0.0), worn)
            for worn in (fatigue.worn, np.maximum(fatigue.worn + self.offset, 0.0))
            for sign in (-1.0, 1.0)
        )
        return max(abs(bound.damage_max[0] - top) for bound in bounds)

    def path_error(self, life: Woehler) -> float:
        """Return the error of the largest damage that the sampling of stress paths causes.

        It is systematic and does not depend on the length of jumps.
        """
        criterion = self.fatigue.criterion
        error = 0.0 if criterion is None else criterion.path_error
        return self.fatigue.damage_max[0] * life.relative_error(error)

    def columns(self, life: Woehler | None, shares: tuple[float, ...] = (1.0,)) -> dict[str, Any]:
        """Return the values of the body's damage columns by name; empty without a `life` law."""
        if life is None:
            return {}
        fatigue, used, each = self.fatigue, self.utilisation, self.passes or 1.0
        top, at = fatigue.damage_max
        # At the depths of the damage, so that without wear the life is the inverse of the damage.
        new = each * _per_pass(life, shares, fatigue.depth, used, fatigue.zeta)
        largest, _ = fatigue.with_damage(fatigue.zeta, new, 0.0 * self.rate).damage_max
        balance = each * _integrate_damage(fatigue.depth, used, life, shares)
        works = balance > 0.1 * balance.max()  # rows with little damage have any margin
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


def _per_pass(
    life: Woehler, shares: tuple[float, ...], depth: np.ndarray, used: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """Return the damage (n_y, m) per pass at the depths `at`, the weighted sum over blocks."""
    each = zip(shares, used, strict=True)
    parts = [
        share * life.damage(interpolate_over_depth(depth, block, at))
        for share, block in each
        if share
    ]
    return np.sum(parts, axis=0)


def widen_rows(values: np.ndarray, elements: int) -> np.ndarray:
    """Return rows (..., n_y, n) extended to a wider mesh; the new rows have zero damage."""
    return widen_field(values, (elements, values.shape[-1]))


def material_depths(depth: np.ndarray, fine: float) -> np.ndarray:
    """Return depths at which damage is stored, mm: `depth` and finer ones near the surface."""
    places = list(fine * np.linspace(0.0, 1.0, FINE) ** 2)
    step = places[-1] - places[-2]
    while places[-1] < depth[-1]:
        step = max(step, min(GROWTH * step, COARSE * depth[1]))
        places.append(places[-1] + step)
    even = np.array([place for place in places if place < depth[-1]])
    between = even[np.abs(even[:, None] - depth).min(axis=1) > 1e-6 * depth[1]]
    return np.union1d(depth, between)


def widen_body(damage: BodyDamage, y: np.ndarray) -> BodyDamage:
    """Return the damage of a body extended to a wider mesh; the new rows are undamaged."""
    fatigue = damage.fatigue
    fatigue = replace(
        fatigue,
        y=y,
        worn=widen_field(fatigue.worn, y.shape),
        damage=widen_rows(fatigue.damage, y.size),
        utilisation=widen_rows(fatigue.utilisation, y.size),
    )
    names = ("utilisation", "utilisation_before", "error")
    rows: dict[str, Any] = {k: widen_rows(getattr(damage, k), y.size) for k in names}
    return replace(damage, fatigue=fatigue, rate=widen_field(damage.rate, y.shape), **rows)


def after_jump(
    last: BodyDamage,
    fatigue: BodyFatigue,
    used: np.ndarray,
    worn: np.ndarray,
    rate: np.ndarray,
    shares: tuple[float, ...],
    jump: tuple[int, int],
    life: Woehler | None,
    revolution: int,
    order: BlockOrder | None = None,
) -> BodyDamage:
    """Return the damage of a body after a jump of revolutions; `jump` is (this length, last)."""
    zeta, before = last.fatigue.zeta, last.fatigue
    fatigue = fatigue.with_damage(zeta, before.damage, worn)
    offset = None if order is None else order.offset
    later = replace(last, utilisation=used, utilisation_before=last.utilisation, rate=rate)
    later = replace(later, fatigue=fatigue, missed=0.0, offset=offset)
    if life is None:
        return later
    if not last.passes:  # a flat body passes the contact only once
        each = [life.damage(interpolate_over_depth(fatigue.depth, block, zeta)) for block in used]
        return replace(later, fatigue=fatigue.with_damage(zeta, np.max(each, axis=0), 0.0 * worn))
    added, missed = _damage_of_jump(last, later, shares, jump, life)
    fatigue = fatigue.with_damage(zeta, before.damage + last.passes * added, worn)
    missed *= last.passes
    initiation, (top, _), (was, _) = last.initiation, fatigue.damage_max, before.damage_max
    if math.isnan(initiation) and top >= 1.0:
        initiation = revolution + jump[0] * (1.0 - was) / (top - was)
    # At the material depths: the extrapolated damage at the surface may exceed all of them.
    remaining = np.where(_remaining(fatigue), fatigue.damage, 0.0)
    near = remaining >= BodyDamage.near_largest * remaining.max()
    largest = float(missed[near].max(initial=0.0))
    if order is not None:  # shorter jumps do not reduce this error
        missed = missed + last.passes * _block_order_error(last, later, order, jump[0], life)
    return replace(
        later,
        fatigue=fatigue,
        initiation=initiation,
        error=last.error + missed,
        missed=largest / top if top > 0.0 else 0.0,
    )


def _remaining(fatigue: BodyFatigue) -> np.ndarray:
    """Return a mask (n_y, m) of the material points that are not worn off."""
    return fatigue.zeta >= fatigue.worn[:, None]


def _remaining_damage(
    fatigue: BodyFatigue,
    life: Woehler,
    shares: tuple[float, ...],
    used: np.ndarray,
    worn: np.ndarray,
) -> np.ndarray:
    """Return the damage (n_y, m) per pass of the material points; 0 of those worn off."""
    deep = fatigue.zeta - worn[:, None]
    per_pass = _per_pass(life, shares, fatigue.depth, used, np.maximum(deep, 0.0))
    return np.where(deep >= 0.0, per_pass, 0.0)


def _damage_of_jump(
    previous: BodyDamage,
    later: BodyDamage,
    shares: tuple[float, ...],
    jump: tuple[int, int],
    life: Woehler,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the damage (n_y, m) of one pass per revolution over a jump, and its error."""
    before, after, (length, last) = previous.fatigue, later.fatigue, jump
    damage = partial(_remaining_damage, before, life, shares)
    end = damage(later.utilisation, after.worn)
    if length == 1:
        return end, np.zeros_like(end)
    first, second = previous.utilisation, later.utilisation
    # Newton's second difference: u = straight line + t (t - 1) bend goes through the record before.
    bend = np.zeros_like(first)
    if last:
        bend = (second - first) * last - (first - previous.utilisation_before) * length
        bend *= length / (last * (length + last))
    # One part for each material depth that the fastest row loses: the damage of material ends
    # when wear removes it, and no Gauss rule holds across that. More than 400 take too long.
    steps = np.searchsorted(before.zeta, after.worn) - np.searchsorted(before.zeta, before.worn)
    parts = int(min(max(1, steps.max()), 400))
    total, missed = np.zeros_like(end), np.zeros_like(end)
    ends = before.worn, previous.rate, after.worn, later.rate
    for part in range(parts):
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            t = (part + node) / parts
            worn = _interpolate_profile(*ends, t, length)
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
    """Return the damage error (n_y, m) of a jump that rolls the mean of the blocks."""
    before = previous.fatigue

    def damage(used: np.ndarray, worn: np.ndarray) -> np.ndarray:
        return _remaining_damage(before, life, (1.0,), used[None], worn)

    ends = (previous.utilisation, later.utilisation), (before.worn, later.fatigue.worn)
    factors = order.load_factors(before.y, before.depth)
    return order.damage_error(damage, *ends, revolutions, factors)


def _interpolate_profile(
    first: np.ndarray, rate: np.ndarray, last: np.ndarray, end: np.ndarray, t: float, length: int
) -> np.ndarray:
    """Return the profile at the time t of a jump, by a cubic through both ends and their rates."""
    s = 1.0 - t
    cubic = first * s * s * (1.0 + 2.0 * t) + last * t * t * (1.0 + 2.0 * s)
    cubic += length * s * t * (rate * s - end * t)
    return np.clip(cubic, first, last)


def _integrate_damage(
    depth: np.ndarray, used: np.ndarray, life: Woehler, shares: tuple[float, ...]
) -> np.ndarray:
    """Return the integral of the damage per pass over the depth, shape (n_y,), mm."""
    number, cells = np.arange(depth.size), 8  # between two depths
    between = np.linspace(0, depth.size - 1, cells * (depth.size - 1) + 1)
    edges = np.interp(between, number, np.sqrt(depth))  # dz = 2 root d(root)
    widths = np.diff(edges)
    root = (edges[:-1, None] + NODES * widths[:, None]).ravel()
    weights = 2.0 * root * np.outer(widths, WEIGHTS).ravel()
    return _per_pass(life, shares, depth, used, root**2) @ weights
