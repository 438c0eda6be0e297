"""The file of a fit: its variables, and the answers of computations for a later run."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from tractive_sam.extra_packages import xarray
from tractive_sam.fitting.case import Answer
from tractive_sam.fitting.design import Fit, FitDesign
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.problem import FitProblem
from tractive_sam.fitting.response import restore_answers
from tractive_sam.fitting.results import DONE, FitResult, Gain, Intervals
from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.run import describe_differences
from tractive_sam.scene import describe_changes, hashes_of
from tractive_sam.schema import SceneError, warn
from tractive_sam.store import (
    DamagedError,
    ResultsError,
    netcdf_format,
    read_netcdf,
    versions,
    write_netcdf,
)

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


Variables: TypeAlias = dict[str, tuple]
"""Dimensions, values, unit and description by name."""


def parameter_variables(best: Estimate, intervals: Intervals, shift: np.ndarray) -> Variables:
    """Return the variables of estimates, intervals, correlation and derivatives.

    Parameters
    ----------
    best : Estimate
        The minimum.
    intervals : Intervals
        Intervals of the estimate.
    shift : ndarray, shape (n,)
        Change of the estimates by a finer mesh.
    """
    parameters, of = best.problem.parameters, ("parameter",)
    names = _coordinate_names(best.problem)
    variables: dict[str, tuple] = {
        "parameter": (of, list(parameters.keys), "1", "key of the scene"),
        "value": (of, parameters.values(best.u), "1", "estimate"),
        "low": (of, intervals.low, "1", "low end of the interval"),
        "high": (of, intervals.high, "1", "high end of the interval"),
        "sd": (of, intervals.sd, "1", "standard deviation"),
        "start": (of, parameters.start, "1", "first value"),
        "mesh_shift": (of, shift, "1", "change of the estimate by a finer mesh"),
        "correlation": (("parameter", "other"), best.correlation, "1", "correlation"),
        "coordinate": (("coordinate",), names, "1", "parameters, and positions of profiles"),
        "jacobian": (("point", "coordinate"), best.jacobian, "1",
                     "derivative of the prediction by ln(value), or value over its scale"),
    }  # fmt: skip
    places = [
        (f"{series.name} {name}", number)
        for series, place in zip(best.problem.series, best.problem.positions, strict=True)
        if series.measured.data.profile
        for name, number in series.position.values(best.u[place]).items()
    ]
    if places:
        labels, numbers = zip(*places, strict=True)
        variables["position"] = (("position",), list(labels), "1", "position of a profile")
        variables["position_value"] = (("position",), numbers, "mm", "offset, level; tilt: 1")
    if intervals.curves:
        meaning = "parameter, its value, rise of chi-square"
        curves = np.concatenate(intervals.curves)
        variables["likelihood"] = (("likelihood_point", "of"), curves, "1", meaning)
    return variables


def _coordinate_names(problem: FitProblem) -> list[str]:
    """Return the names of all fitted coordinates: keys, and positions of profiles."""
    names = list(problem.parameters.keys)
    for series in problem.series:
        if series.measured.data.profile:
            names += [f"{series.name} {name}" for name in series.measured.data.nuisance]
    return names


def point_variables(best: Estimate, finer: np.ndarray | None) -> Variables:
    """Return the variables of measured and predicted values, residuals and mesh errors."""
    problem, of = best.problem, ("point",)
    numbers, labels, abscissas, names = [], [], [], []
    for k, series in enumerate(problem.series):
        name, places = series.measured.abscissa
        count = len(series.columns)
        numbers += [k] * series.measured.points
        labels += [*series.columns] * len(places)
        abscissas += list(np.repeat(places, count))
        names += [name] * series.measured.points
    variables: dict[str, tuple] = {
        "series": (of, numbers, "1", "data set, from 0"),
        "observation": (of, labels, "1", "observed column"),
        "abscissa_name": (of, names, "1", "what varies"),
        "abscissa": (of, np.array(abscissas, float), "1", "its value"),
        "observed": (of, problem.observed, "1", "measured value"),
        "noise": (of, best.noise, "1", "its standard deviation"),
        "predicted": (of, best.predicted, "1", "prediction"),
        "residual": (of, best.residuals, "1", "measured less predicted, over the noise"),
        "band": (of, best.band, "1", "standard deviation of the prediction by the parameters"),
        "weight": (of, best.weights, "1", "weight by the loss"),
    }
    squares = np.square(best.residuals)
    sums = [float(squares[np.array(numbers) == k].sum()) for k in range(len(problem.series))]
    variables["data_chi2"] = (("data",), sums, "1", "chi-square of each data set")
    if finer is not None:
        meaning = "prediction on a finer mesh less prediction"
        variables["model_error"] = (of, finer - best.predicted, "1", meaning)
    return variables


def attributes_of(best: Estimate, fit: Fit) -> dict[str, Any]:
    """Return the attributes of the file of a fit: status, message, chi-square, counts, cost."""
    low, high = best.chi2_range(fit.level)
    solves, rolls, convolutions = best.problem.evaluations.cost
    return {
        "format": FIT_FORMAT,
        "status": DONE if best.iterations < fit.iterations else "not converged",
        "message": best.message,
        "chi2": best.chi2,
        "chi2_low": low,
        "chi2_high": high,
        "degrees": best.degrees,
        "scatter": best.scatter,
        "likelihood_limit": best.quantile(fit.level) ** 2,
        "points": best.problem.observed.size,
        "iterations": best.iterations,
        "solves": solves,
        "rolls": rolls,
        "convolutions": convolutions,
        "version": versions()["tractive-sam"],
    }


def test_variables(gains: Sequence[Gain]) -> Variables:
    """Return the variables of the candidate tests; {} without candidates."""
    if not gains:
        return {}
    return {
        "test": (("test",), [gain.label for gain in gains], "1", "candidate of the next test"),
        "test_gain": (("test",), [gain.gain for gain in gains], "1",
                      "fall of the logarithm of the determinant of the covariance"),
        "test_sd": (("test", "parameter"), [gain.deviation for gain in gains], "1",
                    "standard deviations after the test"),
    }  # fmt: skip


def read_answers(
    document: FitDesign, path: str | PathLike[str] | None, overwrite: bool, files: Mapping[str, str]
) -> dict[str, Answer]:
    """Return stored answers of an earlier run by digest, {} if none fit; raise for another scene.

    Answers do not depend on the data: if a data file has changed, a note names it.

    Parameters
    ----------
    document : FitDesign
        The fit.
    path : path-like or None
        The file of the earlier run, if any.
    overwrite : bool
        Whether a fit of another scene may be replaced.
    files : mapping of str to str
        SHA-256 of the files of the scene and of the data, by path.

    Raises
    ------
    ResultsError
        If it is no fit, or one of another scene.
    """
    if path is None or not Path(path).exists():
        return {}
    before = open_fit(path)
    data = before.dataset
    stored = json.loads(str(data.attrs.get("files", "{}")))
    changed = describe_changes(hashes_of([document.fit.scene]), stored)
    if changed or before.design.fit.scene != document.fit.scene:
        if overwrite:
            return {}
        different = describe_differences(before.design.fit.scene, document.fit.scene, free=())
        reason = "; ".join(filter(None, (different, changed and f"{changed} has changed")))
        cure = "-o FILE.nc gives this fit another file, --overwrite replaces it"
        raise ResultsError(f"{path} holds the fit of another scene ({reason}); {cure}")
    if changed := describe_changes(files, stored):
        warn(
            f"{changed} has changed since the fit in {path}, which the fit of the new data replaces"
        )
    if "answer" not in data or data.attrs.get("version") != versions()["tractive-sam"]:
        return {}  # another version may compute other numbers
    try:
        return restore_answers(data)
    except Exception as error:  # of numbers and texts that were changed
        cure = "remove it, and fit again"
        raise DamagedError(f"{path} is damaged ({error}): {cure}") from error
