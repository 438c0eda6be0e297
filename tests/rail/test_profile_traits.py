"""What profile files state: each trait gives the points of the plain file, a note, or an error."""

import re
import tracemalloc
import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

import tractive_sam as ts
from tests.rail.test_wheel_scene import TABLES
from tractive_sam.output_file import OutputError
from tractive_sam.rail import (
    ProfileError,
    builtin_profile,
    from_measurement,
    read_profile,
    write_profile,
)
from tractive_sam.rail.measured import check_datum

PLACES = np.linspace(-25.0, 25.0, 201)
WHEEL, RAIL = (
    np.round(profile.at(np.arange(*profile.s[[0, -1]], 0.6)), 4)
    for profile in map(builtin_profile, ("S1002", "60E1"))
)


def shift(y, z):
    return lambda points: points + np.array((y, z))


def scale(factor, z=None):
    return lambda points: points * (factor, factor if z is None else z)


def lines(form="{:.4f} {:.4f}", *, change=None, head="", tail="", encoding="utf-8", end="\n"):
    """Return a function that writes points as lines, and their repetitions for longer forms."""

    def write(points):
        points = points if change is None else change(points)
        number = form.count("{")
        rows = [form.format(*(list(point) * 2)[:number]) for point in points]
        return end.join([*head.format(n=len(rows)).splitlines(), *rows, *tail.splitlines()]).encode(
            encoding
        )

    return write


def numbered(first, head=""):
    def write(points):
        rows = [f"{k},{y:.4f},{z:.4f}" for k, (y, z) in enumerate(points, first)]
        return "\n".join([*head.splitlines(), *rows]).encode()

    return write


def two_sided(sign, head=""):
    """Write four columns, the left one with y in the direction `sign` and 1 mm higher."""

    def write(points):
        rows = [f"{sign * y:.4f} {z - 1.0:.4f} {y:.4f} {z:.4f}" for y, z in points]
        return "\n".join([*head.splitlines(), *rows]).encode()

    return write


def simpack(*entries, kind=1, form="{:.4f} {:.4f}", change=None, units="units.len.f = 1000."):
    steps = "\n".join((units, *entries))
    head = f"header.begin\n type = {kind} ! kind\nheader.end\nspline.begin\n{steps}\npoint.begin"
    return lines(form, head=head, tail="point.end\nspline.end", change=change)


def miniprof(*entries, form="{:.4f}\t{:.4f}\t0.1\t0\t0", change=None):
    head = "\n".join(("ProgramName=Own", "XYPoints={n}", *entries, "", ""))
    return lines(form, head=head, change=change)


def spoil(content, old, new):
    return lambda points: content(points).replace(old, new)


class Trait(NamedTuple):
    """Content of a file, keys for its reading, and the expected note or error."""

    content: Callable
    note: str = ""
    error: str = ""
    keys: dict = {}  # noqa: RUF012 - not changed


