"""Streams records into a results file that is whole at every moment.

Structure changes only on copies that take the place of the file (`replacement`): when it is
created, when its rows run out, when fields are added, when it is finished. In between, rows laid
out before are filled in place, and `/history/committed` is raised after each. So whenever the
process is killed, the file opens and holds every record appended; and it can be read meanwhile.
"""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self
from uuid import uuid4

import numpy as np
from h5py import File

from tractive_sam.results.grid import Grid
from tractive_sam.results.record import Record
from tractive_sam.store import layout, rows
from tractive_sam.store.errors import ResultsError
from tractive_sam.store.opening import results_file
from tractive_sam.store.replacement import open_in_place, replacement
from tractive_sam.store.room import make_room

RUN = "run"
"""Attribute of a file: the run that writes it."""

FIRST_ROWS = 64
"""Rows laid out at first; doubled whenever they are full, so that copying costs little."""


class HistoryWriter:
    """Writes the records of one computation, each on disk when `append` returns.

    Parameters
    ----------
    path : path-like
        The file.
    scene_toml : str
        What is computed.
    grid : Grid
        The mesh.
    reference : mapping of str to float, optional
        Unworn contact by Hertz: "a0", "b0" in mm, "p0" in MPa; what is missing becomes nan.
    overwrite : bool
        Whether a results file there may be replaced. A file of any other kind never is.

    Raises
    ------
    ResultsError
        If there is a file that may not be replaced, or none can be written.
    """

    def __init__(
        self,
        path: str | Path,
        scene_toml: str,
        grid: "Grid",
        reference: Mapping[str, float] | None = None,
        overwrite: bool = False,
    ) -> None:
        self.path = Path(path)
        check_results(self.path, overwrite)
        self._run = uuid4().hex
        try:
            with replacement(self.path, empty=True) as file:
                layout.create(file, scene_toml, grid, reference or {})
                file.attrs[RUN] = self._run
        except OSError as error:
            raise ResultsError(f"{self.path} cannot be written: {error}") from error

    @classmethod
    def reopen(cls, path: str | Path, scene_toml: str | None = None) -> Self:
        """Go on after the last record of an existing results file whose contact was solved.

        Parameters
        ----------
        path : path-like
            The file.
        scene_toml : str, optional
            The scene as it is to be rolled on; by default as it was.

        Raises
        ------
        ResultsError
            If there is no such file, or it cannot be read or written.
        """
        writer = cls.__new__(cls)
        writer.path = Path(path)
        with results_file(writer.path):  # says what is wrong with it
            pass
        writer._run = uuid4().hex
        try:
            with replacement(writer.path) as file:
                if scene_toml is not None:
                    layout.set_scene(file, scene_toml)
                rows.drop_unsolved(file)
                layout.set_status(file, *layout.RUNNING)
                file.attrs[RUN] = writer._run
        except OSError as error:
            raise ResultsError(f"{path} cannot be written: {error}") from error
        return writer

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
            with suppress(OSError, ResultsError):
                self.finish("stopped early", f"{kind.__name__}: {error}".removesuffix(": "))

    def append(
        self,
        record: Record,
        grid: "Grid | None" = None,
        state: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        """Store a record; one that fails or is interrupted leaves no trace.

        Parameters
        ----------
        record : Record
            What is to be kept.
        grid : Grid, optional
            Its mesh, where that may be a wider one of the same elements than the one before; what
            is stored is padded.
        state : mapping of str to ndarray, optional
            Fields from which to go on after it, by the names of `STATE`.

        Raises
        ------
        ResultsError
            If another run has taken over the file.
        ValueError
            If the mesh does not have the same number of elements more on either side.
        """
        with open_in_place(self.path) as file:
            self._check_own(file)
            wider = grid is not None and rows.differs(file, grid)
            fits = not (record.fields or wider or rows.full(file) or layout.lacks(file, record))
            if fits:
                rows.fill(file, record, state)
        if not fits:
            with replacement(self.path) as file:
                self._check_own(file)
                if wider:
                    rows.widen(file, grid)
                layout.add_columns(file, record)
                if rows.full(file):
                    rows.lay_out(file, max(FIRST_ROWS, 2 * rows.committed(file)))
                if record.fields:
                    rows.append_fields(file, record)
                rows.fill(file, record, state)

    def finish(self, status: str, message: str = "") -> None:
        """Say how the computation ended and drop the rows that it did not need.

        Parameters
        ----------
        status, message : str
            As of `History`.
        """
        with replacement(self.path) as file:
            self._check_own(file)
            rows.lay_out(file, rows.committed(file))
            layout.set_status(file, status, message)

    def _check_own(self, file: "File") -> None:
        """Two runs that were given one file must not mix their records."""
        if file.attrs.get(RUN) != self._run:
            cure = "give each run a file of its own"
            raise ResultsError(f"{self.path} was taken over by another run; {cure}")


def check_results(path: Path, overwrite: bool = False) -> None:
    """See that a results file can be written, before what may take long.

    Raises
    ------
    ResultsError
        As by `make_room`.
    """
    make_room(path, overwrite, _check_kind)


def _check_kind(path: Path) -> None:
    with results_file(path):
        pass
