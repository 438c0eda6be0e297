"""Studies in one process: stored results, repeated cases, and reports of failures."""

import re
import socket
from contextlib import ExitStack
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from tests.studies.conftest import CREEPAGE, MU, small
from tractive_sam.run.pipeline import roll
from tractive_sam.store import ResultsError, open_history, results_writer
from tractive_sam.studies import (
    Study,
    StudyError,
    cases,
    cluster,
    estimate_times,
    explain_study,
    open_study,
    run,
    study,
    worker,
)
from tractive_sam.studies.design import CaseLog
from tractive_sam.studies.results import Folder


@pytest.fixture
def rolled(monkeypatch):
    """The files that are rolled."""
    files = []

    def spy(scene, path, **options):
        files.append(path)
        return roll(scene, path, **options)

    monkeypatch.setattr(worker.run, "roll", spy)
    return files


@pytest.mark.slow
def test_results_are_those_of_the_scenes(tmp_path):
    results = study(small(), tmp_path, workers=0)
    assert results.complete
    for row in results.rows:
        wanted = roll(row.case.scene)
        for name in ("Qx", "Qy", "p_max", "stick_fraction"):
            # Computed twice by the same steps: the plans of the transforms may be others.
            assert row.last[name] == pytest.approx(wanted[name][-1], rel=1e-9, abs=1e-12)
        assert results.history(row.case.number).finished


def test_complete_cases_are_not_run_again(tmp_path, rolled):
    study(small(MU), tmp_path, workers=0)
    assert len(rolled) == 2
    assert study(small(MU), tmp_path, workers=0).complete
    assert len(rolled) == 2
    finer = {"key": "friction.mu", "values": [0.2, 0.3, 0.4]}
    assert study(small(finer), tmp_path, workers=0).complete
    assert len(rolled) == 3


def test_what_is_complete_is_what_the_files_say(tmp_path, rolled):
    """The table of complete cases only saves time: it may be lost, or say too much."""
    results = study(small(MU), tmp_path, workers=0)
    (tmp_path / "complete.jsonl").write_text('{"digest": "cut o')
    assert [row.last for row in open_study(tmp_path).rows] == [row.last for row in results.rows]
    assert study(small(MU), tmp_path, workers=0).complete
    assert len(rolled) == 2
    results.rows[0].file.unlink()
    assert open_study(tmp_path).counts["waiting"] == 1
    assert study(small(MU), tmp_path, workers=0).complete
    assert len(rolled) == 3


def test_complete_case_whose_file_was_spoilt_is_computed_again(tmp_path, rolled):
    results = study(small(MU), tmp_path, workers=0)
    file = results.rows[0].file
    file.write_bytes(b"")
    assert open_study(tmp_path).rows[0].status == "failed"
    reported = []
    again = study(small(MU), tmp_path, workers=0, say=reported.append)
    assert again.complete
    assert len(rolled) == 3
    # Computed twice by the same steps: the plans of the transforms may be others.
    assert again.rows[0].last["Qx"] == pytest.approx(results.rows[0].last["Qx"], rel=1e-9)
    aside = file.with_suffix(".damaged")
    assert aside.exists()
    assert len(reported) == 1
    assert aside.name in reported[0]


def test_file_that_may_not_be_read_is_left_unchanged(tmp_path, monkeypatch):
    (case, _) = cases(small(MU))
    file = tmp_path / f"{case.name}.h5"
    file.write_text("not for everybody")

    def refused(path):
        raise ResultsError(f"{path} may not be read")

    monkeypatch.setattr(worker, "open_history", refused)
    assert worker.run_case(case.scene, str(file)).status == "failed"
    assert file.read_text() == "not for everybody"


JUNK = (
    b"[1, 2]\n3\nnull\n\xff\xfe\n"
    b'{"digest": 5}\n{"digest": "a"}\n{"digest": ["a"]}\n'
    b'{"digest": "%s", "size": 1, "version": "", "message": "", "row": {"P": "text"}}\n'
)


def test_what_others_put_into_the_folder_is_left_unchanged(tmp_path, rolled):
    results = study(small(MU), tmp_path, workers=0)
    with (tmp_path / "complete.jsonl").open("ab") as table:
        table.write(b"\n" + JUNK % results.rows[0].case.digest.encode())
    (tmp_path / "notes.txt").write_bytes("Größe".encode("latin-1"))
    (tmp_path / "more.txt").mkdir()
    (tmp_path / "99999-ab.h5").mkdir()
    assert [row.last for row in open_study(tmp_path).rows] == [row.last for row in results.rows]
    assert study(small(MU), tmp_path, workers=0).complete
    assert len(rolled) == 2
    assert (tmp_path / "notes.txt").exists()


