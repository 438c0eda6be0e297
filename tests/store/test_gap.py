import pickle
import tracemalloc

import h5py
import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.scene import Gap
from tractive_sam.schema import keys
from tractive_sam.store import GapError, gap, read_gap

X, Y = np.array([-1.0, 0.0, 1.5]), np.array([-2.0, -1.0, 0.0, 2.0])
SEPARATION = 1e-3 * X[:, None] ** 2 + 1e-4 * Y
POINTS = np.array([[x, y, s] for x, row in zip(X, SEPARATION, strict=True)
                   for y, s in zip(Y, row, strict=True)])  # fmt: skip
SHUFFLED = np.random.default_rng(0).permutation(POINTS)


def write_hdf5(path, **datasets):
    with h5py.File(path, "w") as file:
        for name, values in datasets.items():
            file[name] = values


def write_columns(path, points):
    np.savetxt(path, points, delimiter=",", header="x,y,separation", comments="")


def write_matrix(path):
    rows = [["x \\ y", *Y], *([x, *row] for x, row in zip(X, SEPARATION, strict=True))]
    path.write_text("\n".join(",".join(map(str, row)) for row in rows))


def structured(points):
    return np.array([tuple(p) for p in points], [("x", float), ("y", float), ("separation", float)])


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("a.h5", lambda path: write_hdf5(path, x=X, y=Y, separation=SEPARATION)),
        ("a.npy", lambda path: np.save(path, SHUFFLED)),
        ("b.npy", lambda path: np.save(path, structured(SHUFFLED))),
        ("a.csv", lambda path: write_columns(path, SHUFFLED)),
        ("b.csv", write_matrix),
    ],
)
def test_every_format_gives_the_same(tmp_path, name, write):
    write(tmp_path / name)
    x, y, separation = read_gap(tmp_path / name)
    np.testing.assert_array_equal(x, X)
    np.testing.assert_array_equal(y, Y)
    np.testing.assert_array_equal(separation, SEPARATION)


def with_nan():
    points = POINTS.copy()
    points[5, 2] = np.nan
    return points


def write_archive(path):
    with path.open("wb") as file:
        np.savez(file, x=X, y=Y, separation=SEPARATION)


def write_damaged(path, what):
    """Write a file with the first bytes `what` inverted: it opens, but is not consistent."""
    write_hdf5(path, x=X, y=Y, separation=SEPARATION)
    whole = path.read_bytes()
    path.write_bytes(whole.replace(what, bytes(255 - byte for byte in what), 1))


