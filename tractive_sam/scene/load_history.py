"""A measured load history, and the blocks of a duty cycle that levels make of it."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from io import StringIO
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import AfterValidator

from tractive_sam import input_file
from tractive_sam.schema import (
    Check,
    Fault,
    FilePath,
    Row,
    SceneError,
    Table,
    ValidEntries,
    Whole,
    entry,
    shorten,
    suggest_name,
)

from .duty import Block, BlockCreepage, BlockFriction, BlockLoad
from .gap import named

MOST_LEVELS = 1000
"""Of a column."""

MOST_REVOLUTIONS = 10**12
"""Of a row."""

DOUBTFUL = 0.01
"""Error of the work that is worth a note."""

BY_LEVELS = '"levels": every revolution wears by its own load, and ranges of load roll no distance'

_TABLES: dict[str, type[Table]] = {
    "load": BlockLoad,
    "creepage": BlockCreepage,
    "friction": BlockFriction,
}

COLUMNS = {
    **{key: f"{name}.{key}" for name, table in _TABLES.items() for key in table.model_fields},
    "shift_y": "shift_y",
    "revolutions": "revolutions",
}
"""Columns of a measured load history: the key of each in a block."""

WORK_UNKNOWN = {"approach", "pressure", "force_x", "force_y"}
"""Columns by which the normal load or the creepage is found only where the contact is solved."""

_File = Annotated[FilePath, AfterValidator(lambda path: named(path, (".csv", ".txt")))]


def _found_together(entries: ValidEntries) -> Iterator[Fault]:
    given = entries.given & {"rows", "error", "work_error"}
    if given and not given >= {"rows", "error"}:
        first = min(given)
        yield Fault(first, shorten(entries[first]), "nothing: it is written when the file is read")


class LoadHistory(Table):
    r"""A measured load history, [load_history]: its rows become the blocks of [[duty]].

    Each column is divided into levels of equal width between its extremes; revolutions in the same
    level of every column become one block, with their mean. A relative file is sought from the
    folder of the TOML file, or else from the working folder. What binning did is written beside it
    when the file is read; a results file holds the blocks as well, and needs the file no more.

    Examples
    --------
    >>> from pathlib import Path
    >>> rows = "normal,revolutions\n300,500\n310,400\n450,100\n"
    >>> _ = Path("loads.csv").write_text(rows)
    >>> table = {"file": "loads.csv", "levels": 2}
    >>> spectrum = discs.replace(load_history=table, **{"wear.revolutions": 2000})
    >>> [(one.revolutions, round(one.load.normal, 1)) for one in spectrum.duty]
    [(900, 304.4), (100, 450.0)]
    >>> spectrum.load_history.rows, round(spectrum.load_history.error["normal"], 4)
    (3, 0.0105)
    """

    file: _File = entry(
        "CSV file, a line of names and then numbers: keys of [load], [creepage] and [friction] "
        "such as normal and longitudinal, shift_y, and revolutions that each row stands for, "
        "1 by default; in the units of a scene",
        "the path of a file",
    )
    levels: Whole = entry(
        "levels of each column", f"a whole number from 1 to {MOST_LEVELS}", 8, ge=1, le=MOST_LEVELS
    )
    binning: Literal["levels"] = entry("how rows become blocks", BY_LEVELS, "levels")
    rows: int | None = entry(
        "rows of the file", "not to be given: written when the file is read", None
    )
    error: dict[str, float] | None = entry(
        "of each column, root mean square of what a revolution is off its block, over the largest "
        "magnitude of the column",
        "not to be given: written when the file is read",
        None,
    )
    work_error: float | None = entry(
        "relative error of the mean of |load x creepage| over the revolutions, which Archard's law "
        "wears by in full slip; unknown where columns give pressure, approach or forces",
        "not to be given: written when the file is read",
        None,
    )
    checks: ClassVar[tuple[Check, ...]] = (_found_together,)

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`: the blocks made of the file, and their error."""
        binned = (self.error or {}).items()
        errors = ", ".join(f"{name} {error:.2%}" for name, error in binned if error)
        text = (
            f"{self.rows} rows of {self.file.name} in {len(scene.duty)} blocks by {self.levels} "
            "levels of each column; difference from the block, root mean square over the largest "
            f"value: {errors or 'none'}"
        )
        work = "" if self.work_error is None else f"; load x creepage {self.work_error:.2%}"
        yield Row("load history", text + work, brief=True)

    def __hash__(self) -> int:
        return hash((self.file, self.levels, self.rows))


