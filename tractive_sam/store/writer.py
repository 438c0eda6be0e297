"""Streams records into a results file that is complete at every time.

At a checkpoint a copy replaces the file (`atomic_rewrite`). The copy contains all records so far
and the state from which rolling resumes. So the file can be read at any time. If the process is
killed, the file contains the history up to a record, and the run resumes from there. `Checkpoints`
schedules the copies. A copy is also made when more than `PENDING_BYTES` wait, and at the end, also
after an exception.
"""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from time import perf_counter
from types import TracebackType
from typing import Self
from uuid import uuid4

import numpy as np

from tractive_sam import interrupt
from tractive_sam.results import Grid, LawRecord, Quantity, Record, widen_field
from tractive_sam.scene import Scene
from tractive_sam.store import layout, tables, write_access
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.layout import set_text
from tractive_sam.store.opening import open_results
from tractive_sam.store.reader import open_history, read_state, write_legacy_history
from tractive_sam.store.write_access import atomic_rewrite


class Checkpoints:
    """Timer of checkpoints that limits the share of the wall time spent on them.

    Parameters
    ----------
    share : float
        Largest share of the wall time; infinite for a checkpoint after every record.
    """

    def __init__(self, share: float = 0.02) -> None:
        self._share, self._next = share, -math.inf

    @property
    def is_due(self) -> bool:
        """Whether it is time for the next checkpoint."""
        return perf_counter() >= self._next

    @contextmanager
    def take(self) -> Iterator[None]:
        """Measure the duration of the block, one checkpoint, and schedule the next one."""
        start = perf_counter()
        yield
        end = perf_counter()
        self._next = end + (end - start) / self._share


PENDING_BYTES = 2**24
"""Largest size of the fields that wait for the next copy, bytes."""


