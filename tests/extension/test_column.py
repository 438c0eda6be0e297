"""A user-defined column: in memory, in a file, read back, shown, drawn, and when it is resumed."""

import io
import json

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app


def centre(contact):
    pressure = contact.pressure / contact.pressure.sum()
    return pressure.sum(1) @ contact.grid.x, pressure.sum(0) @ contact.grid.y


MEAN = ts.Quantity(
    "p_mean",
    "MPa",
    "mean contact pressure",
    lambda contact: contact.pressure[contact.touching].mean(),
    symbol=r"\bar{p}",
)
PER_LENGTH = ts.Quantity("load", "N", "load once more", lambda c: c.P, per_length=True)
ROWS = ts.Quantity("p_rows", "MPa", "peak of each row", lambda c: c.pressure.max(0), ("y",))
CENTRE = ts.Quantity("centre", "mm", "centre of pressure", centre, ("axis",))
COLUMNS = (MEAN, PER_LENGTH, ROWS, CENTRE)

DISCS = ts.Scene.builtin("twin-discs").with_set(
    ["grid.elements=[15, 31]", "wear.revolutions=4", "wear.save=[0, 4]"]
)
DISCS = DISCS.replace(subsurface=None)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return tmp_path_factory.mktemp("column") / "a.h5"


@pytest.fixture(scope="module")
def written(path):
    return ts.roll(DISCS, path, columns=COLUMNS)


def test_it_is_that_of_the_contact(written):
    for at in written.saved:
        state, row = written.state(at), written["revolution"] == at
        assert written["p_mean"][row] == MEAN.of(state)
        np.testing.assert_array_equal(written["p_rows"][row][0], ROWS.of(state))
        np.testing.assert_array_equal(written["centre"][row][0], centre(state))
    np.testing.assert_array_equal(written["load"], written["P"])


def test_it_is_the_same_in_memory_and_in_a_file(written, path):
    kept, read = ts.roll(DISCS, columns=COLUMNS), ts.open_history(path)
    for one in COLUMNS:
        # Plans of transforms may differ, and with them the last digits.
        np.testing.assert_allclose(kept[one.name], read[one.name], rtol=1e-9, atol=1e-12)
        assert kept.columns[one.name] == read.columns[one.name] == one


def test_it_is_per_length_in_a_line_contact(tmp_path):
    history = ts.roll(ts.Scene.builtin("cylinders"), tmp_path / "a.h5", columns=[PER_LENGTH])
    assert history.columns["load"].unit == "N/mm"
    assert ts.open_history(tmp_path / "a.h5").columns["load"].unit == "N/mm"


def test_it_is_shown(written, path):
    def reported(*options):
        return CliRunner().invoke(app, ["show", str(path), *options]).stdout

    assert json.loads(reported("--json"))["p_mean"] == written["p_mean"].tolist()
    (line,) = [line for line in reported().splitlines() if "p_mean" in line]
    assert "MPa" in line
    assert "mean contact pressure" in line


def test_it_is_plotted(written):
    kept = ts.roll(DISCS, columns=[MEAN])
    figure = ts.plot.compare({"file": written, "memory": kept}, "p_mean")
    figure.savefig(io.BytesIO(), dpi=40)
    (axes,) = figure.axes
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), written["p_mean"])
    assert axes.get_ylabel() == "mean contact pressure (MPa)"


def test_it_is_kept_when_it_is_rolled_on(written, path, tmp_path):
    longer = DISCS.with_set(["wear.revolutions=6", "wear.save=[0, 4, 6]"])
    for name, columns in (("with", COLUMNS), ("without", ()), ("new", (*COLUMNS, new("other")))):
        again = tmp_path / f"{name}.h5"
        again.write_bytes(path.read_bytes())
        history = ts.roll(longer, again, resume=True, columns=columns)
        np.testing.assert_array_equal(history["p_mean"][: len(written)], written["p_mean"])
        assert np.isfinite(history["p_mean"][-1]) == (name != "without")
        assert history["revolution"][-1] == 6
        if name == "new":
            assert np.isnan(history["other"][: len(written)]).all()
            assert history["other"][-1] == 1.0


