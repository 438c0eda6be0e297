"""Writes xarray datasets as netCDF files, and reads them."""

from collections.abc import Mapping
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

from tractive_sam.extras import require_extra
from tractive_sam.output_file import describe_os_error, write_file
from tractive_sam.store.errors import DamagedError, ResultsError
from tractive_sam.store.hdf5_file import open_to_read
from tractive_sam.store.hdf5_guard import has_endless_heap


def write_netcdf(
    path: str | PathLike[str], dataset: Any, encoding: Mapping[str, Mapping[str, Any]] | None = None
) -> None:
    """Write an xarray Dataset to a netCDF file, which appears when it is complete.

    Parameters
    ----------
    path : path-like
        The file; it is replaced atomically.
    dataset : xarray.Dataset
        The dataset.
    encoding : mapping of str to mapping, optional
        Encodings of variables, as `xarray.Dataset.to_netcdf` takes them.

    Raises
    ------
    ImportError
        If h5netcdf or xarray is not installed.
    OutputError
        If the file cannot be written.
    """
    with require_extra("netCDF files"):
        import h5netcdf  # noqa: PLC0415 - of an extra
        from xarray.backends import H5NetCDFStore  # noqa: PLC0415 - of an extra

    memory = BytesIO()
    with h5netcdf.File(memory, "w") as file:
        dataset.dump_to_store(H5NetCDFStore(file), encoding=encoding)
    write_file(path, memory.getbuffer())


def netcdf_format(path: str | PathLike[str]) -> str:
    """Return the attribute "format" of a netCDF file; "" if it has none or is unreadable."""
    try:
        with open_to_read(Path(path)) as file:
            name = file.attrs.get("format", "")
    except (OSError, ResultsError, TypeError, ValueError):
        return ""
    return name.decode("utf-8", "replace") if isinstance(name, bytes) else str(name)


def read_netcdf(path: str | PathLike[str]) -> Any:
    """Return the content of a netCDF file as an xarray Dataset in memory.

    Parameters
    ----------
    path : path-like
        The file.

    Returns
    -------
    xarray.Dataset
        All its variables.

    Raises
    ------
    ImportError
        If h5netcdf or xarray is not installed.
    ResultsError
        If the file cannot be read, or is damaged.
    """
    with require_extra("netCDF files"):
        import xarray  # noqa: PLC0415 - of an extra

    path = Path(path)
    try:
        open_to_read(path).close()
        damaged = has_endless_heap(path)
    except OSError as error:
        raise DamagedError(
            f"{path} cannot be read: {describe_os_error(error)}; make it again"
        ) from error
    if damaged:
        raise DamagedError(f"{path} is damaged (its texts); make it again")
    try:
        with xarray.open_dataset(path, engine="h5netcdf", decode_times=False) as file:
            return file.load()
    except (LookupError, OSError, TypeError, ValueError) as error:
        raise DamagedError(f"{path} is damaged ({error}); make it again") from error
