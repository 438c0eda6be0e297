"""Measured values of the data sets, read and checked, and their standard deviations."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from math import log
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.description import format_with_unit
from tractive_sam.fitting.design import COORDINATES, DEPTH, Data, FitError, Noise
from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError, shorten, suggest_name, warn
from tractive_sam.text_table import (
    TextError,
    TextTable,
    equal_columns,
    find_marks,
    list_first,
    read_table,
)


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """Noise of measured values: absolute, relative to the prediction, or of the logarithm.

    With a relative noise, the standard deviation is one of the predicted value m: if it followed
    the measured value y, low values would weigh more, and the mean of n values y = m (1 + s e)
    would come out as (1 - 2 s^2) m for any n. The fit solves the equations of quasi-likelihood,
    sum (y - m) m' / sd(m)^2 = 0, which are unbiased: the derivative of sd(m) does not appear in
    them (Wedderburn, Biometrika 61 (1974) 439-447).

    Attributes
    ----------
    absolute, relative : ndarray
        Standard deviation, and standard deviation over the predicted value; added in quadrature.
    logarithmic : ndarray
        Standard deviation of the natural logarithm of a value; 0 without a factor.
    """

    smallest = 0.1
    """Smallest prediction over the measured value for the standard deviation: a prediction of zero
    would have none."""

    absolute: np.ndarray
    relative: np.ndarray
    logarithmic: np.ndarray

    @classmethod
    def from_table(cls, noise: Noise, shape: tuple[int, ...], column: Any = None) -> "NoiseModel":
        """Return the noise of values of a shape from its table, and the column that it names."""
        logarithmic = 0.0 if noise.factor is None else log(noise.factor)
        absolute = (noise.absolute or 0.0) if column is None else np.asarray(column)[:, None]
        parts = (absolute, noise.relative or 0.0, logarithmic)
        return cls(*(np.broadcast_to(np.asarray(part, float), shape) for part in parts))

    @classmethod
    def join(cls, models: list["NoiseModel"]) -> "NoiseModel":
        """Return the noise of the values of all models in one row."""
        names = [field.name for field in fields(cls)]
        return cls(*(np.concatenate([getattr(m, name).ravel() for m in models]) for name in names))

    def deviation(self, predicted: np.ndarray, observed: np.ndarray) -> np.ndarray:
        """Return the standard deviations of measured values at predictions, in their unit."""
        size = np.maximum(np.abs(predicted), self.smallest * np.abs(observed))
        linear = np.hypot(self.absolute, self.relative * size)
        is_log = self.logarithmic > 0.0
        return np.where(is_log, self.logarithmic * np.where(is_log, size, 0.0), linear)

    def residuals(
        self, predicted: np.ndarray, observed: np.ndarray, deviation: np.ndarray
    ) -> np.ndarray:
        """Return (predicted - measured) over given standard deviations; of logarithms by a factor.

        A prediction with another sign than a measured value with a factor has the residual nan.
        """
        is_log = self.logarithmic > 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            residuals = (predicted - observed) / deviation
            if is_log.any():
                ratios = np.log(predicted[is_log] / observed[is_log])
                residuals[is_log] = ratios / self.logarithmic[is_log]
        return residuals


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
    observed : ndarray, shape (rows, observations)
        Measured values.
    noise : NoiseModel
        Their noise, each array of the same shape.
    y : ndarray, shape (rows,)
        Lateral places of a profile, mm; empty otherwise.
    """

    data: Data
    settings: tuple[Mapping[str, float], ...]
    places: np.ndarray
    observed: np.ndarray
    noise: NoiseModel
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
            is_place = key in COORDINATES
            return key, self.places if is_place else np.array([s[key] for s in self.settings])
        return "row", np.arange(len(self.observed), dtype=float)


