"""Counts revolutions: what a pass wears is in the way of the next one."""

from tractive_sam.roll.passage import Passage, next_passage, unworn
from tractive_sam.roll.revolutions import passages, recorded

__all__ = ["Passage", "next_passage", "passages", "recorded", "unworn"]
