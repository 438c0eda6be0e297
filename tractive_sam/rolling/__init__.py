"""Counts revolutions: what a pass wears is in the way of the next one."""

from tractive_sam.rolling.adaptive import MISSED
from tractive_sam.rolling.damage import Damage, followed, stressed_volume
from tractive_sam.rolling.forecast import Forecast
from tractive_sam.rolling.passage import (
    Passage,
    ProfilePoint,
    begun,
    first_passage,
    next_passage,
    resumed,
    unworn,
)
from tractive_sam.rolling.revolutions import ErrorEstimator, passages, recorded
from tractive_sam.rolling.transient import Moment, Transient, expected_steps

__all__ = [
    "MISSED",
    "Damage",
    "ErrorEstimator",
    "Forecast",
    "Moment",
    "Passage",
    "ProfilePoint",
    "Transient",
    "begun",
    "expected_steps",
    "first_passage",
    "followed",
    "next_passage",
    "passages",
    "recorded",
    "resumed",
    "stressed_volume",
    "unworn",
]
