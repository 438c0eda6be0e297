import os
from math import inf

import h5py
import numpy as np
import pytest

from tests.store.sample_records import SCENE, make_record, mesh, records
from tractive_sam.results.history import History
from tractive_sam.store import HistoryWriter, ResultsError, open_history
from tractive_sam.store.writer import Checkpoints


def test_file_and_memory_hold_the_same(finished):
    stored = open_history(finished)
    kept = History.of_records(
        records(7),
        SCENE,
        mesh(),
        message="every revolution",
    )
    assert stored.to_dict() == kept.to_dict()
    assert len(stored) == len(kept) == 7
    np.testing.assert_array_equal(stored["wear_profile"], kept["wear_profile"])
    np.testing.assert_array_equal(stored.field_revolutions, [0, 30, 60])
    for revolution in (0, 30, 60, None):
        for name in stored.fields:
            np.testing.assert_array_equal(
                stored.field(name, revolution), kept.field(name, revolution)
            )


def test_many_records(path):
    count = 1100  # more than two chunks of rows
    with HistoryWriter(path, SCENE, mesh()) as writer:
        for record in records(count, every=50):
            writer.append(record)
        writer.finish("done")
    history = open_history(path)
    np.testing.assert_array_equal(history["revolution"], 10 * np.arange(count))
    np.testing.assert_array_equal(history.field("pressure", 1000), 100.0)
    with h5py.File(path) as file:
        assert len(file["history/P"]) == len(file["history/record"]) == count


def test_records_wait_for_a_checkpoint(path, monkeypatch):
    """At the first record, if too many fields wait, when it is due, and at the end."""
    size = sum(one.nbytes for one in make_record(0, with_fields=True).fields.values())
    monkeypatch.setattr("tractive_sam.store.writer.PENDING_BYTES", 2 * size)

    class Due(Checkpoints):
        is_due = True

    checkpoints = Due()
    with HistoryWriter(path, SCENE, mesh(), checkpoints=checkpoints) as writer:
        held = []
        for number, (due, with_fields) in enumerate(
            [(True, False), (False, True), (False, True), (False, True), (False, False)]
        ):
            checkpoints.is_due = due
            writer.append(make_record(number, with_fields))
            held.append(len(open_history(path)))
        assert held == [1, 1, 1, 4, 4]
        writer.finish("done")
    np.testing.assert_array_equal(open_history(path)["revolution"], 10 * np.arange(5))


def test_checkpoints_take_their_share_of_the_time(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("tractive_sam.store.writer.perf_counter", lambda: now[0])
    checkpoints = Checkpoints(share=0.1)
    assert checkpoints.is_due
    with checkpoints.take():
        now[0] += 1.0
    for now[0], due in ((1.5, False), (10.9, False), (11.1, True)):
        assert checkpoints.is_due == due


def test_file_can_be_read_while_it_is_written(path):
    with HistoryWriter(path, SCENE, mesh(), checkpoints=Checkpoints(inf)) as writer:
        for count, record in enumerate(records(5, every=2), start=1):
            writer.append(record)
            history = open_history(path)
            assert len(history) == count
            assert history.status == "running"
            assert not history.finished


def test_reopened_file_continues(finished):
    with HistoryWriter.reopen(finished) as writer:
        assert open_history(finished).status == "running"
        for number in (7, 8):
            writer.append(make_record(number, with_fields=True))
        writer.finish("done")
    history = open_history(finished)
    np.testing.assert_array_equal(history["revolution"], 10 * np.arange(9))
    np.testing.assert_array_equal(history.field_revolutions, [0, 30, 60, 70, 80])
    assert history.finished


def test_error_in_the_computation_is_reported_in_the_file(path):
    def interrupted():
        with HistoryWriter(path, SCENE, mesh()) as writer:
            writer.append(make_record(0))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    history = open_history(path)
    assert (history.status, history.message) == ("stopped early", "interrupted")
    assert len(history) == 1


def test_an_interrupt_after_the_file_changed_doubles_nothing(path, monkeypatch):
    def interrupted(*names):
        os.rename(*names)
        monkeypatch.undo()
        raise KeyboardInterrupt

    writer = HistoryWriter(path, SCENE, mesh())
    monkeypatch.setattr("tractive_sam.store.write_access.os.replace", interrupted)
    with pytest.raises(KeyboardInterrupt), writer:
        writer.append(make_record(0, with_fields=True))
    history = open_history(path)
    assert history["revolution"].tolist() == history.field_revolutions.tolist() == [0]
    assert history.status == "stopped early"


def test_record_that_fails_leaves_no_trace(path):
    with HistoryWriter(path, SCENE, mesh()) as writer:
        writer.append(make_record(0, with_fields=True))
        for with_fields in (False, True):
            with pytest.raises((TypeError, ValueError)):
                writer.append(make_record(1, with_fields, mesh(n_y=4)))
        writer.append(make_record(1))
        writer.finish("done")
    history = open_history(path)
    np.testing.assert_array_equal(history["revolution"], [0, 10])
    np.testing.assert_array_equal(history.field_revolutions, [0])
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_wider_mesh(path):
    wide = mesh(7, 13)
    with HistoryWriter(path, SCENE, mesh()) as writer:
        writer.append(make_record(1, with_fields=True))
        writer.append(make_record(2, with_fields=True, grid=wide), wide)
        writer.finish("done")
    stored = open_history(path)
    both = [make_record(1, with_fields=True), make_record(2, with_fields=True, grid=wide)]
    kept = History.of_records(both, SCENE, wide)
    np.testing.assert_array_equal(stored.x, wide.x)
    np.testing.assert_array_equal(stored["wear_profile"], kept["wear_profile"])
    for revolution in (10, 20):
        pressure = stored.field("pressure", revolution)
        np.testing.assert_array_equal(pressure, kept.field("pressure", revolution))
    assert stored.field("pressure", 10).sum() == make_record(1, True).fields["pressure"].sum()


def test_only_results_are_overwritten_and_only_on_demand(finished, tmp_path):
    with pytest.raises(ResultsError, match="overwrite=True"):
        HistoryWriter(finished, SCENE, mesh())
    HistoryWriter(finished, SCENE, mesh(), overwrite=True)
    assert len(open_history(finished)) == 0
    precious = tmp_path / "precious.h5"
    with h5py.File(precious, "w") as file:
        file["gold"] = 1
    with pytest.raises(ResultsError, match="precious"):
        HistoryWriter(precious, SCENE, mesh(), overwrite=True)
    with h5py.File(precious) as file:
        assert file["gold"][()] == 1
    with pytest.raises(ResultsError, match="nowhere"):
        HistoryWriter(tmp_path / "nowhere" / "history.h5", SCENE, mesh())


def test_link_continues_to_point_to_the_results(path, tmp_path):
    link = tmp_path / "link.h5"
    link.symlink_to(path)
    HistoryWriter(path, SCENE, mesh())
    HistoryWriter.reopen(link).append(make_record(0, with_fields=True))
    assert link.is_symlink()
    assert len(open_history(path)) == 1
