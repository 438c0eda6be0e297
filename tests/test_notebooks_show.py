"""What a notebook shows of scenes, contacts, histories, studies and figures: little, and once."""

import re
from dataclasses import replace
from html import escape

import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.cli import app

ROUND = ("grid.elements=[21, 21]", "grid.half_length=[4.08, 4.08]")
WORN = ("wear.coefficient=1e-4", "wear.revolutions=3", "wear.save=[0, 3]")
SCENE = ts.Scene.builtin("spheres").replace(subsurface=None).with_set(ROUND)
MU = {"key": "friction.mu", "values": [0.2, 0.4]}


@pytest.fixture(scope="module")
def history():
    return ts.roll(SCENE.with_set(WORN))


def things(history, folder):
    pytest.importorskip("dask", reason="dask is of the extra study")
    study = ts.study(ts.Study(scene=SCENE, axis=[MU]), folder / "study", workers=0)
    line = ts.roll(ts.Scene.builtin("cylinders"))
    return [SCENE, history, history.state(), study, line, line.state(), line.scene]


@pytest.mark.slow
def test_little_is_shown_and_a_picture_is(history, tmp_path):
    for one in things(history, tmp_path):
        text, html = repr(one), one._repr_html_()
        assert max(map(len, text.splitlines())) < 250, text
        assert len(text.splitlines()) < 20
        without_picture = re.sub(r'base64,[^"]*', "", html)
        assert len(without_picture) < 5000
        assert "<table>" in html
    assert "<img" in history._repr_html_()
    assert "<svg" in SCENE._repr_html_()


def test_titles_are_no_markup():
    html = SCENE.replace(title="<script>alert(1)</script>\x1b[2J")._repr_html_()
    assert "<script" not in html
    assert "\x1b" not in html


def test_what_has_no_fields_is_shown_without_a_picture(history):
    bare = ts.History.of_records([], history.scene, history.grid, status="running")
    assert "running" in repr(bare)
    assert "<img" not in bare._repr_html_()


def test_names_of_a_scene_are_its_own():
    listed = {name for name in dir(SCENE) if not name.startswith("_")}
    assert {"body", "load", "hertz", "replace", "with_set", "to_toml"} <= listed
    assert not [name for name in listed if name.startswith("model_")]
    assert not listed & {"copy", "dict", "json", "construct", "parse_obj", "schema", "validate"}
    assert not listed & {
        "checks",
        "has_fixed_domain",
        "table_class",
        "under_largest_load",
        "unfold",
    }
    assert "revolutions" in dir(SCENE.with_set(WORN).wear)


def test_a_figure_shows_itself_once_whatever_a_notebook_was_reported(history):
    formatters = pytest.importorskip("IPython.core.formatters", reason="of the extra notebooks")
    from IPython.core.pylabtools import select_figure_formats  # noqa: PLC0415
    from matplotlib import pyplot  # noqa: PLC0415

    figure = plot.forces(history)
    display = formatters.DisplayFormatter()
    data, about = display.format(figure)
    assert data["image/png"].startswith(b"\x89PNG")
    assert about["image/png"]["width"] == round(figure.get_figwidth() * figure.dpi)

    class Shell:
        display_formatter = display

    select_figure_formats(Shell, {"png"})  # as %matplotlib inline does
    data, _ = display.format(figure)
    assert sorted(data) == ["image/png", "text/plain"]
    assert not pyplot.get_fignums()  # which it would draw a second time at the end of a cell


def test_a_creep_table_shows_its_description_and_no_numbers():
    table = ts.open_table("steel")
    shown = " ".join(CliRunner().invoke(app, ["show", "steel"]).output.split())
    for title, rows in table.sections.items():
        for what, answer in rows:
            assert f"{what} {answer}" in shown, title
            assert f"{what} " in repr(table)
            assert answer in repr(table)
            assert escape(answer) in table._repr_html_()
    assert len(repr(table).splitlines()) < 40  # a screen; its arrays take thousands
    assert "array(" not in repr(table)


def test_titles_of_tables_are_text():
    """Neither a tag in a page nor a command of a terminal."""
    table = ts.open_table("steel")
    hostile = replace(table, about={"title": "<script>alert(1)</script>\x1b[2J"})
    assert "<script" not in hostile._repr_html_()
    assert "\x1b" not in repr(hostile)
