"""Sphinx configuration of the manual: `sphinx-build -W --keep-going docs docs/_build/html`."""

import sys
from importlib.metadata import version as installed
from importlib.util import find_spec
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import roles
from numpydoc.docscrape import NumpyDocString

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import parts  # noqa: E402 - beside this file

# The inherited docstrings of Matplotlib use a role of the Matplotlib manual.
roles.register_generic_role("mpltype", nodes.literal)

parts.write(HERE)

project = "tractive_sam"
author = "The tractive_sam developers"
project_copyright = author
release = installed("tractive-sam").partition(".post")[0]  # without the commits since

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
    "numpydoc",
    "myst_nb",
]
exclude_patterns = ["_build", "_parts", "paper.md"]
templates_path = ["_templates"]

# Every cross-reference must have a target.
nitpicky = True

# Notebooks are shown with their stored outputs; CI runs them separately.
nb_execution_mode = "off"
myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 3

# MathJax is part of the built manual, so that formulas need no network. This script draws SVG and
# contains all TeX packages and glyphs, so it loads no other file.
mathjax_path = "tex-svg-full.js"
MATHJAX = Path(find_spec("sphinx-mathjax-offline").origin).parent / "static" / "mathjax"

# Docstrings state shapes and units, so types need no links and signatures stay short.
default_role = "literal"
autodoc_typehints = "none"
numpydoc_show_class_members = False
# Docstrings of tables have a section of keys. The manual lists the keys on the page "Scene keys".
NumpyDocString.sections["Keys"] = []

html_theme = "pydata_sphinx_theme"
html_title = f"tractive_sam {release}"
html_static_path = ["_static", str(MATHJAX / mathjax_path)]
html_css_files = ["manual.css"]
html_theme_options = {
    "show_prev_next": False,
    "navbar_align": "left",
    "footer_start": ["copyright"],
}
html_theme_options |= {"footer_end": [], "show_toc_level": 2, "header_links_before_dropdown": 7}
html_sidebars = {"index": [], "validation": [], "benchmarks": []}
html_copy_source = False


def _escape_bars(_app, _what, _name, _object, _options, lines):
    """Escape the bars of magnitudes, |s|, which are not substitutions."""
    lines[:] = [
        line if "`" in line or ">>>" in line else line.replace("|", r"\|") for line in lines
    ]


def setup(app):
    """Connect the function that escapes bars, so that docstrings remain readable in a terminal."""
    app.connect("autodoc-process-docstring", _escape_bars)
