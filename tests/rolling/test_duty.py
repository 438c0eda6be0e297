"""Duty cycles: blocks of load and creepage, rolled in their order or on the mean."""

import math
import os
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.scenes import interrupted
from tests.test_resume import KILLED_BY_ITSELF
from tractive_sam.cli.program import app
from tractive_sam.schema import PlausibilityWarning

DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None)
DISCS = DISCS.with_set(
    ["grid.half_length=[0.42, 0.9]", "grid.elements=[15, 25]", "wear.revolutions=60"]
)
HEAVY = {"revolutions": 1, "load": {"normal": 450.0}}
SLOW = {"revolutions": 2, "creepage": {"longitudinal": -0.002}}
ASIDE = {"revolutions": 2, "shift_y": 0.1}
FREE = {"revolutions": 3, "creepage": {"longitudinal": 0.0}}
LETTER = {"wear.stepping": "every-revolution"}


def rolled(*blocks, **changes):
    return ts.roll(DISCS.replace(duty=blocks, **changes))


def assert_same(one, other, *names):
    for name in names or ("wear_max", "entering_profile", "wear_profile_A", "P", "Qx", "jump"):
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)


def test_life_under_a_spectrum_needs_no_wear_and_one_contact_for_each_different_block():
    """Life by Miner's rule from the lives of the blocks, in memory and in the file."""
    steel = {"sensitivity": 0.333, "limit": 250.0, "elements": 8}
    unworn = DISCS.replace(wear=None, fatigue=steel)
    blocks = ({"revolutions": 3}, HEAVY, {"revolutions": 6})
    history = ts.roll(unworn.replace(duty=blocks))
    assert (len(history), history["solves"][0], history.status) == (1, 2, "done")
    lives = [
        ts.roll(one)["fatigue_life"][0] for one in (unworn, unworn.replace(load=HEAVY["load"]))
    ]
    damages = np.array([0.9 / lives[0], 0.1 / lives[1]])
    # The largest damages of the blocks need not be at one depth: between their maximum and sum.
    assert (1.0 / history["fatigue_life"][0] <= damages.sum(axis=0) * (1.0 + 1e-6)).all()
    assert (1.0 / history["fatigue_life"][0] >= damages.max(axis=0) * (1.0 - 1e-6)).all()


def test_alike_blocks_are_one_bit_for_bit():
    single = ts.roll(DISCS)
    assert_same(rolled({"revolutions": 1}, {"revolutions": 2}, {"revolutions": 7}), single)
    letter = ts.roll(DISCS.replace(**LETTER, **{"wear.revolutions": 6}))
    blocks = ({"revolutions": 1}, {"revolutions": 2})
    assert_same(rolled(*blocks, **LETTER, **{"wear.revolutions": 6}), letter)


def test_blocks_that_differ_by_nothing_are_one():
    """Their contacts are solved each on its own."""
    single = ts.roll(DISCS)
    near = rolled({"revolutions": 1}, {"revolutions": 2, "load": {"normal": 300.0 * (1 + 1e-14)}})
    assert near["solves"][-1] == 2 * single["solves"][-1]
    last = single["wear_profile"][-1]
    # To the residual of the contacts.
    np.testing.assert_allclose(near["wear_profile"][-1], last, atol=1e-6 * last.max())


def test_a_block_of_free_rolling_changes_only_the_count():
    """Discs of equal material: it does not wear."""
    single = rolled(HEAVY, **LETTER, **{"wear.revolutions": 10})
    block = {"revolutions": 4} | {k: v for k, v in FREE.items() if k != "revolutions"}
    mixed = rolled(HEAVY, block, **LETTER, **{"wear.revolutions": 50})
    # After the revolution that wears: the other four leave the profile as it is.
    np.testing.assert_allclose(
        mixed["wear_profile"][[5 * k + 1 for k in range(10)]],
        single["wear_profile"][1:],
        rtol=1e-9,
        atol=1e-15,
    )
    assert mixed["block_share"][-1].tolist() == [1.0, 0.0]


