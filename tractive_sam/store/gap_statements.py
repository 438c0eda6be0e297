"""Units, scales and layouts that gap files state, in headings and in attributes."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam import scene
from tractive_sam.schema import warn
from tractive_sam.text_table import (
    LENGTHS,
    Remark,
    TextError,
    TextTable,
    find_length_unit,
    find_length_units,
    list_first,
    parse_number,
)

NAMES = ("x", "y", "separation")


def names_scale(name: str) -> bool:
    """Return whether an attribute or array of a name may change the numbers of a file."""
    words = "scal|offset|factor|gain|multipl|invert|slope|intercept|positive|direction"
    return bool(re.search(rf"{words}|\bsign", name.lower()))


def read_heading(settings: scene.Gap, table: TextTable) -> dict[str, Any]:
    """Return the unit and the size of a matrix in a heading; TextError for what is not used.

    Returns
    -------
    dict
        "unit" of the values; "width" and "height", mm.
    """
    stated: dict[str, Any] = {}
    has_units = bool(table.units) and all(table.units)
    lengths = has_units or settings.length_unit is not None or settings.step is not None
    heights = has_units or settings.unit is not None
    cell = table.rows[0][0]
    is_matrix = not table.names and (
        settings.step is not None or len(table.rows[0]) > len(NAMES) or parse_number(cell) is None
    )
    has_words = not table.names and re.search(r"[^\W\d].*[\\/,]|\[", cell)
    corner = [Remark(table.lines[0], cell)] if has_words else []
    for remark in corner if is_matrix and _find_axes(cell) else []:
        _check_order(remark, None, "x/y in the corner for it")
    unused = []
    for remark in table.remarks:
        units = find_length_units(remark.value)
        is_above = remark.line < table.lines[0]
        is_unit = bool(remark.states("unit of values")) and not remark.states("scale")
        if units and is_above and not table.names and is_unit:
            stated["unit"] = units[0]
            _name_replaced_unit(settings, "values", units[0], settings.unit)
        elif units and (size := remark.states("size")):
            stated[remark.key] = float(size[1]) * LENGTHS[units[0]]
        elif not _is_layout(settings, table, remark, is_matrix):
            unused.append(remark)
    used = [*table.units, settings.unit or "", settings.length_unit or ""]
    known = (*LENGTHS, *table.units) if heights and not has_units else used
    text = table.find_unused(known, unused)
    table.find_unused(known, corner)  # an error if the corner has another unit
    for remark in () if heights and lengths else [*unused, *corner]:
        if find_length_units(remark.value) or remark.states("lengths"):
            keys = "gap.unit, gap.length_unit" + ("" if table.names else " and gap.step")
            cure = f"{keys}, which state it; or the file without this line"
            raise TextError(f"{remark.place}, which is not read", cure)
    if text:
        note(settings, text)
    return stated


def _is_layout(settings: scene.Gap, table: TextTable, remark: Remark, is_matrix: bool) -> bool:
    """Return whether a remark states the order or the spacing of the points that is used.

    Raises
    ------
    TextError
        If it states another order, direction or spacing.
    """
    cure = "the file without this line, if it does not apply"
    if remark.states("order") and _find_axes(remark.text):
        order = [name.lower() for name in table.names if name.lower() in ("x", "y")] or ["x", "y"]
        if not is_matrix and len(table.rows[0]) == 2 and not table.names:
            order = [settings.profile]
        _check_order(remark, None if is_matrix else order, cure)
        return not find_length_unit(re.sub(r".*[\[(]|[\])].*", "", remark.text))
    if is_matrix and remark.states("origin"):
        value = f"{remark.place}, which is not applied"
        raise TextError(value, f"x and y that increase; or {cure}")
    if remark.states("downwards") and "positive" not in settings.model_fields_set:
        raise TextError(f"{remark.place}, and no gap.positive", f"gap.positive; or {cure}")
    stated = remark.states("step")
    if not (is_matrix and stated and settings.step):
        return False
    scale = LENGTHS[settings.length_unit or "mm"]
    units = find_length_units(remark.value)
    factor = LENGTHS[units[0]] / scale if units else 1.0
    steps = {"dx": settings.step[0], "dy": settings.step[1]}.get(stated[0], settings.step)
    texts = re.findall(r"(?<![\w.])\d*\.?\d+(?:e[-+]?\d+)?", remark.value.lower())
    if not all(np.isclose(factor * float(text), steps, rtol=0.01).any() for text in texts):
        value = f"{remark.place}, and gap.step = {list(settings.step)}"
        raise TextError(value, f"a spacing equal to it; or {cure}")
    return bool(texts)


def _find_axes(text: str) -> list[str]:
    """Return the words x and y of a text in their order."""
    return re.findall(r"(?<![^\W_])[xy](?![^\W_])", text.lower())


def _check_order(remark: Remark, order: Sequence[str] | None, cure: str) -> None:
    """Raise a TextError if a remark states another order of axes, or, without one, of a matrix."""
    turned = not order and remark.states("rows along y")
    names = order or ("x", "y")
    axes = _find_axes(remark.text)
    if axes != [*names][: len(axes)] or turned:
        layout = f"the order {', '.join(names)}"
        layout = layout if order else "rows of equal x and columns of equal y"
        raise TextError(f"{remark.place}, another layout", f"{layout}; or {cure}")


def read_units(
    settings: scene.Gap,
    attributes: Sequence[Mapping[str, Any]],
    of_file: Mapping[str, Any],
) -> tuple[str, str]:
    """Return the units of coordinates and separation; a TextError for other scales."""
    used = ("scale_factor", "add_offset", "missing_value")
    hidden = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS")
    stated: list[set[str]] = []
    unused = []
    for name, entries in zip((*NAMES, "file"), (*attributes, of_file), strict=True):
        stated.append(set())
        for key, value in entries.items():
            # Names in capitals and names that begin with an underscore are parts of the formats.
            if key in hidden or key[:1] == "_" or (key in used and name != "file"):
                continue
            text = value.decode() if isinstance(value, bytes) else str(value)
            has_sign = key.lower() == "positive" and "positive" in settings.model_fields_set
            if names_scale(key) and text not in ("1", "1.0", "0", "0.0") and not has_sign:
                cure = "numbers to which it is applied; units, scale_factor and add_offset of each "
                cure += "dataset; gap.positive for a direction"
                raise TextError(f"the attribute {key} = {text[:40]} of {name}", cure)
            if key.casefold() in ("unit", "units"):
                stated[-1].add(find_length_unit(text) or text)
            elif re.search(r"\d", text) or "unit" in key.lower():
                unused.append(f"{name}.{key}")
    name_unused(settings, unused)
    shared = stated.pop()
    texts = [" and ".join(sorted(units or shared)) for units in stated]
    return agree_units(settings, NAMES, texts, "no attribute units of")


def agree_units(
    settings: scene.Gap, names: Sequence[str], stated: Sequence[str], bare: str
) -> tuple[str, str]:
    """Return the units of coordinates and values; a TextError unless they agree.

    Parameters
    ----------
    settings : Gap
        The table of the scene, whose units replace those of the file.
    names, stated : sequence of str
        Names of the coordinates and, at the end, of the values; their units, "" if not stated.
    bare : str
        Message if units are missing, before the names without one.
    """
    *lengths, height = stated
    lengths, height = [settings.length_unit or unit for unit in lengths], settings.unit or height
    units = [*lengths, height]
    pairs = [*zip(names, units, strict=True)]
    for name, unit in pairs:
        if unit and unit not in LENGTHS:
            raise TextError(f"{name} in {unit}", f"one unit of {', '.join(LENGTHS)}")
    if any(units) and not all(units):
        missing = ", ".join(name for name, unit in pairs if not unit)
        cure = "units of all or none; gap.unit and gap.length_unit state them, too"
        raise TextError(f"{bare} {missing}", cure)
    if len({*lengths}) > 1:
        listed = ", ".join(f"{name} in {unit}" for name, unit in zip(names, lengths, strict=False))
        raise TextError(listed, "one unit for x and y")
    for name, unit, used in zip(names, stated, units, strict=True):
        _name_replaced_unit(settings, name, unit, used)
    return lengths[0] or "mm", height or "mm"


def _name_replaced_unit(settings: scene.Gap, name: str, stated: str, used: str | None) -> None:
    """Warn if the scene replaces a unit that a file states."""
    if stated and used and stated != used:
        note(settings, f"{name} in {used}, as the scene states, and not in {stated}, as the file")


def note(settings: scene.Gap, text: str) -> None:
    """Issue a warning of what a gap file contains."""
    warn(f"gap: {Path(str(settings.file)).name}: {text}")


def name_unused(settings: scene.Gap, names: Sequence[str]) -> None:
    """Warn of attributes, datasets or arrays that are not read."""
    if names:
        note(settings, f"not read: {list_first(names, 5)}")
