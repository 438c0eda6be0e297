"""Results and measured gaps on disk; the only room that opens HDF5 files."""

from tractive_sam.store.errors import GapError, ResultsError
from tractive_sam.store.gap import read_gap
from tractive_sam.store.reader import last_state, open_history
from tractive_sam.store.volume import Image, check_volume, write_volume
from tractive_sam.store.writer import HistoryWriter

__all__ = [
    "GapError",
    "HistoryWriter",
    "Image",
    "ResultsError",
    "check_volume",
    "last_state",
    "open_history",
    "read_gap",
    "write_volume",
]
