"""The folder of a study and its results: a table of its cases, and a dataset.

study.toml                  the study, with its scene
    00012-0123456789abcdef.h5   results of a case: its number when it was first run, and the hash of
                                its scene
    00012-0123456789abcdef.damaged    a results file that could not be read
    0123456789abcdef.txt        why a case failed: the message, and after an empty line the version
                                of this package, the worker and its traceback
    complete.jsonl              last records of complete cases, to be read at once, each
                                with a checksum (see `CaseLog`)

Workers write the results files; the client that runs the study writes all others. There is no other
state: these files determine which cases are complete. Other files are not changed.

A study that keeps scalars has no results files: complete.jsonl has a line for each complete case. A
line is written before the case is reported as complete, and counts only if it agrees with its
checksum.
"""

import csv
import math
import os
import re
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from io import StringIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.description import html_table, text_table
from tractive_sam.extra_packages import xarray
from tractive_sam.extras import check_extra
from tractive_sam.output_file import OutputError, describe_os_error, is_disk_failure, write_file
from tractive_sam.results import BODIES, COLUMNS, History, Quantity, index_by_name
from tractive_sam.safe_text import Html, csv_cell
from tractive_sam.scene import FileContent, hashes_of, use_contents
from tractive_sam.schema import SceneError, SceneWarning
from tractive_sam.store import (
    FileInUseError,
    ResultsError,
    StorageError,
    hold_lock,
    is_written,
    open_history,
    write_netcdf,
)
from tractive_sam.studies.design import DIGEST, Case, CaseLog, Study, cases, title_of
from tractive_sam.studies.worker import COMPLETE, FAILED, CaseOutcome, Task, summary


class Folder:
    """Folder of a study: the study, results files, log of cases, and failures.

    Parameters
    ----------
    path : path-like
        The folder.
    """

    digest_pattern = re.compile(rf"[0-9a-f]{{{DIGEST}}}")

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).absolute()
        self._study, self.log = self.path / "study.toml", CaseLog(self.path / "complete.jsonl")

    @contextmanager
    def lock(self, study: Study) -> Iterator[None]:
        """Within the block, lock the folder for one client; create it, and store the study in it.

        Raises
        ------
        ResultsError
            If it cannot be written, has other files, or another client runs it.
        """
        with ExitStack() as locks:
            try:
                self.path.mkdir(parents=True, exist_ok=True)
                if not self._study.exists() and any(self.path.glob("[!.]*")):
                    message = f"{self.path} contains other files; choose an empty folder"
                    raise ResultsError(message)
                locks.enter_context(hold_lock(self.path / ".client.lock"))
                write_file(self._study, study.to_toml())
            except FileInUseError:
                raise ResultsError(
                    f"{self.path} is being run by another client; wait for it, stop it, or choose "
                    "another folder"
                ) from None
            except FileExistsError:
                raise ResultsError(f"{self.path} is not a folder; choose another") from None
            except OutputError:
                raise
            except OSError as error:
                if is_disk_failure(error):
                    message = f"{self.path} cannot be written: {describe_os_error(error)}"
                    raise StorageError(message) from error
                raise ResultsError(
                    f"{self.path} cannot be written: {error}; choose another folder"
                ) from error
            yield

    def study(self) -> Study:
        """Return the study that is stored in the folder; ResultsError if there is none.

        Raises
        ------
        ResultsError
            If the folder has no study.
        StudyError
            If its file is no longer valid.
        """
        if not self._study.is_file():
            raise ResultsError(
                f"{self.path} is not the folder of a study; tractive-sam study STUDY.toml -o "
                f"{self.path} creates it"
            )
        return Study.from_toml(self._study)

    def results(self) -> dict[str, Path]:
        """Return the results files in the folder, by the hash of their scenes."""
        with os.scandir(self.path) as files:
            names = [file.name for file in files if file.name.endswith(".h5")]
        return {
            name[:-3].partition("-")[2]: self.path / name
            for name in sorted(names)
            if not name.startswith(".")
        }

    def file_of(self, case: Case, results: dict[str, Path]) -> Path:
        """Return the path of the results file of a case, existing or not."""
        return results.get(case.digest, self.path / f"{case.name}.h5")

    def log_complete(self, task: Task, outcome: CaseOutcome) -> None:
        """Log a complete case with its last record, and remove its earlier failure."""
        entry = {
            "digest": task.case.digest,
            "size": 0 if task.file is None else task.file.stat().st_size,
            "version": outcome.version,
            "message": outcome.message,
            "row": outcome.row,
        }
        if files := hashes_of([task.case.scene]):
            entry["files"] = files
        self.log.append(entry)
        self._failure_file(task.case).unlink(missing_ok=True)

    def log_failure(self, case: Case, outcome: CaseOutcome) -> None:
        """Write message, version, worker and traceback of a failed case to its failure file."""
        by = f"tractive-sam {outcome.version or 'of unknown version'} on {outcome.worker or '?'}"
        write_file(self._failure_file(case), f"{outcome.message}\n\n{by}\n{outcome.traceback}")

    def failures(self) -> dict[str, str]:
        """Return the reasons of failed cases, by the hash of their scenes."""
        return {
            file.stem: file.read_text(encoding="utf-8", errors="replace").partition("\n\n")[0]
            for file in self.path.glob("*.txt")
            if self.digest_pattern.fullmatch(file.stem) and file.is_file()
        }

    def _failure_file(self, case: Case) -> Path:
        """Return the path of the file with the reason of a case's failure."""
        return self.path / f"{case.digest}.txt"


