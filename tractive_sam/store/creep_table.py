"""Reads tables of creep forces."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tractive_sam.output_file import describe_os_error
from tractive_sam.store.errors import DamagedError, ResultsError
from tractive_sam.store.hdf5_file import open_to_read
from tractive_sam.store.hdf5_guard import member, numbers_of

TABLE_FORMAT = "creep-force table 2"
"""What a file says of itself; another number is another version."""


CHECKS = ("check_points", "check_errors", "check_told")
"""Points that were held out: places, errors, and those that the table tells."""

HELD_OUT = ("held_out", "held_out_median", "held_out_worst", "held_out_inside")
"""What these points say of the errors of the table."""

GRADIENTS = (
    "gradient_checks", "gradient_median", "gradient_worst", "gradient_at_rest", "gradient_inside",
)  # fmt: skip
"""Summary of the measured errors of gradients."""

TEXTS = ("format", "axes", "apart", "scaling", "version", "title", "design")
"""Attributes that are texts."""

NUMBERS = ("whole", "rounds", "contacts", "cpu_seconds", "widened", *HELD_OUT, *GRADIENTS)
"""Attributes that are numbers."""

POSITIVE = ("tolerance", "a", "b", "load", "mu", "shear")
"""Attributes that are positive numbers; all but the first scale the table of a scene."""


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
    gradient_bars : ndarray or None
        Error bars of gradients; none in files from before they were measured.
    """

    names: tuple[str, ...]
    axes: tuple[np.ndarray, ...]
    coefficients: np.ndarray
    bars: np.ndarray
    between: tuple[np.ndarray, ...]
    about: Mapping[str, Any]
    gradient_bars: np.ndarray | None = None


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
        told = f"{path} cannot be read as a table: {describe_os_error(error)}; make it again"
        raise DamagedError(told) from error
    with file:
        kind = str(_plain(file.attrs.get("format", "")))
        if kind != TABLE_FORMAT:
            told = f"a {kind}" if kind.startswith("creep-force") else "no table of creep forces"
            cure = "make it again by tractive-sam table"
            raise ResultsError(f"{path} is {told}; this version reads {TABLE_FORMAT}: {cure}")
        try:
            return _stored(file)
        except (LookupError, OSError, TypeError, ValueError) as error:
            raise DamagedError(f"{path} is damaged ({error}); make it again") from error


def _stored(file: h5py.File) -> StoredTable:
    """Return what a file holds, be it of shapes that fit or not."""
    about = _about(file)
    names = tuple(about["axes"].split())
    for name in names:
        if not name.isidentifier():  # / would lead into groups
            raise ValueError(f"axes: the name {name!r}; allowed: letters, digits and _")
    axes = tuple(_numbers(file, name) for name in names)
    between = tuple(
        _numbers(file, f"between_{name}") if nodes.size > 1 else np.empty((0, 3))
        for name, nodes in zip(names, axes, strict=True)
    )
    about |= {name: _numbers(file, name) for name in CHECKS if name in file}
    coefficients, bars = (_numbers(file, name) for name in ("coefficients", "error_bar"))
    gradient_bars = _numbers(file, "gradient_bar") if "gradient_bar" in file else None
    return StoredTable(names, axes, coefficients, bars, between, about, gradient_bars)


def _numbers(file: h5py.File, name: str) -> np.ndarray:
    """Read an array of numbers that lies in the file itself."""
    try:
        return numbers_of(member(file, name))[()]
    except (KeyError, ValueError) as error:
        raise ValueError(f"{name}: {error}") from error


def _about(file: h5py.File) -> dict[str, Any]:
    """Read the attributes: texts, and finite numbers, some of which come together or not at all."""
    about: dict[str, Any] = {}
    for name in (*TEXTS, *NUMBERS, *POSITIVE):
        if name not in file.attrs:
            continue
        value = about[name] = _plain(file.attrs[name])
        if name in TEXTS:
            if not isinstance(value, str):
                raise ValueError(f"{name}: {value!r}; allowed: a text")
        elif not isinstance(value, int | float) or not math.isfinite(value):
            raise ValueError(f"{name}: {value!r}; allowed: a finite number")
        elif name in POSITIVE and value <= 0.0:
            raise ValueError(f"{name}: {value!r}; allowed: a positive number")
    bars = (*GRADIENTS, "gradient_bar")
    for together in (HELD_OUT, CHECKS, bars, ("a", "b", "load", "mu", "shear")):
        lacking = [name for name in together if name not in about and name not in file]
        if lacking and len(lacking) < len(together):
            raise ValueError(f"no {', '.join(lacking)}; allowed: all of {', '.join(together)}")
    return about


def _plain(value: Any) -> Any:
    """An attribute as text or number: netCDF keeps numbers as arrays of one."""
    if isinstance(value, np.ndarray | np.generic) and value.size == 1:
        value = value.item()
    return value.decode() if isinstance(value, bytes) else value
