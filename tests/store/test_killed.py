"""A results file is complete whenever its writer is killed."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from math import inf
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.store.sample_records import SCENE, make_record, mesh
from tractive_sam.store import HistoryWriter, open_history, results_writer
from tractive_sam.store.write_access import atomic_rewrite
from tractive_sam.store.writer import Checkpoints

pytestmark = pytest.mark.slow  # writers are killed, again and again

KILLS = 10


def is_fields_record(number):
    return number % 7 == 0


def write_for_ever(path, tally):
    """Write records, and after each its number into another file."""
    with HistoryWriter(path, SCENE, mesh(), checkpoints=Checkpoints(inf)) as history:
        for number in range(1_000_000):
            history.append(make_record(number, is_fields_record(number)))
            os.pwrite(tally, (number + 1).to_bytes(8, "little"), 0)


def kill_writers(folder):
    """Start writers one after the other and kill each at a random moment."""
    chance = random.Random(1)
    for k in range(KILLS):
        tally = os.open(folder / f"{k}.tally", os.O_CREAT | os.O_RDWR)
        child = os.fork()
        if child == 0:
            try:
                write_for_ever(folder / f"{k}.h5", tally)
            finally:
                os.pwrite(tally, b"failed", 0)
                os._exit(1)
        while not os.pread(tally, 8, 0):
            time.sleep(1e-3)
        time.sleep(chance.uniform(0.0, 0.15))
        os.kill(child, signal.SIGKILL)
        assert os.WIFSIGNALED(os.waitpid(child, 0)[1])
        os.close(tally)


def assert_whole(path, count):
    """Every one of the first records is there, and at most one more."""
    history = open_history(path)
    n = len(history)
    assert count <= n <= count + 1
    assert history.status == "running"
    np.testing.assert_array_equal(history["revolution"], 10 * np.arange(n))
    np.testing.assert_allclose(history["wear_profile"], np.outer(1e-6 * np.arange(n), np.ones(9)))
    for name in history.of_dims():
        expected = [make_record(k).values[name] for k in range(n)]
        np.testing.assert_array_equal(history[name], expected)
    np.testing.assert_array_equal(
        history.field_revolutions, [10 * k for k in range(n) if is_fields_record(k)]
    )
    for revolution in history.field_revolutions:
        np.testing.assert_array_equal(history.field("pressure", revolution), revolution / 10)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills forked processes")
def test_killed_writer_loses_no_record_of_a_checkpoint(tmp_path):
    # In a separate process, which has no threads that a fork could leave in the lurch.
    found = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, __file__, tmp_path], check=True, env=found)
    for k in range(KILLS):
        count = int.from_bytes((tmp_path / f"{k}.tally").read_bytes(), "little")
        assert_whole(tmp_path / f"{k}.h5", count)


def test_copies_left_behind_are_removed(path, finished):
    """By the next writer, who is the only one: no one works on them any more."""
    left = [path.with_name(f".{path.name}.{run}.new") for run in ("one", "two")]
    for copy in left:
        shutil.copyfile(finished, copy)
    other = path.with_name(".other.h5.one.new")
    shutil.copyfile(finished, other)
    with results_writer(path, overwrite=True):
        assert not any(copy.exists() for copy in left)
    assert other.exists()
    assert sorted(file.name for file in path.parent.iterdir()) == [other.name, path.name]


def test_two_replacements_at_once_do_not_mix(path, finished):
    """Each ends with a complete file, written by the one that ends last."""
    with atomic_rewrite(path) as one:
        one.attrs["run"] = "one"
        with atomic_rewrite(path) as two:
            two.attrs["run"] = "two"
        with h5py.File(path) as file:
            assert file.attrs["run"] == "two"
    with h5py.File(path) as file:
        assert file.attrs["run"] == "one"
    assert len(open_history(path)) == len(open_history(finished))
    assert not list(path.parent.glob(".*.new"))


if __name__ == "__main__":
    kill_writers(Path(sys.argv[1]))
