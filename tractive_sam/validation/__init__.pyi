"""What `validation` exports, for `__init__.py` and for type checkers."""

from .comparison import Comparison as Comparison
from .comparison import Outcome as Outcome
from .comparison import PublishedSet as PublishedSet
from .comparison import Topic as Topic
from .comparison import Verdict as Verdict
from .report import TOPICS as TOPICS
from .report import select_sets as select_sets
from .report import validate as validate
from .wheel_rail import check_locus as check_locus
from .wheel_rail import find_standard_locus as find_standard_locus
