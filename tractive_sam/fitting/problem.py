"""Predictions of all data sets, and their derivatives, at any values of the parameters."""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tractive_sam.fitting import prepare
from tractive_sam.fitting.case import FitCase, Reply, is_steady, merge_cases
from tractive_sam.fitting.data import NoiseModel
from tractive_sam.fitting.design import FitError, Parameters
from tractive_sam.fitting.evaluations import Evaluations
from tractive_sam.fitting.series import Series
from tractive_sam.schema import Fault, SceneError


@dataclass(frozen=True, eq=False)
class FitProblem:
    """Data sets and parameters of a fit: predictions, residuals and derivatives at coordinates u.

    Coordinates belong to the parameters, and after them to the positions of the profiles.

    Attributes
    ----------
    parameters : Parameters
        The free parameters.
    series : tuple of Series
        The data sets.
    evaluations : Evaluations
        Source of answers.
    step : float or None
        Relative step of differences.
    """

    roll_step = 1e-2
    """Relative step of differences of rolls. Fixed steps leave a noise of some 1e-6 of the wear, so
    that a derivative has an error of 1e-4 by it, and of about half the step by curvature."""

    slope_accuracy = 1e-4
    """Relative error of derivatives."""

    parameters: Parameters
    series: tuple[Series, ...]
    evaluations: Evaluations
    step: float | None = None

    @cached_property
    def positions(self) -> list[slice]:
        """Slice of the coordinates that position each data set; empty except for profiles."""
        slices, first = [], len(self.parameters)
        for series in self.series:
            count = len(series.measured.data.nuisance) if series.measured.data.profile else 0
            slices.append(slice(first, first + count))
            first += count
        return slices

    @property
    def size(self) -> int:
        """Number of coordinates: parameters, and positions of profiles."""
        return self.positions[-1].stop

    @cached_property
    def observed(self) -> np.ndarray:
        """All measured values, shape (points,)."""
        return np.concatenate([series.measured.observed.ravel() for series in self.series])

    @cached_property
    def noise(self) -> NoiseModel:
        """Noise of all measured values, each array of shape (points,)."""
        return NoiseModel.join([series.measured.noise for series in self.series])

    def deviation(self, predicted: np.ndarray) -> np.ndarray:
        """Return the standard deviations of all measured values at predictions, (points,)."""
        return self.noise.deviation(predicted, self.observed)

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the coordinates, each of shape (size,)."""
        low, high = (np.full(self.size, bound) for bound in (-np.inf, np.inf))
        n = len(self.parameters)
        low[:n], high[:n] = self.parameters.bounds
        return low, high

    @property
    def priors(self) -> int:
        """Number of parameters with a prior."""
        return int(np.isfinite(self.parameters.prior[:, 0]).sum())

    def residuals(
        self,
        u: np.ndarray,
        predicted: np.ndarray,
        deviation: np.ndarray | None = None,
        scatter: float = 1.0,
    ) -> np.ndarray:
        """Return (predicted - measured)/noise at all points, then the residuals of the priors.

        Parameters
        ----------
        u : ndarray, shape (size,)
            Coordinates.
        predicted : ndarray, shape (points,)
            Predictions there.
        deviation : ndarray, shape (points,), optional
            Stated standard deviations of the measured values; by default those at the predictions.
        scatter : float
            Factor on the stated noise.
        """
        deviation = self.deviation(predicted) if deviation is None else deviation
        misfit = self.noise.residuals(predicted, self.observed, deviation)
        return np.concatenate([misfit / scatter, self.prior_residuals(u)])

    def residual_slopes(
        self,
        u: np.ndarray,
        predicted: np.ndarray,
        slopes: np.ndarray,
        deviation: np.ndarray,
        scatter: float = 1.0,
    ) -> np.ndarray:
        """Return the derivatives of `residuals` by u, at constant standard deviations."""
        is_log = self.noise.logarithmic > 0.0
        scale = scatter * np.where(is_log, self.noise.logarithmic * predicted, deviation)
        return np.concatenate([slopes / scale[:, None], self.prior_jacobian(u)])

    def slope_errors(self, predicted: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        """Return the errors of derivatives of the predictions, shape (points, size).

        They are `slope_accuracy` of the derivative, or of the prediction for those by differences,
        of each data set separately. A value that does not depend on a parameter has none.
        """
        errors, n = np.abs(slopes), len(self.parameters)
        first = 0
        for series in self.series:
            rows = slice(first, first + series.measured.points)
            first = rows.stop
            differs = np.array([key not in series.exact for key in self.parameters.keys])
            sizes = np.abs(predicted[rows])[:, None] * (slopes[rows, :n] != 0.0) * differs
            errors[rows, :n] = np.maximum(errors[rows, :n], sizes)
        return self.slope_accuracy * errors

    def prior_residuals(self, u: np.ndarray) -> np.ndarray:
        """Return (value - mean) / standard deviation of each parameter that has a prior."""
        mean, sd = self.parameters.prior.T
        residuals = (self.parameters.values(u) - mean) / sd
        return residuals[np.isfinite(mean)]

    def prior_jacobian(self, u: np.ndarray) -> np.ndarray:
        """Return the derivatives of `prior_residuals` by the coordinates, shape (priors, size)."""
        mean, sd = self.parameters.prior.T
        rows = np.zeros((len(self.parameters), self.size))
        np.fill_diagonal(rows, self.parameters.slopes(u) / sd)
        return rows[np.isfinite(mean)]

    def predict(self, u: np.ndarray, derivatives: bool = False) -> np.ndarray:
        """Return predicted values, shape (points,); nan if a computation failed.

        Parameters
        ----------
        u : ndarray, shape (size,)
            Coordinates.
        derivatives : bool
            Whether exact derivatives are computed as well, for a `jacobian` there.
        """
        replies = self._replies({"": u}, derivatives)
        if replies is None:
            return np.full(self.observed.size, math.nan)
        return self._collect(replies, "", u)

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """Return derivatives of predictions by coordinates, (points, size); FitError if one fails.

        Raises
        ------
        FitError
            If a computation that they need fails.
        """
        u = np.asarray(u, float)
        moved = {key: (k, self._moved(u, k)) for k, key in enumerate(self.parameters.keys)}
        replies = self._replies({"": u} | {key: at for key, (_, at) in moved.items()})
        if replies is None:
            raise FitError(
                [Fault("fit.step", "a step to values that the scene forbids", "a smaller step")]
            )
        slopes = self.parameters.slopes(u)
        rows = []
        for n, (series, place) in enumerate(zip(self.series, self.positions, strict=True)):
            block = np.zeros((series.measured.points, self.size))
            base = [replies[n, "", k] for k in range(len(series.groups))]
            here = series.predictions(base, u[place]).ravel()
            for key, (k, at) in moved.items():
                if key in series.exact:
                    by = series.predictions(base, u[place], f"/{series.exact[key]}")
                    block[:, k] = by.ravel() * slopes[k]
                else:
                    changed = [replies[n, key, g] for g in range(len(series.groups))]
                    change = series.predictions(changed, u[place]).ravel() - here
                    block[:, k] = change / (at[k] - u[k])
            if series.measured.data.profile:
                block[:, place] = series.position.slopes(*series.profile_of(base[0]), u[place])
            rows.append(block)
        jacobian = np.concatenate(rows)
        if not np.isfinite(jacobian).all():
            value = f"a step at which the computation failed ({self.failures[-1]})"
            raise FitError([Fault("fit.step", value, "another step, or other starts")])
        return jacobian

    def align_profiles(self, u: np.ndarray) -> np.ndarray:
        """Return coordinates whose profile positions fit the predicted profiles best."""
        replies = self._replies({"": u})
        aligned = np.array(u, float)
        for n, (series, place) in enumerate(zip(self.series, self.positions, strict=True)):
            here = None if replies is None else replies[n, "", 0]
            if series.measured.data.profile and here is not None and not here.failed:
                aligned[place] = series.position.align(*series.profile_of(here))
        return aligned

    def predict_finer(self, u: np.ndarray) -> np.ndarray:
        """Return predicted values (points,) on a finer mesh; nan if a computation failed."""
        cases: dict[tuple, FitCase] = {}
        values = self.parameters.values_by_key(u)
        try:
            for n, series in enumerate(self.series):
                for k, case in enumerate(series.cases(values, n, False)):
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        scene = prepare.on_finer_mesh(case.scene)
                    cases[n, "", k] = FitCase(scene, case.columns, case.places, seat=(n, k, 1))
        except SceneError:
            return np.full(self.observed.size, math.nan)
        return self._collect(self._replies_of(cases), "", u)

    def _moved(self, u: np.ndarray, k: int) -> np.ndarray:
        """Return coordinates with the k-th one changed by a difference step within its bounds."""
        step = self.step or self._default_step
        if self.parameters.integer[k]:
            step = max(step, 1.0 / self.parameters.values(u)[k])
        at = u.copy()
        beyond = u[k] + step > self.parameters.bounds[1][k]
        at[k] += -step if beyond else step
        if self.parameters.integer[k]:  # the integer used at these coordinates
            values = self.parameters.values(at)
            values[k] = round(values[k])
            at[k] = self.parameters.coordinates(values)[k]
        return at

    @cached_property
    def _default_step(self) -> float:
        """Relative step of finite differences: larger if any data set is rolled."""
        rolled = any(not is_steady(prepare.drop_tables(series.base, series.columns, series.unworn))
                     for series in self.series)  # fmt: skip
        tolerance = max(series.base.solver.tolerance for series in self.series)
        return self.roll_step if rolled else max(1e-4, tolerance**0.5)

    def _replies(
        self, points: Mapping[str, np.ndarray], derivatives: bool = True
    ) -> dict[tuple, Reply] | None:
        """Return replies at named points by (series, point, group); None if a scene is invalid.

        Exact derivatives are computed at the point "", and there only if they are wanted. At other
        points, only what has no exact derivative is computed.
        """
        cases: dict[tuple, FitCase] = {}
        try:
            for n, series in enumerate(self.series):
                for point, u in points.items():
                    if not (point and point in series.exact):
                        wanted = derivatives and not point
                        series_cases = series.cases(self.parameters.values_by_key(u), n, wanted)
                        cases |= {(n, point, k): case for k, case in enumerate(series_cases)}
        except SceneError as error:
            self.refusals.append(str(error.faults[0]))
            return None
        order = sorted(cases, key=lambda name: (name[0], name[2], name[1]))  # neighbours in turn
        near = {(n, k): case for (n, point, k), case in cases.items() if not point}
        return self._replies_of(
            {
                name: replace(cases[name], near=near.get((name[0], name[2])))
                if name[1]
                else cases[name]
                for name in order
            }
        )

    def _replies_of(self, cases: Mapping[tuple, FitCase]) -> dict[tuple, Reply]:
        """Return the replies of cases by name; cases of the same scene are computed once."""
        together = merge_cases(cases.values())
        answers = self.evaluations.answers(together)
        self.failures.extend(answer.message for answer in answers.values() if answer.message)
        names = {name: case.scene.fingerprint() for name, case in cases.items()}
        return {name: Reply(together[key], answers[key]) for name, key in names.items()}

    @cached_property
    def refusals(self) -> list[str]:
        """Faults of values that the scene does not allow, at which the search turned back."""
        return []

    @cached_property
    def failures(self) -> list[str]:
        """Messages of the computations that failed so far."""
        return []

    def _collect(self, replies: Mapping[tuple, Reply], point: str, u: np.ndarray) -> np.ndarray:
        """Return the predictions of all data sets at a point from its replies, shape (points,)."""
        predictions = []
        for n, (series, place) in enumerate(zip(self.series, self.positions, strict=True)):
            each = [replies[n, point, k] for k in range(len(series.groups))]
            if series.measured.data.profile and each[0].failed:
                predictions.append(np.full(series.measured.points, math.nan))
                continue
            predictions.append(series.predictions(each, np.asarray(u)[place]).ravel())
        return np.concatenate(predictions)
