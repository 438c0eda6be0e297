"""Describe tables of creep forces and their designs, as text and for JSON."""

import math
from os import PathLike
from time import process_time
from typing import Any

import numpy as np

from tractive_sam.description import Description, Section
from tractive_sam.lookup import NAMES, CreepTable, describe_axis, describe_range
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError
from tractive_sam.studies import Axis, Study
from tractive_sam.tables.axis import TableAxis
from tractive_sam.tables.design import TableDesign
from tractive_sam.tables.grid import CreepageGrid
from tractive_sam.tables.refinement import Refinement
from tractive_sam.tables.solving import NODE_SHARE


def is_design(path: str | PathLike[str]) -> bool:
    """Return whether a TOML file has keys of a table design that studies and scenes lack.

    A file with a scene and axes alone may be a study as well, and is not regarded as a design.
    """
    try:
        tables = TableDesign.read_tables(path)
    except SceneError:
        return False
    keys = TableDesign.model_fields.keys() - Study.model_fields.keys() - Scene.model_fields.keys()
    axis_keys = TableAxis.model_fields.keys() - Axis.model_fields.keys()
    axes = tables.get("axis")
    axes = axes if isinstance(axes, list) else []
    return bool(keys & tables.keys()) or any(
        isinstance(axis, dict) and axis_keys & axis.keys() for axis in axes
    )


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