COLUMNS = "ProgramName=x\nColumnDef={}\n\n"
TRAITS = {
    "plain": Trait(lines()),
    "tabs": Trait(lines("{:.4f}\t{:.4f}")),
    "commas": Trait(lines("{:.4f},{:.4f}")),
    "semicolons and decimal commas": Trait(
        spoil(lines("{:.4f};{:.4f}", head="y;z"), b".", b",")
    ),
    "blanks and decimal commas": Trait(spoil(lines(), b".", b",")),
    "carriage returns": Trait(lines(end="\r")),
    "Windows line ends": Trait(lines(end="\r\n")),
    "Fortran exponents": Trait(lines("{:.4f}D+00 {:.4f}D+00")),
    "a byte-order mark": Trait(lines("{:.4f},{:.4f}", head="y,z", encoding="utf-8-sig")),
    "UTF-16": Trait(lines(encoding="utf-16")),
    "Windows-1252": Trait(lines(head="Prüfer: Müller", encoding="cp1252"), note="Müller"),
    "a DOS end mark": Trait(lines(tail="\x1a")),
    "inline comments": Trait(lines("{:.4f} {:.4f} # point")),
    "comment lines": Trait(lines(head="# one\n% two\n! three", tail="% end of data")),
    "a count": Trait(lines(head="WHEEL OWN\n{n} 1"), note="'WHEEL OWN' is taken for a title"),
    "a wrong count": Trait(lines(head="WHEEL OWN\n9999"), error="line 2"),
    "a heading of numbers": Trait(lines(head="2024 05 17 profile of axle 3"), error="line 1"),
    "exchanged columns with names": Trait(lines(head="z y", change=lambda p: p[:, ::-1])),
    "row numbers with names": Trait(numbered(0, ",y,z"), note="row numbers"),
    "row numbers without names": Trait(numbered(1), note="row numbers"),
    "further columns": Trait(lines("{:.4f} {:.4f} 0.3"), note="first two columns"),
    "unknown names": Trait(lines("{:.4f},{:.4f},0.3", head="a,b,c"), error="columns y and z"),
    "inches in the heading": Trait(
        lines("{:.9f},{:.9f}", head="y [in],z [in]", change=scale(1 / 25.4))
    ),
    "metres in the heading": Trait(lines("{:.7f},{:.7f}", head="y (m),z (m)", change=scale(1e-3))),
    "micrometres by key": Trait(lines("{:.1f} {:.1f}", change=scale(1e3)), keys={"unit": "um"}),
    "centimetres without a unit": Trait(lines("{:.5f} {:.5f}", change=scale(0.1)), error="cm"),
    "units that differ": Trait(lines("{:.4f},{:.4f}", head="y [mm],z [m]"), error="units m, mm"),
    "mirrored": Trait(lines(change=scale(-1.0, 1.0)), keys={"mirror": True}),
    "two sides": Trait(two_sided(-1.0), error="side = left or right"),
    "the right side": Trait(two_sided(-1.0), keys={"side": "right"}),
    "the left side": Trait(two_sided(-1.0), keys={"side": "left"}),
    "the left side, outward": Trait(two_sided(1.0), keys={"side": "left"}),
    "sides with names": Trait(
        two_sided(-1.0, "y_left z_left y_right z_right"), keys={"side": "right"}
    ),
    "a side of one profile": Trait(lines(), error="side", keys={"side": "left"}),
    "nan": Trait(lines(tail="nan nan\n60.5 -3"), error="finite"),
    "a word": Trait(lines(tail="sixty one"), error="sixty"),
    "SIMPACK": Trait(simpack()),
    "SIMPACK in metres": Trait(
        simpack(units="units.len.f = 1.", form="{:.7f} {:.7f}", change=scale(1e-3))
    ),
    "SIMPACK unit name": Trait(
        simpack(units="units.len = 'm'", form="{:.7f} {:.7f}", change=scale(1e-3))
    ),
    "SIMPACK units that differ": Trait(simpack("units.len = 'm'"), error="units.len.f"),
    "SIMPACK unit of 0": Trait(simpack(units="units.len.f = 0"), error="units.len.f"),
    "SIMPACK negative unit": Trait(simpack(units="units.len.f = -1000"), error="units.len.f"),
    "SIMPACK unit that is a word": Trait(simpack(units="units.len.f = mm"), error="units.len.f"),
    "shift": Trait(simpack("shift.y = +2.0", "shift.z = -1.5", change=shift(-2.0, 1.5))),
    "shift in metres": Trait(
        simpack("shift.y = 0.002", units="units.len.f = 1.", form="{:.7f} {:.7f}",
                change=lambda p: 1e-3 * (p - (2.0, 0.0)))
    ),
    "rotate": Trait(simpack("rotate = 0.025"), error="rotate"),
    "no rotation": Trait(simpack("rotate = +0.000000e+00")),
    "bound.y": Trait(simpack("bound.y.min = -32", "bound.y.max = 32")),
    "inactive bounds": Trait(simpack("bound.y.min = 1", "bound.y.max = 0", "bound.z.min = 1")),
    "bound.z": Trait(simpack("bound.z.min = -1", "bound.z.max = 5"), error="bound.z"),
    "mirror.y": Trait(simpack("mirror.y = 1", change=scale(-1.0, 1.0))),
    "mirror.z": Trait(simpack("mirror.z = 1", change=scale(1.0, -1.0))),
    "inversion": Trait(simpack("inversion = 1", change=lambda p: p[::-1])),
    "point.dist.min": Trait(
        simpack("point.dist.min = 0.3", change=lambda p: np.insert(p, 100, p[99] + 0.01, axis=0))
    ),
    "approx.smooth": Trait(simpack("approx.smooth = 0.2"), note="approx.smooth"),
    "weights": Trait(
        spoil(simpack(form="{:.4f} {:.4f} 1.0"), b" 1.0\npoint.end", b" 2.0\npoint.end"),
        note="weights",
    ),
    "an unknown entry": Trait(simpack("warp.factor = 9"), note="warp.factor"),
    "the type of the other body": Trait(simpack(kind=2), error="type"),
    "no end of the points": Trait(spoil(simpack(), b"point.end", b""), error="cut off"),
    "Miniprof": Trait(miniprof("XOffset=0.0", "YOffset=0.0", "ColumnDef=X,Y,A,C,N", "Sd=28.1")),
    "Miniprof offsets": Trait(miniprof("XOffset=1.0", "YOffset=-0.8", change=shift(-1.0, 0.8)),
                              note="first two"),
    "Miniprof columns": Trait(
        miniprof("ColumnDef=Y,X", form="{:.4f}\t{:.4f}", change=lambda p: p[:, ::-1])
    ),
    "Miniprof with too many columns": Trait(miniprof("ColumnDef=X,Y"), error="ColumnDef"),
    "a comment with a shift": Trait(simpack("# Offset: 5"), note="Offset: 5"),
    "bounds around nothing": Trait(
        simpack("bound.y.min = 90", "bound.y.max = 95"), error="0 points within the bounds"
    ),
    "Miniprof without X": Trait(miniprof("ColumnDef=A,Y,C,N,K"), error="ColumnDef"),
    "Miniprof count": Trait(spoil(miniprof(), b"XYPoints=", b"XYPoints=9"), error="xypoints"),
    "Miniprof left rail": Trait(miniprof("Rail=Left", "ColumnDef=X,Y,A,C,N"), note="mirror"),
    "Miniprof tilt": Trait(miniprof("Tilt=1.5", "ColumnDef=X,Y,A,C,N"), note="Tilt=1.5"),
    **{
        f"{text}, in {place}": Trait(write(text), note=text)
        for text in (
            "WheelOffset=0.9", "FlangeBack=-70.9", "TrackShift=0.9", "ReferencePoint=0.9",
            "offset: 0.9, 0", "lateral offset 0.9 mm", "heights magnified 1.1 times",
            "z in 0.1 mm", "heights in cm", "Mirror: yes", "Seite: links", "Comment: z = 2 z",
        )
        for place, write in {
            "a comment": lambda text: lines(head=f"# {text}"),
            "an inline comment": lambda text: simpack(f"shift.y = 0 ! {text}"),
        }.items()
    },
    **{
        f"{text}, above the points": Trait(lines(head=text), note=text)
        for text in ("Seite: links", "Mirror: yes", "Shift: two", "FlangeBack=-70.9")
    },
    "a side above the points": Trait(lines(head="Side: left"), note="Side = left"),
    "a unit above the points": Trait(lines("{:.5f} {:.5f}", head="Units: cm", change=scale(0.1))),
    "a unit above the points that a key replaces": Trait(
        lines(head="Units: cm"), note="unit = mm replaces cm", keys={"unit": "mm"}
    ),
    "a SIMPACK unit that a key replaces": Trait(
        simpack(units="units.len.f = 1."), note="replaces units.len.f = 1", keys={"unit": "mm"}
    ),
    "an unknown unit above the points": Trait(lines(head="Units: furlong"), error="furlong"),
    "many entries": Trait(lines("{:.4f} {:.4f} # 3"), note=", and "),
    "descriptions": Trait(lines(head="Date: 2024-05-17\nTime: 12:30:05\n# speed: 80 km/h")),
    **{
        f"columns {header}": Trait(lines("{:.4f},{:.4f}", head=header), error="columns")
        for header in ("-y,z", "y inward [mm],z [mm]", "y,-z", "a1,b1", "# -y,z [mm]")
    },
    "signs of SIMPACK columns": Trait(
        spoil(simpack(), b"point.begin", b"point.begin\n-y z"), error="columns -y, z"
    ),
    "names of SIMPACK columns": Trait(
        spoil(simpack(), b"point.begin",
              b"point.begin\n! y value (lengths unit)  z value (lengths unit)")
    ),
    "names and rule of SIMPACK columns": Trait(
        spoil(simpack(), b"point.begin",
              b"point.begin\n!\n! y value (lengths unit)  z value (lengths unit)\n! ----  ----"),
        note="y value",
    ),
    "columns y and height": Trait(lines("{:.4f};{:.4f}", head="y [mm];height [mm]")),
    "Miniprof offset with a comma": Trait(miniprof("XOffset=2,0"), error="xoffset = '2,0'"),
    "Miniprof offset with a unit": Trait(miniprof("XOffset=2.0 mm"), error="xoffset = '2.0 mm'"),
    "two offsets": Trait(miniprof("XOffset=2", "XOffset=0"), error="xoffset = 2, and"),
    "there and back": Trait(
        lines(change=lambda p: np.concatenate((p, shift(0, 1e-3)(p[::-1])))),
        error="return along|turn back",
    ),
    "two tables": Trait(
        lambda points: lines()(points) + b"\n\n" + lines()(points),
        error="return along|turn back",
    ),
    "two tables in opposite order": Trait(
        lambda points: lines()(points) + b"\n\n" + lines()(shift(0, 0.05)(points[::-1])),
        error="return along|turn back",
    ),
}  # fmt: skip
"""Traits of files by name: a new one is a line."""


