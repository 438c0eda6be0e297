"""HTML pages that need no other files and no network."""

from importlib.resources import files

from tractive_sam.pages.report import report

__all__ = ["report", "style"]


def style() -> str:
    """Return the style sheet (CSS) that all HTML pages share."""
    return files(__name__).joinpath("style.css").read_text("utf-8")
