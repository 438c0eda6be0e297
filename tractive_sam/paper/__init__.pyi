"""What `paper` exports, for `__init__.py` and for type checkers."""

from .finding import Chapter as Chapter
from .finding import Finding as Finding
from .finding import FindingTable as FindingTable
from .finding import Picture as Picture
from .finding import Statement as Statement
from .finding import Verdict as Verdict
from .reproduction import CHAPTERS as CHAPTERS
from .reproduction import reproduce as reproduce
from .size import FULL as FULL
from .size import REDUCED as REDUCED
from .size import Size as Size
