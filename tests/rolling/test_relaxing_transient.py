"""Transients of bodies that relax, against limits, exact histories and their own steady state."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.contact.test_relaxation import LINE, SPHERE, relaxing
from tests.scenes import interrupted
from tractive_sam.contact import Model
from tractive_sam.contact.memory import Memory
from tractive_sam.mechanics.relaxation import FadingMemory
from tractive_sam.operators import Lattice, Operators

FRICTION = {"mu": 0.3}
COUNT = 24
DX = 4.0 / COUNT
LINE = LINE.replace(**{"grid.elements": (COUNT,)}, friction=FRICTION)
SPHERE = SPHERE.replace(**{"grid.elements": (20, 20)}, friction=FRICTION)
COLUMNS = ("approach", "p_max", "Qx", "step_work", "step_bulk", "elastic_energy")


def rolling(scene, steps=6, loads=(0.8, 1.0), side=DX, **table):
    """The scene with a course of the load, and a creepage."""
    course = {
        "distance": [0.0, steps * side],
        "load.normal": [share * scene.load.normal for share in loads],
        "creepage.longitudinal": [-2e-3, -2e-3],
        "start": "steady",
    }
    return scene.replace(transient=course | table)


def at_rest(scene, loads, knots, duration, **table):
    """The scene with a course of the load over a time, without rolling."""
    loads = [share * scene.load.normal for share in loads]
    course = {"distance": knots, "load.normal": loads, "start": "shift", "duration": duration}
    return scene.replace(creepage={}, transient=course | table)


@pytest.mark.parametrize(("bodies", "step"), [("AB", 1.0), ("B", 1.0), ("B", 0.6)])
def test_steady_rolling_stays(bodies, step):
    """The step with a fraction of an element is steady as well; of line contacts to 1e-7 a step."""
    scene = relaxing(LINE, [(1.0, 0.7), (0.5, 8.0)], bodies=bodies)
    history = ts.roll(rolling(scene, loads=(1.0, 1.0), step=step * DX))
    for name in ("approach", "p_max", "My", "Qx"):
        assert history[name] == pytest.approx(history[name][0], rel=2e-6), name


def test_rolling_from_rest_becomes_steady():
    scene = relaxing(SPHERE, [(1.0, 0.3)])
    course = rolling(scene, 20, (1.0, 1.0), side=0.2, start="rest")
    history = ts.roll(course.replace(**{"transient.creepage.longitudinal": [0.0, 0.0]}))
    steady = ts.solve(scene)
    assert history["p_max"][0] > 1.2 * steady.p_max  # glassy at first
    for name in ("approach", "p_max", "My"):  # after 13 times V tau
        assert history[name][-1] == pytest.approx(getattr(steady, name), rel=1e-4)
    bulk = sum(steady.bulk_dissipation.values())
    assert history["bulk_dissipation"][-1].sum() == pytest.approx(bulk, rel=1e-4)


@pytest.mark.parametrize("bodies", ["AB", "B"])
@pytest.mark.parametrize(("length", "softening"), [(1e-6, 3.0), (1e8, 1.0)])
def test_short_and_long_times_are_elastic(bodies, length, softening):
    young = {f"body.{body}.young": LINE.body.A.young / softening for body in bodies}
    elastic = ts.roll(rolling(LINE.replace(**young)))
    history = ts.roll(rolling(relaxing(LINE, [(2.0, length)], bodies=bodies)))
    for name in ("approach", "p_max", "Qx"):
        # Relative to the datum, T = 1e8 mm leaves some 1e-5 of the memory of the approach.
        assert history[name] == pytest.approx(elastic[name], rel=2e-5), name


def test_terms_of_ratio_zero_are_elastic():
    plain = ts.roll(rolling(LINE.replace(creepage={"speed": 100.0}), 2))
    zero = ts.roll(rolling(relaxing(LINE, [(0.0, 1.0)]), 2))
    for name in ("approach", "p_max", "Qx", "step_work"):
        assert np.array_equal(plain[name], zero[name])


def test_energy_is_conserved_and_bodies_dissipate():
    """At rest, in steps of an element and of a part, with dissimilar bodies and two terms."""
    scene = relaxing(LINE, [(1.0, 0.7), (0.5, 8.0)], bodies="B")
    rolls = [rolling(scene, step=step * DX) for step in (1.0, 0.7)]
    rests = at_rest(scene, (1e-3, 1.0, 1e-3), [0.0, 1.0, 2.0], 0.02)
    for course in (*rolls, rests):
        history = ts.roll(course)
        assert np.nanmax(np.abs(history.energy_balance - 1.0)) < 1e-9
        assert (history["step_bulk"][1:, 1] > 0.0).all()
        assert not history["step_bulk"][:, 0].any()


def test_growing_contact_at_rest():
    """While it grows, the contact is that of elastic bodies (Lee & Radok 1960, J. Appl. Mech. 27).

    Their load is that of the course times the creep compliance. This also holds on a mesh.
    """
    time, steps = 0.02, 12
    scene = relaxing(SPHERE, [(2.0, 1.0)])  # 0.01 s
    loads = np.array((0.2, 1.0))
    history = ts.roll(at_rest(scene, loads, [0.0, 1.0], time, step=1.0 / steps))
    t, y = time, time / 0.01
    crept = (loads[1] - loads[0]) * (1.0 + 2.0 * (1.0 - (1.0 - np.exp(-y)) / y))
    crept += loads[0] * (1.0 + 2.0 * (1.0 - np.exp(-t / 0.01)))
    elastic = ts.solve(SPHERE.replace(**{"load.normal": crept * SPHERE.load.normal}))
    # The tractions are linear in each step: an error of second order, a sixth of y/12 squared.
    assert history["approach"][-1] == pytest.approx(elastic.approach, rel=2e-3)


@pytest.mark.slow
def test_steps_are_of_second_order():
    fine, found = 4.0 / 96, []
    scene = relaxing(LINE.replace(**{"grid.elements": (96,)}), [(1.0, 0.3)])
    for step in (8, 4, 2):
        history = ts.roll(rolling(scene, 32, (0.3, 1.0), fine, step=step * fine))
        found.append([history[name][-1] for name in ("approach", "Qx", "My")])
    first, second = np.abs(np.diff(found, axis=0))
    # A quarter by the second order; the place of the edges within elements matters as well.
    assert (second < first / 3.0).all()


def test_resumed_course_continues(tmp_path):
    """All that the next step uses is stored, also what its initial guess extrapolates."""
    scene = relaxing(SPHERE, [(1.0, 0.5)], bodies="B")
    course = rolling(scene, 4, side=0.2)
    whole = ts.roll(course)
    path = tmp_path / "roll.nc"
    interrupted(course, path, 3)
    resumed = ts.roll(course, path, resume=True)
    for name in COLUMNS:
        np.testing.assert_array_equal(whole[name], resumed[name], err_msg=name)


def test_memory_far_ahead_is_that_of_a_long_mesh():
    """Loads of random size, at 40 elements by nodes at growing distances, and all elements."""
    scene = relaxing(SPHERE, [(1.0, 5.0)])
    scene = rolling(scene, 60, side=0.2)
    memory = Memory(Model(scene))
    assert memory.zones == 2
    term, steps, m = memory.terms[0], 24, 2
    law = FadingMemory(term.elastic.A, term.elastic.B, None, 1.0, 5.0, m * 0.2)
    shape = 20 + m * (steps + 1), 20
    whole = Operators(Lattice(shape, 0.2, 0.2), law, 1.0, 5.0)
    rng, last = np.random.default_rng(3), np.zeros((3, 20, 20))
    past, exact = memory.begin(last, steady=True), np.zeros((1, *shape))
    for _ in range(steps):
        loads = last.copy()
        loads[0] += 1.0 + rng.random((20, 20))
        recalling = memory.recall(past, last, m, 0.0)
        past = memory.after(past, last, recalling, loads, 1)
        change = np.zeros((1, *shape))
        change[0, :20] = (last - loads)[0]
        moved = np.zeros_like(exact)
        moved[:, :-m] = exact[:, m:]
        exact, last = np.exp(-m * 0.2 / 5.0) * moved + whole.normal(change), loads
    found = memory.displacement(past)[0, 0]
    # Beyond the long mesh nothing came: as many steps as it is longer than the mesh.
    assert found == pytest.approx(exact[0, :20], abs=2e-4 * np.abs(exact).max())


@pytest.mark.parametrize("scene", [LINE, SPHERE])
def test_forecast_counts_the_memory(scene):
    """Each term adds as many convolutions to a step as the forecast says, within a factor of 2."""
    side = 2.0 * scene.grid.half_length[0] / scene.grid.elements[0]
    work, added = [], []
    for terms in ([(0.5, 0.5)], [(0.5, 0.5), (0.5, 0.6)]):
        course = rolling(relaxing(scene, terms), 3, side=side)
        work.append(Memory(Model(course)).work_of_steps[1])
        added.append(ts.roll(course)["convolutions"][2:].mean())
    assert 0.5 < (added[1] - added[0]) / (work[1] - work[0]) < 2.0


@pytest.mark.parametrize(
    ("key", "table"),
    [
        ("transient.duration", {"duration": 1.0}),
        ("transient.duration", {"start": "shift", "duration": -1.0}),
        ("transient.duration", {"start": "shift", "duration": 0.0}),
    ],
)
def test_faults_name_the_key(key, table):
    with pytest.raises(ts.SceneError) as error:
        rolling(relaxing(LINE, [(1.0, 1.0)]), **table)
    assert key in str(error.value)


def test_elastic_shifts_take_no_time():
    with pytest.raises(ts.SceneError, match=r"transient\.duration"):
        at_rest(LINE, (0.5, 1.0), [0.0, 1.0], 1.0)


def test_rolling_needs_a_speed():
    scene = relaxing(LINE, [(1.0, 1.0)])
    with pytest.raises(ts.SceneError, match=r"creepage\.speed"):
        rolling(scene).replace(creepage={})
