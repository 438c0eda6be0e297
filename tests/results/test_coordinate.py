"""A history along another coordinate than revolutions: stored, written, read, shown, drawn."""

import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.store.sample_records import STRESSED, make_record, mesh, with_stress
from tractive_sam import plot
from tractive_sam.cli.program import app
from tractive_sam.results.column_table import columns
from tractive_sam.results.quantity import COORDINATE
from tractive_sam.store.writer import HistoryWriter

DISTANCE = ts.Quantity(
    "distance", "mm", "distance rolled", symbol="s", label="distance", role=COORDINATE
)
STEP = 0.1
SAVED = (1, 3)


def record_at(number):
    record = with_stress(make_record(number, number in SAVED))
    values = dict(record.values) | {"distance": STEP * number, "p_max": 100.0 + number}
    del values["revolution"]
    return replace(record, values=values, columns=columns(STRESSED, [DISTANCE]))


RECORDS = [record_at(number) for number in range(4)]


def in_memory():
    return ts.History.of_records(RECORDS, STRESSED, mesh())


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("distance") / "a.h5"
    with HistoryWriter(path, STRESSED, mesh(), coordinate=DISTANCE) as writer:
        for record in RECORDS:
            writer.append(record)
        writer.finish("done")
    return path


@pytest.fixture(params=["memory", "file"])
def history(request, path):
    return in_memory() if request.param == "memory" else ts.open_history(path)


def test_it_has_a_coordinate_and_no_revolutions(history):
    assert history.coordinate == DISTANCE
    assert "revolution" not in history.columns
    np.testing.assert_array_equal(history["distance"], STEP * np.arange(4))
    assert history["distance"].dtype == float
    np.testing.assert_array_equal(history.saved, [STEP, STEP * 3])
    assert len(history) == 4


def test_fields_are_found_by_its_value(history):
    for at in (STEP * 3, 0.3, None):  # 0.1 * 3 is not 0.3
        assert (history.field("pressure", at) == 3.0).all()
        assert (history.field("pressure", distance=at) == 3.0).all()
        assert history.stress("A", "y=0", at).components["xx"].max() == 3.0
        assert history.state(at).pressure.max() == 3.0
    assert (history.field("pressure", STEP) == 1.0).all()
    with pytest.raises(LookupError, match="distance"):
        history.field("pressure", 0.25)


@pytest.mark.parametrize("named", [{"revolution": 3}, {"distance": 0.3, "revolution": 3}])
def test_another_coordinate_is_refused(history, named):
    with pytest.raises(TypeError, match="distance"):
        history.field("pressure", **named)
    with pytest.raises(TypeError, match="distance"):
        history.state(0.3, distance=0.3)


def test_an_unfinished_file_without_records_opens(tmp_path):
    HistoryWriter(tmp_path / "a.h5", STRESSED, mesh(), coordinate=DISTANCE)
    history = ts.open_history(tmp_path / "a.h5")
    assert (len(history), history.coordinate, history.saved.size) == (0, DISTANCE, 0)


def test_a_written_history_is_rolled_on(path):
    again = path.with_name("b.h5")
    again.write_bytes(path.read_bytes())
    with HistoryWriter.reopen(again) as writer:
        writer.append(record_at(4))
        writer.finish("done")
    assert ts.open_history(again)["distance"].tolist() == [STEP * k for k in range(5)]


def test_it_is_shown(path):
    def reported(*options):
        result = CliRunner().invoke(app, ["show", str(path), *options])
        assert result.exit_code == 0, result.output
        return result.stdout

    assert json.loads(reported("--json"))["distance"] == (STEP * np.arange(4)).tolist()
    first = [line.split()[0] for line in reported().splitlines() if line.strip()]
    assert first[first.index("s") + 1] == "mm"


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_it_is_plotted(history, tmp_path):
    (axes,) = plot.compare({"one": history}, "p_max").axes
    np.testing.assert_array_equal(axes.lines[0].get_xdata(), history["distance"])
    assert axes.get_xlabel() == "distance $s$ (mm)"
    assert plot.ContactView.from_source(history, 0.3).caption.endswith("s\u00a0=\u00a00.3\u00a0mm")
    assert plot.pressure(history, distance=0.3).axes
    (legend,) = plot.wear_depth_profiles(history).legends
    assert [text.get_text() for text in legend.get_texts()] == ["0.1", "0.3"]
    figures = {path.name.removesuffix(".png") for path in plot.save_all(history, tmp_path)}
    assert {"pressure-0.1", "pressure-0.3", "forces", "wear-depth", "wear-profiles"} <= figures


def test_histories_along_several_coordinates_are_not_compared(history):
    revolving = ts.History.of_records([with_stress(make_record(1, True))], STRESSED, mesh())
    with pytest.raises(ValueError, match=r"distance.*revolution"):
        plot.compare({"one": history, "two": revolving}, "p_max")


def test_it_is_an_xarray_along_it(history):
    pytest.importorskip("xarray", reason="of the extra study")
    data = history.to_xarray()
    assert data["p_max"].dims == ("distance",)
    assert data["distance"].attrs["units"] == "mm"
