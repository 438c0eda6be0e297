"""Fatigue of transients: the stress that each point of the material lives through."""

import math

import numpy as np
import pytest

import tractive_sam as ts

LINE = ts.Scene(
    body={
        "A": {"young": 210e3, "poisson": 0.3, "radius_x": 10.0, "radius_y": math.inf},
        "B": {"young": 210e3, "poisson": 0.3, "radius_x": math.inf, "radius_y": math.inf},
    },
    load={"normal": 500.0},
    friction={"mu": 0.6},
    grid={"half_length": 0.3, "elements": 81},
)
CROSSLAND = {"criterion": "crossland", "sensitivity": 0.2, "limit": 250.0, "shear_yield": 300.0}
SHORT = {"elements": 8, "bodies": ["A"]}
SPHERES = ts.Scene.builtin("spheres").replace(
    subsurface=None, creepage=None, grid={"half_length": [4.1, 4.1], "elements": [15, 15]}
)
PEAK = 0.6
"""Largest force over the force of gross slip."""


def fretting(criterion, signs=(1, -1, 1), **changes):
    """A cylinder under a constant load and a tangential force that changes its sign."""
    force = [0.0, *(0.6 * 500.0 * PEAK * sign for sign in signs)]
    course = {"start": "shift", "distance": list(range(len(force))), "load.force_x": force}
    return LINE.replace(
        load={"normal": 500.0, "force_x": 0.0}, transient=course | changes, fatigue=criterion
    )


@pytest.fixture(scope="module")
def cycled():
    """A history in which only the stress after the first peak counts."""
    return ts.roll(fretting(CROSSLAND | SHORT, cycle_start=1.0))


def mindlin(x, a, p0, forces):
    """Yield tangential tractions on A for forces over the force of gross slip, from peak to peak.

    Cattaneo and Mindlin: each change of the force adds the traction of full slip less the traction
    of a stick zone with a width that follows from half the change.
    """

    def partial(share):
        c = a * math.sqrt(1.0 - share)
        full = np.sqrt(np.maximum(1.0 - (x / a) ** 2, 0.0))
        return 0.6 * p0 * (full - c / a * np.sqrt(np.maximum(1.0 - (x / c) ** 2, 0.0)))

    first = partial(PEAK)
    for force in forces:
        yield first - 2.0 * partial((PEAK - force) / 2.0) if force < PEAK else first


def flamant(x, depth, at):
    """Stress xx, yy, zz, xy, xz, yz in the half-plane of A under unit loads at many places.

    Returns the stress from the pressure and from the traction at `at`, two arrays of shape
    (6, len(x), len(at)).
    """
    dx, r = x[:, None] - at, at[1] - at[0]
    both = -2.0 / math.pi * r / (dx**2 + depth**2) ** 2
    # Body A lies at z > 0, and the traction acts on it: a pull to +x ahead of it compresses.
    xx, zz, xz = dx**2, depth**2, dx * depth
    none = np.zeros_like(dx)
    direction = np.array([xx, 0.3 * (xx + zz), zz + none, none, xz, none])
    return both * depth * direction, both * dx * direction


@pytest.mark.slow
def test_fretting_of_a_cylinder_is_that_of_the_closed_form(cycled):
    """Crossland's stress of the fields of Cattaneo and Mindlin, integrated independently."""
    fatigue, hertz = cycled.fatigue("A"), LINE.hertz
    at = np.linspace(-hertz.a, hertz.a, 1001)
    pressure = hertz.p0 * np.sqrt(1.0 - (at / hertz.a) ** 2)
    # The body returns by the mirror image, with equal tractions of the other sign.
    tractions = np.array(list(mindlin(at, hertz.a, hertz.p0, np.linspace(PEAK, -PEAK, 11))))
    tractions = np.concatenate([tractions, -tractions])
    criterion = ts.Crossland(sensitivity=0.2)
    x = np.linspace(-5.0, 5.0, 501) * hertz.a
    for k in (2, 4, 6):
        normal, tangential = flamant(x, fatigue.depth[k], at)
        fields = (normal @ pressure)[:, None] + np.moveaxis(tangential @ tractions.T, -1, 1)
        wanted = criterion(fields).max() / 250.0
        # The mesh has 63 elements across the contact.
        np.testing.assert_allclose(fatigue.utilisation[0, k], wanted, rtol=5e-3)


