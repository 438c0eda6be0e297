import json
import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from tests.store.sample_records import SCENE, assert_described, make_record, mesh
from tractive_sam.results.column_table import STRESSES, columns
from tractive_sam.results.state import FIELDS
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError
from tractive_sam.store import HistoryWriter, ResultsError, open_history


def test_what_is_known_of_the_computation(finished):
    history = open_history(finished)
    assert history.scene == SCENE
    assert history.title == SCENE.title
    assert (history.status, history.message) == ("done", "every revolution")
    assert history.finished
    hertz = SCENE.hertz
    assert (history.a0, history.b0, history.p0) == (hertz.a, hertz.b, hertz.p0)
    assert history.versions["h5py"] == h5py.__version__
    assert history.totals == {"contact_solves": 14, "wall_seconds": 3.5}
    np.testing.assert_array_equal(history["p_max_at"][3], [0.1 * 3, -0.1 * 3])


def test_what_was_not_recorded_is_reported_with_what_was(finished):
    history = open_history(finished)
    with pytest.raises(KeyError, match=r"'wear_maximum'.*wear_max, "):
        history["wear_maximum"]
    with pytest.raises(KeyError, match=r"history\.field\('pressure'\)"):
        history["pressure"]


def test_totals_are_of_what_is_known(finished):
    with h5py.File(finished, "r+") as file:
        del file["history/solves"], file["history/seconds"]
    assert open_history(finished).totals == {"contact_solves": 0, "wall_seconds": 0.0}


def test_dictionary_is_json(finished):
    content = json.loads(json.dumps(open_history(finished).to_dict(), allow_nan=False))
    rows = {name for name, one in columns(SCENE).items() if "y" not in one.dims} | {*STRESSES}
    totals = {"contact_solves", "wall_seconds", "energy_balance", "wear_balance"}
    assert set(content) == {"status", "message", "a0", "b0", "p0"} | rows | totals
    assert content["revolution"] == [0, 10, 20, 30, 40, 50, 60]
    assert content["contact_solves"] == 14


def test_numbers_that_are_not_known_are_null(path):
    record = make_record(0)
    record.values["stick_fraction"] = np.nan
    with HistoryWriter(path, SCENE, mesh()) as writer:
        writer.append(record)
    content = open_history(path).to_dict()
    assert content["stick_fraction"] == [None]


def test_fields_that_were_not_kept(finished, path):
    history = open_history(finished)
    with pytest.raises(LookupError, match="0, 30, 60"):
        history.field("pressure", 10)
    with pytest.raises(LookupError, match="pressure, traction_x"):
        history.field("temperature")


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
class TestXarray:
    @pytest.fixture(autouse=True)
    def _has_engine(self, engine):
        pytest.importorskip({"netcdf4": "netCDF4"}.get(engine, engine))

    @pytest.mark.slow
    def test_history(self, finished, engine):
        with xr.open_dataset(finished, group="history", engine=engine) as data:
            assert data.Qx.dims == ("record",)
            assert data.wear_profile.dims == ("record", "y")
            assert data.p_max_at.dims == ("record", "axis")
            assert set(data.coords) == {"record", "revolution", "y", "axis", "body"}
            assert data.axis.values.tolist() == ["x", "y"]
            assert all({"units", "long_name"} <= set(v.attrs) for v in data.variables.values())
            assert data.Qx.swap_dims(record="revolution").sel(revolution=30) == data.Qx[3]

    def test_fields(self, finished, engine):
        with xr.open_dataset(finished, group="fields", engine=engine) as data:
            assert set(data.coords) == {"record", "revolution", "x", "y"}
            assert set(data) == set(FIELDS)
            assert all(field.dims == ("record", "x", "y") for field in data.values())
            np.testing.assert_array_equal(data.x, mesh().x)
            np.testing.assert_array_equal(data.record, [0, 3, 6])
            assert (data.pressure.sel(record=3) == 3.0).all()

    @pytest.mark.slow
    def test_tree(self, finished, engine):
        with xr.open_datatree(finished, engine=engine) as tree:
            assert {"grid", "history", "fields", "stress", "state"} == set(tree.children)
            scene = tree["scene"].item()
            assert (scene.decode() if isinstance(scene, bytes) else scene) == SCENE.to_toml()
            assert tree["fields/pressure"].attrs["units"] == "MPa"


def test_every_dataset_is_described(finished):
    assert_described(finished)
    with h5py.File(finished) as file:
        assert "grid/x" in file
        assert file["fields/x"] == file["grid/x"]


def test_a_zero_follows_every_text(finished):
    # Readers in C may seek it; without one they continue through what lies behind.
    texts = []

    def check(name, item):
        for attribute, value in item.attrs.items():
            if isinstance(value, bytes):
                assert item.attrs.get_id(attribute).dtype.itemsize > len(value), attribute
                texts.append(attribute)

    with h5py.File(finished) as file:
        check("/", file)
        file.visititems(check)
        assert file["scene"].dtype.itemsize > len(file["scene"][()])
    assert {"format", "versions", "status", "message", "digest"} <= set(texts)


