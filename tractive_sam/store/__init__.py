"""Results and measured gaps on disk; the only room that opens HDF5 files."""

from tractive_sam.store.errors import DamagedError, GapError, ResultsError
from tractive_sam.store.gap import read_gap
from tractive_sam.store.reader import open_history, state_of
from tractive_sam.store.volume import Image, check_volume, write_volume
from tractive_sam.store.writer import HistoryWriter, check_results

__all__ = [
    "DamagedError",
    "GapError",
    "HistoryWriter",
    "Image",
    "ResultsError",
    "check_results",
    "check_volume",
    "open_history",
    "read_gap",
    "state_of",
    "write_volume",
]
