"""Wear within a transient: it is the material's, travels with it, and changes the next contact."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.contact import choose_grid
from tractive_sam.schema import PlausibilityWarning

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None, creepage=None)
P, MU, A, P0 = SPHERES.normal_load, SPHERES.friction.mu[0], SPHERES.hertz.a, SPHERES.hertz.p0
N = 21
DX = 2.0 * 4.08 / N
LITTLE = 1e-3  # /MPa: too little to change the contact


def scene(transient, n=N, wear=LITTLE, **changes):
    table = wear if isinstance(wear, dict) else {"intensity": wear}
    return SPHERES.replace(transient=transient, wear=table, **{"grid.elements": (n, n), **changes})


def rolling(steps, creepage=-0.0031, dx=DX, **table):
    return {"distance": [0, steps * dx], "creepage.longitudinal": [creepage] * 2, **table}


def revolution(n, wear=LITTLE, creepage=-0.0031, **changes):
    """Depth that one steady revolution wears across the track."""
    table = {"revolutions": 1, "turns": "equal", "stepping": "every-revolution"}
    steady = SPHERES.replace(
        wear=table | {"intensity": wear},
        creepage={"longitudinal": creepage},
        **{"grid.elements": (n, n), **changes},
    )
    history = ts.roll(steady)
    return history["wear_profile"][1] - history["entering_profile"][1]


def test_material_that_passes_a_constant_course_wears_as_in_a_revolution():
    n = 23
    dx = 2.0 * 4.08 / n
    history = ts.roll(scene(rolling(21, dx=dx, start="steady"), n))
    steady = revolution(n)
    assert history.status == "done"
    # Equal work of every particle, to the residual of both, 3e-5 of the depth.
    np.testing.assert_allclose(history["wear_profile"][-1], steady, atol=1e-4 * steady.max())


@pytest.mark.slow
def test_first_order_slip_wears_more_of_its_work_in_a_transient():
    # Steady, it takes the slip of one face with the pressure of the element; of the particle the
    # mean of its ways. They meet with the mesh, in first order.
    apart = []
    for n in (15, 30):
        dx, steps = 2.0 * 4.08 / n, round(0.93 * n)
        changes = {"solver.slip": "upwind"}
        history = ts.roll(scene(rolling(steps, dx=dx, start="steady"), n, **changes))
        steady = revolution(n, **changes)
        apart.append(history["wear_profile"][-1].sum() / steady.sum() - 1.0)
    assert 0.0 < apart[1] < 0.65 * apart[0]  # .5 of first order; .47 measured


@pytest.mark.slow
def test_worn_bodies_feed_back_as_in_a_revolution():
    # So much wears in a pass that Q_x changes by 0.4 %.
    n, much = 23, 5.0
    dx = 2.0 * 4.08 / n
    with pytest.warns(PlausibilityWarning):
        history = ts.roll(scene(rolling(42, dx=dx, start="steady"), n, much))
    with pytest.warns(PlausibilityWarning):
        steady = revolution(n, much)
    # Within the contact depths belong to half an element later: 1e-3 of them here, a third less on
    # 45 elements.
    np.testing.assert_allclose(history["wear_profile"][-1], steady, atol=2e-3 * steady.max())
    apart = history["Qx"] - history["Qx"][-1]
    assert abs(apart[0]) > 2e-3 * history["Qx"][-1]  # .4 % measured
    assert abs(apart[-10]) < 1e-4 * history["Qx"][-1]  # it has settled: 1.4e-5


@pytest.mark.slow
def test_a_ball_that_slides_to_and_fro_wears_by_pressure_and_sliding_distance():
    # Johnson 1985, eq. 3.91: of full traction mu p in x both bodies are displaced by
    # u = pi mu p0 (4 (2 - nu) a^2 - (4 - 3 nu) x^2 - (4 - nu) y^2)/(16 G a). Once all slides, a
    # stroke of 2 D slips 2 (D - u), the first one half as far; the wear is i p times that.
    G, nu, i = 1.0, 0.28, 1e-6
    stroke = 4.0 * 3.0 * (2.0 - nu) * MU * P / (8.0 * G * A)
    courses = {"distance": [0, 1, 2, 3], "creepage.longitudinal": [0, stroke, -stroke, stroke]}
    for steps in (4, 12):
        history = ts.roll(scene(courses | {"start": "shift", "step": 1 / steps}, 41, i))
        x, y = history.x[:, None], history.y[None, :]
        u = 4.0 * (2.0 - nu) * A**2 - (4.0 - 3.0 * nu) * x**2 - (4.0 - nu) * y**2
        slipped = 5.0 * (stroke - np.pi * MU * P0 / (16.0 * G * A) * u)
        exact = i * P0 * np.sqrt(np.maximum(1.0 - (x**2 + y**2) / A**2, 0.0)) * slipped
        inside = np.hypot(x, y) < 0.9 * A  # the edge is a staircase
        missed = np.abs(history.field("wear") - exact)[inside].max() / exact.max()
        lost = history["worn_volume"][-1].sum() / (exact.sum() * history.grid.element_area)
        # The error of the mesh (1.9e-3 of each), for any step: friction works with its end.
        assert missed < 0.003
        assert lost == pytest.approx(1.0, abs=0.003)
        assert history["wear_max"][-1] == history.field("wear").max()


@pytest.mark.parametrize(
    ("slip", "step"),
    [("auto", None), ("auto", 0.5 * DX), ("auto", 1.7 * DX), ("upwind", 1.7 * DX)],
)
def test_what_is_worn_lies_on_the_track(slip, step):
    table = {
        "distance": [0, 6 * DX, 9 * DX, 24 * DX],
        "creepage.longitudinal": [0, 0, -4e-3, 0],
        **({} if step is None else {"step": step}),
    }
    history = ts.roll(scene(table, **{"solver.slip": slip}))
    places, depth = history.worn_track
    assert (np.diff(places) > 0.0).all()
    sections = depth.sum(axis=1) * history.grid.dy
    volume = trapezoid(sections, places)
    whole = history["worn_volume"][-1].sum()
    # By trapezia between places: of steps of one element a sum, of others 3 % off.
    assert volume == pytest.approx(whole, rel=1e-12 if step is None else 0.03, abs=0.0)
    assert history["step_worn"].sum() == pytest.approx(whole, rel=1e-12, abs=0.0)  # rounding
    # The depth is largest at the place of the contact when it slid most, after its front has
    # passed.
    deepest = places[depth.max(axis=1).argmax()]
    assert 4 * DX < deepest < 20 * DX
    assert depth.max() == pytest.approx(history["wear_max"][-1], rel=1e-12, abs=0.0)  # the same


@pytest.mark.parametrize("step", [None, 0.6 * DX])
def test_it_wears_by_the_work_of_friction(step):
    history = ts.roll(scene(rolling(8, step=step)))
    assert history.status == "done"
    work = history["step_friction"]
    worn = work > 1e-6 * work.max()  # in others work on a few elements is negative, and wears none
    # As far as steps are solved: 3e-8 measured.
    np.testing.assert_allclose(history.wear_balance[worn], 1.0, rtol=1e-6)
    np.testing.assert_allclose(history["step_worn"][worn], LITTLE / MU * work[worn], rtol=1e-6)


def test_shifts_wear_by_the_work_of_friction_as_their_steps_become_small():
    """The work of a step follows the mean of its tractions: of second order."""
    apart = []
    for step in (0.2, 0.1):
        table = {"distance": [0, 1, 2], "load.force_x": [0, 0.1, -0.1], "start": "shift"}
        history = ts.roll(scene(table | {"step": step}))
        by_work = LITTLE / MU * history["step_friction"].sum()
        apart.append(history["step_worn"].sum() / by_work - 1.0)
    assert 0.0 < apart[1] < 0.35 * apart[0]  # .28 measured
    assert apart[1] < 0.02  # .007 measured


def test_orthotropic_wear_is_within_its_coefficients():
    table = rolling(8) | {"creepage.lateral": [-1e-3] * 2}
    law = {"intensity": (LITTLE, 0.3 * LITTLE)}
    history = ts.roll(scene(table, wear=law, **{"friction.mu": (0.4, 0.2), "friction.angle": 30.0}))
    known = history.wear_balance[1:]
    np.testing.assert_array_equal(known, 1.0)


def test_each_body_has_its_share():
    by_hardness = {"body.A.hardness": 1.0, "body.B.hardness": 3.0}
    history = ts.roll(scene(rolling(16), **by_hardness))
    lost, behind = (history[name] for name in ("worn_volume", "wear_profile"))
    np.testing.assert_allclose(lost[-1, 0], 0.75 * lost[-1].sum(), rtol=1e-12)  # rounding
    np.testing.assert_allclose(history["wear_profile_A"], 0.75 * behind, rtol=1e-12)
    own = {"law": {"A": "archard", "B": "energy"}, "coefficient": {"A": 1.0, "B": 3.0 / MU}}
    apart = ts.roll(scene(rolling(16), wear=own))
    # k of the energy law in mm3/J is Archard's k over mu, and 1e3 i.
    ratio = apart["worn_volume"][-1] / lost[-1].sum()
    np.testing.assert_allclose(ratio, [1.0, 3.0], rtol=1e-5)  # tractions slip as solved: 9e-7


def test_archards_law_counts_the_sliding_distance_whatever_the_friction():
    table = {"distance": [0, 30 * DX], "creepage.longitudinal": [-0.1] * 2}
    both = [ts.roll(scene(table | changes)) for changes in ({}, {"friction.mu": [MU, MU / 2]})]
    # Full slip by the creepage: elastic slip is another one, of a tenth; 1.2 % measured.
    first, weaker = (history["step_worn"][-1] for history in both)
    assert weaker == pytest.approx(first, rel=0.02)
    assert np.isnan(both[1].wear_balance).all()


@pytest.mark.slow
@pytest.mark.parametrize("start", ["rest", "shift"])
@pytest.mark.parametrize(("stepping", "counts"), [("even", (1, -1)), ("adaptive", (4,))])
def test_it_continues_where_it_was_stopped(tmp_path, start, stepping, counts):
    courses = {"distance": [0, 2, 3], "load.force_x": [0, 0.1, -0.05]}
    how = {"start": start, "stepping": stepping, "tolerance": 1e-2}
    wears = scene(courses | how, 15, wear=10 * LITTLE)
    whole = ts.roll(wears)

    for count in counts:
        path = tmp_path / f"{count}.h5"
        interrupted(wears, path, count % len(whole))
        history = ts.roll(wears, path, resume=True)
        assert history.status == "done"
        np.testing.assert_array_equal(history["distance"], whole["distance"])
        # Found from other first guesses, to the solver's tolerance.
        for name in ("worn_volume", "wear_max", "wear_profile", "wear_profile_A", "step_worn"):
            size = np.abs(whole[name]).max()
            np.testing.assert_allclose(history[name], whole[name], atol=1e-6 * size)


def test_the_contact_is_that_of_the_worn_bodies():
    shifts = {"distance": [0, 1, 2], "creepage.longitudinal": [0, 0.1, -0.1], "start": "shift"}
    missed = []
    for step in (0.1, 0.05):
        history = ts.roll(scene(shifts | {"step": step}, wear=1.0))
        found = history.state(2.0)
        again = ts.solve(SPHERES.replace(**{"grid.elements": (N, N)}), wear=found.wear)
        missed.append(np.abs(again.pressure - found.pressure).max() / P0)
    # Enough to be seen: 5 % of the approach and 3.4 % of the pressure.
    assert found.wear.max() > 0.04 * found.approach
    assert again.p_max < 0.97 * P0
    # The gap of a step holds the wear that the one before foretold: second order.
    assert missed[1] < 0.3 * missed[0]  # .23 measured
    assert missed[1] < 1e-3  # 3.4e-4 measured


def test_a_line_contact_wears_too():
    cylinders = ts.Scene.builtin("cylinders")
    a = cylinders.hertz.a
    grid = {"half_length": 1.2 * a, "elements": 33}
    table = {"distance": [0, 3 * a], "creepage.longitudinal": [-0.001] * 2, "start": "steady"}
    history = ts.roll(
        cylinders.replace(creepage=None, transient=table, grid=grid, wear={"coefficient": 1e-4})
    )
    assert history.status == "done"
    np.testing.assert_allclose(history.wear_balance[1:], 1.0, rtol=1e-6)  # 1e-8, as solved
    assert history.worn_track[1].shape[1] == 1


def test_worn_bodies_begin_worn_and_flat_ones_lose_volume():
    discs = ts.Scene.builtin("twin-discs-isotropic").replace(
        **{"grid.elements": (15, 35), "wear.revolutions": 400, "wear.save": (400,)}
    )
    worn = ts.roll(discs)
    table = {"distance": [0, 0.3], "creepage.longitudinal": [-0.005] * 2}
    wear = {"intensity": discs.wear.intensity}
    going_on = discs.replace(transient=table, wear=None, creepage=None).replace(wear=wear)
    history = ts.roll(going_on, start=worn)
    assert history.status == "done"
    np.testing.assert_array_equal(history["wear_max"][0], worn["wear_max"][-1])
    np.testing.assert_array_equal(history["worn_volume"][0], worn["worn_volume"][-1])
    gained = history["worn_volume"][-1] - history["worn_volume"][0]
    # What rounding leaves of a difference of volumes a million times as large.
    assert gained.sum() == pytest.approx(history["step_worn"].sum(), rel=1e-8, abs=0.0)
    assert (history["wear_profile_A"][-1] >= history["wear_profile_A"][0] - 1e-15).all()
    with pytest.raises(ts.ResultsError, match="transient"):
        ts.roll(discs, start=history)


def test_what_wears_too_deep_in_a_step_ends_with_a_message():
    with pytest.warns(PlausibilityWarning):
        history = ts.roll(scene(rolling(8, -0.02), wear=1e3))
    assert history.status == "out of iterations"
    assert "transient.step" in history.message


def test_parts_of_an_element_between_dissimilar_bodies_are_noted():
    def remarks(part, **changes):
        table = rolling(2, step=part * DX)
        return "transient.step" in ts.roll(scene(table, wear=LITTLE, **changes)).message

    rigid = {"body.A.shear": 2.0, "body.A.poisson": 0.4, "body.B.shear": 1e3}
    assert remarks(0.5, **rigid)
    assert not remarks(1.0, **rigid)
    assert not remarks(0.5)  # equal bodies: 2e-3


def test_the_track_does_not_hang_on_what_is_stored():
    whole = ts.roll(scene(rolling(30)))
    early = ts.roll(scene(rolling(30, save=[5 * DX])))
    places, depth = early.worn_track
    assert places[-1] == pytest.approx(early["distance"][-1] + early.grid.x[0])  # nothing beyond it
    known = np.interp(places, whole.worn_track[0], whole.worn_track[1].max(axis=1))
    # Equal records at equal places, up to rounding of the places.
    np.testing.assert_allclose(depth.max(axis=1), known, atol=1e-6 * known.max())


def test_adaptive_steps_that_wear_too_deep_are_shortened():
    course = {"distance": [0, 0.35], "creepage.longitudinal": [0, 0.035], "start": "shift"}
    even, adaptive = {"step": 0.1}, {"step": 0.1, "stepping": "adaptive", "tolerance": 0.1}
    with pytest.warns(PlausibilityWarning):
        ended, done = (ts.roll(scene(course | steps, wear=30.0)) for steps in (even, adaptive))
    assert ended.status == "out of iterations"
    assert done.status == "done"
    assert np.diff(done["distance"]).min() < 0.1  # transient.step


def test_a_chosen_mesh_is_wide_enough_for_wear():
    chosen = SPHERES.replace(grid=None)
    table = {"distance": [0, 1], "creepage.longitudinal": [-0.001] * 2}
    shifts = {"distance": [0, 1], "creepage.longitudinal": [0, 0.01], "start": "shift"}
    wear = {"intensity": LITTLE}
    plain, rolled, slid = (
        choose_grid(chosen.replace(transient=one, wear=worn)).half_length
        for one, worn in ((table, None), (table, wear), (shifts, wear))
    )
    assert rolled[1] > plain[1]
    assert rolled[0] == plain[0] < slid[0]


def test_scenes_without_wear_have_nothing_of_it():
    history = ts.roll(SPHERES.replace(transient=rolling(2), **{"grid.elements": (15, 15)}))
    assert not {"step_worn", "worn_volume"} & set(history.columns)
    assert not history["wear_max"].any()
    with pytest.raises(ValueError, match="worn_track"):
        _ = history.worn_track


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_its_figures(tmp_path):
    rolled = ts.roll(scene(rolling(20)))
    figures = {path.stem for path in ts.plot.save_all(rolled, tmp_path)}
    assert {
        "worn-track",
        "wear-depth",
        "wear-profiles",
        "wear-over-distance",
        "worn-mass",
    } <= figures
    shifts = {"distance": [0, 1], "creepage.longitudinal": [0, 0.1], "start": "shift"}
    figures = {path.stem for path in ts.plot.save_all(ts.roll(scene(shifts)), tmp_path / "shift")}
    assert "wear-depth" in figures
    assert "worn-track" not in figures
