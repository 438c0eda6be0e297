"""Damage of material that wear removes: over blocks in their order, and its columns.

In the mean every revolution of a cycle of n has the damage sum of w_b d_b, w_b = n_b/n. In its
order a block b does all of its damage at one time of the cycle, tau_b revolutions after the middle,
and at the wear of that time, e_b more than in the mean:

    sum over a jump of w_b (tau_b d(d_b)/dN + (d_b(zeta - E - e_b; E + e_b) - d_b(zeta - E; E))),

by Taylor in tau_b. The first term adds up to the change of the damage of a pass: it does not grow
with the number of cycles. The second term is proportional to the wear of a cycle, and has two
causes. The material lies e_b less deep. And rows that are worn more carry less load, by J_b e_b of
their wear in a pass with the response J_b (`rolling.passage`), which changes the stress.

For that reason a cycle also wears another profile than its mean: the difference eps obeys

    d(eps)/dN = J eps + c,    J = sum of w_b J_b,    c = sum of w_b J_b e_b,

and its short waves settle at -J^-1 c within tens of revolutions. It adds to every e_b.

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
(`rolling.body_damage`).

With steady d(z) and wear w' of a revolution, material that reaches the surface has D = integral of
d dz/w': cracks start there if and only if w' is below w'_bal(y) = integral of d dz.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.mechanics import Steel, VolumeLife, Woehler, interpolate_over_depth
from tractive_sam.results import BodyFatigue, State, widen_field
from tractive_sam.scene import Fatigue, Scene, Spectrum
from tractive_sam.schema import required
from tractive_sam.subsurface import LocalSteel


@dataclass(frozen=True, eq=False)
class BlockOrder:
    """Effect of the order of blocks within a duty cycle on the wear of one body.

    Attributes
    ----------
    shares : ndarray, shape (blocks,)
        Share of each block in the revolutions of a cycle.
    delay : ndarray, shape (blocks,)
        Mean time of each block after the middle of the cycle, revolutions.
    wear : ndarray, shape (blocks, n_y)
        Mean depth worn off by then, minus the depth in a cycle with constant wear, mm.
    loads, changes : ndarray, shape (blocks, n_y), optional
        Load of each row in each block, and its change by the wear of the order, both as depth that
        a pass wears, mm. None: loads do not change.
    offset : ndarray, shape (n_y,)
        Depth worn off before the last revolution, minus the depth in a cycle with constant wear,
        mm.
    ahead : ndarray, shape (blocks,)
        Largest difference, at any time of a cycle, between the revolutions of each block so far and
        those of the mean.
    """

    shares: np.ndarray
    delay: np.ndarray
    wear: np.ndarray
    offset: np.ndarray
    ahead: np.ndarray
    loads: np.ndarray | None = None
    changes: np.ndarray | None = None

    @classmethod
    def from_spectrum(
        cls, spectrum: Spectrum, rates: np.ndarray, revolution: int = 1
    ) -> "BlockOrder":
        """Return the effect of the block order on wear, from the wear rate of each block.

        Parameters
        ----------
        spectrum : Spectrum
            The blocks.
        rates : ndarray, shape (blocks, n_y)
            Wear of a revolution of each block, mm.
        revolution : int
            Last revolution.
        """
        shares = np.array(spectrum.revolutions) / spectrum.cycle
        uneven = rates - np.tensordot(shares, rates, axes=1)
        delay, wear = np.zeros(shares.size), np.zeros(rates.shape)
        rolled, ahead = np.zeros(shares.size), np.zeros(shares.size)
        start, worn, place = 0.0, np.zeros(rates.shape[1]), (revolution - 1) % spectrum.cycle
        offset = worn
        for count, block in zip(spectrum.each, spectrum.places, strict=True):
            # Mean over the revolutions of the block, each with the wear before it.
            part, middle = count / spectrum.revolutions[block], 0.5 * (count - 1)
            delay[block] += part * (start + middle - 0.5 * (spectrum.cycle - 1))
            wear[block] += part * (worn + middle * uneven[block])
            if start <= place < start + count:
                offset = worn + (place - start) * uneven[block]
            start, worn = start + count, worn + count * uneven[block]
            rolled[block] += count
            ahead = np.maximum(ahead, abs(rolled - start * shares))
        return cls(shares, delay, wear, offset, ahead)

    def drift(self, responses: Sequence[np.ndarray], revolution: int) -> np.ndarray:
        """Return the worn profile minus the profile that the mean of the blocks would wear, mm.

        Parameters
        ----------
        responses : sequence of ndarray, shape (n_y, n_y)
            Response of the wear of a revolution of each block to the profile, 1/revolution.
        revolution : int
            Revolutions since both profiles were equal.
        """
        blocks = list(zip(self.shares, responses, self.wear, strict=True))
        source = sum(share * response @ wear for share, response, wear in blocks)
        mean = sum(share * response for share, response, _ in blocks)
        # One step of the implicit Euler formula: first t c, finally -J^-1 c.
        return np.linalg.solve(np.eye(source.size) / revolution - mean, source)

    def load_factors(
        self, y: np.ndarray, depth: np.ndarray, negligible: float = 1e-9
    ) -> np.ndarray:
        """Return factors, 0 to 2, by which the block order changes stress, (blocks, n_y, n).

        At a depth z the loads of the rows around count by the pressure below a line load on an
        elastic half-space, 2/pi z^3/(y^2 + z^2)^2; at the surface only the row itself counts.

        Parameters
        ----------
        y, depth : ndarray, shapes (n_y,) and (n,)
            Rows, equally spaced, and depths, mm.
        negligible : float
            Load over the largest one below which its relative change is ignored.
        """
        factors = np.ones((self.shares.size, y.size, depth.size))
        if self.loads is None:
            return factors
        for k, z in enumerate(depth):
            spread = _spread(y, z)
            load, change = self.loads @ spread, self.changes @ spread
            loaded = load > negligible * self.loads.max(axis=1, keepdims=True)
            factors[:, :, k] += np.divide(change, load, out=np.zeros_like(load), where=loaded)
        return np.clip(factors, 0.0, 2.0)

    def damage_error(
        self,
        damage: Callable[[np.ndarray, np.ndarray], np.ndarray],
        used: tuple[np.ndarray, np.ndarray],
        worn: tuple[np.ndarray, np.ndarray],
        length: int,
        factors: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return the error of damage over a jump that rolls the mean of the blocks, (n_y, m).

        It is the absolute value of the sum of all blocks plus the absolute values of each block:
        they may not cancel, and elements that come into contact or begin to slip change more than
        loads do.

        Parameters
        ----------
        damage : callable
            Damage (n_y, m) of a pass in the material, from utilisation (n_y, n) and the worn
            depth (n_y,), mm.
        used : tuple of ndarray, shape (blocks, n_y, n)
            Utilisation in each block at both ends of the jump.
        worn : tuple of ndarray, shape (n_y,)
            Depth worn off at both ends, mm.
        length : int
            Revolutions of the jump.
        factors : ndarray, shape (blocks, n_y, n), optional
            From `load_factors`; by default loads do not change.
        """
        middle = 0.5 * (worn[0] + worn[1])
        factors = np.ones((self.shares.size, 1, 1)) if factors is None else factors
        total, separate = np.zeros(1), np.zeros(1)
        for b, share in enumerate(self.shares):
            change = damage(used[1][b], worn[1]) - damage(used[0][b], worn[0])
            mean = 0.5 * (used[0][b] + used[1][b])
            shifted = damage(mean * factors[b], middle + self.wear[b]) - damage(mean, middle)
            error = share * (self.delay[b] * change + length * shifted)
            total, separate = total + error, separate + abs(error)
        return abs(total) + separate

    def switch_error(
        self, damage: Callable[[np.ndarray], np.ndarray], used: np.ndarray
    ) -> np.ndarray:
        """Return the error of damage if rows of elements come into another state, (n_y, m).

        When an edge of the contact or of the stick area crosses a row, the row gets the stress of
        its neighbour at once, and the damage of a block changes by a factor. From then on, the
        mean counts up to `ahead` more or fewer revolutions of the block than there are in order.
        This is the error of one such change; it does not grow with the number of cycles.

        Parameters
        ----------
        damage : callable
            Damage (n_y, m) of a pass in the material, from utilisation (n_y, n).
        used : ndarray, shape (blocks, n_y, n)
            Utilisation in each block.
        """
        error = np.zeros(1)
        for ahead, block in zip(self.ahead, used, strict=True):
            own, padded = damage(block), np.pad(block, ((1, 1), (0, 0)), "edge")
            others = (abs(damage(other) - own) for other in (padded[:-2], padded[2:]))
            error = error + ahead * np.maximum(*others)
        return error


