"""Damage in the material while it wears."""

import math
from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.results import BodyFatigue, Grid, Status
from tractive_sam.rolling import body_damage, steps
from tractive_sam.rolling.passage import solve_pass

LIFE = ts.Woehler(cycles=1e6, exponent=6.0)
ASKED = {"shear_yield": 300.0, "sensitivity": 0.333, "limit": 250.0, "elements": 12}
DEPTH = np.concatenate(([0.0], np.linspace(0.02, 0.5, 25)))


def material(rate, utilisation=None):
    """One row of a body that is stressed alike for ever, and wears evenly."""
    if utilisation is None:
        utilisation = 1.2 * np.exp(-((DEPTH - 0.1) ** 2) / 0.02)
    rows = np.tile(utilisation, (len(rate), 1))
    zeta = body_damage.material_depths(DEPTH, 0.05)
    now = BodyFatigue("A", np.arange(len(rate)) * 1.0, DEPTH, rows, rows, rows, None, math.nan)
    now = now.with_damage(zeta, np.zeros((len(rate), zeta.size)), np.zeros(len(rate)))
    used = rows[None]
    return body_damage.BodyDamage(now, used, used, np.asarray(rate, float), 1.0, 0.0 * now.damage)


def rolled(one, jumps, life=LIFE):
    """Return the damage after jumps of these lengths."""
    revolution, before = 0, 0
    for jump in jumps:
        worn = one.fatigue.worn + jump * one.rate
        now = replace(one.fatigue, worn=worn)
        reached = now, one.utilisation, worn, one.rate, (1.0,)
        one = body_damage.after_jump(one, *reached, (jump, before), life, revolution)
        revolution, before = revolution + jump, jump
    return one


def test_without_wear_the_life_is_the_inverse_of_the_damage():
    one = material([0.0])
    reported = one.columns(LIFE)
    after = rolled(one, [1, 4, 95, 900])
    assert after.fatigue.damage_max[0] * reported["fatigue_life"] == pytest.approx(
        1000.0, rel=1e-12
    )
    peak = LIFE.damage(np.array([1.2]))[0]
    assert 1.0 / reported["fatigue_life"] == pytest.approx(peak, rel=1e-3)  # a parabola
    assert after.error.max() < 1e-12 * after.fatigue.damage_max[0]
    assert math.isnan(after.initiation)


def test_a_crack_starts_when_the_damage_is_one():
    one = material([0.0])
    life = one.columns(LIFE)["fatigue_life"]
    after = rolled(one, [1, int(0.4 * life), int(0.4 * life), int(0.4 * life)])
    assert after.initiation == pytest.approx(life, rel=1e-9)


