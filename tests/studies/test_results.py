"""The table of a study, its dataset, and its figures."""

import csv
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies.conftest import CREEPAGE, MU, small
from tractive_sam.cli import app
from tractive_sam.description import format_setting
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene
from tractive_sam.schema import PlausibilityWarning
from tractive_sam.store import ResultsError, results_writer
from tractive_sam.studies import Study, cases, figures, open_study, save_figures, study
from tractive_sam.studies.figures import axis_variable, distinct_texts, short_key
from tractive_sam.studies.results import Folder
from tractive_sam.studies.worker import CaseOutcome

xarray = pytest.importorskip("xarray", reason="xarray is of the extra study")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    return study(small(), tmp_path_factory.mktemp("done"), workers=0)


@pytest.mark.slow
def test_dataset_has_the_axes(done):
    data = done.dataset()
    assert data["Qx_over_P"].dims == ("creepage.longitudinal", "friction.mu")
    assert data["Qx_over_P"].shape == (3, 2)
    assert data["p_max"].attrs["units"] == "MPa"
    for row in done.rows:
        assert data["Qx"].sel(row.case.changes).item() == row.last["Qx"]
    # More friction and more creepage transmit more.
    assert (np.diff(data["Qx"].values, axis=0) > 0).all()
    assert (np.diff(data["Qx"].values, axis=1) > 0).all()


