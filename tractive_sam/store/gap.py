"""Reads measured or worn separations, and profiles as instruments write them."""

import re
import zipfile
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from math import prod
from pathlib import Path
from typing import IO, Any

import h5py
import numpy as np
import scipy  # its parts are loaded when first used
from numpy.lib import format as npy
from numpy.typing import ArrayLike

from tractive_sam import scene
from tractive_sam.input_file import open_regular
from tractive_sam.scene import ALONG, TEXTS
from tractive_sam.store.errors import GapError
from tractive_sam.store.gap_statements import (
    NAMES,
    agree_units,
    name_unused,
    names_scale,
    note,
    read_heading,
    read_units,
)
from tractive_sam.store.opening import get_member, numeric_dataset, open_to_read
from tractive_sam.text_table import (
    LENGTHS,
    TextError,
    TextTable,
    find_marks,
    list_first,
    parse_number,
    read_table,
)

LARGEST = 1e30
"""Largest magnitude of coordinates and separations, mm, at which no formula overflows. Equal to
`schema.LARGEST`, which would load the reader of scenes."""

Gap = tuple[np.ndarray, np.ndarray, np.ndarray]

_HEIGHTS = ("separation", "gap", "z", "height", "heights", "depth", "profile", "elevation", "raw")
"""Names of the measured quantity in files, in lower case."""


@dataclass(frozen=True, eq=False)
class _GapData:
    """Raw content of a gap file: x, y, values (nan: missing), and their units."""

    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    units: tuple[str, str] = ("mm", "mm")


def read_gap(gap: scene.Gap | str | Path, table: str = "gap") -> Gap:
    """Read a gap from a file or its arrays, and return the separation on a grid in mm.

    ===============  ==============================================================
    .h5 .nc          datasets x (n_x,), y (n_y,) and separation (n_x, n_y), in the
                     units of their attribute `units`; if its dimensions have names,
                     as in netCDF, they may have any order
    .npy             a structured array with the fields x, y, separation; an array
                     (n, 3) of these columns: every point of the grid once, in any
                     order; an array (n, 2) of y and height, a profile across the
                     track; with gap.step a matrix, one row for each x
    .npz             arrays of these names; or a single array, as .npy
    .csv .txt .dat   columns x, y, separation; or two columns y, height; or a
    .tsv .xyz .asc   matrix whose first row holds y and whose first column holds x
                     (of two y with a word in the corner), without both with gap.step.
                     Separators: comma, semicolon, tab or space; decimal points or
                     commas. A header may state names and units: ``y [mm]; z [um]``.
                     A heading may state the size and the unit of a matrix, as the
                     export of Gwyddion does; other lengths and scales are refused
    ===============  ==============================================================

    Parameters
    ----------
    gap : Gap or path-like
        The table of a scene, or a file of separations in mm.
    table : str
        Name of the table, for messages.

    Returns
    -------
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Increasing coordinates, mm.
    separation : ndarray, shape (n_x, n_y)
        Separation of the surfaces, mm.

    Raises
    ------
    GapError
        If the file cannot be read, or does not hold finite numbers on a full grid.
    """
    settings = gap if isinstance(gap, scene.Gap) else scene.Gap.model_construct(file=Path(gap))
    content = getattr(settings.file, "content", None)
    try:
        if content is None:
            return _read(settings)
        read: Gap = content.read(settings.reading, lambda: _read(settings))
        return read
    except GapError as error:
        raise error.for_table(table) from error.__cause__


def _read(settings: scene.Gap) -> Gap:
    """Return a gap from its file or arrays, converted to mm; GapError unless it is valid."""
    if settings.file is None:
        return settings.in_mm(settings.x, settings.y, settings.separation)
    path = settings.file
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        raise GapError(path, f"the suffix {path.suffix!r}", f"one of {', '.join(_READERS)}")
    try:
        data = _READERS[suffix](path, settings)
        _check_grid(data)
        data = replace(data, values=_fill(settings, data))
    except FileNotFoundError:
        raise GapError(path, "no such file", "an existing file") from None
    except (GapError, Warning):
        raise
    except TextError as error:
        raise GapError(path, error.value, error.allowed) from None
    except Exception as error:  # for damaged files the libraries raise many types of errors
        problem = f"unreadable ({getattr(error, 'strerror', None) or error})"
        cure = "a regular file with numbers for x, y and separation"
        raise GapError(path, problem, cure) from error
    return settings.in_mm(data.x, data.y, data.values, data.units)