@pytest.mark.slow
@pytest.mark.parametrize("stepping", ["adaptive", "every-revolution"])
def test_depth_of_a_line_in_full_slip(stepping):
    """Sum of n_k i P'_k |xi_k| in a cycle."""
    steel = {"young": 208e3, "poisson": 0.3, "radius_x": 40.0, "radius_y": math.inf}
    n, load, creepage = (3, 2, 5), (300.0, 150.0, 80.0), (0.2, 0.3, 0.4)
    scene = ts.Scene(
        body={"A": steel, "B": steel},
        load={"normal": 300.0},
        friction={"mu": 0.3},
        wear={"intensity": 1e-8, "revolutions": 40, "stepping": stepping},
        duty=[
            {"revolutions": k, "load": {"normal": P}, "creepage": {"longitudinal": -xi}}
            for k, P, xi in zip(n, load, creepage, strict=True)
        ],
    )
    history = ts.roll(scene)
    assert history.finished, history.message
    cycle = sum(k * 1e-8 * P * xi for k, P, xi in zip(n, load, creepage, strict=True))
    depth = history["entering_profile"][-1, 0] + history["wear_per_revolution"][-1, 0]
    # Slip is creepage plus strain of the surfaces; the work of the strain over the contact is zero.
    assert depth == pytest.approx(4 * cycle, rel=1e-6)
    of_blocks = [k * P * xi for k, P, xi in zip(n, load, creepage, strict=True)]
    np.testing.assert_allclose(
        history["worn_by"][-1].sum(axis=(1, 2)) / history["entering_profile"][-1, 0],
        np.array(of_blocks) / sum(of_blocks),
        rtol=0.1 if stepping == "every-revolution" else 1e-6,  # the last revolution is to come
    )


