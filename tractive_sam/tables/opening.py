"""Open tables of creep forces, built-in ones by their names, without computing contacts."""

import atexit
from collections.abc import Mapping
from functools import cache
from importlib.resources import as_file, files
from os import PathLike
from pathlib import Path
from typing import Any

from tractive_sam.lookup import CONTACT, NAMES, CreepTable, Hermite, check_axis_name
from tractive_sam.store import DamagedError, read_creep_table


def builtin_tables() -> dict[str, Path]:
    """Return the paths of the built-in creep-force tables, by name."""
    folder = files("tractive_sam.tables") / "builtin"
    names = sorted(file.name for file in folder.iterdir() if file.name.endswith(".nc"))
    return {name.removesuffix(".nc"): _path_of_builtin(name) for name in names}


@cache
def _path_of_builtin(name: str) -> Path:
    """Return the path of a built-in file, extracted until the process ends if zipped."""
    extraction = as_file(files("tractive_sam.tables") / "builtin" / name)
    path = extraction.__enter__()
    atexit.register(extraction.__exit__, None, None, None)
    return path


def is_table(name: str | PathLike[str]) -> bool:
    """Return whether a name belongs to a built-in table or ends in .nc."""
    return str(name).endswith(".nc") or str(name) in builtin_tables()


def open_table(name: str | PathLike[str]) -> CreepTable:
    """Open a creep-force table, a built-in one by name or a netCDF file.

    Parameters
    ----------
    name : str or path-like
        ``"steel"``, or the path of a file that `build_table` or ``tractive-sam table`` wrote.

    Returns
    -------
    CreepTable
        The table; calls with creepages and contacts need only NumPy.

    Raises
    ------
    ResultsError
        If the table does not exist, or the file is damaged, no table, or of another version.

    Examples
    --------
    >>> table = ts.open_table("steel")
    >>> f = table(-1e-3, 5e-4, 1e-4, a=6.0, b=4.0, load=80e3, mu=0.3, shear=80e3)
    >>> bool(f.Qx > 0.0 > f.Qy)
    True
    >>> bool(abs(f.error[0]) < 0.05 * 0.3 * 80e3)
    True
    """
    path = builtin_tables().get(str(name), Path(name))
    stored = read_creep_table(path)
    about = stored.about
    try:
        if stored.names[-len(NAMES) :] != NAMES:
            raise ValueError(
                f"axes: {' '.join(stored.names)}; allowed: {' '.join(NAMES)} at the end"
            )
        names = stored.names[: -len(NAMES)]
        for name_of_axis in names:
            check_axis_name(name_of_axis)
        _check_shapes(about, len(stored.names))
        return CreepTable(
            Hermite(stored.axes, stored.coefficients),
            names,
            stored.bars,
            stored.between,
            about,
            tuple(str(about.get("apart", "")).split()),
            bool(about.get("whole", 0)),
            {key: float(about[key]) for key in CONTACT} if CONTACT[0] in about else None,
            stored.gradient_bars,
        )
    except ValueError as error:
        raise DamagedError(f"{path} is damaged: {error}; make it again") from error


def _check_shapes(about: Mapping[str, Any], axes: int) -> None:
    """Raise a ValueError unless arrays of check points and their errors have equal lengths."""
    places = about.get("check_points")
    for name, columns in (("check_points", axes), ("check_errors", 3), ("check_told", 3)):
        if places is not None and about[name].shape != (len(places), columns):
            raise ValueError(f"{name}: {about[name].shape}; allowed: ({len(places)}, {columns})")
