"""Names that `store` exports, for `__init__.py` and for type checkers."""

from .creep_table import TABLE_FORMAT as TABLE_FORMAT
from .creep_table import StoredTable as StoredTable
from .creep_table import read_creep_table as read_creep_table
from .errors import DamagedError as DamagedError
from .errors import FileInUseError as FileInUseError
from .errors import GapError as GapError
from .errors import ResultsError as ResultsError
from .errors import StorageError as StorageError
from .format_version import FORMAT_VERSION as FORMAT_VERSION
from .format_version import versions as versions
from .gap import read_gap as read_gap
from .lock import hold_lock as hold_lock
from .netcdf import netcdf_format as netcdf_format
from .netcdf import read_netcdf as read_netcdf
from .netcdf import write_netcdf as write_netcdf
from .reader import open_history as open_history
from .reader import read_state as read_state
from .volume import Image as Image
from .volume import check_volume as check_volume
from .volume import write_surface as write_surface
from .volume import write_volume as write_volume
from .write_access import is_written as is_written
from .write_access import lock_path as lock_path
from .writer import HistoryWriter as HistoryWriter
from .writer import check_results as check_results
from .writer import results_writer as results_writer
