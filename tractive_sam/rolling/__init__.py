"""Counts revolutions: what a pass wears is in the way of the next one."""

from tractive_sam.rolling.damage import MISSED, Damage, stressed_volume
from tractive_sam.rolling.forecast import Forecast
from tractive_sam.rolling.observation import Observation
from tractive_sam.rolling.passage import Passage, ProfilePoint, begun
from tractive_sam.rolling.process import (
    ErrorEstimator,
    Process,
    Recorder,
    Step,
    StepRecord,
    StoredStep,
    continuing_rows,
)
from tractive_sam.rolling.registry import process_of, process_type, steps
from tractive_sam.rolling.transient import Moment, Transient

__all__ = [
    "MISSED",
    "Damage",
    "ErrorEstimator",
    "Forecast",
    "Moment",
    "Observation",
    "Passage",
    "Process",
    "ProfilePoint",
    "Recorder",
    "Step",
    "StepRecord",
    "StoredStep",
    "Transient",
    "begun",
    "continuing_rows",
    "process_of",
    "process_type",
    "steps",
    "stressed_volume",
]