def block_orders(
    spectrum: Spectrum, rates: np.ndarray, responses: Sequence[np.ndarray], revolution: int
) -> tuple[BlockOrder, ...]:
    """Return the `BlockOrder` of body A and of body B, with its effect on wear and row loads.

    Parameters
    ----------
    spectrum : Spectrum
        The blocks.
    rates : ndarray, shape (blocks, 2, n_y)
        Wear of each body in a revolution of each block, mm.
    responses : sequence of ndarray, shape (n_y, n_y)
        Response of the wear of both bodies in each block to their total profile, 1/revolution.
    revolution : int
        Last revolution, at least 1.
    """
    loads = rates.sum(axis=1)
    both = BlockOrder.from_spectrum(spectrum, loads, revolution)
    drift = both.drift(responses, revolution)
    each = zip(responses, both.wear, strict=True)
    changes = np.array([block @ (wear + drift) for block, wear in each])
    mean = np.tensordot(both.shares, loads, axes=1)
    orders = []
    for body in range(rates.shape[1]):
        order = BlockOrder.from_spectrum(spectrum, rates[:, body], revolution)
        of_body = np.tensordot(order.shares, rates[:, body], axes=1)
        part = drift * np.divide(of_body, mean, out=np.zeros_like(mean), where=mean > 0.0)
        wear, offset = order.wear + part, order.offset + part
        orders.append(replace(order, wear=wear, offset=offset, loads=loads, changes=changes))
    return tuple(orders)


