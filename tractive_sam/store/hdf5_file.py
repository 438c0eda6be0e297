"""Opens HDF5 files for reading, also files that other code of the process has open."""

from pathlib import Path

import h5py

from tractive_sam.input_file import open_regular
from tractive_sam.store.errors import ResultsError


def open_to_read(path: Path) -> h5py.File:
    """Open an HDF5 file for reading, also while other code of this process has it open.

    HDF5 shares one handle between all openings of a file by one driver. It refuses an opening with
    different flags: h5py and xarray set flags of locks, netCDF sets a flag of closing. So the file
    is opened by the driver for buffered files, which other code does not use. Only a file that this
    process has open for writing is opened by the usual driver, to share its handle.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    ResultsError
        If another process has it open for writing.
    OSError
        If the file is not a regular file, not an HDF5 file, or is damaged.
    """
    open_regular(path).close()
    try:
        return h5py.File(path, "r", driver="stdio", locking=False)
    except OSError as error:
        unopened = error
    for locking in (False, "best-effort", True):
        try:
            file = h5py.File(path, "r", locking=locking)
        except OSError as error:
            if "already open for write" in str(error):
                cure = "close it there; if its writer was killed, use h5clear -s"
                message = f"{path} is open for writing in another program: {cure}"
                raise ResultsError(message) from error
            if "flag values don't match" not in str(error):
                raise  # only the usual driver states the cause
        else:
            if file.mode == "r+":
                return file
            file.close()  # the shared handle of an earlier reader may predate the damage
    raise unopened
