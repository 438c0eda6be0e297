"""Reads measured or worn separations, and profiles as instruments write them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import ArrayLike

from tractive_sam import scene
from tractive_sam.scene import ALONG, TEXTS
from tractive_sam.store.errors import GapError
from tractive_sam.store.hdf5_file import open_to_read
from tractive_sam.store.hdf5_guard import get_member, numeric_dataset
from tractive_sam.store.numpy_guard import read_archive, read_array
from tractive_sam.text_table import LENGTHS, TextError, find_length_unit, parse_number, read_table

NAMES = ("x", "y", "separation")
LARGEST = 1e30
"""Largest magnitude of coordinates and separations, mm, at which no formula overflows. Equal to the
limit in `scene.quantities`, which would load the scene reader."""

Gap = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class _GapData:
    """Raw content of a gap file: x, y, values, and their units."""

    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    units: tuple[str, str] = ("mm", "mm")


def read_gap(gap: scene.Gap | str | Path, table: str = "gap") -> Gap:
    """Read a gap from a file or its arrays, and return the separation on a grid in mm.

    ===============  ==============================================================
    .h5              datasets x (n_x,), y (n_y,) and separation (n_x, n_y), in the
                     units of their attribute `units`
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
                     Lines that begin with # or % are skipped
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
    if path.suffix.lower() not in _READERS:
        raise GapError(path, f"the suffix {path.suffix!r}", f"one of {', '.join(_READERS)}")
    try:
        data = _READERS[path.suffix.lower()](path, settings)
    except FileNotFoundError:
        raise GapError(path, "no such file", "an existing file") from None
    except GapError:
        raise
    except TextError as error:
        raise GapError(path, error.value, error.allowed) from None
    except OSError as error:
        problem = f"unreadable ({error.strerror or error})"
        raise GapError(
            path, problem, "a regular file with numbers for x, y and separation"
        ) from error
    except Exception as error:  # for damaged files the libraries raise many types of errors
        raise GapError(path, f"unreadable ({error})", "numbers for x, y and separation") from error
    _check_grid(path, data)
    return settings.in_mm(data.x, data.y, data.values, data.units)