@pytest.mark.slow
def test_the_order_of_blocks_matters_as_much_as_a_cycle_wears():
    """The difference of both orders over the depth falls in proportion to the intensity."""
    found = []
    for intensity, cycles in ((8e-6, 6), (4e-6, 12)):
        profiles = []
        for order in ((HEAVY, ASIDE), (ASIDE, HEAVY)):
            changes = LETTER | {"wear.intensity": intensity, "wear.revolutions": 3 * cycles}
            profiles.append(rolled(*order, **changes)["wear_profile"][-1])
        one, other = profiles
        found.append(np.abs(one - other).max() / one.max())
    # Linear, to the next order in the wear of a cycle, a tenth of the total here at most.
    assert found[0] / found[1] == pytest.approx(2.0, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("blocks", [(HEAVY, SLOW), (HEAVY, SLOW, ASIDE)])
def test_jumps_meet_what_is_rolled_block_by_block(blocks):
    jumps = rolled(*blocks, **{"wear.revolutions": 300})
    letter = rolled(*blocks, **LETTER, **{"wear.revolutions": 300})
    assert len(jumps) < 0.1 * len(letter)
    assert jumps["solves"].sum() <= 1.2 * len(blocks) * len(jumps)
    for name in ("wear_profile", "wear_profile_A"):
        last = letter[name][-1]
        # Three times the tolerance, as for a single load, and the wear of half a cycle.
        lag = 0.5 * 3 * letter["wear_per_revolution"][-5:].max()
        np.testing.assert_allclose(jumps[name][-1], last, atol=3e-3 * last.max() + lag, rtol=0.0)


def test_a_record_costs_what_its_own_contacts_cost():
    """Contacts of the other blocks were solved for an earlier record, and counted there."""
    history = rolled(HEAVY, SLOW, **LETTER, **{"wear.revolutions": 6})
    rolls = np.array([[1, 1], [1, 0], [0, 1], [0, 1], [1, 0], [0, 1], [0, 1]], bool)
    for name in ("block_operator_applications", "block_convolutions"):
        np.testing.assert_array_equal(history[name] > 0.0, rolls, err_msg=name)


def test_columns_of_the_blocks_and_of_the_cycle():
    history = rolled(HEAVY, SLOW, ASIDE)
    n = np.array([1, 2, 2]) / 5
    np.testing.assert_allclose(history["block_P"][-1], [450.0, 300.0, 300.0], rtol=1e-9)
    for name in ("P", "Qx", "t_gamma", "worn_area", "dissipation"):
        of_blocks = history[f"block_{name}"] @ n
        np.testing.assert_allclose(history[name], of_blocks, rtol=1e-12, atol=1e-15)
    for name in ("p_max", "wear_max", "half_width_y"):
        np.testing.assert_array_equal(history[name], history[f"block_{name}"].max(axis=1))
    np.testing.assert_array_equal(
        history["operator_applications"], history["block_operator_applications"].sum(axis=1)
    )
    np.testing.assert_allclose(history["block_share"][1:].sum(axis=1), 1.0, rtol=1e-12)
    parts = history["worn_by"].sum(axis=(1, 2))
    np.testing.assert_allclose(parts, history["entering_profile"], atol=1e-14)
    # Each block dissipates what it is given.
    np.testing.assert_allclose(
        history["block_dissipation"], history["block_work_supplied"], rtol=1e-4
    )
    # Time is measured for the cycle only.
    assert "block_seconds" not in history.columns
    assert (history["seconds"] > 0.0).all()


def test_a_block_is_a_history():
    history = rolled(HEAVY, SLOW, ASIDE | {"name": "aside"})
    for k in range(3):
        block = history.block(k)
        state = block.state(60)
        for name in ("P", "Qx", "Mz", "t_gamma", "p_max"):
            assert getattr(state, name) == pytest.approx(block[name][-1], rel=1e-12)
        assert block.scene.load.normal == (450.0 if k == 0 else 300.0)
    aside = history.block(2)
    assert "aside" in aside.scene.title
    # Contact and forces are reported at the place of the band.
    assert abs(aside["p_max_at"][-1, 1]) < 0.1
    assert aside.grid.shift == 0.1
    for place in ("1", np.int64(1)):
        assert history.block(place).scene == history.block(1).scene
    for none in (3, -1, "3", "²", 0.5):
        with pytest.raises(LookupError, match=str(none)):
            history.block(none)
    with pytest.raises(LookupError, match=r"history\.block"):
        history.state(60)


def test_a_shifted_block_is_one_that_is_not():
    """Relative to its place: shifted by full elements, so that the meshes are equal."""
    dy = 1.8 / 25
    shifted = rolled({"revolutions": 1, "shift_y": 2 * dy}, **{"wear.revolutions": 20})
    centred = rolled({"revolutions": 1}, **{"wear.revolutions": 20})
    moved = np.roll(centred["wear_profile"][-1], 2)
    last = shifted["wear_profile"][-1]
    np.testing.assert_allclose(last, moved, atol=1e-9 * moved.max())
    np.testing.assert_allclose(shifted["block_Mz"][:, 0], centred["block_Mz"][:, 0], atol=1e-6)


def test_forces_friction_and_laws_of_the_blocks():
    blocks = (
        {"revolutions": 1, "load": {"force_x": 60.0}},
        {"revolutions": 1, "friction": {"mu": [0.3, 0.3]}},
    )
    history = rolled(*blocks)
    np.testing.assert_allclose(history["block_Qx"][:, 0], 60.0, rtol=1e-6)
    assert (history["block_xi_x"][:, 0] != -0.005).all()
    assert history["block_Qx_over_P"][-1, 1] < 0.3
    own = ts.roll(
        DISCS.replace(duty=(HEAVY, SLOW)),
        laws=ts.Laws.of(DISCS).replace(wear=ts.PerBody(A=ts.Energy((4e-6, 4e-6)))),
    )
    assert own.finished
    assert not own["wear_profile_B"].any()


def test_each_body_by_its_law_in_each_block():
    law = 'wear.law={A="usfd", B="archard"}'
    scene = DISCS.with_set([law, "wear.coefficient.B=1e-3"]).replace(duty=(HEAVY, SLOW))
    history = ts.roll(scene)
    both = history["wear_profile_A"] + history["wear_profile_B"]
    np.testing.assert_allclose(both, history["wear_profile"], atol=1e-12 * both.max())


@pytest.mark.slow
@pytest.mark.parametrize("stepping", ["adaptive", "every-revolution"])
def test_it_resumes_as_if_nothing_had_happened(tmp_path, stepping):
    scene = DISCS.replace(duty=(HEAVY, SLOW, ASIDE))
    scene = scene.replace(**{"wear.stepping": stepping, "wear.revolutions": 20})
    whole, path = ts.roll(scene), tmp_path / "a.h5"
    interrupted(scene, path, 4)
    history = ts.roll(scene, path, resume=True)
    own = "seconds", "over_application", "residual"
    names = {name for name in whole.columns if name.removeprefix("block_") not in own}
    assert_same(history, whole, *names)
    np.testing.assert_array_equal(history.field("pressure"), whole.field("pressure"))
    other = scene.replace(duty=(SLOW, HEAVY, ASIDE))
    reported = r"duty\[0\]\.revolutions.*1.*2"
    with pytest.raises(ts.ResultsError, match=reported):
        ts.roll(other, path, resume=True)
    with pytest.raises(ts.ResultsError, match=r"duty.*3.*2"):
        ts.roll(scene.replace(duty=(HEAVY, SLOW)), path, resume=True)


@pytest.mark.slow
def test_files_without_the_bound_of_the_traction_resume(tmp_path):
    """Earlier versions did not store it; only one block is solved again at a time."""
    changes = ["grid.elements=[9, 11]", "wear.coefficient=1e-3", "wear.stepping=every-revolution"]
    hot = ts.Scene.builtin("hot-discs").with_set([*changes, "wear.revolutions=4"])
    long = hot.replace(duty=[{"revolutions": 1}, {**SLOW, "revolutions": 1}])
    short = long.with_set(["wear.revolutions=2"])
    ts.roll(short, tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        del file["fields/traction_bound"], file["state/traction_bound"]
    resumed = ts.roll(long, tmp_path / "a.h5", resume=True)
    np.testing.assert_allclose(resumed["Qx"], ts.roll(long)["Qx"], rtol=1e-7)  # solver: 1e-8


@pytest.mark.slow
def test_killed_spectra_continue(tmp_path):
    """More kills: benchmarks/duty.py."""
    scene = DISCS.replace(duty=(HEAVY, SLOW), **{"wear.save": (0, 5, 60)})
    (tmp_path / "scene.toml").write_text(scene.to_toml())
    found = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", KILLED_BY_ITSELF, "3"]
    run = subprocess.run(command, cwd=tmp_path, env=found, check=False)
    assert run.returncode == -signal.SIGKILL
    history, whole = ts.roll(scene, tmp_path / "a.h5", resume=True), ts.roll(scene)
    # Plans of transforms may differ between processes, and with them the last digits.
    last = whole["wear_profile"][-1]
    np.testing.assert_allclose(history["wear_profile"][-1], last, atol=1e-6 * last.max())


@pytest.mark.slow
def test_meshes_that_are_left_to_us_hold_all_blocks(tmp_path):
    wide = {"revolutions": 1, "shift_y": 0.8}
    scene = DISCS.replace(grid=None, duty=(HEAVY, wide), **{"wear.revolutions": 200})
    history = ts.roll(scene, tmp_path / "a.h5")
    assert history.finished, history.message
    assert history.grid.half_length[1] > 0.8 + history.block(1)["half_width_y"].max()
    np.testing.assert_allclose(history["block_P"][-1], [450.0, 300.0], rtol=1e-6)


def test_it_begins_with_worn_bodies():
    blocks = (HEAVY, SLOW)
    whole = rolled(*blocks, **LETTER, **{"wear.revolutions": 12})
    first = rolled(*blocks, **LETTER, **{"wear.revolutions": 6})
    second = ts.roll(first.scene, start=first)
    last = whole["wear_profile"][-1]
    np.testing.assert_allclose(second["wear_profile"][-1], last, atol=1e-9 * last.max())
    for body in "AB":
        name = f"wear_profile_{body}"
        last = whole[name][-1]
        np.testing.assert_allclose(second[name][-1], last, atol=1e-9 * last.max())


@pytest.mark.parametrize(
    ("blocks", "changes", "key"),
    [
        ([], {}, "duty"),
        ([{}], {}, "duty[0].revolutions"),
        ([HEAVY, {"revolutions": 0}], {}, "duty[1].revolutions"),
        ([HEAVY, {"revolutions": 1000}], {}, "duty"),
        ([HEAVY, {"revolutions": 1, "shift_y": 0.8}], {}, "duty[1].shift_y"),
        ([HEAVY, {"revolutions": 1, "load": {"normal": 1e5}}], {}, "duty[1]"),
        ([HEAVY, {"revolutions": 1, "load": {"force_x": 1e5}}], {}, "duty[1].load.force_x"),
        ([HEAVY, {"revolutions": 1, "load": {"heavy": 1.0}}], {}, "duty[1].load.heavy"),
        ([HEAVY], {"wear": None}, "duty"),
        ([HEAVY | {"name": "a"}, SLOW | {"name": "a"}], {}, "duty[1].name"),
        ([HEAVY, ASIDE], {"body.A.radius_y": math.inf, "grid": None}, "duty[1].shift_y"),
    ],
)
def test_faults_name_the_block(blocks, changes, key):
    with pytest.raises(ts.SceneError) as caught:
        DISCS.replace(duty=blocks, **changes)
    assert key in [fault.key for fault in caught.value.faults]


def test_a_law_without_hardness_is_reported():
    with pytest.raises(ts.SceneError) as caught:
        DISCS.with_set(["wear.law=jendel"]).replace(duty=(HEAVY,))
    assert "body.A.hardness" in [fault.key for fault in caught.value.faults]


def test_a_broken_cycle_is_noted():
    with pytest.warns(PlausibilityWarning, match=r"wear\.revolutions|duty"):
        DISCS.replace(duty=({"revolutions": 7},))


def test_a_scene_with_blocks_is_its_text():
    scene = DISCS.replace(duty=(HEAVY, ASIDE | {"name": "aside"}))
    assert ts.Scene.from_toml_text(scene.to_toml()) == scene
    text = DISCS.to_toml() + "\n[[duty]]\nrevolutions = 1\nload.normal = 450.0\n"
    assert ts.Scene.from_toml_text(text) == DISCS.replace(duty=(HEAVY,))
    contact = ts.solve(scene)
    assert pytest.approx(300.0) == contact.P


def test_it_is_reported_on_the_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(DISCS.replace(duty=(HEAVY, SLOW)).to_toml())
    for command in (["explain", "scene.toml"], ["run", "scene.toml"], ["show", "scene.h5"]):
        result = CliRunner().invoke(app, command)
        assert result.exit_code == 0, result.output
        assert "duty[1]" in result.output, command
    shown = CliRunner().invoke(app, ["show", "scene.h5", "--json"])
    assert '"block_share"' in shown.output
    shown = CliRunner().invoke(app, ["show", "scene.h5", "--csv"])
    assert "block_P duty[0]" in shown.output


def test_error_bars_of_every_block():
    scene = ts.Scene.builtin("twin-discs").replace(subsurface=None, grid=None)
    scene = scene.replace(
        duty=({"revolutions": 1}, SLOW),
        accuracy={"tolerance": 0.1, "elements": 3000},
        **{"wear.revolutions": 3, "wear.save": (0, 3)},
    )
    history = ts.roll(scene)
    bars = history["block_Qx_error"]
    assert bars.shape == (len(history), 2)
    assert (bars > 0.0).all()
    n = np.array([1.0, 2.0]) / 3.0
    np.testing.assert_allclose(history["Qx_error"], bars @ n, rtol=1e-12)
