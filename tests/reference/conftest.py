import json
from pathlib import Path

import pytest

DATA = Path(__file__).parents[1] / "data" / "reference.json"


@pytest.fixture(scope="session")
def published():
    """Numbers of the literature and of an independent program."""
    return json.loads(DATA.read_text(encoding="utf-8"))