RUNNING, INTERRUPTED, WAITING = "running", "interrupted", "waiting"
STATUSES = (COMPLETE, RUNNING, INTERRUPTED, FAILED, WAITING)


@dataclass(frozen=True)
class CaseRow:
    """Result of one case: status, message and the values of its last record.

    Attributes
    ----------
    case : Case
        The case.
    status : str
        One of `STATUSES`.
    message : str
        How it ended; empty if it has not.
    file : Path or None
        Results file of the case, if there is one.
    last : mapping of str to number
        Its last record, by the names of `COLUMNS`, of bodies as ``von_mises_max A``; its totals.
    version : str
        Version of this package that computed it.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> row = ts.study(study, "friction", workers=0).rows[1]
    >>> row.status, row.case.changes
    ('complete', {'friction.mu': 0.4})
    """

    case: Case
    status: str
    message: str = ""
    file: Path | None = None
    last: dict[str, Any] = field(default_factory=dict)
    version: str = ""

    @cached_property
    def _history(self) -> History | None:
        """History of the case, read once; None without a results file."""
        return None if self.file is None else open_history(self.file)

    def record(self, revolution: int | None) -> Mapping[str, float]:
        """Return the quantities of the case at a revolution (None: in its last record).

        Returns
        -------
        mapping of str to number
            Values by name as in `last`; empty if the case has no record of the revolution.
        """
        if revolution is None or self.last.get("revolution") == revolution:
            return self.last
        if self._history is None:
            return {}
        matches = np.flatnonzero(self._history["revolution"] == revolution)
        return summary(self._history, matches[-1]) if matches.size else {}


