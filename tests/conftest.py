"""Settings of all tests. The package is not imported here: coverage has not begun yet."""

import functools
import gc
import os
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from PIL import Image

from tests import cpu_time
from tests.browser import Browser

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


def pytest_collection_finish():
    """Let garbage collections pass over the tests and modules: they stay until the end."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True)
def _strict_numpy():
    """Let NumPy raise if a result is invalid or infinite."""
    with np.errstate(invalid="raise", over="raise", divide="raise"):
        yield


@pytest.fixture(autouse=True)
def _no_allowed_laws(monkeypatch):
    """Let each test begin without laws that another test allowed for this process."""
    monkeypatch.setattr("tractive_sam.schema.named_law._ALLOWED", set())


@pytest.fixture(scope="session", autouse=True)
def _formulas_parsed_once():
    """Let all figures share their parsed formulas, which take a third of the time for a figure.

    Matplotlib stores few, and those of each figure apart.
    """
    parser = import_module("matplotlib.mathtext").MathTextParser
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parser, "__hash__", lambda self: hash(str(vars(self))))
        patch.setattr(parser, "__eq__", lambda self, other: vars(self) == vars(other))
        parse = functools.lru_cache(1000)(parser._parse_cached.__wrapped__)
        patch.setattr(parser, "_parse_cached", parse)
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


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """Start a browser; all tests of this process show their pages in it."""
    with Browser(tmp_path_factory.mktemp("browser")) as browser:
        yield browser


@pytest.fixture
def few_table_nodes(monkeypatch):
    """Tables of creep forces begin with few nodes, and are checked at few points."""
    few = {"samples": 1, "anywhere": 16, "checks": 16, "first_u": (0.0, 0.4, 0.7, 1.0)}
    refinement = import_module("tractive_sam.tables.solving").Refinement(**few)
    monkeypatch.setattr("tractive_sam.tables.solving.HEADINGS", 3)
    monkeypatch.setattr("tractive_sam.tables.solving.TILTS", 2)
    monkeypatch.setattr("tractive_sam.tables.building.Refinement", lambda: refinement)


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
