"""Courses over the distance rolled: what is stepped through, recorded, and continued from."""

import math
import re
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.contact import Model, StepInput, Stepper
from tractive_sam.run.resume import last_step
from tractive_sam.solvers import Sequential
from tractive_sam.solvers.ladder import COUPLED, FIXED_PRESSURE, NORMAL

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None, creepage=None)
P, MU = SPHERES.normal_load, SPHERES.friction.mu[0]
N = 21
DX = 2.0 * 4.08 / N


def scene(transient, n=N, slip="auto", **changes):
    return SPHERES.replace(
        transient=transient, **{"grid.elements": (n, n), "solver.slip": slip, **changes}
    )


@pytest.mark.slow
def test_a_constant_force_after_a_shift_takes_the_creepage_of_an_independent_program():
    # Printed by CONTACT; 33 elements of 0.25 mm, first-order slip.
    held = {"distance": [0, 14], "load.force_x": [0.657 * MU * P] * 2}
    grid = {"half_length": (4.125, 4.125), "elements": (33, 33)}
    history = ts.roll(SPHERES.replace(transient=held, grid=grid, **{"solver.slip": "upwind"}))
    assert history.status == "done"
    assert len(history) == 57
    found = -1e3 * history["creepage_found"][[1, 7, 12, 14, 17, 29, 56], 0]
    printed = [1.824, 2.334, 2.968, 3.403, 3.241, 3.093, 3.101]
    np.testing.assert_allclose(found, printed, atol=6e-4)  # four digits
    assert np.isnan(history["creepage_found"][0]).all()  # a shift is no creepage
    assert -history["shift_x"][0] == pytest.approx(1.774e-2, rel=5e-4)  # four digits
    np.testing.assert_allclose(history["Qx"], 0.657 * MU * P, rtol=1e-6)  # the solver's tolerance


@pytest.mark.slow
@pytest.mark.parametrize("slip", ["auto", "upwind"])
@pytest.mark.parametrize(
    "drive",
    [
        {"creepage.longitudinal": -0.003},
        {"creepage.spin": 4e-4, "creepage.lateral": 5e-4},
        {"creepage.longitudinal": -0.002, "friction.mu": (0.5, 0.25), "friction.angle": 30.0},
    ],
)
def test_in_the_end_it_is_steady(drive, slip):
    courses = {k: [v, v] for k, v in drive.items() if k.startswith("creepage")}
    others = {k: v for k, v in drive.items() if not k.startswith("creepage")}
    end = 110 * 8.16 / 15  # full elements
    history = ts.roll(scene({"distance": [0, end], **courses}, 15, slip, **others))
    steady = ts.solve(SPHERES.replace(**drive, **{"grid.elements": (15, 15), "solver.slip": slip}))
    assert history.status == "done"
    # What is left of the start falls with the distance: to the solver's tolerance after 17 a.
    size = max(MU, *np.atleast_1d(others.get("friction.mu", MU))) * P
    for name in ("Qx", "Qy"):
        assert history[name][-1] == pytest.approx(getattr(steady, name), abs=2e-6 * size)


def test_steps_meet_knots_and_saves():
    transient = {
        "distance": [0, 1.0, 1.0, 2.5],
        "creepage.longitudinal": [0, -1e-3, -1e-3, 0],
        "load.normal": [P, P, 1.2 * P, 1.2 * P],
        "save": [0.3, 1.0, 2.5],
    }
    history = ts.roll(scene(transient))
    assert history.status == "done"
    at = history["distance"]
    assert (np.diff(at) >= 0.0).all()
    for stop in (0.0, 0.3, 1.0, 2.5):
        assert stop in at
    assert np.diff(at).max() <= DX * (1.0 + 1e-6)
    assert np.count_nonzero(at == 1.0) == 2  # before and after the jump of the load
    assert history.saved.tolist() == [0.3, 1.0, 2.5]
    np.testing.assert_allclose(history.state(1.0).P, 1.2 * P, rtol=1e-9)  # a load is met exactly
    jump = int(np.flatnonzero(at == 1.0)[-1])
    np.testing.assert_allclose(history["P"][:jump], P, rtol=1e-9)
    np.testing.assert_allclose(history["P"][jump:], 1.2 * P, rtol=1e-9)
    assert math.isnan(history["xi_x"][jump])  # a shift has no creepage