def _spread(y: np.ndarray, z: float) -> np.ndarray:
    """Return the influence (n_y, n_y) of the load of each row on the pressure below each row."""
    if z == 0.0 or y.size == 1:
        return np.eye(y.size)

    def integral(at: np.ndarray) -> np.ndarray:
        return (z * at / (z**2 + at**2) + np.arctan(at / z)) / np.pi

    distance, half = y[:, None] - y, 0.5 * (y[1] - y[0])
    return integral(distance + half) - integral(distance - half)


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
        Profiles of the utilisation in each block, in this record and in the one before
        (`Steel.stack`).
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
    switch : ndarray, shape (n_y, m), or float
        Error of the damage if a row of elements comes into another state within this cycle.
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
    switch: np.ndarray | float = 0.0

    near_largest: ClassVar[float] = 0.9
    """Damage, over the largest one, from which its error makes jumps shorter."""

    @classmethod
    def from_state(
        cls,
        state: Mapping[str, np.ndarray],
        contact: State,
        body: str,
        depths: tuple[np.ndarray, np.ndarray],
        passes: float,
        initiation: float,
    ) -> Self:
        """Return the damage of a body from its stored `state`, to resume from.

        Parameters
        ----------
        state : mapping of str to ndarray
            By name with the body, also of files of earlier versions.
        contact : State
            The contact of the record.
        body : str
            "A" or "B".
        depths : (ndarray, ndarray), shape (n_y,)
            Depth worn off the body, and in a revolution, mm.
        passes, initiation : float
            See `BodyDamage`.
        """
        (worn, rate), grid, layer = depths, contact.grid, state.get(f"local_layer_{body}")
        depth, zeta = (state[f"{name}_{body}"] for name in ("depth", "zeta"))
        damage, error, used, before = (
            widen_rows(state[f"{name}_{body}"], grid.elements[1])
            for name in ("damage", "damage_error", "utilisation", "utilisation_before")
        )
        missing = np.full(used.shape[1:], np.nan)  # in files of earlier versions
        shear, radius = (
            widen_rows(state.get(f"{name}_{body}", missing), grid.elements[1])
            for name in ("residual_shear", "path_radius")
        )
        local = LocalSteel.from_contact(contact, body, depth, worn, None, layer)
        steel, about = local.steel, (None, local.common_yield)
        if steel.common_limit is not None and used.shape[-1] < steel.profiles * depth.size:
            # Earlier versions stored one profile for all layers.
            used, before = (
                steel.stack(depth, values * (local.limit / steel.common_limit), local.layer)
                for values in (used, before)
            )
        fatigue = BodyFatigue(body, grid.y, depth, used[0], shear, radius, *about, **local.fields())
        fatigue = fatigue.with_damage(zeta, damage, worn)
        restored = cls(fatigue, used, before, rate, passes, error, initiation)
        largest = restored.blocks.max(axis=0)
        return replace(restored, fatigue=replace(fatigue, utilisation=largest))

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Damage, utilisation, shakedown stresses and depths, by name with body: `from_state`."""
        names = "depth", "zeta", "damage", "residual_shear", "path_radius", "local_layer"
        arrays = {name: getattr(self.fatigue, name) for name in names} | {
            "utilisation": self.utilisation,
            "utilisation_before": self.utilisation_before,
            "damage_error": self.error,
        }
        return {f"{k}_{self.fatigue.body}": array for k, array in arrays.items() if array.size}

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
        more = fatigue.damage + error + self.switch
        # Positive, as damage_max extrapolates to the surface by logarithms.
        less = np.divide(fatigue.damage**2, more, out=np.zeros_like(more), where=more > 0.0)
        bounds = (
            fatigue.with_damage(fatigue.zeta, damage, worn)
            for worn in (fatigue.worn, np.maximum(fatigue.worn + self.offset, 0.0))
            for damage in (less, more)
        )
        return max(abs(bound.damage_max[0] - top) for bound in bounds)

    def path_error(self, life: Woehler) -> float:
        """Return the error of the largest damage that the sampling of stress paths causes.

        It is systematic and does not depend on the length of jumps.
        """
        criterion, steel = self.fatigue.criterion, self.fatigue.steel
        error = 0.0 if criterion is None else criterion.path_error
        top, at = self.fatigue.damage_max
        return top * steel.life(float(steel.layer_at(at[2])), life).relative_error(error)

    @property
    def blocks(self) -> np.ndarray:
        """Utilisation in each block at the depths of the cycle, (blocks, n_y, n)."""
        fatigue, steel = self.fatigue, self.fatigue.steel
        used = np.split(self.utilisation, steel.profiles, axis=-1)
        zeta = fatigue.worn[:, None] + fatigue.depth
        return steel.utilisation(used, zeta, fatigue.local_layer.astype(int))

    def columns(self, life: Woehler | None, shares: tuple[float, ...] = (1.0,)) -> dict[str, Any]:
        """Return the values of the body's damage columns by name; empty without a `life` law."""
        if life is None:
            return {}
        fatigue, used, each = self.fatigue, self.utilisation, self.passes or 1.0
        top, at = fatigue.damage_max
        # At the depths of the damage, so that without wear the life is the inverse of the damage.
        steel, below = fatigue.steel, fatigue.zeta + fatigue.worn[:, None]
        new = each * _per_pass(fatigue, life, shares, used, fatigue.zeta, below)
        unworn = fatigue.with_damage(fatigue.zeta, new, 0.0 * self.rate)
        largest, weakest = unworn.largest_damage(steel.layer_at(below))
        row = int(np.argmin(abs(fatigue.y - weakest[1])))
        balance = each * _integrate_damage(fatigue, used, life, shares)
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
        } | layer_column(steel, weakest[2] + fatigue.worn[row])


