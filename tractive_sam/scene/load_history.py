"""A measured load history, and the blocks of a load spectrum that are made from it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import AfterValidator

from tractive_sam.schema import (
    Check,
    Fault,
    FilePath,
    Integer,
    Row,
    SceneError,
    Table,
    ValidEntries,
    entry,
    optional,
    shorten,
    suggest_name,
    warn,
)
from tractive_sam.text_table import (
    TextError,
    TextTable,
    equal_columns,
    find_marks,
    list_first,
    parse_number,
    read_table,
)

from .duty import Block, BlockCreepage, BlockFriction, BlockLoad
from .inputs import TEXTS, absolute_path

MAX_LEVELS = 1000
"""Largest number of levels of a column."""

_BY_LEVELS = '"levels": wear depends on the load of every revolution, not on ranges of the load'

_TABLES: dict[str, type[Table]] = {
    "load": BlockLoad,
    "creepage": BlockCreepage,
    "friction": BlockFriction,
}

_COLUMNS = {
    **{key: f"{name}.{key}" for name, table in _TABLES.items() for key in table.model_fields},
    "shift_y": "shift_y",
    "revolutions": "revolutions",
}
"""Key in a block for each column of a measured load history."""

_File = Annotated[FilePath, AfterValidator(lambda path: absolute_path(path, TEXTS))]


def _check_results_of_binning(entries: ValidEntries) -> Iterator[Fault]:
    """Report rows, error or work_error without both rows and error, which only the package sets."""
    keys = entries.given & {"rows", "error", "work_error"}
    if keys and not keys >= {"rows", "error"}:
        first = min(keys)
        yield Fault(
            first, shorten(entries[first]), "nothing: the key is written when the file is read"
        )


class LoadHistory(Table):
    r"""Measured loads in a file, which become the blocks of [[duty]].

    The range of each column is divided into levels of equal width. Revolutions that have the same
    levels in all columns form one block, with the mean values of these revolutions. A relative path
    starts at the folder of the TOML file or, for a scene without a file, at the working folder. The
    errors due to the levels are written into the table when the file is read. A results file
    contains the blocks, so the CSV file is no longer needed.

    Examples
    --------
    >>> from pathlib import Path
    >>> rows = "normal,revolutions\n300,500\n310,400\n450,100\n"
    >>> _ = Path("loads.csv").write_text(rows)
    >>> table = {"file": "loads.csv", "levels": 2}
    >>> spectrum = discs.replace(load_history=table, **{"wear.revolutions": 2000})
    >>> [(block.revolutions, round(block.load.normal, 1)) for block in spectrum.duty]
    [(900, 304.4), (100, 450.0)]
    >>> spectrum.load_history.rows, round(spectrum.load_history.error["normal"], 4)
    (3, 0.0105)
    """

    file: _File = entry(
        "CSV file with a line of column names, followed by rows of numbers in the units of a "
        "scene; columns are keys of [load], [creepage] and [friction], for example normal and "
        "longitudinal, shift_y, and revolutions (number of revolutions that a row represents, 1 "
        "by default)"
    )
    levels: Integer = entry("number of levels of each column", default=8, ge=1, le=MAX_LEVELS)
    binning: Literal["levels"] = entry(
        "method that combines rows into blocks", _BY_LEVELS, "levels"
    )
    rows: int | None = optional(
        "number of rows of the file", "not to be given: written when the file is read"
    )
    error: dict[str, float] | None = optional(
        "error of each column: root mean square of the difference between a revolution and its "
        "block, divided by the largest magnitude of the column",
        "not to be given: written when the file is read",
    )
    work_error: float | None = optional(
        "relative error of the mean of |load x creepage| over the revolutions, to which the wear "
        "in full slip is proportional; unknown if columns give pressure, approach or forces",
        "not to be given: written when the file is read",
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_results_of_binning,)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield a report row: the blocks made from the file, and their errors.

        Parameters as in `Table.describe`.
        """
        binned = (self.error or {}).items()
        errors = ", ".join(f"{name} {error:.2%}" for name, error in binned if error)
        text = (
            f"{self.rows} rows of {self.file.name} in {len(scene.duty)} blocks, {self.levels} "
            "levels of each column; root mean square difference from the block over the largest "
            f"value: {errors or 'none'}"
        )
        work = "" if self.work_error is None else f"; load x creepage {self.work_error:.2%}"
        yield Row("load history", text + work, brief=True)

    def __hash__(self) -> int:
        return hash((self.file, self.levels, self.rows))


