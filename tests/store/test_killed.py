"""A results file is whole whenever its writer is killed."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.store.sample_records import REFERENCE, SCENE, make_record, mesh
from tractive_sam.store import HistoryWriter, open_history, writer
from tractive_sam.store.replacement import ABANDONED, replacement

KILLS = 10
PAGE = 4096


def is_fields_record(number):
    return number % 7 == 0


def write_for_ever(path, tally):
    """Write records, and after each its number into another file."""
    with HistoryWriter(path, SCENE, mesh(), REFERENCE) as history:
        for number in range(1_000_000):
            history.append(make_record(number, is_fields_record(number)))
            os.pwrite(tally, (number + 1).to_bytes(8, "little"), 0)


def kill_writers(folder):
    """Start writers one after the other and kill each at a random moment."""
    writer.FIRST_ROWS = 4  # so that rows are laid out anew again and again
    chance = random.Random(1)
    for k in range(KILLS):
        tally = os.open(folder / f"{k}.tally", os.O_CREAT | os.O_RDWR)
        child = os.fork()
        if child == 0:
            write_for_ever(folder / f"{k}.h5", tally)
        while not os.pread(tally, 8, 0):
            time.sleep(1e-3)
        time.sleep(chance.uniform(0.0, 0.15))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(tally)


def assert_whole(path, count):
    """Every one of the first records is there, and at most one more."""
    with h5py.File(path) as file:
        assert count <= file["history/committed"][()] <= count + 1
    history = open_history(path)
    n = len(history)
    assert history.status == "running"
    np.testing.assert_array_equal(history["revolution"], 10 * np.arange(n))
    np.testing.assert_allclose(history["wear_profile"], np.outer(1e-6 * np.arange(n), np.ones(9)))
    for name, values in history.scalars.items():
        np.testing.assert_array_equal(values, [make_record(k).scalars[name] for k in range(n)])
    np.testing.assert_array_equal(
        history.field_revolutions, [10 * k for k in range(n) if is_fields_record(k)]
    )
    for revolution in history.field_revolutions:
        np.testing.assert_array_equal(history.field("pressure", revolution), revolution / 10)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills forked processes")
def test_killed_writer_loses_no_committed_record(tmp_path):
    # In a process of its own, which has no threads that a fork could leave in the lurch.
    found = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, __file__, tmp_path], check=True, env=found)
    for k in range(KILLS):
        count = int.from_bytes((tmp_path / f"{k}.tally").read_bytes(), "little")
        assert_whole(tmp_path / f"{k}.h5", count)


def test_row_written_in_part_is_no_record(path, tmp_path):
    """Any mixture of old and new pages of the disk reads as before, or with the new record."""
    chance = random.Random(2)
    torn = tmp_path / "torn.h5"
    with HistoryWriter(path, SCENE, mesh(), REFERENCE) as history:
        history.append(make_record(0, is_fields_record(0)))
        for number in range(1, 7):
            before = path.read_bytes()
            history.append(make_record(number))
            after = path.read_bytes()
            assert len(after) == len(before)
            with h5py.File(path) as file:
                last = file["history/committed"].id.get_offset() // PAGE
            pages = range(0, len(after), PAGE)
            changed = [
                k for k, p in enumerate(pages) if before[p : p + PAGE] != after[p : p + PAGE]
            ]
            for _ in range(8):
                mixed = bytearray(before)
                for k in chance.sample(changed, chance.randint(0, len(changed))):
                    if k != last:
                        mixed[k * PAGE : (k + 1) * PAGE] = after[k * PAGE : (k + 1) * PAGE]
                torn.write_bytes(mixed)
                assert_whole(torn, number)


def test_copies_left_behind_are_removed_and_those_at_work_are_not(path, finished):
    left, at_work = (path.with_name(f".{path.name}.{run}.new") for run in ("left", "work"))
    for copy in (left, at_work):
        shutil.copyfile(finished, copy)
    before = time.time() - 2.0 * ABANDONED
    os.utime(left, (before, before))
    HistoryWriter.reopen(path).append(make_record(7))
    assert len(open_history(path)) == 8
    assert not left.exists()
    assert at_work.exists()


def test_two_replacements_at_once_do_not_mix(path, finished):
    """Each ends with a whole file, that of the one that ends last."""
    with replacement(path) as one:
        one.attrs["run"] = "one"
        with replacement(path) as two:
            two.attrs["run"] = "two"
        with h5py.File(path) as file:
            assert file.attrs["run"] == "two"
    with h5py.File(path) as file:
        assert file.attrs["run"] == "one"
    assert len(open_history(path)) == len(open_history(finished))
    assert not list(path.parent.glob(".*.new"))


if __name__ == "__main__":
    kill_writers(Path(sys.argv[1]))
