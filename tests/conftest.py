"""Numpy raises where numbers go wrong. The package is not imported before coverage has begun."""

import numpy as np
import pytest
from hypothesis import settings

# A change is judged by the same examples each time, whatever the speed of the machine;
# `--hypothesis-profile=search` looks for new ones.
settings.register_profile("same", derandomize=True, database=None, deadline=None)
settings.register_profile("search", derandomize=False, database=None, deadline=None)
settings.load_profile("same")


@pytest.fixture(autouse=True)
def _strict_numpy():
    with np.errstate(invalid="raise", over="raise", divide="raise"):
        yield


def pytest_collection_modifyitems(session):
    """Tests go to limits on purpose."""
    unlikely = "ignore::tractive_sam.scene.PlausibilityWarning"
    session.add_marker(pytest.mark.filterwarnings(unlikely))