class HistoryWriter:
    """Writer of a results file: appends records, and stores them at checkpoints.

    Parameters
    ----------
    path : path-like
        The file; `sole_writer` reserves it for one run.
    scene : Scene
        The scene that is computed.
    grid : Grid
        The mesh.
    overwrite : bool
        Whether an existing results file may be replaced. A file of another kind is never replaced.
    checkpoints : Checkpoints, optional
        Schedule by which records are written to the disk.
    laws : mapping of str to LawRecord, optional
        `law_records` of the `History`.
    started, measured : str
        See `History`.
    coordinate : Quantity, optional
        The column along which the history runs, of the role `COORDINATE`; by default the scene's.

    Raises
    ------
    ResultsError
        If a file exists that may not be replaced, or the file cannot be written.
    """

    run = "run"
    """Attribute of a file: identifier of the run that writes it."""

    def __init__(
        self,
        path: str | Path,
        scene: Scene,
        grid: Grid,
        overwrite: bool = False,
        checkpoints: Checkpoints | None = None,
        laws: Mapping[str, LawRecord] | None = None,
        coordinate: Quantity | None = None,
        started: str = "",
        measured: str = "",
    ) -> None:
        check_results(Path(path), overwrite)
        self._initialise(path, (len(grid.x), len(grid.y)), checkpoints)
        with atomic_rewrite(self.path, empty=True) as file:
            layout.create_layout(file, scene, grid, laws, coordinate)
            set_text(file["scene"], "started", started)
            set_text(file["scene"], "measured", measured)
            set_text(file["scene"], "datum", "vertex")
            set_text(file, self.run, self._run)

    @classmethod
    def reopen(
        cls,
        path: str | Path,
        scene: Scene | None = None,
        records: int | None = None,
    ) -> Self:
        """Return a writer that drops records after the last resumable one and continues there.

        Parameters
        ----------
        path : path-like
            The file.
        scene : Scene, optional
            The scene from here on; by default the scene of the file.
        records : int, optional
            Number of records when the file was read to be resumed.

        Raises
        ------
        ResultsError
            If the file does not exist, is damaged, has changed since it was read, or cannot be
            written.
        """
        with open_results(Path(path)) as stored:
            stored.verify()
            version = stored.version
        history = open_history(path)
        if records is not None and len(history) != records:
            raise ResultsError(
                f"{path} had {records} records when it was read and has {len(history)} now: "
                "another run writes it; wait for its end, then resume"
            )
        writer = cls.__new__(cls)
        writer._initialise(path, (len(history.x), len(history.y)))
        scene = history.scene if scene is None else scene
        with atomic_rewrite(writer.path, empty=version == 1) as file:
            if version == 1:
                solved = np.flatnonzero(history["converged"] > 0.0)
                count = int(solved[-1]) + 1 if solved.size else 0
                state = read_state(path, count - 1) if count else {}
                write_legacy_history(history, count, state, scene, file)
            else:
                layout.set_scene(file, scene)
                tables.drop_after_state(file)
            layout.set_status(file, *layout.RUNNING)
            layout.set_versions(file, history.provenance)
            set_text(file, cls.run, writer._run)
            writer._pending = len(file["history/record"]), []
        return writer

    def _initialise(
        self, path: str | Path, mesh: tuple[int, int], checkpoints: Checkpoints | None = None
    ) -> None:
        """Set the attributes of a writer without pending records."""
        self.path, self._mesh, self._run = Path(path), mesh, uuid4().hex
        self._checkpoints = checkpoints or Checkpoints()
        # The number of records on disk, and the records that wait: both change at once.
        self._pending: tuple[int, list[Record]] = (0, [])
        self._pending_bytes = 0  # size of the fields of the waiting records
        self._grid: Grid | None = None  # the last mesh
        self._state: tuple[int, Mapping[str, np.ndarray]] | None = None  # last row and its state

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Record in the file what stopped the computation, if there was an exception."""
        if error is None:
            return
        if isinstance(error, KeyboardInterrupt):
            cause = f"interrupted by {error}" if str(error) else "interrupted"
        else:
            cause = f"{type(error).__name__}: {error}".removesuffix(": ")
        # A full disk may have stopped it: the first error then states more than the next.
        with suppress(ResultsError):
            self.finish("stopped early", cause)

    def append(
        self,
        record: Record,
        grid: Grid | None = None,
        state: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        """Append a record in memory; if a checkpoint is due, write all such records to the disk.

        Parameters
        ----------
        record : Record
            The record.
        grid : Grid, optional
            The mesh of the record, if it may be wider than the mesh before, with equal elements;
            stored fields are padded.
        state : mapping of str to ndarray, optional
            Fields from which to resume after the record, by the names of `FIELDS`; stored if the
            contact was solved.

        Raises
        ------
        StorageError
            If the file cannot be written. It stays as it was at the last checkpoint.
        ResultsError
            If another run has taken over the file.
        ValueError
            If the mesh is not wider by equal numbers of elements on opposite sides, or the record
            has another mesh; the record is then not added.
        """
        mesh = self._mesh if grid is None else (len(grid.x), len(grid.y))
        _check_fits(record, self._mesh, mesh)
        self._mesh = mesh
        self._grid = grid or self._grid
        stored, pending = self._pending
        pending.append(record)
        if state is not None and record.values["converged"]:
            self._state = stored + len(pending) - 1, dict(state)
        self._pending_bytes += sum(
            variable.data.nbytes
            for table in record.tables.values()
            for variable in table.variables.values()
        )
        if self._pending_bytes > PENDING_BYTES or self._checkpoints.is_due:
            with self._checkpoints.take():
                self._write()

    def finish(self, status: str, message: str = "") -> None:
        """Write all pending records and the final status to the disk.

        Parameters
        ----------
        status, message : str
            See `History`.

        Raises
        ------
        ResultsError
            See `append`.
        """
        self._write((status, message))

    def _write(self, ended: tuple[str, str] | None = None) -> None:
        """Write pending records, resume state and status to a copy, which replaces the file."""
        with atomic_rewrite(self.path) as file:
            if file.attrs.get(self.run) != self._run.encode():
                cure = "choose a separate file for each run"
                raise ResultsError(f"another run has taken over {self.path}; {cure}")
            if self._grid is not None:
                tables.widen(file, self._grid)
            stored, pending = self._pending
            # Some are in the file already if an interrupt came just after the last replacement.
            pending = pending[len(file["history/record"]) - stored :]
            layout.add_tables(file, pending)
            if pending:
                tables.append(file, pending)
            if self._state is not None:
                tables.put_state(file, *self._state)
            if ended is not None:
                layout.set_status(file, *ended)
            stored = len(file["history/record"])
        self._pending, self._pending_bytes = (stored, []), 0
        self._state = None


def _check_fits(record: Record, before: tuple[int, int], mesh: tuple[int, int]) -> None:
    """Raise a ValueError unless the mesh contains the last one and the record's arrays fit it."""
    widen_field(np.empty(before), mesh)
    for name, quantity in record.columns.items():
        if quantity.dims == ("y",):
            widen_field(np.asarray(record.values[name]), mesh[1:])
    for values in record.fields.values():
        widen_field(values, mesh)


@contextmanager
def results_writer(path: Path, overwrite: bool = False) -> Iterator[None]:
    """Within the block, lock a results file for one run; FileInUseError at once if locked.

    Raises
    ------
    FileInUseError
        If another process writes the file.
    ResultsError
        See `check_results`.
    """
    with interrupt.protect_cleanup(), write_access.sole_writer(path, overwrite, _check_kind):
        yield


def check_results(path: Path, overwrite: bool = False) -> None:
    """Raise a ResultsError unless a results file can be written, before a long computation.

    Raises
    ------
    ResultsError
        See `check_writable`.
    """
    write_access.check_writable(path, overwrite, _check_kind)


def _check_kind(path: Path) -> None:
    """Raise a ResultsError unless an existing file is a results file."""
    with open_results(path):
        pass