@dataclass(frozen=True)
class StudyResults:
    """Results of all cases of a study, with tables, figures and files of them.

    Attributes
    ----------
    path : Path
        The folder of the study.
    study : Study
        The study.
    rows : tuple of Row
        The result of each case, in their order.
    damage_note : str
        Note on the log of complete cases if lines of it disagree with their checksums; without a
        results file, their cases count as not computed.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> results = ts.study(study, "friction", workers=0)
    >>> results.counts["complete"]
    2
    >>> results.dataset()["Qx_over_P"].sel({"friction.mu": 0.4}).round(1).item()
    0.3
    >>> results.save_csv("friction.csv")
    >>> results.save_netcdf("friction.nc")
    >>> results.history(1).status
    'done'
    """

    path: Path
    study: Study
    rows: tuple[CaseRow, ...]
    damage_note: str = ""

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        return text_table("Study", self._summary())

    def _repr_html_(self) -> str:
        """Return the summary and a figure of the first varying quantity as HTML, for notebooks."""
        return html_table(self._summary(), self._picture())

    def _summary(self, max_columns: int = 8) -> dict[str, str]:
        """Return title, folder, cases by status and ranges of varied keys as texts by label."""
        counts = ", ".join(f"{n} {status}" for status, n in self.counts.items() if n)
        rows = {"study": self.study.title or self.study.scene.title or "no title"}
        rows |= {"folder": str(self.path), "cases": f"{len(self)}: {counts}"}
        columns = [pair for dim in self.study.dimensions for pair in dim.columns.items()]
        for key, column in columns[:max_columns]:
            first, last = (f"{k:.4g}" if isinstance(k, float) else str(k) for k in _ends(column))
            rows[key] = f"{len(column)} values, {first} to {last}"
        return rows

    def _picture(self) -> Html:
        """Return a figure of the first quantity that varies as HTML; empty without."""
        from tractive_sam.studies.figures import first_figure  # which reads results

        figure = first_figure(self)
        return Html() if figure is None else figure.to_html(380)

    @property
    def complete(self) -> bool:
        """Whether every case is complete."""
        return self.counts[COMPLETE] == len(self.rows)

    @property
    def counts(self) -> dict[str, int]:
        """Number of cases by status, 0 for a status that no case has."""
        statuses = [row.status for row in self.rows]
        return {status: statuses.count(status) for status in STATUSES}

    @property
    def versions(self) -> dict[str, int]:
        """Number of cases by the package version that computed them."""
        return dict(sorted(Counter(row.version for row in self.rows if row.version).items()))

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """Quantities in the last records of the cases that have a description, by name."""
        names = {name: None for row in self.rows for name in row.last}
        return {name: self._described[name] for name in names if name in self._described}

    @cached_property
    def _described(self) -> dict[str, Quantity]:
        """Descriptions of all quantities that records of the study may have, by name."""
        scene = self.rows[0].case.scene if self.rows else self.study.scene
        columns = [column.with_units_of(scene) for column in COLUMNS]
        of_bodies = [
            replace(
                column, name=f"{column.name} {body}", long_name=f"{column.long_name}, body {body}"
            )
            for column in columns
            if column.dims == ("body",)
            for body in BODIES
        ]
        return index_by_name([*(column for column in columns if not column.dims), *of_bodies])

    @cached_property
    def _names(self) -> set[str]:
        """Names of all columns of the last records, with totals and error bars."""
        return {*self._described}.union(*(row.last for row in self.rows))

    def history(self, number: int) -> History:
        """Open the history of a case, by number; ResultsError if it has no results file yet.

        Raises
        ------
        ResultsError
            If it has no results file yet.
        IndexError
            If the case does not exist.
        """
        if not -len(self) <= number < len(self):
            raise IndexError(f"no case {number}; they are numbered from 0 to {len(self) - 1}")
        row = self.rows[number]
        if row.file is None and row.status == COMPLETE:
            cure = 'run it with keep = "all"'
            raise ResultsError(f"{row.case}: the study keeps scalars, no histories; {cure}")
        if row.file is None:
            raise ResultsError(f"{row.case} is {row.status}: it has no results yet")
        return open_history(row.file)

    def column(self, name: str, revolution: int | None = None) -> np.ndarray:
        """Return a quantity of all cases, shape (len(self),); nan if it is unknown.

        Parameters
        ----------
        name : str
            One of `quantities`.
        revolution : int, optional
            Revolution of the record instead of the last one; a study that keeps scalars has only
            the last one.

        Raises
        ------
        KeyError
            If the quantity is unknown; the message lists the known ones.
        """
        if name not in self._names:
            raise KeyError(f"no quantity {name!r}; there are {', '.join(sorted(self._names))}")
        return _column(name, [row.record(revolution) for row in self.rows])

    def values(self, key: str) -> np.ndarray:
        """Return the values of a key of the scene in all cases: numbers, or else texts.

        Raises
        ------
        KeyError
            If the key does not vary; the message lists those that do.
        """
        vary = [key for dim in self.study.dimensions for key in dim.columns]
        if key not in vary:
            raise KeyError(f"{key} does not vary; there are {', '.join(vary)}")
        return _as_array([row.case.changes[key] for row in self.rows])

    def dataset(self, revolution: int | None = None) -> "xarray.Dataset":
        """Return all quantities of the last record, or of a revolution, over the study's axes.

        The dimensions are the keys of the axes, and `SAMPLE` of a Latin hypercube; keys that vary
        together with another one are coordinates as well.

        Parameters
        ----------
        revolution : int, optional
            Revolution of the records instead of the last one of each case; nan if there is none.
        """
        check_extra("xarray", "study results")
        study = self.study
        dims, shape = [dim.name for dim in study.dimensions], study.shape
        coordinates = {
            key: (dim.name, _as_array(column), {"long_name": title_of(key)})
            for dim in study.dimensions
            for key, column in dim.columns.items()
        }
        records = [row.record(revolution) for row in self.rows]
        variables: dict[str, tuple[Any, ...]] = {
            name: (dims, _column(name, records).reshape(shape), quantity.attributes)
            for name, quantity in self.quantities.items()
        }
        for name in ("status", "message"):
            texts = np.array([getattr(row, name) for row in self.rows], dtype=object)
            variables[name] = (dims, texts.astype(str).reshape(shape))
        return xarray.Dataset(variables, coordinates, {"title": study.title or study.scene.title})

    def save_netcdf(self, path: str | PathLike[str]) -> None:
        """Write all quantities of the last records over the study's axes as a netCDF file."""
        write_netcdf(path, self.dataset())

    def save_csv(
        self, path: str | PathLike[str], *, quantities: Sequence[str] = (), units: bool = False
    ) -> None:
        """Write the last records of all cases, one row a case, as CSV with all digits.

        Parameters
        ----------
        path : path-like
            The file.
        quantities : sequence of str
            Columns after the keys that vary, in this order; by default all `quantities`, with
            status, message, file and version of each case.
        units : bool
            Whether headings contain units, as ``Qx [N]``.

        Raises
        ------
        ValueError
            If a quantity is unknown.
        """
        columns = self.columns(quantities=quantities, units=units)
        text = StringIO(newline="")
        writer = csv.writer(text)
        writer.writerow(map(csv_cell, columns))
        for row in zip(*columns.values(), strict=True):
            writer.writerow(map(csv_cell, row))
        write_file(path, text.getvalue())

    def columns(
        self, *, quantities: Sequence[str] = (), units: bool = False
    ) -> dict[str, list[Any]]:
        """Return the columns that `save_csv` writes, by heading: a value for each case.

        Parameters
        ----------
        quantities, units
            See `save_csv`.

        Raises
        ------
        ValueError
            If a quantity is unknown.
        """
        keys = [key for dim in self.study.dimensions for key in dim.columns]
        unknown = [name for name in quantities if name not in self.quantities]
        if unknown:
            available = ", ".join(self.quantities) or "none yet"
            raise ValueError(f"no quantity {', '.join(unknown)}; there are {available}")
        names = list(quantities or self.quantities)
        rows = self.rows
        columns: dict[str, list[Any]] = {"case": [row.case.number for row in rows]}
        columns |= {key: [row.case.changes[key] for row in rows] for key in keys}
        if not quantities:
            columns |= {
                "status": [row.status for row in rows],
                "message": [row.message for row in rows],
                "file": [row.file.name if row.file else "" for row in rows],
                "version": [row.version for row in rows],
            }
        for name in names:
            unit = self.quantities[name].unit if units else "1"
            heading = f"{name} [{unit}]" if unit not in ("", "1") else name
            columns[heading] = [row.last.get(name, "") for row in rows]
        return columns