def test_versions_that_differ_are_reported(tmp_path):
    results = study(small(MU), tmp_path, workers=0)
    ((here, count),) = results.versions.items()
    assert count == 2
    log = CaseLog(tmp_path / "complete.jsonl")
    *_, second = log.read().entries.values()
    log.append(second | {"version": "0.0.1"})  # the last entry of a case counts
    assert open_study(tmp_path).versions == {"0.0.1": 1, here: 1}


@pytest.mark.slow
def test_interrupted_case_continues_from_its_last_record(tmp_path):
    wanted = roll(worn().scene)
    (case,) = cases(worn())
    file = tmp_path / f"{case.name}.h5"

    class Stop(Exception):
        pass

    def stop(record):
        if record.revolution >= 50:
            raise Stop

    with Folder(tmp_path).lock(worn()):
        pass
    with pytest.raises(Stop):
        roll(case.scene, file, progress=stop)
    before = open_history(file)
    assert open_study(tmp_path).rows[0].status == "failed"  # it says that it was stopped
    results = study(worn(), tmp_path, workers=0)
    assert results.complete
    after = results.history(0)
    np.testing.assert_array_equal(after["seconds"][: len(before)], before["seconds"])
    np.testing.assert_allclose(after["wear_max"], wanted["wear_max"], rtol=1e-6)


def worn(**given):
    return Study(
        scene="twin-discs",
        without=["subsurface"],
        set=[
            "grid.half_length=[0.35, 0.9]",
            "grid.elements=[15, 25]",
            "wear.revolutions=200",
            "wear.save=[200]",
        ],
        axis=[{"key": "friction.angle", "values": [45]}],
        **given,
    )


def failing():
    """The second force is more than friction carries, which no one knows beforehand."""
    axis = {"key": "load.force_x", "values": [0.03, 0.4, 0.05]}
    return small(axis, set=["grid.elements=[21, 21]", "load.approach=0.036"])


def test_failed_case_is_reported_and_stops_no_other(tmp_path):
    reported = []
    results = study(failing(), tmp_path, workers=0, progress=reported.append)
    assert [row.status for row in results.rows] == ["complete", "failed", "complete"]
    assert results.rows[1].message
    assert (reported[-1].ended, reported[-1].failed, reported[-1].cases) == (3, 1, 3)
    assert reported[-1].share == pytest.approx(1.0)


def test_case_that_raises_is_reported(tmp_path, monkeypatch):
    def broken(scene, path, **options):
        if scene.friction.mu[0] == 0.4:
            raise RuntimeError("no space left")
        return roll(scene, path, **options)

    monkeypatch.setattr(worker.run, "roll", broken)
    results = study(small(MU), tmp_path, workers=0)
    assert [row.status for row in results.rows] == ["complete", "failed"]
    assert results.rows[1].message == "RuntimeError: no space left"
    (reported,) = tmp_path.glob("*.txt")
    for kept in ("in broken", version("tractive-sam"), socket.gethostname()):
        assert kept in reported.read_text()
    monkeypatch.setattr(worker.run, "roll", roll)
    assert study(small(MU), tmp_path, workers=0).complete
    assert not list(tmp_path.glob("*.txt"))


def test_a_case_has_one_writer(tmp_path):
    (case, _) = cases(small(MU))
    file = tmp_path / f"{case.name}.h5"
    with results_writer(file):
        outcome = worker.run_case(case.scene, str(file))
    assert outcome.status == worker.LOCKED
    assert not file.exists()


def test_what_another_process_computes_is_waited_for_and_reported_once(tmp_path, monkeypatch):
    (case, _) = cases(small(MU))
    reported, waits = [], iter(range(2))
    with ExitStack() as held:
        held.enter_context(results_writer(tmp_path / f"{case.name}.h5"))
        monkeypatch.setattr(run, "sleep", lambda _: next(waits) == 1 and held.close())
        assert study(small(MU), tmp_path, workers=0, say=reported.append).complete
    assert reported == [f"waiting for {case}, which another process computes"]
    assert next(waits, None) is None


def test_worker_that_does_not_see_the_folder(tmp_path):
    (case, _) = cases(small(MU))
    outcome = worker.run_case(case.scene, str(tmp_path / "nowhere" / "a.h5"))
    assert outcome.status == "failed"
    assert "must be on a file system that all its machines share" in outcome.message


