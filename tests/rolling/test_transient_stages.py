"""Transients in stages that roll or shift: what passes from one to the next."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.contact import Model, StepInput, Stepper

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None, creepage=None)
P, Q = SPHERES.normal_load, 0.5 * SPHERES.friction.mu[0] * SPHERES.normal_load
DX = 2.0 * 4.08 / 15
LONG = 6 * DX


def scene(*stages, n=15, **changes):
    start = changes.pop("start", "rest")
    grid = {"grid.elements": (n, n)}
    return SPHERES.replace(transient={"stage": list(stages), "start": start}, **grid, **changes)


def columns(history):
    """Return the columns that two equal courses have in common, without times of computing."""
    own = {"seconds", "over_application", "stage", "stretch", "next_step"}
    return {name: history[name] for name in history.columns if name not in own}


PRESS = {"motion": "shift", "distance": [0, 1], "step": 0.25, "load.force_x": [0.0, Q]}
HOLD = {"distance": [1, 1 + LONG], "load.force_x": Q}
SPEED = {"creepage.longitudinal": [-1e-3, -2e-3], "load.normal": [P, 0.8 * P]}
CREEP = {"distance": [1 + LONG, 1 + 2 * LONG], **SPEED}
BACK = {
    "motion": "shift",
    "distance": [1 + 2 * LONG, 2 + 2 * LONG],
    "step": 0.5,
    "creepage.longitudinal": [0.0, 0.005],
    "load.approach": SPHERES.hertz.approach,
}
MIXED = scene(PRESS, HOLD, CREEP, BACK)


@pytest.fixture(scope="module")
def mixed():
    return ts.roll(MIXED)


@pytest.mark.parametrize(
    "course",
    [
        {"distance": [0, 1, 1, 2], "load.force_x": [0.0, Q, 0.5 * Q, 0.5 * Q]},
        {"distance": [0, 2], "creepage.longitudinal": [-1e-3, -2e-3], "stepping": "adaptive"},
        {"distance": [0, 1, 2], "creepage.longitudinal": [0.0, 0.01, -0.01], "step": 0.5},
    ],
)
@pytest.mark.parametrize("start", ["rest", "steady", "shift"])
def test_a_single_stage_is_the_transient_without_stages(course, start):
    if start == "steady" and course["distance"][1] == 1:
        return  # one start is enough for these
    plain = SPHERES.replace(transient={**course, "start": start}, **{"grid.elements": (15, 15)})
    shifts = start == "shift"
    stage = {**course, "motion": "shift" if shifts else "rolling"}
    staged = scene(stage, start="rest" if shifts else start)
    expected, found = columns(ts.roll(plain)), columns(ts.roll(staged))
    assert expected.keys() == found.keys()
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values, err_msg=name)


@pytest.mark.parametrize("motion", ["rolling", "shift"])
@pytest.mark.parametrize("key", ["load.force_x", "creepage.longitudinal"])
def test_a_stage_cut_in_two_gives_the_same(motion, key):
    end = 0.012 if (motion, key) == ("shift", "creepage.longitudinal") else 1.2 * Q
    end = -0.003 if (motion, key) == ("rolling", "creepage.longitudinal") else end
    steps = {"motion": motion, "step": DX}
    single = scene({"distance": [0, 8 * DX], key: [0.0, end], **steps})
    first = {"distance": [0, 4 * DX], key: [0.0, 0.5 * end], **steps}
    second = {"distance": [4 * DX, 8 * DX], key: [0.5 * end, end], **steps}
    expected, found = ts.roll(single), ts.roll(scene(first, second))
    assert list(found["stage"]) == [0.0] * 5 + [1.0] * 4
    for name in ("distance", "Qx", "shift_x", "step_work", "step_friction", "elastic_energy"):
        # Guesses differ by rounding, solutions by a tenth of the solver's tolerance at most.
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-9)


def test_the_state_passes_from_stage_to_stage(mixed):
    """The steps are those of a stepper that takes them one after another."""
    stepper = Stepper(Model(MIXED))
    result = stepper.at_rest(stepper.press(StepInput(load=P)))
    forces, shares = [result.contact.Qx], np.arange(1, 7) / 6
    inputs = [StepInput(load=P, forces=(part * Q, None)) for part in (0.25, 0.5, 0.75, 1.0)]
    inputs += [StepInput(DX, load=P, forces=(Q, None)) for _ in shares]
    inputs += [
        StepInput(DX, (-1e-3 * (1.0 + s - 1 / 12), 0.0, 0.0), P * (1.0 - 0.2 * s)) for s in shares
    ]
    inputs += [StepInput(approach=SPHERES.hertz.approach)]  # the jump from the load
    shift = 0.0025, 0.0, 0.0
    inputs += [StepInput(creepages=shift, approach=SPHERES.hertz.approach) for _ in "12"]
    for each in inputs:
        result = stepper.step(result, each)
        forces.append(result.contact.Qx)
    assert mixed.status == "done"
    np.testing.assert_allclose(mixed["Qx"], forces, rtol=1e-7)  # ten tolerances of the solver
    balance = mixed.energy_balance  # nan if nothing is supplied, as in the jump of the load
    np.testing.assert_allclose(balance[np.isfinite(balance)], 1.0, rtol=1e-9)  # rounding
    assert mixed["P"][-1] == pytest.approx(ts.solve(MIXED.replace(transient=None)).P, rel=2e-2)


def test_columns_and_units_of_stages(mixed):
    assert mixed.columns["distance"].unit == "mm"
    assert list(np.unique(mixed["stage"])) == [0.0, 1.0, 2.0, 3.0]
    rolls = np.isin(mixed["stage"], [1.0, 2.0])
    np.testing.assert_array_equal(np.isfinite(mixed["xi_x"]), rolls)
    assert MIXED.schedule.rolled(1 + 2 * LONG) == pytest.approx(2 * LONG)
    assert MIXED.schedule.rolled(2 + 2 * LONG) == pytest.approx(2 * LONG)
    assert ts.Scene.from_toml_text(MIXED.to_toml()) == MIXED


@pytest.mark.slow
def test_a_constant_creepage_after_a_shift_becomes_steady():
    creep = {"distance": [1, 1 + 90 * DX], "creepage.longitudinal": -3e-3, "stepping": "adaptive"}
    course = scene(PRESS, creep)
    steady = course.replace(transient=None, **{"creepage.longitudinal": -3e-3})
    history = ts.roll(course)
    # Interpolation in steps of several elements: of second order in the element size.
    assert history["Qx"][-1] == pytest.approx(ts.solve(steady).Qx, rel=1e-3)


def test_a_shift_begins_with_the_traction_of_steady_rolling():
    rolling = {"creepage.longitudinal": -1e-3}
    back = {"motion": "shift", "distance": [0, 1], "creepage.longitudinal": [0.0, 0.004]}
    history = ts.roll(scene(back, start="steady", **rolling))
    steady = ts.solve(SPHERES.replace(**{"grid.elements": (15, 15)}, **rolling))
    assert history["Qx"][0] == pytest.approx(steady.Qx, rel=1e-12)
    assert history["xi_x"][0] == -1e-3
    assert (np.diff(history["Qx"]) < 0.0).all()
    forced = {"motion": "shift", "distance": [0, 1], "load.force_x": [0.8 * Q, 0.9 * Q]}
    jumped = ts.roll(scene(forced, start="steady", **rolling))
    assert jumped["Qx"][0] == pytest.approx(0.8 * Q, rel=1e-6)  # the solver's tolerance


@pytest.mark.slow
@pytest.mark.parametrize("wear", [None, {"coefficient": 1e-5}])
def test_it_continues_within_and_between_stages(wear, tmp_path):
    course = MIXED.replace(wear=wear)
    whole = ts.roll(course)
    names = ["distance", "stage", "P", "Qx", "xi_x", "shift_x", "step_work", "friction_work"]
    names += ["wear_profile", "worn_volume"] if wear else []
    for after in (3, 5, 11, 18):
        path = tmp_path / f"{after}.h5"
        interrupted(course, path, after)
        found = ts.roll(course, path, resume=True)
        for name in names:  # ten tolerances of the solver
            np.testing.assert_allclose(found[name], whole[name], rtol=1e-7, atol=1e-9)


@pytest.mark.slow
def test_other_steps_of_a_stage_do_not_prevent_resuming(tmp_path):
    interrupted(MIXED, tmp_path / "a.h5", 12)
    finer = MIXED.with_set([f"transient.stage[2].step={0.5 * DX}"])
    rows = len(ts.roll(MIXED)["distance"])
    again = ts.roll(finer, tmp_path / "a.h5", resume=True)
    assert len(again["distance"]) > rows
    other = finer.with_set(["transient.stage[2].motion='shift'"])
    with pytest.raises(ts.ResultsError, match=r"stage\[2\]"):
        ts.roll(other, tmp_path / "a.h5", resume=True)


def test_wear_lies_where_the_bodies_rolled():
    course = MIXED.replace(wear={"coefficient": 1e-5})
    places, depth = ts.roll(course).worn_track
    assert places[-1] == pytest.approx(2 * LONG + 7 * DX)  # of rolling, without the shifts
    assert (depth.max(axis=1)[places > 0.0] > 0.0).any()


@pytest.mark.parametrize(
    ("transient", "key"),
    [
        ({"stage": []}, "transient.stage"),
        ({"start": "rest"}, "transient.distance"),
        ({"stage": [PRESS], "distance": [0, 1]}, "transient.distance"),
        ({"stage": [PRESS], "creepage.longitudinal": 0.1}, "transient.creepage"),
        ({"stage": [PRESS], "start": "shift"}, "transient.start"),
        ({"stage": [PRESS, CREEP]}, "transient.stage[1].distance"),
        ({"stage": [{"motion": "slide", "distance": [0, 1]}]}, "transient.stage[0].motion"),
        (
            {"stage": [{"distance": [0, 1, 2], "load.normal": [P, P]}]},
            "transient.stage[0].load.normal",
        ),
        (
            {"stage": [PRESS | {"creepage.longitudinal": 0.1}]},
            "transient.stage[0].creepage.longitudinal",
        ),
        ({"stage": [PRESS, HOLD | {"load.force_x": 9 * Q}]}, "transient.stage[1].load.force_x"),
        ({"stage": [PRESS, HOLD | {"step": 99.0}]}, "transient.stage[1].step"),
        ({"stage": [PRESS], "save": [2.0]}, "transient.save"),
    ],
)
def test_faults_name_the_key(transient, key):
    with pytest.raises(ts.SceneError) as error:
        SPHERES.replace(transient=transient)
    assert key in [fault.key for fault in error.value.faults]


@pytest.mark.parametrize(
    "changes",
    [
        {"heat": {"bulk": 20.0}},
        {"friction.law": "rational", "friction.kinetic": 0.1, "friction.half_speed": 1e3},
    ],
)
def test_what_a_shift_does_not_have_is_refused_in_its_stage(changes):
    with pytest.raises(ts.SceneError) as error:
        MIXED.replace(**{"creepage.speed": 1e4}, **changes)
    keys = [fault.key for fault in error.value.faults if fault.key.startswith("transient")]
    assert keys == ["transient.stage[0].motion", "transient.stage[3].motion"]


@pytest.mark.slow
def test_a_study_varies_a_stage(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(scene(PRESS, HOLD).to_toml())
    axis = {"key": "transient.stage[1].load.force_x", "values": [0.5 * Q, Q]}
    results = ts.study(ts.Study(scene=str(path), axis=[axis]), tmp_path / "study", workers=0)
    assert results.complete
    np.testing.assert_allclose(
        results.column("Qx"), [0.5 * Q, Q], rtol=1e-6
    )  # the solver's tolerance