def _stored_contents(folder: Folder) -> Iterator[FileContent]:
    """Yield the contents of the files that scenes name, from the results files of a study."""
    for file in folder.results().values():
        with suppress(ResultsError):
            yield from (given.content for given in open_history(file).scene.inputs.values())


def open_study(directory: str | PathLike[str]) -> StudyResults:
    """Read the results in the folder of a study, which may still run.

    Parameters
    ----------
    directory : path-like
        Folder of the study.

    Raises
    ------
    ResultsError
        If it is not the folder of a study.
    StudyError
        If the study or a scene is no longer valid: a file is missing, and no results file has its
        content.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> study = ts.Study(scene="spheres", without=["subsurface"], axis=[mu])
    >>> results = ts.study(study, "friction", workers=0)
    >>> ts.open_study("friction").rows == results.rows
    True
    """
    folder = Folder(directory)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)  # printed when it was computed
        try:
            study = folder.study()
            all_cases = cases(study)
        except SceneError:  # a file may be missing whose content the results files have
            with use_contents(_stored_contents(folder), only_missing=True):
                study = folder.study()
                all_cases = cases(study)
    return read_results(folder, study, all_cases)


def read_results(folder: Folder, study: Study, cases: Sequence[Case]) -> StudyResults:
    """Return the results of the cases of a study from its folder.

    Parameters
    ----------
    folder : Folder
        Folder of the study.
    study : Study
        The study.
    cases : sequence of Case
        All its cases.
    """
    files, logged, failures = folder.results(), folder.log.read(), folder.failures()
    rows = []
    for case in cases:
        interrupt.raise_if_interrupted()
        file, entry = folder.file_of(case, files), logged.entries.get(case.digest)
        if entry and study.keep == "scalars" and not entry["size"]:
            rows.append(
                CaseRow(case, COMPLETE, entry["message"], None, entry["row"], entry["version"])
            )
        elif entry and case.digest in files and file.stat().st_size == entry["size"]:
            result = entry["message"], file, entry["row"], entry["version"]
            rows.append(CaseRow(case, COMPLETE, *result))
        else:
            rows.append(_row(case, file, failures.get(case.digest, "")))
    return StudyResults(folder.path, study, tuple(rows), logged.damage_note)