def test_bodies_part_and_touch_again():
    transient = {"distance": [0, 2, 4, 6], "load.approach": [0.036, -0.01, -0.01, 0.036]}
    start = SPHERES.replace(load={"approach": 0.036}, creepage={"longitudinal": -1e-3})
    history = ts.roll(start.replace(transient=transient, **{"grid.elements": (15, 15)}))
    assert history.status == "done"
    apart = (history["distance"] > 2.0) & (history["distance"] < 4.0)
    assert apart.any()
    assert (history["P"][apart] == 0.0).all()
    assert (history["Qx"][apart] == 0.0).all()
    assert history["Qx"][-1] > 0.0
    # As solved, to 1e-8.
    assert history["P"][-1] == pytest.approx(history["P"][0], rel=1e-6)
    transient = {"distance": [0, 2], "load.approach": [0.036, -0.01]}
    ended = ts.roll(start.replace(transient=transient, **{"grid.elements": (15, 15)}))
    assert "transient.load.approach" in ended.message  # and no word of wear


def test_a_bump_travels_through_the_contact():
    x = np.linspace(-1.0, 9.0, 101)
    bump = -2e-3 * np.exp(-0.5 * ((x - 4.0) / 0.5) ** 2)
    profile = {"x": x, "y": [-9.0, 9.0], "separation": np.stack((bump, bump), axis=1)}
    transient = {"distance": [0, 8], "profile.A": profile, "save": [0, 2, 4, 6]}
    history = ts.roll(scene(transient, 31, creepage={"longitudinal": -1e-3}))
    assert history.status == "done"
    for at, place in ((2.0, 2.0), (4.0, 0.0), (6.0, -2.0)):  # x = 4 - distance
        p, without = history.field("pressure", at), history.field("pressure", 0.0)
        i = np.argmax((p - without)[:, 15])
        assert history.x[i] == pytest.approx(place, abs=1.1 * history.grid.dx)  # to an element
    with pytest.raises(ts.SceneError, match="friction"):
        ts.Scene(**scene(transient).entries() | {"friction": None})


@pytest.mark.slow
@pytest.mark.parametrize("stepping", ["even", "adaptive"])
def test_it_continues_where_it_was_stopped(tmp_path, stepping):
    transient = {
        "distance": [0, 2, 2, 5],
        "creepage.longitudinal": [0, -2e-3, -1e-3, -1e-3],
        "load.normal": [P, P, 1.1 * P, P],
        "stepping": stepping,
    }
    whole = ts.roll(scene(transient, 15))

    for count in (1, 4, len(whole) - 2):
        path = tmp_path / f"{count}.h5"
        interrupted(scene(transient, 15), path, count)
        history = ts.roll(scene(transient, 15), path, resume=True)
        assert history.status == "done"
        np.testing.assert_array_equal(history["distance"], whole["distance"])
        # Found from other first guesses, to the solver's tolerance.
        for name in ("Qx", "P", "shift_x", "elastic_energy"):
            size = np.abs(whole[name]).max()
            np.testing.assert_allclose(history[name], whole[name], atol=1e-6 * size)


def test_it_continues_from_the_two_contacts_that_it_had(tmp_path):
    transient = {
        "distance": [0, 2],
        "creepage.longitudinal": [0, -2e-3],
        "load.normal": [0.8 * P, P],
    }
    rising = scene(transient, 15)
    history = ts.roll(rising, tmp_path / "a.h5")
    last, _ = last_step(history, tmp_path / "a.h5", rising)
    for one, row in ((last.before, -2), (last.result, -1)):
        for name in ("approach", "xi_x", "Qx"):
            # Forces are summed once more.
            assert getattr(one.contact, name) == pytest.approx(history[name][row], rel=1e-12)


