import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.rail import builtin_profile, read_profile
from tractive_sam.results import describe_balances
from tractive_sam.rolling import process_of

SETTINGS = [
    *("wear.revolutions=100000", "grid.elements=[15, 21]", "wear.tolerance=0.03"),
    "wheelset.pitch=rolling-radius",  # one wheel only
]


@pytest.fixture(scope="module")
def scene():
    return ts.Scene.builtin("wheel-wear").with_set(SETTINGS)


@pytest.fixture(scope="module")
def worn(scene):
    return ts.wear_profiles(scene)


@pytest.mark.slow
def test_worn_area_is_that_of_the_passes(scene):
    """In a first short step each profile loses what the passes of all positions wear off."""
    one = scene.with_set(["wear.revolutions=100", "rail.passes=0.5"])
    expected = np.zeros(2)
    for position in process_of(Model(one)).begin().positions:
        for patch in position.worn:
            expected += position.share * patch.width * patch.rates.sum(axis=1)
    worn = ts.wear_profiles(one)
    found = [worn.worn_areas[name][-1] for name in ("wheel", "rail")]
    assert found == pytest.approx(100.0 * expected, rel=1e-3)  # rates change within the step


def sampled(profile, name, per_mm, shift, folder):
    """A file of a built-in profile with points at equal distances."""
    curve = builtin_profile(profile)
    s = np.arange(shift, curve.s[-1], 1.0 / per_mm)
    path = folder / f"{name}-{per_mm}-{shift:g}.txt"
    np.savetxt(path, curve.at(s))
    return str(path)


@pytest.mark.parametrize("per_mm", [20, pytest.param(5, marks=pytest.mark.slow), 1])
@pytest.mark.parametrize("y", [1.0, 7.0])
def test_no_material_is_lost_between_the_points_of_a_profile(scene, tmp_path, per_mm, y):
    """Also where points lie further apart than the half width of the patch on the flange."""
    files = {
        f"{name}.profile": sampled(profile, name, per_mm, 0.4 / per_mm, tmp_path)
        for name, profile in (("wheel", "S1002"), ("rail", "60E1"))
    }
    changes = {"wheelset.y": y, "wheelset.yaw": 5.0, "wear.revolutions": 5, "wear.save": (0, 5)}
    one = scene.replace(duty=None, **changes, **files)
    work = ts.roll(one.replace(wear=None))["dissipation"].sum()
    history = ts.roll(one)
    # The load is shared to 1e-4; rates change by some 1e-4 in 5 revolutions on the flange.
    assert history["worn_section"][-1].sum() == pytest.approx(5.0 * 2e-8 / 0.3 * work, rel=1e-3)
    assert history.wear_balance[-1] == pytest.approx(1.0, abs=1e-4)
    assert "wear" in describe_balances(history)


def test_response_counts_the_passes_over_the_rail(scene):
    """Equal bodies wear equally in a pass: with p wheels, (1 + p)/2 times as fast."""
    responses = []
    for passes in (0, 1, 3):
        one = scene.replace(duty=None, **{"rail.passes": passes, "wheelset.y": 3.0})
        responses.append(process_of(Model(one)).begin().positions[0].worn[0].response)
    assert responses[0] == pytest.approx(0.5 * responses[1])
    assert responses[2] == pytest.approx(2.0 * responses[1])