@pytest.mark.parametrize(
    "criterion",
    [
        "dang-van",
        pytest.param("findley", marks=pytest.mark.slow),
        pytest.param("orthogonal-shear", marks=pytest.mark.slow),
    ],
)
def test_a_steady_transient_has_the_utilisation_of_steady_rolling(criterion):
    fatigue = {"criterion": criterion, "limit": 250.0, "shear_yield": 300.0, "elements": 8}
    if criterion != "orthogonal-shear":
        fatigue["sensitivity"] = 0.3
    scene = LINE.replace(creepage={"longitudinal": -2e-3}, fatigue=fatigue)
    steady = ts.fatigue(ts.solve(scene))
    distance = [0.0, 14 * 0.6 / 81]  # full elements: no stress is interpolated in the contact
    history = ts.roll(scene.replace(transient={"distance": distance, "start": "steady"}))
    for body, wanted in steady.items():
        found = history.fatigue(body)
        # Between the last columns of a path, far outside, it is interpolated.
        np.testing.assert_allclose(found.utilisation, wanted.utilisation, rtol=3e-3)
        np.testing.assert_allclose(found.shakedown_upper, wanted.shakedown_upper, rtol=1e-6)
        np.testing.assert_allclose(found.shakedown_lower, wanted.shakedown_lower, rtol=1e-6)


def test_rolling_from_rest_becomes_steady_rolling():
    """The bodies slip everywhere after the first elements."""
    coarse = {"half_length": 0.3, "elements": 41}
    scene = LINE.replace(creepage={"longitudinal": -0.1}, fatigue=CROSSLAND | SHORT, grid=coarse)
    steady = ts.fatigue(ts.solve(scene))["A"]
    history = ts.roll(scene.replace(transient={"distance": [0.0, 0.8]}))
    found = history.fatigue("A").utilisation
    np.testing.assert_allclose(found, steady.utilisation, rtol=0.01)
    # Pressed bodies that begin to roll have not had any traction yet.
    assert history["utilisation"][0, 0] < 0.8 * history["utilisation"][-1, 0]


def test_the_other_sign_of_a_course_is_its_mirror_image(cycled):
    there, back = cycled, ts.roll(fretting(CROSSLAND | SHORT, (-1, 1, -1), cycle_start=1.0))
    np.testing.assert_allclose(there["utilisation"][-1], back["utilisation"][-1], rtol=1e-6)
    place = abs(there["utilisation_at"][-1, 0, 0])
    # The crack of fretting starts at the edge of the contact.
    assert abs(place - LINE.hertz.a) < 2.0 * there.grid.dx
    assert there["utilisation_at"][-1, 0, 2] == 0.0


def test_a_longer_history_has_no_smaller_ball():
    history = ts.roll(fretting(CROSSLAND | SHORT))
    used = history["utilisation"][:, 0]
    used = used[np.isfinite(used)]
    assert used.size == 4  # records at the knots, which are stored
    assert (np.diff(used) >= -1e-12).all()
    life = history["fatigue_life"][-1, 0]
    assert life == pytest.approx(1e7 * used[-1] ** -10.0, rel=1e-9)
    assert history["damage"][-1, 0] == pytest.approx(1.0 / life)


@pytest.mark.slow
def test_what_is_stored_does_not_change_it():
    few, many = (
        ts.roll(fretting(CROSSLAND | SHORT, save=save)) for save in ([3.0], [0.05, 1.0, 1.55, 3.0])
    )
    np.testing.assert_array_equal(few["utilisation"][-1], many["utilisation"][-1])
    np.testing.assert_array_equal(few.fatigue("A").damage, many.fatigue("A").damage)


@pytest.mark.slow
@pytest.mark.parametrize("start", ["steady", "shift"])
def test_a_resumed_run_is_the_uninterrupted_one(tmp_path, start):
    shifts = {"creepage.longitudinal": [0.0, 0.01, -0.01]}
    course = {"distance": [0.0, 1.0, 2.0], "start": start} | (shifts if start == "shift" else {})
    creepage = None if start == "shift" else {"longitudinal": -2e-3}
    scene = SPHERES.replace(transient=course, creepage=creepage, fatigue=CROSSLAND | SHORT)
    whole, path = ts.roll(scene), tmp_path / "a.h5"

    def stop(record):
        if record.at >= 1.2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ts.roll(scene, path, progress=stop)
    history = ts.roll(scene, path, resume=True)
    # Arrays from a file lie otherwise in memory, so that transforms round otherwise.
    for name in ("utilisation", "shakedown_lower", "damage"):
        np.testing.assert_allclose(history[name], whole[name], rtol=1e-7)
    np.testing.assert_allclose(
        history.fatigue("A").path_radius, whole.fatigue("A").path_radius, rtol=1e-7
    )


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"transient.cycle_start": 3.0}, "transient.cycle_start"),
        ({"transient.cycle_start": -1.0}, "transient.cycle_start"),
        ({"fatigue": None, "transient.cycle_start": 1.0}, "transient.cycle_start"),
        ({"fatigue.volume": {}}, "fatigue.volume"),
    ],
)
def test_what_it_cannot_take_names_the_key(changes, key):
    with pytest.raises(ts.SceneError) as caught:
        fretting(CROSSLAND | SHORT).replace(**changes)
    assert key in {fault.key for fault in caught.value.faults}


def test_it_is_explained_and_plotted(cycled):
    text = repr(ts.explain(cycled.scene))
    assert "stress history" in text
    assert "memory of the history" in text
    figures = {one.name for one in ts.plot.list_figures(cycled)}
    assert figures >= {"utilisation-A", "damage-A", "fatigue-course"}
