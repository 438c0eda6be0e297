import shutil
from pathlib import Path

import pytest

from tests.store.sample_records import SCENE, mesh, records
from tractive_sam.store import HistoryWriter


@pytest.fixture
def path(tmp_path):
    return tmp_path / "history.h5"


@pytest.fixture(scope="session")
def seven_records(tmp_path_factory):
    """Return the path of a results file of seven records, three with fields, which tests copy."""
    path = tmp_path_factory.mktemp("finished") / "history.h5"
    with HistoryWriter(path, SCENE, mesh()) as writer:
        for record in records(7):
            writer.append(record)
        writer.finish("done", "every revolution")
    return path


@pytest.fixture
def finished(path, seven_records):
    """Return the path of a finished results file, which a test may change."""
    return Path(shutil.copy(seven_records, path))
