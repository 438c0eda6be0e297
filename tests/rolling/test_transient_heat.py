"""Temperature of transients: it becomes steady, follows from the work of friction, and resumes."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.contact import Model
from tractive_sam.results import Grid
from tractive_sam.rolling import steps
from tractive_sam.rolling.transient import heat_memories
from tractive_sam.run import memory

GLASS = {"conductivity": 1.0, "density": 2500.0, "heat_capacity": 800.0}
STEEL = {"conductivity": 50.0, "heat_capacity": 450.0}
UNLIKE = {"body.A.thermal": STEEL, "body.B.thermal": GLASS}
CYLINDERS = ts.Scene.builtin("cylinders").replace(
    subsurface=None, creepage={"longitudinal": -0.004, "speed": 1000.0}, heat={"bulk": 20.0}
)
BODY = {"young": 208e3, "poisson": 0.3, "radius_x": 20.0, "radius_y": 20.0}
SPHERES = ts.Scene(
    body={"A": BODY, "B": BODY},
    load={"normal": 100.0},
    friction={"mu": 0.4},
    creepage={"longitudinal": -0.003, "spin": 0.02, "speed": 500.0},
    heat={"bulk": 20.0},
    grid={"half_length": (0.336, 0.336), "elements": (15, 15)},
)
DX = 0.672 / 15
HEAT_FIELDS = ("temperature_max", "temperature_mean", "heat_share")


def rolling(distance, scene=SPHERES, **changes):
    return scene.replace(transient={"distance": [0.0, distance]}, **changes)


def cylinders(n, **changes):
    half = 1.3 * CYLINDERS.hertz.a
    return CYLINDERS.replace(
        grid={"half_length": (half, 0.5)[:1], "elements": (n,)}, **changes
    ), 2.0 * half / n


def same(history, other, names=HEAT_FIELDS, **tolerance):
    for name in names:
        np.testing.assert_allclose(history[name], other[name], **tolerance)


@pytest.mark.slow
def test_it_becomes_steady_on_finer_meshes():
    errors = []
    for n in (15, 31, 61):
        scene, dx = cylinders(n)
        steady = ts.solve(scene).heat
        history = ts.roll(rolling(4 * n * dx, scene))
        assert history.status == "done"
        warm = history.state(history["distance"][-1]).heat
        missed = np.abs(warm.temperature_A - steady.temperature_A).max()
        errors.append(missed / (steady.temperature_max - 20.0))
    assert errors[-1] < 2e-3  # of the largest rise, at any element
    assert errors[-1] < 0.4 * errors[0]  # first order, and more


def test_unlike_bodies_become_steady():
    scene, dx = cylinders(31, **UNLIKE, **{"heat.bulk": {"A": 80.0, "B": 20.0}})
    steady, history = ts.solve(scene).heat, ts.roll(rolling(120 * dx, scene))
    rise = steady.temperature_max - 20.0
    # By 24 elements of the contact: 2e-3 of the rise of B.
    assert history["temperature_max"][-1] == pytest.approx(steady.temperature_max, abs=4e-3 * rise)
    assert history["heat_share"][-1] == pytest.approx(steady.share, abs=4e-3)
    warm = history.state(history["distance"][-1]).heat
    apart = (warm.temperature_A - warm.temperature_B)[warm.touching]
    assert np.abs(apart).max() < 1e-8 * rise  # of the linear system
    # At first they touch as half-spaces put together do.
    roots = np.sqrt([50.0 * 7850.0 * 450.0, 1.0 * 2500.0 * 800.0])
    first = (roots * (80.0, 20.0)).sum() / roots.sum()
    assert history["temperature_max"][0] == pytest.approx(first, rel=1e-12)


def test_steady_rolling_stays_as_warm():
    scene = rolling(6 * DX).replace(**{"transient.start": "steady"})
    found = ts.roll(scene)["temperature_max"] - 20.0
    assert found[0] == pytest.approx(ts.solve(SPHERES).heat.temperature_max - 20.0, rel=1e-9)
    np.testing.assert_allclose(found, found[0], rtol=8e-3)  # as by the mesh: 11 elements touch


def test_heat_is_the_work_of_friction():
    """All heat that bodies take up, before any leaves the margin, also if loads jump."""
    course = {
        "distance": [0.0, 3 * DX, 3 * DX, 5.5 * DX],
        "load.normal": [100.0, 100.0, 60.0, 60.0],
        "creepage.longitudinal": [0.0, -0.003, -0.003, 0.002],
    }
    model = Model(SPHERES.replace(transient=course, **{"creepage.speed": 50.0}))
    found = list(steps(model))
    assert any(one.result.shifted for one in found)
    memories, last = heat_memories(model), found[-1]
    past = last.observed["heat"].past
    taken = sum(memories[body].stored_heat(past[body]) for body in "AB")
    assert taken == pytest.approx(last.friction, rel=1e-3)  # N mm = mJ; of what has faded out
    shift = next(one for one in found if one.result.shifted)
    heat = shift.observed["heat"].heat
    assert heat.power == 0.0  # it takes no time
    assert heat.temperature_max > 20.0


def test_what_is_stored_does_not_change_what_is_computed():
    plain = ts.roll(rolling(4.5 * DX))
    saves = [0.3 * DX, 0.5 * DX, 2.2 * DX, 4.5 * DX]
    stored = ts.roll(rolling(4.5 * DX).replace(**{"transient.save": saves}))
    steps_of = np.isfinite(stored["next_step"])
    for name in (*HEAT_FIELDS, "Qx", "convolutions"):
        np.testing.assert_array_equal(stored[name][steps_of], plain[name])
    # A record between two steps is warmer than the one before and colder than the one after.
    assert (np.diff(stored["temperature_max"]) > 0.0).all()


def test_half_steps_are_as_warm():
    half = rolling(12 * DX).replace(**{"transient.step": 0.5 * DX})
    whole, halves = ts.roll(rolling(12 * DX)), ts.roll(half)
    rise = whole["temperature_max"][-1] - 20.0
    missed = np.abs(halves["temperature_max"][8::2] - whole["temperature_max"][4:])
    # The slip of a step between nodes is another one: 7 elements touch, and most of them stick.
    assert missed.max() < 4e-2 * rise
    assert missed[-1] < 1.5e-2 * rise


@pytest.mark.slow
def test_a_run_is_continued(tmp_path):
    for scene in (rolling(6 * DX), rolling(6 * DX, **UNLIKE)):
        path = tmp_path / f"{scene.thermal['B'].conductivity:g}.h5"
        interrupted(scene, path, 4)
        again = ts.roll(scene, path, resume=True)
        assert again.status == "done"
        # The error of the last extrapolation is not stored: contacts agree within their tolerance.
        same(again, ts.roll(scene), (*HEAT_FIELDS, "Qx"), rtol=1e-8)


def test_mirrored_scenes_are_mirrored():
    changes = {"creepage.spin": -0.02, "creepage.lateral": -1e-3}
    scene = SPHERES.replace(**{"creepage.lateral": 1e-3})
    one, other = (ts.roll(rolling(4 * DX, scene, **one)) for one in ({}, changes))
    same(one, other, rtol=1e-7)  # ten tolerances of the solver
    last = one["distance"][-1]
    warm, mirrored = (history.state(last).heat.temperature_A for history in (one, other))
    np.testing.assert_allclose(mirrored[:, ::-1], warm, rtol=1e-6)


def test_heat_changes_nothing_else():
    warm = ts.roll(rolling(4 * DX))
    cold = ts.roll(rolling(4 * DX, heat=None))
    same(warm, cold, ("Qx", "Mz", "convolutions", "operator_applications", "solves"), rtol=0.0)
    assert "temperature_max" not in cold.columns


def test_a_mesh_may_grow():
    load, half = 100.0, 0.8 * SPHERES.hertz.a
    narrow = Grid((half, half), (11, 11))
    course = {
        "distance": [0.0, 4 * narrow.dx, 10 * narrow.dx],
        "load.normal": [0.3 * load, 0.3 * load, load],
    }
    scene = SPHERES.replace(transient=course, grid=None)
    found = list(steps(Model(scene, grid=narrow)))
    wide = found[-1].contact.grid
    assert wide.elements > narrow.elements
    wanted = list(steps(Model(scene, grid=wide)))
    for now, then in zip(found, wanted, strict=True):
        warm, known = (one.observed["heat"].heat.temperature_max for one in (now, then))
        assert warm == pytest.approx(known, abs=1e-3 * (known - 20.0) + 1e-9)  # of the margins


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"transient.start": "shift"}, "transient.start"),
        ({"friction.temperature": [[20.0, 1.0], [500.0, 0.5]]}, "friction.temperature"),
        (
            {"wear": {"intensity": 1e-6, "temperature": [[20.0, 1.0], [500.0, 2.0]]}},
            "wear.temperature",
        ),
        ({"creepage.speed": None}, "creepage.speed"),
    ],
)
def test_what_cannot_be(changes, key):
    with pytest.raises(ts.SceneError) as error:
        rolling(1.0).replace(**changes)
    assert any(fault.key == key for fault in error.value.faults)


def test_its_memory_is_counted():
    warm, cold = (memory.contact_bytes(Model(rolling(1.0, **one))) for one in ({}, {"heat": None}))
    fields = steps(Model(rolling(DX)))
    past = next(iter(fields)).observed["heat"].past["A"]
    assert warm - cold >= 2 * past.nbytes  # of both bodies
