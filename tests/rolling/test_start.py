"""A roll that begins with the worn bodies of another."""

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.cli.program import app

DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None)
DISCS = DISCS.with_set(
    [
        "grid.half_length=[0.35, 0.7]",
        "grid.elements=[15, 21]",
        "wear.revolutions=4",
        'wear.stepping="every-revolution"',
    ]
)
EACH = DISCS.with_set(["body.B.radius_x=20.0", "wear.turns=each"])
SHARED = EACH.with_set(["body.A.hardness=3", "body.B.hardness=1"])
OWN = EACH.with_set(['wear.law={A="usfd", B="archard"}', "wear.coefficient.B=1e-3"])


@pytest.mark.parametrize("scene", [DISCS, SHARED, OWN], ids=["equal", "shared", "own"])
def test_two_rolls_are_one(scene):
    """Equal scenes: as many revolutions in two parts as in one."""
    whole = ts.roll(scene.with_set(["wear.revolutions=8"]))
    first = ts.roll(scene)
    second = ts.roll(scene, start=first)
    # If the turns of both bodies are counted, the entering depth depends on the digits of two sums.
    close = {"rtol": 1e-7, "atol": 1e-14}
    for name in ("wear_max", "worn_volume", "wear_profile", "wear_profile_A", "wear_profile_B"):
        np.testing.assert_allclose(second[name][1:], whole[name][5:], **close, err_msg=name)
    # Revolution 0 is the contact between both: nothing is worn in it.
    np.testing.assert_allclose(second["worn_volume"][0], first["worn_volume"][-1], rtol=1e-10)
    assert second["worn_area"][0] == 0.0


def test_a_third_roll_knows_what_each_body_lost_by_either_law():
    first = ts.roll(SHARED)
    second = ts.roll(
        SHARED.replace(**{"body.A.hardness": 1.0, "body.B.hardness": 3.0}), start=first
    )
    for body, share in (("A", (0.25, 0.75)), ("B", (0.75, 0.25))):
        lost = second[f"wear_profile_{body}"][0]
        turns = {"A": 1.0, "B": EACH.body.A.radius_x / 20.0}[body]
        entering = first["entering_profile"][-1]
        worn = first["wear_profile"][-1] - entering
        gain = SHARED.turns.gain
        wanted = share[0] * turns * (entering / gain + worn)
        np.testing.assert_allclose(lost, wanted, rtol=1e-10, atol=1e-15)
    # What is worn from here on is shared by the other hardness.
    more = second["worn_volume"][-1] - second["worn_volume"][0]
    radii = np.array([EACH.body.A.radius_x, 20.0])
    turns = np.array([1.0, radii[0] / radii[1]])
    assert more[0] / more[1] == pytest.approx(
        (0.75 * turns[0] * radii[0]) / (0.25 * turns[1] * radii[1]), rel=1e-9
    )
    third = ts.roll(SHARED, start=second)
    np.testing.assert_allclose(third["worn_volume"][0], second["worn_volume"][-1], rtol=1e-9)


def test_from_a_state_and_onto_another_mesh():
    first = ts.roll(DISCS)
    by_state = ts.roll(DISCS, start=first.state(4))
    by_history = ts.roll(DISCS, start=first)
    np.testing.assert_allclose(by_state["wear_max"], by_history["wear_max"], rtol=1e-12)
    finer = DISCS.with_set(["grid.elements=[15, 31]", "wear.revolutions=1"])
    other = ts.roll(finer, start=first)
    lost = np.interp(other.y, first.y, by_history["wear_profile"][0])
    np.testing.assert_allclose(other["wear_profile"][0], lost, atol=1e-15)


@pytest.mark.slow
def test_a_mesh_that_grows_knows_what_was_worn_next_to_it():
    first = ts.roll(DISCS)
    free = DISCS.replace(grid=None).with_set(["wear.stepping=adaptive", "wear.revolutions=400"])
    history = ts.roll(free, start=first)
    assert history.finished
    assert (history["wear_profile"][-1] >= history["wear_profile"][0] - 1e-15).all()


@pytest.mark.slow
def test_it_is_kept_where_it_began(tmp_path):
    path = tmp_path / "b.h5"
    first = ts.roll(DISCS, tmp_path / "a.h5")
    second = ts.roll(DISCS, path, start=first)
    assert "revolution 4" in second.started
    assert "orthotropic" in second.started
    assert ts.open_history(path).started == second.started
    third = ts.roll(DISCS, start=second)
    assert second.started in third.started
    shown = CliRunner().invoke(app, ["show", str(path)])
    assert "began with" in shown.stdout


@pytest.mark.slow
@pytest.mark.parametrize("scene", [SHARED, OWN], ids=["shared", "own"])
def test_it_resumes_as_it_began(tmp_path, scene):
    first, path = ts.roll(DISCS), tmp_path / "b.h5"
    first = ts.roll(scene)
    whole = ts.roll(scene, start=first)
    interrupted(scene, path, 3, start=first)
    history = ts.roll(scene, path, resume=True)
    for name in ("wear_max", "worn_volume", "wear_profile_A", "wear_profile_B"):
        np.testing.assert_array_equal(history[name], whole[name])
    assert history.started == whole.started
    assert ts.roll(scene, path, resume=True, start=first).finished
    with pytest.raises(ts.ResultsError, match="start"):
        ts.roll(scene, path, resume=True, start=whole)


def test_other_bodies_are_refused():
    first = ts.roll(DISCS)
    with pytest.raises(ts.ResultsError, match=r"body\.A\.radius_x"):
        ts.roll(DISCS.with_set(["body.A.radius_x=32"]), start=first)
    with pytest.raises(TypeError, match=r"start.*History"):
        ts.roll(DISCS, start="a.h5")
    with pytest.raises(ts.ResultsError, match="history"):
        ts.roll(OWN, start=ts.roll(OWN).state(4))


def test_from_the_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ts.roll(DISCS, "a.h5")
    (tmp_path / "scene.toml").write_text(DISCS.to_toml())
    run = ["run", "scene.toml", "--set", "load.normal=400", "--start"]
    result = CliRunner().invoke(app, [*run, "a.h5", "-o", "b.h5"])
    assert result.exit_code == 0, result.output
    assert ts.open_history("b.h5")["wear_max"][0] > 0.0
    for other, key in (("none.h5", "none.h5"), ("a.h5", "radius_x")):
        requested = [*run, other, "--set", "body.A.radius_x=32", "-o", "c.h5"]
        result = CliRunner().invoke(app, requested)
        assert result.exit_code == 2
        assert key in result.output
