"""Build a table of creep forces, in this process or on workers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from os import PathLike

from tractive_sam.extras import require_extra
from tractive_sam.lookup import CreepTable
from tractive_sam.store import ResultsError
from tractive_sam.studies import check_installed, local_cluster
from tractive_sam.tables.builder import TableBuilder
from tractive_sam.tables.design import TableDesign
from tractive_sam.tables.opening import is_table, open_table
from tractive_sam.tables.refinement import Refinement, TableProgress
from tractive_sam.tables.solving import Solve, solve_here, solve_on_workers
from tractive_sam.tables.table_contacts import TableContacts


def build_table(
    design: TableDesign | str | PathLike[str],
    path: str | PathLike[str] | None = None,
    progress: Callable[[TableProgress], None] | None = None,
    *,
    scheduler: str | None = None,
    workers: int = 0,
    say: Callable[[str], None] | None = None,
) -> CreepTable:
    """Build a creep-force table from a design, or add gradient error bars to an old table.

    Parameters
    ----------
    design : TableDesign or path-like
        Its design, or the file (TOML) of the design. The file or the name of a table yields this
        table with slopes at rest of fine meshes and error bars of gradients, which older files
        lack; other contacts are not solved again.
    path : path-like, optional
        File to write, netCDF; `open_table` reads it.
    progress : callable, optional
        Called whenever contacts have been solved.
    scheduler : str, optional
        Address of a scheduler of dask.distributed: its workers solve the contacts; others take over
        the contacts of a worker that dies.
    workers : int
        Without a scheduler: number of processes on this machine. With 0 the contacts are solved in
        this process. A script with workers calls it under ``if __name__ == "__main__":``, as the
        workers import the script.
    say : callable, optional
        Called with a message about what is waited for.

    Raises
    ------
    TableError
        With the faults of the design; or if the tolerance needs more nodes or elements than the
        design allows.
    RuntimeError
        If a contact is not solved, or all its workers die.
    ResultsError
        If dask is not installed, or the address is invalid.
    SchedulerLostError
        If the scheduler does not exist or was lost.

    Examples
    --------
    >>> rough = ts.TableDesign(ellipticity=1.0, tolerance=0.2, elements=15)
    >>> table = ts.build_table(rough, "rough.nc")
    >>> f = table(-1e-3, 0.0, 0.0, a=1.0, b=1.0, load=1e3, mu=0.3, shear=8e4)
    >>> bool(f.Qx > 0.0)
    True
    >>> ts.open_table("rough.nc").nodes == table.nodes
    True
    """
    previous: CreepTable | None = None
    if not isinstance(design, TableDesign):
        previous = open_table(design) if is_table(design) else None
        design = TableDesign.from_toml(design) if previous is None else _read_design(previous)
    with _open_solver(design, scheduler, workers, say or (lambda _: None)) as solve:
        contacts = TableContacts(design, solve, progress or (lambda _: None), Refinement())
        builder = TableBuilder(contacts)
        table = builder.build() if previous is None else builder.update(previous)
    if path is not None:
        with require_extra("build_table"):
            from tractive_sam.tables.file import write_table  # noqa: PLC0415 - of an extra

        write_table(table, path)
    return table


@contextmanager
def _open_solver(
    design: TableDesign, scheduler: str | None, workers: int, log: Callable[[str], None]
) -> Iterator[Solve]:
    """Yield a function that solves contacts: in this process, in several, or on a cluster."""
    chosen: AbstractContextManager = nullcontext((scheduler, None))
    if scheduler is not None or workers:
        check_installed()
        chosen = chosen if scheduler is not None else local_cluster(workers)
    with chosen as (address, security):
        yield (
            solve_here(design)
            if address is None
            else solve_on_workers(design, address, security, log)
        )


def _read_design(table: CreepTable) -> TableDesign:
    """Return the design that a table stores; ResultsError if it stores none."""
    if "design" not in table.about:
        raise ResultsError(
            "design: the file of the table has none; build the table from a design (TOML)"
        )
    return TableDesign.from_toml_text(str(table.about["design"]))
