"""Measured values of the data sets, read and checked."""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from tractive_sam.fitting.design import FitError
from tractive_sam.fitting.tables import COORDINATES, DEPTH, Data, Noise
from tractive_sam.input_file import read_columns
from tractive_sam.schema import Fault, shorten, suggest_name


@dataclass(frozen=True, eq=False)
class Measured:
    """Measurements of one data set: settings and records of its rows, values, and noise.

    Attributes
    ----------
    data : Data
        Table that describes the data set.
    settings : tuple of mapping
        Entries that are set in the scene, of each row; of a profile one for all rows.
    places : ndarray, shape (rows,)
        Revolution or distance of each row; nan stands for the last record.
    observed, noise : ndarray, shape (rows, observations)
        Measured values and their standard deviations.
    y : ndarray, shape (rows,)
        Lateral places of a profile, mm; empty otherwise.
    """

    data: Data
    settings: tuple[Mapping[str, float], ...]
    places: np.ndarray
    observed: np.ndarray
    noise: np.ndarray
    y: np.ndarray

    @property
    def points(self) -> int:
        """Number of measured values in the data set."""
        return self.observed.size

    @property
    def abscissa(self) -> tuple[str, np.ndarray]:
        """Name and values of the x axis of figures of this data set, values of shape (rows,)."""
        if self.data.profile:
            return "y", self.y
        for key in self.data.vary:
            column = (
                self.places if key in COORDINATES else np.array([s[key] for s in self.settings])
            )
            return key, column
        return "row", np.arange(len(self.observed), dtype=float)


def read_measured(data: Data, key: str) -> Measured:
    """Read and check the measurements of a data set; faults name its table `key`.

    Parameters
    ----------
    data : Data
        The data set.
    key : str
        Its key in messages, like ``fit.data[0]``.

    Raises
    ------
    FitError
        If columns are missing, have other than finite numbers, or give no noise.
    """
    try:
        columns = _columns_of(data)
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not a text in UTF-8"
        raise FitError(
            [Fault(f"{key}.file", shorten(data.file), f"a readable file ({reason})")]
        ) from None
    except ValueError as error:
        raise FitError(
            [Fault(f"{key}.{_source(data)}", str(error), "a header and columns of equal length")]
        ) from None
    wanted = [*data.vary, *(["y", DEPTH] if data.profile else data.observe)]
    wanted += [data.uncertainty.column] if data.uncertainty.column else []
    faults, numbers = [], {}
    for name in wanted:
        column = data.columns.get(name, name)
        if column not in columns:
            hint = suggest_name(column, columns) if columns else "a header row and columns"
            faults.append(Fault(f"{key}.{_source(data)}", f"no column {shorten(column)}", hint))
            continue
        numbers[name], wrong = _numbers(columns[column])
        if wrong:
            first, text = wrong[0]
            where = f"{shorten(text)} in row {first} of {column}"
            more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
            faults.append(Fault(f"{key}.{_source(data)}", where + more, "finite numbers"))
    if not faults and not len(numbers[wanted[0]]):
        faults.append(Fault(f"{key}.{_source(data)}", "no rows", "a row for each measurement"))
    if faults:
        raise FitError(faults)
    return _measured(data, key, numbers)


def _source(data: Data) -> str:
    """Return the key that gives the data: "file" or "values"."""
    return "file" if data.values is None else "values"


def _measured(data: Data, key: str, numbers: Mapping[str, np.ndarray]) -> Measured:
    """Return the measurements from columns of numbers; FitError for invalid noise or places."""
    names = (DEPTH,) if data.profile else data.observe
    observed = np.stack([numbers[name] for name in names], axis=1)
    noise = _noise_of(data.uncertainty, observed, numbers)
    if not (np.isfinite(noise) & (noise > 0.0)).all():
        row = int(np.argmin((noise > 0.0).all(axis=1))) + 1
        cure = "above 0; a relative noise needs measured values other than 0: { absolute = ... }"
        raise FitError([Fault(f"{key}.noise", f"{noise.min():g} in row {row}", cure)])
    rows = 1 if data.profile else len(observed)
    keys = [name for name in data.vary if name not in COORDINATES]
    settings = tuple({name: float(numbers[name][k]) for name in keys} for k in range(rows))
    place = next((numbers[name] for name in data.vary if name in COORDINATES), None)
    if place is None:
        place = np.full(rows, math.nan if data.at is None else data.at)
    if (place < 0.0).any():
        cure = "revolutions and distances of at least 0"
        raise FitError([Fault(f"{key}.vary", f"{place.min():g}", cure)])
    return Measured(data, settings, place, observed, noise, numbers.get("y", np.empty(0)))


def _noise_of(noise: Noise, observed: np.ndarray, numbers: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return standard deviations of measured values, from a column or by `noise_at`."""
    if noise.column is not None:
        return np.broadcast_to(numbers[noise.column][:, None], observed.shape)
    return noise_at(noise, observed)


def noise_at(noise: Noise, observed: np.ndarray) -> np.ndarray:
    """Return standard deviations: root of the sum of squares of absolute and relative noise."""
    return np.hypot(noise.absolute or 0.0, (noise.relative or 0.0) * np.abs(observed))


def _numbers(cells: Sequence[Any]) -> tuple[np.ndarray, list[tuple[int, Any]]]:
    """Return a column as numbers, and (row from 1, cell) for each cell that is not finite."""
    numbers, wrong = np.full(len(cells), math.nan), []
    for k, cell in enumerate(cells):
        with suppress(TypeError, ValueError):
            numbers[k] = float(cell)
        if not math.isfinite(numbers[k]):
            wrong.append((k + 1, cell))
    return numbers, wrong


def _columns_of(data: Data) -> Mapping[str, Sequence[Any]]:
    """Return the columns of a data set by name, of equal length, with unchecked cells."""
    if data.values is not None:
        columns = {
            name: np.atleast_1d(np.asarray(values, dtype=object)).tolist()
            for name, values in data.values.items()
        }
        lengths = {name: len(values) for name, values in columns.items()}
        if len(set(lengths.values())) > 1:
            raise ValueError(", ".join(f"{n} values of {name}" for name, n in lengths.items()))
        return columns
    return read_columns(str(data.file))
