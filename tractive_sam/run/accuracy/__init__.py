"""An accuracy in place of a mesh: the same scene on finer and finer meshes, and error bars.

Every mesh has half the elements of the next. The differences between the last three tell how far
the finest may be from the limit (`error_bars`); it is refined until that is within the tolerance.
"""

from tractive_sam.run.accuracy.course import Judge, judge_of, judge_on
from tractive_sam.run.accuracy.judgement import missed_before
from tractive_sam.run.accuracy.levels import Levels, with_tolerances
from tractive_sam.run.accuracy.steady import Refined, refined

__all__ = [
    "Judge",
    "Levels",
    "Refined",
    "judge_of",
    "judge_on",
    "missed_before",
    "refined",
    "with_tolerances",
]
