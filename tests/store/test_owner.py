"""A results file has one writer, from the first reading to the last record."""

import subprocess
import sys
from math import inf

import pytest

import tractive_sam as ts
from tests.store.sample_records import SCENE, make_record, mesh
from tractive_sam.store import (
    FileInUseError,
    HistoryWriter,
    ResultsError,
    open_history,
    results_writer,
)
from tractive_sam.store.writer import Checkpoints


def test_a_second_run_is_refused_while_the_first_rolls(tmp_path):
    path = tmp_path / "discs.h5"
    coarse = ["grid.half_length=[0.35, 0.7]", "grid.elements=[15, 15]", "wear.revolutions=3"]
    scene = ts.Scene.builtin("twin-discs").with_set(coarse)
    refused = []

    def take_over(record):
        for options in ({"overwrite": True}, {"resume": True}):
            with pytest.raises(FileInUseError) as reported:
                ts.roll(scene, path, **options)
            refused.append(str(reported.value))

    history = ts.roll(scene, path, progress=take_over)
    assert refused
    assert all(str(path) in reported for reported in refused)
    assert history["revolution"].tolist() == [0, 1, 2, 3]
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_a_writer_that_was_killed_holds_nothing(finished):
    holds = (
        "import sys, time, pathlib; from tractive_sam.store import results_writer\n"
        "with results_writer(pathlib.Path(sys.argv[1]), True):\n"
        "    print('held', flush=True); time.sleep(60)"
    )
    command = [sys.executable, "-c", holds, finished]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as holder:
        assert holder.stdout.readline().strip() == b"held"
        with pytest.raises(FileInUseError), results_writer(finished, overwrite=True):
            pass
        holder.kill()
    with results_writer(finished, overwrite=True):
        pass


def test_where_there_are_no_locks_a_file_that_was_taken_over_is_not_mixed(path):
    with HistoryWriter(path, SCENE, mesh(), checkpoints=Checkpoints(inf)) as first:
        first.append(make_record(0, with_fields=True))
        second = HistoryWriter.reopen(path)
        with pytest.raises(ResultsError, match="run"):
            first.append(make_record(1, with_fields=True))
        second.append(make_record(1))
        second.finish("done")
    assert open_history(path)["revolution"].tolist() == [0, 10]


def test_a_file_that_moved_on_since_it_was_read_is_not_resumed(finished):
    read = len(open_history(finished))
    HistoryWriter.reopen(finished, records=read).append(make_record(7, with_fields=True))
    with pytest.raises(ResultsError, match=f"{read} .* {read + 1}"):
        HistoryWriter.reopen(finished, records=read)
    assert open_history(finished)["revolution"].tolist() == [10 * k for k in range(read + 1)]