def _fill(settings: scene.Gap, data: _GapData) -> np.ndarray:
    """Return values with interpolated missing points; TextError if the scene does not allow it.

    Numbers such as -9999, with which instruments mark missing points, are missing values.
    """
    values = data.values.copy()
    lines = [v for v in (values, values.T) if len(v) == 2 and np.array_equal(v[0], v[1], True)]
    repeats = 1 + bool(lines)  # a profile
    is_mark = find_marks(values)
    finite = values[np.isfinite(values) & ~is_mark]
    extremes = np.unique([finite.min(), finite.max()]) if finite.size else finite
    inner = finite[~np.isin(finite, extremes)]
    for kind, others in ((values[is_mark], finite), (extremes, inner)):
        largest = float(np.abs(others).max(initial=0.0))
        for extreme in np.unique(kind) if largest else ():
            factor = abs(extreme) / largest
            text = f"{extreme:g} at {(values == extreme).sum() // repeats} points, "
            text += f"{factor:.3g} times the largest of the other values"
            if others is inner and factor > 1000.0:
                note(settings, f"{text}; remove outliers")
            elif others is finite and settings.missing is None:
                cure = 'values at all points; gap.missing = "interpolate" replaces such marks'
                raise TextError(text, cure)
            elif others is finite:
                values[values == extreme] = np.nan
    missing = np.isnan(values)
    if not missing.any():
        return values
    i, j = np.argwhere(missing)[0]
    axes = [("x", data.x[i], data.x.size), ("y", data.y[j], data.y.size)]
    place = ", ".join(f"{name} = {at:g}" for name, at, n in axes if n > 2 or not lines)
    text = f"{missing.sum() // repeats} of {missing.size // repeats} points are missing, the first "
    text += f"at {place}"
    if settings.missing is None:
        raise TextError(text, 'finite numbers; gap.missing = "interpolate" replaces missing points')
    across, width_across = _interpolate_rows(data.y, values)
    along, width_along = (array.T for array in _interpolate_rows(data.x, values.T))
    width = np.minimum(width_across, width_along)
    widest = float(width[missing].max())
    steps = [float(np.median(np.diff(axis))) for axis in (data.y, data.x) if axis.size > 2]
    limit = settings.missing_width or 6.0 * max(steps, default=0.0)
    if widest > limit * (1.0 + 1e-9):
        hole = f"the widest hole is {widest:.4g} wide"
        where = hole if np.isfinite(widest) else "also at an edge"
        cure = f"holes up to {limit:.4g}; gap.missing_width for wider ones, or a map without its "
        cure += "edge"
        raise TextError(f"{text}; {where}", cure)
    weights = 1.0 / width_across, 1.0 / width_along
    filled = (weights[0] * across + weights[1] * along) / np.maximum(sum(weights), 1e-300)
    values[missing] = filled[missing]
    note(settings, f"{text}; interpolated, the widest hole is {widest:.3g} wide")
    return values


