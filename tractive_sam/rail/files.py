"""Profile files: two columns, as instruments and vehicle programs write them."""

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np

from tractive_sam.input_file import read_text
from tractive_sam.output_file import write_file
from tractive_sam.text_table import (
    Remark,
    TextTable,
    find_length_unit,
    list_first,
    parse_number,
    parse_table,
)

from .measured import UNITS, Kind, from_measurement
from .profile import Array, Profile

SECTIONS = ".slcs"
"""Suffix of a file of sections of a rail."""

SUFFIXES = (
    *(".prw", ".prr", ".wheel", ".rail", ".whl", ".ban", ".whe", ".rai", ".csv", ".txt", ".dat"),
    SECTIONS,
)
"""Suffixes of profile files, in lower or upper case. All are text with a point on each line."""

Side = Literal["left", "right"]
"""Sides of a file with the profiles of both sides."""


class ProfileError(ValueError):
    """Error of a profile file that cannot be used."""


def read_profile(
    path: str | PathLike[str],
    kind: Kind,
    unit: str | None = None,
    smoothing: float | None = None,
    *,
    mirror: bool = False,
    side: Side | None = None,
) -> Profile:
    """Read a wheel or rail profile; raise ProfileError if it is unusable.

    A line of a file is a point: lateral position and height. A heading with the names y and z, or x
    and y, or ``ColumnDef`` of Miniprof, chooses the columns. The flange shows which side of a wheel
    is inside and which is down; a rail ends on its flanks, and its y points away from the track
    centre unless `mirror` is set. Shifts, limits, units and mirrors in the heading of SIMPACK and
    Miniprof files are applied. What is stated and not used is a note of the profile (its `notes`),
    or an error.

    Parameters
    ----------
    path : path-like
        The file.
    kind : {"wheel", "rail", "section"}
        Kind of the profile; "section" is one of several sections of a rail.
    unit : {"mm", "m", "in", "cm", "um"}, optional
        Unit of lengths; by default the unit in the file, or mm.
    smoothing : float, optional
        Root mean square distance of a cubic smoothing spline from the points, mm; 0 interpolates
        the points. By default they are interpolated, and smoothed only if they scatter as the last
        printed digit makes them.
    mirror : bool
        Whether y of the file runs the other way: of a rail, towards the track centre.
    side : {"left", "right"}, optional
        Side that is read from a file with four columns, y and z of the left and the right side. If
        their y run in opposite directions, y of the left side is mirrored.

    Raises
    ------
    ProfileError
        If the file cannot be read, or its points are not a profile; the message states the line or
        the place, and what is allowed.
    """
    try:
        text = read_text(path, max_bytes=10**7, encoding=None)
    except (OSError, UnicodeDecodeError) as error:
        raise ProfileError(f"{path}: cannot be read: {error}") from None
    try:
        parts = re.split(r"^[ \t]*point\.(?:begin|end)\b", text, flags=re.MULTILINE)
        if len(parts) > 1:
            points, inside, notes = _read_simpack(parts, kind, unit, side)
        else:
            (points, notes), inside = _read_columns(parse_table(text), unit, side), None
        if mirror:
            points = points * (-1.0, 1.0)
        profile = from_measurement(points, kind, smoothing, inside)
    except ValueError as error:
        raise ProfileError(f"{path}: {error}") from None
    return replace(profile, notes=(*notes, *profile.notes))


