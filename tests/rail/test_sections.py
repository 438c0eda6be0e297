"""Rails whose section varies along the track."""

from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.rail import Profile, RailSections, builtin_profile, find_patches, write_profile

STEEL = {"shear": 82e3, "poisson": 0.28}
X = np.arange(-40.0, 41.0, 20.0)
E_STAR = 82e3 / (1.0 - 0.28)


@pytest.fixture(scope="module")
def rails(tmp_path_factory):
    """A function that writes a rail with tops at z(x) and lateral positions y(x)."""
    folder = tmp_path_factory.mktemp("sections")

    def write(name, y, z, head="", marks=()):
        rail = builtin_profile("UIC60-manchester")
        names = [f"{name}-{k}.prr" for k in range(X.size)]
        for k, x in enumerate(X):
            write_profile(rail.moved(0.0, (y(x), z(x))), folder / names[k], "rail")
        rows = [f"{x} '{file}'  % one section" for x, file in zip(X, names, strict=True)]
        counts = f"{X.size}\n{len(marks)} 0 0\n1"
        table = [f"{x} " + " ".join(map(str, marks)) for x in X] if marks else []
        path = folder / f"{name}.slcs"
        path.write_text("\n".join([f"{head or '0.0 1.0'}", counts, *rows, *table]))
        return path

    return write


def scene(path, radius=460.0, **wheelset):
    place = {"y": 2.0, "roll": 0.0, "pitch": 0.0, "load": 1e4, **wheelset}
    return ts.Scene(
        body={"A": STEEL, "B": STEEL},
        wheel={"profile": "S1002", "radius": radius},
        rail={"profile": str(path), "inclination": np.inf},
        wheelset=place,
        friction={"mu": 0.3},
        creepage={"longitudinal": 1e-3},
        grid={"half_length": [6.0, 6.0], "elements": [31, 31]},
    )


def test_equal_sections_are_a_prismatic_rail(rails, wheel):
    rail = builtin_profile("UIC60-manchester").moved(0.0, (750.0, 0.0))
    marks = np.tile([0.0, rail.s[-1]], (3, 1))
    varying = RailSections.from_profiles(np.array([-50.0, 0.0, 50.0]), [rail] * 3, marks)
    placed = replace(wheel, y=3.0, yaw=0.01, roll=1e-4)
    expected, found = (find_patches(placed, one, 1e4, E_STAR)[0] for one in (rail, varying))
    assert found.origin == pytest.approx(expected.origin, abs=2e-3)
    assert found.angle == pytest.approx(expected.angle, abs=1e-5)
    local = expected.lowered(0.02)
    same = replace(local, rail=varying)
    x, y = np.linspace(-5.0, 5.0, 11), np.linspace(-3.0, 3.0, 13)
    # Cubics between points 0.25 mm apart.
    assert same.gap(x, y) == pytest.approx(local.gap(x, y), abs=1e-6)
    assert same.opening == pytest.approx(local.opening, abs=1e-6)
    assert same.rigid_slip(x, y) == pytest.approx(local.rigid_slip(x, y), abs=1e-8)


@pytest.mark.slow
def test_a_crowned_rail_is_the_rail_of_a_smaller_wheel(rails):
    """Curvatures along the track add up: 1/460 + 1/600 = 1/260.4."""
    crown = rails("crown", lambda x: 0.0, lambda x: x**2 / 1200.0)
    flat = rails("flat", lambda x: 0.0, lambda x: 0.0)
    found, expected = (
        ts.solve(scene(crown)),
        ts.solve(scene(flat, radius=1.0 / (1 / 460 + 1 / 600))),
    )
    for name in ("P", "p_max", "approach", "Qx"):
        # The cone of the wheel has another curvature across: 1e-4.
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-3)


def test_a_rail_on_a_ramp_is_touched_ahead(rails):
    """A circle of radius r touches a ramp of slope m at -r m / sqrt(1 + m^2)."""
    m = 0.05
    ramp = rails("ramp", lambda x: 0.0, lambda x: m * x)
    patch = scene(ramp, x=0.0).wheel_rail.patches[0]
    expected = -patch.rolling_radius * m / np.hypot(1.0, m)
    assert patch.origin[0] == pytest.approx(expected, rel=2e-3)  # the wheel is a cone
    # An axle that follows the ramp has no velocity normal to it, and thus no lateral creepage.
    follows = scene(ramp, x=0.0, slope=m).wheel_rail.patches[0]
    assert patch.creepages()[1] == pytest.approx(-m * np.sin(patch.angle), rel=0.02)
    assert follows.creepages()[1] == pytest.approx(0.0, abs=2e-5)


