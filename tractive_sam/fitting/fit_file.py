"""The file of a fit."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.extras import check_extra
from tractive_sam.fitting.results import FitResult
from tractive_sam.optional import xarray
from tractive_sam.store import ResultsError, netcdf_format, read_netcdf, write_netcdf

FIT_FORMAT = "fit 1"
"""Attribute `format` of a file; the number is the version of the format."""


def is_fit(path: str | PathLike[str]) -> bool:
    """Return whether a file is a netCDF file with the result of a fit.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> fitting.is_fit("twin-discs.h5")
    False
    """
    return str(path).endswith(".nc") and netcdf_format(path).startswith("fit ")


def open_fit(path: str | PathLike[str]) -> FitResult:
    """Return the result of a fit from its file, also of an interrupted fit.

    Parameters
    ----------
    path : path-like
        File that `fit` wrote (netCDF).

    Raises
    ------
    ResultsError
        If the file does not exist, is damaged, or no fit of this version.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> creep = {"creepage.longitudinal": [-1e-3, -4e-3], "Qx_over_P": [0.1, 0.27]}
    >>> data = {"values": creep, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    >>> data["noise"] = 0.05
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]}, "mu.nc")
    >>> ts.open_fit("mu.nc").values == found.values
    True
    """
    if not Path(path).is_file():
        raise ResultsError(f"{path} does not exist; tractive-sam fit FIT.toml -o {path} writes it")
    dataset = read_netcdf(path)
    kind = str(dataset.attrs.get("format", ""))
    if kind != FIT_FORMAT:
        raise ResultsError(
            f"{path} has the format {kind or 'none'}, this version reads {FIT_FORMAT}: fit again"
        )
    if missing := {"status", "message"} - dataset.attrs.keys() or {"design"} - {*dataset}:
        raise ResultsError(f"{path} is damaged: it lacks {', '.join(missing)}; fit again")
    return FitResult(dataset)


def write_fit(path: str | PathLike[str], result: FitResult) -> None:
    """Write the result of a fit as netCDF; an existing file is replaced in one operation."""
    write_netcdf(path, result.dataset)


def make_dataset(
    variables: Mapping[str, tuple[tuple[str, ...], Any, str, str]], attributes: Mapping[str, Any]
) -> xarray.Dataset:
    """Return an xarray Dataset from variables (dimensions, values, unit, description).

    Parameters
    ----------
    variables : mapping of str to tuple
        Dimensions, values, unit and description by name.
    attributes : mapping
        Attributes of the dataset.
    """
    check_extra("xarray", "fit")
    data_variables = {}
    for name, (dims, values, unit, meaning) in variables.items():
        array = np.asarray(values)
        plain = array.astype(object) if array.dtype.kind == "U" else array
        data_variables[name] = (dims, plain, {"units": unit, "long_name": meaning})
    return xarray.Dataset(data_variables, attrs={"format": FIT_FORMAT, **attributes})