@pytest.mark.slow
def test_slip_of_a_shift_is_a_length(tmp_path):
    """Its numbers grow with the unit of length, so that the file must not call them pure."""
    shift = {"start": "shift", "distance": [0, 1], "step": 1.0, "creepage.longitudinal": [0, 0.01]}
    ts.roll(scene(shift, 13), tmp_path / "shift.h5")
    ts.roll(scene(shift | {"start": "rest"}, 13), tmp_path / "rolling.h5")
    for name, unit in (("shift", "mm"), ("rolling", "1")):
        with h5py.File(tmp_path / f"{name}.h5") as file:
            assert file["fields/slip_x"].attrs["units"] == unit
        slip = ts.open_history(tmp_path / f"{name}.h5").to_xarray()["slip_y"]
        assert slip.attrs["units"] == unit


@pytest.mark.slow
def test_a_loop_of_shifts_takes_mindlins_work():
    # Mindlin & Deresiewicz 1953: Cattaneo's shift of both bodies is c (1 - (1 - q)^(2/3)), with
    # q = Q/mu P and c = 3 (2 - nu) mu P/(8 G a); after the force has turned round, twice the change
    # of force takes twice the shift. So an oscillation between +-Q dissipates, by integration:
    q, a = 0.6, SPHERES.hertz.a
    loop = 1.0 - (1.0 - q) ** (5 / 3) - 5.0 * q / 6.0 * (1.0 + (1.0 - q) ** (2 / 3))
    exact = 4.8 * MU * P * (3.0 * (2.0 - 0.28) * MU * P / (8.0 * 1.0 * a)) * loop
    transient = {
        "distance": [0, 1, 2, 3],
        "load.force_x": [0, q * MU * P, -q * MU * P, q * MU * P],
        "start": "shift",
    }
    history = ts.roll(scene(transient, 45))
    assert history.status == "done"
    np.testing.assert_allclose(
        history["friction_work"],
        np.cumsum(history["step_friction"]),
        rtol=1e-12,  # equal sums
    )
    cycle = history["distance"] > 1.0
    # Of steps of a tenth of a stretch: 1.3 % measured.
    assert history["step_friction"][cycle].sum() == pytest.approx(exact, rel=0.02)
    first, last = (history["shift_x"][history["distance"] == at][0] for at in (1.0, 3.0))
    assert last == pytest.approx(first, rel=1e-4)  # the loop is closed


@pytest.mark.slow
def test_carters_cylinder_from_rest():
    # The exact solution is approached slowly: after 12 a it is still some per cent low.
    cylinders = ts.Scene.builtin("cylinders")
    a, drive = cylinders.hertz.a, cylinders.creepage.longitudinal
    transient = {"distance": [0, 3 * a, 12 * a], "creepage.longitudinal": [drive] * 3}
    grid = {"half_length": 1.2 * a, "elements": 65}
    history = ts.roll(cylinders.replace(transient=transient, grid=grid, creepage=None))
    steady = ts.solve(cylinders.replace(grid=grid)).Qx
    share = history["Qx"] / steady
    assert history.status == "done"
    assert (np.diff(share) > 0.0).all()
    assert share[0] == 0.0
    assert 0.9 < share[-1] < 0.995  # .984 measured


@pytest.mark.parametrize("n", [21, 101, 401])
def test_the_first_step_of_a_line_contact_takes_few_applications(n):
    # All strips displace each other: what slips at first sticks once all tractions have grown.
    cylinders = ts.Scene.builtin("cylinders")
    table = {"distance": [0.0, 0.02], "creepage.longitudinal": [-0.002, 0.002]}
    history = ts.roll(
        cylinders.replace(transient=table, creepage=None, subsurface=None, **{"grid.elements": n})
    )
    assert history.status == "done"
    # 17 to 50; several hundred to thousands if slip counted in full.
    assert history["operator_applications"].max() < 100


