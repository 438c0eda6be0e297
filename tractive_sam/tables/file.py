"""Write a table of creep forces as netCDF."""

from os import PathLike
from typing import Any

import numpy as np
import xarray

from tractive_sam.lookup import NAMES, CreepTable
from tractive_sam.store import TABLE_FORMAT, versions, write_netcdf

FORCES = ("Qx", "Qy", "Mz")

MEANINGS = {
    "log_ratio": "ln(a/b)",
    "poisson": "Poisson's ratio",
    "heading": "atan2(w_2, w_1)",
    "tilt": "atan2(w_3/2, sqrt(w_1^2 + w_2^2))",
    "u": "r / (r + r_0), r^2 = w_1^2 + w_2^2 + (w_3/2)^2, r_0 = 2 / (3.2 + 0.9 a/b)",
}

CHECKS = {
    "check_points": "check points, by all axes",
    "check_errors": "errors of the table at the check points, over mu P",
    "check_told": "errors that the table reports at the check points",
}

SCALING = "(Qx, Qy, Mz/c) / (mu P) over w = G c^2 / (mu P) (xi_x, xi_y, c spin), c = sqrt(a b)"

SYMMETRIES = "; (w_1, -w_2, -w_3) gives (Qx, -Qy, -Mz), (-w_1, w_2, w_3) gives (-Qx, Qy, Mz)"


def write_table(table: CreepTable, path: str | PathLike[str]) -> None:
    """Write a table; an existing file is replaced."""
    every, axes = (*table.names, *NAMES), table.law.axes
    count = len(every)
    names = [
        " ".join(every[k] for k in range(count) if d >> (count - 1 - k) & 1) or "value"
        for d in range(2**count)
    ]
    about = {k: v for k, v in table.about.items() if not k.startswith("check")}
    variables: dict[str, Any] = {
        "coefficients": (
            (*every, "derivative", "force"),
            table.law.coefficients,
            {"long_name": "value, and derivatives by the axes named", "units": "1"},
        ),
        "error_bar": (
            (*every, "force"),
            table.bars,
            {"long_name": "error bar of the contact at the node", "units": "1"},
        ),
    }
    for name, errors in zip(every, table.between, strict=True):
        if len(errors):
            meaning = f"largest error of interpolation along {name}, within its intervals"
            variables[f"between_{name}"] = (
                (f"interval_{name}", "force"),
                errors,
                {"long_name": meaning, "units": "1"},
            )
    variables |= _checked_errors(table)
    coordinates: dict[str, Any] = {
        name: ((name,), nodes, {"long_name": MEANINGS.get(name, name), "units": "1"})
        for name, nodes in zip(every, axes, strict=True)
    }
    coordinates |= {"derivative": names, "force": list(FORCES)}
    format_entries = {
        "format": TABLE_FORMAT,
        "axes": " ".join(every),
        "apart": " ".join(table.apart),
        "whole": int(table.whole),
        "scaling": SCALING + ("" if table.whole else SYMMETRIES),
        "version": versions()["tractive-sam"],
    } | dict(table.contact or {})
    dataset = xarray.Dataset(variables, coordinates, about | format_entries)
    encoding = {name: {"zlib": True, "complevel": 4} for name in ("coefficients", "error_bar")}
    write_netcdf(path, dataset, encoding)


def _checked_errors(table: CreepTable) -> dict[str, Any]:
    """Return the variables of the check points, and of the error bars of gradients."""
    variables: dict[str, Any] = {}
    for name, meaning in CHECKS.items():
        if name in table.about:
            last = "axis" if name == "check_points" else "force"
            values = np.asarray(table.about[name])
            variables[name] = (("check", last), values, {"long_name": meaning, "units": "1"})
    if table.gradient_bars is not None:
        meaning = "error bars of gradients over sqrt(K_ii K_jj): at rest, within each interval of u"
        variables["gradient_bar"] = (
            ("gradient_interval", "force", "creepage"),
            table.gradient_bars,
            {"long_name": meaning, "units": "1"},
        )
    return variables