def check_signs(measured: Measured, scenes: Mapping[tuple[int, ...], Scene]) -> None:
    """Raise a SceneError if nearly all measured values have a sign that friction or wear forbids.

    Friction dissipates: a force on A is opposite to the creepage of its direction if there is no
    other. Worn masses and volumes are positive.
    """
    forces = {"Qx": "longitudinal", "Qx_over_P": "longitudinal",
              "Qy": "lateral", "Qy_over_P": "lateral"}  # fmt: skip
    wears = ("worn_mass", "worn_volume", "wear_max")
    for k, name in enumerate(measured.data.observe):
        signs = np.zeros(len(measured.observed))
        for rows, scene in scenes.items():
            slip = forces.get(name)
            signs[list(rows)] = float(name in wears)
            if slip and _has_only_creepage(scene, slip):
                signs[list(rows)] = -np.sign(getattr(scene.creepage, slip) or 0.0)
        observed = measured.observed[:, k]
        noise = measured.noise.deviation(observed, observed)[:, k]
        if len(observed) > 2 and name in wears and "revolution" in measured.data.vary:
            order = np.argsort(measured.places)
            if (np.diff(observed[order]) < 0.0).all():
                cure = "what is worn off, that is the first weighing less the later ones"
                raise SceneError([Fault("columns", f"{name} that falls with the revolution", cure)])
        signs *= np.sign(observed) * (np.abs(observed) > 2.0 * noise)
        if (wrong := int((signs < 0.0).sum())) > 0.8 * np.count_nonzero(signs):
            slip = forces.get(name)
            rule = f"creepage.{slip} < 0 drives A, {name} > 0" if slip else "values above 0"
            columns = [*({f"creepage.{slip}"} & {*measured.data.vary}), name]
            cure = f'{rule}; columns = {{ "{columns[0]}" = "-..." }} reverses the sign of a column'
            raise SceneError([Fault("columns", f"{name} of the wrong sign in {wrong} rows", cure)])


def _has_only_creepage(scene: Scene, name: str) -> bool:
    """Return whether a creepage alone makes half-spaces without relaxation slip, at all times."""
    others = {"longitudinal", "lateral", "spin"} - {name}
    slip, bodies = scene.creepage, (scene.body.A, scene.body.B)
    special = scene.wheel or scene.conformal or scene.transient or scene.duty
    is_plain = not special and not any(body.relaxation for body in bodies)
    return slip is not None and is_plain and not any(getattr(slip, one) for one in others)


