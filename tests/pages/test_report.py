"""The page of a history: what is on it, that nothing breaks it, and that it needs nothing else."""

import base64
import json
import re
import sys

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.description import format_unit, html_symbol
from tractive_sam.pages import data
from tractive_sam.results import Grid

DISCS = ("grid.half_length=[0.35, 0.7]", "grid.elements=[21, 31]", "wear.revolutions=20")
NARROW = Grid((0.35, 0.54), (15, 15))
SMALL = (*DISCS, "wear.save=[0, 5, 20]", "subsurface.elements=12")


@pytest.fixture(scope="module")
def history():
    own = ts.Quantity("share", "1", "share of the <load>", lambda c: c.Qx / c.P + c.wear.max())
    return ts.roll(ts.Scene.builtin("twin-discs").with_set(SMALL), columns=[own])


def unpacked(packed):
    return np.frombuffer(base64.b64decode(packed["base64"]), "<f4").reshape(packed["shape"])


@pytest.mark.parametrize(
    ("math", "html"),
    [
        ("Q_x/P", "Q<sub>x</sub>/P"),
        (r"p_\mathrm{max}", "p<sub>max</sub>"),
        ("p_{95}", "p<sub>95</sub>"),
        (r"T\gamma/A", "Tγ/A"),
        (r"\xi_x", "ξ<sub>x</sub>"),
        (r"\sigma_\mathrm{vM}", "σ<sub>vM</sub>"),
        (r"\frac{a}{b}", ""),
        ("a<b", "a&lt;b"),
    ],
)
def test_symbols(math, html):
    assert html_symbol(math) == html


@pytest.mark.parametrize(
    ("unit", "shown"), [("mm3", "mm³"), ("1", ""), ("1/mm", "1/mm"), ("N mm", "N mm")]
)
def test_units(unit, shown):
    assert format_unit(unit) == shown


def test_arrays_come_back():
    values = np.arange(6.0).reshape(2, 3).T
    assert (unpacked(data.pack_array(values)) == values).all()


def test_every_column_that_changes_is_plotted_once(history):
    lines = [line for chart in data.charts(history) for line in chart["lines"]]
    figures = [unpacked(line["values"]) for line in lines]
    for name, values in history.numbers().items():
        column = history.columns[name.split()[0]]
        hidden = column.role in data.HIDDEN or "position" in column.dims
        known = values[np.isfinite(values)]
        if hidden or known.size < 2 or np.ptp(known) <= 1e-9 * np.abs(known).max():
            continue
        assert any(np.array_equal(values.astype("<f4"), one, equal_nan=True) for one in figures), (
            name
        )
    titles = [chart["title"] for chart in data.charts(history)]
    assert len(set(titles)) == len(titles)
    # A user-defined column appears automatically, and is not markup.
    assert "Share of the &lt;load&gt;" in titles


def test_a_force_that_is_zero_is_not_plotted():
    """Of isotropic friction that is driven along x there is no lateral force, and no moment."""
    scene = ts.Scene.builtin("twin-discs-isotropic").replace(subsurface=None)
    short = {"wear.revolutions": 20, "wear.save": (20,), "grid.elements": (9, 15)}
    with pytest.warns(ts.SceneWarning, match=r"grid\.elements"):
        history = ts.roll(scene.replace(**short))
    assert np.abs(history["Mz"]).max() > 0.0  # what the solver leaves
    titles = {chart["title"]: len(chart["lines"]) for chart in data.charts(history)}
    assert titles["Tangential forces"] == 1
    assert data.chart_title(history.columns["Mz"]) not in titles


def test_the_fields_are_those_of_the_records(history):
    surface = data.page_data(history)["surface"]
    pressure = unpacked(surface["fields"]["pressure"])
    assert pressure.shape[0] == len(history.saved)
    for shown, at in zip(pressure, history.saved, strict=True):
        # All of the load is in the window, in single precision.
        load = shown.sum(dtype=float) * history.grid.element_area
        assert load == pytest.approx(history.state(at).P, rel=1e-6)


def test_heat_and_friction_that_varies_are_on_it(history):
    hot = ts.roll(ts.Scene.builtin("hot-discs"))
    shown = data.page_data(hot)["surface"]["fields"]
    heat = hot.state().heat
    assert unpacked(shown["temperature_B"]).max() == pytest.approx(heat.temperature["B"].max())
    # In full slip it is what temperature leaves of friction.
    degrees, factors = np.array(hot.scene.friction.temperature).T
    least = np.interp(heat.temperature_max, degrees, factors)
    assert unpacked(shown["friction"]).min() == pytest.approx(least, rel=1e-3)  # drawn on beside
    assert not {"temperature_A", "friction"} & set(data.page_data(history)["surface"]["fields"])


def test_large_results_are_thinned_and_that_is_reported(history):
    found = data.page_data(history, data.PageLimits(records=2, numbers=400, elements=5))
    whole = history.field("pressure").size
    assert unpacked(found["surface"]["fields"]["pressure"])[0].size < whole / 4
    assert found["places"] == ["0", "20"]
    assert len(found["leftOut"]) == 2


