from itertools import product

import numpy as np
import pytest

from tractive_sam.rail import (
    ProfileError,
    builtin_profile,
    from_measurement,
    read_profile,
    write_profile,
)

Y = np.linspace(-30.0, 30.0, 301)


@pytest.fixture(scope="module")
def wheel():
    return builtin_profile("S1002")


def written(path, points, form="{:.8f} {:.8f}"):
    path.write_text("\n".join(form.format(*point) for point in points), encoding="utf-8")
    return path


@pytest.mark.parametrize("suffix", [".prw", ".wheel", ".whl", ".csv"])
def test_written_profiles_are_read(wheel, tmp_path, suffix):
    path = tmp_path / f"new{suffix}"
    write_profile(wheel, path, "wheel", "S1002")
    found = read_profile(path, "wheel")
    assert np.abs(found.height(Y) - wheel.height(Y)).max() < 2e-9  # written with nine decimals


def test_written_rails_are_read(tmp_path):
    rail = builtin_profile("60E1")
    write_profile(rail, tmp_path / "new.prr", "rail")
    found = read_profile(tmp_path / "new.prr", "rail")
    # A spline through points 0.1 mm apart overshoots at the change of the radius from 80 to 13 mm.
    assert np.abs(found.height(Y) - rail.height(Y)).max() < 3e-5


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
@pytest.mark.parametrize("order", [1, -1])
def test_any_direction_is_recognised(wheel, signs, order):
    found = from_measurement(wheel.points[::order] * signs, "wheel")
    assert np.abs(found.height(Y) - wheel.height(Y)).max() < 2e-9


SHAPES = {  # corners with z down
    "wheel": [(-70, 9), (-60, 28), (-50, 28), (-38, 5), (-20, 0), (65, -3), (70, -40)],
    "rail": [(-36, 38), (-35, 12), (-25, 2), (25, 2), (35, 12), (36, 38)],
    "nose with a wide foot": [(0, 35), (4, 2), (12, 0), (17, 2), (24, 38), (85, 39)],
    "flangeway": [(-42, 42), (-32, 20), (-25, 20), (-5, 55), (10, 55), (20, 0), (97, -3), (99, 9)],
    "roller": [(-50, -30), (-30, -10), (-10, 0), (10, 0), (30, -10), (50, -30)],
}
UNCLEAR_SHAPES = {
    "groove": [(-40, 0), (-20, 0), (-15, 30), (15, 30), (20, 0), (40, 0)],  # or a rail with feet
    "line": [(-50, -10), (50, 10)],
    "raised ends": [(-40, 32), (-38, 40), (-20, 40), (-15, 0), (15, 0), (20, 40), (40, 40)],
}


def place_points(shape, crowded=None):
    """Return 1000 points along a shape, and 2000 more on the face with the number `crowded`."""
    corners = np.array((SHAPES | UNCLEAR_SHAPES)[shape], dtype=float)
    s = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))))
    at = np.linspace(0.0, s[-1], 1000)
    if crowded is not None:
        at = np.union1d(at, np.linspace(s[crowded], s[crowded + 1], 2000))
    return np.stack([np.interp(at, s, column) for column in corners.T], axis=1)


@pytest.mark.parametrize("crowded", [None, 0, 2, 4])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_outward_side_does_not_depend_on_the_spacing_of_points(shape, crowded):
    kind = "wheel" if shape in ("wheel", "roller") else "section"
    points = place_points(shape, crowded)
    for y, z, order in product((1, -1), repeat=3):
        found = from_measurement((points * (y, z))[::order], kind).points
        expected = points if shape == "wheel" else (points * (y, 1))[::y]  # its flange is inside
        np.testing.assert_allclose(found, expected, atol=1e-12)  # rounding of the spline


@pytest.mark.parametrize("shape", UNCLEAR_SHAPES)
@pytest.mark.parametrize("kind", ["wheel", "section"])
def test_a_profile_whose_outward_side_is_unclear_is_refused(shape, kind):
    with pytest.raises(ValueError, match="which side"):
        from_measurement(place_points(shape), kind)


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1.0), ("m", 1e3), ("in", 25.4)])
def test_units_are_converted(wheel, tmp_path, unit, factor):
    path = written(tmp_path / "a.csv", wheel.points / factor, "{:.12f},{:.12f}")
    found = read_profile(path, "wheel", unit)
    assert np.abs(found.height(Y) - wheel.height(Y)).max() < 1e-8


