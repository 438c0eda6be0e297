"""Every kind of file behind one interface, in Python and for the commands that read files."""

import json

import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app
from tractive_sam.documents import (
    FitDocument,
    FitRequest,
    ResultsDocument,
    SceneRequest,
    StudyDocument,
    StudyRequest,
    TableDocument,
    TableRequest,
)

COARSE = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"]).replace(subsurface=None)
CREEP = {"creepage.longitudinal": [-1e-3, -4e-3], "Qx_over_P": [0.1, 0.27]}
DATA = {
    "values": CREEP,
    "vary": "creepage.longitudinal",
    "observe": "Qx_over_P",
    "noise": 0.05,
}
AXIS = [{"key": "friction.mu", "values": [0.2, 0.4]}]

FILES = {
    "run.h5": ResultsDocument,
    "fit.nc": FitDocument,
    "steel": TableDocument,
    "study": StudyDocument,
    "scene.toml": SceneRequest,
    "study.toml": StudyRequest,
    "fit.toml": FitRequest,
    "table.toml": TableRequest,
}
"""A file of each kind, in `folder`."""

WITH_RESULTS = ["run.h5", "fit.nc", "steel", "study"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a file of each kind."""
    folder = tmp_path_factory.mktemp("documents")
    ts.roll(COARSE, folder / "run.h5")
    design = {"scene": COARSE, "free": ["friction.mu"], "data": [DATA], "mesh_check": False}
    ts.fit(design, folder / "fit.nc")
    study = ts.Study(scene=COARSE, axis=AXIS)
    ts.study(study, folder / "study", workers=0)
    (folder / "scene.toml").write_text(COARSE.to_toml())
    (folder / "study.toml").write_text(study.to_toml())
    (folder / "fit.toml").write_text(ts.open_fit(folder / "fit.nc").design.to_toml())
    design = ts.TableDesign(ellipticity=[0.5, 1.0], tolerance=0.05)
    (folder / "table.toml").write_text(design.to_toml())
    return folder


@pytest.fixture
def call(folder, monkeypatch, tmp_path):
    """Run the program in the folder of the files; nothing but an exit may leave it."""
    monkeypatch.chdir(folder)

    def call(*arguments):
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        assert result.exception is None or isinstance(result.exception, SystemExit)
        return result

    return call


@pytest.fixture(params=FILES)
def file(request):
    return request.param


def test_a_file_is_recognised_by_its_content(file, folder, monkeypatch):
    monkeypatch.chdir(folder)
    document = ts.open_any(file)
    assert type(document) is FILES[file]
    assert document.noun in repr(document)
    assert document.is_complete


@pytest.mark.parametrize("file", [name for name in FILES if name != "table.toml"])
def test_every_file_is_explained(file, call):
    explained = call("explain", file)
    assert explained.exit_code == 0, explained.stderr
    assert explained.stdout.count("\n") > 3


@pytest.mark.parametrize("file", WITH_RESULTS)
def test_every_result_is_shown_plotted_and_reported(file, call, tmp_path):
    shown = call("show", file)
    assert shown.exit_code == 0, shown.stderr
    assert json.loads(call("show", file, "--json").stdout)
    plotted = call("plot", file, "-o", tmp_path / "figures", "--width", "84mm")
    assert plotted.exit_code == 0, plotted.stderr
    names = {path.name for path in (tmp_path / "figures").glob("*.png")}
    assert names
    assert {line.rpartition("/")[2] for line in plotted.stdout.split()} == names
    reported = call("report", file, "-o", tmp_path / "page.html")
    assert reported.exit_code == 0, reported.stderr
    page = (tmp_path / "page.html").read_text("utf-8")
    assert "</main>" in page


@pytest.mark.parametrize("file", sorted(FILES.keys() - WITH_RESULTS))
@pytest.mark.parametrize("command", ["show", "plot", "report"])
def test_a_file_without_results_names_the_command_that_computes_them(command, file, call):
    refused = call(command, file)
    assert refused.exit_code == 2
    assert f"tractive-sam {FILES[file].command.split()[1]} {file}" in refused.stderr


@pytest.mark.parametrize("file", ["fit.nc", "steel", "study"])
@pytest.mark.parametrize(
    ("option", "name"),
    [
        (["--units", "si-mm"], "units"),
        (["--block", "0"], "blocks"),
        (["--animate"], "animate"),
    ],
)
def test_options_of_results_files_are_refused_for_others(file, option, name, call):
    refused = call("plot", file, *option)
    assert refused.exit_code == 2
    assert name in refused.stderr


def test_figures_of_a_fit_have_no_titles_on_request(tmp_path, call):
    sizes = set()
    for option in ("--title", "--no-title"):
        assert call("plot", "fit.nc", option, "--format", "pdf", "-o", str(tmp_path)).exit_code == 0
        sizes.add(sum(path.stat().st_size for path in tmp_path.glob("*.pdf")))
    assert len(sizes) == 2


def test_rows_of_a_study_are_printed_as_csv(call):
    lines = call("show", "study", "--csv").stdout.splitlines()
    assert len(lines) == 3
    assert lines[0].startswith("case,friction.mu,status,")
    for name in ("fit.nc", "steel"):
        assert call("show", name, "--csv").exit_code == 2


def test_settings_are_refused_unless_the_file_is_a_scene(file, call):
    if file != "table.toml":
        explained = call("explain", file, "--set", "creepage.lateral=1e-3")
        assert (explained.exit_code == 0) == (file == "scene.toml")