def test_wear_follows_the_frictional_work(scene):
    """Archard's law with isotropic friction: volume = k / mu times the work."""
    one = scene.replace(duty=None, **{"wheelset.y": 3.0, "wheelset.yaw": 15.0})
    contact = ts.solve(one.replace(wear=None))
    coefficient = one.wear.laws  # A and B wear alike
    assert set(coefficient.values()) == {"archard"}
    history = ts.roll(one.with_set(["wear.revolutions=1"]))
    worn = ts.WornProfiles.from_history(history)
    area = sum(worn.worn_areas[name][-1] for name in ("wheel", "rail"))
    # k in mm3/(N m): 1e-3 in 1/MPa; in full slip p s = work / mu.
    assert contact.stick_fraction == 0.0
    assert area == pytest.approx(2.0e-5 * 1e-3 * contact.dissipation / 0.3, rel=1e-3)
    around = 2.0 * np.pi * ts.contact_locus(one, [3.0]).radius[0, 0]
    # The radius varies over the worn strip by parts of a mm, of 460 mm.
    volume = around * worn.worn_areas["wheel"][-1]
    assert history["worn_volume"][-1, 0] == pytest.approx(volume, rel=1e-3)


@pytest.mark.parametrize("heated", [False, True])
def test_wear_has_the_friction_of_the_tractions(scene, heated):
    """Archard's law, where friction varies in the patch: in full slip volume = k times p s.

    With the friction of other places the wear would be another by the ratio of both.
    """
    ramp = {"friction.across": ((735.0, 0.2), (745.0, 1.0))}
    position = {"wheelset.y": 3.0, "wheelset.yaw": 15.0, "wear.revolutions": 1}
    one = scene.replace(duty=None, **position, **ramp)
    if heated:
        warm = {"friction.temperature": ((20.0, 1.0), (500.0, 0.8)), "creepage.speed": 2e4}
        one = one.replace(heat={"bulk": 20.0}, **warm)
    contact = ts.solve(one.replace(wear=None))
    assert contact.stick_fraction == 0.0
    slid = np.hypot(*contact.slip) * contact.pressure
    expected = 2.0e-5 * 1e-3 * slid.sum() * contact.grid.element_area
    # The load is shared to 1e-4.
    assert ts.roll(one)["worn_section"][-1].sum() == pytest.approx(expected, rel=1e-4)


@pytest.mark.slow
def test_no_node_gains_material(worn):
    assert (np.diff(worn.wheel_depth, axis=0) >= 0.0).all()
    assert (np.diff(worn.rail_depth, axis=0) >= 0.0).all()


@pytest.mark.slow
def test_wear_is_where_the_contacts_are(worn, scene):
    y = scene.rail.curve.at(worn.new["rail"].s)[:, 0]
    inside = y[worn.rail_depth[-1] > 0.1 * worn.rail_depth[-1].max()]
    places = worn.contact_y
    assert places.min() - 15.0 < inside.min()
    assert inside.max() < places.max() + 15.0


@pytest.mark.slow
def test_the_tolerance_bounds_the_error_of_the_depth(scene):
    """The largest depth is within tolerance and error bar of its value by small steps."""
    position = {"wheelset.y": 3.0, "wheelset.yaw": 2.0, "wear.revolutions": 30000}
    one = scene.replace(duty=None, **position)
    exact = ts.roll(one.with_set(["wear.tolerance=0.002"]))
    for tolerance in (0.05, 0.02):
        history = ts.roll(one.with_set([f"wear.tolerance={tolerance}"]))
        assert len(history) < len(exact)
        error = abs(history["wear_max"][-1] - exact["wear_max"][-1])
        assert error < tolerance * exact["wear_max"][-1]
        assert error < history["wear_max_error"][-1]
        assert history.wear_balance[-1] == pytest.approx(1.0, abs=0.1 * tolerance)


@pytest.mark.slow
def test_a_step_depth_limits_the_steps(scene):
    one = scene.with_set(["wear.revolutions=5000", "wear.tolerance=0.1", "wear.step_depth=5e-4"])
    depth = ts.roll(one)["wheel_wear"].max(axis=1)
    assert depth[-1] > 5e-4
    # The rate at the place of the largest depth falls within a step.
    assert np.diff(depth).max() <= 1.05 * 5e-4


