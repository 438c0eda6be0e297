"""Writes xarray datasets as netCDF files, and opens them, also files from other people.

Every number has a checksum of HDF5. The last line of a file is the hash of all bytes before it, so
that texts, attributes and scalars are checked as well; HDF5 ignores this line.
"""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import h5py

from tractive_sam.extras import require_extra
from tractive_sam.output_file import describe_os_error, write_file
from tractive_sam.store.errors import DamagedError, ResultsError
from tractive_sam.store.hdf5_guard import (
    SEAL,
    check_claimed_size,
    get_member,
    has_endless_heap,
    has_seal,
    open_to_read,
)


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

    checked = {
        name: {"fletcher32": True} | dict((encoding or {}).get(name, {}))
        for name, variable in dataset.variables.items()
        if variable.size and variable.ndim and variable.dtype.kind in "biuf"
    }
    memory = BytesIO()
    with h5netcdf.File(memory, "w") as file:
        sealed = dataset.assign_attrs(checksum="SHA-256 in the last line of the file")
        sealed.dump_to_store(H5NetCDFStore(file), encoding={**(encoding or {}), **checked})
    seal = SEAL + hashlib.sha256(memory.getbuffer()).hexdigest().encode()
    memory.seek(0, 2)
    memory.write(seal)
    write_file(path, memory.getbuffer())


@contextmanager
def open_netcdf(path: Path, cure: str = "make it again") -> Iterator[h5py.File]:
    """Open a netCDF file for reading within the block; all its members are checked first.

    Parameters
    ----------
    path : Path
        The file.
    cure : str
        What to do about a damaged file, for the message.

    Raises
    ------
    ResultsError
        If the file cannot be read or is damaged: its content is not what was written, it refers to
        other files, or it claims more data than it can contain. Also for errors of the block, which
        reads its content.
    """
    try:
        sealed = has_seal(path)
        if has_endless_heap(path):
            raise ValueError("its texts")
        with open_to_read(path) as file:
            if "checksum" in file.attrs and not sealed:
                raise ValueError("its end is lost, or another program has changed it")
            _check_members(file)
            yield file
    except (MemoryError, ResultsError):
        raise
    except Exception as error:  # h5py raises many types of errors for damaged files
        problem = describe_os_error(error) if isinstance(error, OSError) else str(error)
        raise DamagedError(f"{path} is damaged or cannot be read: {problem}; {cure}") from error


def _check_members(file: h5py.File) -> None:
    """Raise a ValueError unless a file contains only datasets of numbers and texts that fit it."""
    claimed = 0
    for name in file:
        member = get_member(file, name)
        if isinstance(member, h5py.Group) or not (
            member.dtype.kind in "biufS" or h5py.check_string_dtype(member.dtype)
        ):
            raise ValueError(f"{name}: allowed: arrays of numbers and texts")
        claimed += member.size * max(member.dtype.itemsize, 8)
        try:
            check_claimed_size(member, claimed)
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from error


def netcdf_format(path: str | PathLike[str]) -> str:
    """Return the attribute "format" of a netCDF file; "" if it has none or is unreadable."""
    try:
        with open_to_read(Path(path)) as file:
            name = file.attrs.get("format", "")
            return name.decode("utf-8", "replace") if isinstance(name, bytes) else str(name)
    except Exception:  # h5py raises many types of errors for damaged files
        return ""


def read_netcdf(path: str | PathLike[str], cure: str = "make it again") -> Any:
    """Return the content of a netCDF file as an xarray Dataset in memory.

    Parameters
    ----------
    path : path-like
        The file.
    cure : str
        What to do about a damaged file, for the message.

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
    with (
        open_netcdf(path, cure),
        xarray.open_dataset(path, engine="h5netcdf", decode_times=False) as dataset,
    ):
        return dataset.load()