def new(name, unit="1", of=lambda contact: 1.0, **about):
    return ts.Quantity(name, unit, "something else", of, **about)


def test_another_quantity_of_its_name_is_refused(written, path):
    with pytest.raises(ts.ResultsError, match="p_mean"):
        ts.roll(DISCS, path, resume=True, columns=[new("p_mean", "GPa")])


@pytest.mark.parametrize(
    "columns",
    [
        [new(name)]
        for name in ("P", "pressure", "record", "y", "status", "a0", "a/b", "", "energy_balance")
    ]
    + [[new("a", of=None)], [new("a", dims=("x", "y"))], [new("a", role="coordinate")]]
    + [[new("a"), new("a")]],
)
def test_what_cannot_be_a_column_is_refused(columns):
    with pytest.raises(ValueError, match="columns"):
        ts.roll(DISCS, columns=columns)


def test_a_column_of_the_criterion_is_not_replaced():
    class Longitudinal(ts.StressCriterion):
        name, symbol, long_name = "along", r"\sigma_x", "longitudinal stress"

        def __call__(self, stress):
            return stress[0]

    laws = ts.Laws.of(DISCS).replace(criterion=Longitudinal())
    with pytest.raises(ValueError, match="along_max"):
        ts.roll(DISCS, laws=laws, columns=[new("along_max")])


def test_what_is_no_quantity_is_refused():
    with pytest.raises(TypeError, match="columns"):
        ts.roll(DISCS, columns=["p_mean"])


def test_a_value_of_another_shape_is_reported():
    with pytest.raises(ValueError, match="rows"):
        ts.roll(DISCS, columns=[new("rows", of=lambda contact: contact.pressure)])


BLOCKS = (
    {"revolutions": 1, "load": {"normal": 100.0}},
    {"revolutions": 3, "load": {"normal": 200.0}},
)
PEAK = ts.Quantity("peak", "MPa", "peak", lambda c: c.p_max, over_blocks="largest")
PEAK_AT = ts.Quantity(
    "peak_at", "mm", "place", lambda c: c.p_max_at, ("axis",), over_blocks="mean", place_of="peak"
)
OVER_BLOCKS = (
    *(PEAK, PEAK_AT),
    ts.Quantity("least", "MPa", "least peak", lambda c: c.p_max, over_blocks="smallest"),
    ts.Quantity("sum", "MPa", "sum of peaks", lambda c: c.p_max, over_blocks="sum"),
    ts.Quantity("mean", "MPa", "mean peak", lambda c: c.p_max),
)


def test_it_states_how_a_duty_cycle_combines_its_blocks(tmp_path):
    scene = DISCS.replace(duty=BLOCKS, **{"wear.revolutions": 4})
    history = ts.roll(scene, tmp_path / "duty.h5", columns=OVER_BLOCKS)
    of_blocks = history["block_peak"][0]
    assert of_blocks.max() > 1.1 * of_blocks.min()
    assert history["peak"][0] == of_blocks.max()
    assert history["least"][0] == of_blocks.min()
    assert history["sum"][0] == pytest.approx(of_blocks.sum(), rel=1e-12)
    assert history["mean"][0] == pytest.approx(of_blocks @ [0.25, 0.75], rel=1e-12)
    np.testing.assert_array_equal(history["peak_at"][0], history["block_peak_at"][0][1])
    assert ts.open_history(tmp_path / "duty.h5").columns["peak_at"].place_of == "peak"


def test_an_unknown_combination_is_refused():
    with pytest.raises(ValueError, match="over_blocks"):
        ts.Quantity("peak", "MPa", "peak", over_blocks="median")
