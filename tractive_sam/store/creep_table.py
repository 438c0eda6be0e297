"""Reads the files of creep-force tables."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tractive_sam.store.errors import ResultsError
from tractive_sam.store.hdf5_guard import get_member, numeric_dataset
from tractive_sam.store.netcdf import open_netcdf

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
        return numeric_dataset(get_member(file, name))[()]
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
