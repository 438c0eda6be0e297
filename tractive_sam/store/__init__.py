"""Results and measured gaps on disk; the only room that opens HDF5 files."""

from tractive_sam.store.errors import GapError, ResultsError
from tractive_sam.store.gap import read_gap
from tractive_sam.store.reader import last_state, open_history
from tractive_sam.store.writer import HistoryWriter

__all__ = ["GapError", "HistoryWriter", "ResultsError", "last_state", "open_history", "read_gap"]
