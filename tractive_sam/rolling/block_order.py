"""Effect of the order of blocks on the damage of a duty cycle that is rolled as its mean.

In the mean every revolution of a cycle of n has the damage sum of w_b d_b, w_b = n_b/n. In its
order a block b does all of its damage at one time of the cycle, tau_b revolutions after the middle,
and at the wear of that time, e_b more than in the mean:

    sum over a jump of w_b (tau_b d(d_b)/dN + (d_b(zeta - E - e_b; E + e_b) - d_b(zeta - E; E))),

by Taylor in tau_b. The first term adds up to the change of the damage of a pass: it does not grow
with the number of cycles. The second term is proportional to the wear of a cycle, and has two
causes. The material lies e_b less deep. And rows that are worn more carry less load, by J_b e_b of
their wear in a pass with the response J_b (`rolling.response`), which changes the stress.

For that reason a cycle also wears another profile than its mean: the difference eps obeys

    d(eps)/dN = J eps + c,    J = sum of w_b J_b,    c = sum of w_b J_b e_b,

and its short waves settle at -J^-1 c within tens of revolutions. It adds to every e_b.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.scene import Spectrum


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
    """

    shares: np.ndarray
    delay: np.ndarray
    wear: np.ndarray
    offset: np.ndarray
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
        return cls(shares, delay, wear, offset)

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
