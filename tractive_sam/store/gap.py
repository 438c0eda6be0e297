"""Reads measured or worn separations, and profiles as instruments write them."""

from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import ArrayLike

from tractive_sam import scene
from tractive_sam.scene import ALONG, LENGTHS, TEXTS
from tractive_sam.store.errors import GapError
from tractive_sam.store.gap_text import is_number, one_of, read_text
from tractive_sam.store.hdf5_file import open_to_read
from tractive_sam.store.hdf5_guard import member, numbers_of
from tractive_sam.store.numpy_guard import read_archive, read_array

NAMES = ("x", "y", "separation")
VALUES = ("separation", "height", "z")
"""Names under which files keep what is measured."""

LARGEST = 1e30
"""Magnitude of coordinates and separations, mm, within which nothing can overflow: that of
`scene.quantities`, without loading what reads scenes."""

Gap = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class _Found:
    """What a file holds: values over x and y, and the units that it tells of both."""

    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    units: tuple[str, str] = ("mm", "mm")


def read_gap(gap: scene.Gap | str | Path, table: str = "gap") -> Gap:
    """Read a separation on a rectangular grid.

    ===============  ==============================================================
    .h5              datasets x (n_x,), y (n_y,) and separation (n_x, n_y), in the
                     units of their attribute `units`
    .npy             a structured array with the fields x, y, separation; an array
                     (n, 3) of these columns: every point of the grid once, in any
                     order; an array (n, 2) of y and height, a profile across the
                     track; with gap.step a matrix, a row for each x
    .npz             arrays of these names; or a single array, as .npy
    .csv .txt .dat   columns x, y, separation; or two columns y, height; or a
    .tsv .xyz .asc   matrix whose first row holds y and whose first column holds x
                     (of two y with a word in the corner), without both with gap.step.
                     Between numbers a comma, a semicolon, tabs or spaces; decimal
                     points or commas. A header may tell names and units: ``y [mm]; z [um]``.
                     Lines that begin with # or % are left out
    ===============  ==============================================================

    Parameters
    ----------
    gap : Gap or path-like
        The table of a scene, or a file of separations in mm.
    table : str
        What the table is called, for messages.

    Returns
    -------
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Increasing coordinates, mm.
    separation : ndarray, shape (n_x, n_y)
        Mm.

    Raises
    ------
    GapError
        If the file cannot be read, or does not hold finite numbers on a full grid.
    """
    told = gap if isinstance(gap, scene.Gap) else scene.Gap.model_construct(file=Path(gap))
    try:
        return _read(told)
    except GapError as error:
        raise error.of(table) from error.__cause__


def _read(told: scene.Gap) -> Gap:
    if told.file is None:
        return told.in_mm(told.x, told.y, told.separation)
    path = told.file
    if path.suffix not in _READERS:
        raise GapError(path, f"the suffix {path.suffix!r}", f"one of {', '.join(_READERS)}")
    try:
        found = _READERS[path.suffix](path, told)
    except FileNotFoundError:
        raise GapError(path, "no such file", "an existing file") from None
    except GapError:
        raise
    except OSError as error:
        given = f"unreadable ({error.strerror or error})"
        raise GapError(
            path, given, "a regular file with numbers for x, y and separation"
        ) from error
    except Exception as error:  # damaged files make the libraries raise whatever comes
        raise GapError(path, f"unreadable ({error})", "numbers for x, y and separation") from error
    _check(path, found)
    return told.in_mm(found.x, found.y, found.values, found.units)


def _read_hdf5(path: Path, told: scene.Gap) -> _Found:
    with open_to_read(path) as file:
        missing = [name for name in NAMES if name not in file]
        if missing:
            raise GapError(path, f"no dataset {', '.join(missing)}", f"datasets {', '.join(NAMES)}")
        datasets = {name: numbers_of(member(file, name)) for name in NAMES}
        units = {name: _unit_of(path, name, one) for name, one in datasets.items()}
        if units["x"] != units["y"]:
            raise GapError(path, f"x in {units['x']}, y in {units['y']}", "the same unit of both")
        x, y, values = (_finite(path, datasets[name], name) for name in NAMES)
    return _Found(x, y, values, (units["x"], units["separation"]))


def _unit_of(path: Path, name: str, dataset: h5py.Dataset) -> str:
    unit = dataset.attrs.get("units", "mm")
    unit = unit.decode() if isinstance(unit, bytes) else str(unit)
    if unit not in LENGTHS:
        raise GapError(path, f"{name} in {unit}", f"units of {', '.join(LENGTHS)}")
    return unit


def _read_npy(path: Path, told: scene.Gap) -> _Found:
    return _of_array(path, told, read_array(path))


def _read_npz(path: Path, told: scene.Gap) -> _Found:
    held = read_archive(path)
    if len(held) == 1:
        return _of_array(path, told, *held.values())
    value = [held[name] for name in VALUES if name in held]
    if len(value) != 1 or "y" not in held:
        needed = f"y, one of {', '.join(VALUES)}, and x but for a profile; or a single array"
        raise GapError(path, f"arrays {', '.join(held)}", needed)
    y, values = _finite(path, held["y"], "y"), _finite(path, value[0], "separation")
    if "x" in held:
        return _Found(_finite(path, held["x"], "x"), y, values)
    _check_body(path, told, () if "separation" not in held else ("y", "separation"))
    return _profile(y, values)