FAULTS = {
    "missing.h5": (lambda path: None, "no such file"),
    "a.pdf": (lambda path: path.write_text("1"), "suffix '.pdf'"),
    "one.txt": (lambda path: path.write_text("1"), r"shape \(1, 1\)"),
    "text.h5": (lambda path: path.write_text("1"), "unreadable"),
    "no-y.h5": (lambda path: write_hdf5(path, x=X, separation=SEPARATION), "no dataset y"),
    "turned.h5": (
        lambda path: write_hdf5(path, x=X, y=Y, separation=SEPARATION.T),
        r"shape \(4, 3\)",
    ),
    "falling.h5": (
        lambda path: write_hdf5(path, x=X[::-1], y=Y, separation=SEPARATION),
        "x that does not increase, ",
    ),
    "single.h5": (lambda path: write_hdf5(path, x=X[:1], y=Y, separation=SEPARATION[:1]), "x of"),
    "words.h5": (lambda path: write_hdf5(path, x=["a"], y=Y, separation=SEPARATION), "unreadable"),
    "pickle.npy": (lambda path: np.save(path, np.array([{}], object)), "unreadable"),
    "two.npy": (lambda path: np.save(path, POINTS[:, :2]), "without a body"),
    "map.npy": (lambda path: np.save(path, SEPARATION), "gap.step"),
    "fields.npy": (lambda path: np.save(path, np.zeros(3, [("x", float)])), "no field y"),
    "hole.npy": (lambda path: np.save(path, POINTS[1:]), "11 points"),
    "twice.npy": (lambda path: np.save(path, POINTS[[0, *range(11)]]), "11 distinct"),
    "nan.npy": (lambda path: np.save(path, with_nan()), "1 of 12 points are missing"),
    "nan-x.npy": (lambda path: np.save(path, POINTS * [np.nan, 1, 1]), "gap.file"),
    "empty.npy": (lambda path: path.write_bytes(b""), "unreadable"),
    "archive.npy": (write_archive, "an archive of arrays"),
    "zip.npy": (lambda path: path.write_bytes(b"PK\3\4 and no more"), "unreadable"),
    "long.csv": (lambda path: path.write_text("1" * 1_000_001), "line 1 longer"),
    "tree.h5": (lambda path: write_damaged(path, b"TREE"), r"unreadable \(.*B-tree"),
    "heap.h5": (lambda path: write_damaged(path, b"HEAP"), r"unreadable \(.*heap"),
    "link.h5": (lambda path: write_damaged(path, b"SNOD"), "unreadable"),
    "group.h5": (lambda path: write_hdf5(path, **{"x": X, "y": Y, "separation/a": X}), "unread"),
    "empty.csv": (lambda path: path.write_text(""), "no rows"),
    "ragged.csv": (lambda path: path.write_text("x,y,separation\n1,2\n"), "line 1.* of 3 cells"),
    "header.csv": (lambda path: path.write_text("x,y,separation\n"), "no rows below"),
    "units.csv": (lambda path: path.write_text("y [mm];separation\n0;1\n"), "the unit of sep"),
    "order.csv": (lambda path: path.write_text("z,x,v\n1,2,3\n"), "columns z, x, v"),
    "words.csv": (lambda path: path.write_text("x,y,separation\na,b,c\n"), "no rows below"),
    "nan.csv": (
        lambda path: path.write_text("# y separation\n0 1\n\n1 nan\n"),
        "line 4, 'nan' in column sep",
    ),
    "falling.csv": (
        lambda path: path.write_text("y,separation\n0,1\n2,1\n1,1\n"),
        "increase, 1 after 2;",
    ),
    "matrix.csv": (lambda path: path.write_text("y,0,1,2\n0,1,1,1\n1,1,x,1\n"), "line 3, 'x';"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_reported_with_the_file_and_the_cure(tmp_path, name):
    write, found = FAULTS[name]
    write(tmp_path / name)
    with pytest.raises(GapError, match=found) as error:
        read_gap(tmp_path / name)
    assert error.value.key == "gap.file"
    assert name in error.value.given
    assert error.value.allowed


def test_lengths_are_bounded_as_those_of_a_scene():
    assert gap.LARGEST == keys.LARGEST


def test_units_are_those_of_the_file(tmp_path):
    path = tmp_path / "gap.h5"
    write_hdf5(path, x=X, y=Y, separation=1e3 * SEPARATION)
    with h5py.File(path, "r+") as file:
        file["separation"].attrs["Unit"] = "um"
    with pytest.raises(GapError, match="units of x, y"):
        read_gap(path)
    with h5py.File(path, "r+") as file:
        file.attrs["units"] = "mm"
    np.testing.assert_allclose(read_gap(path)[2], SEPARATION, rtol=1e-15)  # one product
    with h5py.File(path, "r+") as file:
        file["separation"].attrs["units"] = "furlong"
    with pytest.raises(GapError, match=r"separation.*furlong"):
        read_gap(path)


HEIGHT = np.array([0.5, -1.25, 2.0, 0.0])  # micrometres over Y in mm
ROWS = list(zip(Y, HEIGHT, strict=True))
PROFILES = {
    "semicolon.csv": "y [mm];z [µm]\n" + "\n".join(f"{y};{z}" for y, z in ROWS),
    "comma.csv": "y_mm,z_um\n" + "\n".join(f"{y},{z}" for y, z in ROWS),
    "decimal.csv": "Y [mm]; Z [um]\n" + "\n".join(f"{y}; {z}".replace(".", ",") for y, z in ROWS),
    "tab.txt": "# stylus\n# y (mm)\tz (um)\n"
    + "\n".join(f"{y}\t{z}".replace(".", ",") for y, z in ROWS),
    "space.dat": "y [mm]  z [um]\n"
    + "\n".join(f"{y}   {z}" for y, z in zip(Y[::-1], HEIGHT[::-1], strict=True)),
    "decimal-space.txt": "y [mm]  z [um]\n"
    + "\n".join(f"{y} {z}".replace(".", ",") for y, z in ROWS),
}


@pytest.mark.parametrize("name", PROFILES)
def test_profiles_as_instruments_write_them(tmp_path, name):
    path = tmp_path / name
    path.write_text(PROFILES[name], encoding="utf-8")
    _, y, separation = read_gap(ts.Gap(file=path, body="A"))
    np.testing.assert_array_equal(y, Y)
    for row in separation:  # what stands out of a body closes the gap
        np.testing.assert_allclose(row, -1e-3 * HEIGHT, rtol=1e-15)
    depths = read_gap(ts.Gap(file=path, body="B", positive="inward"))[2]
    np.testing.assert_array_equal(depths, -separation)


def test_a_profile_without_a_header_has_the_units_of_the_scene(tmp_path):
    path = tmp_path / "trace.txt"
    np.savetxt(path, np.stack([1e3 * Y, 1e3 * HEIGHT], axis=1))
    gap = ts.Gap(file=path, body="A", unit="nm", length_unit="um")
    _, y, separation = read_gap(gap)
    np.testing.assert_allclose(y, Y, rtol=1e-15)
    np.testing.assert_allclose(separation[0], -1e-3 * HEIGHT, rtol=1e-15)


@pytest.mark.parametrize("name", ["map.npy", "map.npz", "map.csv", "map.txt"])
def test_a_map_with_a_step_is_centred(tmp_path, name):
    path = tmp_path / name
    if name.endswith("npy"):
        np.save(path, SEPARATION)
    elif name.endswith("npz"):
        np.savez(path, SEPARATION)
    else:
        np.savetxt(path, SEPARATION, delimiter="," if name.endswith("csv") else " ")
    x, y, separation = read_gap(ts.Gap(file=path, step=[0.5, 0.25]))
    np.testing.assert_array_equal(x, [-0.5, 0.0, 0.5])
    np.testing.assert_array_equal(y, [-0.375, -0.125, 0.125, 0.375])
    np.testing.assert_array_equal(separation, SEPARATION)


def test_an_archive_of_named_arrays(tmp_path):
    path = tmp_path / "profile.npz"
    np.savez(path, y=Y, z=HEIGHT)
    assert read_gap(ts.Gap(file=path, body="A", unit="um"))[2].shape == (2, 4)
    np.savez(path, x=X, y=Y, separation=SEPARATION)
    np.testing.assert_array_equal(read_gap(path)[2], SEPARATION)


def test_what_a_table_cannot_mean(tmp_path):
    with pytest.raises(ts.SceneError, match="positive"):
        ts.Gap(x=X, y=Y, separation=SEPARATION, positive="inward")
    with pytest.raises(ts.SceneError, match="step"):
        ts.Gap(x=X, y=Y, separation=SEPARATION, step=[1.0, 1.0])


def test_the_heights_of_both_bodies_close_the_gap_alike():
    peaks = {body: ts.Gap(x=X, y=Y, separation=SEPARATION, body=body) for body in "AB"}
    for of_one in peaks.values():
        np.testing.assert_array_equal(read_gap(of_one)[2], -SEPARATION)
    assert peaks["A"] != peaks["B"]


def test_scattered_points_are_refused_without_their_grid(tmp_path):
    """Of 30,000 points it would have 9e8 numbers, 7 GB; what is refused takes a few MB."""
    rng = np.random.default_rng(5)
    path = tmp_path / "scattered.npy"
    np.save(path, rng.random((30_000, 3)))
    tracemalloc.start()
    with pytest.raises(GapError, match="30000"):
        read_gap(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # The points, their order and their places: some ten numbers a point, sorted in copies.
    assert peak < 50 * 8 * 30_000


def test_a_fault_names_the_table_that_requested_the_file(tmp_path):
    path = tmp_path / "profile.csv"
    path.write_text("0 1\n1 2\n")
    with pytest.raises(GapError) as raised:
        read_gap(Gap(file=path), "transient.profile.B")
    for error in (raised.value, pickle.loads(pickle.dumps(raised.value))):
        assert error.key == "transient.profile.B.file"
        assert "transient.profile.B.body" in error.allowed
    with pytest.raises(GapError, match=r"gap\.body"):
        read_gap(Gap(file=path))


def write_text(path, text):
    path.write_text(text, encoding="utf-8")
    return path


MATRIX = "\n".join(" ".join(f"{v:.9g}" for v in row) for row in 1e-3 * SEPARATION) + "\n"


def test_a_matrix_uses_its_heading(tmp_path):
    """Rows lie along x; a size is that of all points, each in the middle of its share."""
    heading = "# Channel\n# Width: 8.00 mm\n# Height: 1.5 mm\n# Value units: m\n"
    path = write_text(tmp_path / "map.txt", heading + MATRIX)
    with pytest.warns(ts.SceneWarning, match=r"0\.5 and 2 mm"):
        x, y, separation = read_gap(ts.Gap(file=path))
    np.testing.assert_allclose(x, [-0.5, 0.0, 0.5])
    np.testing.assert_allclose(y, [-3.0, -1.0, 1.0, 3.0])
    np.testing.assert_allclose(separation, SEPARATION, rtol=1e-8)  # printed digits
    with pytest.raises(GapError, match=r"gap\.step = 2 mm along y"):
        read_gap(ts.Gap(file=path, step=[0.5, 0.5]))


@pytest.mark.parametrize("corner", ["0.2", "0"])
def test_a_matrix_of_numbers_is_not_guessed_to_contain_coordinates(tmp_path, corner):
    """A plane that rises in both directions: the map was not levelled."""
    plane = 0.2 * np.arange(6)[:, None] + 0.3 * np.arange(5)
    rows = [" ".join(f"{v:.3f}" for v in row) for row in plane]
    path = write_text(tmp_path / "tilted.txt", "\n".join([corner + rows[0][5:], *rows[1:]]))
    with pytest.raises(GapError, match=r"gap\.step"):
        read_gap(path)
    assert read_gap(ts.Gap(file=path, step=[1.0, 1.0]))[2].shape == plane.shape


def test_missing_points_are_filled_up_to_a_width(tmp_path):
    x, y = np.arange(5.0), np.arange(6.0)
    plane = 1e-3 * (x[:, None] + 2.0 * y)
    holed = plane.copy()
    holed[2, 2:4] = np.nan
    points = np.array([[a, b, z] for a, row in zip(x, holed, strict=True)
                       for b, z in zip(y, row, strict=True)])  # fmt: skip
    for name, values in (("map.npy", points), ("absent.npy", points[np.isfinite(points[:, 2])])):
        np.save(tmp_path / name, values)
        with pytest.raises(GapError, match=r"gap\.missing"):
            read_gap(tmp_path / name)
        with pytest.warns(ts.SceneWarning, match="2 of 30 points"):
            filled = read_gap(ts.Gap(file=tmp_path / name, missing="interpolate"))[2]
        np.testing.assert_allclose(filled, plane, rtol=1e-12)  # a plane is interpolated exactly
        with pytest.raises(GapError, match="missing_width"):
            read_gap(ts.Gap(file=tmp_path / name, missing="interpolate", missing_width=1.0))
    points[0, 2] = np.nan
    np.save(tmp_path / "corner.npy", points)
    with pytest.raises(GapError, match="edge"):
        read_gap(ts.Gap(file=tmp_path / "corner.npy", missing="interpolate"))


def test_marks_of_missing_points(tmp_path):
    values = SEPARATION.copy()
    values[1, 1] = -9999.0
    np.save(tmp_path / "map.npy", values)
    table = {"file": tmp_path / "map.npy", "step": [1.0, 1.0]}
    with pytest.raises(GapError, match="-9999 at 1 points"):
        read_gap(ts.Gap(**table))
    with pytest.warns(ts.SceneWarning, match="1 of 12"):
        assert abs(read_gap(ts.Gap(**table, missing="interpolate"))[2]).max() < 1.0
    values[1, 1] = 12.5
    np.save(tmp_path / "map.npy", values)
    with pytest.warns(ts.SceneWarning, match="outliers"):
        read_gap(ts.Gap(**table))


@pytest.mark.parametrize("dims", [("x", "y"), ("y", "x")])
@pytest.mark.parametrize(("name", "engine"), [("a.h5", "h5netcdf"), ("a.nc", "scipy")])
def test_named_dimensions_have_any_order(tmp_path, dims, name, engine):
    xarray = pytest.importorskip("xarray")
    values = xarray.DataArray(SEPARATION, {"x": X, "y": Y}, ("x", "y"))
    data = xarray.Dataset({"separation": values.transpose(*dims)})
    packed = {"dtype": "i4", "scale_factor": 1e-9, "_FillValue": -(2**31)}
    data.to_netcdf(tmp_path / name, engine=engine, encoding={"separation": packed})
    np.testing.assert_allclose(read_gap(tmp_path / name)[2], SEPARATION, atol=1e-9)  # as packed


def test_other_dimensions_are_refused(tmp_path):
    path = tmp_path / "a.h5"
    write_hdf5(path, x=X, y=Y, separation=SEPARATION)
    with h5py.File(path, "r+") as file:
        file["separation"].dims[0].label = "time"
    with pytest.raises(GapError, match="dimensions time"):
        read_gap(path)


def test_names_choose_the_columns(tmp_path):
    """A column of heights needs its body, and a column of depths its direction."""
    rows = "\n".join(f"{z};{y}" for y, z in ROWS)
    path = write_text(tmp_path / "trace.csv", f"Height [um];Lateral_(mm)\n{rows}\n")
    _, y, separation = read_gap(ts.Gap(file=path, body="A"))
    np.testing.assert_array_equal(y, Y)
    np.testing.assert_allclose(separation[0], -1e-3 * HEIGHT, rtol=1e-15)
    write_text(path, f"depth [um];y [mm]\n{rows}\n")
    with pytest.raises(GapError, match=r"gap\.positive"):
        read_gap(ts.Gap(file=path, body="A"))
    inward = read_gap(ts.Gap(file=path, body="A", positive="inward"))[2]
    np.testing.assert_allclose(inward, -separation, rtol=1e-15)


GRID = "\n".join(" ".join(f"{v:.9g}" for v in row) for row in POINTS) + "\n"
STATED = {
    "y\\x": ("y\\x 0 1 2\n0 1 1 1\n1 1 2 1\n", {}, "another layout"),
    "corner unit": ("x/y[um] 0 1 2\n0 1 1 1\n1 1 2 1\n", {}, "line 1"),
    "columns": ("# columns: y x z\n" + GRID, {}, "another layout"),
    "assigned columns": ("# Columns = y, x, z\n" + GRID, {}, "another layout"),
    "format": ("Format: Y X Z\n" + GRID, {}, "another layout"),
    "rows": ("# rows: y, columns: x\n" + MATRIX, {"step": [1, 1]}, "another layout"),
    "origin": ("# Origin: lower left\n" + MATRIX, {"step": [1, 1]}, "Origin"),
    "dx": ("# dx = 0.1\n" + MATRIX, {"step": [1, 1], "unit": "mm"}, "gap.step"),
    "pixel": ("# pixel size: 0.1\n" + MATRIX, {"step": [1, 1], "unit": "mm"}, "gap.step"),
    "count": ("# Columns: 12\n" + MATRIX, {"step": [1, 1]}, "but 3 rows"),
    "counts": ("# 12 x 9 points\n" + MATRIX, {"step": [1, 1]}, "but 3 rows"),
    "xres": ("# xres = 12\n" + MATRIX, {"step": [1, 1]}, "but 3 rows"),
    "ESRI": ("ncols 12\nnrows 9\n" + MATRIX, {"step": [1, 1]}, "but 3 rows"),
    "points with a step": (GRID, {"step": [1, 1]}, "three columns"),
    "sign": ("# positive: down\n" + MATRIX, {"step": [1, 1]}, "gap.positive"),
    "direction": ("# Direction: into the material\n" + MATRIX, {"step": [1, 1]}, "gap.positive"),
    "strengthening": ("# Verstaerkung: 1000\n" + MATRIX, {"step": [1, 1]}, "not applied"),
    "amplification": ("Amplification: 10\n" + MATRIX, {"step": [1, 1]}, "not applied"),
    "conversion": ("Conversion=10\n" + MATRIX, {"step": [1, 1]}, "not applied"),
    "unit with a factor": ("Unit: 1e-6 m\n" + MATRIX, {"step": [1, 1]}, "not applied"),
    "tenths": ("# value unit = 0.1 mm\n" + MATRIX, {"step": [1, 1]}, "not applied"),
    **{
        name: (f"y [mm];{name} [mm]\n0;1\n1;2\n", {"body": "A"}, "columns y")
        for name in ("-z", "z inverted", "1000*z", "z*1e3", "z x1000", "z x 10")
    },
}


@pytest.mark.parametrize("case", STATED)
def test_stated_layouts_and_scales_that_are_not_used_are_refused(tmp_path, case):
    text, settings, named = STATED[case]
    path = write_text(tmp_path / "map.txt", text)
    with pytest.raises(GapError, match=named):
        read_gap(ts.Gap(file=path, **settings))


@pytest.mark.parametrize(
    "heading", ["# rows: x, columns: y", "# dx = 1", "# 3 x 4 points", "ncols 4", "# xres: 4"]
)
def test_stated_layouts_that_are_used_give_no_note(tmp_path, heading):
    path = write_text(tmp_path / "map.txt", f"{heading}\n{MATRIX}")
    assert read_gap(ts.Gap(file=path, step=[1.0, 1.0]))[2].shape == SEPARATION.shape


@pytest.mark.parametrize(
    ("place", "name", "value", "found"),
    [
        ("separation", "scale", 1000.0, "scale = 1000"),
        ("separation", "z_offset", 5.0, "z_offset"),
        ("separation", "scale_factor", [1.0, 2.0], "unreadable"),
        ("separation", "positive", "down", "positive"),
        ("/", "units", "furlong", "furlong"),
        ("/", "pixels", 12, "file.pixels"),
        ("y", "comment", "every 2 mm", "y.comment"),
    ],
)
def test_attributes_that_are_not_used_are_refused_or_named(tmp_path, place, name, value, found):
    path = tmp_path / "gap.h5"
    write_hdf5(path, x=X, y=Y, separation=SEPARATION)
    with h5py.File(path, "r+") as file:
        file[place].attrs[name] = value
    with pytest.raises((GapError, ts.SceneWarning), match=found):
        read_gap(path)


@pytest.mark.parametrize(
    ("text", "settings"),
    [
        ("# Value units: m\n" + MATRIX, {"step": [1.0, 1.0]}),
        ("y [mm];separation [m]\n0;1\n1;2\n2;1\n", {"length_unit": "mm"}),
    ],
)
def test_a_unit_that_the_scene_replaces_is_named(tmp_path, text, settings):
    path = write_text(tmp_path / "map.txt", text)
    plain = read_gap(ts.Gap(file=path, unit="m", **settings))[2]
    with pytest.warns(ts.SceneWarning, match="in um, as the scene states, and not in m"):
        other = read_gap(ts.Gap(file=path, unit="um", **settings))[2]
    np.testing.assert_allclose(1e6 * other, plain)


@pytest.mark.parametrize("kind", [bool, complex])
def test_arrays_of_other_than_real_numbers_are_refused(tmp_path, kind):
    np.save(tmp_path / "a.npy", SEPARATION.astype(kind))
    with pytest.raises(GapError, match=f"array of {kind.__name__}"):
        read_gap(ts.Gap(file=tmp_path / "a.npy", step=[1.0, 1.0]))


def test_other_arrays_of_a_file_are_named(tmp_path):
    arrays = {"x": X, "y": Y, "separation": SEPARATION}
    write_hdf5(tmp_path / "a.h5", **arrays, quality=SEPARATION)
    np.savez(tmp_path / "a.npz", **arrays, quality=SEPARATION)
    for name in ("a.h5", "a.npz"):
        with pytest.warns(ts.SceneWarning, match="quality"):
            read_gap(tmp_path / name)
    np.savez(tmp_path / "b.npz", **arrays, units=np.array(["um"]))
    with pytest.raises(GapError, match=r"units.*gap\.unit"):
        read_gap(tmp_path / "b.npz")
