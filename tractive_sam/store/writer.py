"""Streams records into a results file that is whole at every moment.

The file changes only by copies that take its place (`atomic_rewrite`), with all records since the
last one and the state from which rolling goes on. So whenever the process is killed, the file
opens, holds a history up to some record, and goes on from there; and it can be read meanwhile. When
a copy is made `Checkpoints` tells; one is made where `HELD` is waiting, and at the end, also where
that is an exception.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Self
from uuid import uuid4

import numpy as np
from h5py import File

from tractive_sam import interrupt
from tractive_sam.results import Grid, LawRecord, Quantity, Record, widened
from tractive_sam.scene import Scene
from tractive_sam.store import former, layout, rows, writable
from tractive_sam.store.atomic import atomic_rewrite
from tractive_sam.store.checkpoints import Checkpoints
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import results_file
from tractive_sam.store.reader import open_history, state_of
from tractive_sam.store.texts import set_text

HELD = 2**24
"""Most bytes of fields that wait for the next copy."""

RUN = "run"
"""Attribute of a file: the run that writes it."""


class HistoryWriter:
    """Writes the records of one computation.

    Parameters
    ----------
    path : path-like
        The file; `sole_writer` holds it for one run.
    scene : Scene
        What is computed.
    grid : Grid
        The mesh.
    overwrite : bool
        Whether a results file there may be replaced. A file of any other kind never is.
    checkpoints : Checkpoints, optional
        When records are put on disk.
    laws : mapping of str to LawRecord, optional
        `law_records` of the `History`.
    started, measured : str
        As of `History`.
    coordinate : Quantity, optional
        The column along which the history goes, of the role `COORDINATE`; by default the scene's.

    Raises
    ------
    ResultsError
        If there is a file that may not be replaced, or none can be written.
    """

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
        self._begin(path, (len(grid.x), len(grid.y)), checkpoints)
        with atomic_rewrite(self.path, empty=True) as file:
            layout.create(file, scene, grid, laws, coordinate)
            set_text(file["scene"], "started", started)
            set_text(file["scene"], "measured", measured)
            set_text(file["scene"], "datum", "vertex")
            set_text(file, RUN, self._run)

    @classmethod
    def reopen(
        cls,
        path: str | Path,
        scene: Scene | None = None,
        records: int | None = None,
        checkpoints: Checkpoints | None = None,
    ) -> Self:
        """Go on after the last record of an existing results file whose contact was solved.

        Parameters
        ----------
        path : path-like
            The file.
        scene : Scene, optional
            The scene as it is to be rolled on; by default as it was.
        records : int, optional
            Number of records that it held when it was read to be rolled on.
        checkpoints : Checkpoints, optional
            When records are put on disk.

        Raises
        ------
        ResultsError
            If there is no such file, it is damaged anywhere, it holds other records by now, or
            cannot be written.
        """
        with results_file(Path(path)) as stored:
            stored.verify()
            version = stored.version
        history = open_history(path)
        if records is not None and len(history) != records:
            raise ResultsError(
                f"{path} held {records} records when it was read, and now holds {len(history)}: "
                "another run writes it; wait for it, and resume then"
            )
        writer = cls.__new__(cls)
        writer._begin(path, (len(history.x), len(history.y)), checkpoints)
        scene = history.scene if scene is None else scene
        with atomic_rewrite(writer.path, empty=version == 1) as file:
            if version == 1:
                solved = np.flatnonzero(history["converged"] > 0.0)
                count = int(solved[-1]) + 1 if solved.size else 0
                state = state_of(path, count - 1) if count else {}
                former.rewrite(history, count, state, scene, file)
            else:
                layout.set_scene(file, scene)
                rows.drop_after_state(file)
            layout.set_status(file, *layout.RUNNING)
            layout.set_versions(file, history.provenance)
            set_text(file, RUN, writer._run)
            writer._pending = len(file["history/record"]), []
        return writer

    def _begin(
        self, path: str | Path, mesh: tuple[int, int], checkpoints: Checkpoints | None
    ) -> None:
        self.path, self._mesh, self._run = Path(path), mesh, uuid4().hex
        self._checkpoints = checkpoints or Checkpoints()
        # How many records are on disk, and those that are not: both change at once.
        self._pending: tuple[int, list[Record]] = (0, [])
        self._held = 0  # bytes of their fields
        self._grid: Grid | None = None  # the last mesh, and the last state with its row
        self._state: tuple[int, Mapping[str, np.ndarray]] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Say in the file what stopped the computation, if anything did."""
        if error is not None:
            # A full disk may be what stopped it; then the error at hand says more than the next.
            with suppress(ResultsError):
                self.finish("stopped early", _told(error))

    def append(
        self,
        record: Record,
        grid: Grid | None = None,
        state: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        """Add a record; on disk at the next checkpoint.

        Parameters
        ----------
        record : Record
            What is to be kept.
        grid : Grid, optional
            Its mesh, where that may be a wider one of the same elements than the one before; what
            is stored is padded.
        state : mapping of str to ndarray, optional
            Fields from which to go on after it, by the names of `FIELDS`; taken where its contact
            was solved.

        Raises
        ------
        StorageError
            If the disk does not take it. The file is as it was at the last checkpoint.
        ResultsError
            If another run has taken over the file.
        ValueError
            If the mesh does not have the same number of elements more on either side, or the record
            is of another mesh; then it is not added.
        """
        mesh = self._mesh if grid is None else (len(grid.x), len(grid.y))
        _check_fits(record, self._mesh, mesh)
        self._mesh = mesh
        self._grid = grid or self._grid
        kept, pending = self._pending
        pending.append(record)
        if state is not None and record.values["converged"]:
            self._state = kept + len(pending) - 1, dict(state)
        self._held += _bytes(record)
        if self._held > HELD or self._checkpoints.due:
            with self._checkpoints.taken():
                self._write()

    def finish(self, status: str, message: str = "") -> None:
        """Put all records on disk, and say how the computation ended.

        Parameters
        ----------
        status, message : str
            As of `History`.

        Raises
        ------
        ResultsError
            As of `append`.
        """
        self._write((status, message))

    def _write(self, ended: tuple[str, str] | None = None) -> None:
        """Have a copy with all that is pending take the place of the file."""
        with atomic_rewrite(self.path) as file:
            self._check_own(file)
            if self._grid is not None:
                rows.widen(file, self._grid)
            kept, pending = self._pending
            # Some are there already if an interrupt came just after the last copy was put in place.
            pending = pending[len(file["history/record"]) - kept :]
            layout.add_columns(file, pending)
            if pending:
                rows.append(file, pending)
            if self._state is not None:
                rows.put_state(file, *self._state)
            if ended is not None:
                layout.set_status(file, *ended)
            kept = len(file["history/record"])
        self._pending, self._held = (kept, []), 0
        self._state = None

    def _check_own(self, file: File) -> None:
        """Two runs that were given one file must not mix their records."""
        if file.attrs.get(RUN) != self._run.encode():
            cure = "give each run a file of its own"
            raise ResultsError(f"{self.path} was taken over by another run; {cure}")


def _bytes(record: Record) -> int:
    """Size of what is kept of a record beside its numbers."""
    arrays = [*record.fields.values()]
    arrays += [one for plane in record.stress for one in plane.components.values()]
    arrays += [one for c in record.cycles for one in vars(c).values() if np.ndim(one)]
    return sum(one.nbytes for one in arrays)


def _check_fits(record: Record, before: tuple[int, int], mesh: tuple[int, int]) -> None:
    """See that a record is of a mesh that is the one before, or that one with a margin."""
    widened(np.empty(before), mesh)
    for name, one in record.columns.items():
        if one.dims == ("y",):
            widened(np.asarray(record.values[name]), mesh[1:])
    for values in record.fields.values():
        widened(values, mesh)


@contextmanager
def results_writer(path: Path, overwrite: bool = False) -> Iterator[None]:
    """Hold a results file for one run, from the first reading to the last record.

    Raises
    ------
    HeldError
        If another process writes it.
    ResultsError
        As by `check_results`.
    """
    with interrupt.protect_cleanup(), writable.sole_writer(path, overwrite, _check_kind):
        yield


def check_results(path: Path, overwrite: bool = False) -> None:
    """See that a results file can be written, before what may take long.

    Raises
    ------
    ResultsError
        As by `check_writable`.
    """
    writable.check_writable(path, overwrite, _check_kind)


def _check_kind(path: Path) -> None:
    with results_file(path):
        pass


def _told(error: BaseException) -> str:
    """What stopped a computation, for people."""
    if isinstance(error, KeyboardInterrupt):
        return f"interrupted by {error}" if str(error) else "interrupted"
    return f"{type(error).__name__}: {error}".removesuffix(": ")
