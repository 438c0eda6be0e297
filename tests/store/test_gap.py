import tracemalloc

import h5py
import numpy as np
import pytest

from tractive_sam.scene import quantities
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
    """A file whose first bytes `what` are turned over: it opens, but does not hold together."""
    write_hdf5(path, x=X, y=Y, separation=SEPARATION)
    whole = path.read_bytes()
    path.write_bytes(whole.replace(what, bytes(255 - byte for byte in what), 1))


FAULTS = {
    "missing.h5": (lambda path: None, "no such file"),
    "a.txt": (lambda path: path.write_text("1"), "suffix '.txt'"),
    "text.h5": (lambda path: path.write_text("1"), "unreadable"),
    "no-y.h5": (lambda path: write_hdf5(path, x=X, separation=SEPARATION), "no dataset y"),
    "turned.h5": (
        lambda path: write_hdf5(path, x=X, y=Y, separation=SEPARATION.T),
        r"shape \(4, 3\)",
    ),
    "falling.h5": (
        lambda path: write_hdf5(path, x=X[::-1], y=Y, separation=SEPARATION),
        "x that does not increase",
    ),
    "single.h5": (lambda path: write_hdf5(path, x=X[:1], y=Y, separation=SEPARATION[:1]), "x of"),
    "words.h5": (lambda path: write_hdf5(path, x=["a"], y=Y, separation=SEPARATION), "unreadable"),
    "pickle.npy": (lambda path: np.save(path, np.array([{}], object)), "unreadable"),
    "two.npy": (lambda path: np.save(path, POINTS[:, :2]), r"shape \(12, 2\)"),
    "fields.npy": (lambda path: np.save(path, np.zeros(3, [("x", float)])), "no field y"),
    "hole.npy": (lambda path: np.save(path, POINTS[1:]), "11 points"),
    "twice.npy": (lambda path: np.save(path, POINTS[[0, *range(11)]]), "11 distinct"),
    "nan.npy": (lambda path: np.save(path, with_nan()), "1 separations that are not finite"),
    "nan-x.npy": (lambda path: np.save(path, POINTS * [np.nan, 1, 1]), "gap.file"),
    "empty.npy": (lambda path: path.write_bytes(b""), "unreadable"),
    "archive.npy": (write_archive, "an archive of arrays"),
    "zip.npy": (lambda path: path.write_bytes(b"PK\3\4 and no more"), "unreadable"),
    "long.csv": (lambda path: path.write_text("1" * 200_000), "unreadable .*field larger"),
    "tree.h5": (lambda path: write_damaged(path, b"TREE"), r"unreadable \(.*B-tree"),
    "heap.h5": (lambda path: write_damaged(path, b"HEAP"), r"unreadable \(.*heap"),
    "link.h5": (lambda path: write_damaged(path, b"SNOD"), "unreadable"),
    "group.h5": (lambda path: write_hdf5(path, **{"x": X, "y": Y, "separation/a": X}), "unread"),
    "empty.csv": (lambda path: path.write_text(""), "no rows"),
    "ragged.csv": (lambda path: path.write_text("x,y,separation\n1,2\n"), "rows of"),
    "header.csv": (lambda path: path.write_text("x,y,separation\n"), "x of shape"),
    "words.csv": (lambda path: path.write_text("x,y,separation\na,b,c\n"), "unreadable"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_told_with_the_file_and_the_cure(tmp_path, name):
    write, found = FAULTS[name]
    write(tmp_path / name)
    with pytest.raises(GapError, match=found) as error:
        read_gap(tmp_path / name)
    assert error.value.key == "gap.file"
    assert name in error.value.given
    assert error.value.allowed


def test_lengths_are_bounded_as_those_of_a_scene():
    assert gap.LARGEST == quantities.LARGEST


def test_other_units_are_refused(tmp_path):
    path = tmp_path / "gap.h5"
    with h5py.File(path, "w") as file:
        for name, values in (("x", [0, 1]), ("y", [0, 1]), ("separation", [[0, 1], [2, 3]])):
            file[name] = np.array(values, float)
        file["separation"].attrs["units"] = "um"
    with pytest.raises(GapError, match="separation in um"):
        read_gap(path)


def test_scattered_points_are_refused_without_their_grid(tmp_path):
    """Of 30,000 points it would have 9e8 numbers, 7 GB; what is refused takes a few MB."""
    rng = np.random.default_rng(5)
    path = tmp_path / "scattered.npy"
    np.save(path, rng.random((30_000, 3)))
    tracemalloc.start()
    with pytest.raises(GapError, match="30000 points"):
        read_gap(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # The points, their order and their places: some ten numbers a point, sorted in copies.
    assert peak < 50 * 8 * 30_000
