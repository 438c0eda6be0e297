"""Counts revolutions: what a pass wears is in the way of the next one."""

from tractive_sam.rolling.passage import Milestone, Passage, next_passage, unworn
from tractive_sam.rolling.revolutions import passages, recorded

__all__ = ["Milestone", "Passage", "next_passage", "passages", "recorded", "unworn"]