def _read_hdf5(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in the datasets x, y and separation of an HDF5 file, with their units."""
    with open_to_read(path) as file:
        missing = [name for name in NAMES if name not in file]
        if missing:
            raise GapError(path, f"no dataset {', '.join(missing)}", f"datasets {', '.join(NAMES)}")
        datasets = {name: numeric_dataset(get_member(file, name)) for name in NAMES}
        units = {name: _read_unit(path, name, dataset) for name, dataset in datasets.items()}
        if units["x"] != units["y"]:
            raise GapError(path, f"x in {units['x']}, y in {units['y']}", "one unit for x and y")
        x, y, values = (_finite(path, datasets[name], name) for name in NAMES)
    return _GapData(x, y, values, (units["x"], units["separation"]))


def _read_unit(path: Path, name: str, dataset: h5py.Dataset) -> str:
    """Return the unit of a dataset, mm by default; GapError unless it is a known length."""
    unit = dataset.attrs.get("units", "mm")
    unit = unit.decode() if isinstance(unit, bytes) else str(unit)
    if unit not in LENGTHS:
        raise GapError(path, f"{name} in {unit}", f"units of {', '.join(LENGTHS)}")
    return unit


def _read_npy(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in an .npy file: fields x, y, separation, or a matrix."""
    return _gap_from_array(path, settings, read_array(path))


def _read_npz(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in an .npz file: x, y and separation (or height, z), or a single array."""
    # Names of the measured quantity in files.
    value_names = ("separation", "height", "z")
    arrays = read_archive(path)
    if len(arrays) == 1:
        return _gap_from_array(path, settings, *arrays.values())
    measured = [arrays[name] for name in value_names if name in arrays]
    if len(measured) != 1 or "y" not in arrays:
        needed = (
            f"y, one of {', '.join(value_names)}, and x except for a profile; or a single array"
        )
        raise GapError(path, f"arrays {', '.join(arrays)}", needed)
    y, values = _finite(path, arrays["y"], "y"), _finite(path, measured[0], "separation")
    if "x" in arrays:
        return _GapData(_finite(path, arrays["x"], "x"), y, values)
    _check_body(path, settings, () if "separation" not in arrays else ("y", "separation"))
    return _gap_from_profile(settings, y, values)


def _gap_from_array(path: Path, settings: scene.Gap, array: np.ndarray) -> _GapData:
    """Return the gap in an array with the fields x, y, separation, or in a matrix."""
    if array.dtype.names is not None:
        missing = [name for name in NAMES if name not in array.dtype.names]
        if missing:
            raise GapError(path, f"no field {', '.join(missing)}", f"fields {', '.join(NAMES)}")
        array = np.stack([array[name].ravel() for name in NAMES], axis=-1)
    return _gap_from_matrix(path, settings, _finite(path, array, "array"))


def first_place(places: Sequence[str]) -> str:
    """Return the first of several faulty places, with the number of others, as text."""
    return places[0] if len(places) == 1 else f"{places[0]} and {len(places) - 1} more"


def _finite(path: Path, values: ArrayLike, name: str) -> np.ndarray:
    """Return values as an array; raise a GapError unless all are finite numbers."""
    array = np.asarray(values, float)
    wrong = np.argwhere(~np.isfinite(array))
    if wrong.size:
        places = [f"{array[tuple(index)]} in {name}{index.tolist()}" for index in wrong]
        raise GapError(path, first_place(places), "finite numbers")
    return array


def _read_text(path: Path, settings: scene.Gap) -> _GapData:
    """Return the gap in a text file: points, a profile, heights, or a matrix with x and y."""
    table = read_table(path, 2**30)  # about 5000 x 5000 numbers
    names = tuple(name.lower() for name in table.names)
    units = [find_length_unit(unit) or unit for unit in table.units]
    if any(units) and not all(units):
        bare = ", ".join(name for name, unit in zip(names, units, strict=True) if not unit)
        raise GapError(path, f"a header without the unit of {bare}", "units of all columns or none")
    lateral = {unit for unit in units[:-1] if unit}
    if len(lateral) > 1:
        raise GapError(path, f"x and y in {', '.join(sorted(lateral))}", "one unit for x and y")
    unknown = [unit for unit in units if unit and unit not in LENGTHS]
    if unknown:
        raise GapError(path, f"the unit {unknown[0]}", f"units of {', '.join(LENGTHS)}")
    stated = next(iter(lateral), "mm"), units[-1] if any(units) else "mm"
    corner = parse_number(table.rows[0][0], table.decimal)
    if (
        names
        or settings.step is not None
        or (len(table.rows[0]) <= len(NAMES) and corner is not None)
    ):
        return replace(_gap_from_matrix(path, settings, table.numbers(), names), units=stated)
    table.rows[0][0] = "0"  # the corner may contain any text
    matrix = table.numbers()
    return _GapData(matrix[1:, 0], matrix[0, 1:], matrix[1:, 1:])


def _gap_from_matrix(
    path: Path, settings: scene.Gap, array: np.ndarray, names: tuple[str, ...] = ()
) -> _GapData:
    """Return the gap in a matrix: heights over a grid, a profile, or points (x, y, z)."""
    if array.ndim == 2 and settings.step is not None:
        x, y = (
            step * (np.arange(n) - 0.5 * (n - 1))
            for step, n in zip(settings.step, array.shape, strict=True)
        )
        return _GapData(x, y, array)
    if array.ndim == 2 and array.shape[1] == 2:
        _check_body(path, settings, names)
        return _gap_from_profile(settings, array[:, 0], array[:, 1])
    if names and names[:2] not in (("x", "y"), ()):
        raise GapError(path, f"columns {', '.join(names)}", "x, y and separation in this order")
    return _gap_from_points(path, array)


def _check_body(path: Path, settings: scene.Gap, names: tuple[str, ...]) -> None:
    """Raise a GapError if a profile of heights has no body and no name of a separation."""
    if settings.body is None and names[-1:] != ("separation",):
        cure = 'gap.body = "A" or "B" for heights of this body; or the header y, separation'
        raise GapError(path, "a profile without a body or the header separation", cure)


def _gap_from_profile(settings: scene.Gap, place: np.ndarray, values: np.ndarray) -> _GapData:
    """Return the gap of a profile over x or y that is constant in the other direction."""
    if place.ndim == 1 and place.size > 1 and place[0] > place[-1]:
        place, values = place[::-1], values[::-1]
    ends, both = np.array([-ALONG, ALONG]), np.stack([values, values])
    if settings.profile == "x":
        return _GapData(place, ends, both.T)
    return _GapData(ends, place, both)


_READERS = {
    ".h5": _read_hdf5,
    ".npy": _read_npy,
    ".npz": _read_npz,
    **dict.fromkeys(TEXTS, _read_text),
}


def _gap_from_points(path: Path, points: np.ndarray) -> _GapData:
    """Return the gap of points (n, 3) in any order; GapError unless they fill a grid once."""
    if points.ndim != 2 or points.shape[1] != len(NAMES):
        cure = (
            "columns x, y, separation; a profile of two columns; or gap.step = [dx, dy] of a matrix"
        )
        raise GapError(path, f"an array of shape {points.shape}", cure)
    x, i = np.unique(points[:, 0], return_inverse=True)
    y, j = np.unique(points[:, 1], return_inverse=True)
    size = len(x) * len(y)  # n² for n scattered points: do not allocate the grid before the check
    indices, counts = np.unique(np.stack((i, j)), axis=1, return_counts=True)
    filled = len(counts)
    if not len(points) == filled == size:
        value = f"{len(points)} points ({filled} distinct) of {len(x)} x and {len(y)} y"
        if filled < len(points):
            k, m = indices[:, counts > 1][:, 0]
            value += f"; x = {x[k]:g}, y = {y[m]:g} occurs {counts.max()} times"
        raise GapError(path, value, f"each of the {size} points of the grid once")
    separation = np.empty((len(x), len(y)))
    separation[i, j] = points[:, 2]
    return _GapData(x, y, separation)


def _check_grid(path: Path, data: _GapData) -> None:
    """Raise a GapError unless axes increase, shapes match, and numbers are moderate."""
    for name, axis in (("x", data.x), ("y", data.y)):
        if axis.ndim != 1 or axis.size < 2:
            raise GapError(path, f"{name} of shape {axis.shape}", f"at least 2 values of {name}")
        falls = np.flatnonzero(np.diff(axis) <= 0.0)
        if falls.size:
            places = [f"{axis[k + 1]:g} after {axis[k]:g}" for k in falls]
            value = f"{name} that does not increase, {first_place(places)}"
            raise GapError(path, value, f"increasing {name}")
    shape = (data.x.size, data.y.size)
    if data.values.shape != shape:
        raise GapError(path, f"separation of shape {data.values.shape}", f"the shape {shape}")
    largest = max(float(np.abs(array).max()) for array in (data.x, data.y, data.values))
    if largest > LARGEST:
        raise GapError(path, f"numbers up to {largest:g}", f"lengths up to {LARGEST:g} mm")
