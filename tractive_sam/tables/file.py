"""Write a table of creep forces as netCDF."""

from os import PathLike
from typing import Any

import numpy as np
import xarray

from tractive_sam.lookup import NAMES, CreepTable
from tractive_sam.store import TABLE_FORMAT, versions, write_netcdf


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
    encoding = {name: {"zlib": True, "complevel": 4} for name in ("coefficients", "error_bar")}
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
            table.law.coefficients,
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
