"""Variables of the file of a fit."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from tractive_sam.fitting.design import Fit
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.problem import FitProblem
from tractive_sam.fitting.results import DONE, Gain, Intervals
from tractive_sam.store import versions

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
        (f"{series.key} {name}", number)
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
            names += [f"{series.key} {name}" for name in series.measured.data.nuisance]
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


def text_variables(texts: Mapping[str, list[str]]) -> Variables:
    """Return a variable for each name with lines of text; none for an empty list."""
    return {
        name: ((f"{name}_line",), lines, "1", f"{name}, in words")
        for name, lines in texts.items()
        if lines
    }


def attributes_of(best: Estimate, fit: Fit) -> dict[str, Any]:
    """Return the attributes of the file of a fit: status, message, chi-square, counts, cost."""
    low, high = best.chi2_range(fit.level)
    solves, rolls, convolutions = best.problem.evaluations.cost
    return {
        "status": DONE if best.iterations < fit.iterations else "not converged",
        "message": best.message,
        "chi2": best.chi2,
        "chi2_low": low,
        "chi2_high": high,
        "degrees": best.degrees,
        "scatter": best.scatter,
        "likelihood_limit": best.loss.rise * best.quantile(fit.level) ** 2,
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
