"""Studies that keep the last numbers of each case alone: one file, neighbours in turn."""

import os
import signal
import socket
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from tests.studies.conftest import CREEPAGE, MU, small
from tractive_sam.run.pipeline import roll
from tractive_sam.store import ResultsError
from tractive_sam.studies import (
    Study,
    StudyError,
    cases,
    estimate_times,
    explain_study,
    open_study,
    run,
    study,
)
from tractive_sam.studies.worker import Task, make_chains, neighbour_order, run_chain, summary

NUMBERS = ("P", "Qx", "Qy", "Mz", "approach", "xi_x", "p_max", "worn_area")


def scalars(*axes, **given):
    return small(*axes, keep="scalars", **given)


def agree(last, wanted):
    for name in NUMBERS:
        # What the tolerance of the scenes, 1e-8, leaves of a solution.
        assert last[name] == pytest.approx(wanted[name], rel=1e-6, abs=1e-7), name


@pytest.fixture
def computed(monkeypatch):
    """The scenes that are computed."""
    scenes, before = [], run.run_neighbour

    def spy(scene, neighbours):
        scenes.append(scene)
        return before(scene, neighbours)

    monkeypatch.setattr(run, "run_neighbour", spy)
    return scenes


def test_numbers_are_those_of_each_scene_only(tmp_path):
    results = study(scalars(), tmp_path)
    assert results.complete
    for row in results.rows:
        wanted = summary(roll(row.case.scene, progress=False))
        assert row.last.keys() == wanted.keys()
        agree(row.last, wanted)


@pytest.mark.slow
def test_scenes_of_any_process_may_keep_scalars(tmp_path):
    """Wheel and rail: a contact of several patches, which no neighbour starts."""
    axis = {"key": "wheelset.y", "values": [0.5, 1.0]}
    small = {"set": ["grid.elements=[11, 11]"], "axis": [axis], "keep": "scalars"}
    for row in study(Study(scene="wheel-rail", **small), tmp_path, workers=0).rows:
        agree(row.last, summary(roll(row.case.scene, progress=False)))


def test_all_is_in_one_file(tmp_path):
    study(scalars(), tmp_path)
    assert {file.name for file in tmp_path.glob("[!.]*")} == {"study.toml", "complete.jsonl"}


def test_what_is_kept_is_shown_as_any_other(tmp_path):
    results = study(scalars(), tmp_path / "scalars")
    assert results.dataset()["Qx"].shape == (3, 2)
    assert np.isfinite(results.column("Qx", revolution=0)).all()
    assert np.isnan(results.column("Qx", revolution=1)).all()
    results.save_csv(tmp_path / "table.csv")
    assert len((tmp_path / "table.csv").read_text().splitlines()) == 7
    with pytest.raises(ResultsError, match="keep"):
        results.history(0)


@pytest.mark.parametrize(
    "given",
    [
        {"set": ["grid.elements=[15, 15]", "load.force_x=0.05"]},
        {"without": ["subsurface", "grid"], "set": ["solver.tolerance=1e-8"]},  # a chosen mesh
        {"without": [], "set": ["grid.elements=[15, 15]", "subsurface.elements=4"]},
    ],
)
def test_neighbours_of_any_kind(given):
    loads = {"key": "load.normal", "values": [0.4, 0.4705]}
    requested = scalars(loads, CREEPAGE if "load.force_x=0.05" not in given["set"] else MU, **given)
    scenes = [case.scene for case in cases(requested)]
    for scene, outcome in zip(scenes, run_chain(scenes), strict=True):
        assert outcome.status == "complete"
        wanted = summary(roll(scene, progress=False))
        assert outcome.row.keys() == wanted.keys()
        agree(outcome.row, wanted)


