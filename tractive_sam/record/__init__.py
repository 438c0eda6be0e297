"""What is kept of a computation: plain numbers and arrays with names and units."""

from tractive_sam.record.history import History
from tractive_sam.record.quantities import (
    BODY_ERROR_BARS,
    BODY_POINTS,
    BODY_SCALARS,
    ERROR_BARS,
    FIELDS,
    POINTS,
    PROFILES,
    SCALARS,
    STATE,
    STRESS,
    Quantity,
    error_bars,
    scalars,
)
from tractive_sam.record.record import Record, record, state

__all__ = [
    "BODY_ERROR_BARS",
    "BODY_POINTS",
    "BODY_SCALARS",
    "ERROR_BARS",
    "FIELDS",
    "POINTS",
    "PROFILES",
    "SCALARS",
    "STATE",
    "STRESS",
    "History",
    "Quantity",
    "Record",
    "error_bars",
    "record",
    "scalars",
    "state",
]
