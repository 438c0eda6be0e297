"""Results files and measured gaps on disk."""

from tractive_sam.store.creep_table import TABLE_FORMAT, StoredTable, read_creep_table
from tractive_sam.store.errors import (
    DamagedError,
    FileInUseError,
    GapError,
    ResultsError,
    StorageError,
)
from tractive_sam.store.gap import read_gap
from tractive_sam.store.lock import hold_lock
from tractive_sam.store.netcdf import netcdf_format, read_netcdf, write_netcdf
from tractive_sam.store.reader import open_history, read_state
from tractive_sam.store.versions import FORMAT_VERSION, versions
from tractive_sam.store.volume import Image, check_volume, write_surface, write_volume
from tractive_sam.store.write_access import is_written, lock_path
from tractive_sam.store.writer import HistoryWriter, check_results, results_writer

__all__ = [
    "FORMAT_VERSION",
    "TABLE_FORMAT",
    "DamagedError",
    "FileInUseError",
    "GapError",
    "HistoryWriter",
    "Image",
    "ResultsError",
    "StorageError",
    "StoredTable",
    "check_results",
    "check_volume",
    "hold_lock",
    "is_written",
    "lock_path",
    "netcdf_format",
    "open_history",
    "read_creep_table",
    "read_gap",
    "read_netcdf",
    "read_state",
    "results_writer",
    "versions",
    "write_netcdf",
    "write_surface",
    "write_volume",
]