def test_dataset_is_written_and_read(done, tmp_path):
    data = done.dataset()
    data.to_netcdf(tmp_path / "study.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "study.nc", engine="h5netcdf") as again:
        xarray.testing.assert_equal(again.load(), data)


@pytest.mark.slow
def test_dataset_of_a_revolution(tmp_path, monkeypatch):
    requested = Study(
        scene="twin-discs",
        without=["subsurface"],
        set=["grid.elements=[15, 41]", "wear.save=[3]", "wear.revolutions=3"],
        axis=[{"key": "friction.angle", "values": [0, 90]}],
    )
    results = study(requested, tmp_path, workers=0)
    new = results.dataset(0)
    for number in range(2):
        history = results.history(number)
        assert new["Qx"][number] == history["Qx"][0]
        assert new["wear_max"][number] == 0.0
    # Each file is read once, for all revolutions and columns.
    monkeypatch.setattr("tractive_sam.studies.results.open_history", None)
    assert np.isnan(results.dataset(17)["Qx"]).all()
    np.testing.assert_array_equal(results.column("wear_max", 0), 0.0)


def test_stress_of_the_lower_body_only(tmp_path):
    requested = Study(
        scene="spheres",
        set=["grid.elements=[21, 21]", 'subsurface.bodies=["B"]'],
        axis=[{"key": "friction.mu", "values": [0.2, 0.4]}],
    )
    results = study(requested, tmp_path, workers=0)
    last = results.column("von_mises_max B")
    assert (last > 0.0).all()
    np.testing.assert_array_equal(results.column("von_mises_max B", revolution=0), last)
    assert np.isnan(results.column("von_mises_max A", revolution=0)).all()


def test_entries_that_vary_together(tmp_path):
    zipped = {"key": "creepage.lateral", "values": [1e-4, 3e-4]}
    results = study(small({**MU, "zip": [zipped]}), tmp_path, workers=0)
    data = results.dataset()
    assert data["Qy"].dims == ("friction.mu",)
    np.testing.assert_array_equal(data["creepage.lateral"], zipped["values"])
    assert data["creepage.lateral"].dims == ("friction.mu",)


def test_csv_has_every_case_and_quantity(done, tmp_path):
    done.save_csv(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6
    assert [float(row["Qx"]) for row in rows] == done.column("Qx").tolist()
    assert [float(row["friction.mu"]) for row in rows] == done.values("friction.mu").tolist()
    assert {row["status"] for row in rows} == {"complete"}


def test_csv_of_chosen_quantities_with_units(done, tmp_path):
    done.save_csv(tmp_path / "table.csv", quantities=("Qx", "Qx_over_P"), units=True)
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    keys = [key for one in done.study.dimensions for key in one.columns]
    assert list(rows[0]) == ["case", *keys, "Qx [N]", "Qx_over_P"]
    assert [float(row["Qx [N]"]) for row in rows] == done.column("Qx").tolist()
    with pytest.raises(ValueError, match="Qx_over_P"):
        done.save_csv(tmp_path / "table.csv", quantities=("Qx_over_p",))


def test_what_there_is_not_is_reported_with_what_there_is(done):
    with pytest.raises(KeyError, match=r"'Qx_over_p'.*Qx_over_P"):
        done.column("Qx_over_p")
    with pytest.raises(KeyError, match="'pressure'"):
        done.column("pressure", revolution=0)
    with pytest.raises(KeyError, match=r"load\.normal.*creepage"):
        done.values("load.normal")
    with pytest.raises(IndexError, match=r"6.*0.*5"):
        done.history(6)
    assert np.isnan(done.column("von_mises_max A")).all()  # known nowhere, yet a quantity


def test_every_status_is_reported(tmp_path):
    requested = small()
    found = cases(requested)
    files = [tmp_path / f"{case.name}.h5" for case in found]
    folder = Folder(tmp_path)

    class Killed(BaseException):
        pass

    def killed(record):
        raise Killed

    with folder.lock(requested):
        roll(found[0].scene, files[0])
        folder.log_failure(found[1], CaseOutcome("failed", "no space left"))
        with results_writer(files[2]):
            statuses = [row.status for row in open_study(tmp_path).rows]
        files[4].write_text("no HDF5")
    assert statuses == ["complete", "failed", "running", "waiting", "waiting", "waiting"]
    results = open_study(tmp_path)
    assert [row.status for row in results.rows[2:5]] == ["waiting", "waiting", "failed"]
    assert results.rows[1].message == "no space left"
    assert np.isnan(results.column("Qx")[1:]).all()
    data = results.dataset()
    assert data["status"].values[0].tolist() == ["complete", "failed"]
    assert data["message"].values[0, 1] == "no space left"
    with pytest.raises(ResultsError, match=r"case 1 .*failed"):
        results.history(1)


def names(paths):
    return sorted(path.name for path in paths)


@pytest.mark.slow
def test_figures_over_two_axes(done, tmp_path):
    paths = save_figures(done, tmp_path, quantities=("Qx_over_P", "p_max"))
    assert names(paths) == [
        "Qx_over_P-curves.png",
        "Qx_over_P-map.png",
        "p_max-curves.png",
        "p_max-map.png",
    ]
    assert all(path.stat().st_size > 5000 for path in paths)


@pytest.mark.usefixtures("empty_pictures")
def test_figures_by_default_are_of_what_varies(done, tmp_path):
    names = {path.name.partition("-")[0] for path in save_figures(done, tmp_path)}
    assert names == {"Qx_over_P", "stick_fraction"}  # the pressure is equal everywhere


@pytest.mark.usefixtures("empty_pictures")
def test_a_figure_that_fails_is_omitted(done, tmp_path, monkeypatch):
    def fail():
        raise ValueError("no room for the labels")

    def list_figures(results, name, *more):
        return ((kind, fail if name == "Qx" else f) for kind, f in original(results, name, *more))

    original = figures._figures
    monkeypatch.setattr(figures, "_figures", list_figures)
    with pytest.warns(UserWarning, match="Qx-(map|curves) is omitted: no room"):
        paths = save_figures(done, tmp_path, quantities=("Qx", "p_max"))
    assert names(paths) == ["p_max-curves.png", "p_max-map.png"]
    monkeypatch.setattr("tractive_sam.studies.open_study", lambda _: done)
    arguments = ["study-show", "done", "--figures", str(tmp_path), "--quantity", "Qx"]
    shown = CliRunner().invoke(app, arguments)
    assert shown.exit_code == 0, shown.output
    assert "Qx-map is omitted" in shown.stderr


def test_figures_over_one_axis(done, tmp_path):
    held = {"friction.mu": 0.2}
    paths = save_figures(done, tmp_path, quantities=("Qx",), at=held, format="pdf")
    assert names(paths) == ["Qx-curve-mu0.2.pdf"]


def test_axes_that_are_fixed_are_distinguished():
    bodies = ({"key": f"body.{body}.radius_x", "values": [300.0, 400.0]} for body in "AB")
    study = small(*bodies, MU)
    assert short_key("body.A.radius_x", study) != short_key("body.B.radius_x", study)
    assert short_key("friction.mu", study) == "mu"


@pytest.mark.usefixtures("empty_pictures")
def test_figures_of_samples(tmp_path):
    latin = {
        "number": 4,
        "variable": [
            {"key": "friction.mu", "start": 0.1, "stop": 0.5},
            {"key": "load.normal", "start": 0.2, "stop": 0.6},
        ],
    }
    results = study(small(axis=(), latin=latin), tmp_path / "a", workers=0)
    assert results.dataset()["Qx"].dims == ("sample",)
    assert names(save_figures(results, tmp_path, quantities=("Qx",))) == ["Qx-samples.png"]


def test_figures_while_nothing_is_known(tmp_path):
    with Folder(tmp_path).lock(small()):
        results = open_study(tmp_path)
    assert save_figures(results, tmp_path) == []
    assert results.quantities == {}


@pytest.mark.parametrize(
    ("scene", "mesh", "force"),
    [("spheres", ["grid.elements=[21, 21]"], "N"), ("cylinders", [], "N/mm")],
)
def test_figures_have_the_units_of_the_contact(scene, mesh, force, tmp_path, monkeypatch):
    variables = []

    def keep(x, y, **_):
        variables.extend((x, y))
        return SimpleNamespace(savefig=lambda path, **look: None)

    monkeypatch.setattr(figures, "study_curves", keep)
    loads = {"key": "load.normal", "values": [0.3, 0.4]}
    requested = Study(scene=scene, without=["subsurface"], set=mesh, axis=[loads])
    results = study(requested, tmp_path / "study", workers=0)
    save_figures(results, tmp_path, quantities=("Qx",))
    assert [variable.label for variable in variables] == [f"$P$ ({force})", f"$Q_x$ ({force})"]


@pytest.mark.parametrize(
    ("options", "reported"),
    [
        ({"quantities": ("Qz",)}, "Qz.*Qx"),
        ({"at": {"friction.angle": 0}}, "friction.angle.*creepage"),
        ({"at": {"friction.mu": 0.3}}, "friction.mu.*0.3.*0.2, 0.4"),
        (
            {"at": {"friction.mu": 0.2, "creepage.longitudinal": -1e-3}},
            "axes|axis",
        ),
    ],
)
def test_bad_figures(done, tmp_path, options, reported):
    with pytest.raises(ValueError, match=reported):
        save_figures(done, tmp_path, **options)


def test_three_axes_are_too_many_for_a_figure(tmp_path):
    loads = {"key": "load.normal", "values": [0.3, 0.4]}
    with Folder(tmp_path).lock(small(CREEPAGE, MU, loads)):
        results = open_study(tmp_path)
    with pytest.raises(ValueError, match=r"3 axes.*--at"):
        save_figures(results, tmp_path)


def test_axes_of_courses_and_blocks_are_named_in_a_line():
    rolled, shifted = map(Scene.builtin, ("traction-control", "fretting"))
    courses = {"transient.creepage.longitudinal": ((0.0, 1e-3), (0.0, 2e-3))}
    assert "shift" not in axis_variable(courses, rolled).label
    assert axis_variable(courses, shifted).label.endswith("mm")
    assert axis_variable({"duty[0].load.normal": (1.0, 2.0)}, rolled).label == "$P$ of duty[0] (N)"


def test_blocks_of_a_duty_cycle_as_values_of_an_axis_are_reported_by_name_and_revolutions():
    duty = [{"name": "curve", "revolutions": 7, "creepage.spin": 1e-4}, {"revolutions": 3}]
    assert format_setting(tuple(duty)) == "(curve 7, duty[1] 3)"
    assert format_setting(1.0 / 3.0) == "0.333333"
    assert len(format_setting(tuple(range(100)))) <= 50
    assert distinct_texts(((1, 2), (3, 4))) == ["(1, 2)", "(3, 4)"]
    many = [(*range(100), end) for end in (1, 2)]  # cut short, they differ by their places
    assert len(set(distinct_texts(many))) == 2


def test_warnings_of_scenes_are_not_reported_again_where_results_are_opened(tmp_path):
    much = {"key": "friction.mu", "values": [7.0, 8.0]}  # as in per cent
    with pytest.warns(PlausibilityWarning):
        study(small(much, keep="scalars"), tmp_path / "much", workers=0)
    assert len(open_study(tmp_path / "much")) == 2  # here a warning is an error
