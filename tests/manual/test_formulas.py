"""The manual shows its formulas in a browser without a network."""

import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.browser import needs_browser

DOCS = Path(__file__).parents[2] / "docs"
NEEDED = ("sphinx", "myst_nb", "numpydoc", "pydata_sphinx_theme", "sphinx-mathjax-offline")

pytestmark = [
    pytest.mark.slow,  # Sphinx builds pages
    needs_browser,
    pytest.mark.skipif(not all(map(find_spec, NEEDED)), reason="needs the extra docs"),
]

STATE = r"""MathJax.startup.promise.then(() => ({
    formulas: document.querySelectorAll(".math").length,
    left: document.querySelectorAll(".math:not(:has(mjx-container svg))").length,
    raw: /\\[\[\](){}a-z]/.test(document.querySelector("article").innerText),
    faults: document.querySelectorAll("[data-mjx-error], mjx-container [fill=red]").length,
    wider: document.documentElement.scrollWidth > innerWidth,
}))"""


@pytest.fixture(scope="module")
def theory(tmp_path_factory):
    """Build the chapters of theory with the configuration of the manual; return their folder."""
    folder = tmp_path_factory.mktemp("manual")
    shutil.copytree(DOCS / "theory", folder / "source")
    build = [sys.executable, "-m", "sphinx", "-q", "-c", str(DOCS)]
    subprocess.run(
        [*build, str(folder / "source"), str(folder / "html")],
        check=True,
        capture_output=True,  # links to other chapters lead nowhere here
    )
    return folder / "html"


def test_no_page_loads_anything_from_a_network(theory):
    for page in theory.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        found = re.findall(r"<(?:script|link|img|iframe)\b[^>]*(?:src|href)=\"(?:https?:)?//", text)
        assert not found, page.name


@pytest.mark.parametrize("width", [1440, 390])
def test_every_formula_is_plotted(theory, browser, width):
    pages = [
        page for page in sorted(theory.glob("*.html")) if 'class="math' in page.read_text("utf-8")
    ]
    assert pages
    for page in pages:
        browser.open(page.as_uri(), width)
        state = browser.run(STATE)
        external = [url for url in browser.requests if not url.startswith(("file:", "data:"))]
        assert not external, page.name
        assert state.pop("formulas") > 0, page.name
        assert not any(state.values()), (page.name, state)