def _read_simpack(
    parts: list[str], kind: Kind, unit: str | None, side: Side | None
) -> tuple[Array, Array, list[str]]:
    """Return points, mm, which of them count, and notes, from a SIMPACK file.

    Parameters
    ----------
    parts : list of str
        Its text before, within and after the block of points.
    kind, unit, side
        See `read_profile`.
    """
    if len(parts) != 3:
        cure = "allowed: one block from point.begin to point.end; the file may be cut off"
        raise ValueError(f"{len(parts) - 1} marks point.begin and point.end; {cure}")
    if side is not None:
        raise ValueError(f"side = {side}, and one profile; allowed: no side")
    used = r"shift\.[yz]|rotate|bound\.[yz]\.(min|max)|mirror\.[yz]|inversion|point\.dist\.min"
    used += r"|units\.(len|ang)(\.f)?|header\.(type|version)"
    first = parts[0].count("\n") + 1  # line of the points
    section, keys, unused = "", dict[str, str](), list[Remark]()
    for line in (parts[0] + parts[2]).splitlines():
        content, _, remark = line.strip().partition("!")
        content = content.strip()
        unused.append(Remark(0, remark.strip()))
        if mark := re.fullmatch(r"(\w+)\.(begin|end)", content):
            section = mark[1] if mark[2] == "begin" else ""
            continue
        entry = re.fullmatch(r"([\w.]+)\s*=\s*(.*)", content)
        key = ("header." * (section == "header") + entry[1]) if entry else ""
        if entry and re.fullmatch(used, key):
            _state(keys, key, entry[2].strip(" '\""))
        else:
            unused.append(Remark(0, content.lstrip("#% ")))
    stated = _read_number(keys, "header.type", float(kind == "wheel"))
    if stated != float(kind == "wheel"):
        raise ValueError(f"type = {stated:g}, and a {kind}; allowed: 0 of a rail, 1 of a wheel")
    table = parse_table(parts[1], first)
    values = table.numbers()
    if values.shape[1] not in (2, 3):
        raise ValueError(f"{values.shape[1]} columns of points; allowed: y, z, and a weight")
    names = [name.lower().removesuffix(" value") for name in table.names]  # as SIMPACK writes them
    if (names and names[:2] != ["y", "z"]) or {*table.units[:2]} - {"", "lengths unit"}:
        raise ValueError(f"columns {', '.join(table.labels)}; allowed: y, z, and a weight")
    factor = _find_simpack_unit(keys, unit)
    notes = _describe_unused([*unused, *table.remarks])
    stated = _read_number(keys, "units.len.f", 1e3 / factor)
    if not math.isclose(factor * stated, 1e3, rel_tol=1e-3):
        notes.append(f"unit = {unit} replaces units.len.f = {stated:g}, which the file states")
    if values.shape[1] == 3 and np.ptp(values[:, 2]) > 0.0:
        notes.append("the weights of the points, their third column, are not used")
    points, inside = _apply_steps(values[:, :2], keys)
    return points * factor, inside, notes


def _state(keys: dict[str, str], key: str, text: str) -> None:
    """Add an entry of a heading; raise a ValueError if it was stated with another value."""
    if keys.setdefault(key, text) != text:
        raise ValueError(f"{key} = {keys[key]}, and {key} = {text}; allowed: one of them")


def _read_number(keys: Mapping[str, str], key: str, default: float = 0.0) -> float:
    """Return the number of a key; raise a ValueError if it is not finite."""
    number = parse_number(keys[key]) if key in keys else default
    if number is None or not math.isfinite(number):
        raise ValueError(f"{key} = {keys[key]!r}; allowed: a finite number, without a unit")
    return number


def _apply_steps(points: Array, keys: Mapping[str, str]) -> tuple[Array, Array]:
    """Return points after the steps of a SIMPACK heading, and which are within its bounds."""
    if _read_number(keys, "rotate"):
        cure = "rotate the points, and set it to 0: programs disagree about its sign"
        raise ValueError(f"rotate = {keys['rotate']}; allowed: 0; {cure}")
    kept, least = [0], _read_number(keys, "point.dist.min")
    for k in range(1, len(points)):
        if math.dist(points[k], points[kept[-1]]) >= least:
            kept.append(k)
    points = points[kept] + [_read_number(keys, f"shift.{axis}") for axis in "yz"]
    within = np.ones(len(points), dtype=bool)
    for k, axis in enumerate("yz"):
        low, high = (_read_number(keys, f"bound.{axis}.{end}") for end in ("min", "max"))
        inside = (points[:, k] >= low) & (points[:, k] <= high) | (low >= high)
        if axis == "z" and not inside.all():
            cure = "remove these points: programs remove them or move them to the bound"
            raise ValueError(f"bound.z of {low:g} to {high:g} excludes {(~inside).sum()}; {cure}")
        within &= inside
    signs = [-1.0 if _read_number(keys, f"mirror.{axis}") else 1.0 for axis in "yz"]
    return points * signs, within


