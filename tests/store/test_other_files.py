"""Files that others wrote lead to no other file of the machine, and claims are checked."""

import json
import os
import threading
import zipfile
from contextlib import suppress

import h5py
import numpy as np
import pytest

import tractive_sam as ts
from tests.store.sample_records import SCENE, mesh, records
from tractive_sam import input_file
from tractive_sam.schema import SceneError
from tractive_sam.store import (
    GapError,
    HistoryWriter,
    ResultsError,
    gap,
    open_history,
    read_gap,
)
from tractive_sam.store.layout import set_text

X = np.linspace(-2.0, 2.0, 5)
SECRET = 12345.0
LINKS = ("external", "soft", "virtual", "raw")


def put(group, name, shape, kind, folder):
    """Lay numbers of another file under a name, in one of the ways that HDF5 has."""
    with h5py.File(folder / "secret.h5", "w") as file:
        file["z"] = np.full(shape, SECRET)
    (folder / "secret.bin").write_bytes(np.full(shape, SECRET).tobytes())
    if kind == "external":
        group[name] = h5py.ExternalLink(str(folder / "secret.h5"), "/z")
    elif kind == "soft":
        group.file["elsewhere"] = h5py.ExternalLink(str(folder / "secret.h5"), "/z")
        group[name] = h5py.SoftLink("/elsewhere")
    elif kind == "virtual":
        layout = h5py.VirtualLayout(shape, float, maxshape=(None, *shape[1:]))
        layout[...] = h5py.VirtualSource(str(folder / "secret.h5"), "z", shape)
        group.create_virtual_dataset(name, layout)
    else:
        raw = [(str(folder / "secret.bin"), 0, 8 * int(np.prod(shape)))]
        group.create_dataset(name, shape, float, external=raw)


@pytest.mark.filterwarnings("ignore::tractive_sam.SceneWarning")  # arrays that are not read
@pytest.mark.parametrize("name", ["x", "y", "separation"])
@pytest.mark.parametrize("kind", LINKS)
def test_gap_reads_no_other_file(tmp_path, kind, name):
    arrays = {"x": X, "y": X, "separation": np.zeros((5, 5))}
    with h5py.File(tmp_path / "gap.h5", "w") as file:
        for key, values in arrays.items():
            if key == name:
                put(file, key, values.shape, kind, tmp_path)
            else:
                file[key] = values
    with pytest.raises(GapError, match=r"gap\.h5") as error:
        read_gap(tmp_path / "gap.h5")
    assert str(SECRET) not in str(error.value)


def datasets_of(path):
    """Return the names of all datasets of numbers, and of groups."""
    found = []
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.append((name, isinstance(item, h5py.Group))))
    return found


@pytest.fixture
def stored(tmp_path):
    path = tmp_path / "stored.h5"
    with HistoryWriter(path, SCENE, mesh()) as writer:
        for record in records(3):
            writer.append(record)
        writer.finish("done", "every revolution")
    return path


def read_all(path):
    """Everything that a history reads of its file."""
    history = open_history(path)
    arrays = [history[name] for name in history.columns]
    arrays += [history.field(name, at) for at in history.saved for name in ("pressure", "wear")]
    return arrays


@pytest.mark.slow
@pytest.mark.parametrize("kind", LINKS)
def test_results_read_no_other_file(stored, tmp_path, kind):
    whole = stored.read_bytes()
    # Each kind of link in other datasets: together they are in all of them.
    for name, is_group in datasets_of(stored)[LINKS.index(kind) :: len(LINKS)]:
        stored.write_bytes(whole)
        with h5py.File(stored, "r+") as file:
            group, _, last = name.rpartition("/")
            shape = () if is_group else file[name].shape
            del file[name]
            put(file[group or "/"], last, shape or (3,), kind, tmp_path)
        before = (tmp_path / "secret.bin").read_bytes()
        with suppress(ResultsError):  # of what is not read nothing comes
            assert not any((one == SECRET).any() for one in read_all(stored))
        # To resume it copies the complete file, and would write into the other file.
        with pytest.raises(ResultsError):
            HistoryWriter.reopen(stored)
        assert (tmp_path / "secret.bin").read_bytes() == before


def test_group_that_lies_in_itself_ends(stored):
    with h5py.File(stored, "r+") as file:
        file["history/again"] = file["history"]
    with pytest.raises(ResultsError):
        HistoryWriter.reopen(stored)


