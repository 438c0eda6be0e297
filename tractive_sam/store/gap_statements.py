"""Units, scales and layouts that gap files state, in headings and in attributes."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam import scene
from tractive_sam.schema import warn
from tractive_sam.store.errors import GapError
from tractive_sam.text_table import (
    LENGTHS,
    TextTable,
    describe_unused,
    find_length_unit,
    list_first,
    parse_number,
    split_statement,
)

NAMES = ("x", "y", "separation")


def names_scale(name: str) -> bool:
    """Return whether an attribute or array of a name may change the numbers of a file."""
    words = "scal|offset|factor|gain|multipl|invert|slope|intercept|positive|direction"
    return bool(re.search(rf"{words}|\bsign", name.lower()))


def read_heading(path: Path, settings: scene.Gap, table: TextTable) -> dict[str, Any]:
    """Return the unit and the size of a matrix in a heading; GapError for what is not used.

    Returns
    -------
    dict
        "unit" of the values; "width" and "height", mm.
    """
    stated: dict[str, Any] = {}
    has_units = bool(table.units) and all(table.units)
    lengths = has_units or settings.length_unit is not None or settings.step is not None
    heights = has_units or settings.unit is not None
    spacings = r"unit|step|spacing|pixel|cell ?size|resolution|pitch|increment|sampling|\bd[xyz]\b"
    used = [*table.units, settings.unit or "", settings.length_unit or ""]
    unused = []
    corner = [(table.lines[0], table.rows[0][0])]
    corner = [] if table.names or not re.search(r"[^\W\d].*[\\/,]|\[", corner[0][1]) else corner
    for line, text in [*table.remarks, *corner]:
        key, value = split_statement(text)
        words = re.split(r"[\s\[\](){},;:=]+", value)
        found = (find_length_unit(word) for word in words if word not in ("in", "mil"))
        units = [unit for unit in found if unit]
        size = re.fullmatch(r"([\d.eE+-]+)\s*(\S+)", value)
        if units and not table.names and re.search(r"^(?!.*(\b[xy]\b|lateral)).*\bunits?\b", key):
            stated["unit"] = units[0]
            continue
        if key in ("width", "height") and size and units:
            stated[key] = float(size[1]) * LENGTHS[units[0]]
            continue
        if _check_layout(path, settings, table, line, text):
            continue
        matters = table.check_remark(
            line, text, (*LENGTHS, *table.units) if heights and not has_units else used
        )
        if (
            units or re.search(spacings, key or (text.lower() if re.search(r"\d", text) else ""))
        ) and not (heights and lengths):
            keys = "gap.unit, gap.length_unit" + ("" if table.names else " and gap.step")
            value = f"line {line}, {text[:60]!r}, which is not read"
            raise GapError(path, value, f"{keys}, which state it; or the file without this line")
        unused += [(line, text)] if matters and (line, text) not in corner else []
    if unused:
        warn(f"gap: {path.name}: {describe_unused(unused)}")
    return stated


def _check_layout(path: Path, settings: scene.Gap, table: TextTable, line: int, text: str) -> bool:
    """Return whether a line states the order or the spacing of the points that is used.

    Raises
    ------
    GapError
        If it states another order, direction or spacing.
    """
    key, value = split_statement(text.lower())
    place, cure = f"line {line}, {text[:60]!r}", "the file without this line, if it does not apply"
    first, width = table.rows[0][0], len(table.rows[0])
    is_matrix = not table.names and (
        settings.step is not None or width > len(NAMES) or parse_number(first, ".") is None
    )
    axes = re.findall(r"(?<![^\W_])[xy](?![^\W_])", text.lower())
    order = [name.lower() for name in table.names if name.lower() in ("x", "y")] or ["x", "y"]
    order = [settings.profile] if not is_matrix and width == 2 and not table.names else order
    words = r"\b(columns?|rows?|format|fields?|order|layout)\b"
    is_corner = is_matrix and (line, text) == (table.lines[0], first)
    if axes and (is_corner or re.search(words, key or text.lower())):
        turned = r"rows?\W+(are |along )?y\b|columns?\W+(are |along )?x\b"
        if axes != order[: len(axes)] or (is_matrix and re.search(turned, text.lower())):
            layout = f"the order {', '.join(order)}"
            layout = "rows of equal x and columns of equal y" if is_matrix else layout
            cure = "x/y in the corner for it" if is_corner else cure
            raise GapError(path, f"{place}, another layout", f"{layout}; or {cure}")
        return not find_length_unit(re.sub(r".*[\[(]|[\])].*", "", text))
    if is_matrix and key == "origin" and re.search(r"lower|upper|top|bottom|left|right", value):
        raise GapError(path, f"{place}, which is not applied", f"x and y that increase; or {cure}")
    down = r"\b(positive|direction|orientation|sign|points?|axis)\b.*"
    down += r"\b(down\w*|into|inwards?|below)\b"
    if re.search(down, text.lower()) and "positive" not in settings.model_fields_set:
        raise GapError(path, f"{place}, and no gap.positive", f"gap.positive; or {cure}")
    spacings = r"(\bd[xy]\b|step|spacing|pixel ?size|cell ?size|pitch|increment)"
    spacing = re.search(spacings, text.lower())
    if not (is_matrix and spacing and settings.step):
        return False
    scale = LENGTHS[settings.length_unit or "mm"]
    units = [find_length_unit(word) for word in re.findall(r"[^\W\d]+", value)]
    factor = next((LENGTHS[unit] for unit in units if unit), scale) / scale
    steps = {"dx": settings.step[0], "dy": settings.step[1]}.get(spacing[1], settings.step)
    numbers = [float(n) for n in re.findall(r"(?<![\w.])\d*\.?\d+(?:e[-+]?\d+)?", value)]
    if not all(np.isclose(factor * n, steps, rtol=0.01).any() for n in numbers):
        allowed = f"a spacing equal to it; or {cure}"
        raise GapError(path, f"{place}, and gap.step = {list(settings.step)}", allowed)
    return bool(numbers)


def read_units(
    path: Path,
    settings: scene.Gap,
    attributes: Sequence[Mapping[str, Any]],
    of_file: Mapping[str, Any],
) -> tuple[str, str]:
    """Return the units of coordinates and separation; GapError for attributes with other scales."""
    used = ("scale_factor", "add_offset", "missing_value")
    hidden = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS")
    spellings: list[dict[str, str]] = []
    unused = []
    for name, entries in zip((*NAMES, "file"), (*attributes, of_file), strict=True):
        # Names in capitals and names that begin with an underscore are parts of the formats.
        names = [key for key in entries if key not in hidden and key[:1] != "_"]
        names = [key for key in names if key not in used or name == "file"]
        values = [entries[key] for key in names]
        texts = {
            key: value.decode() if isinstance(value, bytes) else str(value)
            for key, value in zip(names, values, strict=True)
        }
        spellings.append({k: t for k, t in texts.items() if k.casefold() in ("unit", "units")})
        for key, text in texts.items():
            has_sign = key.lower() == "positive" and "positive" in settings.model_fields_set
            trivial = text in ("1", "1.0", "0", "0.0") or has_sign
            if names_scale(key) and not trivial:
                cure = "numbers to which it is applied; units, scale_factor and add_offset of each "
                cure += "dataset; gap.positive for a direction"
                raise GapError(path, f"the attribute {key} = {text[:40]} of {name}", cure)
        unused += [
            f"{name}.{key}"
            for key, text in texts.items()
            if key not in spellings[-1] and (re.search(r"\d", text) or "unit" in key.lower())
        ]
    name_unused(path, unused)
    shared = spellings.pop()
    stated = [settings.length_unit, settings.length_unit, settings.unit]
    known: list[str | None] = []
    for name, spelled, given in zip(NAMES, spellings, stated, strict=True):
        found = {find_length_unit(text): text for text in (spelled or shared).values()}
        if None in found or len(found) > 1:
            text = ", ".join(found.values())
            raise GapError(path, f"{name} in {text}", f"one unit of {', '.join(LENGTHS)}")
        known.append(given or next((unit for unit in found if unit), None))
    if any(known) and not all(known):
        bare = ", ".join(name for name, unit in zip(NAMES, known, strict=True) if not unit)
        cure = "units of all datasets or none; gap.unit and gap.length_unit state them, too"
        raise GapError(path, f"no attribute units of {bare}", cure)
    if known[0] != known[1]:
        raise GapError(path, f"x in {known[0]}, y in {known[1]}", "one unit for x and y")
    return known[0] or "mm", known[2] or "mm"


def name_unused(path: Path, names: Sequence[str]) -> None:
    """Warn of attributes, datasets or arrays that are not read."""
    if names:
        warn(f"gap: {path.name}: not read: {list_first(names, 5)}")
