"""Files of creep-force tables: written as netCDF, and opened without computing contacts."""

import atexit
from collections.abc import Mapping
from functools import cache
from importlib.resources import as_file, files
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.extra_packages import xarray
from tractive_sam.lookup import CONTACT, NAMES, CreepTable, Hermite, check_axis_name
from tractive_sam.store import TABLE_FORMAT, DamagedError, read_creep_table, versions, write_netcdf


def write_table(table: CreepTable, path: str | PathLike[str]) -> None:
    """Write a creep-force table to a netCDF file; an existing file is replaced."""
    symmetries = "; (w_1, -w_2, -w_3) gives (Qx, -Qy, -Mz), (-w_1, w_2, w_3) gives (-Qx, Qy, Mz)"
    scaling = "(Qx, Qy, Mz/c) / (mu P) over w = G c^2 / (mu P) (xi_x, xi_y, c spin), c = sqrt(a b)"
    meanings = {
        "log_ratio": "ln(a/b)",
        "poisson": "Poisson's ratio",
        "heading": "atan2(w_2, w_1)",
        "tilt": "atan2(w_3/2, sqrt(w_1^2 + w_2^2))",
        "u": "r / (r + r_0), r^2 = w_1^2 + w_2^2 + (w_3/2)^2, r_0 = 2 / (3.2 + 0.9 a/b)",
    }
    forces = ("Qx", "Qy", "Mz")
    every = (*table.names, *NAMES)
    about = {k: v for k, v in table.about.items() if not k.startswith("check")}
    coordinates: dict[str, Any] = {
        name: _variable((name,), nodes, meanings.get(name, name))
        for name, nodes in zip(every, table.law.axes, strict=True)
    }
    coordinates |= {"derivative": _name_derivatives(every), "force": list(forces)}
    format_entries = {
        "format": TABLE_FORMAT,
        "axes": " ".join(every),
        "apart": " ".join(table.apart),
        "whole": int(table.whole),
        "scaling": scaling + ("" if table.whole else symmetries),
        "version": versions()["tractive-sam"],
    } | dict(table.contact or {})
    variables = _node_variables(table, every) | _checked_errors(table)
    dataset = xarray.Dataset(variables, coordinates, about | format_entries)
    # Single precision takes half the space, and the bytes of all numbers, sorted by their place in
    # the number, a seventh less.
    single = {"zlib": True, "shuffle": True, "dtype": "f4"}
    names = ("coefficients", "error_bar")
    encoding = {name: single | {"chunksizes": dataset[name].shape} for name in names}
    write_netcdf(path, dataset, encoding)


Variable = tuple[tuple[str, ...], np.ndarray, dict[str, str]]
"""Dimensions, values and attributes."""


def _variable(dims: tuple[str, ...], values: np.ndarray, meaning: str) -> Variable:
    """Return a dimensionless netCDF variable: (dims, values, attributes)."""
    return dims, values, {"long_name": meaning, "units": "1"}


def _name_derivatives(axes: tuple[str, ...]) -> list[str]:
    """Return names of all mixed first derivatives: "value", "tilt", "u", "u tilt", ...

    >>> _name_derivatives(("u", "tilt"))
    ['value', 'tilt', 'u', 'u tilt']
    """
    count = len(axes)
    return [
        " ".join(axes[k] for k in range(count) if number >> (count - 1 - k) & 1) or "value"
        for number in range(2**count)
    ]


def _node_variables(table: CreepTable, axes: tuple[str, ...]) -> dict[str, Variable]:
    """Return the netCDF variables of a table's nodes and intervals, by name."""
    variables = {
        "coefficients": _variable(
            (*axes, "derivative", "force"),
            _round_derivatives(table.law.coefficients),
            "value, and derivatives by the axes named",
        ),
        "error_bar": _variable(
            (*axes, "force"), table.bars, "error bar of the contact at the node"
        ),
    }
    for name, errors in zip(axes, table.between, strict=True):
        if len(errors):
            meaning = f"largest error of interpolation along {name}, within its intervals"
            variables[f"between_{name}"] = _variable((f"interval_{name}", "force"), errors, meaning)
    return variables


def _round_derivatives(coefficients: np.ndarray) -> np.ndarray:
    """Return the coefficients with derivatives of 20 binary digits, which take less space.

    They change by at most 1e-6, far below the error bars. The values, which come first, stay: in
    full slip they are mu P.
    """
    fraction, exponent = np.frexp(coefficients)
    rounded = np.ldexp(np.round(fraction * 2.0**20), exponent - 20)
    rounded[..., 0, :] = coefficients[..., 0, :]
    return rounded


def _checked_errors(table: CreepTable) -> dict[str, Variable]:
    """Return the netCDF variables of check points and gradient error bars, by name."""
    checks = {
        "check_points": "check points, by all axes",
        "check_errors": "errors of the table at the check points, over mu P",
        "check_told": "errors that the table reports at the check points",
    }
    variables: dict[str, Variable] = {}
    for name, meaning in checks.items():
        if name in table.about:
            last = "axis" if name == "check_points" else "force"
            variables[name] = _variable(("check", last), np.asarray(table.about[name]), meaning)
    if table.gradient_bars is not None:
        meaning = "error bars of gradients over sqrt(K_ii K_jj): at rest, within each interval of u"
        dims = ("gradient_interval", "force", "creepage")
        variables["gradient_bar"] = _variable(dims, table.gradient_bars, meaning)
    return variables


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
