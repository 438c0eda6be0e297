"""Writes xarray datasets as netCDF files, and opens them, also files from other people.

Every number has a checksum of HDF5. The last line of a file is the hash of all bytes before it, so
that texts, attributes and scalars are checked as well; HDF5 ignores this line.
"""

import hashlib
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tractive_sam.extras import require_extra
from tractive_sam.output_file import describe_os_error, write_file
from tractive_sam.store.errors import DamagedError, ResultsError
from tractive_sam.store.opening import (
    SEAL,
    check_claimed_size,
    get_member,
    has_endless_heap,
    has_seal,
    numeric_dataset,
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


TABLE_FORMAT = "creep-force table 2"
"""Value of the attribute `format`, with the version of the format."""

CHECKS = ("check_points", "check_errors", "check_told")
"""Datasets of the check points: coordinates, true errors, and errors that the table estimates."""


@dataclass(frozen=True, eq=False)
class StoredTable:
    """Arrays and attributes of a creep-force table as its file holds them.

    Attributes
    ----------
    names : tuple of str
        Names of the axes.
    axes : tuple of ndarray
        Nodes of each axis.
    coefficients, bars : ndarray
        Derivatives and error bars at the nodes.
    between : tuple of ndarray
        Interpolation errors within the intervals of each axis; empty for an axis of one node.
    about : mapping
        Attributes of the file, and the check points.
    gradient_bars : ndarray or None
        Error bars of gradients; None for files that were written before they were measured.
    """

    names: tuple[str, ...]
    axes: tuple[np.ndarray, ...]
    coefficients: np.ndarray
    bars: np.ndarray
    between: tuple[np.ndarray, ...]
    about: Mapping[str, Any]
    gradient_bars: np.ndarray | None = None


def read_creep_table(path: Path) -> StoredTable:
    """Return the content of a creep-force table's file; ResultsError unless it is valid.

    Raises
    ------
    ResultsError
        If the file does not exist, is damaged, is no table, or has another version.
    """
    if not path.is_file():
        cure = f"write it by tractive-sam table TABLE.toml -o {path}, or use the built-in steel"
        raise ResultsError(f"{path}: this table does not exist; {cure}")
    cure = "make it again by tractive-sam table"
    with open_netcdf(path, cure) as file:
        kind = str(_decode_attribute(file.attrs.get("format", "")))
        if kind != TABLE_FORMAT:
            described = f"a {kind}" if kind.startswith("creep-force") else "no creep-force table"
            raise ResultsError(f"{path} is {described}; this version reads {TABLE_FORMAT}: {cure}")
        return _read_table(file)


def _read_table(file: h5py.File) -> StoredTable:
    """Return all arrays and attributes of an open file, with unchecked shapes."""
    about = _read_attributes(file)
    names = tuple(about["axes"].split())
    for name in names:
        if not name.isidentifier():  # / would lead into groups
            raise ValueError(f"axes: the name {name!r}; allowed: letters, digits and _")
    axes = tuple(_read_numbers(file, name) for name in names)
    between = tuple(
        _read_numbers(file, f"between_{name}") if nodes.size > 1 else np.empty((0, 3))
        for name, nodes in zip(names, axes, strict=True)
    )
    about |= {name: _read_numbers(file, name) for name in CHECKS if name in file}
    coefficients, bars = (_read_numbers(file, name) for name in ("coefficients", "error_bar"))
    gradient_bars = _read_numbers(file, "gradient_bar") if "gradient_bar" in file else None
    return StoredTable(names, axes, coefficients, bars, between, about, gradient_bars)


def _read_numbers(file: h5py.File, name: str) -> np.ndarray:
    """Return a numeric dataset as an array; links and external datasets are refused."""
    try:
        return np.asarray(numeric_dataset(get_member(file, name))[()], float)
    except (KeyError, ValueError) as error:
        raise ValueError(f"{name}: {error}") from error


def _read_attributes(file: h5py.File) -> dict[str, Any]:
    """Return the attributes of a table's file by name; ValueError unless they are valid."""
    # Attributes that are positive numbers; all except the first scale the table of a scene.
    positive = ("tolerance", "a", "b", "load", "mu", "shear")
    # Attributes that summarize the measured errors of gradients.
    gradients = (
        "gradient_checks", "gradient_median", "gradient_worst", "gradient_at_rest",
        "gradient_inside",
    )  # fmt: skip
    # Attributes that summarize the errors at the check points.
    error_summary = ("held_out", "held_out_median", "held_out_worst", "held_out_inside")
    # Attributes that are numbers.
    numbers = ("whole", "rounds", "contacts", "cpu_seconds", "widened", *error_summary, *gradients)
    # Attributes that are texts.
    texts = ("format", "axes", "apart", "scaling", "version", "title", "design")
    about: dict[str, Any] = {}
    for name in (*texts, *numbers, *positive):
        if name not in file.attrs:
            continue
        value = about[name] = _decode_attribute(file.attrs[name])
        if name in texts:
            if not isinstance(value, str):
                raise ValueError(f"{name}: {value!r}; allowed: a text")
        elif not isinstance(value, int | float) or not math.isfinite(value):
            raise ValueError(f"{name}: {value!r}; allowed: a finite number")
        elif name in positive and value <= 0.0:
            raise ValueError(f"{name}: {value!r}; allowed: a positive number")
    bars = (*gradients, "gradient_bar")
    for together in (error_summary, CHECKS, bars, ("a", "b", "load", "mu", "shear")):
        missing = [name for name in together if name not in about and name not in file]
        if missing and len(missing) < len(together):
            raise ValueError(f"no {', '.join(missing)}; allowed: all of {', '.join(together)}")
    return about


def _decode_attribute(value: Any) -> Any:
    """Return bytes as str, arrays of one element as scalar, other attributes unchanged."""
    if isinstance(value, np.ndarray | np.generic) and value.size == 1:
        value = value.item()
    return value.decode() if isinstance(value, bytes) else value