@pytest.mark.parametrize("share", [0.5, 0.9, 1.1, 2.0])
def test_wear_that_is_slower_than_fatigue_starts_cracks(share):
    """With steady d(z) and w', what comes to the surface has suffered the integral of d/w'."""
    balance = material([0.0]).columns(LIFE)["balancing_wear"][0]
    rate = share * balance
    count = int(0.45 / rate)  # until material from below the stress is at the surface
    one = rolled(material([rate]), [1, *[count // 30] * 30])
    top, at = one.fatigue.damage_max
    # Of the interpolation between places of the material.
    assert top == pytest.approx(1.0 / share, rel=2e-3)
    assert at[2] == pytest.approx(one.fatigue.worn[0], abs=0.05)
    assert (share < 1.0) == (not math.isnan(one.initiation))
    assert one.columns(LIFE)["wear_margin"] == pytest.approx(share, rel=1e-9)


def test_long_jumps_are_the_sum_of_passes():
    """Of a profile that wears unevenly under stress that changes."""

    def course(jumps):
        one, n, last = material([1e-4, 3e-4]), 0, 0
        for jump in jumps:
            n += jump
            worn = np.array([1e-4, 3e-4]) * n**1.1
            rate = 1.1 * worn / n
            shape = np.exp(-((DEPTH - 0.1) ** 2) / 0.02) * (1.2 - 0.3 * (n / 400) ** 0.5)
            now = replace(one.fatigue, utilisation=np.tile(shape, (2, 1)), worn=worn)
            reached = now, now.utilisation[None], worn, rate, (1.0,)
            one = body_damage.after_jump(one, *reached, (jump, last), LIFE, n - jump)
            last = jump
        return one

    each = course([1] * 400)
    jumps = course([1, 1, 2, 3, 4, 6, 9, 14, 20, 30, 40, 50, 60, 80, 80])
    left = each.fatigue.zeta >= each.fatigue.worn[:, None] + 0.03
    scale = each.fatigue.damage[left].max()
    missed = np.abs(jumps.fatigue.damage - each.fatigue.damage)[left].max()
    assert missed < 5e-3 * scale  # parabolas over a fifth of the course
    assert missed < jumps.error.max()
    assert not each.error.any()


def test_a_row_is_damaged_whatever_its_neighbours_lose():
    """Beside a deeper one that wears faster, but crosses fewer places of the material."""
    rates, depths = np.array([8.1e-6, 8e-6]), np.array([0.2, 0.0])

    def after_a_jump(rows):
        one = material(rates[rows])
        return rolled(
            replace(one, fatigue=replace(one.fatigue, worn=depths[rows])), [1000]
        ).fatigue.damage

    # As many parts of the jump, so by rounding; by the one of the deeper row it is 1e-2.
    np.testing.assert_allclose(after_a_jump([0, 1])[1], after_a_jump([1])[0], rtol=1e-12)


def test_jumps_are_judged_where_the_top_lies_above_all_places():
    """Of stress that falls so fast that the surface has suffered much more than any place."""
    steep = ts.Woehler(cycles=1e6, exponent=40.0)
    one = rolled(material([3.46e-7], 1.5 * np.exp(-200.0 * DEPTH**0.5)), [1, 9], steep)
    # The course of the utilisation has a bend.
    suddenly = replace(one, utilisation_before=0.9 * one.utilisation)
    worn = one.fatigue.worn + 31 * one.rate
    reached = replace(one.fatigue, worn=worn), one.utilisation, worn, one.rate, (1.0,)
    after = body_damage.after_jump(suddenly, *reached, (31, 9), steep, 10)
    left = after.fatigue.damage[after.fatigue.zeta[None] >= after.fatigue.worn[:, None]]
    assert after.fatigue.damage_max[0] > left.max() / body_damage.BodyDamage.near_largest
    assert after.missed > 0.0


def test_a_flat_body_comes_but_once():
    one = replace(material([0.0]), passes=0.0)
    after = rolled(one, [1, 10, 100])
    assert after.fatigue.damage_max[0] == pytest.approx(LIFE.damage(np.array([1.2]))[0], rel=1e-3)
    assert math.isnan(after.columns(LIFE)["wear_margin"])


def discs(*settings, **requested):
    scene = ts.Scene.builtin("twin-discs").with_set(["grid.elements=[15, 31]", *settings])
    requested = {name: value for name, value in (ASKED | requested).items() if value is not None}
    return scene.replace(subsurface=None, fatigue=requested)


def test_the_damage_of_a_jump_counts_with_the_length_of_the_jump_before(monkeypatch):
    """The utilisation between two records is a parabola through the record before them."""
    jumps, after_jump = [], body_damage.after_jump

    def record(*arguments):
        jumps.append(arguments[6])
        return after_jump(*arguments)

    monkeypatch.setattr("tractive_sam.rolling.observers.after_jump", record)
    scene = discs("wear.revolutions=12", "wear.save=[0, 12]", bodies=["A"], elements=8)
    rolled = ts.roll(scene)
    lengths = [0, *np.diff(rolled["revolution"]).astype(int)]
    assert len(set(lengths)) > 2
    assert jumps == list(zip(lengths[1:], lengths[:-1], strict=True))


@pytest.mark.slow
def test_adaptive_jumps_do_the_damage_of_every_revolution():
    settings = ["wear.revolutions=40", "wear.save=[0, 40]"]
    jumps = ts.roll(discs(*settings))
    each = ts.roll(discs(*settings, "wear.stepping=every-revolution"))
    assert len(jumps) < len(each) == 41
    # The stepping's tolerance: no row comes into contact, or loses it, by then.
    np.testing.assert_allclose(jumps["damage"][-1], each["damage"][-1], rtol=1e-3)
    # Miner's sum at the surface is more: what was there has been worn off since.
    lives = np.sum(1.0 / each["fatigue_life"][1:], axis=0)
    assert (each["damage"][-1] < lives).all()
    assert (each["damage"][-1] > 0.7 * lives).all()  # found .81 and .85


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_jumps_are_short_where_the_damage_requires_it(each_of_sixty, tolerance):
    """At revolution 52 an element leaves the contact, and with it a third of the damage."""
    jumps = ts.roll(discs(*SIXTY, tolerance=tolerance))
    exact = each_of_sixty["damage"][-1]
    np.testing.assert_allclose(jumps["damage"][-1], exact, rtol=tolerance)
    assert len(jumps) < 35
    # Without the error by the points of stress paths, the only one of every revolution.
    reported = (jumps["damage_error"][-1] - each_of_sixty["damage_error"][-1]) / exact
    assert (reported < 10.0 * tolerance).all()  # of some ten jumps that count


SIXTY = "wear.revolutions=60", "wear.save=[0, 60]"


@pytest.fixture(scope="module")
def each_of_sixty():
    return ts.roll(discs(*SIXTY, "wear.stepping=every-revolution"))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("damage") / "whole.h5"
    return ts.roll(discs("wear.revolutions=40", "wear.save=[0, 15, 40]"), path)


@pytest.mark.slow
def test_file_and_memory_hold_the_same(whole):
    kept = ts.roll(whole.scene)
    for body in "AB":
        for revolution in (0, 15, 40):
            here, there = (one.fatigue(body, revolution=revolution) for one in (whole, kept))
            for name in ("y", "depth", "zeta", "utilisation", "residual_shear", "damage", "worn"):
                # Plans of transforms may differ, and with them the last digits; of what is nothing
                # beside the damage of one pass, all of them.
                np.testing.assert_allclose(
                    getattr(here, name), getattr(there, name), rtol=1e-7, atol=1e-12
                )
        assert here.damage_max[0] == pytest.approx(whole["damage"][-1, "AB".index(body)])
    with pytest.raises(LookupError, match="A, B"):
        whole.fatigue("C")


@pytest.mark.slow
def test_it_continues_with_the_same_damage(whole, tmp_path, monkeypatch):
    path = tmp_path / "a.h5"
    ts.roll(discs("wear.revolutions=15", "wear.save=[0, 15]"), path)

    def unsolved(*pass_):
        contact, depth = solve_pass(*pass_)
        return replace(contact, status=Status.OUT_OF_ITERATIONS), depth

    with monkeypatch.context() as patch:
        patch.setattr("tractive_sam.rolling.passage.solve_pass", unsolved)
        stopped = ts.roll(whole.scene, path, resume=True).fatigue("A")
    assert np.isfinite((stopped.residual_shear, stopped.path_radius, stopped.utilisation)).all()
    on = ts.roll(whole.scene, path, resume=True)
    np.testing.assert_array_equal(on["revolution"], whole["revolution"])
    # Digits of transforms, by the power of the stress; places and damage that are nothing.
    for name in ("damage", "damage_at", "damage_error", "wear_margin", "fatigue_life"):
        np.testing.assert_allclose(on[name], whole[name], rtol=1e-7, atol=1e-12)
    for body in "AB":
        here, there = on.fatigue(body), whole.fatigue(body)
        np.testing.assert_allclose(here.damage, there.damage, rtol=1e-7, atol=1e-15)  # as above


@pytest.mark.slow
def test_a_mesh_that_grows_keeps_the_damage(tmp_path):
    scene = discs("wear.revolutions=12", "wear.save=[12]").replace(grid=None)
    first = ts.roll(scene, tmp_path / "a.h5")
    assert first.finished
    body = first.fatigue("A")
    assert body.damage.shape == (first.grid.elements[1], body.zeta.size)
    wider = first.grid.half_length[1] + 4 * first.grid.dy
    grid = {
        "half_length": [first.grid.half_length[0], wider],
        "elements": [first.grid.elements[0], first.grid.elements[1] + 8],
    }
    longer = scene.replace(grid=grid).with_set(["wear.revolutions=14", "wear.save=[12, 14]"])
    on = ts.roll(longer, tmp_path / "a.h5", resume=True)
    assert on.finished
    again = on.fatigue("A", revolution=12)
    np.testing.assert_array_equal(again.damage[4:-4], body.damage)
    assert not again.damage[:4].any()
    assert (on.fatigue("A").damage[4:-4] >= body.damage).all()


@pytest.mark.slow
def test_a_mesh_that_grows_during_the_run_changes_nothing():
    settings = ["wear.intensity=2e-5", "wear.revolutions=200", "wear.save=[200]"]
    scene = discs(*settings).replace(grid=None)
    narrow = Grid((0.35, 0.54), (15, 15))
    last = list(steps(Model(scene, grid=narrow)))[-1]
    wide = last.grid
    assert wide.elements[1] > narrow.elements[1]
    wanted = list(steps(Model(scene, grid=wide)))[-1]
    assert last.revolution == wanted.revolution
    for body in "AB":
        here, there = (one.observed["damage"].bodies[body].fatigue for one in (last, wanted))
        np.testing.assert_array_equal(here.y, there.y)
        # Jumps may differ, and each is right to the tolerance of the stepping, 1 % of the damage.
        np.testing.assert_allclose(here.damage, there.damage, atol=1e-2 * there.damage.max())


@pytest.mark.slow
def test_a_contact_that_leaves_the_mesh_keeps_the_damage_before(tmp_path, monkeypatch):
    def away(model, last, jump, rows):
        contact = replace(last.contact, status=ts.solvers.Status.OFF_GRID)
        far = replace(last, contacts=(contact,), revolution=last.revolution + jump, observed={})
        return far, math.inf

    monkeypatch.setattr("tractive_sam.rolling.revolutions.jump_on", away)
    monkeypatch.setattr("tractive_sam.rolling.process.GROWTHS", 0)
    scene = discs("wear.revolutions=9", "wear.save=[0, 9]").replace(grid=None)
    for path in (None, tmp_path / "a.h5"):
        history = ts.roll(scene, path)
        assert history.status == "off grid"
        assert "shakedown" in history.message
        top, _ = history.fatigue("A").damage_max
        assert top == pytest.approx(history["damage"][-2, 0], rel=1e-12)  # equal numbers
        assert np.isnan(history["damage"][-1]).all()


def test_without_wear_there_is_a_life_and_no_damage():
    history = ts.roll(discs().replace(wear=None))
    assert (history["damage"] == 0.0).all()
    assert (history["fatigue_life"] > 0.0).all()
    assert np.isnan(history["wear_margin"]).all()  # there is none


def test_stress_above_the_shakedown_limit_is_reported(whole):
    assert whole["shakedown_lower"][-1].min() < 1.0
    assert "shakedown" in whole.message
    bears = ts.roll(discs(shear_yield=3000.0, limit=None).replace(wear=None))
    assert (bears["shakedown_lower"] > 1.0).all()
    assert "shakedown" not in bears.message


def test_what_is_not_requested_is_not_there():
    history = ts.roll(discs("wear.revolutions=1", "wear.save=[0, 1]", limit=None))
    assert "damage" not in history.columns
    assert "shakedown_lower" in history.columns
    assert not history.fatigue("A").damage.any()


SPECTRUM = (
    {"revolutions": 1, "load": {"normal": 350.0}},
    {"revolutions": 3},
)


def test_blocks_that_are_alike_do_the_damage_of_one_load():
    settings = ["wear.revolutions=20", "wear.save=[0, 20]"]
    alike = discs(*settings).replace(duty=[{"revolutions": 1}, {"revolutions": 4}])
    whole, one = ts.roll(alike), ts.roll(discs(*settings))
    for name in ("damage", "fatigue_life", "shakedown_lower", "shakedown_upper", "wear_margin"):
        np.testing.assert_allclose(whole[name], one[name], rtol=1e-9)  # by rounding


@pytest.mark.slow
def test_blocks_add_up_by_miner(tmp_path):
    """Cycles in jumps, in single revolutions, and killed half way have equal damage."""
    settings = ["wear.revolutions=16", "wear.save=[0, 8, 16]"]
    spectrum = discs(*settings).replace(duty=SPECTRUM)
    jumps = ts.roll(spectrum, tmp_path / "a.h5")
    life = np.array([ts.roll(one.replace(wear=None))["fatigue_life"][0] for one in spectrum.blocks])
    miner = 1.0 / np.average(1.0 / life, axis=0, weights=[1, 3])
    # At the worst place of all; each alone has another worst place.
    assert (jumps["fatigue_life"][0] >= miner * (1.0 - 1e-9)).all()
    assert (jumps["fatigue_life"][0] < 4.0 * life[0] * (1.0 + 1e-9)).all()
    assert (jumps["utilisation"][0] == jumps["block_utilisation"][0].max(axis=0)).all()
    # No block shakes down at more than all of them, with one residual stress.
    single = [ts.roll(one.replace(wear=None))["shakedown_lower"][0] for one in spectrum.blocks]
    assert (jumps["shakedown_lower"][0] <= np.min(single, axis=0) * (1.0 + 1e-9)).all()
    each = ts.roll(spectrum.with_set(["wear.stepping=every-revolution"]))
    # A cycle wears as its mean does, to what a cycle wears; surfaces are damaged in order.
    np.testing.assert_allclose(jumps["damage"][-1], each["damage"][-1], rtol=0.05)
    half = spectrum.with_set(["wear.revolutions=8", "wear.save=[0, 8]"])
    ts.roll(half, tmp_path / "b.h5")
    on = ts.roll(spectrum, tmp_path / "b.h5", resume=True)
    # Digits of transforms, by the power of the stress; of the unworn, damage that is nothing.
    np.testing.assert_allclose(on["damage"], jumps["damage"], rtol=1e-7, atol=1e-12)
    assert on.fatigue("A").damage_max[0] == pytest.approx(on["damage"][-1, 0])
    assert on.block(0)["utilisation"].shape == on["utilisation"].shape


def test_a_block_aside_damages_its_own_place():
    settings = ["wear.revolutions=2", "wear.save=[0, 2]"]
    scene = discs(*settings)
    aside = [{"revolutions": 1}, {"revolutions": 1, "shift_y": 0.4}]
    history = ts.roll(scene.replace(duty=aside))
    one = ts.roll(scene.replace(wear=None)).fatigue("A").utilisation
    both = history.fatigue("A", revolution=0)
    assert both.utilisation.max() == pytest.approx(one.max(), rel=0.05)  # of the elements it is on
    damaged = both.y[both.utilisation[:, 1] > 0.5 * both.utilisation[:, 1].max()]
    single = both.y[one[:, 1] > 0.5 * one[:, 1].max()]
    assert damaged.min() == pytest.approx(single.min(), abs=0.05)
    assert damaged.max() == pytest.approx(single.max() + 0.4, abs=0.1)  # an element


@pytest.mark.slow
def test_the_life_of_a_volume():
    requested = {"criterion": "orthogonal-shear", "sensitivity": None, "limit": 1.0}
    volume = {"constant": 1e-34}
    smooth = discs(**requested, volume=volume).replace(wear=None, friction=None, creepage=None)
    smooth = smooth.replace(grid=None)
    loads = (200.0, 250.0)
    lives = [ts.roll(smooth.with_set([f"load.normal={p}"]))["volume_life"][0, 0] for p in loads]
    # P^-3 of a point contact: meshes that a scene chooses are similar, to the solver's tolerance.
    assert np.log(lives[0] / lives[1]) / np.log(1.25) == pytest.approx(3.0, abs=1e-3)
    likely = ts.roll(smooth.with_set(["fatigue.volume.survival=0.5"]))["volume_life"]
    rarely = ts.roll(smooth)["volume_life"]
    ratio = (math.log(0.5) / math.log(0.9)) ** 0.9
    np.testing.assert_allclose(likely / rarely, ratio, rtol=1e-9)
    assert (ts.roll(smooth)["volume_at_top"] < 0.5).all()
    rough = discs(**requested, volume={}).replace(wear=None)
    history = ts.roll(rough)
    assert "volume_life" not in history.columns  # without a constant
    assert (history["volume_at_top"] == 1.0).any()  # friction: the surface counts most
    assert "one element deep" in history.message
    assert "one element deep" not in ts.roll(smooth).message
    with pytest.raises(ts.SceneError, match="limit"):
        discs(**requested | {"limit": None}, volume=volume)
