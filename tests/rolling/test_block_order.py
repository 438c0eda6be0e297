"""Error of the damage of a duty cycle by the order of its blocks."""

from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.rolling.body_damage import BlockOrder, block_orders

STEEL = {"young": 208e3, "poisson": 0.3, "radius_x": 30.0, "radius_y": 30.0}
# The wear of a cycle, a share of the damaged depth, exceeds the wear of dry steel.
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
    spectrum = discs(blocks, **{"wear.revolutions": 720}).spectrum  # full cycles
    return BlockOrder.from_spectrum(spectrum, np.array(rates))


def passes(used, worn):
    """Damage of a pass that falls with the depth; `used` is the utilisation at its top."""
    deep = ZETA - worn[:, None]
    return np.where(deep >= 0.0, used**6 * np.exp(-8.0 * np.maximum(deep, 0.0)), 0.0)


@pytest.mark.parametrize("counts", [(1, 1), (2, 4), (5, 1)])
@pytest.mark.parametrize("rates", [(4e-4, 1e-4), (1e-4, 4e-4), (2e-4, 2e-4)])
def test_it_is_the_difference_to_the_blocks_in_their_order(counts, rates):
    """For blocks with a known course, far below the surface and all wear."""
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
    # The sum of all, and the blocks without signs, which cancel to a nineteenth if the heavy one
    # wears more.
    assert (estimate[0, below] <= 21.0 * difference).all()


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


def test_the_offset_is_the_wear_before_a_revolution():
    rates = np.array([[3e-4, 0.0], [1e-4, 1e-4]])
    spectrum = discs((HEAVY, BACK)).spectrum
    mean = np.tensordot((2 / 6, 4 / 6), rates, axes=1)
    for revolution in (1, 2, 3, 6, 7, 18):
        order = BlockOrder.from_spectrum(spectrum, rates, revolution)
        worn = sum((rates[spectrum.block_at(n)] for n in range(1, revolution)), np.zeros(2))
        np.testing.assert_allclose(order.offset, worn - (revolution - 1) * mean, atol=1e-18)


def responding(rng, rows=5, fastest=2e-3):
    """A random response of wear to the profile: waves of it decay, an even depth has no effect."""
    waves = rng.normal(size=(rows, rows))
    waves -= waves.mean(axis=1, keepdims=True)
    decay = waves.T @ waves
    return -fastest * decay / np.linalg.eigvalsh(decay).max()


@pytest.mark.parametrize("cycles", [1, 4, 1000])
def test_the_drift_is_the_difference_of_both_profiles(cycles):
    """Of wear that is linear in the profile, rolled in the order of blocks and as their mean."""
    rng = np.random.default_rng(1)
    spectrum = discs((HEAVY, BACK)).spectrum
    rates = rng.uniform(1e-4, 3e-4, (2, 1, 5))
    responses = [responding(rng), responding(rng)]
    shares = np.array((2, 4)) / 6
    in_order, as_mean = np.zeros(5), np.zeros(5)
    for n in range(1, 6 * cycles + 1):
        b = spectrum.block_at(n)
        in_order = in_order + rates[b, 0] + responses[b] @ in_order
        each = (w * (r[0] + j @ as_mean) for w, r, j in zip(shares, rates, responses, strict=True))
        as_mean = as_mean + sum(each)
    # Rates at the end, as a roll knows them.
    ends = np.array([[r[0] + j @ as_mean] for r, j in zip(rates, responses, strict=True)])
    drift = BlockOrder.from_spectrum(spectrum, ends[:, 0]).drift(responses, 6 * cycles)
    difference = in_order - as_mean
    error = np.abs(drift - difference).max() / np.abs(difference).max()
    # To the first order in the response of a cycle, 1e-2; a single implicit step of the drift
    # reaches e^-t at t = 1 to a third, and is less exact if rates have changed since.
    assert error < 0.5
    (order,) = block_orders(spectrum, ends, responses, 6 * cycles)
    before = BlockOrder.from_spectrum(spectrum, ends[:, 0], 6 * cycles)
    np.testing.assert_allclose(order.wear - before.wear, np.tile(drift, (2, 1)), atol=1e-15)
    np.testing.assert_allclose(order.offset - before.offset, drift, atol=1e-15)
    changes = [j @ w for j, w in zip(responses, order.wear, strict=True)]
    np.testing.assert_allclose(order.changes, changes)


