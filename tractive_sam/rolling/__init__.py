"""Counts revolutions: what a pass wears is in the way of the next one."""

from tractive_sam.rolling.passage import Milestone, Passage, first_passage, next_passage, unworn
from tractive_sam.rolling.revolutions import Judge, passages, recorded
from tractive_sam.rolling.saves import Saves

__all__ = [
    "Judge",
    "Milestone",
    "Passage",
    "Saves",
    "first_passage",
    "next_passage",
    "passages",
    "recorded",
    "unworn",
]
