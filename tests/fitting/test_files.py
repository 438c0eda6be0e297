"""The file of a fit: resumed, shown, drawn, and refused if it belongs to another fit."""

import json
import re
import shutil

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.fitting.conftest import creep_data
from tractive_sam.cli import app
from tractive_sam.fitting.case import Evaluations, FitCase, InProcess, InWorkers, compute
from tractive_sam.fitting.fit_file import read_answers, write_fit
from tractive_sam.fitting.results import FitResult
from tractive_sam.fitting.run import _unfinished, read_design
from tractive_sam.scene import hash_files
from tractive_sam.schema import SceneWarning

FIT = """
[fit]
scene = "rig.toml"
free = ["friction.mu"]
curve = 0

[[fit.data]]
file = "creep.csv"
vary = "creepage.longitudinal"
observe = "Qx_over_P"
noise = { column = "sd" }

[[fit.test]]
vary = "creepage.longitudinal"
values = [-0.0005, -0.01]
observe = "Qx_over_P"
noise = 0.05
"""


@pytest.fixture(scope="module")
def rig(spheres, tmp_path_factory):
    """A folder with a fit file, its scene and its data."""
    folder = tmp_path_factory.mktemp("rig")
    (folder / "rig.toml").write_text(spheres.to_toml())
    (folder / "FIT.toml").write_text(FIT)
    data = creep_data(spheres, {"friction.mu": 0.35})["values"]
    rows = zip(data["creepage.longitudinal"], data["Qx_over_P"], strict=True)
    lines = [f"{xi},{ratio},{0.05 * ratio}" for xi, ratio in rows]
    header = "creepage.longitudinal,Qx_over_P,sd"
    (folder / "creep.csv").write_text("\n".join([header, *lines]))
    return folder


def run(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)))


@pytest.fixture(scope="module")
def fitted(rig):
    """The file of a fit, by the command."""
    scene = rig / "out.toml"
    found = run("fit", rig / "FIT.toml", "-o", rig / "FIT.nc", "--design", "--scene", scene)
    assert found.exit_code == 0, found.output
    assert "friction.mu" in found.output
    return rig / "FIT.nc"


@pytest.mark.slow
def test_show_prints_the_agreed_names(fitted):
    found = json.loads(run("show", fitted, "--json").stdout)
    assert set(found) >= {"parameters", "correlation", "undetermined", "chi2", "points", "solves"}
    mu = found["parameters"]["friction.mu"]
    assert set(mu) >= {"value", "low", "high", "sd"}
    assert mu["low"] < 0.35 < mu["high"]
    assert found["points"] == 4
    assert "friction.mu" in run("show", fitted).stdout


def test_fitted_scene_is_written(fitted):
    scene = ts.Scene.from_toml(fitted.with_name("out.toml"))
    assert scene.friction.mu[0] == pytest.approx(0.35, rel=1e-6)


@pytest.mark.slow
def test_figures_and_page_are_written(fitted, tmp_path):
    found = run("plot", fitted, "-o", tmp_path / "figures")
    assert found.exit_code == 0, found.output
    assert [one.name for one in (tmp_path / "figures").iterdir()] == ["data0-Qx_over_P.png"]
    assert run("report", fitted, "-o", tmp_path / "fit.html").exit_code == 0
    page = (tmp_path / "fit.html").read_text()
    assert "friction.mu" in page
    assert "Next test" in page
    assert page.count("<img") == 1


def fail(*_, **__):
    raise ValueError("no room for the labels")


@pytest.mark.parametrize("broken", ["fitting.figures.fitted_curve", "plot.Figure.savefig"])
def test_a_figure_that_fails_is_omitted(fitted, tmp_path, monkeypatch, broken):
    """The results do not depend on it: plot and report end well, and name what is missing."""
    monkeypatch.setattr(f"tractive_sam.{broken}", fail)
    name = "data0-Qx_over_P"
    with pytest.warns(UserWarning, match=f"{name} is omitted: no room"):
        assert ts.open_any(fitted).save_figures(tmp_path) == []
    found = run("plot", fitted, "-o", tmp_path / "figures")
    assert found.exit_code == 0, found.output
    assert f"{name} is omitted" in " ".join(found.stderr.split())
    found = run("report", fitted, "-o", tmp_path / "fit.html")
    assert found.exit_code == 0, found.output
    assert "<img" not in (tmp_path / "fit.html").read_text()


