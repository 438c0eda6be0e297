"""What `pages` lets out, for `__init__.py` and for type checkers."""

from .history_page import fill_page as fill_page
from .history_page import report as report