@dataclass(frozen=True)
class Binned:
    """Blocks made from a measured load history, and the errors of this simplification.

    Attributes
    ----------
    blocks : tuple of Block
        The blocks, by ascending level of the first column that varies.
    error : mapping of str to float
        Error by column, see `LoadHistory`.
    work_error : float or None
        Error of the work, see `LoadHistory`.
    rows : int
        Number of measured rows.

    Examples
    --------
    >>> measured = {"normal": [300.0, 310.0, 450.0, 440.0], "longitudinal": [-0.005] * 4}
    >>> binned = ts.blocks_of(measured, levels=2)
    >>> [(block.revolutions, block.load.normal) for block in binned.blocks]
    [(2, 305.0), (2, 445.0)]
    >>> round(binned.error["normal"], 4)
    0.0111
    """

    blocks: tuple[Block, ...]
    error: Mapping[str, float]
    work_error: float | None
    rows: int


def add_blocks(tables: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """Return scene tables with blocks made from [load_history]; SceneError if [[duty]] conflicts.

    Raises
    ------
    SceneError
        With the faults of the load history.
    """
    table, blocks = tables.get("load_history"), tables.get("duty")
    if isinstance(blocks, Mapping):
        cure = (
            "a list of blocks, each begins with [[duty]]; a measured file belongs to [load_history]"
        )
        raise SceneError([Fault("duty", f"one table, {shorten(dict(blocks))}", cure)])
    if table is None:
        return tables
    try:
        if not isinstance(table, LoadHistory | Mapping):
            allowed = "a table with the keys file and levels"
            raise SceneError([Fault("file", shorten(table), allowed)])
        history = table if isinstance(table, LoadHistory) else LoadHistory(**table)
        if blocks is not None:
            if history.rows is not None:
                return tables
            cure = "[load_history] or [[duty]]: the rows of the history become the blocks"
            raise SceneError([Fault("file", "with [[duty]]", cure)])
        binned = blocks_of(history.file, history.levels)
        loads = [b.load.normal for b in binned.blocks if b.load.normal is not None]
        scene_load = dict(tables.get("load") or {}).get("normal")
        if loads and isinstance(scene_load, int | float) and 1.0 <= max(loads) < scene_load / 100.0:
            text = f"all loads are below 1 % of load.normal = {scene_load:g}"
            warn(f"load_history: {text}; a header may state normal [kN]")
    except SceneError as error:
        faults = (
            replace(fault, key=fault.key.replace("measured", "file")) for fault in error.faults
        )
        raise SceneError(fault.under("load_history") for fault in faults) from None
    results = {"rows": binned.rows, "error": dict(binned.error), "work_error": binned.work_error}
    return {**tables, "load_history": history.entries() | results, "duty": binned.blocks}


def blocks_of(
    measured: str | PathLike[str] | Mapping[str, ArrayLike],
    levels: int = 8,
    binning: str = "levels",
) -> Binned:
    """Make load blocks from a measured load history, by sorting its rows into levels.

    Each column is divided into levels of equal width between its extremes; revolutions in one
    level of every column become a block, with their mean. The order of the revolutions is lost:
    a cycle must wear little.

    Parameters
    ----------
    measured : path-like, or mapping of str to array_like
        A CSV file with column names in its first line, or the columns: keys of [load], [creepage]
        and [friction], as in "normal" and "longitudinal", "shift_y", and "revolutions" (number of
        revolutions of each row, default 1). In the units of a scene.
    levels : int
        Number of levels of each column.
    binning : str
        "levels". Rainflow counting, as for fatigue, gives ranges of the load; wear depends on the
        distance rolled at each load, which a range does not have.

    Returns
    -------
    Binned
        The blocks and their errors.

    Raises
    ------
    SceneError
        With the faults of the table; the key is the name of the column.

    Examples
    --------
    >>> binned = ts.blocks_of({"normal": [300.0, 450.0], "revolutions": [900, 100]}, levels=2)
    >>> spectrum = discs.replace(duty=binned.blocks, **{"wear.revolutions": 2000})
    >>> spectrum.spectrum.cycle
    1000
    """
    if not isinstance(levels, int) or isinstance(levels, bool) or not 1 <= levels <= MAX_LEVELS:
        raise SceneError([Fault("levels", shorten(levels), f"an integer from 1 to {MAX_LEVELS}")])
    if binning != "levels":
        raise SceneError([Fault("binning", shorten(binning), _BY_LEVELS)])
    columns, lines = _columns(measured)
    _check_values(columns, lines)
    _name_implausible_rows(columns, lines)
    rows = next(iter(columns.values())).size
    values, max_revolutions = columns.pop("revolutions", np.ones(rows)), 10**12
    wrong = values[(values < 1) | (values > max_revolutions) | (values % 1 != 0)]
    if wrong.size:
        allowed = f"integers from 1 to {max_revolutions:.0e} in every row"
        raise SceneError([Fault("revolutions", f"{wrong[0]}", allowed)])
    counts = values.astype(int)
    bins = np.stack([_levels(values, levels) for values in columns.values()], axis=1)
    _, place = np.unique(bins, axis=0, return_inverse=True)
    place = place.ravel()
    total = np.bincount(place, counts)
    means = {name: np.bincount(place, counts * v) / total for name, v in columns.items()}
    blocks = tuple(
        _block({name: float(mean[k]) for name, mean in means.items()}, int(total[k]))
        for k in range(len(total))
    )
    error = {
        name: float(np.sqrt(np.average((v - means[name][place]) ** 2, weights=counts)))
        / (float(np.abs(v).max()) or 1.0)
        for name, v in columns.items()
    }
    return Binned(blocks, error, _work_error(columns, means, place, counts), rows)


def _block(values: dict[str, float], revolutions: int) -> Block:
    """Return the block with the mean values of the columns, for a number of revolutions."""
    tables: dict[str, Any] = {"revolutions": revolutions}
    for name, value in values.items():
        table, _, key = _COLUMNS[name].rpartition(".")
        (tables.setdefault(table, {}) if table else tables)[key] = value
    return Block(**tables)


def _levels(values: np.ndarray, levels: int) -> np.ndarray:
    """Return the index of the level of each value; equal levels divide the range of the values."""
    low, width = values.min(), np.ptp(values) or 1.0
    return np.minimum(((values - low) / width * levels).astype(int), levels - 1)


def _work_error(
    columns: Mapping[str, np.ndarray],
    means: Mapping[str, np.ndarray],
    place: np.ndarray,
    counts: np.ndarray,
) -> float | None:
    """Return the relative error of mean load x creepage due to the blocks; None if unknown.

    Returns
    -------
    float or None
        None if columns give quantities from which load and creepage are known only by a solution.
    """
    if {"approach", "pressure", "force_x", "force_y"} & columns.keys():
        return None

    def work(of_rows: Mapping[str, np.ndarray]) -> np.ndarray:
        load, none = of_rows.get("normal", np.ones(1)), np.zeros(1)
        creepage = np.hypot(of_rows.get("longitudinal", none), of_rows.get("lateral", none))
        return load * (creepage if {"longitudinal", "lateral"} & of_rows.keys() else 1.0)

    each = np.broadcast_to(work(columns), counts.shape)
    binned = np.broadcast_to(work({k: v[place] for k, v in means.items()}), counts.shape)
    mean = float(np.average(each, weights=counts))
    return abs(float(np.average(binned, weights=counts)) / mean - 1.0) if mean else 0.0


def _check_values(columns: Mapping[str, np.ndarray], lines: Sequence[str]) -> None:
    """Raise a SceneError with the first line of each column whose value no block may have."""
    faults = []
    for name, values in columns.items():
        for row in {int(values.argmin()), int(values.argmax())} if name != "revolutions" else ():
            try:
                _block({name: float(values[row])}, 1)
            except SceneError as error:
                value = f"{name} = {values[row]:g} in {lines[row]}"
                allowed = error.faults[0].allowed
                if name in ("normal", "pressure"):
                    allowed += "; without contact there is no wear: remove these rows"
                faults.append(Fault("measured", value, allowed))
    if faults:
        raise SceneError(faults)


def _name_implausible_rows(columns: Mapping[str, np.ndarray], lines: Sequence[str]) -> None:
    """Warn of rows with marks of missing values or single large values, and of tiny loads."""
    for name, values in columns.items():
        if name == "revolutions":
            continue
        sizes, is_mark = np.abs(values), find_marks(values)
        is_mark &= not is_mark.all()
        median = float(np.median(sizes))
        is_peak = (sizes > 20.0 * median) & (median > 0.0)
        is_peak &= is_peak.sum() <= max(1, sizes.size // 100)
        for where, text in (
            (is_mark, "a mark of missing values"),
            (is_peak & ~is_mark, f"more than 20 times the median, {median:.4g}"),
        ):
            rows = np.flatnonzero(where)
            if rows.size:
                places = list_first([lines[row] for row in rows.tolist()], 3)
                value = f"{name} = {values[rows[0]]:g} in {places}"
                warn(f"load_history: {value}, {text}: remove such rows if they are no loads")
    if (largest := float(columns.get("normal", np.ones(1)).max())) < 1.0:
        warn(f"load_history: all loads are at most {largest:g} N; a header may state normal [kN]")


def _columns(
    measured: str | PathLike[str] | Mapping[str, ArrayLike],
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Return columns of a load history as arrays, and the place of each row for messages.

    Raises
    ------
    SceneError
        If a column is unknown, no number, not finite, or shorter than others.
    """
    if not isinstance(measured, Mapping):
        return _read(Path(measured))
    _check_names(measured)
    try:
        columns = equal_columns(measured)
    except TextError as error:
        raise SceneError([Fault("columns", error.value, error.allowed)]) from None
    return columns, [f"row {k + 1}" for k, _ in enumerate(next(iter(columns.values())))]


def _check_names(names: Iterable[str]) -> None:
    """Raise a SceneError for unknown columns, or without any but the number of revolutions."""
    unknown = [name for name in names if name not in _COLUMNS]
    faults = [Fault(name, "an unknown column", suggest_name(name, _COLUMNS)) for name in unknown]
    if not faults and not {*names} - {"revolutions"}:
        faults = [Fault("columns", shorten([*names]), "at least one column besides revolutions")]
    if faults:
        raise SceneError(faults)


def _read(path: Path) -> tuple[dict[str, np.ndarray], list[str]]:
    """Return the columns of a text file by name in units of a scene, and the lines of its rows."""
    columns: dict[str, np.ndarray] = {}
    try:
        table = read_table(path, max_bytes=2**29, named=True)
        times = ("time", "t", "date", "timestamp", "datetime", "clock")
        unused = [name for name in table.names if name.lower() in times]
        used = {name: k for k, name in enumerate(table.names) if name not in unused}
        if len(used) + len(unused) < len(table.names):
            raise TextError(f"columns {', '.join(table.names)}", "each column once")
        note = table.find_unused(table.units)
        _check_names(used)
        for name, place in used.items():
            table_name, _, key = _COLUMNS[name].rpartition(".")
            meaning = _TABLES.get(table_name, Block).model_fields[key].title or ""
            columns[name] = table.column(place, meaning)
    except OSError as error:
        allowed = f"an existing text file of columns with names ({error.strerror})"
        raise SceneError([Fault("measured", shorten(str(path)), allowed)]) from None
    except TextError as error:
        value = f"{path.name}, {error.value}"
        raise SceneError([Fault("measured", value, error.allowed)]) from None
    if unused:
        warn(f"load_history: columns of {path.name} that are not read: {', '.join(unused)}")
    if note:
        warn(f"load_history: {path.name}: {note}")
    if places := _find_restarts(table, unused):
        text = f"rows continue after {places}: all blocks are one history"
        warn(f"load_history: {path.name}: {text}")
    return columns, [f"{path.name}, line {line}" for line in table.lines]


def _find_restarts(table: TextTable, times: Iterable[str]) -> str:
    """Name lines at which a second block may begin: after a gap, or where the time falls."""
    comments = {remark.line for remark in table.remarks} - {*table.lines}
    kinds: dict[str, list[str]] = {"an empty line": [], "a comment": [], "a fall of the time": []}
    for m, n in pairwise(table.lines):
        if n - m > 1:
            kinds["a comment" if {*range(m + 1, n)} <= comments else "an empty line"] += [str(n)]
    for column in map(table.names.index, times):
        clock = [parse_number(row[column], table.decimal) or 0.0 for row in table.rows]
        falls = np.flatnonzero(np.diff(clock) < 0.0) + 1
        kinds["a fall of the time"] += [str(table.lines[k]) for k in falls]
    return " and ".join(
        f"{what} at line {list_first(lines, 3)}"
        for what, lines in kinds.items()
        if lines and len(lines) < max(2, len(table.lines) // 4)
    )