def layer_column(steel: Steel, zeta: float) -> dict[str, float]:
    """Return the column of the layer that fails first, at a depth below the unworn surface, mm.

    It is empty without layers, and nan where there is no damage.
    """
    layer = math.nan if math.isnan(zeta) else float(steel.layer_at(zeta))
    return {"failing_layer": layer} if steel.is_layered else {}


def pass_damage(
    fatigue: BodyFatigue, life: Woehler, used: np.ndarray, at: np.ndarray, zeta: np.ndarray
) -> np.ndarray:
    """Return the damage (n_y, m) of a pass, in each layer by its stress, limit and curve.

    Parameters
    ----------
    fatigue : BodyFatigue
        The body, with the depths of `used`.
    life : Woehler
        Wöhler curve of a body without layers.
    used : ndarray, shape (n_y, profiles n)
        Profiles of the utilisation (`Steel.stack`).
    at, zeta : ndarray, shape (m,) or (n_y, m)
        Depths below the present and below the unworn surface, mm.
    """
    steel, depth = fatigue.steel, fatigue.depth
    layer = steel.layer_at(zeta)
    parts = (used[:, k : k + depth.size] for k in range(0, used.shape[1], depth.size))
    profiles = [interpolate_over_depth(depth, part, at) for part in parts]
    return steel.damage(steel.utilisation(profiles, zeta, layer), layer, life)


def _per_pass(
    fatigue: BodyFatigue,
    life: Woehler,
    shares: tuple[float, ...],
    used: np.ndarray,
    at: np.ndarray,
    zeta: np.ndarray,
) -> np.ndarray:
    """Return the damage (n_y, m) per pass (`pass_damage`), the weighted sum over blocks."""
    each = zip(shares, used, strict=True)
    parts = [share * pass_damage(fatigue, life, block, at, zeta) for share, block in each if share]
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
        each = [pass_damage(fatigue, life, block, zeta, zeta) for block in used]
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
        damage = partial(_damage_of_block, later.fatigue, life)
        later = replace(later, switch=last.passes * order.switch_error(damage, used))
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
    per_pass = _per_pass(fatigue, life, shares, used, np.maximum(deep, 0.0), fatigue.zeta)
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


