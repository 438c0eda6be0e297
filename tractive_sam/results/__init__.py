"""What travels: plain data with names and units, below everything that makes or reads it.

A `State` is one solved contact, a `Record` what is kept of it, a `History` all records.
"""

from tractive_sam.results.history import History
from tractive_sam.results.quantities import (
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
from tractive_sam.results.record import Record, record, state

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
