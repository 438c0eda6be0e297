"""HTML pages that need no other files and no network."""

from tractive_sam.pages.report import fill_page, report

__all__ = ["fill_page", "report"]