def grown(path):
    with h5py.File(path, "r+") as file:
        for one in file["history"].values():
            if one.shape and one.maxshape[0] is None:
                one.resize(4 * 10**8, axis=0)


def test_results_of_more_records_than_fit_are_refused(stored):
    grown(stored)
    with pytest.raises(ResultsError, match="MiB"):
        open_history(stored)


def npy_claim(path):
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2000000000, 3), }"
    path.write_bytes(b"\x93NUMPY\x01\x00v\x00" + header.ljust(117) + b"\n" + b"0" * 100)


def npz_claim(path):
    npy_claim(path.with_suffix(".npy"))
    with zipfile.ZipFile(path, "w") as archive:
        archive.write(path.with_suffix(".npy"), "y.npy")


def npy_objects(path):
    np.save(path, np.array([{}]), allow_pickle=True)


def h5_claim(path):
    with h5py.File(path, "w") as file:
        file["x"] = file["y"] = X
        file.create_dataset("separation", (200_000, 200_000), float, chunks=(1000, 1000))


@pytest.mark.parametrize(
    ("name", "write", "found"),
    [
        ("a.npy", npy_claim, r"\d+ bytes"),
        ("a.npz", npz_claim, r"\d+ bytes"),
        ("b.npy", npy_objects, "objects"),
        ("a.h5", h5_claim, "MiB"),
    ],
)
def test_gap_that_claims_more_than_it_holds(tmp_path, name, write, found):
    write(tmp_path / name)
    with pytest.raises(GapError, match=found):
        read_gap(tmp_path / name)


def test_archive_is_measured_before_it_is_unpacked(tmp_path, monkeypatch):
    path = tmp_path / "a.npz"
    np.savez_compressed(path, y=np.zeros(10**5))
    assert path.stat().st_size < 10**4
    monkeypatch.setattr(gap.npy, "read_array_header_1_0", None)
    with pytest.raises(ValueError, match="MiB"):
        gap.read_archive(path, max_bytes=8 * 10**5)  # of the numbers; the header is more


@pytest.mark.parametrize("suffix", [".csv", ".npy", ".npz", ".h5", ".txt"])
@pytest.mark.parametrize("kind", ["device", "pipe", "folder"])
def test_only_regular_files_are_inputs(tmp_path, suffix, kind):
    path = tmp_path / f"a{suffix}"
    {"device": lambda: path.symlink_to("/dev/zero"), "pipe": lambda: os.mkfifo(path),
     "folder": path.mkdir}[kind]()  # fmt: skip
    with pytest.raises(GapError, match="regular"):
        read_gap(path)
    with pytest.raises((SceneError, ValueError)):
        ts.blocks_of(path, levels=2)
    with pytest.raises(SceneError, match="regular"):
        ts.Scene.from_toml(path)
    with pytest.raises(ResultsError):
        open_history(path)


def test_scene_comes_through_a_pipe_of_the_shell(tmp_path):
    reader, writer = os.pipe()
    text = ts.Scene.builtin("spheres").to_toml().encode()
    thread = threading.Thread(target=lambda: (os.write(writer, text), os.close(writer)))
    thread.start()
    assert ts.Scene.from_toml(f"/dev/fd/{reader}") == ts.Scene.builtin("spheres")
    thread.join()
    os.close(reader)


def test_size_of_a_text_is_limited(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("12345")
    assert input_file.read_text(path, max_bytes=5) == "12345"
    with pytest.raises(OSError, match="4 bytes"):
        input_file.read_text(path, max_bytes=4)


COLUMN = {"name": "turn", "unit": "1", "long_name": "turn", "dims": [], "symbol": "n"}
COLUMN |= {"label": "turn", "format": ".3f", "whole": False, "per_length": False, "role": ""}


@pytest.mark.parametrize(
    "wrong",
    [
        {"format": "999999999f"},
        {"format": ".4000000000f"},
        {"format": "/>9f"},
        {"name": "=1+1"},
        {"name": "a/b"},
        {"unit": 5},
        {"dims": ["x"]},
        *({key: "a\x1b[31m"} for key in ("name", "unit", "long_name", "symbol", "label")),
        {"label": "\u202eabc"},
    ],
)
def test_columns_of_a_file_are_checked(stored, wrong):
    with h5py.File(stored, "r+") as file:
        set_text(file["history"], "own", json.dumps([COLUMN | wrong]))
    with pytest.raises(ResultsError, match="columns"):
        open_history(stored)