@pytest.mark.slow
def test_position_and_marks_follow_the_track(rails):
    """A rail that moves sideways, seen 20 mm further on, has moved by that much."""
    marks = (0.0, 30.0, 999.0)
    moving = rails("moving", lambda x: 0.1 * x, lambda x: 0.0, "10.0 2.0", marks)
    rail = scene(moving, x=40.0).wheel_rail.rail
    ahead = scene(moving, x=60.0).wheel_rail.rail
    assert rail.x[[0, -1]] == pytest.approx([-100.0, 60.0])  # 2 (10 + x) - 40
    shift = ahead.section(0.0).points - rail.section(0.0).points
    assert shift == pytest.approx(np.tile([1.0, 0.0], (len(shift), 1)), abs=1e-9)
    description = str(ts.explain(scene(moving, x=40.0)))
    assert "x = 40 mm" in description


@pytest.mark.slow
def test_a_mark_that_a_section_lacks_is_a_plain_point_there(tmp_path):
    """Sections of one profile are one rail, whatever marks some of them do not have."""
    write_profile(builtin_profile("60E1"), tmp_path / "a.prr", "rail")
    head = "0 1\n3\n3 0 0\n1\n0 'a.prr'\n5 'a.prr'\n10 'a.prr'\n"
    files = []
    for name, middle in (("all", "5 0 60 125"), ("some", "5 0 -1 125"), ("none", "5 -1 -1 -1")):
        files.append(tmp_path / f"{name}.slcs")
        files[-1].write_text(f"{head}0 0 60 125\n{middle}\n10 0 60 125\n")
    complete, *others = (scene(path).rail.unplaced_curve for path in files)
    # The points between the marks differ: cubics between points 0.25 mm apart.
    for rail in others:
        y = np.linspace(-30.0, 30.0, 61)
        assert rail.section(5.0).height(y) == pytest.approx(
            complete.section(5.0).height(y), abs=1e-4
        )


@pytest.fixture(scope="module")
def beginning(tmp_path_factory):
    """A prismatic rail whose part with the smallest y begins at x = 0."""
    folder = tmp_path_factory.mktemp("parts")
    rail = builtin_profile("UIC60-manchester")
    first = float(rail.locate(np.array([8.0]), near=8.0)[0])
    end = Profile.from_nodes(rail.at(np.linspace(first, rail.s[-1], 800)),
                             rail.at(np.linspace(first, rail.s[-1], 800), 1)
                             * (rail.s[-1] - first) / 799)  # fmt: skip
    write_profile(rail, folder / "all.prr", "rail")
    write_profile(end, folder / "end.prr", "rail")
    places = (-80, -60, -40, -20, 0, 20, 40, 60)
    names = [f"{x} '{'end' if x < 0 else 'all'}.prr'" for x in places]
    marks = [f"{x} " + ("-1 0 999" if x < 0 else f"0 {first} 999") for x in places]
    path = folder / "rail.slcs"
    path.write_text("\n".join(["0 1", "8", "3 0 0", "1", *names, *marks]))
    return path


def on_parts(path, x):
    rail = {"profile": str(path), "inclination": np.inf, "origin": [750.0, 0.0]}
    return ts.Scene(
        body={"A": STEEL, "B": STEEL},
        wheel={"profile": "S1002"},
        rail=rail,
        wheelset={"x": x, "y": 0.0, "roll": 0.0, "pitch": 0.0, "load": 1e4},
        friction={"mu": 0.3},
        grid={"half_length": [6.0, 6.0], "elements": [31, 31]},
    )


def test_a_part_of_the_rail_begins_at_a_section(beginning):
    rail = on_parts(beginning, x=30.0).rail.unplaced_curve
    whole = rail.section(30.0)
    # Up to the first section that has the part, the rail is the rest.
    for x in (-100.0, -50.0, -20.0, -1e-9):
        assert rail.section(x).points[0, 0] == pytest.approx(8.0, abs=1e-6)
    assert rail.section(1e-9).points[0, 0] == pytest.approx(whole.points[0, 0], abs=1e-6)
    y = np.array([-10.0, 0.0, 7.0, 9.0, 20.0])
    before, after = (rail.across(x, y, near=20.0)[0] for x in (-30.0, 30.0))
    np.testing.assert_allclose(after[:, 1], whole.height(y), atol=1e-6)
    np.testing.assert_allclose(before[3:], after[3:], atol=1e-5)  # cubics between 0.25 mm
    assert (before[:3, 1] > after[:3, 1] + 50.0).all()


