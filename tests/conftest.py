"""Settings of all tests. The package is not imported here: coverage has not begun yet."""

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from PIL import Image

from tests import cpu_time

# The examples are equal in each run, at any speed of the machine; `--hypothesis-profile=search`
# looks for new ones.
settings.register_profile("same", derandomize=True, database=None, deadline=None)
settings.register_profile("search", derandomize=False, database=None, deadline=None)
settings.load_profile("same")

TERMINAL_VARIABLES = (
    *("FORCE_COLOR", "GITHUB_ACTIONS", "NO_COLOR", "PY_COLORS", "TERM", "TTY_COMPATIBLE"),
)
"""Variables that describe the terminal; printed output depends on them."""

pytest_addoption = cpu_time.pytest_addoption


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    """Remove the description of the terminal, after pytest itself has read it."""
    for name in TERMINAL_VARIABLES:
        os.environ.pop(name, None)
    config.pluginmanager.register(cpu_time.CpuTime(config))


@pytest.fixture(autouse=True)
def _strict_numpy():
    """Let NumPy raise if a result is invalid or infinite."""
    with np.errstate(invalid="raise", over="raise", divide="raise"):
        yield


@pytest.fixture
def empty_pictures(monkeypatch):
    """Figures are made, and their pictures have one dot: drawing takes most of the time."""

    def save_dot(_figure, target, **_options):
        if isinstance(target, str | Path):
            Path(target).touch()
        else:
            Image.new("L", (1, 1)).save(target, "png")

    monkeypatch.setattr("tractive_sam.plot.figure.Figure.savefig", save_dot)


def pytest_collection_modifyitems(session, config, items):
    """Ignore warnings about improbable values, and do not trace slow tests.

    Tests go to limits on purpose. Coverage doubles the time of a test, and slow tests reach few
    lines that no quick test reaches.
    """
    unlikely = "ignore::tractive_sam.schema.PlausibilityWarning"
    session.add_marker(pytest.mark.filterwarnings(unlikely))
    if config.pluginmanager.hasplugin("_cov"):
        for item in items:
            if item.get_closest_marker("slow"):
                item.add_marker("no_cover")