def _interpolate_rows(places: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rows with linearly interpolated nan, and the distance of the neighbours of each point.

    At the ends of a row, values are 0 and the distance is infinite.
    """
    count, valid = np.arange(places.size), np.isfinite(values)
    before = np.maximum.accumulate(np.where(valid, count, 0), axis=1)
    after = np.minimum.accumulate(np.where(valid, count, count[-1])[:, ::-1], axis=1)[:, ::-1]
    low, high = (np.take_along_axis(values, k, axis=1) for k in (before, after))
    width = np.where(np.isfinite(low + high) & ~valid, places[after] - places[before], np.inf)
    filled = low + (places - places[before]) / width * (high - low)
    return np.nan_to_num(filled), width


def _read_hdf5(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in the datasets x, y and separation of an HDF5 file, with their units."""
    with open_to_read(path) as file:
        _check_names(settings, file, "dataset")
        parts = [numeric_dataset(get_member(file, name)) for name in NAMES]
        names = [
            {dimension.label, *(h5py.h5i.get_name(scale.id).decode() for scale in scales)}
            for dimension in parts[2].dims
            for scales in (dimension.values(),)
        ]
        arrays = [(dataset[()], dict(dataset.attrs)) for dataset in parts]
        return _from_datasets(settings, arrays, names, file.attrs)


def _read_netcdf(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in a netCDF file, of version 4 (HDF5) or of the classic format."""
    with open_regular(path) as opened:
        if opened.read(3) != b"CDF":
            return _read_hdf5(path, settings)
        opened.seek(0)
        with scipy.io.netcdf_file(opened, mmap=False) as file:
            _check_names(settings, file.variables, "variable")
            parts = [file.variables[name] for name in NAMES]
            arrays = [(part.data, vars(part)["_attributes"]) for part in parts]
            names = [{name} for name in parts[2].dimensions]
            attributes = vars(file)["_attributes"]
            return _from_datasets(settings, arrays, names, attributes)


def _check_names(settings: scene.Gap, found: Collection[str], kind: str) -> None:
    """Raise a TextError unless x, y and separation are among the names of datasets or fields."""
    missing = [name for name in NAMES if name not in found]
    if missing:
        raise TextError(f"no {kind} {', '.join(missing)}", f"{kind}s {', '.join(NAMES)}")
    name_unused(settings, [name for name in found if name not in NAMES])


def _from_datasets(
    settings: scene.Gap,
    parts: Sequence[tuple[np.ndarray, Mapping[str, Any]]],
    dimensions: Sequence[set[str]],
    of_file: Mapping[str, Any],
) -> _GapData:
    """Return the gap of x, y and separation with their attributes.

    Parameters
    ----------
    settings : Gap
        See `_read`.
    parts : sequence of (ndarray, mapping)
        Stored numbers and attributes of x, y and separation.
    dimensions : sequence of set of str
        Names of the dimensions of the separation, which state the order of x and y.
    of_file : mapping
        Attributes of the file.
    """
    units = read_units(settings, [attributes for _, attributes in parts], of_file)
    x, y, values = (_unpack(*part) for part in parts)
    names = [{name.strip("/") for name in texts} - {""} for texts in dimensions]
    if names == [{"y"}, {"x"}]:
        values = values.T
    elif any(names) and names != [{"x"}, {"y"}]:
        stated = ", ".join("/".join(sorted(name)) or "without a name" for name in names)
        raise TextError(f"separation with the dimensions {stated}", "the dimensions x and y")
    return _GapData(_finite(x, "x"), _finite(y, "y"), values, units)


def _unpack(stored: np.ndarray, attributes: Mapping[str, Any]) -> np.ndarray:
    """Return the numbers of a netCDF variable: fill values as nan, scale and offset applied."""
    values = np.asarray(stored, float)
    for name in ("_FillValue", "missing_value"):
        if name in attributes:
            values = np.where(values == np.ravel(attributes[name])[0], np.nan, values)
    scale, offset = (
        np.asarray(attributes.get(name, default), float).item()  # an error for several
        for name, default in (("scale_factor", 1.0), ("add_offset", 0.0))
    )
    return values if (scale, offset) == (1.0, 0.0) else scale * values + offset


def _read_npz(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in an .npz file: x, y and separation (or height, z), or a single array."""
    arrays = read_archive(path)
    if len(arrays) == 1:
        return _gap_from_array(settings, *arrays.values())
    measured = [name for name in _HEIGHTS if name in arrays]
    if len(measured) != 1 or "y" not in arrays:
        needed = f"y, one of {', '.join(_HEIGHTS)}, and x except for a profile; or a single array"
        raise TextError(f"arrays {', '.join(arrays)}", needed)
    others = [name for name in arrays if name not in ("x", "y", *measured)]
    scales = [n for n in others if names_scale(n) or "unit" in n.lower()]
    if scales and None in (settings.unit, settings.length_unit):
        cure = "gap.unit and gap.length_unit, and numbers without other scales"
        raise TextError(f"the array {scales[0]} = {arrays[scales[0]]}"[:80], cure)
    name_unused(settings, others)
    y, values = _finite(arrays["y"], "y"), np.asarray(arrays[measured[0]], float)
    _check_meaning(settings, measured[0], "x" not in arrays)
    if "x" in arrays:
        return _GapData(_finite(arrays["x"], "x"), y, values)
    return _gap_from_profile(settings, y, values)


def _gap_from_array(settings: scene.Gap, array: np.ndarray) -> _GapData:
    """Return the gap in an array with the fields x, y, separation, or in a matrix."""
    if array.dtype.names is not None:
        _check_names(settings, array.dtype.names, "field")
        array = np.stack([array[name].ravel() for name in NAMES], axis=-1)
    if array.dtype.kind not in "fiu":
        raise TextError(f"an array of {array.dtype}", "an array of real numbers")
    return _gap_from_matrix(settings, np.asarray(array, float))


def _finite(values: ArrayLike, name: str) -> np.ndarray:
    """Return values as an array; raise a TextError unless all are finite numbers."""
    array = np.asarray(values, float)
    wrong = np.argwhere(~np.isfinite(array))
    if wrong.size:
        places = [f"{array[tuple(index)]} in {name}{index.tolist()}" for index in wrong]
        raise TextError(list_first(places, 1), "finite numbers")
    return array


def _read_text(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in a text file: points, a profile, heights, or a matrix with x and y."""
    table = read_table(path, 2**30)  # about 5000 x 5000 numbers
    heading = read_heading(settings, table)
    if table.names:
        return _gap_from_columns(settings, table)
    shape = len(table.rows), len(table.rows[0])
    unit, scale = heading.get("unit", "mm"), LENGTHS[settings.length_unit or "mm"]
    sizes = [heading.get(key, 0.0) for key in ("height", "width")]  # rows: x; columns: y
    if settings.step is None and all(sizes):
        step = sizes[0] / shape[0], sizes[1] / shape[1]
        text = f"a matrix of {shape[0]} x {shape[1]} points, {sizes[0]:g} x {sizes[1]:g} mm by its "
        note(settings, f"{text}heading: {step[0]:.6g} and {step[1]:.6g} mm between points")
        values = _read_cells(settings, table)
        return _centre(values, (step[0] / scale, step[1] / scale), ("mm", unit))
    if settings.step is not None:
        lengths = [scale * step for step in settings.step]
        for name, size, n, length in zip("xy", sizes, shape, lengths, strict=True):
            if size and not 0.99 * size <= length * n <= 1.01 * size * n / (n - 1):
                value = f"{size:g} mm along {name} in its heading, and {n} points"
                cure = f"gap.step = {size / n:.4g} mm along {name} for rows along x"
                raise TextError(value, cure)
    corner = parse_number(table.rows[0][0], table.decimal)
    if settings.step is not None or (corner is not None and shape[1] <= len(NAMES)):
        data = _gap_from_matrix(settings, _read_cells(settings, table))
        return replace(data, units=(data.units[0], unit))
    if corner:
        value = "a matrix without coordinates"
        cure = "gap.step = [dx, dy]; or y in the first row, x in the first column and text or 0 in "
        raise TextError(value, cure + "the corner; or columns x, y, separation")
    table.rows[0][0] = "0"  # the corner may contain any text
    matrix = _read_cells(settings, table)
    data = _GapData(matrix[1:, 0], matrix[0, 1:], matrix[1:, 1:], ("mm", unit))
    if corner is not None:
        _check_corner(data)
    return data


def _check_corner(data: _GapData) -> None:
    """Raise a TextError unless a matrix with 0 in its corner certainly contains coordinates."""
    for axis in (data.x, data.y):
        steps = np.diff(axis)
        if axis.size < 3 or not np.allclose(steps, steps.mean(), rtol=1e-3) or steps.mean() <= 0.0:
            break
    else:
        sums = data.x[:, None] + data.y
        if not np.allclose(data.values, sums, atol=0.05 * np.ptp(sums)):
            return
    value = "a matrix whose first row and column may be coordinates or heights"
    raise TextError(value, "gap.step = [dx, dy]; or a word in the corner between x and y")


def _read_cells(
    settings: scene.Gap, table: TextTable, columns: Sequence[int] | None = None
) -> np.ndarray:
    """Return numbers of a table; TextError for missing ones, unless the scene fills them."""
    try:
        return table.numbers(columns)
    except TextError as error:
        values = table.numbers(columns, missing=True)  # an error if any cell is no number
        if settings.missing is None:
            cure = f'{error.allowed}; gap.missing = "interpolate" replaces missing points'
            raise TextError(error.value, cure) from None
        return values


def _gap_from_columns(settings: scene.Gap, table: TextTable) -> _GapData:
    """Return the gap of a profile or of points in named columns."""
    names = [re.sub(r"[\s_]*\d?$", "", name.lower()) for name in table.names]
    order = _find_columns(names)
    if order is None or settings.step is not None:
        value = f"columns {', '.join(table.labels)}" + (" and gap.step" if order else "")
        cure = f"x, y and one of {', '.join(_HEIGHTS)}; or one of these and y, x, lateral, position"
        raise TextError(value, cure)
    *places, height = order
    _check_meaning(settings, names[height], len(places) == 1)
    labels, units = ([texts[k] for k in order] for texts in (table.labels, table.units))
    stated = agree_units(settings, labels, units, "a header without the unit of")
    points = np.column_stack([table.numbers(places), _read_cells(settings, table, [height])])
    if len(places) == 1:
        return _gap_from_profile(settings, points[:, 0], points[:, 1], stated)
    return replace(_gap_from_points(settings, points), units=stated)


def _find_columns(names: Sequence[str]) -> list[int] | None:
    """Return the indices of the place and the height, or of x, y and height; None if not clear."""
    places = ("x", "y", "s", "lateral", "longitudinal", "position", "distance", "length", "along",
              "lateral position", "longitudinal position", "x position", "y position")  # fmt: skip
    for order in permutations(range(len(names))) if len(names) in (2, 3) else ():
        *before, height = (names[k] for k in order)
        known = before == ["x", "y"] if len(names) == 3 else before[0] in places
        if known and height in _HEIGHTS:
            return [*order]
    return [0, 1] if [*names] == ["x", "y"] else None


def _gap_from_matrix(settings: scene.Gap, array: np.ndarray) -> _GapData:
    """Return the gap in a matrix: heights over a grid, a profile, or points (x, y, z)."""
    if array.ndim == 2 and settings.step is not None:
        for name, lines in (("column", array.T), ("row", array)):
            steps = np.diff(lines)
            even = np.all(np.isclose(steps, steps[:, :1], rtol=1e-3, atol=0.0), axis=1)
            if steps.shape[1] > 2 and steps[0, 0] and even[0] and not even.all():
                value = f"a first {name} of evenly spaced numbers, and gap.step"
                cure = "heights alone, without coordinates or row numbers; or no gap.step"
                raise TextError(value, cure)
        if array.shape[1] == len(NAMES):
            sizes = [np.unique(column).size for column in array.T[:2]]
            if min(sizes) > 1 and sizes[0] * sizes[1] == len(array):
                value = f"points of a grid, {sizes[0]} x {sizes[1]}, in three columns, and gap.step"
                raise TextError(value, "a matrix of heights alone; or no gap.step")
        return _centre(array, settings.step)
    if array.ndim == 2 and array.shape[1] == 2:
        _check_meaning(settings, "", True)
        return _gap_from_profile(settings, _finite(array[:, 0], "y"), array[:, 1])
    return _gap_from_points(settings, array)


def _centre(
    values: np.ndarray, step: tuple[float, float], units: tuple[str, str] = ("mm", "mm")
) -> _GapData:
    """Return the gap in a matrix of points at steps along x and y, with its centre at 0."""
    x, y = (
        step * (np.arange(n) - 0.5 * (n - 1)) for step, n in zip(step, values.shape, strict=True)
    )
    return _GapData(x, y, values, units)


def _check_meaning(settings: scene.Gap, name: str, is_profile: bool) -> None:
    """Raise a TextError if it is not clear whether values are a separation or heights of a body."""
    separations = ("separation", "gap") if is_profile else ("separation", "gap", "z", "")
    if settings.body is None and name not in separations:
        cure = 'gap.body = "A" or "B" for heights of this body; or the header y, separation'
        value = f"a column {name} without a body" if name else "a profile without a body"
        raise TextError(f"{value} or the header separation", cure)
    if name == "depth" and "positive" not in settings.model_fields_set:
        cure = 'gap.positive = "inward" for depths below the surface, or "outward"'
        raise TextError("a column depth", cure)


def _gap_from_profile(
    settings: scene.Gap,
    place: np.ndarray,
    values: np.ndarray,
    units: tuple[str, str] = ("mm", "mm"),
) -> _GapData:
    """Return the gap of a profile over x or y that is constant in the other direction."""
    if place.ndim == 1 and place.size > 1 and place[0] > place[-1]:
        place, values = place[::-1], values[::-1]
    end = ALONG / LENGTHS[settings.length_unit or units[0]]
    ends, both = np.array([-end, end]), np.stack([values, values])
    if settings.profile == "x":
        return _GapData(place, ends, both.T, units)
    return _GapData(ends, place, both, units)


_READERS = {
    ".h5": _read_hdf5,
    ".nc": _read_netcdf,
    ".npy": lambda path, settings: _gap_from_array(settings, read_array(path)),
    ".npz": _read_npz,
    **dict.fromkeys(TEXTS, _read_text),
}


def _gap_from_points(settings: scene.Gap, points: np.ndarray) -> _GapData:
    """Return the gap of points (n, 3) in any order; TextError unless they fill a grid once.

    With gap.missing, up to half of the points may be absent.
    """
    if points.ndim != 2 or points.shape[1] != len(NAMES):
        cure = "columns x, y, separation; a profile of two columns; or gap.step = [dx, dy] of a "
        cure += "matrix"
        raise TextError(f"an array of shape {points.shape}", cure)
    _finite(points[:, :2], "array")
    x, i = np.unique(points[:, 0], return_inverse=True)
    y, j = np.unique(points[:, 1], return_inverse=True)
    size = len(x) * len(y)  # n² for n scattered points: do not allocate the grid before the check
    indices, counts = np.unique(np.stack((i, j)), axis=1, return_counts=True)
    filled = len(counts)
    allowed = size if settings.missing is None else size // 2
    if not len(points) == filled >= allowed:
        value = f"{len(points)} points ({filled} distinct) of {len(x)} x and {len(y)} y"
        if filled < len(points):
            k, m = indices[:, counts > 1][:, 0]
            value += f"; x = {x[k]:g}, y = {y[m]:g} occurs {counts.max()} times"
        cure = f"each of the {size} points of the grid once; or gap.step = [dx, dy] of a matrix; "
        raise TextError(value, cure + 'or gap.missing = "interpolate" if few are absent')
    separation = np.full((len(x), len(y)), np.nan)
    separation[i, j] = points[:, 2]
    return _GapData(x, y, separation)


def _check_grid(data: _GapData) -> None:
    """Raise a TextError unless axes increase, shapes match, and numbers are moderate."""
    for name, axis in (("x", data.x), ("y", data.y)):
        if axis.ndim != 1 or axis.size < 2:
            raise TextError(f"{name} of shape {axis.shape}", f"at least 2 values of {name}")
        falls = np.flatnonzero(np.diff(axis) <= 0.0)
        if falls.size:
            places = [f"{axis[k + 1]:g} after {axis[k]:g}" for k in falls]
            value = f"{name} that does not increase, {list_first(places, 1)}"
            raise TextError(value, f"increasing {name}")
    shape = (data.x.size, data.y.size)
    if data.values.shape != shape:
        raise TextError(f"separation of shape {data.values.shape}", f"the shape {shape}")
    if np.isinf(data.values).any():
        raise TextError("infinite values", "finite numbers")
    arrays = (data.x, data.y, np.nan_to_num(data.values))
    largest = max(float(np.abs(array).max()) for array in arrays)
    if largest > LARGEST:
        raise TextError(f"numbers up to {largest:g}", f"lengths up to {LARGEST:g} mm")


# Files of NumPy from other programs: sizes are checked before memory is allocated.


def read_array(path: Path) -> np.ndarray:
    """Return the array in an .npy file; ValueError if it contains Python objects.

    Raises
    ------
    OSError
        If the file is no regular file.
    ValueError
        If it contains Python objects or fewer numbers than its header states, or is no .npy file.
    """
    with open_regular(path) as file:
        if zipfile.is_zipfile(file):
            raise ValueError("an archive of arrays; its suffix is .npz")
        size = file.seek(0, 2)
        file.seek(0)
        return _read_checked(file, size)


def read_archive(path: Path, max_bytes: int = 2**31) -> dict[str, np.ndarray]:
    """Return the arrays in an .npz file by name; ValueError above `max_bytes` in all.

    Parameters
    ----------
    path : Path
        The file.
    max_bytes : int
        Largest total size of the arrays: a small compressed file may contain huge arrays.

    Raises
    ------
    OSError, ValueError
        See `read_array`; also if the arrays are larger than `max_bytes`.
    """
    with open_regular(path) as file, zipfile.ZipFile(file) as archive:
        members = archive.infolist()
        size = sum(member.file_size for member in members)
        if size > max_bytes:
            raise ValueError(f"{size / 2**20:.4g} MiB of arrays, at most {max_bytes / 2**20:.4g}")
        arrays = {}
        for member in members:
            with archive.open(member) as content:
                name = member.filename.removesuffix(".npy")
                arrays[name] = _read_checked(content, member.file_size)
    return arrays


def _read_checked(file: IO[bytes], size: int) -> np.ndarray:
    """Return an array from a file of `size` bytes, checked before memory is allocated."""
    version = npy.read_magic(file)
    header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = header(file)
    if dtype.hasobject:
        raise ValueError("Python objects instead of numbers")
    if any(n < 0 for n in shape) or prod(shape) * dtype.itemsize > size:
        raise ValueError(f"{size} bytes claim an array of the shape {shape}")
    file.seek(0)
    return npy.read_array(file, allow_pickle=False)
