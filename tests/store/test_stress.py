"""Stress in results files."""

import json

import numpy as np
import pytest
import xarray as xr

from tests.store.sample_records import (
    SCENE,
    STRESSED,
    assert_described,
    make_record,
    mesh,
    records,
    with_stress,
)
from tractive_sam.results.history import History
from tractive_sam.results.stress import STRESS
from tractive_sam.store import HistoryWriter, open_history


@pytest.fixture
def stressed(path):
    with HistoryWriter(path, STRESSED, mesh()) as writer:
        for record in records(5, every=2):
            writer.append(with_stress(record))
        writer.finish("done")
    return path


def test_file_and_memory_hold_the_same(stressed):
    stored = open_history(stressed)
    kept = History.of_records([with_stress(r) for r in records(5, every=2)], STRESSED, mesh())
    assert stored.to_dict() == kept.to_dict()
    assert stored.planes == kept.planes
    assert stored.bodies == ("A", "B")
    assert stored["von_mises_max_at"].shape == (5, 2, 3)
    for body, plane in stored.planes:
        for revolution in (0, 20, 40, None):
            here, there = (h.stress(body, plane, revolution) for h in (stored, kept))
            assert (here.body, here.plane, here.position) == (there.body, there.plane, 0.14)
            assert list(here.axes) == list(there.axes)
            for name, values in there.components.items():
                np.testing.assert_array_equal(here.components[name], values)
            np.testing.assert_allclose(here.von_mises, there.von_mises)


def test_json(stressed):
    content = json.loads(json.dumps(open_history(stressed).to_dict(), allow_nan=False))
    assert content["von_mises_max"] == {"A": [0, 1, 2, 3, 4], "B": [1, 2, 3, 4, 5]}
    assert content["von_mises_max_at"]["B"][2] == [2, 1, 0.1]


def test_what_was_not_kept(stressed):
    history = open_history(stressed)
    with pytest.raises(LookupError, match=r"y=0.*A.*z=0\.5a.*A.*y=0.*B"):
        history.stress("A", "x=0")
    with pytest.raises(LookupError, match="0, 20, 40"):
        history.stress("A", "y=0", 10)
    plain = History.of_records(records(2), SCENE, mesh())
    assert plain.to_dict()["von_mises_max"] == {}
    with pytest.raises(LookupError, match=r"\[subsurface\]"):
        plain.stress("A", "y=0")


def test_wider_mesh(path):
    """Stress beside the former mesh is not known, nor given."""
    wide = mesh(7, 13)
    with HistoryWriter(path, STRESSED, mesh()) as writer:
        writer.append(with_stress(make_record(1, with_fields=True)))
        writer.append(with_stress(make_record(2, with_fields=True, grid=wide), wide), wide)
        writer.finish("done")
    history = open_history(path)
    before, after = (history.stress("B", "z=0.5a", n) for n in (10, 20))
    np.testing.assert_array_equal(before.components["xx"], np.ones((5, 9)))
    np.testing.assert_array_equal(before.axes["y"], mesh().y)
    np.testing.assert_array_equal(after.components["xx"], np.full((7, 13), 2.0))
    assert np.isfinite(before.max_shear).all()
    assert history.stress("A", "y=0", 10).components["xx"].shape == (5, 3)


def test_a_table_is_a_dataset_of_xarray(stressed):
    kept = History.of_records([with_stress(r) for r in records(5, every=2)], STRESSED, mesh())
    for history in (open_history(stressed), kept):
        data = history.tables["stress/A/y=0"][1].to_xarray()
        assert set(data) == set(STRESS)
        assert data.von_mises.dims == ("x", "depth")
        assert data.von_mises.attrs["units"] == "MPa"
        np.testing.assert_array_equal(data.depth, [0.0, 0.1, 0.3])
        assert history.tables["fields"][0].to_xarray().pressure.dims == ("x", "y")


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray(stressed, engine):
    pytest.importorskip({"netcdf4": "netCDF4"}.get(engine, engine))
    with xr.open_dataset(stressed, group="stress/A/y=0", engine=engine) as data:
        assert set(data) == set(STRESS)
        assert data.von_mises.dims == ("record", "x", "depth")
        np.testing.assert_array_equal(data.x, mesh().x)
        np.testing.assert_array_equal(data.record, [0, 2, 4])
    with xr.open_dataset(stressed, group="stress/B/z=0.5a", engine=engine) as data:
        assert data.xz.dims == ("record", "x", "y")
    with xr.open_dataset(stressed, group="history", engine=engine) as data:
        assert data.von_mises_max.sel(body="B").dims == ("record",)
        assert data.von_mises_max_at.dims == ("record", "body", "position")


def test_every_dataset_is_described(stressed):
    assert_described(stressed)
