"""What is kept of a computation: plain numbers and arrays with names and units."""

from tractive_sam.record.history import History
from tractive_sam.record.quantities import FIELDS, POINTS, PROFILES, SCALARS, Quantity
from tractive_sam.record.record import Record, record

__all__ = ["FIELDS", "POINTS", "PROFILES", "SCALARS", "History", "Quantity", "Record", "record"]
