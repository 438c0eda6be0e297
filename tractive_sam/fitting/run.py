"""The front door: from a fit file to its result."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.extras import check_extra
from tractive_sam.fitting.answer_file import answer_variables, read_answers
from tractive_sam.fitting.data import Measured, read_measured
from tractive_sam.fitting.design import Fit, FitDesign, FitError
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.evaluations import Evaluations, InProcess, compute_with
from tractive_sam.fitting.fit_file import make_dataset, write_fit
from tractive_sam.fitting.likelihood import ProfileLikelihood
from tractive_sam.fitting.model_curve import curve_variables
from tractive_sam.fitting.next_test import check_tests, rank_tests
from tractive_sam.fitting.parameters import Parameters
from tractive_sam.fitting.prepare import SharedRecords
from tractive_sam.fitting.problem import FitProblem
from tractive_sam.fitting.results import FitResult, Intervals
from tractive_sam.fitting.search import Search
from tractive_sam.fitting.series import Series
from tractive_sam.fitting.variables import (
    attributes_of,
    parameter_variables,
    point_variables,
    test_variables,
    text_variables,
)
from tractive_sam.fitting.words import describe_undetermined, find_undetermined, list_notes
from tractive_sam.scene import hash_files, hashes_of
from tractive_sam.schema import Fault, PlausibilityWarning, warn
from tractive_sam.store import versions

Progress = Callable[[Evaluations], None]
"""Called after each computation."""


def fit(
    design: FitDesign | Mapping[str, Any] | str | PathLike[str],
    path: str | PathLike[str] | None = None,
    *,
    workers: int = 0,
    overwrite: bool = False,
    next_test: bool = False,
    progress: Progress | None = None,
) -> FitResult:
    """Fit numbers of a scene to measurements, by weighted nonlinear least squares.

    The mesh is chosen at the first values of the parameters, and adaptive stepping is replaced by
    the steps that it takes there: both are fixed while the parameters vary.

    Parameters
    ----------
    design : FitDesign, mapping or path-like
        What to fit: a fit file, or its table [fit].
    path : path-like, optional
        The result (netCDF), to which computations are streamed: an interrupted fit resumes from
        those in the file.
    workers : int
        Processes on this machine; 0: this one. Computations that take less than about 2 s together
        are not distributed.
    overwrite : bool
        Whether to replace a file that holds the fit of another scene.
    next_test : bool
        Whether to rank the candidates [[fit.test]] as well.
    progress : callable, optional
        Called after each computation.

    Returns
    -------
    FitResult
        Estimates with intervals, what is not determined, residuals, errors of the model, cost.

    Raises
    ------
    FitError
        With every fault of the design and of its data.
    ResultsError
        If the file is no fit, or the fit of another scene.
    ImportError
        Without xarray, which comes with the extra ``study``.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> creep = {"creepage.longitudinal": [-1e-3, -4e-3], "Qx_over_P": [0.1, 0.27]}
    >>> data = {"values": creep, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    >>> data["noise"] = 0.05
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]})
    >>> 0.2 < found.values["friction.mu"] < 0.4
    True
    """
    check_extra("xarray", "fit")
    check_extra("h5netcdf", "fit")
    document = _fix_files(read_design(design))
    table = document.fit
    if next_test and not table.test:
        raise FitError([Fault("fit.test", "nothing", "at least one [[fit.test]] to choose from")])
    if next_test:
        check_tests(table, Parameters.of(table))
    with compute_with(workers) as compute:
        done = Evaluations(compute, read_answers(document, path, overwrite), progress=progress)
        if path is not None:
            done.save = lambda: write_fit(path, _unfinished(document, done))
        problem = make_problem(table, done)
        best = Search(problem, table).run()
        result = _complete(document, best, next_test)
    if path is not None:
        write_fit(path, result)
    return result


def make_problem(table: Fit, done: Evaluations | None = None) -> FitProblem:
    """Read the data of a fit, fix meshes and steps at the first values, and return the problem.

    Parameters
    ----------
    table : Fit
        The [fit] table.
    done : Evaluations, optional
        Source of answers; by default computed in this process.

    Raises
    ------
    FitError
        With every fault of the data, or of a scene at the first values.
    """
    measured = _read_all(table)
    parameters = Parameters.of(table)
    _check_count(measured, parameters)
    done = done or Evaluations(InProcess())
    shared = SharedRecords(complete=False)

    def prepared() -> tuple[Series, ...]:
        return tuple(
            Series.of(f"fit.data[{k}]", table_of_data, table.scene, parameters, done, shared)
            for k, table_of_data in enumerate(measured)
        )

    prepared()
    shared.complete = True
    series = prepared()
    for note in dict.fromkeys(note for one in series for note in one.notes):
        warn(note, PlausibilityWarning)
    return FitProblem(parameters, series, done, table.step)


def read_design(design: FitDesign | Mapping[str, Any] | str | PathLike[str]) -> FitDesign:
    """Return a fit design from a file, from its tables, or as it is.

    Raises
    ------
    FitError
        With every fault.
    """
    if isinstance(design, FitDesign):
        return design
    if isinstance(design, Mapping):
        return FitDesign(fit=design.get("fit", design))
    return FitDesign.from_toml(design)


def _fix_files(document: FitDesign) -> FitDesign:
    """Return a design whose scene has its files as they are now, for all computations."""
    scene = document.fit.scene.with_current_files(fix=True)
    table = document.fit.model_copy(update={"scene": scene})
    return document.model_copy(update={"fit": table})


def _describe_files(document: FitDesign) -> str:
    """Return the SHA-256 of the files of a fit by path, as JSON: of its scene and of its data."""
    data = [str(Path(table.file).absolute()) for table in document.fit.data if table.file]
    return json.dumps(
        {path: sha for file in data for path, sha in hash_files(file).items()}
        | hashes_of([document.fit.scene])
    )


def _read_all(table: Fit) -> list[Measured]:
    """Read all data sets, and raise a FitError with the faults of all of them."""
    measured: list[Measured] = []
    faults: list[Fault] = []
    for k, data in enumerate(table.data):
        try:
            measured.append(read_measured(data, f"fit.data[{k}]"))
        except FitError as error:
            faults += error.faults
    if faults:
        raise FitError(faults)
    return measured


def _check_count(measured: list[Measured], parameters: Parameters) -> None:
    """Raise an error if there are fewer measurements and priors than unknowns."""
    points = sum(data_set.points for data_set in measured)
    positions = sum(len(data_set.data.nuisance) for data_set in measured if data_set.data.profile)
    priors = np.isfinite(parameters.prior[:, 0]).sum()
    if points + priors < len(parameters) + positions:
        sought = f"{len(parameters)} parameters"
        sought += f" and {positions} positions of profiles" if positions else ""
        cure = "at least as many points and priors as unknowns, or fewer free keys"
        raise FitError([Fault("fit.data", f"{points} points for {sought}", cure)])


def _unfinished(document: FitDesign, done: Evaluations) -> FitResult:
    """Return the result of a running fit: no estimates, only the answers so far."""
    design = ((), document.to_toml(), "1", "the fit file")
    attributes = {
        "status": "running",
        "message": f"computations stored: {len(done.stored)}; run the fit again to resume it",
        "version": versions()["tractive-sam"],
        "files": _describe_files(document),
    }
    return FitResult(make_dataset({"design": design, **answer_variables(done.stored)}, attributes))


def find_intervals(best: Estimate, table: Fit) -> Intervals:
    """Return the intervals of all parameters, linearised or by profile likelihood.

    A parameter that is not determined at the estimate may be bounded by the data on one side.
    """
    low, high, sd = best.interval(table.level)
    for k in find_undetermined(best):
        low[k], high[k] = ProfileLikelihood(best, table, k).bounds()
    curves = []
    if table.intervals == "profile":
        for k in np.flatnonzero(np.isfinite(sd)).tolist():
            low[k], high[k], curve = ProfileLikelihood(best, table, k).interval()
            curves.append(np.column_stack([np.full(len(curve), k), curve]))
    return Intervals(low, high, sd, tuple(curves))


def _complete(document: FitDesign, best: Estimate, next_test: bool) -> FitResult:
    """Return the full result of an ended search: intervals, mesh error, next tests, notes."""
    table, problem = document.fit, best.problem
    n = len(problem.parameters)
    intervals, shift = find_intervals(best, table), np.full(n, np.nan)
    finer = problem.predict_finer(best.u) if table.mesh_check else None
    if finer is not None and np.isfinite(finer).all():
        moved = problem.parameters.values((best.u + best.shift(finer - best.predicted))[:n])
        shift = moved - problem.parameters.values(best.u)
    gains = rank_tests(best, table) if next_test else []
    texts = {
        "undetermined": describe_undetermined(best, intervals),
        "notes": list_notes(best, table, intervals),
    }
    variables = {
        "design": ((), document.to_toml(), "1", "the fit file"),
        **parameter_variables(best, intervals, shift),
        **point_variables(best, finer),
        **curve_variables(best, table),
        **text_variables(texts),
        **test_variables(gains),
        **answer_variables(problem.evaluations.stored),
    }
    attributes = attributes_of(best, table) | {"files": _describe_files(document)}
    return FitResult(make_dataset(variables, attributes))
