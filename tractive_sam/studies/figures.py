"""Figures of a study: each quantity over one or two of its axes."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from tractive_sam.description import format_setting
from tractive_sam.plot import (
    Drawing,
    Figure,
    Variable,
    save_drawings,
    study_curves,
    study_map,
    study_samples,
)
from tractive_sam.results import COLUMNS, Quantity, index_by_name
from tractive_sam.scene import CreepageCourse, Scene
from tractive_sam.studies.design import SAMPLE, Study, title_of

DEFAULTS = ("Qx_over_P", "Qy_over_P", "Mz", "p_max", "stick_fraction", "wear_max")
"""Quantities that are drawn by default."""


class Tabulated(Protocol):
    """Protocol of study results for figures: study, rows, quantities and `column`."""

    @property
    def study(self) -> Study:
        """The study: its dimensions, scene and title."""

    @property
    def rows(self) -> Sequence[Any]:
        """Results of its cases, one a case."""

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """Quantities in the last records of the cases, by name."""

    def column(self, name: str) -> np.ndarray:
        """Return the values of a quantity in the last records of all cases, shape (cases,)."""


def save_figures(
    results: Tabulated,
    directory: str | PathLike[str],
    *,
    quantities: tuple[str, ...] = (),
    at: Mapping[str, Any] | None = None,
    format: str = "png",
) -> list[Path]:
    """Draw quantities of the last records over the axes of a study, and save the figures.

    Curves over the longest axis, one for each value of the second longest, and a map over both;
    samples of a Latin hypercube over each of their entries.

    Parameters
    ----------
    results : StudyResults
        Results to draw.
    directory : path-like
        Folder of the figures; it is created if it does not exist.
    quantities : tuple of str
        Names of `Tabulated.quantities`; by default the ones in `DEFAULTS` that vary.
    at : mapping of str to object, optional
        Fixed values of axes, by key; they are needed if more than two axes vary. The titles and
        the names of the files contain them.
    format : str
        One of `plot.FORMATS`.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    ValueError
        If a quantity, axis or value is unknown, or more than two axes vary.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> results = ts.study(study, "friction", workers=0)
    >>> for path in ts.studies.save_figures(results, "figures", quantities=("Qx_over_P",)):
    ...     print(path.name)
    Qx_over_P-curve.png
    """
    drawings = study_figures(results, quantities=quantities, at=at)
    return save_drawings(drawings, directory, format)


def study_figures(
    results: Tabulated, *, quantities: tuple[str, ...] = (), at: Mapping[str, Any] | None = None
) -> Iterator[Drawing]:
    """Yield the figures that `save_figures` saves, to be drawn; raise its errors.

    Parameters
    ----------
    results, quantities, at
        See `save_figures`.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> results = ts.study(study, "friction", workers=0)
    >>> drawings = ts.studies.study_figures(results, quantities=("Qx_over_P",))
    >>> [drawing.name for drawing in drawings]
    ['Qx_over_P-curve']
    """
    unknown = [name for name in quantities if name not in results.quantities]
    if unknown:
        available = ", ".join(results.quantities) or "none yet"
        raise ValueError(f"no quantity {', '.join(unknown)}; there are {available}")
    index = _fix_axes(results, at or {})
    names = quantities or [name for name in DEFAULTS if _varies(results, name)]
    fixed = {short_key(key, results.study): value for key, value in (at or {}).items()}
    named = ", ".join(f"{key} = {value}" for key, value in fixed.items())
    title = "\n".join(filter(None, (results.study.title or results.study.scene.title, named)))
    places = [re.sub(r"[^\w.+-]", "_", f"{key}{value}") for key, value in fixed.items()]
    for name in names:
        for kind, draw in _figures(results, name, index, title):
            stem = "-".join((name.replace(" ", "-"), kind, *places))
            caption = f"{results.quantities[name].long_name}, in the last record of each case."
            yield Drawing(stem, caption[0].upper() + caption[1:], draw)


def first_figure(results: Tabulated) -> Figure | None:
    """Return a figure of the first varying quantity; None if none varies, or too many axes do."""
    try:
        index = _fix_axes(results, {})
        names = [name for name in DEFAULTS if name in results.quantities and _varies(results, name)]
        title = results.study.title or results.study.scene.title
        return next(draw() for name in names for _, draw in _figures(results, name, index, title))
    except (StopIteration, ValueError):  # too few cases as yet, or too many axes
        return None


def short_key(key: str, study: Study) -> str:
    """Return the last part of a key, or all of it if it is not unique in the study."""
    last = [dim.name.rpartition(".")[2] for dim in study.dimensions]
    short = key.rpartition(".")[2]
    return short if last.count(short) == 1 else key


def _fix_axes(results: Tabulated, at: Mapping[str, Any]) -> tuple[int | slice, ...]:
    """Return an index into the cases with the axes `at` fixed; ValueError if > 2 axes remain."""
    dimensions = results.study.dimensions
    names = [dim.name for dim in dimensions]
    unknown = [key for key in at if key not in names]
    if unknown:
        raise ValueError(f"no axis {', '.join(unknown)}; there are {', '.join(names)}")
    index: list[int | slice] = []
    for dim in dimensions:
        if dim.name not in at:
            index.append(slice(None))
            continue
        column = range(len(dim)) if dim.name == SAMPLE else dim.columns[dim.name]
        if at[dim.name] not in column:
            values = ", ".join(map(str, column))
            raise ValueError(f"{dim.name} has no value {at[dim.name]}; it has {values}")
        index.append(list(column).index(at[dim.name]))
    free = [n for n, k in zip(names, index, strict=True) if isinstance(k, slice)]
    # A sample has several keys itself.
    max_free = 1 if SAMPLE in free else 2
    if not 1 <= len(free) <= max_free:
        raise ValueError(
            f"{len(free)} axes vary, {', '.join(free) or 'none'}; fix all but {max_free}, each at "
            "one of its values: --at KEY=VALUE, in Python at={key: value}"
        )
    return tuple(index)


def _varies(results: Tabulated, name: str) -> bool:
    """Return whether a quantity varies among the cases, by more than 1e-6 of its scale."""
    # Relative variation of a quantity below which it is constant, within the errors of solvers.
    noise = 1e-6
    values = results.column(name)
    values = values[np.isfinite(values)]
    return bool(values.size) and bool(np.ptp(values) > noise * _size(results, name))


def _size(results: Tabulated, name: str) -> float:
    """Return the scale of a quantity: 1 for ratios, P times half width for Mz, else its maximum."""
    if name == "Mz":
        return float(np.nanmax(results.column("P") * results.column("half_width_x")))
    if name in ("Qx_over_P", "Qy_over_P", "stick_fraction"):
        return 1.0
    return float(np.nanmax(np.abs(results.column(name))))


def _figures(
    results: Tabulated, name: str, index: tuple, title: str
) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """Yield (kind, function that draws) of a quantity over one or two axes, or over samples."""
    free = [
        dim for dim, k in zip(results.study.dimensions, index, strict=True) if isinstance(k, slice)
    ]
    about = results.quantities[name]
    values = results.column(name).reshape(results.study.shape)[index]
    quantity = Variable(name, values, about.long_name, about.unit)
    scene = results.rows[0].case.scene
    if free[0].name == SAMPLE:
        variables = {key: axis_variable(free[0].columns, scene, key) for key in free[0].columns}
        yield "samples", partial(study_samples, variables, quantity, title=title)
        return
    if len(free) == 1:
        x = axis_variable(free[0].columns, scene)
        yield "curve", partial(study_curves, x, quantity, title=title)
        return
    if len(free[0]) < len(free[1]):
        free, quantity = free[::-1], replace(quantity, values=values.T)
    x, over = (axis_variable(dim.columns, scene) for dim in free)
    yield "curves", partial(study_curves, x, quantity, over, title=title)
    yield "map", partial(study_map, x, over, quantity, title=title)


def axis_variable(columns: Mapping[str, tuple], scene: Scene, key: str | None = None) -> Variable:
    """Return the values of a key (default: the axis's own), numbers or texts, for figures."""
    key = key or next(iter(columns))
    numbers = all(isinstance(value, int | float) for value in columns[key])
    values = np.array(columns[key] if numbers else distinct_texts(columns[key]))
    table, _, name = key.rpartition(".")
    meaning = title_of(key)
    if table == "transient.creepage":
        shifts = scene.schedule.shifts
        meaning = CreepageCourse.shifts[name] if shifts else title_of(f"creepage.{name}")
    meaning = re.split("; |, or |, for ", meaning)[0]  # without conditions: a label is short
    return Variable(key, values, meaning, _unit(key, scene))


def distinct_texts(column: tuple) -> list[str]:
    """Return values as texts; equal texts get their indices."""
    texts = [format_setting(value) for value in column]
    return [f"{k}: {text}" if texts.count(text) > 1 else text for k, text in enumerate(texts)]


def _unit(key: str, scene: Scene) -> str:
    """Return the unit of a key that has a symbol in figures; empty for other keys."""
    units = {
        name: quantity.with_units_of(scene).unit
        for name, quantity in index_by_name(COLUMNS).items()
    }
    of_entries = {
        "load.normal": units["P"],
        "load.pressure": units["p_max"],
        "creepage.spin": units["spin"],
        "friction.angle": "degrees",
    }
    return of_entries.get(key.rpartition("].")[2], "")