@pytest.mark.parametrize("trait", TRAITS)
@pytest.mark.parametrize("kind", ["wheel", "rail"])
def test_traits_of_profile_files(tmp_path, kind, trait):
    content, note, error, keys = TRAITS[trait]
    points = {"wheel": WHEEL, "rail": RAIL}[kind]
    # Worn on one side: a mirrored rail differs.
    points = points + np.outer(0.3 * np.exp(-(((points[:, 0] - 12.0) / 4.0) ** 2)), (0, 1))
    path = tmp_path / "a.prw"
    data = content(points)
    if kind == "rail":
        data = data.replace(b"type = 1", b"type = 0")
    path.write_bytes(data)
    if error:
        with pytest.raises(ProfileError, match=error):
            read_profile(path, kind, **keys)
        return
    plain = tmp_path / "plain.txt"
    plain.write_bytes(lines()(points))
    found, expected = read_profile(path, kind, **keys), read_profile(plain, kind)
    if "left" in keys.values():
        expected = expected.moved(0.0, (0.0, -1.0))
    assert not expected.notes
    text = " ".join(found.notes)
    assert note in text if note else not text
    # Four digits of each point, twice if they were shifted or scaled.
    np.testing.assert_allclose(found.height(PLACES), expected.height(PLACES), atol=3e-4)


