"""Options of all figures: units, titles, size and measured points."""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, Literal, Self

import numpy as np
from matplotlib.axes import Axes

from tractive_sam.description import ShortArrays, format_unit
from tractive_sam.results import BODIES, COLUMNS, History, index_by_name
from tractive_sam.text_table import read_table


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(ShortArrays):
    """Measured values of columns along the coordinate of a history.

    Attributes
    ----------
    columns : mapping of str to ndarray
        Values by the name of a column, shape (n,); one of them is the coordinate, for example
        "revolution". Columns of bodies end in the body: "worn_mass B". NaN: not measured.

    Examples
    --------
    >>> weighed = {"revolution": np.array([0.0, 2.0]), "worn_mass B": np.array([0.0, 1e-4])}
    >>> measured = plot.Measurements(weighed)
    >>> files = plot.save_all(history, "figures", measured=measured)
    """

    columns: Mapping[str, np.ndarray]

    @classmethod
    def from_file(cls, path: str | PathLike[str]) -> Self:
        """Read measurements from a text file with a header of column names.

        Raises
        ------
        ValueError
            If the file cannot be read, is not a table, or an entry is not a number.
        """
        quantities, columns = index_by_name(COLUMNS), {}
        try:
            table = read_table(path, named=True)
            for place, (name, unit) in enumerate(zip(table.names, table.units, strict=True)):
                quantity = quantities.get(name.partition(" ")[0])
                meaning = quantity.unit if quantity else unit  # `check` refuses unknown columns
                columns[name] = table.column(place, meaning, missing=True)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise ValueError(
                f"{path} is not a table ({reason}); allowed: a text file with a row of column "
                "names and a row for each point"
            ) from None
        return cls(columns)

    def check(self, history: History) -> None:
        """Raise a ValueError unless a history has all measured columns and one is its coordinate.

        Raises
        ------
        ValueError
            If the coordinate is missing, or a column is unknown.
        """
        coordinate = history.coordinate.name
        if coordinate not in self.columns:
            raise ValueError(f"measured points: the column {coordinate} is missing; add it")
        names = [*history.of_dims(), *(f"{n} {b}" for n in history.of_dims("body") for b in BODIES)]
        for name in self.columns:
            if name not in names:
                allowed = ", ".join(sorted(names))
                raise ValueError(f"measured points: the column {name} is unknown; use {allowed}")

    def compared(self, history: History) -> list[str]:
        """Return the names of the columns that are compared: all but the coordinate."""
        return [name for name in self.columns if name != history.coordinate.name]

    def compare(self, history: History, name: str) -> tuple[np.ndarray, np.ndarray, str]:
        """Return coordinates, measured values, and a text with the rms deviation from a column.

        Parameters
        ----------
        history : History
            History that is compared.
        name : str
            Name of the column, with its body.

        Returns
        -------
        places, values : ndarray, shape (n,)
            Coordinates and values of the measured points.
        text : str
            Root mean square of the differences, in the unit of the column.
        """
        column, _, body = name.partition(" ")
        quantity = history.columns[column]
        stored = history[column][:, BODIES.index(body)] if body else history[column]
        course = history[history.coordinate.name]
        places, measured = self.columns[history.coordinate.name], self.columns[name]
        valid = np.isfinite(measured) & (places >= course[0]) & (places <= course[-1])
        differences = np.interp(places[valid], course, stored) - measured[valid]
        rms = math.sqrt(np.mean(differences**2)) if valid.any() else math.nan
        unit = format_unit(quantity.unit)
        return places, measured, f"measured, rms of differences {rms:.2g} {unit}".rstrip()

    def draw(self, axes: Axes, history: History, name: str, divisor: float, **style: Any) -> None:
        """Draw the measured points of a column, with their rms deviation in the legend.

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
        if name in self.columns:
            places, measured, label = self.compare(history, name)
            axes.plot(places, measured / divisor, "x", label=label, clip_on=False, **style)


UNITS = ("hertz", "si-mm")
"""Units of lengths and pressures in figures: over Hertz's, or in mm and MPa."""


@dataclass(frozen=True)
class FigureOptions:
    """Options of figures: units, titles, scale of the sizes, and measured points to draw.

    Attributes
    ----------
    units : str
        One of `UNITS`.
    titles : bool
        Whether figures have titles.
    scale : float
        Width over the usual one; fonts shrink with it, to 60 % at most.
    measured : Measurements, optional
        Points that are drawn with the columns of a history.

    Raises
    ------
    ValueError
        If the units are unknown.
    """

    units: str = "hertz"
    titles: bool = True
    scale: float = 1.0
    measured: Measurements | None = None

    def __post_init__(self) -> None:
        if self.units not in UNITS:
            raise ValueError(f"units is {self.units!r}; allowed: {', '.join(UNITS)}")

    @property
    def font_scale(self) -> float:
        """Size of fonts over the default size, at least 0.6."""
        return max(self.scale, 0.6)


_CURRENT: ContextVar[FigureOptions] = ContextVar("options of figures")


def current_options() -> FigureOptions:
    """Return the figure options in effect."""
    return _CURRENT.get(None) or FigureOptions()


@contextmanager
def change_options(**changes: Any) -> Iterator[None]:
    """Return a context in which figures are drawn with changed options."""
    token = _CURRENT.set(replace(current_options(), **changes))
    try:
        yield
    finally:
        _CURRENT.reset(token)


@contextmanager
def units(name: Literal["hertz", "si-mm"]) -> Iterator[None]:
    """Return a context in which figures use units "hertz" (relative) or "si-mm" (mm, MPa).

    Parameters
    ----------
    name : str
        "hertz", the default, or "si-mm".

    Raises
    ------
    ValueError
        If the units are unknown.

    Examples
    --------
    >>> with plot.units("si-mm"):
    ...     plot.pressure(contact).axes[0].get_ylabel()
    '$y$ (mm)'
    """
    with change_options(units=name):
        yield