@dataclass(frozen=True)
class Binned:
    """A measured load history as blocks, and what binning did to it.

    Attributes
    ----------
    blocks : tuple of Block
        The blocks, by ascending level of the first column that varies.
    error : mapping of str to float
        By column, as of `LoadHistory`.
    work_error : float or None
        As of `LoadHistory`.
    rows : int
        Rows that were measured.

    Examples
    --------
    >>> measured = {"normal": [300.0, 310.0, 450.0, 440.0], "longitudinal": [-0.005] * 4}
    >>> binned = ts.blocks_of(measured, levels=2)
    >>> [(one.revolutions, one.load.normal) for one in binned.blocks]
    [(2, 305.0), (2, 445.0)]
    >>> round(binned.error["normal"], 4)
    0.0111
    """

    blocks: tuple[Block, ...]
    error: Mapping[str, float]
    work_error: float | None
    rows: int


def with_blocks(tables: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """The tables of a scene, with the blocks of a load history that is not read yet.

    Raises
    ------
    SceneError
        With what is wrong with it.
    """
    given, blocks = tables.get("load_history"), tables.get("duty")
    if isinstance(blocks, Mapping):
        cure = "a list of blocks, each begins with [[duty]]; a measured file is of [load_history]"
        raise SceneError([Fault("duty", f"one table, {shorten(dict(blocks))}", cure)])
    if given is None:
        return tables
    try:
        asked = given if isinstance(given, LoadHistory) else LoadHistory(**_table(given))
        if blocks is not None:
            if asked.rows is not None:
                return tables
            cure = "one of them: the rows of the history become the blocks"
            raise SceneError([Fault("file", "together with [[duty]]", cure)])
        binned = blocks_of(asked.file, asked.levels)
    except SceneError as error:
        faults = (
            replace(fault, key=fault.key.replace("measured", "file")) for fault in error.faults
        )
        raise SceneError(fault.under("load_history") for fault in faults) from None
    found = {"rows": binned.rows, "error": dict(binned.error), "work_error": binned.work_error}
    return {**tables, "load_history": asked.entries() | found, "duty": binned.blocks}


def _table(given: Any) -> Mapping[Any, Any]:
    if isinstance(given, Mapping):
        return given
    raise SceneError([Fault("file", shorten(given), "a table with a file, and levels")])


def blocks_of(
    measured: str | PathLike[str] | Mapping[str, ArrayLike],
    levels: int = 8,
    binning: str = "levels",
) -> Binned:
    """Make blocks of a measured load history, by levels.

    Each column is divided into levels of equal width between its extremes; revolutions that lie in
    the same level of every column become one block, with their mean. What each revolution was
    counts, not the order of them: wear goes by every revolution, and a cycle is to wear little.

    Parameters
    ----------
    measured : path-like, or mapping of str to array_like
        A CSV file whose first line names its columns, or the columns: keys of [load], [creepage]
        and [friction] such as "normal" and "longitudinal", "shift_y", and "revolutions" that each
        row stands for, one by default. In the units of a scene.
    levels : int
        Levels of each column.
    binning : str
        "levels". Rainflow counts ranges between turning points of a load, which are what fatigue
        goes by; wear goes by the distance rolled at each load, and a range has none.

    Raises
    ------
    SceneError
        With what is wrong with the table; the key is that of the column.

    Examples
    --------
    >>> binned = ts.blocks_of({"normal": [300.0, 450.0], "revolutions": [900, 100]}, levels=2)
    >>> spectrum = discs.replace(duty=binned.blocks, **{"wear.revolutions": 2000})
    >>> spectrum.spectrum.cycle
    1000
    """
    if not isinstance(levels, int) or isinstance(levels, bool) or not 1 <= levels <= MOST_LEVELS:
        allowed = f"a whole number from 1 to {MOST_LEVELS}"
        raise SceneError([Fault("levels", shorten(levels), allowed)])
    if binning != "levels":
        raise SceneError([Fault("binning", shorten(binning), BY_LEVELS)])
    columns = _columns(measured)
    rows = next(iter(columns.values())).size
    given = columns.pop("revolutions", np.ones(rows))
    wrong = given[(given < 1) | (given > MOST_REVOLUTIONS) | (given % 1 != 0)]
    if wrong.size:
        allowed = f"whole numbers from 1 to {MOST_REVOLUTIONS:.0e} in every row"
        raise SceneError([Fault("revolutions", f"{wrong[0]}", allowed)])
    counts = given.astype(int)
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
    tables: dict[str, Any] = {"revolutions": revolutions}
    for name, value in values.items():
        table, _, key = COLUMNS[name].rpartition(".")
        (tables.setdefault(table, {}) if table else tables)[key] = value
    return Block(**tables)


def _levels(values: np.ndarray, levels: int) -> np.ndarray:
    """The level of each value, from 0."""
    low, high = values.min(), values.max()
    if high == low:
        return np.zeros(values.size, int)
    return np.minimum(((values - low) / (high - low) * levels).astype(int), levels - 1)


def _work_error(
    columns: Mapping[str, np.ndarray],
    means: Mapping[str, np.ndarray],
    place: np.ndarray,
    counts: np.ndarray,
) -> float | None:
    """Of the mean product of load and creepage; None where they are not what is given."""
    if WORK_UNKNOWN & columns.keys():
        return None

    def work(of: Mapping[str, np.ndarray]) -> np.ndarray:
        load = of.get("normal", np.ones(1))
        creepage = np.hypot(of.get("longitudinal", np.zeros(1)), of.get("lateral", np.zeros(1)))
        return load * (creepage if {"longitudinal", "lateral"} & of.keys() else 1.0)

    each = np.broadcast_to(work(columns), counts.shape)
    binned = np.broadcast_to(work({k: v[place] for k, v in means.items()}), counts.shape)
    mean = float(np.average(each, weights=counts))
    return abs(float(np.average(binned, weights=counts)) / mean - 1.0) if mean else 0.0


def _columns(measured: str | PathLike[str] | Mapping[str, ArrayLike]) -> dict[str, np.ndarray]:
    """The columns of a table, all of one length and finite."""
    given = measured if isinstance(measured, Mapping) else _read(Path(measured))
    unknown = [name for name in given if name not in COLUMNS]
    if unknown:
        raise SceneError([Fault(n, "a column", suggest_name(n, COLUMNS)) for n in unknown])
    try:
        columns = {name: np.asarray(values, float).ravel() for name, values in given.items()}
    except (ValueError, TypeError):
        raise SceneError([Fault("columns", "no numbers", "numbers in every row")]) from None
    lengths = {one.size for one in columns.values()}
    finite = all(np.isfinite(one).all() for one in columns.values())
    if len(lengths) != 1 or lengths == {0} or not finite or not columns.keys() - {"revolutions"}:
        allowed = "at least one column besides revolutions, of finite numbers, all equally long"
        raise SceneError([Fault("columns", f"{len(columns)} of {sorted(lengths)} rows", allowed)])
    return columns


def _read(path: Path, most: int = 2**29) -> dict[str, list[float]]:
    """Read a CSV file with a line of names; it may have so many bytes, some 20 million rows."""
    try:
        text = input_file.read_text(path, most, "utf-8-sig")
        lines = [(n, row) for n, row in enumerate(csv.reader(StringIO(text)), 1) if row]
    except (OSError, ValueError, csv.Error):
        allowed = "an existing CSV file that can be read: a line of names, then numbers"
        raise SceneError([Fault("measured", shorten(str(path)), allowed)]) from None
    (_, names), *rows = lines or [(0, [])]
    numbers = [_numbers(names, row) or [] for _, row in rows]
    wrong = [line for line, found in zip(lines[1:], numbers, strict=True) if not found]
    if not rows or wrong or ";" in "".join(names):
        n, row = (wrong or lines or [(1, ["nothing"])])[0]
        allowed = "a line of names, then as many numbers in each; commas between, decimal points"
        given = f"{path.name}, line {n}: {shorten(','.join(row))}"
        raise SceneError([Fault("measured", given, allowed)])
    names = [name.strip() for name in names]
    twice = {name: None for name in names if names.count(name) > 1}
    if twice:
        given = f"{path.name} with two columns {', '.join(map(shorten, twice))}"
        raise SceneError([Fault("measured", given, "each column once")])
    return {name: [row[k] for row in numbers] for k, name in enumerate(names)}


def _numbers(names: list[str], row: list[str]) -> list[float] | None:
    """The numbers of a line, one for each name; None where it has others."""
    try:
        return [float(text) for _, text in zip(names, row, strict=True)]
    except ValueError:
        return None