def test_a_data_file_that_changes_during_a_fit_is_named_by_the_next(rig, tmp_path, monkeypatch):
    """Files are hashed once, before they are read: a later hash would hide the change."""
    folder = shutil.copytree(rig, tmp_path / "rig", ignore=shutil.ignore_patterns("*.nc"))
    data, hashed = folder / "creep.csv", []

    def changing(case, start=None):
        data.write_text(text.replace("-0.004,", "-0.0041,"))
        return compute(case, start)

    def counted(path):
        hashed.append(path)
        return hash_files(path)

    text = data.read_text()
    monkeypatch.setattr("tractive_sam.fitting.case.compute", changing)
    monkeypatch.setattr("tractive_sam.fitting.run.hash_files", counted)
    ts.fit(folder / "FIT.toml", folder / "FIT.nc")
    assert hashed == [str(data)]
    with pytest.warns(SceneWarning, match="creep.csv has changed since the fit"):
        ts.fit(folder / "FIT.toml", folder / "FIT.nc")


def test_file_is_read_again(fitted):
    found = ts.open_fit(fitted)
    assert found.finished
    assert found.status == "done"
    assert "friction.mu" in repr(found)
    page = found._repr_html_()
    assert page.count("<table>") == 3  # estimates, next test, agreement
    assert page.count("<img") == 1
    assert "friction.mu" in page
    assert found.next_tests()[0]["gain"] > 0.0
    data = found.dataset
    assert data["model_error"].size == data["observed"].size == 4


@pytest.mark.slow
def test_a_second_fit_computes_nothing_again(fitted, rig, monkeypatch):
    monkeypatch.setattr("tractive_sam.fitting.case.compute", None)
    before = ts.open_fit(fitted)
    again = ts.fit(rig / "FIT.toml", fitted, next_test=True)
    assert again.values == before.values
    assert again.solves == before.solves


@pytest.mark.slow
def test_an_interrupted_fit_resumes(rig, tmp_path, monkeypatch):
    done = []

    def interrupted(case, start=None):
        if len(done) == 9:
            raise KeyboardInterrupt
        done.append(case)
        return compute(case, start)

    monkeypatch.setattr("tractive_sam.fitting.case.compute", interrupted)
    with pytest.raises(KeyboardInterrupt):
        ts.fit(rig / "FIT.toml", tmp_path / "part.nc")
    part = ts.open_fit(tmp_path / "part.nc")
    assert not part.finished
    assert part.status == "running"
    assert run("plot", tmp_path / "part.nc").exit_code == 2
    assert "running" in run("show", tmp_path / "part.nc").stdout
    assert "running" in part._repr_html_()

    before = len(done)

    def counted(case, start=None):
        done.append(case)
        return compute(case, start)

    monkeypatch.setattr("tractive_sam.fitting.case.compute", counted)
    found = ts.fit(rig / "FIT.toml", tmp_path / "part.nc")
    assert found.values["friction.mu"] == pytest.approx(0.35, rel=1e-6)
    assert len({one.digest for one in done}) == len(done), "computed twice"
    assert found.solves == len(done) > before


@pytest.mark.parametrize(("key", "value"), [("friction.mu", 0.5), ("solver.tolerance", 3e-7)])
def test_the_file_of_a_changed_scene_names_the_changed_key(spheres, tmp_path, key, value):
    path, data = tmp_path / "FIT.nc", creep_data(spheres, {"friction.mu": 0.35})
    design = {"scene": spheres, "free": ["friction.mu"], "data": [data], "mesh_check": False}
    ts.fit(design | {"curve": 0}, path)
    changed = {"curve": 0, "scene": spheres.replace(**{key: value})}
    with pytest.raises(ts.ResultsError, match=f"another scene .*{key}"):
        ts.fit(design | changed, path)


def test_a_changed_data_file_is_named(fitted, rig, tmp_path):
    """Its fit is replaced: the answers do not depend on the data."""
    path, data = tmp_path / "FIT.nc", str(rig / "creep.csv")
    path.write_bytes((rig / "FIT.nc").read_bytes())
    design = read_design(rig / "FIT.toml")
    stored = json.loads(ts.open_fit(path).dataset.attrs["files"])
    assert read_answers(design, path, False, stored)
    with pytest.warns(SceneWarning, match=re.escape(data)):
        assert read_answers(design, path, False, stored | {data: "of other data"})