@pytest.mark.slow
@pytest.mark.parametrize(("length", "expected"), [(40.0, "low"), (0.02, "high")])
def test_a_small_oscillation_of_creepage(length, expected):
    # Waves long against the contact: the steady slope; short ones: a shift that oscillates, held by
    # 4 a G/(2 - nu) for both bodies together (8 a G/(2 - nu) of each).
    a, G, nu, small = SPHERES.hertz.a, 1.0, 0.28, 2e-6
    n = 31
    wave = length * a
    knots = np.linspace(0.0, 2.0 * wave, 49)
    creepage = small * np.sin(2.0 * np.pi * knots / wave)
    transient = {"distance": knots.tolist(), "creepage.longitudinal": creepage.tolist()}
    transient |= {"step": min(wave / 24.0, 0.9)}
    history = ts.roll(scene(transient, n))
    at, force = history["distance"], history["Qx"]
    last = at >= wave
    if expected == "low":
        slope = ts.solve(scene(None, n, creepage={"longitudinal": -small})).Qx / small
        found = -(force[last] / small)[np.argmax(np.interp(at, knots, creepage)[last])]
        assert found == pytest.approx(slope, rel=0.1)  # a wave of 40 a lags by some per cent
    else:
        shift = np.ptp(history["shift_x"][last])
        # The mesh's edge makes the contact a little larger or smaller: .3 % measured.
        assert np.ptp(force[last]) / shift == pytest.approx(4.0 * a * G / (2.0 - nu), rel=0.02)


