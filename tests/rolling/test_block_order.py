"""Error of the damage of a duty cycle by the order of its blocks."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.rolling.block_order import BlockOrder

STEEL = {"young": 208e3, "poisson": 0.3, "radius_x": 30.0, "radius_y": 30.0}
# Wear of a cycle that is a share of the damaged depth is more than that of dry steel.
pytestmark = pytest.mark.filterwarnings("ignore:wear")

DISCS = {
    "body": {"A": STEEL, "B": STEEL | {"radius_y": 60.0}},
    "load": {"normal": 300.0},
    "creepage": {"longitudinal": -0.003, "lateral": 0.001},
    "friction": {"mu": 0.3},
    "grid": {"half_length": [0.5, 0.96], "elements": [17, 33]},
    "fatigue": {
        "criterion": "dang-van",
        "sensitivity": 0.3,
        "limit": 250.0,
        "cycles": 1e6,
        "exponent": 6.0,
        "elements": 8,
    },
    "wear": {"coefficient": {"A": 1e-2, "B": 2e-2}, "revolutions": 24, "save": [0, 24]},
}
HEAVY = {"revolutions": 2, "load": {"normal": 360.0}}
BACK = {
    "revolutions": 4,
    "load": {"normal": 220.0},
    "creepage": {"longitudinal": 0.002, "lateral": -0.001},
    "shift_y": 4 * 0.96 / 33,
}
ZETA = np.linspace(0.0, 1.0, 401)


def discs(blocks, **changes):
    return ts.Scene(**DISCS).replace(duty=blocks, **changes)


def order_of(*blocks, rates):
    """The order of some blocks of the discs; `rates` of each different one."""
    spectrum = discs(blocks, **{"wear.revolutions": 720}).spectrum  # whole cycles
    return BlockOrder.from_spectrum(spectrum, np.array(rates))


def passes(used, worn):
    """Damage of a pass that falls with the depth; `used` is the utilisation at its top."""
    deep = ZETA - worn[:, None]
    return np.where(deep >= 0.0, used**6 * np.exp(-8.0 * np.maximum(deep, 0.0)), 0.0)


@pytest.mark.parametrize("counts", [(1, 1), (2, 4), (5, 1)])
@pytest.mark.parametrize("rates", [(4e-4, 1e-4), (1e-4, 4e-4), (2e-4, 2e-4)])
def test_it_is_the_difference_to_the_blocks_in_their_order(counts, rates):
    """Of blocks with a known course: far below the surface, where no place is worn off."""
    order = order_of(
        *({**b, "revolutions": n} for b, n in zip((HEAVY, BACK), counts, strict=True)),
        rates=np.array(rates)[:, None],
    )
    cycles, cycle = 40, sum(counts)
    sequence = [0] * counts[0] + [1] * counts[1]
    mean = np.dot(counts, rates) / cycle
    worn, exact, on_mean = 0.0, 0.0, 0.0
    used = np.array((1.1, 0.9))
    for n in range(cycles * cycle):
        block = sequence[n % cycle]
        exact = exact + passes(used[block], np.array([worn]))
        worn += rates[block]
        for share, each in zip(order.shares, used, strict=True):
            on_mean = on_mean + share * passes(each, np.array([n * mean]))
    ends = np.array([0.0]), np.array([cycles * cycle * mean])
    estimate = order.damage_error(passes, (used, used), ends, cycles * cycle)
    below = ends[1][0] + 0.05 < ZETA
    difference = np.abs(exact - on_mean)[0, below]
    # To the second order in the wear of a cycle, 1e-2 of the depth over which damage falls.
    assert (estimate[0, below] >= 0.98 * difference).all()
    # The signs of blocks are lost: they cancel to a nineteenth where the heavy one wears more.
    assert (estimate[0, below] <= 20.0 * difference).all()


def test_a_symmetric_order_has_no_delay():
    order = order_of(HEAVY, BACK, HEAVY, rates=[[3e-4, 0.0], [1e-4, 1e-4]])
    np.testing.assert_allclose(order.delay, 0.0, atol=1e-12)  # rounding
    longer = order_of(
        {**HEAVY, "revolutions": 20}, {**BACK, "revolutions": 40}, rates=[[3e-4], [1e-4]]
    )
    short = order_of(HEAVY, BACK, rates=[[3e-4], [1e-4]])
    np.testing.assert_allclose(longer.delay, 10.0 * short.delay)
    even = order_of(HEAVY, BACK, rates=[[2e-4], [2e-4]])
    np.testing.assert_allclose(even.wear, 0.0, atol=1e-18)  # rounding


@pytest.mark.parametrize("blocks", [(HEAVY, BACK), (BACK, HEAVY)])
def test_the_error_of_the_damage_includes_the_order_of_blocks(blocks):
    scene = discs(blocks)
    jumps = ts.roll(scene)
    each = ts.roll(scene.with_set(["wear.stepping=every-revolution"]))
    difference = np.abs(jumps["damage"][-1] - each["damage"][-1])
    assert (difference < jumps["damage_error"][-1]).all()
    # 1.5 to 1.7 % of A; B, whose surface wears off faster, meets the damage by chance.
    assert (jumps["damage_error"][-1] < 0.1 * each["damage"][-1]).all()
    assert (each["damage_error"] == 0.0).all()