def test_changed_loads_spread_over_the_depth():
    """A load on a row is felt in others by Boussinesq's line load; an even change everywhere."""
    y, depth = np.linspace(-1.0, 1.0, 201), np.array([0.0, 0.05, 0.2])
    even = BlockOrder(np.ones(1), np.zeros(1), np.zeros((1, 201)), np.zeros(201), np.zeros(1))
    loads = np.ones((1, 201))
    factors = replace(even, loads=loads, changes=0.1 * loads).load_factors(y, depth)
    np.testing.assert_allclose(factors, 1.1, rtol=1e-12)  # rounding
    single = np.zeros((1, 201))
    single[0, 100] = 0.5
    factors = replace(even, loads=loads, changes=single).load_factors(y, depth)[0] - 1.0
    np.testing.assert_array_equal(factors[:, 0], single[0])
    for k, z in ((1, 0.05), (2, 0.2)):
        law = 0.5 * 0.01 * 2.0 / np.pi * z**3 / (y**2 + z**2) ** 2
        middle = np.abs(y) < 0.3  # the track ends at 1
        # Over an element of a fifth of the smaller depth, and with what a track of 1 leaves out.
        np.testing.assert_allclose(factors[middle, k], law[middle], rtol=0.02)
    assert (even.load_factors(y, depth) == 1.0).all()


@pytest.mark.slow
@pytest.mark.parametrize("blocks", [(HEAVY, BACK), (BACK, HEAVY)])
def test_the_error_of_the_damage_includes_the_order_of_blocks(blocks):
    scene = discs(blocks)
    jumps = ts.roll(scene)
    each = ts.roll(scene.with_set(["wear.stepping=every-revolution"]))
    difference = np.abs(jumps["damage"][-1] - each["damage"][-1])
    # The points of stress paths are an error of both, the only one of every revolution.
    of_paths = np.expm1(6.0 * np.log1p(ts.Laws.of(scene).fatigue.path_error))
    np.testing.assert_allclose(each["damage_error"], of_paths * each["damage"])
    assert (difference < jumps["damage_error"][-1] - each["damage_error"][-1]).all()
    # At most 8.9 % of A and 10.7 % of B, with 2.4 % by the points of the paths.
    assert (jumps["damage_error"][-1] < 0.12 * each["damage"][-1]).all()


def test_a_change_of_state_counts_as_many_revolutions_as_the_order_is_ahead():
    """The largest difference of counts, over all times of a cycle at which the damage changes."""
    spectrum = discs((HEAVY, BACK, HEAVY)).spectrum
    rates = np.zeros((len(spectrum.revolutions), 4))
    order = BlockOrder.from_spectrum(spectrum, rates)
    blocks = [spectrum.block_at(n) for n in range(1, spectrum.cycle + 1)]
    in_order = np.cumsum([np.eye(len(rates))[b] for b in blocks], axis=0)
    mean = np.arange(1, spectrum.cycle + 1)[:, None] * order.shares
    np.testing.assert_allclose(order.ahead, np.abs(in_order - mean).max(axis=0), atol=1e-14)
    used = np.zeros((len(rates), 4, 1))
    used[0, :, 0] = 1.0, 1.0, 0.5, 0.0  # rows beside an edge take the damage of their neighbour
    error = order.switch_error(np.square, used)[:, 0]
    np.testing.assert_allclose(error, order.ahead[0] * np.array([0.0, 0.75, 0.75, 0.25]))


@pytest.mark.slow
@pytest.mark.parametrize("cycles", [2, 3, 5])
def test_the_error_includes_what_the_order_changes_of_the_stress(cycles):
    """In the second and third cycle, elements begin to slip only where blocks are in order.

    Without these changes the error was 0.65 and 0.38 of the difference.
    """
    blocks = [
        {
            "revolutions": count,
            "load": {"normal": load},
            "creepage": {"longitudinal": creepage, "lateral": lateral},
            "shift_y": shift * 0.48 / 33,
        }
        for count, load, creepage, lateral, shift in (
            (6, 275.2, 0.00354, 0.00164, -4),
            (3, 221.0, 0.00523, 0.00002, 8),
            (1, 270.1, 0.00307, -0.00131, 6),
            (6, 344.0, 0.00143, 0.00066, -8),
        )
    ]
    worn = {"coefficient": {"A": 2.74e-3, "B": 1.614e-3}, "revolutions": 16 * cycles}
    worn["save"] = [0, 16 * cycles]
    fatigue = DISCS["fatigue"] | {"exponent": 8.9}
    bodies = {"A": STEEL | {"radius_y": 42.1}, "B": STEEL | {"radius_y": 26.0}}
    scene = discs(blocks, body=bodies, wear=worn, fatigue=fatigue, friction={"mu": 0.19})
    jumps = ts.roll(scene)
    each = ts.roll(scene.with_set(["wear.stepping=every-revolution"]))
    difference = np.abs(jumps["damage"][-1] - each["damage"][-1])
    # Both have the error by the points of stress paths.
    assert (difference < jumps["damage_error"][-1] - each["damage_error"][-1]).all()