def test_headers_and_further_columns_are_skipped(wheel, tmp_path):
    path = tmp_path / "a.whl"
    lines = ['ProgramName = "instrument"', f"XYPoints = {len(wheel.points)}", ""]
    lines += [f"{y:.8f}\t{z:.8f}\t0.1\t2" for y, z in wheel.points]
    path.write_text("\n".join(lines), encoding="utf-8")
    assert np.abs(read_profile(path, "wheel").height(Y) - wheel.height(Y)).max() < 2e-8


def test_smoothing_meets_its_tolerance_and_calms_the_curvature(wheel):
    noise = np.random.default_rng(1).normal(0.0, 0.005, wheel.points[::4].shape)
    points = wheel.points[::4] + noise
    rough, smooth = from_measurement(points, "wheel"), None
    smooth = from_measurement(points, "wheel", smoothing=0.005 * np.sqrt(2.0))
    tread = smooth.locate(np.linspace(-20.0, 40.0, 500))
    assert np.abs(smooth.curvature(tread)).max() < 0.1 * np.abs(rough.curvature(tread)).max()
    assert np.sqrt(np.mean((smooth.height(Y) - wheel.height(Y)) ** 2)) < 0.005
    off = smooth.points - points
    assert np.sqrt((off**2).sum(axis=1).mean()) == pytest.approx(0.005 * np.sqrt(2.0), rel=0.01)


def spoilt(points, index, values):
    changed = points.copy()
    changed[index] = values
    return changed


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p: p[:10], "at least 20"),
        (lambda p: p[:0], "at least 20"),
        (lambda p: p / 25.4, "unit is probably in"),
        (lambda p: p / 1e3, "unit is probably m"),
        (lambda p: p * 1e3, "allowed: 60 to 200"),
        (lambda p: np.random.default_rng(0).permutation(p), "turn back"),
        (lambda p: np.concatenate((p[:700], p[500:])), "turn back|equal|crosses"),
        (lambda p: np.repeat(p, 2, axis=0), "equal"),
        (lambda p: spoilt(p, 30, np.nan), "finite"),
        (lambda p: spoilt(p, 30, np.inf), "finite"),
        (lambda p: spoilt(p, (600, 0), -90.0), "turn back"),
    ],
)
def test_points_that_are_no_profile_are_reported(wheel, change, message):
    with pytest.raises(ValueError, match=message):
        from_measurement(change(wheel.points), "wheel")


def test_a_profile_that_crosses_itself_is_reported():
    angles = np.linspace(0.0, 3.5 * np.pi, 200)
    loop = np.stack((angles * 6.0 - 30.0 * np.sin(angles), 20.0 * np.cos(angles)), axis=1)
    with pytest.raises(ValueError, match=r"\(\S+, \S+\) mm"):
        from_measurement(loop, "wheel")


def test_a_wheel_is_no_rail(wheel):
    with pytest.raises(ValueError, match="rail"):
        from_measurement(wheel.points, "rail")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "no rows"),
        (b"\xff\xfe\x00", "cannot be read"),
        (b"1 2\n3 4\nfive six\n7 8\n", "line 3"),
        (b"nan nan\n" * 30, "finite"),
    ],
)
def test_files_that_are_no_profiles_are_reported(tmp_path, content, message):
    path = tmp_path / "bad.whl"
    path.write_bytes(content)
    with pytest.raises(ProfileError, match=message):
        read_profile(path, "wheel")


def test_a_missing_file_and_a_folder_are_reported(tmp_path):
    for path in (tmp_path / "none.prw", tmp_path):
        with pytest.raises(ProfileError, match=path.name):
            read_profile(path, "wheel")


def test_too_much_smoothing_is_reported(wheel):
    with pytest.raises(ValueError, match="smoothing"):
        from_measurement(wheel.points, "wheel", smoothing=1000.0)
