"""Run a fit: from its file to its result, curves, the next test, and a density for samplers."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.extras import check_extra
from tractive_sam.fitting.case import Evaluations, InProcess, SharedRecords, compute_with, is_steady
from tractive_sam.fitting.data import Measured, NoiseModel, read_measured
from tractive_sam.fitting.design import (
    CandidateTest,
    Data,
    Fit,
    FitDesign,
    FitError,
    Noise,
    Parameters,
)
from tractive_sam.fitting.estimate import Estimate, ProfileLikelihood, Search
from tractive_sam.fitting.fit_file import (
    FIT_FORMAT,
    Variables,
    attributes_of,
    parameter_variables,
    point_variables,
    read_answers,
    test_variables,
    write_fit,
)
from tractive_sam.fitting.problem import FitProblem, Loss, Series
from tractive_sam.fitting.remarks import describe_undetermined, find_undetermined, list_notes
from tractive_sam.fitting.response import answer_variables, make_dataset
from tractive_sam.fitting.results import FitResult, Gain, Intervals
from tractive_sam.scene import hash_files, hashes_of
from tractive_sam.schema import Fault, PlausibilityWarning, warn
from tractive_sam.store import versions


def rank_tests(best: Estimate, fit: Fit) -> list[Gain]:
    """Return the candidate tests by how much they reduce the uncertainty, the best one first.

    A test is linearised at the estimate. A direction that is not determined yet counts with the
    standard deviation 10 of its coordinate.

    Raises
    ------
    FitError
        If a candidate has no valid scene, or is not solved.
    """
    n = len(best.problem.parameters)
    weak = np.eye(best.u.size)
    prior = best.problem.prior_jacobian(best.u)
    rows = np.concatenate([best.weighted, prior])
    information = rows.T @ rows + 1e-2 * weak
    target = np.arange(n) if fit.target is None else np.array([fit.free.index(fit.target)])
    before = _logarithm(information, target)
    gains = []
    for k, test in enumerate(fit.test):
        for label, measured in _measured_tests(test):
            problem = _problem_of(best.problem, f"fit.test[{k}]", measured, fit)
            slopes = problem.jacobian(best.u[:n])
            noise = problem.deviation(problem.predict(best.u[:n], derivatives=True))
            wide = np.zeros((len(slopes), best.u.size))
            wide[:, :n] = slopes / noise[:, None]
            after = information + wide.T @ wide
            deviation = np.sqrt(np.diag(np.linalg.inv(after))[:n])
            deviation *= np.abs(best.problem.parameters.slopes(best.u))
            gains.append(Gain(label, deviation, before - _logarithm(after, target)))
    return sorted(gains, key=lambda gain: -gain.gain)


def check_tests(fit: Fit, start: Parameters) -> None:
    """Raise a FitError with the faults in the scenes of all candidate tests.

    Raises
    ------
    FitError
        With the faults of those that are not valid.
    """
    faults: list[Fault] = []
    for k, test in enumerate(fit.test):
        for _, measured in _measured_tests(test):
            try:
                key = f"fit.test[{k}]"
                Series.of(key, key, measured, fit.scene, start, None)
            except FitError as error:
                faults += error.faults
    if faults:
        raise FitError(dict.fromkeys(faults))


def _logarithm(information: np.ndarray, target: np.ndarray) -> float:
    """Return log det of the covariance of the target parameters from an information matrix."""
    covariance = np.linalg.inv(information)[np.ix_(target, target)]
    return float(np.linalg.slogdet(covariance)[1])


def _measured_tests(test: CandidateTest):
    """Yield (label, data set of one unmeasured row) for each value of a candidate test."""
    entries = ", ".join(f"{key} = {value}" for key, value in test.set.items())
    for value in test.values or (None,):
        varied = {} if value is None else {str(test.vary): float(value)}
        label = ", ".join(filter(None, (*(f"{k} = {v:g}" for k, v in varied.items()), entries)))
        columns = {name: [1.0] for name in (*varied, *test.observe)}
        data = Data(
            values=columns, observe=test.observe, body=test.body, at=test.at, noise=1.0,
            set=test.set, vary=tuple(varied),
        )  # fmt: skip
        zeros = np.zeros((1, len(test.observe)))  # nothing is measured yet
        noise = NoiseModel.from_table(test.uncertainty, zeros.shape)
        place = np.array([np.nan if test.at is None else test.at])
        measured = Measured(data, (varied,), place, zeros, noise, np.empty(0))
        yield ": ".join(filter(None, (_describe_observation(test), label))), measured


def _describe_observation(test: CandidateTest) -> str:
    """Return the observed columns of a test as text, with the body and the record."""
    text = ", ".join(test.observe)
    text += f" of body {test.body}" if test.body else ""
    return text + (f" at {test.at:g}" if test.at is not None else "")


def _problem_of(problem: FitProblem, key: str, measured: Measured, fit: Fit) -> FitProblem:
    """Return a problem with the same parameters that has only this data set."""
    series = Series.of(key, key, measured, fit.scene, problem.parameters, problem.evaluations)
    return replace(problem, series=(series,))


def curve_variables(best: Estimate, fit: Fit) -> Variables:
    """Return variables of predictions between points of single contacts that vary one key.

    Only data sets of single contacts that differ in one key have them: a roll for each point would
    cost more than the fit.

    Parameters
    ----------
    best : Estimate
        The minimum.
    fit : Fit
        The scene, and the number of points.
    """
    n = len(best.problem.parameters)
    rows: list[np.ndarray] = []
    names: list[str] = []
    for number, series in enumerate(best.problem.series):
        places = _places_between(series, best, fit.curve)
        if not places.size:
            continue
        (key,) = series.measured.data.vary
        shape = (places.size, len(series.columns))
        measured = Measured(
            series.measured.data, tuple({key: float(x)} for x in places),
            np.full(places.size, np.nan), np.ones(shape), NoiseModel.from_table(Noise(absolute=1.0),
            shape), np.empty(0),
        )  # fmt: skip
        try:
            problem = _problem_of(best.problem, series.name, measured, fit)
            predicted = problem.predict(best.u[:n], derivatives=True)
            slopes = problem.jacobian(best.u[:n])
        except FitError:  # a value between the measured ones that cannot be computed
            continue
        wide = np.pad(slopes, ((0, 0), (0, best.u.size - n)))
        x = np.repeat(places, len(series.columns))
        rows.append(np.column_stack([np.full(x.size, number), x, predicted, best.spread(wide)]))
        names += [*series.columns] * places.size
    if not rows:
        return {}
    meaning = "data set, abscissa, prediction, its standard deviation"
    return {
        "curve": (("curve_point", "of_curve"), np.concatenate(rows), "1", meaning),
        "curve_column": (("curve_point",), names, "1", "predicted column"),
    }


def _places_between(series: Series, best: Estimate, points: int) -> np.ndarray:
    """Return x values between the measured ones; none for profiles, rolls or several keys."""
    x = np.unique(series.measured.abscissa[1])
    same_keys = list(series.measured.data.vary) == list(series.measured.settings[0])
    if series.measured.data.profile or not same_keys or len(series.measured.data.vary) != 1:
        return np.empty(0)
    values = best.problem.parameters.values_by_key(best.u)
    scene = series.scene_at(values, series.measured.settings[0])
    if not is_steady(scene) or not 1 < x.size < points:
        return np.empty(0)
    shares = np.linspace(0.0, x.size - 1.0, points)
    return np.setdiff1d(np.interp(shares, np.arange(x.size), x), x)


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
    document = read_design(design).fix_files()
    table = document.fit
    if next_test and not table.test:
        raise FitError([Fault("fit.test", "nothing", "at least one [[fit.test]] to choose from")])
    if next_test:
        check_tests(table, Parameters.of(table))
    with compute_with(workers) as compute:
        files = _hash_files(document)
        answers = read_answers(document, path, overwrite, files)
        done = Evaluations(compute, answers, progress=progress)
        if path is not None:
            done.save = lambda: write_fit(path, _unfinished(document, done, files))
        problem = make_problem(table, done)
        best = Search(problem, table).run()
        result = _complete(document, best, next_test, files)
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
    measured = read_all(table)
    parameters = Parameters.of(table)
    _check_count(measured, parameters)
    done = done or Evaluations(InProcess())
    shared = SharedRecords(complete=False)

    def prepared() -> tuple[Series, ...]:
        return tuple(
            Series.of(f"fit.data[{k}]", name, one, table.scene, parameters, done, shared)
            for k, (name, one) in enumerate(zip(table.names, measured, strict=True))
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
    return FitDesign.read(design)


def _hash_files(document: FitDesign) -> dict[str, str]:
    """Return the SHA-256 of the files of a fit by path: of its scene and of its data."""
    data = [str(Path(table.file).absolute()) for table in document.fit.data if table.file]
    hashes = {path: sha for file in data for path, sha in hash_files(file).items()}
    return hashes | hashes_of([document.fit.scene])


def read_all(table: Fit) -> list[Measured]:
    """Read all data sets, and raise a FitError with the faults of all of them."""
    measured: list[Measured] = []
    faults: list[Fault] = []
    for k, data in enumerate(table.data):
        try:
            measured.append(read_measured(data, f"fit.data[{k}]", table.data))
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


def _unfinished(document: FitDesign, done: Evaluations, files: Mapping[str, str]) -> FitResult:
    """Return the result of a running fit: no estimates, only the answers so far."""
    design = ((), document.to_toml(), "1", "the fit file")
    attributes = {
        "format": FIT_FORMAT,
        "status": "running",
        "message": f"computations stored: {len(done.stored)}; run the fit again to resume it",
        "version": versions()["tractive-sam"],
        "files": json.dumps(files),
    }
    return FitResult(make_dataset({"design": design, **answer_variables(done.stored)}, attributes))


def find_intervals(best: Estimate, table: Fit) -> Intervals:
    """Return the intervals of all parameters, linearised or by profile likelihood.

    A parameter that is not determined at the estimate may be bounded by the data on one side.
    """
    low, high, sd = best.interval(table.level)
    begin = best.problem.evaluations.begin
    for k in find_undetermined(best):
        begin(f"interval of {table.free[k]}")
        low[k], high[k] = ProfileLikelihood(best, table, k).bounds()
    curves = []
    if table.intervals == "profile":
        for k in np.flatnonzero(np.isfinite(sd)).tolist():
            begin(f"interval of {table.free[k]}, {k + 1} of {len(sd)}")
            low[k], high[k], curve = ProfileLikelihood(best, table, k).interval()
            curves.append(np.column_stack([np.full(len(curve), k), curve]))
    return Intervals(low, high, sd, tuple(curves))


def _complete(
    document: FitDesign, best: Estimate, next_test: bool, files: Mapping[str, str]
) -> FitResult:
    """Return the full result of an ended search: intervals, mesh error, next tests, notes."""
    table, problem = document.fit, best.problem
    n = len(problem.parameters)
    intervals, shift = find_intervals(best, table), np.full(n, np.nan)
    problem.evaluations.begin("finer mesh")
    finer = problem.predict_finer(best.u) if table.mesh_check else None
    if finer is not None and np.isfinite(finer).all():
        moved = problem.parameters.values((best.u + best.shift(finer - best.predicted))[:n])
        shift = moved - problem.parameters.values(best.u)
    problem.evaluations.begin("figures" + " and next tests" * next_test)
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
        **{
            k: ((f"{k}_line",), lines, "1", f"{k}, in words") for k, lines in texts.items() if lines
        },
        **test_variables(gains),
        **answer_variables(problem.evaluations.stored),
    }
    attributes = attributes_of(best, table) | {"files": json.dumps(files)}
    return FitResult(make_dataset(variables, attributes))


def log_posterior(
    design: FitDesign | Mapping[str, Any] | str | PathLike[str],
) -> tuple[Callable[[np.ndarray], float], np.ndarray]:
    """Return the log posterior density of a fit as a function, up to a constant, and a start.

    The density is one of the values of the parameters: a positive one that is fitted by its
    logarithm has no prior except bounds and the stated one. Positions of profiles are coordinates
    after the parameters, see `FitResult`.

    Parameters
    ----------
    design : FitDesign, mapping or path-like
        See `fit`.

    Returns
    -------
    density : callable
        Function of values, shape (size,); minus infinity outside bounds and if a computation fails.
    start : ndarray, shape (size,)
        First values.

    Raises
    ------
    FitError
        With every fault of the design and of its data.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> density, start = fitting.log_posterior(
    ...     {"scene": coarse, "free": ["friction.mu"], "data": [data]}
    ... )
    >>> density(0.3 * start / start) > density(2.0 * start)
    True
    """
    table = read_design(design).fit
    problem = make_problem(table)
    n = len(problem.parameters)
    loss = Loss(table.loss)

    def density(values: np.ndarray) -> float:
        values = np.asarray(values, float)
        inside = (values[:n] >= problem.parameters.lower) & (values[:n] <= problem.parameters.upper)
        if not (inside & ((values[:n] > 0.0) | ~problem.parameters.logarithmic)).all():
            return -np.inf
        u = np.concatenate([problem.parameters.coordinates(values[:n]), values[n:]])
        predicted = problem.predict(u)
        residuals = problem.residuals(u, predicted)
        problem.evaluations.stored.clear()  # samplers hardly return to earlier values
        if not np.isfinite(residuals).all():
            return -np.inf
        # A relative noise follows the prediction, and so does the width of its density.
        follows = problem.noise.relative > 0.0
        cost = loss.cost(residuals, predicted.size)
        return -cost - float(np.log(problem.deviation(predicted)[follows]).sum())

    first = np.ones(problem.size)
    first[n:] = 0.0
    first = problem.align_profiles(first)
    return density, np.concatenate([problem.parameters.values(first), first[n:]])