@pytest.mark.parametrize(
    ("spacing", "digits", "limit"),
    [(0.2, 2, 0.1), (0.88, 2, 0.15), (0.57, 3, 0.06), (0.1, 3, 0.06)],
)
def test_rounded_points_are_smoothed_by_their_last_digit(tmp_path, spacing, digits, limit):
    """The note is given, and the error of the slope falls by the stated ratio, within a factor."""
    wheel = builtin_profile("S1002")
    points = np.round(wheel.at(np.arange(*wheel.s[[0, -1]], spacing)), digits)
    points = points[np.append(True, np.diff(points, axis=0).any(axis=1))]
    path = tmp_path / "a.whl"
    np.savetxt(path, points, fmt="%.5f")
    smooth, through = read_profile(path, "wheel"), read_profile(path, "wheel", smoothing=0.0)
    (note,) = smooth.notes
    assert "smoothing" in note
    assert not through.notes
    tread = np.linspace(-20.0, 25.0, 2000)
    errors = [
        np.sqrt(np.mean((np.gradient(p.height(tread) - wheel.height(tread), tread)) ** 2))
        for p in (smooth, through)
    ]
    assert errors[0] < 0.35 * errors[1]
    distance = np.abs(smooth.height(tread) - wheel.height(tread)).max()
    assert distance < 10.0**-digits
    # E*/2 of steel times the rms slope is the rms pressure of waves in full contact.
    left = float(note.split("and about ")[1].split(" MPa")[0])
    assert left == pytest.approx(0.5 * 1.154e5 * errors[0], rel=1.0)


