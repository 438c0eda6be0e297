"""Reads tables of creep forces."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.store.errors import DamagedError, ResultsError, reason
from tractive_sam.store.hdf5_file import open_to_read

TABLE_FORMAT = "creep-force table 2"
"""What a file says of itself; another number is another version."""


CHECKS = ("check_points", "check_errors", "check_told")
"""Points that were held out: places, errors, and those that the table tells."""


@dataclass(frozen=True, eq=False)
class StoredTable:
    """What a file of a table holds.

    Attributes
    ----------
    names : tuple of str
        Axes.
    axes : tuple of ndarray
        Nodes.
    coefficients, bars : ndarray
        Derivatives and error bars at the nodes.
    between : tuple of ndarray
        Errors of interpolation within the intervals of each axis; empty along an axis of one node.
    about : mapping
        Attributes of the file, and the points that were held out.
    """

    names: tuple[str, ...]
    axes: tuple[np.ndarray, ...]
    coefficients: np.ndarray
    bars: np.ndarray
    between: tuple[np.ndarray, ...]
    about: Mapping[str, Any]


def read_creep_table(path: Path) -> StoredTable:
    """Read the file of a table.

    Raises
    ------
    ResultsError
        If it does not exist, is damaged, no table, or one of another version.
    """
    if not path.is_file():
        cure = f"tractive-sam table TABLE.toml -o {path} writes one, and steel is built in"
        raise ResultsError(f"{path}: there is no such table; {cure}")
    try:
        file = open_to_read(path)
    except OSError as error:
        told = f"{path} cannot be read as a table: {reason(error)}; make it again"
        raise DamagedError(told) from error
    with file:
        kind = str(_plain(file.attrs.get("format", "")))
        if kind != TABLE_FORMAT:
            told = f"a {kind}" if kind.startswith("creep-force") else "no table of creep forces"
            cure = "make it again by tractive-sam table"
            raise ResultsError(f"{path} is {told}; this version reads {TABLE_FORMAT}: {cure}")
        try:
            names = tuple(str(_plain(file.attrs["axes"])).split())
            axes = tuple(file[name][()] for name in names)
            shape = tuple(map(len, axes))
            coefficients, bars = file["coefficients"][()], file["error_bar"][()]
            between = tuple(
                file[f"between_{name}"][()] if n > 1 else np.empty((0, 3))
                for name, n in zip(names, shape, strict=True)
            )
            about = {k: _plain(v) for k, v in file.attrs.items() if not k.startswith("_")}
            about |= {k: file[k][()] for k in CHECKS if k in file}
        except (KeyError, OSError) as error:
            raise DamagedError(f"{path} is damaged ({error}); make it again") from error
        whole = coefficients.shape == (*shape, 2 ** len(shape), 3) and bars.shape == (*shape, 3)
        if not whole or not np.isfinite(coefficients).all() or not np.isfinite(bars).all():
            raise DamagedError(f"{path} is damaged: its arrays do not fit; make it again")
    return StoredTable(names, axes, coefficients, bars, between, about)


def _plain(value: Any) -> Any:
    """An attribute as text or number: netCDF keeps numbers as arrays of one."""
    value = value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
    return value.decode() if isinstance(value, bytes) else value
