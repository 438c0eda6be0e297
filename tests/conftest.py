"""Numpy raises where numbers go wrong. The package is not imported before coverage has begun."""

import os

import numpy as np
import pytest
from hypothesis import settings

# A change is judged by the same examples each time, whatever the speed of the machine;
# `--hypothesis-profile=search` looks for new ones.
settings.register_profile("same", derandomize=True, database=None, deadline=None)
settings.register_profile("search", derandomize=False, database=None, deadline=None)
settings.load_profile("same")

OF_TERMINALS = ("FORCE_COLOR", "GITHUB_ACTIONS", "NO_COLOR", "PY_COLORS", "TERM", "TTY_COMPATIBLE")
"""What a shell or a service tells of its terminal; what the program prints would go by it."""


@pytest.hookimpl(trylast=True)
def pytest_configure():
    """No terminal is told of, once pytest itself has looked at it."""
    for name in OF_TERMINALS:
        os.environ.pop(name, None)


@pytest.fixture(autouse=True)
def _strict_numpy():
    with np.errstate(invalid="raise", over="raise", divide="raise"):
        yield


def pytest_collection_modifyitems(session):
    """Tests go to limits on purpose."""
    unlikely = "ignore::tractive_sam.scene.PlausibilityWarning"
    session.add_marker(pytest.mark.filterwarnings(unlikely))