def _ends(column: Sequence[Any]) -> tuple[Any, Any]:
    """Return (smallest, largest) of numbers, or (first, last) of other values."""
    numbers = all(isinstance(value, int | float) for value in column)
    return (min(column), max(column)) if numbers else (column[0], column[-1])


def _row(case: Case, file: Path, failure: str) -> CaseRow:
    """Return the status, message and last record of a case, from its results file if it exists."""
    running = is_written(file)
    if not file.exists():
        status = RUNNING if running else FAILED if failure else WAITING
        return CaseRow(case, status, "" if running else failure)
    try:
        history = open_history(file)
    except ResultsError as error:
        return CaseRow(case, FAILED, str(error), file)
    result = file, summary(history), history.versions.get("tractive-sam", "")
    if history.finished:
        return CaseRow(case, COMPLETE, history.message, *result)
    if running:
        return CaseRow(case, RUNNING, "", *result)
    if failure or history.status != "running":
        return CaseRow(case, FAILED, failure or history.message, *result)
    return CaseRow(case, INTERRUPTED, "", *result)


def _column(name: str, records: Sequence[Mapping[str, float]]) -> np.ndarray:
    """Return a quantity of the records of all cases; nan if it is unknown."""
    return np.array([record.get(name, math.nan) for record in records])


def _as_array(values: Sequence[Any]) -> np.ndarray:
    """Return values as an array of numbers, or of texts if they are no numbers."""
    numbers = all(isinstance(x, int | float) and not isinstance(x, bool) for x in values)
    return np.array(values) if numbers else np.array([str(x) for x in values])
