"""On a full disk a file stays unchanged and an error is reported; with room again it continues."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.store.sample_records import SCENE, make_record, mesh, with_stress
from tractive_sam.store import HistoryWriter, Image, StorageError, open_history, write_volume

resource = pytest.importorskip("resource", reason="limits the size of files")

RECORDS, SIZES = 7, 5


def record(number):
    grid = mesh(31, 41)
    made = make_record(number, with_fields=number % 3 == 0, grid=grid)
    for field in made.fields.values():
        field[:] = np.random.default_rng(number).random(field.shape)  # not to be compressed
    return with_stress(made, grid)


def roll(path, first=0):
    if first:
        writer = HistoryWriter.reopen(path)
    else:
        writer = HistoryWriter(path, SCENE, mesh(31, 41), overwrite=True)
    with writer:
        for number in range(first, RECORDS):
            writer.append(record(number))
        writer.finish("done")


def assert_true(path):
    """All that the file holds is as it was handed over."""
    history = open_history(path)
    count = len(history)
    for name in history.of_dims():
        np.testing.assert_array_equal(history[name], [record(k).values[name] for k in range(count)])
    kept = [k for k in range(count) if k % 3 == 0]
    np.testing.assert_array_equal(history.field_revolutions, [10 * k for k in kept])
    for k in kept:
        for name in history.fields:
            np.testing.assert_array_equal(history.field(name, 10 * k), record(k).fields[name])
    return count


def limited(size, act, *arguments):
    """Act with files limited to `size`; return whether it failed with a message."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        act(*arguments)
    except StorageError:
        return True
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    return False


def volume(path):
    layers = np.random.default_rng(1).random((5, 31, 41))
    image = Image((31, 41, 5), (0.0, 0.0, 0.0), (0.1, 0.1, 0.1))
    names = ("von_mises", "max_shear")
    write_volume(path, image, [dict.fromkeys(names, layer) for layer in layers], SCENE, {})


def every_size(folder):
    path, failed = folder / "a.h5", 0
    roll(path)
    whole = path.stat().st_size
    for size in np.linspace(0, whole, SIZES, endpoint=False, dtype=int):
        path.unlink(missing_ok=True)
        failed += limited(int(size), roll, path)
        assert [file for file in folder.iterdir() if file != path] == []
        count = assert_true(path) if path.exists() else 0
        roll(path, first=count)
        assert assert_true(path) == RECORDS
    assert failed == SIZES
    for size in (0, 5_000, 30_000):
        assert limited(size, volume, folder / "a.vtkhdf")
        assert [file for file in folder.iterdir() if file != path] == []


@pytest.mark.slow  # a run for every size of the disk, each with many small files to write
def test_where_room_ends_nothing_is_lost_and_the_process_lives(tmp_path):
    # In a separate process: what fails in HDF5 may end it, also after the last line.
    found = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    run = subprocess.run([sys.executable, __file__, tmp_path], env=found, check=False)
    assert run.returncode == 0


if __name__ == "__main__":
    every_size(Path(sys.argv[1]))