def test_the_file_of_another_scene_is_refused(fitted, rig, tmp_path):
    other = tmp_path / "FIT.toml"
    text = FIT.replace('"creep.csv"', f'"{rig / "creep.csv"}"')
    other.write_text(text.replace('"rig.toml"', '"spheres"'))
    found = run("fit", other, "-o", fitted)
    assert found.exit_code == 2
    assert "another scene" in found.output


@pytest.mark.parametrize("content", [b"", b"\x89HDF\r\n\x1a\n" + bytes(100)])
def test_a_file_that_is_no_fit_is_refused(rig, tmp_path, content):
    path = tmp_path / "bad.nc"
    path.write_bytes(content)
    with pytest.raises(ts.ResultsError):
        ts.open_fit(path)
    assert run("fit", rig / "FIT.toml", "-o", path).exit_code == 2


def test_a_damaged_fit_is_refused(fitted, rig, tmp_path):
    found = ts.open_fit(fitted)
    path = tmp_path / "damaged.nc"
    write_fit(path, FitResult(found.dataset.drop_vars("answer_cost")))
    with pytest.raises(ts.ResultsError, match="damaged"):
        ts.fit(rig / "FIT.toml", path)


def test_faults_are_listed_by_the_command(rig, tmp_path):
    (tmp_path / "FIT.toml").write_text('[fit]\nscene = "spheres"\nfree = ["friction.mew"]\n')
    found = run("fit", tmp_path / "FIT.toml", "-o", tmp_path / "x.nc")
    assert found.exit_code == 2
    assert "fit.free" in found.output
    assert run("fit", rig / "FIT.toml", "-o", tmp_path / "x.h5").exit_code == 2
    assert run("fit", rig / "FIT.toml", "-o", tmp_path / "no" / "x.nc").exit_code == 2


@pytest.mark.parametrize("seconds", [0.01, 10.0])
def test_only_long_computations_are_distributed(seconds, monkeypatch, spheres):
    sent = []

    class Here:
        """Workers that are this process."""

        def run(self, calls):
            sent.extend(calls)
            yield from enumerate(call(*arguments) for call, *arguments in calls)

    cases = [FitCase(spheres, ("Qx",), seat=(0, k % 2)) for k in range(4)]
    monkeypatch.setattr(
        "tractive_sam.fitting.case.compute", lambda case, start=None: (case.seat, None)
    )
    workers = InWorkers(Here())
    assert dict(workers(cases)) == {k: (0, k % 2) for k in range(4)}
    assert not sent  # how long a case takes is not known yet
    workers.here.seconds[:] = [seconds]
    assert dict(workers(cases)) == {k: (0, k % 2) for k in range(4)}
    assert len(sent) == (2 if seconds > 1.0 else 0)  # a call for each seat


@pytest.mark.slow  # starts processes
def test_processes_find_the_same(rig, fitted, tmp_path, monkeypatch):
    monkeypatch.setattr(InWorkers, "worthwhile", 0.0)
    found = ts.fit(rig / "FIT.toml", tmp_path / "two.nc", workers=2)
    expected = ts.open_fit(fitted).values["friction.mu"]
    assert found.values["friction.mu"] == pytest.approx(expected, rel=1e-6)
    assert np.isfinite(found.dataset["predicted"]).all()


@pytest.mark.slow
def test_a_fit_that_was_killed_ends_bit_by_bit_as_another(tmp_path):
    """Finite differences see the initial guess of a contact: it must not depend on the past."""
    scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[11, 11]", "friction.layer=1e-5"])
    values = {"creepage.longitudinal": [-1e-3, -4e-3, -8e-3], "Qx_over_P": [0.16, 0.28, 0.3]}
    data = {"values": values, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    free, path = ["friction.mu", "friction.layer"], tmp_path / "fit.nc"
    data = [data | {"noise": 0.05}]
    tables = {"scene": scene, "free": free, "data": data, "mesh_check": False, "curve": 0}
    design = read_design(tables)
    whole = ts.fit(design, path).dataset
    answers = read_answers(design, path, overwrite=False, files={})
    for kept in (1, len(answers) // 2):
        done = Evaluations(InProcess(), dict([*answers.items()][:kept]))
        write_fit(path, _unfinished(design, done, {}))
        resumed = ts.fit(design, path).dataset
        for name in ("value", "low", "high", "sd", "predicted", "answer", "answer_numbers"):
            np.testing.assert_array_equal(resumed[name], whole[name])
