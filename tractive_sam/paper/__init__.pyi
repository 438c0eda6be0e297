"""What `paper` exports, for `__init__.py` and for type checkers."""

from .page import FULL as FULL
from .page import REDUCED as REDUCED
from .page import Chapter as Chapter
from .page import Finding as Finding
from .page import FindingTable as FindingTable
from .page import Picture as Picture
from .page import Size as Size
from .page import Statement as Statement
from .page import Verdict as Verdict
from .reproduction import CHAPTERS as CHAPTERS
from .reproduction import reproduce as reproduce
