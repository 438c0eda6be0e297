"""The next test: which candidate reduces the uncertainty of the parameters most."""

from dataclasses import replace

import numpy as np

from tractive_sam.fitting.data import Measured, NoiseModel
from tractive_sam.fitting.design import CandidateTest, Data, Fit, FitError, Parameters
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.problem import FitProblem
from tractive_sam.fitting.results import Gain
from tractive_sam.fitting.series import Series
from tractive_sam.schema import Fault


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
                Series.of(f"fit.test[{k}]", measured, fit.scene, start, None)
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
    series = Series.of(key, measured, fit.scene, problem.parameters, problem.evaluations)
    return replace(problem, series=(series,))
