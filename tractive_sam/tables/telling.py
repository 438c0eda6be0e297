"""What a table is, and what a design asks for, in words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np

from tractive_sam.lookup import CONTACT, NAMES, RATIO, CreepTable
from tractive_sam.run import explain
from tractive_sam.scene import Scene, SceneError
from tractive_sam.studies import Axis, Study
from tractive_sam.tables.axis import TableAxis
from tractive_sam.tables.design import TableDesign

ANY = "any contact of Hertz of alike bodies, with isotropic friction"
QUARTER = "a quarter of them; the others follow from it by two symmetries"


def is_design(path: str | PathLike[str]) -> bool:
    """Whether a file is TOML with what only the design of a table has.

    One of a scene and axes alone may be a study as well, and is not told as a design.
    """
    try:
        tables = TableDesign.tables_of(path)
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
    about, axes = table.about, dict(zip((*table.names, *NAMES), table.law.axes, strict=True))
    apart = {name for name in axes if name in table.apart}
    of = ANY if table.contact is None else _scaled(table.contact)
    rows = [("of", of), ("creepages", _creepages(table.whole))]
    nodes = [_told_axis(name, nodes, name in apart) for name, nodes in axes.items()]
    errors = [("tolerance", f"{float(about.get('tolerance', math.nan)):g} of mu P")]
    if "held_out" in about:
        errors.append((
            f"{about['held_out']} points held out",
            f"{about['held_out_median']:.1e} of mu P in the median, {about['held_out_worst']:.1e} "
            f"at most; {about['held_out_inside']:.1%} within what the table tells",
        ))  # fmt: skip
    errors.append(("gradients", gradient_quality(about)))
    made = [("version", str(about.get("version", "unknown")))]
    if {"contacts", "cpu_seconds"} <= about.keys():
        spent = f"{about['contacts']} contacts, {about['cpu_seconds']:.3g} s of one core"
        made.append(("solved", spent))
    varying = [one for one in table.names if one != RATIO and len(axes[one]) > 1]
    given = (*(() if table.contact else CONTACT), *varying)
    call = f"table({', '.join(('xi_x', 'xi_y', 'spin', *(f'{one}=...' for one in given)))})"
    return explain.Explanation((
        explain.Section("Table of creep forces", rows),
        explain.Section("Nodes", [*nodes, ("in all", str(table.nodes))]),
        explain.Section("Errors", errors),
        explain.Section("Made by", made),
        explain.Section("Use", [
            ("in Python", f"table = ts.open_table(FILE); {call}"),
            ("elsewhere", "tractive-sam table FILE, with --header, --fmu, --text or --figure"),
        ]),
    ))  # fmt: skip


def gradient_quality(about: Mapping[str, Any]) -> str:
    """Describe the measured errors of a table's gradients."""
    if "gradient_checks" not in about:
        return "errors not measured; tractive-sam table FILE.nc -o NEW.nc measures them"
    return (
        f"at rest within {about['gradient_at_rest']:.1e} of sqrt(K_ii K_jj), K_ii the slopes at "
        f"rest; at {about['gradient_checks']} points {about['gradient_median']:.1e} in the median, "
        f"{about['gradient_worst']:.1e} at most, {about['gradient_inside']:.1%} within error bars"
    )


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
    of = ANY if design.contact is None else _scaled(design.contact)
    whole = not all(design.symmetries)
    axes = zip(design.names, design.first_nodes, strict=True)
    nodes = [_told_axis(name, nodes, name in design.apart) for name, nodes in axes]
    mesh = f"{design.elements} across, {design.finest} where its error bar is too wide"
    return explain.Explanation((
        explain.Section("Table of creep forces", [("of", of), ("creepages", _creepages(whole))]),
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


def _creepages(whole: bool) -> str:
    return "all headings and tilts" if whole else QUARTER


def _scaled(contact) -> str:
    a, b, load, mu, shear = (contact[key] for key in CONTACT)
    scaled = f"a = {a:.4g} mm, b = {b:.4g} mm, P = {load:.4g} N, mu = {mu:g}, G = {shear:.4g} MPa"
    return f"one scene; scaled by {scaled}"


def _told_axis(name: str, nodes: np.ndarray, apart: bool) -> tuple[str, str]:
    if name == RATIO:
        name, nodes = "a/b", np.exp(nodes)
    if len(nodes) == 1:
        return name, f"{nodes[0]:.4g}"
    if apart:
        return name, ", ".join(f"{one:.6g}" for one in nodes) + ", and nothing between them"
    return name, f"{len(nodes)} from {nodes[0]:.4g} to {nodes[-1]:.4g}"
