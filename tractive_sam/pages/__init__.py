"""HTML pages that need no other files and no network."""

from tractive_sam.pages.page import fill_page
from tractive_sam.pages.report import report

__all__ = ["fill_page", "report"]