class TestUnreadable:
    def test_missing(self, path):
        with pytest.raises(ResultsError, match=re.escape(str(path))):
            open_history(path)

    def test_folder(self, tmp_path):
        with pytest.raises(ResultsError, match=re.escape(str(tmp_path))):
            open_history(tmp_path)

    @pytest.mark.parametrize("content", [b"", b"title = 'spheres'\n"])
    def test_not_hdf5(self, path, content):
        path.write_bytes(content)
        with pytest.raises(ResultsError, match="HDF5"):
            open_history(path)

    def test_hdf5_of_something_else(self, path):
        with h5py.File(path, "w") as file:
            file["x"] = 1
        with pytest.raises(ResultsError, match=re.escape(str(path))):
            open_history(path)

    def test_of_the_future(self, finished):
        with h5py.File(finished, "r+") as file:
            file.attrs["format_version"] = 3
        with pytest.raises(ResultsError, match="3"):
            open_history(finished)

    def test_groups_missing(self, finished):
        with h5py.File(finished, "r+") as file:
            del file["fields"]
        with pytest.raises(ResultsError, match="/fields"):
            open_history(finished)

    @pytest.mark.parametrize("name", ["history/revolution", "grid/x"])
    def test_what_every_file_has_is_missing(self, finished, name):
        with h5py.File(finished, "r+") as file:
            del file[name]
        with pytest.raises(ResultsError, match=rf"damaged.*{name}"):
            open_history(finished)

    @pytest.mark.parametrize("share", [0.01, 0.3, 0.9, 0.999])
    def test_truncated(self, finished, share):
        content = finished.read_bytes()
        finished.write_bytes(content[: int(share * len(content))])
        with pytest.raises(ResultsError, match=re.escape(str(finished))):
            open_history(finished)

    @pytest.mark.slow
    def test_a_lost_page_is_reported_before_rolling_continues(self, tmp_path):
        # In a separate process, which HDF5 may abort while it walks a damaged file.
        found = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
        run = subprocess.run(
            [sys.executable, __file__, tmp_path], env=found, check=False, timeout=120
        )
        assert run.returncode == 0

    def test_field_lost_after_opening(self, finished):
        history = open_history(finished)
        finished.unlink()
        with pytest.raises(ResultsError, match=re.escape(str(finished))):
            history.field("pressure")


def test_results_outlive_the_file_of_their_gap(path, tmp_path):
    gap = tmp_path / "gap.csv"
    gap.write_text("x,y,separation\n-1,-1,0\n-1,1,0\n1,-1,0\n1,1,0\n")
    scene = Scene.builtin("spheres").replace(**{"gap": {"file": str(gap)}})
    with HistoryWriter(path, scene, mesh()) as writer:
        writer.append(make_record(0))
    gap.unlink()
    assert len(open_history(path)) == 1
    assert open_history(path).scene.gap.file == gap
    with pytest.raises(SceneError, match=r"gap\.file"):
        scene.with_current_files()  # to be computed again


def test_reading_does_not_change_the_file(finished):
    before = finished.read_bytes()
    open_history(finished).field("wear")
    assert finished.read_bytes() == before


def test_reference_is_kept_by_name(path):
    HistoryWriter(path, SCENE, mesh())
    assert open_history(path).p0 == SCENE.hertz.p0
    assert len(open_history(path)) == 0


@pytest.mark.parametrize("name", ["p_95", "p_max_at", "wear_profile_A"])
def test_a_earlier_file_lacks_what_was_added_since(path, name):
    with HistoryWriter(path, SCENE, mesh()) as writer:
        writer.append(make_record(0))
    with h5py.File(path, "a") as file:
        del file["history"][name]
    assert np.isnan(open_history(path)[name]).all()
    with HistoryWriter.reopen(path, SCENE) as writer:
        writer.append(make_record(1))
    first, last = open_history(path)[name]
    assert np.isnan(first).all()
    record = make_record(1)
    np.testing.assert_array_equal(last, record.values[name])


def every_page_of_lists_lost(folder):
    path = folder / "a.h5"
    with HistoryWriter(path, SCENE, mesh(31, 41)) as writer:
        for number in range(7):
            writer.append(make_record(number, with_fields=True, grid=mesh(31, 41)))
        writer.finish("done", "")
    whole, page = path.read_bytes(), 4096
    # Pages that hold heads of lists of what there is.
    heads = [at for at in range(0, len(whole), page) if b"BTHD" in whole[at : at + page]]
    assert heads
    for at in heads:
        path.write_bytes(whole[:at] + bytes(page) + whole[at + page :])
        with pytest.raises(ResultsError):
            HistoryWriter.reopen(path)


if __name__ == "__main__":
    every_page_of_lists_lost(Path(sys.argv[1]))