def _damage_of_block(
    fatigue: BodyFatigue, life: Woehler, used: np.ndarray, worn: np.ndarray | None = None
) -> np.ndarray:
    """Return the damage (n_y, m) of a pass of one block, by default at the present worn depth."""
    worn = fatigue.worn if worn is None else worn
    return _remaining_damage(fatigue, life, (1.0,), used[None], worn)


def _block_order_error(
    previous: BodyDamage, later: BodyDamage, order: BlockOrder, revolutions: int, life: Woehler
) -> np.ndarray:
    """Return the damage error (n_y, m) of a jump that rolls the mean of the blocks."""
    before = previous.fatigue
    damage = partial(_damage_of_block, before, life)
    ends = (previous.utilisation, later.utilisation), (before.worn, later.fatigue.worn)
    factors = order.load_factors(before.y, before.depth)
    factors = np.tile(factors, previous.utilisation.shape[-1] // before.depth.size)
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
    fatigue: BodyFatigue, used: np.ndarray, life: Woehler, shares: tuple[float, ...]
) -> np.ndarray:
    """Return the integral of the damage per pass over the depth, shape (n_y,), mm."""
    depth = fatigue.depth
    number, cells = np.arange(depth.size), 8  # between two depths
    between = np.linspace(0, depth.size - 1, cells * (depth.size - 1) + 1)
    edges = np.interp(between, number, np.sqrt(depth))  # dz = 2 root d(root)
    widths = np.diff(edges)
    root = (edges[:-1, None] + NODES * widths[:, None]).ravel()
    weights = 2.0 * root * np.outer(widths, WEIGHTS).ravel()
    zeta = fatigue.worn[:, None] + root**2
    return _per_pass(fatigue, life, shares, used, root**2, zeta) @ weights


AT_TOP = 0.9
"""`VolumeLife.surface_density_ratio` above which the life of a volume depends on the mesh."""


def fatigue_columns(bodies: Mapping[str, BodyDamage], model: Model) -> dict[str, Any]:
    """Return all fatigue columns of a record, values by name and body."""
    life, shares = model.laws.life, model.weights
    columns = cycle_columns({body: part.fatigue for body, part in bodies.items()})
    if model.laws.volume is not None:
        columns |= _volume_columns(bodies, model, model.laws.volume)
    for body, part in bodies.items():
        for name, value in part.columns(life, shares).items():
            if name == "balancing_wear":
                columns[f"{name}_{body}"] = value
            else:
                columns.setdefault(name, {})[body] = value
    return columns


