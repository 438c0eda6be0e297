"""Build and describe tables of creep forces, in this process or on workers."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from os import PathLike
from time import process_time
from typing import Any

import numpy as np

from tractive_sam.description import Description, Section
from tractive_sam.extras import require_extra
from tractive_sam.lookup import NAMES, CreepTable, describe_axis, describe_range
from tractive_sam.store import ResultsError
from tractive_sam.studies import open_workers
from tractive_sam.tables.builder import TableBuilder
from tractive_sam.tables.design import TableDesign
from tractive_sam.tables.solving import (
    NODE_SHARE,
    CreepageGrid,
    Refinement,
    Solve,
    TableContacts,
    TableProgress,
    check_files,
    solve_here,
    solve_on_workers,
)
from tractive_sam.tables.table_file import is_table, open_table


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
        If workers cannot start, or, with a scheduler, if dask is not installed or the address is
        invalid.
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
            from tractive_sam.tables.table_file import write_table  # noqa: PLC0415 - of an extra

        write_table(table, path)
    return table


@contextmanager
def _open_solver(
    design: TableDesign, scheduler: str | None, workers: int, log: Callable[[str], None]
) -> Iterator[Solve]:
    """Yield a function that solves contacts: in this process, in several, or on a cluster."""
    if scheduler is None and not workers:
        yield solve_here(design)
        return
    with open_workers(workers, scheduler, log) as pool:
        yield solve_on_workers(design, pool)


def _read_design(table: CreepTable) -> TableDesign:
    """Return the design that a table stores; ResultsError if none, SceneError for other files."""
    if "design" not in table.about:
        raise ResultsError(
            "design: the file of the table has none; build the table from a design (TOML)"
        )
    design = TableDesign.from_toml_text(str(table.about["design"]))
    check_files(json.loads(str(table.about.get("files", "{}"))), design.files)
    return design


def explain_table(table: CreepTable) -> Description:
    """Return sections that describe a creep-force table: axes, errors, example of a call.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.tables import explain_table
    >>> [section.title for section in explain_table(ts.open_table("steel"))]
    ['Table of creep forces', 'Nodes', 'Errors', 'Made by', 'Use']
    """
    return table.description


def explain_design(design: TableDesign) -> Description:
    """Return sections that describe the table that a design requests, and its work.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.tables import explain_design
    >>> design = ts.TableDesign(ellipticity=[0.5, 1.0], tolerance=0.05)
    >>> explain_design(design)[1].rows[0]
    ('a/b', '2 from 0.5 to 1')
    """
    contacts = describe_range(design.contact, not all(design.symmetries))
    axes = zip(design.names, design.first_nodes, strict=True)
    nodes = [describe_axis(name, nodes, name in design.apart) for name, nodes in axes]
    mesh = f"{design.elements} across, up to {design.finest} until the error bar is small enough"
    return Description((
        Section("Table of creep forces", contacts),
        Section("Nodes to begin with", [*nodes, ("at most", str(design.most))]),
        Section("Contacts", [("tolerance", f"{design.tolerance:g} of mu P"), ("elements", mesh)]),
        Section("Work", _describe_work(design)),
        Section("Make it", [("by", "tractive-sam table FILE.toml -o FILE.nc")]),
    ))  # fmt: skip


def _describe_work(design: TableDesign) -> list[tuple[str, str]]:
    """Return rows that estimate the time to build a table, by solving two nodes now."""
    contacts = design.contacts(tuple(float(nodes[0]) for nodes in design.first_nodes))
    wanted = NODE_SHARE * design.tolerance
    for w in ((0.5, 0.2, 0.1), (0.6, 0.2, 0.1)):  # the first one also loads kernels
        began = process_time()
        contacts.solve(np.array(w), design.elements, design.finest, wanted)
        seconds = process_time() - began
    quarter = CreepageGrid(*design.symmetries)
    lengths = [len(nodes) for nodes in (*design.first_nodes, *quarter.first)]
    first = math.prod(lengths) * len(Refinement().first_u)
    return [
        ("a node", f"about {seconds:.2g} s of one core"),
        (f"{first} nodes to begin with", f"about {first * seconds / 3600.0:.2g} core-hours"),
        (f"{design.most} nodes at most", f"about {design.most * seconds / 3600.0:.2g} core-hours"),
    ]


def table_as_dict(table: CreepTable) -> dict[str, Any]:
    """Return the description of a table, its axes and errors as JSON types."""
    names = (*table.names, *NAMES)
    about = {k: v for k, v in table.about.items() if isinstance(v, str | int | float)}
    return about | {
        "nodes": table.nodes,
        "axes": {name: nodes.tolist() for name, nodes in zip(names, table.law.axes, strict=True)},
        "between": {
            name: errors.max(axis=1).tolist()
            for name, errors in zip(names, table.between, strict=True)
        },
    }
