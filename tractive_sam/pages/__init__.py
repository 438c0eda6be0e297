"""Pages of HTML that need no other file and no network; plotly only here, and only its script."""

from tractive_sam.pages.report import report

__all__ = ["report"]
