import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.store.sample_records import make_values
from tractive_sam.cli import app
from tractive_sam.results.column_table import columns
from tractive_sam.results.grid import Grid
from tractive_sam.results.quantity import fields_table
from tractive_sam.results.record import Record
from tractive_sam.results.state import FIELDS
from tractive_sam.scene import Scene
from tractive_sam.store import HistoryWriter, open_history

GRID = Grid((1.0, 1.0), (9, 9))


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Every command runs in an empty folder, and says so in plain text."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


@pytest.fixture
def call():
    """Run the program with arguments; nothing but an exit may leave it."""

    def call(*arguments):
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        assert result.exception is None or isinstance(result.exception, SystemExit)
        assert "Traceback" not in result.output
        return result

    return call


SCENE = Scene.builtin("spheres").with_set(["title=Stored [not markup]"]).replace(subsurface=None)


def make_record(number, scene=SCENE):
    """A record of a contact that is round and slips everywhere."""
    pressure = np.maximum(1 - np.square(GRID.x[:, None]) - np.square(GRID.y), 0)
    fields = dict.fromkeys(FIELDS, np.zeros_like(pressure))
    fields |= {"pressure": pressure, "traction_x": 0.3 * pressure, "slip_x": -1e-3 * pressure}
    names = {name: one for name, one in columns(scene).items() if one.dims[:1] != ("body",)}
    values = make_values(number + 0.5, number, names, len(GRID.y))
    return Record(values, names, {"fields": fields_table(fields, FIELDS, GRID)})


@pytest.fixture(scope="session")
def thirty_records(tmp_path_factory):
    """Return the path of a results file of thirty records, which tests copy."""
    path = tmp_path_factory.mktemp("stored") / "stored.h5"
    with HistoryWriter(path, SCENE, GRID) as writer:
        for number in range(30):
            record = make_record(number)
            writer.append(record if number in (0, 29) else replace(record, tables={}))
        writer.finish("done", "as asked")
    return path


@pytest.fixture
def stored(folder, thirty_records):
    """Return the path of a results file of thirty records, which a test may change."""
    return Path(shutil.copy(thirty_records, folder))


@pytest.fixture
def roll(monkeypatch):
    """A roll that computes nothing; returns the calls made, and ends as its `ending` says."""

    class Roll:
        ending = ("done", "conditions hold")
        error = None

        def __init__(self):
            self.calls = []

        def __call__(
            self, scene, path=None, *, start=None, overwrite=False, resume=False, progress=None
        ):
            self.calls.append((scene, path, overwrite))
            with HistoryWriter(path, scene, GRID, overwrite) as writer:
                for number in range(3):
                    writer.append(make_record(number, scene))
                    if progress is not None:
                        progress(make_record(number, scene))
                if self.error is not None:
                    raise self.error
                writer.finish(*self.ending)
            return open_history(path)

    fake = Roll()
    monkeypatch.setattr("tractive_sam.run.roll", fake)
    return fake