def test_exact_points_are_interpolated_without_a_note(tmp_path):
    """Points on a fine lateral grid of few digits are exact if their heights have more digits."""
    y = np.arange(-3500, 3501) / 100.0
    z = builtin_profile("60E1").height(y)
    path = tmp_path / "a.rail"
    np.savetxt(path, np.stack((y, z), axis=1), fmt="%.2f %.7f")
    found = read_profile(path, "rail")
    assert not found.notes
    np.testing.assert_allclose(found.height(y), z, atol=1e-6)


def test_scatter_beyond_the_digits_is_named_and_kept():
    noise = np.random.default_rng(1).normal(0.0, 0.005, WHEEL.shape)
    found = from_measurement(WHEEL + noise, "wheel")
    assert re.search(r"smoothing = 0.00[67]", found.notes[0])  # 0.005 in both directions
    np.testing.assert_allclose(found.points, WHEEL + noise, atol=1e-12)


@pytest.mark.parametrize("number", [2000, 20000])
def test_undercuts_and_smoothing_cost_in_proportion_to_the_points(number):
    angles = np.radians(np.linspace(-100.0, 100.0, number))
    points = np.cumsum(np.stack((np.cos(angles), np.sin(angles)), axis=1), axis=0) * 110 / number
    tracemalloc.start()
    try:
        from_measurement(points, "rail", 0.01)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 4e6 + 3e3 * number  # bytes; the first part is the spline of 4000 knots


def test_an_undercut_that_crosses_is_found_among_many_points():
    angles = np.radians(np.linspace(-140.0, 140.0, 5000))
    bulb = np.cumsum(np.stack((np.cos(angles), np.sin(angles)), axis=1), axis=0) * 110 / 5000
    ends = np.linspace(0.0, 1.0, 200)[1:, None]
    points = np.concatenate((bulb, bulb[-1] + ends * (-60.0, -3.0)))
    with pytest.raises(ValueError, match="crosses itself"):
        from_measurement(points, "section")


@pytest.mark.parametrize("place", [-75.0, -71.5, -70.0, -69.2, 0.0, 680.0])
def test_the_tape_line_is_compared_with_the_back_of_the_wheel(tmp_path, place):
    path = tmp_path / "a.whl"
    path.write_bytes(lines(change=shift(place + 70.0, 0.0))(WHEEL))
    profile = read_profile(path, "wheel")
    if abs(place + 70.0) > 20.0:
        with pytest.raises(ValueError, match=f"add {-70.0 - place:g} to all y"):
            check_datum(profile, 70.0)
    else:
        note = check_datum(profile, 70.0)
        assert bool(note) == (abs(place + 70.0) > 1.0)
        assert f"tape_line = {-place:g}" in note or not note
        assert not check_datum(profile, -place)


@pytest.mark.parametrize("z", [-4.0, -0.9, 0.9, 5.0])
def test_the_height_at_the_tread_datum_is_stated_with_the_radius(tmp_path, z):
    path = tmp_path / "a.whl"
    path.write_bytes(lines(change=shift(0.0, z))(WHEEL))
    profile = read_profile(path, "wheel")
    note = check_datum(profile, 70.0, 460.0)
    assert bool(note) == (abs(z) > 1.0)
    assert f"{460.0 + z:g} mm, and not wheel.radius" in note or not note
    wheel = {"profile": path, "radius": 460.0}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)
        one = ts.Scene(**{**TABLES, "wheel": wheel, "wheelset": {"load": 1e4}})
    plain = ts.Scene(**{**TABLES, "wheelset": {"load": 1e4}})
    radii = [s.wheel_rail.patches[0].rolling_radius for s in (plain, one)]
    assert radii[1] - radii[0] == pytest.approx(z, abs=1e-2)  # four digits in the file