def _find_simpack_unit(keys: Mapping[str, str], unit: str | None) -> float:
    """Return the unit of length of a SIMPACK file, mm; `unit` replaces the stated one."""
    factor = _read_number(keys, "units.len.f", 1000.0)
    if factor <= 0.0:
        raise ValueError(f"units.len.f = {factor:g}; allowed: a positive number, lengths per metre")
    if unit is not None:
        return UNITS[unit]
    name = keys.get("units.len", "")
    named = UNITS.get(find_length_unit(name) or "")
    if named is None or "units.len.f" not in keys:
        return named or 1e3 / factor
    if not math.isclose(named * factor, 1e3, rel_tol=1e-3):
        cure = "correct one of them, or give unit"
        raise ValueError(f"units.len.f = {factor:g}, and units.len = {name!r}; {cure}")
    return 1e3 / factor


def _read_columns(table: TextTable, unit: str | None, side: Side | None) -> tuple[Array, list[str]]:
    """Return points, mm, and notes, from a table of a plain or Miniprof file."""
    statements, unused = _read_heading(table)
    columns, mirrored = _choose_columns(table, statements, side)
    values = table.numbers(columns)
    notes = []
    offsets = np.array([_read_number(statements, f"{axis}offset") for axis in "xy"])
    points = (values + offsets) * (-1.0 if mirrored else 1.0, 1.0)
    rest = len(table.rows[0]) - len(columns)
    if columns == [1, 2] and not table.names:
        notes.append("the first column is taken for row numbers")
    elif rest and "columndef" not in statements and not table.names and side is None:
        notes.append(f"the first two columns are used, and {rest} more are not")
    elif _is_title(table):
        notes.append(f"the line {' '.join(table.labels)!r} is taken for a title")
    units = {table.units[k] for k in columns if table.units} - {""}
    stated = {statements[key] for key in ("unit", "units", "length unit") if key in statements}
    units |= {find_length_unit(text) or text for text in stated}
    if len(units) > 1 and unit is None:
        raise ValueError(f"units {', '.join(sorted(units))}; allowed: one unit, or give unit")
    if replaced := ", ".join(sorted(units - {unit})) if unit else "":
        notes.append(f"unit = {unit} replaces {replaced}, which the file states")
    name = unit or (units.pop() if units else "mm")
    if name not in UNITS:
        raise ValueError(f"unit {name}; allowed: {', '.join(UNITS)}, or give unit")
    for key in ("rail", "side"):
        if statements.get(key, "").lower().startswith("l"):
            cure = "set mirror = true if its y points to the track centre"
            notes.append(f"the file states {key.capitalize()} = {statements[key]}: {cure}")
    return points * UNITS[name], [*notes, *_describe_unused(unused)]


def _read_heading(table: TextTable) -> tuple[dict[str, str], list[Remark]]:
    """Return the entries that are used, by key, and the other remarks."""
    number, statements, unused = len(table.rows), dict[str, str](), list[Remark]()
    known = rf"{number}( \d+)*|.*: y and z in mm, y outward, z down"  # count; see write_profile
    for remark in table.remarks:
        key, value = remark.key, remark.value
        count = parse_number(value.split(",")[0]) if remark.states("points") else None
        if count is not None and count != number:
            raise ValueError(f"{number} points, and {key} = {count:g}; the file may be cut off")
        if count is not None or remark.states("side") or remark.states("entry"):
            _state(statements, key, value)
        elif not re.fullmatch(known, remark.text):
            unused.append(remark)
    if "end mark" in statements.get("points", "") and table.remarks[-1].text != "end":
        raise ValueError("the end mark is missing: the file is cut off")
    return statements, unused


