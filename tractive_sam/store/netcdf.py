"""Writes datasets of xarray as netCDF."""

from collections.abc import Mapping
from io import BytesIO
from os import PathLike
from typing import Any

from tractive_sam.extras import require_extra
from tractive_sam.output_file import write_file


def write_netcdf(
    path: str | PathLike[str], dataset: Any, encoding: Mapping[str, Mapping[str, Any]] | None = None
) -> None:
    """Write a dataset as a netCDF file, by way of the memory: HDF5 does not survive a full disk.

    Parameters
    ----------
    path : path-like
        The file; replaced as a whole.
    dataset : xarray.Dataset
        What to write.
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
