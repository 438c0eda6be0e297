import pytest

from tests.store.sample_records import SCENE, mesh, records
from tractive_sam.store import HistoryWriter


@pytest.fixture
def path(tmp_path):
    return tmp_path / "history.h5"


@pytest.fixture
def finished(path):
    """Return a finished results file of seven records, three with fields."""
    with HistoryWriter(path, SCENE, mesh()) as writer:
        for record in records(7):
            writer.append(record)
        writer.finish("done", "every revolution")
    return path
