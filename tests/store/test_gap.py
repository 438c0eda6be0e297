import pickle
import tracemalloc

import h5py
import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.scene import Gap
from tractive_sam.schema import field_types
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
    rows = [["y \\ x", *Y], *([x, *row] for x, row in zip(X, SEPARATION, strict=True))]
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
    "nan.npy": (lambda path: np.save(path, with_nan()), r"nan in array\[5, 2\];"),
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
    "units.csv": (lambda path: path.write_text("y [mm];z\n0;1\n"), "the unit of z"),
    "order.csv": (lambda path: path.write_text("z,x,y\n1,2,3\n"), "columns z, x, y"),
    "words.csv": (lambda path: path.write_text("x,y,separation\na,b,c\n"), "no rows below"),
    "nan.csv": (lambda path: path.write_text("# y z\n0 1\n\n1 nan\n"), "line 4, 'nan' in column z"),
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
    assert gap.LARGEST == field_types.LARGEST


def test_units_are_those_of_the_file(tmp_path):
    path = tmp_path / "gap.h5"
    write_hdf5(path, x=X, y=Y, separation=1e3 * SEPARATION)
    with h5py.File(path, "r+") as file:
        file["separation"].attrs["units"] = "um"
    np.testing.assert_allclose(read_gap(path)[2], SEPARATION, rtol=1e-15)  # one product
    with h5py.File(path, "r+") as file:
        file["separation"].attrs["units"] = "inch"
    with pytest.raises(GapError, match=r"separation.*inch"):
        read_gap(path)


HEIGHT = np.array([0.5, -1.25, 2.0, 0.0])  # micrometres over Y in mm
ROWS = list(zip(Y, HEIGHT, strict=True))
PROFILES = {
    "semicolon.csv": "y [mm];z [µm]\n" + "\n".join(f"{y};{z}" for y, z in ROWS),
    "comma.csv": "y_mm,z_um\n" + "\n".join(f"{y},{z}" for y, z in ROWS),
    "decimal.csv": "Y [mm]; Z [um]\n" + "\n".join(f"{y}; {z}".replace(".", ",") for y, z in ROWS),
    "tab.txt": "# stylus 2 um\n# y (mm)\tz (um)\n"
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
