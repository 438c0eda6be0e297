"""What a table is, and what a design asks for, in words."""

from __future__ import annotations

from os import PathLike
from typing import Any

from tractive_sam.lookup import NAMES, CreepTable, describe_axis, describe_range
from tractive_sam.run import explain
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError
from tractive_sam.studies import Axis, Study
from tractive_sam.tables.axis import TableAxis
from tractive_sam.tables.design import TableDesign


def is_design(path: str | PathLike[str]) -> bool:
    """Whether a file is TOML with what only the design of a table has.

    One of a scene and axes alone may be a study as well, and is not told as a design.
    """
    try:
        tables = TableDesign.read_tables(path)
    except SceneError:
        return False
    own = TableDesign.model_fields.keys() - Study.model_fields.keys() - Scene.model_fields.keys()
    of_axis = TableAxis.model_fields.keys() - Axis.model_fields.keys()
    axes = [one for one in _listed(tables.get("axis")) if isinstance(one, dict)]
    return bool(own & tables.keys()) or any(of_axis & one.keys() for one in axes)


def _listed(value: Any) -> list:
    return value if isinstance(value, list) else []


def explain_table(table: CreepTable) -> explain.Explanation:
    """Say what a table holds, how good it is, and how it is called.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.tables import explain_table
    >>> [section.title for section in explain_table(ts.open_table("steel"))]
    ['Table of creep forces', 'Nodes', 'Errors', 'Made by', 'Use']
    """
    return explain.Explanation(explain.Section(*section) for section in table.sections.items())


def explain_design(design: TableDesign) -> explain.Explanation:
    """Say what table a design asks for.

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
    mesh = f"{design.elements} across, {design.finest} where its error bar is too wide"
    return explain.Explanation((
        explain.Section("Table of creep forces", contacts),
        explain.Section("Nodes to begin with", [*nodes, ("at most", str(design.most))]),
        explain.Section(
            "Contacts", [("tolerance", f"{design.tolerance:g} of mu P"), ("elements", mesh)]
        ),
        explain.Section("Make it", [("by", "tractive-sam table FILE.toml -o FILE.nc")]),
    ))  # fmt: skip


def table_as_dict(table: CreepTable) -> dict[str, Any]:
    """What a table tells of itself, as JSON holds it."""
    names = (*table.names, *NAMES)
    told = {k: v for k, v in table.about.items() if isinstance(v, str | int | float)}
    return told | {
        "nodes": table.nodes,
        "axes": {name: nodes.tolist() for name, nodes in zip(names, table.law.axes, strict=True)},
        "between": {
            name: errors.max(axis=1).tolist()
            for name, errors in zip(names, table.between, strict=True)
        },
    }