@pytest.mark.slow
def test_random_courses_converge():
    """A few of those in `benchmarks/transient.py`, dissimilar and orthotropic ones among them."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
    try:
        from transient import random_scene  # noqa: PLC0415 - a script beside the package
    finally:
        sys.path.pop(0)
    for seed in (1, 5, 8):
        assert ts.roll(random_scene(seed, 13)).status == "done"


def test_friction_may_change_during_the_run():
    transient = {
        "distance": [0, 8, 8, 10],
        "creepage.longitudinal": [-0.02] * 4,
        "friction.mu": [0.4, 0.4, 0.2, 0.2],
    }
    history = ts.roll(scene(transient, 15))
    before, after = (np.flatnonzero(history["distance"] == 8.0)[k] for k in (0, 1))
    np.testing.assert_allclose(history["Qx_over_P"][before], 0.4, rtol=1e-3)  # slides throughout
    np.testing.assert_allclose(history["Qx_over_P"][after:], 0.2, rtol=1e-3)  # also: 2e-4


def test_what_friction_cannot_carry_ends_with_a_message():
    # Under an approach only the solution reports the load.
    pressed = scene(None, 15, load={"approach": SPHERES.hertz.approach})
    courses = {"distance": [0, 2], "load.force_x": [0, 1.5 * MU * P]}
    history = ts.roll(pressed.replace(transient=courses))
    assert history.status == "diverged"
    assert "force_x" in history.message
    assert "mm" in history.message


@pytest.mark.slow
def test_figures_of_a_transient(tmp_path):
    transient = {"distance": [0, 1, 2], "load.force_x": [0, 0.05, -0.05], "start": "shift"}
    history = ts.roll(scene(transient, 15))
    figures = {path.stem for path in ts.plot.save_all(history, tmp_path)}
    assert {"hysteresis", "energies", "stick", "pressure-over-distance", "forces"} <= figures
    assert not any("wear" in name for name in figures)
    assert ts.plot.animate(history, tmp_path / "moving.gif").stat().st_size > 0
    for draw in (ts.plot.hysteresis, ts.plot.energies, ts.plot.stick_course):
        with pytest.raises(ValueError, match="transient"):
            draw(ts.roll(SPHERES.replace(**{"grid.elements": (15, 15)})))


@pytest.mark.parametrize(
    "changes", [{}, {"body.B.shear": 3.0}, {"friction.mu": (0.4, 0.2), "friction.angle": 30.0}]
)
def test_steps_are_those_of_newtons_method_at_less_cost(changes):
    table = {"distance": [0, 3], "creepage.longitudinal": [-0.003] * 2, "creepage.spin": [1e-4] * 2}
    rolling = scene(table, **changes)
    method = COUPLED if "body.B.shear" in changes else Sequential(NORMAL, FIXED_PRESSURE)
    ours, plain = (ts.roll(rolling, solver=solver) for solver in (None, method))
    # Both to the tolerance of the scene, 1e-8, summed over a dozen steps.
    np.testing.assert_allclose(ours["Qx"], plain["Qx"], atol=1e-6 * MU * P)
    # All transforms, with those of preconditioners: .75 to .85 measured.
    assert ours["convolutions"].sum() < 0.95 * plain["convolutions"].sum()


def test_what_a_step_reports_solves_its_problem():
    """Tractions brought back to their bound at the end miss by no more than the tolerance."""
    sphere = scene({"distance": [0, 1], "creepage.longitudinal": [0, -0.003]})
    stepper = Stepper(Model(sphere))
    before = stepper.at_rest(stepper.press(StepInput(load=P)))
    found = stepper.step(before, StepInput(0.25, (-0.003, 0.001, 0.0), P))
    again = stepper.step(before, StepInput(0.25, (-0.003, 0.001, 0.0), P), found, -1.0)
    assert found.contact.residual <= sphere.solver.tolerance
    bound = MU * found.contact.pressure * (1.0 + 1e-12)  # rounding
    assert (np.hypot(*found.contact.traction) <= bound).all()
    apart = np.abs(again.contact.traction - found.contact.traction).max()
    assert apart <= 1e-6 * found.contact.pressure.max()  # a hundred tolerances


def test_shifts_go_along_a_parameter_and_not_over_millimetres():
    rolls = {"distance": [0, 1], "creepage.longitudinal": [0, -0.001]}
    shifts = rolls | {"start": "shift", "step": 0.5, "load.force_x": [0, 0.05]}
    del shifts["creepage.longitudinal"]
    over = {"grid.elements": (15, 15)}
    for table, unit in ((rolls, "mm"), (shifts, "1")):
        history = ts.roll(SPHERES.replace(transient=table, **over))
        assert history.coordinate.name == "distance"
        assert history.coordinate.unit == unit
        assert ("mm" in history.message) == (unit == "mm")
    figure = ts.plot.slip_over_revolutions(history)
    assert figure.axes[-1].get_ylabel().endswith("(mm)")  # slip itself, over no speed
    assert "mm" not in figure.axes[0].get_title()


@pytest.mark.parametrize("length", [2.2, 3.4])
def test_sliding_that_turns_round_is_tracked_in_steps_of_some_elements(length):
    """Friction that looks for its slip from farther than half an element has no solution there."""
    n = 31
    a, dx = SPHERES.hertz.a, 2.0 * SPHERES.grid.half_length[0] / n
    table = {
        "distance": [0.0, 2.0 * a, 4.0 * a],
        "creepage.longitudinal": [0.0, 0.03, -0.015],
        "creepage.lateral": [0.0, 0.009, -0.0045],
        "step": length * dx,
    }
    history = ts.roll(SPHERES.replace(transient=table, **{"grid.elements": (n, n)}))
    assert history.status == "done"
    assert history["operator_applications"].max() < 100  # 13 measured; thousands from farther


@pytest.mark.parametrize("table", ["gap", "transient.profile.B"])
def test_a_run_is_not_resumed_with_another_content_of_its_file(table, tmp_path):
    file, path = tmp_path / "bump.csv", tmp_path / "out.h5"
    text = "x,y,separation\n" + "".join(f"{x},{y},{{0}}\n" for x in (-9, 9) for y in (-9, 9))
    file.write_text(text.format(0.001))
    start_passage = scene({"distance": [0, DX], "creepage.longitudinal": [-0.001] * 2})
    start_passage = start_passage.replace(**{f"{table}.file": file})
    ts.roll(start_passage, path)
    assert ts.roll(start_passage, path, resume=True).status == "done"
    file.write_text(text.format(0.002))
    with pytest.raises(ts.ResultsError, match=re.escape(f"{table}.file")):
        ts.roll(start_passage, path, resume=True)