def test_stress_is_that_of_the_planes(history):
    (one,) = (
        one
        for one in data.page_data(history)["stress"]
        if (one["body"], one["plane"]) == ("B", "x=0")
    )
    shown = unpacked(one["components"]["von Mises"])[-1]
    stress = history.stress("B", "x=0")
    assert shown.max() == pytest.approx(stress.von_mises.max(), rel=1e-6)  # single precision
    assert one["axes"] == ["y", "depth"]


def test_stress_of_a_narrower_mesh_is_plotted_in_the_middle(tmp_path, monkeypatch):
    monkeypatch.setattr("tractive_sam.contact.model.choose_grid", lambda *_, **__: NARROW)
    scene = (
        ts.Scene.builtin("twin-discs")
        .replace(grid=None)
        .with_set(
            [
                "wear.intensity=2e-5",
                "wear.revolutions=200",
                "wear.save=[0, 200]",
                "subsurface.elements=4",
                'subsurface.planes=["x=0", "z=0.5a"]',
            ]
        )
    )
    history = ts.roll(scene, tmp_path / "a.h5")
    assert history.grid.elements[1] > NARROW.elements[1]
    for one in data.page_data(history)["stress"]:
        first, last = unpacked(one["components"]["von Mises"])
        assert np.isfinite(last).all()
        assert not np.isfinite(first).all()
        stored = history.stress(one["body"], one["plane"], 0).von_mises
        assert np.nanmax(first) == pytest.approx(stored.max(), rel=1e-6)  # single precision
        for name in ("first", "second"):
            np.testing.assert_allclose(*unpacked(one[name]), atol=1e-6)  # as above


def test_of_a_duty_cycle_every_block_is_a_place(tmp_path):
    blocks = ({"revolutions": 5, "load": {"normal": 450.0}}, {"revolutions": 5, "shift_y": 0.1})
    scene = ts.Scene.builtin("twin-discs").with_set(SMALL)
    few = {"planes": ["x=0"], "elements": 4, "bodies": ["A"]}
    history = ts.roll(scene.replace(duty=blocks, subsurface=few))
    found = data.page_data(history)
    (stress,) = found["stress"]
    shown, depths, y = (
        unpacked(one)
        for one in (stress["components"]["von Mises"], stress["second"], stress["first"])
    )
    for k in (0, 1):
        block = history.block(k).stress("A", "x=0")
        assert shown[k - 2].max() == pytest.approx(block.von_mises.max(), rel=1e-6)  # single
        assert depths[k - 2] == pytest.approx(block.depth, rel=1e-6)
    assert depths[-2].max() > depths[-1].max()  # each in its own half widths
    assert y[-2] == pytest.approx(y[-1])
    assert len(found["places"]) == len(found["numbers"]) == 2 * len(history.saved)
    area = history.grid.element_area
    loads = unpacked(found["surface"]["fields"]["pressure"]).sum(axis=(1, 2)) * area
    assert loads == pytest.approx([450.0, 300.0] * len(history.saved), rel=1e-6)
    lines = {one["title"]: [line["name"] for line in one["lines"]] for one in found["charts"]}
    assert lines["Longitudinal force over normal load"] == ["cycle", "duty[0]", "duty[1]"]
    assert not any(", of each block" in title for title in lines)
    ts.report(history, tmp_path / "page.html")


def test_titles_do_not_break_the_page(tmp_path):
    bad = "</script><img src=x onerror=alert(1)> $scene <!--"
    scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 21]"]).replace(title=bad)
    page = ts.report(ts.roll(scene), tmp_path / "page.html").read_text("utf-8")
    assert "<img src=x" not in page
    assert page.count("&lt;img src=x") == 3  # in the title, the heading and the scene
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert json.loads(data[1])["places"] == ["0"]


def test_without_plotly_the_extra_is_named(history, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    with pytest.raises(ImportError, match="report"):
        ts.report(history, tmp_path / "page.html")
    assert not list(tmp_path.iterdir())


def test_measured_points_are_in_their_chart(history, tmp_path):
    course, worn = history["revolution"], history["worn_mass"][:, 1]
    measured = plot.Measurements({"revolution": course, "worn_mass B": worn + 0.25})
    found = data.charts(history, measured)
    lines = [line for chart in found for line in chart["lines"] if "measured" in line]
    assert len(lines) == 1
    assert (unpacked(lines[0]["measured"]["x"]) == course).all()
    assert "0.25 mg" in lines[0]["measured"]["name"]
    assert ts.report(history, tmp_path / "page.html", measured).stat().st_size > 0
    with pytest.raises(ValueError, match="p_mox"):
        ts.report(
            history,
            tmp_path / "page.html",
            plot.Measurements({"revolution": course, "p_mox": course}),
        )
