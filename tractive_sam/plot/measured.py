"""Measured points, drawn with the columns of a history that have their names."""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Self

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.description import ShortArrays
from tractive_sam.results import BODIES, History


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(ShortArrays):
    """Measured values along the coordinate of a history.

    Attributes
    ----------
    columns : mapping of str to ndarray
        Values by the name of a column, shape (n,); one of them is the coordinate, such as
        "revolution". Columns of bodies end in the body: "worn_mass B". NaN where nothing was
        measured.

    Examples
    --------
    >>> weighed = {"revolution": np.array([0.0, 2.0]), "worn_mass B": np.array([0.0, 1e-4])}
    >>> measured = plot.Measurements(weighed)
    >>> files = plot.save_all(history, "figures", measured=measured)
    """

    columns: Mapping[str, np.ndarray]

    @classmethod
    def from_file(cls, path: str | PathLike[str]) -> Self:
        """Read a CSV file, whose first line has the names of the columns.

        Raises
        ------
        ValueError
            If the file cannot be read, is not a table, or an entry is not a number.
        """
        try:
            lines = list(csv.reader(Path(path).read_text("utf-8-sig").splitlines()))
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise ValueError(f"{path} cannot be read as CSV: {error}") from None
        names, *rows = [line for line in lines if line] or [[]]
        if not rows or any(len(row) != len(names) for row in rows):
            raise ValueError(
                f"{path} is not a table; allowed: CSV with a line of column names and one line a "
                "point, all of the same length"
            )
        columns = {}
        for k, name in enumerate(map(str.strip, names)):
            try:
                columns[name] = np.array([float(row[k] or "nan") for row in rows])
            except ValueError as error:
                raise ValueError(f"{path}, column {name}: {error}; use numbers") from None
        return cls(columns)

    def check(self, history: History) -> None:
        """Check that a history has the measured columns.

        Raises
        ------
        ValueError
            If the coordinate is missing, or a column is unknown.
        """
        coordinate = history.coordinate.name
        if coordinate not in self.columns:
            raise ValueError(f"measured points: the column {coordinate} is missing; add it")
        known = [*history.of_dims(), *(f"{n} {b}" for n in history.of_dims("body") for b in BODIES)]
        for name in self.columns:
            if name not in known:
                allowed = ", ".join(sorted(known))
                raise ValueError(f"measured points: the column {name} is unknown; use {allowed}")

    def draw(self, axes: Axes, history: History, name: str, divisor: float, **style: Any) -> None:
        """Draw the points of a column, with the rms of their differences in the legend.

        Parameters
        ----------
        axes : Axes
            Axes over the coordinate.
        history : History
            History that is compared.
        name : str
            Name of the column, with its body.
        divisor : float
            Divisor of the values.
        **style
            Style of the markers.
        """
        if name not in self.columns:
            return
        column, _, body = name.partition(" ")
        stored = history[column][:, BODIES.index(body)] if body else history[column]
        course = history[history.coordinate.name]
        places, measured = self.columns[history.coordinate.name], self.columns[name]
        known = np.isfinite(measured) & (places >= course[0]) & (places <= course[-1])
        differences = (np.interp(places[known], course, stored) - measured[known]) / divisor
        rms = math.sqrt(np.mean(differences**2)) if known.any() else math.nan
        label = f"measured, rms of differences {rms:.2g}"
        axes.plot(places, measured / divisor, "x", label=label, clip_on=False, **style)
