"""Reads measured or worn separations."""

import csv
from pathlib import Path

import h5py
import numpy as np

from tractive_sam.store.errors import GapError

NAMES = ("x", "y", "separation")

LARGEST = 1e30
"""Magnitude of coordinates and separations, mm, within which nothing can overflow: that of
`scene.quantities`, without loading what reads scenes."""

Gap = tuple[np.ndarray, np.ndarray, np.ndarray]


def read_gap(path: str | Path) -> Gap:
    """Read a separation on a rectangular grid.

    =====  =========================================================================
    .h5    datasets x (n_x,), y (n_y,) and separation (n_x, n_y)
    .npy   a structured array with the fields x, y, separation, or an array (n, 3) of
           these columns: every point of the grid once, in any order
    .csv   the same three columns under the header ``x,y,separation``; or a matrix whose
           first row holds y and whose first column holds x
    =====  =========================================================================

    Parameters
    ----------
    path : path-like
        The file; lengths in mm.

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
    path = Path(path)
    if path.suffix not in _READERS:
        raise GapError(path, f"the suffix {path.suffix!r}", f"one of {', '.join(_READERS)}")
    try:
        x, y, separation = _READERS[path.suffix](path)
    except FileNotFoundError:
        raise GapError(path, "no such file", "an existing file") from None
    except GapError:
        raise
    except Exception as error:  # damaged files make the libraries raise whatever comes
        raise GapError(path, f"unreadable ({error})", "numbers for x, y and separation") from error
    return _checked(path, x, y, separation)


def _read_hdf5(path: Path) -> Gap:
    with h5py.File(path, "r") as file:
        missing = [name for name in NAMES if name not in file]
        if missing:
            raise GapError(path, f"no dataset {', '.join(missing)}", f"datasets {', '.join(NAMES)}")
        for name in NAMES:
            unit = file[name].attrs.get("units", "mm")
            unit = unit.decode() if isinstance(unit, bytes) else unit
            if unit != "mm":
                raise GapError(path, f"{name} in {unit}", "x, y and separation in mm")
        return tuple(np.asarray(file[name], float) for name in NAMES)


def _read_npy(path: Path) -> Gap:
    with path.open("rb") as file:
        array = np.load(file, allow_pickle=False)
    if not isinstance(array, np.ndarray):
        raise GapError(path, "an archive of arrays", "a single array, as numpy.save writes it")
    if array.dtype.names is not None:
        missing = [name for name in NAMES if name not in array.dtype.names]
        if missing:
            raise GapError(path, f"no field {', '.join(missing)}", f"fields {', '.join(NAMES)}")
        array = np.stack([array[name].ravel() for name in NAMES], axis=-1)
    return _gridded(path, np.asarray(array, float))


def _read_csv(path: Path) -> Gap:
    with path.open(newline="", encoding="utf-8-sig") as file:
        table = [[cell.strip() for cell in row] for row in csv.reader(file) if any(row)]
    widths = {len(row) for row in table}
    if not widths:
        raise GapError(path, "no rows", "a header x, y, separation and a row for each point")
    if len(widths) != 1:
        raise GapError(path, f"rows of {sorted(widths)} entries", "rows of the same length")
    if tuple(table[0]) == NAMES:
        return _gridded(path, np.array(table[1:], float).reshape(-1, len(NAMES)))
    y = np.array(table[0][1:], float)  # the corner may hold anything
    rows = np.array(table[1:], float).reshape(-1, 1 + len(y))
    return rows[:, 0], y, rows[:, 1:]


_READERS = {".h5": _read_hdf5, ".npy": _read_npy, ".csv": _read_csv}


def _gridded(path: Path, points: np.ndarray) -> Gap:
    """Sort points (n, 3) into a grid."""
    if points.ndim != 2 or points.shape[1] != len(NAMES):
        raise GapError(path, f"an array of shape {points.shape}", "columns x, y, separation")
    x, i = np.unique(points[:, 0], return_inverse=True)
    y, j = np.unique(points[:, 1], return_inverse=True)
    size = len(x) * len(y)  # of scattered points as many as their square: not to be laid out
    filled = len(np.unique(np.stack((i, j)), axis=1).T)
    if not len(points) == filled == size:
        found = f"{len(points)} points ({filled} distinct) of {len(x)} x and {len(y)} y"
        raise GapError(path, found, f"each of the {size} points of the grid once")
    separation = np.empty((len(x), len(y)))
    separation[i, j] = points[:, 2]
    return x, y, separation


def _checked(path: Path, x: np.ndarray, y: np.ndarray, separation: np.ndarray) -> Gap:
    for name, axis in (("x", x), ("y", y)):
        if axis.ndim != 1 or axis.size < 2:
            raise GapError(path, f"{name} of shape {axis.shape}", f"at least 2 values of {name}")
        # "not all" rather than "any": nan must fail, too
        if not np.all(np.diff(axis) > 0) or not np.all(np.isfinite(axis)):
            raise GapError(path, f"{name} that does not increase", f"finite, increasing {name}")
    wanted = (x.size, y.size)
    if separation.shape != wanted:
        raise GapError(path, f"separation of shape {separation.shape}", f"the shape {wanted}")
    if not np.isfinite(separation).all():
        bad = np.count_nonzero(~np.isfinite(separation))
        raise GapError(path, f"{bad} separations that are not finite", "finite numbers, mm")
    largest = max(float(np.abs(array).max()) for array in (x, y, separation))
    if largest > LARGEST:
        raise GapError(path, f"numbers up to {largest:g}", f"lengths up to {LARGEST:g} mm")
    return x, y, separation