def describe_improbable(name: str, measured: Measured) -> Iterator[str]:
    """Yield notes on values of a data set that are improbable whatever the scene is."""
    observed, noise = measured.observed, measured.noise
    data, profile, quantities = measured.data, measured.data.profile, index_by_name(COLUMNS)
    sizes = np.ptp(observed) if profile else np.abs(observed)
    if (noise.deviation(observed, observed) > sizes).all():
        units = ", ".join(format_with_unit(one, quantities[one].unit) for one in data.observe)
        yield f"{name}: the noise is larger than all values of {units}: check its unit"
    for k, column in enumerate(data.observe):
        if column in ("Qx_over_P", "Qy_over_P") and np.median(np.abs(observed[:, k])) > 2.0:
            cure = f'observe = "{column[:2]}" reads a force, in N'
            yield f"{name}: {column} of {np.abs(observed[:, k]).max():g} exceeds friction; {cure}"
    if not profile:
        return
    order = np.argsort(measured.y)
    y, depth = measured.y[order], observed[order, 0]
    ends = max(1, y.size // 10)
    places = np.concatenate((y[:ends], y[-ends:]))
    line = np.polyfit(places, np.concatenate((depth[:ends], depth[-ends:])), 1)
    above = depth - np.polyval(line, y)
    if above.sum() < -0.5 * np.abs(above).sum():
        text = "the track lies above the ends of the trace, as in a file of heights"
        cure = "depth is positive into the body"
        yield f'{name}: {text}: {cure}; columns = {{ depth = "-..." }} reverses the sign'
    if np.ptp(above) > 0.1 * np.ptp(y):
        text = f"depths of {np.ptp(above):.3g} mm on a trace of {np.ptp(y):.3g} mm"
        yield f"{name}: {text}: state the units in the header, depth [um] for example"


def read_measured(data: Data, key: str, others: Sequence[Data] = ()) -> Measured:
    """Read and check the measurements of a data set; faults name its table `key`.

    Parameters
    ----------
    data : Data
        The data set.
    key : str
        Its key in messages, like ``fit.data[0]``.
    others : sequence of Data
        Further data sets, which may read other columns of the same file.

    Raises
    ------
    FitError
        If columns are missing, have other than finite numbers, or give no noise.
    """
    source = f"{key}.{'file' if data.values is None else 'values'}"
    where = f"{Path(data.file).name}: " if data.file else ""
    numbers, faults = {}, []
    try:
        columns = _table_of(data)
        sharing = [data, *(one for one in others if data.file and one.file == data.file)]
        wanted = {(name, one.body) for one in sharing for name in _find_columns(one).values()}
        read = {_locate(columns, *column) for column in wanted}
        for name, column in _find_columns(data).items():
            place = _locate(columns, column, data.body)
            if place is None:
                names = f'{suggest_name(column, columns.labels)}; columns = {{ "{name}" = "..." }}'
                cure = f'{names} names one, and "-..." one of opposite sign'
                faults.append(Fault(source, f"{where}no column {shorten(column)}", cure))
                continue
            try:
                values = columns.column(place, _meaning(data, name))
            except TextError as error:
                faults.append(Fault(source, f"{where}{error.value}", error.allowed))
                continue
            numbers[name] = -values if column.startswith("-") else values
            sizes = np.sort(np.abs(values))
            if find_marks(values).any() or (len(sizes) > 2 and sizes[-1] > 1e3 * sizes[-2] > 0.0):
                row = int(np.argmax(np.abs(values)))
                text = f"{name} = {values[row]:g} in line {columns.lines[row]}"
                warn(f"{where or source}{text}, far from the other values: remove such rows")
    except TextError as error:
        faults.append(Fault(source, f"{where}{error.value}", error.allowed))
    except OSError as error:
        reason = f"a readable file ({error.strerror})"
        faults.append(Fault(source, shorten(data.file), reason))
    if faults:
        raise FitError(faults)
    if unused := [label for k, label in enumerate(columns.labels) if k not in read]:
        warn(f"{where or source + ': '}columns that are not read: {list_first(unused, 5)}")
    return _measured(data, key, numbers)


def _find_columns(data: Data) -> dict[str, str]:
    """Return the columns that a data set reads, by the names of their quantities."""
    names = [*data.vary, *(["y", DEPTH] if data.profile else data.observe)]
    names += [data.uncertainty.column] if data.uncertainty.column else []
    return {name: data.columns.get(name, name) for name in names}


def _locate(table: TextTable, column: str, body: str | None) -> int | None:
    """Return the index of a column by its name, else by its words, which may name the body, too.

    A minus sign before `column` is left out: it reverses the sign of the values. Signs and factors
    in the names of a file remain, so that they are not taken for the quantity itself.
    """

    def words_of(text: str) -> str:
        return re.sub(r"[\s_./,()]+|(?<=[^\W\d])-(?=[^\W\d])", "", text).casefold()

    column = column.removeprefix("-")
    if (place := table.find(column)) is not None:
        return place
    wanted = {words_of(column), words_of(f"{column} {body or ''}")}
    pairs = zip(table.labels, table.names, strict=True)
    found = [k for k, pair in enumerate(pairs) if wanted & {*map(words_of, pair)}]
    if len(found) > 1:
        names = ", ".join(table.labels[k] for k in found)
        raise TextError(f"columns {names} for {column}", f'columns = {{ "{column}" = "..." }}')
    return found[0] if found else None


def _table_of(data: Data) -> TextTable:
    """Return the columns of a data set; TextError if they lack names or differ in length."""
    if data.values is None:
        table = read_table(str(data.file), named=True)
        if note := table.find_unused(table.units):
            warn(f"{Path(str(data.file)).name}: {note}")
        return table
    columns = equal_columns(data.values)
    rows = [[*map(str, row)] for row in np.column_stack([*columns.values()]).tolist()]
    names = tuple(columns)
    return TextTable(rows, [*range(1, len(rows) + 1)], names, names, ("",) * len(names))


def _meaning(data: Data, name: str) -> str:
    """Return the meaning of a column with its unit: of a key of the scene, or a quantity."""
    if name in data.vary and name not in COORDINATES:
        return Scene.find_field(name).title or ""
    quantities = index_by_name(COLUMNS)
    name = data.observe[0] if name == data.uncertainty.column else name
    return f"{name}, {quantities[name].unit if name in quantities else 'mm'}"


def _measured(data: Data, key: str, numbers: Mapping[str, np.ndarray]) -> Measured:
    """Return the measurements from columns of numbers; FitError for invalid noise or places."""
    names = (DEPTH,) if data.profile else data.observe
    observed = np.stack([numbers[name] for name in names], axis=1)
    name = data.uncertainty.column
    column = None if name is None else numbers[name]
    noise = NoiseModel.from_table(data.uncertainty, observed.shape, column)
    deviation = noise.deviation(observed, observed)
    if not (np.isfinite(deviation) & (deviation > 0.0)).all() or (noise.absolute < 0.0).any():
        deviation = np.where(noise.absolute < 0.0, noise.absolute, deviation)
        row = int(np.argmin((deviation > 0.0).all(axis=1))) + 1
        cure = "above 0; a relative noise needs measured values other than 0: { absolute = ... }"
        raise FitError([Fault(f"{key}.noise", f"{deviation.min():g} in row {row}", cure)])
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
