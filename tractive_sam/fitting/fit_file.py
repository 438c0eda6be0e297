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
from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.schema import SceneError
from tractive_sam.store import DamagedError, ResultsError, netcdf_format, read_netcdf, write_netcdf

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
    dataset = read_netcdf(path, "fit again")
    kind = str(dataset.attrs.get("format", ""))
    if kind != FIT_FORMAT:
        raise ResultsError(
            f"{path} has the format {kind or 'none'}, this version reads {FIT_FORMAT}: fit again"
        )
    if missing := {"status", "message"} - dataset.attrs.keys() or {"design"} - {*dataset}:
        raise DamagedError(f"{path} is damaged: it lacks {', '.join(missing)}; fit again")
    result = FitResult(dataset)
    try:
        _check_content(result)
    except SceneError as error:
        raise ResultsError(f"{path}: its fit cannot be read: {error}; fit again") from error
    except (TypeError, ValueError) as error:
        raise DamagedError(f"{path} is damaged ({error}); fit again") from error
    return result


def _check_content(result: FitResult) -> None:
    """Raise a SceneError for the fit file, or a ValueError for variables that do not belong to it.

    Tables and figures rely on types, names of columns and numbers of data sets.
    """
    data, fit = result.dataset, result.design.fit
    for name, value in data.attrs.items():
        if name not in ("format", "status", "message", "version", "checksum", "files"):
            float(value)
    if not result.finished:
        return
    _check_variables(data)
    if missing := {"chi2", "chi2_low", "chi2_high", "points", "solves", "rolls"} - {*data.attrs}:
        raise ValueError(f"it lacks {', '.join(sorted(missing))}")
    widths = {"correlation": len(fit.free), "curve": 4, "likelihood": 3}
    if wrong := [name for name, n in widths.items() if name in data and data[name].shape[1] != n]:
        raise ValueError(f"{wrong[0]}: another shape")
    if [*data["parameter"].values] != [*fit.free]:
        raise ValueError("parameter: other keys than in the fit file")
    places = {"series": (data["series"].values, len(fit.data))}
    if "likelihood" in data:
        places["likelihood"] = data["likelihood"].values[:, 0], len(fit.free)
    valid = {name: np.isin(indices, np.arange(n)) for name, (indices, n) in places.items()}
    # Not a number is allowed: a mesh error or an interval may be unknown.
    valid |= {name: ~(data[name].values <= 0.0) for name in ("sd", "noise")}
    valid["band"] = ~(data["band"].values < 0.0)
    if wrong := [name for name, values in valid.items() if not values.all()]:
        raise ValueError(f"{wrong[0]}: numbers that a fit cannot have")
    columns = index_by_name(COLUMNS)
    for name in (
        *data["observation"].values,
        *data.get("curve_column", data["observation"]).values,
    ):
        if str(name).partition(" ")[0] not in columns:
            raise ValueError(f"observation: {name!r} is no column")


def _check_variables(data: xarray.Dataset) -> None:
    """Raise a ValueError unless the variables of a complete fit have their dimensions and types."""
    numbers, texts = "biuf", "OSU"
    variables = (
        ("value low high sd start mesh_shift", ("parameter",), numbers),
        ("correlation", ("parameter", "other"), numbers),
        ("series abscissa observed noise predicted residual band", ("point",), numbers),
        ("parameter", ("parameter",), texts),
        ("observation abscissa_name", ("point",), texts),
    )
    optional = (
        ("model_error", ("point",), numbers),
        ("position", ("position",), texts),
        ("position_value", ("position",), numbers),
        ("test", ("test",), texts),
        ("test_gain", ("test",), numbers),
        ("test_sd", ("test", "parameter"), numbers),
        ("curve", ("curve_point", "of_curve"), numbers),
        ("curve_column", ("curve_point",), texts),
        ("likelihood", ("likelihood_point", "of"), numbers),
        ("undetermined", ("undetermined_line",), texts),
        ("notes", ("notes_line",), texts),
        ("data_chi2", ("data",), numbers),
    )
    for names, dims, kinds in (*variables, *optional):
        for name in names.split():
            if name not in data.variables:
                if (names, dims, kinds) in variables:
                    raise ValueError(f"it lacks {name}")
            elif data[name].dims != dims or data[name].dtype.kind not in kinds:
                raise ValueError(f"{name}: another shape or type")


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