@pytest.mark.slow
def test_profiles_stay_smooth(worn):
    """The implicit step damps waves of a few elements: no patch of the tread becomes concave."""
    wheel = worn.wheel()
    tread = (wheel.points[:, 0] > -10.0) & (wheel.points[:, 0] < 30.0)
    assert np.abs(wheel.curvature(wheel.s[tread])).max() < 0.1


@pytest.mark.slow
def test_wear_returns_the_files_that_a_scene_reads(worn, scene, tmp_path):
    files = worn.write(tmp_path)
    wheel, rail = read_profile(files[0], "wheel"), read_profile(files[1], "rail")
    y = np.linspace(-30.0, 30.0, 101)
    assert np.abs(wheel.height(y) - worn.wheel().height(y)).max() < 1e-5
    assert np.abs(rail.height(y) - worn.rail().height(y)).max() < 3e-5
    again = scene.with_set([f"wheel.profile='{files[0]}'", f"rail.profile='{files[1]}'"])
    patch = again.blocks[0].wheel_rail.patches[0]
    assert patch.origin[1] == pytest.approx(worn.contact_y[-1][0], abs=0.1)
    assert len(np.loadtxt(files[2], delimiter=",", skiprows=1)) == worn.revolutions.size


@pytest.mark.slow
def test_saved_revolutions_are_met(scene):
    settings = ["wear.save=[0, 30000, 100000]", "wear.stepping=saved"]
    worn = ts.wear_profiles(scene.with_set(settings))
    assert {0.0, 30000.0, 100000.0} <= set(worn.revolutions)


def test_scenes_without_wear_or_wheel_are_refused(scene):
    with pytest.raises(ts.SceneError, match="wear"):
        ts.wear_profiles(ts.Scene.builtin("wheel-rail"))
    with pytest.raises(ts.SceneError, match="wheelset"):
        ts.wear_profiles(ts.Scene.builtin("twin-discs"))


@pytest.mark.slow
def test_an_interrupted_run_resumes_exactly(tmp_path):
    """The stored state contains the contacts from which the next step starts."""
    scene = ts.Scene.builtin("wheel-wear").with_set(
        ["grid.elements=[15, 15]", "wear.tolerance=0.1", "wheelset.pitch=rolling-radius"]
    )
    duty = [block.entries() for block in scene.duty[:2]]
    scene, path = scene.replace(duty=duty, **{"wear.revolutions": 90000}), tmp_path / "a.h5"
    records = []

    def stop(record):
        records.append(record)
        if len(records) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ts.roll(scene, path, progress=stop)
    assert len(ts.open_history(path)) == 2
    resumed, expected = ts.roll(scene, path, resume=True), ts.roll(scene)
    assert len(expected) > 3
    for name in set(expected.columns) - {"seconds", "over_application", "block_over_application"}:
        assert np.array_equal(resumed[name], expected[name], equal_nan=True), name
    profiles = ts.WornProfiles.from_history(ts.open_history(path))
    assert np.array_equal(profiles.wheel_depth, expected["wheel_wear"])


@pytest.mark.parametrize(
    ("settings", "key"),
    [
        (["wear.turns=equal"], "wear.turns"),
        (["wear.step_depth=0"], "wear.step_depth"),
        (["rail.passes=-1"], "rail.passes"),
        (["subsurface.planes=['y=0']", "subsurface.depth=1"], "subsurface"),
        (["fatigue.shear_yield=300"], "fatigue"),
    ],
)
def test_keys_that_worn_profiles_do_not_use_are_faults(scene, settings, key):
    with pytest.raises(ts.SceneError) as error:
        scene.with_set(settings)
    assert key in {fault.key for fault in error.value.faults}


def test_keys_of_worn_profiles_need_wheel_and_wear():
    with pytest.raises(ts.SceneError, match="passes"):
        ts.Scene.builtin("wheel-rail").with_set(["rail.passes=2"])
    with pytest.raises(ts.SceneError, match="step_depth"):
        ts.Scene.builtin("twin-discs").with_set(["wear.step_depth=0.1"])
