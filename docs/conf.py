"""How Sphinx builds the manual: `sphinx-build -W --keep-going docs docs/_build/html`."""

import sys
from importlib.metadata import version as installed
from importlib.util import find_spec
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import roles

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import parts  # noqa: E402 - beside this file

# Matplotlib writes the setters of each class of figures, with a role of its own manual.
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
exclude_patterns = ["_build", "_parts"]
templates_path = ["_templates"]

# Every reference inside the pages has to lead somewhere.
nitpicky = True

# Notebooks are shown with the outputs that they are kept with; CI runs them by themselves.
nb_execution_mode = "off"
myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 3

# MathJax is part of the built manual: formulas need no network. This script draws them as SVG and
# contains all packages of TeX and all glyphs, so it loads no other file.
mathjax_path = "tex-svg-full.js"
MATHJAX = Path(find_spec("sphinx-mathjax-offline").origin).parent / "static" / "mathjax"

# Docstrings give shapes and units in words: types are no links, and signatures stay short.
default_role = "literal"
autodoc_typehints = "none"
numpydoc_show_class_members = False

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


def _bars_are_bars(_app, _what, _name, _object, _options, lines):
    """Magnitudes in docstrings, |s|, are no substitutions."""
    lines[:] = [one if "`" in one or ">>>" in one else one.replace("|", r"\|") for one in lines]


def setup(app):
    """Let docstrings be written as they are read in a terminal."""
    app.connect("autodoc-process-docstring", _bars_are_bars)