def _choose_columns(
    table: TextTable, statements: Mapping[str, str], side: Side | None
) -> tuple[list[int], bool]:
    """Return the columns of lateral position and height, and whether y of the side is mirrored."""
    names = [name.strip().lower() for name in table.names]
    if "columndef" in statements:
        names = [name.strip().lower() for name in statements["columndef"].split(",")]
        if len(names) != len(table.rows[0]) or not {"x", "y"} <= {*names}:
            cure = "allowed: a name for each column, with X and Y"
            raise ValueError(f"ColumnDef = {statements['columndef']}; {cure}")
    width = len(table.rows[0])
    axes = [("y", "z"), ("x", "y"), ("x", "z")]
    axes += product(("lateral", "y", "x"), ("height", "vertical"))
    columns = {
        ending: [names.index(axis + ending) for axis in pair]
        for ending in map("".join, product(("_", " ", ""), ("left", "right", "l", "r", "")))
        for pair in reversed(axes)
        if {axis + ending for axis in pair} <= {*names}
    }
    whole = columns.pop("", None)
    sides = {"left" if "l" in ending else "right": found for ending, found in columns.items()}
    if width < 2:
        raise ValueError("one column; allowed: lateral position and height")
    if not sides and width == 4 and not whole and _is_two_sided(table):
        sides = {"left": [0, 1], "right": [2, 3]}
    if sides:
        if side not in sides:
            raise ValueError(f"profiles of two sides; allowed: side = {' or '.join(sides)}")
        y = table.numbers([found[0] for found in sides.values()])
        opposite = len(sides) == 2 and np.corrcoef(y, rowvar=False)[0, 1] < 0.0
        return sides[side], bool(side == "left" and opposite)
    if side is not None:
        raise ValueError(f"side = {side}, and the columns of one profile; allowed: no side")
    if whole:
        return whole, False
    if not names and width > 2 and _is_numbered(table):
        return [1, 2], False
    if names and not _is_title(table):
        listed = ", ".join(filter(None, table.labels))
        raise ValueError(
            f"columns {listed}; allowed: columns y and z, x and y, x and z, or lateral and height, "
            "without signs and directions; or the file without this line if it names no columns"
        )
    return [0, 1], False


def _is_title(table: TextTable) -> bool:
    """Return whether the header of two columns is a title of two words, and names no column."""
    words = [label.lower() for label in table.labels]
    known = {"lateral", "height", "vertical"}.intersection(words)
    return len(words) == 2 and not known and all(re.fullmatch(r"[^\W\d_]{3,}", w) for w in words)


def _is_two_sided(table: TextTable) -> bool:
    """Return whether four columns are the points of two profiles: both y run along the rows."""
    y = table.numbers([0, 2])
    widths = np.ptp(y, axis=0)
    alike = 2.0 * widths.min() > widths.max()
    return bool(alike and abs(np.corrcoef(y, rowvar=False)[0, 1]) > 0.98)


def _is_numbered(table: TextTable) -> bool:
    """Return whether the first column holds row numbers, from 0 or 1, and y runs in the second."""
    first, y = table.numbers([0, 1]).T
    counted = first[0] in (0.0, 1.0) and bool((np.diff(first) == 1.0).all())
    return counted and abs(np.sign(np.diff(y)).mean()) > 0.9


def _describe_unused(remarks: Iterable[Remark]) -> list[str]:
    """Return a note that lists the remarks that state something, or no note."""
    texts = [
        remark.text if len(remark.text) <= 60 else remark.text[:57] + "..."
        for remark in remarks
        if not (remark.text.endswith(("=", ":")) or remark.states("description"))
        if not (remark.key and parse_number(remark.value) == 0.0) and not remark.states("nothing")
    ]
    return [f"entries of the file that are not used: {list_first(texts, 6)}"] if texts else []


def write_profile(profile: Profile, path: str | PathLike[str], kind: Kind, title: str = "") -> None:
    """Write a profile: .prw or .prr as SIMPACK with z upwards, others as columns, z downwards.

    The file appears when it is complete, and its end is marked, so that a part of it is not read.

    Parameters
    ----------
    profile : Profile
        The profile.
    path : path-like
        The file. With the suffix .prw or .prr, z points upwards as these files require; with
        others, lines of y and z in mm, z downwards.
    kind : {"wheel", "rail"}
        Kind of the profile.
    title : str
        A line of text about it.

    Raises
    ------
    OutputError
        If the file cannot be written; an earlier one is unchanged.
    """
    up = -1.0 if Path(path).suffix.lower() in (".prw", ".prr") else 1.0
    lines = [f"{y:.9f} {up * z:.9f}" for y, z in profile.points]
    title = " ".join(title.replace("'", "").replace("!", "").split())
    if up < 0.0:
        number = int(kind == "wheel")
        head = f"header.begin\n  version = 1\n  type = {number}\nheader.end\nspline.begin"
        unit = f"  comment = '{title}'\n  units.len.f = 1000.0\n  point.begin"
        lines = [head, unit, *lines, "  point.end", "spline.end"]
    else:
        head = f"! {title or kind}: y and z in mm, y outward, z down"
        lines = [head, f"! points = {len(lines)}, with an end mark", *lines, "! end"]
    write_file(path, "\n".join(lines) + "\n")