def test_folder_belongs_to_one_client(tmp_path):
    with (
        Folder(tmp_path).lock(small()),
        pytest.raises(ResultsError, match=re.escape(str(tmp_path))),
    ):
        study(small(), tmp_path, workers=0)


def test_folder_of_something_else(tmp_path):
    (tmp_path / "precious.txt").write_text("gold")
    with pytest.raises(ResultsError, match=re.escape(str(tmp_path))):
        study(small(), tmp_path, workers=0)
    with pytest.raises(ResultsError, match=r"precious\.txt"):
        study(small(), tmp_path / "precious.txt", workers=0)
    with pytest.raises(ResultsError, match=r"tractive-sam study STUDY.toml -o"):
        open_study(tmp_path)
    assert [one.name for one in tmp_path.iterdir()] == ["precious.txt"]


def test_folder_that_cannot_be_made(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    with pytest.raises(ResultsError, match="below"):
        study(small(), tmp_path / "file" / "below", workers=0)

    def refuse(path, **options):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(ResultsError, match=r"new.*Permission denied"):
        study(small(), tmp_path / "new", workers=0)


def test_what_goes_wrong_in_a_run_is_not_laid_to_the_folder(tmp_path):
    with pytest.raises(FileExistsError), Folder(tmp_path).lock(small()):
        raise FileExistsError


def test_without_dask_the_cure_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "find_spec", lambda name: None)
    with pytest.raises(ResultsError, match=r"pip install '\.\[study\]'.*--workers"):
        study(small(), tmp_path, scheduler="tcp://127.0.0.1:9")


def test_study_whose_file_was_spoilt(tmp_path):
    with Folder(tmp_path).lock(small()):
        (tmp_path / "study.toml").write_text("scene = 3")
    with pytest.raises(StudyError, match="scene: given 3"):
        open_study(tmp_path)


def test_nothing_is_run_where_a_scene_is_not_valid(tmp_path):
    with pytest.raises(StudyError, match=r"load\.normal"):
        study(small({"key": "load.normal", "values": [0.4, -1]}), tmp_path / "new", workers=0)
    assert not (tmp_path / "new").exists()


def test_more_processes_than_the_memory_holds_are_refused(tmp_path, monkeypatch):
    # As if; a process takes 250.
    monkeypatch.setattr(run.memory, "available_memory", lambda: 700 * 2**20)
    found = cases(small(MU, CREEPAGE))
    run.check_memory(found, 2)
    with pytest.raises(StudyError, match=r"workers.*2"):
        study(small(MU, CREEPAGE), tmp_path, workers=4)
    assert not list(tmp_path.glob("*.h5"))


def test_long_cases_first(tmp_path):
    revolutions = {"key": "wear.revolutions", "values": [1, 100, 10]}
    requested = Study(scene="twin-discs", set=["grid.elements=[15, 41]"], axis=[revolutions])
    tasks, done = run.remaining_tasks(Folder(tmp_path), cases(requested), requested)
    assert [task.case.changes["wear.revolutions"] for task in tasks] == [100, 10, 1]
    assert done == 0


def test_estimates_follow_the_mesh():
    meshes = {"key": "grid.elements", "values": [[41, 41], [81, 81], [161, 161]]}
    found = cases(small(meshes, set=["load.normal=0.4705"]))
    small_one, middle, large = np.array(estimate_times(case.scene for case in found))
    # Beyond what every file takes, time goes with n log n, n being four times as many.
    assert 4.0 < (large - middle) / (middle - small_one) < 6.0


def test_time_of_the_whole_study_is_shared_by_the_workers(monkeypatch):
    monkeypatch.setattr(run.explain, "seconds_per_application", lambda model: 1e-3)
    monkeypatch.setattr(run, "format_duration", str)
    angles = {"key": "friction.angle", "start": 0, "stop": 90, "number": 40}
    requested = Study(scene="twin-discs", axis=[angles])

    def seconds(workers):
        reported = dict(explain_study(requested, workers)[1].rows)[f"with {workers} workers"]
        return float(reported.removeprefix("about ").partition(";")[0])

    assert seconds(1) == pytest.approx(sum(estimate_times(c.scene for c in cases(requested))))
    assert seconds(4) == pytest.approx(seconds(1) / 4)
    assert seconds(1000) == pytest.approx(seconds(1) / 40)  # no faster than a case