def cycle_columns(cycles: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    """Return the columns of utilisation and shakedown, values by name and body."""
    residual = {body: cycle.largest("residual_shear") for body, cycle in cycles.items()}

    def factors(name: str) -> dict[str, float]:
        return {k: cycle.load_factor(getattr(residual[k], name)) for k, cycle in cycles.items()}

    inverse = {
        body: cycle.largest("inverse_yield_factor").value
        for body, cycle in cycles.items()
        if cycle.inverse_yield_factor.size
    }
    with np.errstate(divide="ignore"):
        yields = {body: float(1.0 / np.float64(value)) for body, value in inverse.items()}
    layers = {body: _find_layer(cycle) for body, cycle in cycles.items() if cycle.local_layer.size}
    return (
        utilisation_columns(cycles)
        | ({"utilisation_layer": layers} if layers else {})
        | ({"yield_factor": yields} if yields else {})
        | {
            "shakedown_lower": factors("value"),
            "shakedown_interior": factors("interior"),
            "shakedown_surface": factors("surface"),
            "shakedown_lower_at": {body: maximum.at for body, maximum in residual.items()},
            "shakedown_upper": {body: cycle.shakedown_upper for body, cycle in cycles.items()},
        }
    )


def _find_layer(cycle: BodyFatigue) -> float:
    """Return the number of the layer with the largest utilisation; nan without a limit."""
    _, y, depth = cycle.largest().at
    if math.isnan(depth):
        return math.nan
    return float(cycle.local_layer[abs(cycle.y - y).argmin(), abs(cycle.depth - depth).argmin()])


def shakedown_remark(cycles: Mapping[str, BodyFatigue]) -> str:
    """Return a remark on bodies loaded above the shakedown limit; empty if there are none."""
    factors = {body: cycle.shakedown_lower for body, cycle in cycles.items()}
    above = [f"{body} {factor:.2f}" for body, factor in factors.items() if factor < 1.0]
    if not above:
        return ""
    return (
        f"; stress is above the shakedown limit (load factor of body {', of '.join(above)}): the "
        "material yields, and this elastic stress is not its stress"
    )


def damage_remark(cycles: Mapping[str, BodyFatigue]) -> str:
    """Return a remark on bodies with a damage that no life can have; empty if there are none."""
    damages = {body: cycle.damage_max[0] for body, cycle in cycles.items()}
    above = [f"{body} {top:.3g}" for body, top in damages.items() if top > Woehler.max_per_cycle]
    if not above:
        return ""
    return (
        f"; damage of body {', of '.join(above)}: its stress is so far above the limit that the "
        "Wöhler curve gives no life, and the first pass starts a crack"
    )


def _volume_columns(
    bodies: Mapping[str, BodyDamage], model: Model, law: VolumeLife
) -> dict[str, Any]:
    """Return the columns of stressed volume and its life; blocks add up by Miner's rule."""
    survival = required(_table(model.scene).volume, "fatigue.volume").survival
    columns: dict[str, Any] = {"stressed_volume": {}, "volume_life": {}}
    for body, part in bodies.items():
        volumes = [
            stressed_volume(replace(part.fatigue, utilisation=used), model.scene, law)
            for used in part.blocks
        ]
        lives = [law.life(volume, survival) for volume in volumes]
        used = sum(share / each for share, each in zip(model.weights, lives, strict=True))
        columns["stressed_volume"][body] = float(np.dot(model.weights, volumes))
        life = 1.0 / (used * (part.passes or 1.0)) if used else math.inf
        columns["volume_life"][body] = life
    return columns | {"volume_at_top": surface_density_ratios(bodies, model, law)}


def stressed_volume(cycle: BodyFatigue, scene: Scene, law: VolumeLife) -> float:
    """Return the integral of stress over a body's volume; of a flat one, over 1 mm of track."""
    radius = getattr(scene.body, cycle.body).radius_x
    around = 2.0 * math.pi * abs(radius) if math.isfinite(radius) else 1.0
    limit = required(_table(scene).limit, "fatigue.limit")
    return law.volume(cycle.y, cycle.depth, cycle.utilisation * limit, around)


def life_error_bars(
    columns: Mapping[str, Any], bars: Mapping[str, float], life: Woehler, steel: Mapping[str, Steel]
) -> dict[str, float]:
    """Return the error bars of `fatigue_life` by body, from those of the utilisation.

    They are the increase of the life for the smallest utilisation; for the largest it changes less.
    """
    errors = {}
    for body, used in columns["utilisation"].items():
        layer = columns.get("failing_layer", {}).get(body, math.nan)
        curve = steel.get(body, Steel()).life(layer, life)
        low, here = curve.damage(np.array([used - bars[body], used]))
        if here > 0.0 and not math.isnan(bars[body]):
            longer = here / low - 1.0 if low > 0.0 else math.inf
            errors[body] = columns["fatigue_life"][body] * longer
    return errors


def utilisation_columns(cycles: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    """Return the columns of largest utilisation: of all, interior, surface; and its position."""
    maxima = {body: cycle.largest() for body, cycle in cycles.items()}
    return {
        "utilisation": {body: maximum.value for body, maximum in maxima.items()},
        "utilisation_interior": {body: maximum.interior for body, maximum in maxima.items()},
        "utilisation_surface": {body: maximum.surface for body, maximum in maxima.items()},
        "utilisation_at": {body: maximum.at for body, maximum in maxima.items()},
    }


def surface_density_ratios(
    bodies: Mapping[str, BodyDamage], model: Model, law: VolumeLife
) -> dict[str, float]:
    """Return each body's largest density of the stressed volume at the top over its maximum."""
    limit = required(_table(model.scene).limit, "fatigue.limit")
    return {
        body: max(
            law.surface_density_ratio(damage.fatigue.depth, used * limit) for used in damage.blocks
        )
        for body, damage in bodies.items()
    }


def _table(scene: Scene) -> Fatigue:
    """Return the table [fatigue] of a scene."""
    return required(scene.fatigue, "fatigue")