def _of_array(path: Path, told: scene.Gap, array: np.ndarray) -> _Found:
    if array.dtype.names is not None:
        missing = [name for name in NAMES if name not in array.dtype.names]
        if missing:
            raise GapError(path, f"no field {', '.join(missing)}", f"fields {', '.join(NAMES)}")
        array = np.stack([array[name].ravel() for name in NAMES], axis=-1)
    return _of_numbers(path, told, _finite(path, array, "array"))


def _finite(path: Path, values: ArrayLike, name: str) -> np.ndarray:
    """An array of finite numbers."""
    array = np.asarray(values, float)
    wrong = np.argwhere(~np.isfinite(array))
    if wrong.size:
        places = [f"{array[tuple(at)]} in {name}{at.tolist()}" for at in wrong]
        raise GapError(path, one_of(places), "finite numbers")
    return array


def _read_text(path: Path, told: scene.Gap) -> _Found:
    table = read_text(path)
    named = dict(zip(table.names, table.units, strict=True))
    if "" in named.values() and set(named.values()) != {""}:
        bare = ", ".join(name for name, unit in named.items() if not unit)
        raise GapError(path, f"a header without the unit of {bare}", "units of all columns or none")
    lateral = {unit for unit in table.units[:-1] if unit}
    if len(lateral) > 1:
        raise GapError(path, f"x and y in {', '.join(sorted(lateral))}", "the same unit of both")
    units = (*(lateral or {"mm"}), table.units[-1] or "mm") if table.units else ("mm", "mm")
    few = len(table.cells[0]) <= len(NAMES) and is_number(table.cells[0][0])
    if table.names or few or told.step is not None:
        return replace(_of_numbers(path, told, table.numbers(path), table.names), units=units)
    table.cells[0][0] = "0"  # the corner may hold anything
    matrix = table.numbers(path)
    return _Found(matrix[1:, 0], matrix[0, 1:], matrix[1:, 1:])


def _of_numbers(
    path: Path, told: scene.Gap, array: np.ndarray, names: tuple[str, ...] = ()
) -> _Found:
    """What a matrix of numbers stands for: a map, a profile or points."""
    if array.ndim == 2 and told.step is not None:
        x, y = (
            step * (np.arange(n) - 0.5 * (n - 1))
            for step, n in zip(told.step, array.shape, strict=True)
        )
        return _Found(x, y, array)
    if array.ndim == 2 and array.shape[1] == 2:
        _check_body(path, told, names)
        return _profile(array[:, 0], array[:, 1])
    if names and names[:2] not in (("x", "y"), ()):
        raise GapError(path, f"columns {', '.join(names)}", "x, y and separation in this order")
    return _gridded(path, array)


def _check_body(path: Path, told: scene.Gap, names: tuple[str, ...]) -> None:
    """A profile is that of a body, or else a separation by its name."""
    if told.body is None and names[-1:] != ("separation",):
        cure = 'gap.body = "A" or "B", whose heights these are; or the header y, separation'
        raise GapError(path, "a profile that tells neither its body nor that it separates", cure)


def _profile(y: np.ndarray, values: np.ndarray) -> _Found:
    """A profile across the track, the same along it."""
    if y.ndim == 1 and y.size > 1 and y[0] > y[-1]:
        y, values = y[::-1], values[::-1]
    return _Found(np.array([-ALONG, ALONG]), y, np.stack([values, values]))


_READERS = {
    ".h5": _read_hdf5,
    ".npy": _read_npy,
    ".npz": _read_npz,
    **dict.fromkeys(TEXTS, _read_text),
}


def _gridded(path: Path, points: np.ndarray) -> _Found:
    """Sort points (n, 3) into a grid."""
    if points.ndim != 2 or points.shape[1] != len(NAMES):
        cure = (
            "columns x, y, separation; a profile of two columns; or gap.step = [dx, dy] of a matrix"
        )
        raise GapError(path, f"an array of shape {points.shape}", cure)
    x, i = np.unique(points[:, 0], return_inverse=True)
    y, j = np.unique(points[:, 1], return_inverse=True)
    size = len(x) * len(y)  # of scattered points as many as their square: not to be laid out
    places, times = np.unique(np.stack((i, j)), axis=1, return_counts=True)
    filled = len(times)
    if not len(points) == filled == size:
        found = f"{len(points)} points ({filled} distinct) of {len(x)} x and {len(y)} y"
        if filled < len(points):
            k, m = places[:, times > 1][:, 0]
            found += f"; x = {x[k]:g}, y = {y[m]:g} is there {times.max()} times"
        raise GapError(path, found, f"each of the {size} points of the grid once")
    separation = np.empty((len(x), len(y)))
    separation[i, j] = points[:, 2]
    return _Found(x, y, separation)


def _check(path: Path, found: _Found) -> None:
    for name, axis in (("x", found.x), ("y", found.y)):
        if axis.ndim != 1 or axis.size < 2:
            raise GapError(path, f"{name} of shape {axis.shape}", f"at least 2 values of {name}")
        falls = np.flatnonzero(np.diff(axis) <= 0.0)
        if falls.size:
            places = [f"{axis[k + 1]:g} after {axis[k]:g}" for k in falls]
            found = f"{name} that does not increase, {one_of(places)}"
            raise GapError(path, found, f"increasing {name}")
    wanted = (found.x.size, found.y.size)
    if found.values.shape != wanted:
        raise GapError(path, f"separation of shape {found.values.shape}", f"the shape {wanted}")
    largest = max(float(np.abs(array).max()) for array in (found.x, found.y, found.values))
    if largest > LARGEST:
        raise GapError(path, f"numbers up to {largest:g}", f"lengths up to {LARGEST:g} mm")