def test_rolled_scenes_keep_their_last_record(tmp_path):
    revolutions = {"key": "wear.revolutions", "values": [2, 4]}
    given = {"scene": "twin-discs", "set": ["grid.elements=[15, 41]", "wear.save=[2]"]}
    results = study(scalars(revolutions, **given), tmp_path)
    assert results.column("revolution").tolist() == [2, 4]
    agree(results.rows[1].last, summary(roll(results.rows[1].case.scene, progress=False)))


@pytest.mark.slow  # processes that start
def test_numbers_do_not_hang_on_the_workers(tmp_path):
    one = study(scalars(), tmp_path / "one", workers=0)
    states = []
    # In chains, each from its own first case.
    two = study(scalars(), tmp_path / "two", workers=2, progress=states.append)
    assert two.complete
    here = f"{socket.gethostname()}:{os.getpid()}"
    assert here not in {state.outcome.worker for state in states[1:]}
    for here, there in zip(one.rows, two.rows, strict=True):
        agree(there.last, here.last)


def test_complete_cases_are_not_computed_again(tmp_path, computed):
    study(scalars(MU), tmp_path)
    assert len(computed) == 2
    assert study(scalars(MU), tmp_path).complete
    assert len(computed) == 2
    finer = {"key": "friction.mu", "values": [0.2, 0.3, 0.4]}
    assert study(scalars(finer), tmp_path).complete
    assert len(computed) == 3


@pytest.mark.slow
def test_what_was_reported_done_outlives_the_process(tmp_path, computed):
    """A client that is killed between two cases, by SIGKILL; half of a line is what it left."""
    (tmp_path / "study.toml").write_text(scalars().to_toml())
    program = (
        "import os, signal, tractive_sam as ts\n"
        "def stop(now):\n"
        "    if now.ended == 3: os.kill(os.getpid(), signal.SIGKILL)\n"
        "ts.study('study.toml', 'results', workers=0, progress=stop)\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=False)
    assert ended.returncode == -signal.SIGKILL
    folder = tmp_path / "results"
    assert open_study(folder).counts["complete"] == 3
    with (folder / "complete.jsonl").open("a") as file:
        file.write('\n{"digest": "')
    assert study(scalars(), folder).complete
    assert len(computed) == 3


def test_scalars_and_results_files_in_one_folder(tmp_path, computed):
    study(scalars(MU), tmp_path)
    assert open_study(tmp_path).complete
    whole = study(small(MU), tmp_path, workers=0)
    assert whole.complete
    assert all(row.file is not None for row in whole.rows)
    assert study(scalars(MU), tmp_path).complete  # what files hold is known
    assert len(computed) == 2


def test_failed_case_is_reported_and_stops_no_other(tmp_path):
    forces = {"key": "load.force_x", "values": [0.05, 0.4]}  # more than friction carries
    requested = scalars(forces, set=["grid.elements=[15, 15]", "load.approach=0.036"])
    results = study(requested, tmp_path, workers=0)
    assert [row.status for row in results.rows] == ["complete", "failed"]
    assert results.rows[1].message


def test_neighbours_are_adjacent():
    requested = scalars()
    order = np.argsort(neighbour_order(requested.shape))
    found = cases(requested)
    for one, two in pairwise(order):
        before, after = found[one].changes, found[two].changes
        assert sum(before[key] != after[key] for key in before) == 1


def test_chains_are_short_and_whole():
    tasks = [Task(case, None, 2.0 / 4.5) for case in cases(scalars())]
    assert [len(one) for one in make_chains(tasks)] == [4, 2]
    single = {tasks[1].case.digest}
    assert [len(one) for one in make_chains(tasks, single)] == [1, 1, 4]
    assert [task for one in make_chains(tasks, single) for task in one] == tasks


def test_work_is_that_of_no_files(tmp_path):
    scenes = [case.scene for case in cases(scalars())]
    assert sum(estimate_times(scenes, with_files=False)) < sum(estimate_times(scenes))
    assert "one file" in dict(explain_study(scalars(), 2)[1].rows)["results"]


def test_what_is_no_format_of_storage():
    with pytest.raises(StudyError, match="keep"):
        small(MU, keep="forces")