def test_a_wheel_rolls_on_the_parts_that_exist(beginning, rails):
    prism = on_parts(rails("prism", lambda x: 0.0, lambda x: 0.0), x=0.0)
    before, after = (on_parts(beginning, x=x).wheel_rail.patches[0] for x in (-30.0, 30.0))
    expected = prism.wheel_rail.patches[0]
    assert expected.origin[1] < 758.0
    assert after.origin == pytest.approx(expected.origin, abs=5e-3)
    # Without this part, the wheel touches the rest, and its axle is lower.
    assert before.origin[1] > 758.0
    assert before.wheel.z > after.wheel.z + 0.01
    with pytest.raises(ts.SceneError, match="part of the rail"):
        on_parts(beginning, x=1.0)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"wheelset.roll": "free"}, "wheelset.roll"),
        ({"wheelset.pitch": "free"}, "wheelset.pitch"),
        ({"wear": {"coefficient": 1e-5, "revolutions": 10}}, "wear"),
        ({"rail.gauge": 1435.0, "rail.origin": [750.0, 0.0]}, "rail.origin"),
        ({"rail.origin": [750.0]}, "rail.origin"),
        ({"rail.profile": "60E1", "wheelset.x": 5.0}, "wheelset.x"),
        ({"wheel.profile": "missing.slcs"}, "wheel.profile"),
    ],
)
def test_keys_that_need_another_rail_are_faults(rails, change, key):
    path = rails("level", lambda x: 0.0, lambda x: 0.0)
    with pytest.raises(ts.SceneError) as error:
        scene(path).replace(**change)
    assert key in {fault.key for fault in error.value.faults}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "missing"),
        ("0 1\n3\n0 0 0\n1\n0 'a.prr'\n", "sections"),
        ("0 1\n2\n0 0 0\n1\n0 'a.prr'\n0 'a.prr'\n", "increasing"),
        ("0 1\n2\n0 1 0\n1\n0 'a.prr'\n5 'a.prr'\n", "kinks"),
        ("0 1\n2\n0 0 0\n1\n0 'a.prr'\n5 'b.prr'\n", "b.prr"),
        ("0 1\n2\n2 0 0\n1\n0 'a.prr'\n5 'a.prr'\n0 0 99\n5 -2 99\n", "marks"),
        ("0 1\n2\n2 0 0\n1\n0 'a.prr'\n5 'a.prr'\n0 0 99\n", "marks"),
        ("0 1\n2\n0 0 0\n1\n0 'a.prr'\n5 'a.prr'\n9 'a.prr'\n", "1 further lines"),
        ("0 1\n2\n0 0 0\n1\n0 'a.prr' 2\n5 'a.prr' 2\n", "other than two entries"),
        ("0 1\n2\n2 0 0\n1\n0 'a.prr'\n5 'a.prr'\n5 0 99\n0 0 99\n", "other positions"),
        ("0 1\nmany\n0 0 0\n1\n", "many"),
    ],
)
def test_files_that_are_no_sections_are_faults(tmp_path, text, message):
    write_profile(builtin_profile("60E1"), tmp_path / "a.prr", "rail")
    path = tmp_path / "rail.slcs"
    path.write_text(text)
    with pytest.raises(ts.SceneError, match=message):
        scene(path)


@pytest.mark.parametrize(
    ("remark", "named"),
    [("offset and scale, m", True), ("scale 0.5", True), ("offset, scale [mm]", False)],
)
def test_a_comment_with_a_unit_or_scale_is_named(rails, remark, named):
    path = rails("level", lambda x: 0.0, lambda x: 0.0, head=f"0.0 1.0 % {remark}")
    notes = scene(path).rail.curve.notes if not named else ()
    if named:
        with pytest.warns(ts.SceneWarning, match=f"level.slcs that are not used: .*{remark}"):
            scene(path)
    assert not notes


def test_a_locus_needs_one_profile(rails):
    with pytest.raises(ValueError, match="contact_locus"):
        ts.contact_locus(scene(rails("level", lambda x: 0.0, lambda x: 0.0)), [0.0])
