import sys

import pytest

from tractive_sam.results import Grid
from tractive_sam.scene import Scene
from tractive_sam.store import HistoryWriter


def test_the_page_is_named_after_the_file(call, stored, folder):
    result = call("report", stored)
    assert result.exit_code == 0
    assert result.stdout == "stored.html\n"
    assert "Stored [not markup]" in (folder / "stored.html").read_text("utf-8")
    assert call("report", stored, "-o", "other.html").exit_code == 0
    assert (folder / "other.html").stat().st_size > 1e6  # with the script that draws


def test_what_cannot_be_written_or_shown_is_reported(call, stored, folder):
    assert "cannot be written" in call("report", stored, "-o", folder / "no" / "a.html").stderr
    HistoryWriter("empty.h5", Scene.builtin("spheres"), Grid((1.0, 1.0), (9, 9)))
    result = call("report", "empty.h5")
    assert result.exit_code == 2
    assert "no record" in result.stderr
    assert call("report", "missing.h5").exit_code == 2


def test_without_plotly_the_extra_is_named(call, stored, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    result = call("report", stored)
    assert result.exit_code == 2
    assert "extra report" in result.stderr


@pytest.mark.parametrize("ending", ["running", "diverged"])
def test_what_is_not_done_says_so(call, folder, ending):
    from tests.cli.conftest import GRID, SCENE, make_record  # noqa: PLC0415

    with HistoryWriter("early.h5", SCENE, GRID) as writer:
        writer.append(make_record(0))
        if ending != "running":
            writer.finish(ending, "because")
    result = call("report", "early.h5")
    assert result.exit_code == 0
    assert ending in result.stderr
    assert f">{ending}</span>" in (folder / "early.html").read_text("utf-8")