def test_the_direction_of_a_tread_without_its_flange_is_not_guessed():
    tread = WHEEL[WHEEL[:, 0] > -31.0]
    with pytest.raises(ValueError, match="which side"):
        from_measurement(tread, "wheel")
    bounded = from_measurement(WHEEL, "wheel", inside=WHEEL[:, 0] > -31.0)
    np.testing.assert_allclose(bounded.points, tread, atol=1e-12)
    assert "no flange" in check_datum(bounded, 70.0)


def test_keys_of_profiles_in_a_scene(tmp_path):
    """A wheel whose datum is 75 mm from its back touches the rail as one with 70 mm does."""
    path = tmp_path / "A.WHL"
    path.write_bytes(lines(change=shift(-5.0, 0.0))(WHEEL))
    tables = {**TABLES, "wheelset": {"y": 2.0, "load": 1e4}}
    plain = ts.Scene(**tables)
    wheel = {"profile": path, "radius": 460.0}
    with pytest.warns(ts.SceneWarning, match="tape_line = 75"):
        ts.Scene(**{**tables, "wheel": wheel})
    moved = ts.Scene(**{**tables, "wheel": {**wheel, "tape_line": 75.0}})
    radius = [s.wheel_rail.wheel.radius for s in (plain, moved)]
    assert radius[0] == radius[1]
    points = [s.wheel_rail.patches[0].origin for s in (plain, moved)]
    np.testing.assert_allclose(points[0], points[1], atol=2e-2)  # a flat minimum; four digits
    with pytest.warns(ts.SceneWarning, match="unit is not used"):
        ts.Scene(**{**tables, "rail": {"profile": "60E1", "unit": "mm"}})


def test_a_mirrored_rail_has_its_wear_on_the_other_side(tmp_path):
    depth = 0.2 * np.exp(-(((RAIL[:, 0] + 12.0) / 4.0) ** 2))
    worn = RAIL + np.outer(depth, (0, 1))
    tables = {**TABLES, "wheelset": {"y": 2.0, "load": 1e4}}
    found = []
    for name, points, mirror in (("a.rail", worn, False), ("b.rail", worn * (-1, 1), True)):
        (tmp_path / name).write_bytes(lines()(points))
        rail = {"profile": tmp_path / name, "mirror": mirror}
        scene = ts.Scene(**{**tables, "rail": rail})
        found.append(scene.wheel_rail.patches[0].origin)
        side = "largest" if mirror else "smallest"
        assert f"{side} y of the file" in str(ts.explain(scene))
    np.testing.assert_allclose(found[0], found[1], atol=1e-9)


@pytest.mark.parametrize("suffix", [".prr", ".PRR", ".rail"])
def test_no_part_of_a_written_profile_is_read(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    write_profile(builtin_profile("60E1"), path, "rail", "a 'title' ! with signs")
    data = path.read_bytes()
    assert not read_profile(path, "rail").notes
    lengths = np.unique(
        [*np.linspace(0, len(data) - 40, 25, dtype=int), *range(len(data) - 60, len(data) - 14)]
    )
    for length in lengths:
        path.write_bytes(data[:length])
        if suffix.lower() == ".prr" and b"point.end" in data[:length]:
            continue  # complete but for the mark of the section
        with pytest.raises(ProfileError):
            read_profile(path, "rail")


def test_a_profile_that_cannot_be_written_leaves_the_earlier_file(tmp_path, monkeypatch):
    path = tmp_path / "a.prr"
    path.write_text("earlier")

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.write", fail)
    with pytest.raises(OutputError):
        write_profile(builtin_profile("60E1"), path, "rail")
    assert path.read_text() == "earlier"
    assert [file.name for file in tmp_path.iterdir()] == ["a.prr"]
