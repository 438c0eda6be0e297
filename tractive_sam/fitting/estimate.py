"""Estimates by least squares, their covariance and intervals, and what is not determined."""

import math
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.stats import chi2 as chi2_distribution
from scipy.stats import norm, qmc
from scipy.stats import t as student

from tractive_sam.fitting.design import Fit, FitError
from tractive_sam.fitting.problem import FitProblem, Loss
from tractive_sam.schema import Fault


@dataclass(frozen=True, eq=False)
class Estimate:
    """A minimum of the cost of a fit: coordinates, predictions, derivatives, covariance.

    Attributes
    ----------
    problem : FitProblem
        Problem that was minimised.
    u : ndarray, shape (size,)
        Coordinates of the minimum.
    predicted : ndarray, shape (points,)
        Predictions there.
    jacobian : ndarray, shape (points, size)
        Derivatives of the predictions by the coordinates.
    loss : Loss
        Loss of the residuals.
    iterations : int
        Iterations of the search.
    message : str
        How the search ended.
    by_scatter : bool
        Whether the scatter of the residuals scales the noise.
    scatter : float
        Factor on the stated noise.
    """

    fewest_degrees = 0.5
    """Degrees of freedom below which residuals say nothing about the noise or the model."""

    problem: FitProblem
    u: np.ndarray
    predicted: np.ndarray
    jacobian: np.ndarray
    loss: Loss
    iterations: int
    message: str
    by_scatter: bool = False
    scatter: float = 1.0

    @cached_property
    def noise(self) -> np.ndarray:
        """Stated standard deviations of the measured values, at the predictions, (points,)."""
        return self.problem.deviation(self.predicted)

    @cached_property
    def residuals(self) -> np.ndarray:
        """Measured less predicted, over the stated noise, shape (points,)."""
        problem = self.problem
        return -problem.noise.residuals(self.predicted, problem.observed, self.noise)

    @property
    def chi2(self) -> float:
        """Sum of the squares of the residuals, chi-square, without priors."""
        return self.problem.chi2(self.predicted)

    def cost(self, deviation: np.ndarray | None = None) -> float:
        """Return half the sum of losses, priors included, for stated standard deviations."""
        residuals = self.problem.residuals(self.u, self.predicted, deviation, self.scatter)
        return self.loss.cost(residuals, self.residuals.size)

    @cached_property
    def weights(self) -> np.ndarray:
        """Weights of the residuals by a robust loss, shape (points,); otherwise 1."""
        return self.loss.weights(self.residuals / self.scatter)

    @cached_property
    def inflation(self) -> float:
        """Factor on the variance by a robust loss, see `Loss.inflation`; otherwise 1."""
        return self.loss.inflation(self.residuals / self.scatter, self.u.size)

    @cached_property
    def row_weights(self) -> np.ndarray:
        """Factors of the derivatives of predictions in `weighted`, shape (points,)."""
        return np.sqrt(self.weights / self.inflation) / (self.scatter * self.noise)

    @cached_property
    def weighted(self) -> np.ndarray:
        """Derivatives of predictions over noise, weighted by the loss, shape (points, size)."""
        return self.row_weights[:, None] * self.jacobian

    @cached_property
    def data_directions(self) -> "Directions":
        """Directions of the coordinates, split by whether the data determine them."""
        errors = self.problem.slope_errors(self.predicted, self.jacobian)
        return Directions.of(self.weighted, self.row_weights[:, None] * errors, self._is_linear)

    @cached_property
    def directions(self) -> "Directions":
        """Directions of the coordinates, split by whether data and priors determine them."""
        prior = self.problem.prior_jacobian(self.u)
        errors = self.problem.slope_errors(self.predicted, self.jacobian)
        return Directions.of(
            np.concatenate([self.weighted, prior]),
            np.concatenate([self.row_weights[:, None] * errors, 0.0 * prior]),
            self._is_linear,
        )

    @property
    def _is_linear(self) -> np.ndarray:
        """Whether a coordinate is a value and no logarithm, shape (size,)."""
        positions = self.u.size - len(self.problem.parameters)
        return np.append(~self.problem.parameters.logarithmic, np.ones(positions, bool))

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the coordinates (size, size); inf for variances of undetermined ones."""
        return self.directions.covariance

    @cached_property
    def degrees(self) -> float:
        """Degrees of freedom: points less the coordinates that the data determine.

        A coordinate counts by the share of the data in its information: by 1 without a prior, or
        with a weak one, and by 0 if the prior alone determines it.
        """
        shares = np.square(self.weighted @ self.directions.covariance_root).sum()
        return len(self.residuals) - float(shares)

    def with_scatter(self) -> "Estimate":
        """Return the estimate with the factor on the noise that makes chi-square its degrees.

        A robust loss has a robust scatter, see `Loss.scatter`.
        """
        estimate = self
        for _ in range(50):
            if not self.by_scatter or estimate.degrees < self.fewest_degrees:
                return estimate
            scatter = self.loss.scatter(self.residuals, estimate.degrees)
            scatter, before = max(scatter, 1e-6), estimate.scatter  # above zero for exact data
            estimate = replace(estimate, scatter=scatter)
            if abs(scatter - before) < 1e-9 * scatter:
                break
        return estimate

    def quantile(self, level: float) -> float:
        """Return the half width of an interval in standard deviations: normal, or Student's t.

        If the noise follows from the scatter of the residuals, it is known as well as the degrees
        of freedom allow.
        """
        share = 0.5 + 0.5 * level
        if not self.by_scatter or self.degrees < self.fewest_degrees:
            return float(norm.ppf(share))
        return float(student.ppf(share, self.degrees))

    def chi2_range(self, level: float) -> tuple[float, float]:
        """Return the range (low, high) of chi-square for a probability; nan without degrees."""
        if self.degrees < self.fewest_degrees:
            return math.nan, math.nan
        low, high = chi2_distribution.interval(level, self.degrees)
        return float(low), float(high)

    def interval(self, level: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return low ends, high ends, standard deviations; nan, nan, inf if undetermined.

        Predictions are linear in the values of the parameters. The noise is the one of the tested
        value, see `ProfileLikelihood.rise`: with an absolute noise, the interval is the value and
        multiples of its standard deviation on both sides.
        """
        parameters = self.problem.parameters
        n = len(parameters)
        slopes = np.abs(parameters.slopes(self.u))
        variance = np.diag(self.covariance)[:n]
        low, high = np.full((2, n), math.nan)
        for k in np.flatnonzero(np.isfinite(variance)):
            ends = (self._end(int(k), sign, self.quantile(level)) for sign in (-1.0, 1.0))
            low[k], high[k] = ends
        return low, high, np.where(np.isfinite(variance), slopes * np.sqrt(variance), math.inf)

    def _end(self, k: int, sign: float, goal: float) -> float:
        """Return the low or high end of the interval of a parameter, or its bound."""
        problem, parameters = self.problem, self.problem.parameters
        variance = self.covariance[k, k]
        along = sign * np.nan_to_num(self.covariance[:, k]) / variance
        change, prior_change = self.jacobian @ along, problem.prior_jacobian(self.u) @ along
        prior = problem.prior_residuals(self.u)
        weights = self.weights / self.inflation
        # At the minimum, the slope of the priors balances that of data with the weights of the cost
        balance = self.loss.rise / self.inflation
        values = parameters.values(self.u)
        value, slope = values[k], sign * float(parameters.slopes(self.u)[k])
        low, high = parameters.limits(values)
        farthest = max(((high if slope > 0.0 else low)[k] - value) / slope, 0.0)

        def excess(step: float) -> float:
            predicted = self.predicted + step * change
            deviation = problem.deviation(predicted)
            there, here = (
                problem.noise.residuals(m, problem.observed, deviation) / self.scatter
                for m in (predicted, self.predicted)
            )
            priors = step * prior_change @ (step * prior_change + 2.0 * balance * prior)
            rise = weights @ (np.square(there) - np.square(here)) + priors
            most = 1e3 * goal**2  # a factor has no residual at zero
            return float(min(np.nan_to_num(rise, nan=most), most)) - goal**2

        inner, step = 0.0, min(goal * math.sqrt(variance), farthest)
        for _ in range(60):
            if step > inner and excess(step) >= 0.0:
                return value + slope * float(brentq(excess, inner, step, rtol=1e-9))
            if step >= farthest:
                return float((high if slope > 0.0 else low)[k])
            inner, step = step, min(1.5 * step, farthest)
        return math.nan

    @property
    def correlation(self) -> np.ndarray:
        """Correlation matrix of the parameters (n, n); nan for undetermined ones."""
        n = len(self.problem.parameters)
        covariance = self.covariance[:n, :n]
        deviation = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore"):
            return np.clip(covariance / np.outer(deviation, deviation), -1.0, 1.0)

    @property
    def band(self) -> np.ndarray:
        """Standard deviation of the predictions due to the parameters, shape (points,)."""
        return self.spread(self.jacobian)

    def spread(self, slopes: np.ndarray) -> np.ndarray:
        """Return standard deviations of numbers with derivatives `slopes` by the coordinates."""
        spread = slopes @ self.directions.covariance_root
        return np.sqrt(np.square(spread).sum(axis=1))

    def shift(self, change: np.ndarray) -> np.ndarray:
        """Return the change of the fitted coordinates if the predictions change by `change`."""
        spread = self.directions.covariance_root
        return -spread @ (spread.T @ (self.weighted.T @ (self.row_weights * change)))


@dataclass(frozen=True, eq=False)
class Directions:
    """Directions of the coordinates that data determine, how strongly, and undetermined ones.

    Attributes
    ----------
    sizes : ndarray, shape (determined,)
        Change of the residuals per unit of each direction that is determined.
    determined : ndarray, shape (size, determined)
        These directions.
    null : ndarray, shape (size, others)
        The others.
    """

    sizes: np.ndarray
    determined: np.ndarray
    null: np.ndarray

    UNDETERMINED = 0.3
    """Largest change of the residuals by an e-fold parameter that leaves it undetermined: a 95 %
    interval would span a factor of some 700."""

    @classmethod
    def of(cls, weighted: np.ndarray, errors: np.ndarray, is_linear: np.ndarray) -> "Directions":
        """Split the coordinate space by the singular values of weighted derivatives.

        A direction is determined if its singular value is above the error of the derivatives along
        it, and above `UNDETERMINED` for its logarithmic part. Errors are those of each data set:
        precise data of one parameter leave others determined by less precise ones.

        Parameters
        ----------
        weighted, errors : ndarray, shape (rows, size)
            Derivatives of the residuals, and their errors.
        is_linear : ndarray of bool, shape (size,)
            Whether a coordinate is a value and no logarithm.
        """
        _, sizes, rows = np.linalg.svd(weighted, full_matrices=True)
        sizes = np.pad(sizes, (0, rows.shape[0] - sizes.size))
        logarithmic = np.sqrt(np.square(rows[:, ~is_linear]).sum(axis=1))
        error = np.sqrt((np.square(errors) @ np.square(rows.T)).sum(axis=0))
        determined = sizes > np.maximum(cls.UNDETERMINED * logarithmic, np.maximum(error, 1e-12))
        return cls(sizes[determined], rows[determined].T, rows[~determined].T)

    @property
    def covariance_root(self) -> np.ndarray:
        """Matrix S whose product S S^T is the covariance of the determined directions."""
        return self.determined / self.sizes

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the coordinates; inf variances and nan covariances of undetermined ones."""
        covariance = self.covariance_root @ self.covariance_root.T
        lost = np.square(self.null).sum(axis=1) > self.involved**2
        covariance[lost], covariance[:, lost] = math.nan, math.nan
        covariance[lost, lost] = math.inf
        return covariance

    @property
    def involved(self) -> float:
        """Component of a direction above which a coordinate counts as part of it, 0.02."""
        return 0.02


@dataclass(frozen=True, eq=False)
class Search:
    """Search for the coordinates with the smallest cost: half the weighted sum of squares.

    Attributes
    ----------
    problem : FitProblem
        The problem.
    fit : Fit
        Loss, starts and iterations.
    scatter : float, optional
        Constant factor on the noise; by default 1, or the scatter of the residuals if the fit
        requests it.
    accuracy : float
        Change of the parameters, in standard deviations, at which the search ends. Elements that
        begin to slip leave kinks of about this size.
    converged : float
        Change of the coordinates at which the search ends. For data without noise the cost falls to
        zero, and this change decides.
    near : float
        Change of the coordinates up to which derivatives are not computed again: they change by
        about as much, and so do the intervals.
    reach : float
        Half width of the region of random starts of a parameter without bounds.
    passes : int
        Most updates of standard deviations that depend on predictions.
    """

    problem: FitProblem
    fit: Fit
    scatter: float | None = None
    accuracy: float = 0.03
    converged: float = 1e-7
    near: float = 0.01
    reach: float = math.log(3.0)
    passes: int = 20

    def run(self) -> Estimate:
        """Return the best minimum found from the first values and from any random starts.

        Raises
        ------
        FitError
            If the first values cannot be computed.
        """
        first = np.zeros(self.problem.size)
        first[: len(self.problem.parameters)] = 1.0
        best = self.minimise(self.problem.align_profiles(first))
        for u in self._random_starts():
            try:
                result = self.minimise(self.problem.align_profiles(u))
            except FitError:  # a random start that the scene does not allow
                continue
            best = result if _likelihood(result) > _likelihood(best) else best
        return best

    def _random_starts(self) -> list[np.ndarray]:
        """Return `fit.starts` - 1 random starts within bounds; 0 for positions of profiles."""
        n, count = len(self.problem.parameters), self.fit.starts - 1
        low, high = self.problem.parameters.bounds
        low = np.where(np.isfinite(low), low, 1.0 - self.reach)
        high = np.where(np.isfinite(high), high, 1.0 + self.reach)
        shares = qmc.LatinHypercube(n, rng=np.random.default_rng(self.fit.seed)).random(count)
        starts = np.zeros((count, self.problem.size))
        starts[:, :n] = low + shares * (high - low)
        return list(starts)

    def minimise(self, u: np.ndarray, fixed: int | None = None) -> Estimate:
        """Return the minimum found from one start, with at most one coordinate fixed.

        Least squares hold the standard deviations constant. Those that depend on predictions, or
        on the scatter of the residuals, follow the minimum, until it stays.

        Parameters
        ----------
        u : ndarray, shape (size,)
            Coordinates to start from.
        fixed : int, optional
            A coordinate that stays as it is.

        Raises
        ------
        FitError
            If the predictions at the start, or derivatives, cannot be computed.
        """
        problem, fit = self.problem, self.fit
        varies = np.arange(problem.size) != (-1 if fixed is None else fixed)
        predicted = problem.predict(u, derivatives=True)
        larger = np.maximum(np.abs(predicted), np.abs(problem.observed))
        noise = problem.deviation(larger), self.scatter or 1.0
        inner = _Residuals(problem, u, varies, *noise, Loss(fit.loss))
        self._check_start(problem.residuals(u, predicted, inner.deviation), predicted)
        low, high = problem.bounds
        message, iterations, stays = "no coordinate varies", 0, False
        # The cost is expected to be half the number of degrees of freedom.
        degrees = max(problem.observed.size + problem.priors - problem.size, 1)
        for number in range(self.passes):
            if varies.any():
                inner.begin(self.accuracy if number else 10.0 * self.accuracy, degrees)
                try:
                    solution = least_squares(
                        inner.residuals,
                        np.clip(u, low, high)[varies],
                        inner.slopes,
                        bounds=(low[varies], high[varies]),
                        loss=partial(Loss(fit.loss).terms, points=problem.observed.size),
                        ftol=self.accuracy**2 / degrees,
                        xtol=self.converged,
                        gtol=1e-8,
                        max_nfev=max(fit.iterations - iterations, 1),
                    )
                    u, message = inner.at(solution.x), ENDS[solution.status]
                except SmallStepError as end:
                    before, u = u, end.args[0]
                    stays = number > 0 and np.array_equal(before, u)
                    message = "the next step is small beside the uncertainty"
                iterations += inner.calls
            estimate = Estimate(
                problem, u, problem.predict(u, derivatives=True), inner.jacobian(u, self.near),
                Loss(fit.loss), iterations, message, fit.scatter, inner.scatter,
            )  # fmt: skip
            if self.scatter is None:
                estimate = estimate.with_scatter()
            if not varies.any() or stays or iterations >= fit.iterations:
                break
            inner.deviation, inner.scatter = estimate.noise, estimate.scatter
            if self._remaining(inner, u) < self.accuracy**2:
                break
        return estimate

    def _check_start(self, residuals: np.ndarray, predicted: np.ndarray) -> None:
        """Raise a FitError unless the squares of the residuals at the start are finite."""
        largest, limit = np.abs(residuals).max(initial=0.0), 1e100
        if largest < limit:
            return
        problem = self.problem
        key, cure = "fit.parameter", "other starts, or a scene that can be computed there"
        reason = [*(problem.refusals or problem.failures.values() or ["no result"])][-1]
        value = f"first values at which the scene cannot be computed ({reason})"
        if np.isfinite(largest):
            key, cure = "fit.data.noise", "values and noise in the units of the columns"
            value = f"a value that differs from the model by {largest:.2g} times its noise"
        elif np.isfinite(predicted).all():
            key, cure = "fit.data", "data of the sign of the model, or { relative = ... }"
            value = "noise by a factor, and predictions that are zero or of another sign"
        raise FitError([Fault(key, value, cure)])

    def _remaining(self, inner: "_Residuals", u: np.ndarray) -> float:
        """Return the square of the step to the minimum, in standard deviations, linearised."""
        part = u[inner.varies]
        inner.begin(0.0, 1)
        residuals = inner.residuals(part)
        root = Loss(self.fit.loss).roots(residuals, self.problem.observed.size)
        rows = root[:, None] * inner.slopes(part, self.near)
        low, high = (bound[inner.varies] for bound in self.problem.bounds)
        step = -np.linalg.lstsq(rows, root * residuals, rcond=1e-6)[0]
        step = np.clip(part + step, low, high) - part
        return float(np.square(rows @ step).sum())


class SmallStepError(Exception):
    """The next step of a search is small beside the uncertainty; it has the coordinates."""


@dataclass(eq=False)
class _Residuals:
    """Residuals and derivatives as functions of the coordinates that vary.

    Attributes
    ----------
    problem : FitProblem
        The problem.
    u : ndarray, shape (size,)
        Coordinates; those that are fixed stay as they are.
    varies : ndarray of bool, shape (size,)
        Whether a coordinate varies.
    deviation : ndarray, shape (points,)
        Stated standard deviations of the measured values, constant.
    scatter : float
        Factor on them.
    loss : Loss
        Loss of the residuals.
    last : tuple of ndarray
        Coordinates at which derivatives were computed last, and these.
    calls : int
        Computed residuals since `begin`.
    """

    problem: FitProblem
    u: np.ndarray
    varies: np.ndarray
    deviation: np.ndarray
    scatter: float
    loss: Loss
    last: tuple[np.ndarray, np.ndarray] | None = None
    calls: int = 0
    _share: float = 0.0
    _local: tuple[np.ndarray, np.ndarray, float] | None = None
    _tried: bool = False

    def begin(self, accuracy: float, degrees: int) -> None:
        """Begin a search that ends before a shortened step of less than some standard deviations.

        Elements that begin to slip leave kinks in the cost, before which `least_squares` would
        shorten its steps many times. Its scale is the chi-square of the point, over its degrees
        of freedom, so that data without noise are fitted to their last digits.
        """
        self.calls, self._share, self._local = 0, accuracy**2 / degrees, None

    def at(self, part: np.ndarray) -> np.ndarray:
        """Return all coordinates, from those that vary."""
        u = self.u.copy()
        u[self.varies] = part
        return u

    def residuals(self, part: np.ndarray) -> np.ndarray:
        """Return (predicted - measured)/noise and residuals of priors, at varying coordinates.

        Raises
        ------
        SmallStepError
            With the coordinates of the last derivatives, if a step from there was no better, and
            the next one is small.
        """
        if self._local is not None:
            there, rows, limit = self._local
            if self._tried and float(np.square(rows @ (part - there)).sum()) < limit:
                raise SmallStepError(self.at(there))
            self._tried = True
        self.calls += 1
        u = self.at(part)
        predicted = self.problem.predict(u, derivatives=True)
        return self.problem.residuals(u, predicted, self.deviation, self.scatter)

    def slopes(self, part: np.ndarray, near: float = 0.0) -> np.ndarray:
        """Return the derivatives of the residuals by the coordinates that vary."""
        u = self.at(part)
        slopes = self.jacobian(u, near)
        predicted = self.problem.predict(u, derivatives=True)
        noise = (self.deviation, self.scatter)
        rows = self.problem.residual_slopes(u, predicted, slopes, *noise)[:, self.varies]
        if not near:
            residuals, points = self.problem.residuals(u, predicted, *noise), predicted.size
            limit = self._share * 2.0 * self.loss.cost(residuals, points)
            self._tried = False
            self._local = part, self.loss.roots(residuals, points)[:, None] * rows, limit
            if self.varies.all():
                self.problem.evaluations.add_iteration(self.problem.chi2(predicted))
        return rows

    def jacobian(self, u: np.ndarray, near: float) -> np.ndarray:
        """Return the derivatives of predictions at `u`; those computed within `near` are reused."""
        if self.last is None or np.abs(self.last[0] - u).max() > near:
            self.last = u, self.problem.jacobian(u)
        return self.last[1]


def _likelihood(estimate: Estimate) -> float:
    """Return the logarithm of the likelihood of an estimate, up to a constant."""
    return -estimate.cost() - float(np.log(estimate.noise).sum())


ENDS = {
    0: "the search reached its most iterations",
    1: "the derivatives of the sum of squares are zero",
    2: "the sum of squares no longer falls",
    3: "the parameters no longer change",
    4: "neither the sum of squares nor the parameters change",
}
"""Ends of the search, by the status of `scipy.optimize.least_squares`."""


@dataclass(frozen=True, eq=False)
class ProfileLikelihood:
    """Profile likelihood of one parameter: all others are fitted again at each of its values.

    Attributes
    ----------
    found : Estimate
        The minimum.
    fit : Fit
        The loss, and the probability of the interval.
    k : int
        The parameter.
    accuracy : float
        Error of the root of the rise of the cost at which an end of an interval is accepted.
    points : int
        Most points on each side of the estimate.
    steps : int
        Most steps with the derivatives at the minimum before they are computed again.
    """

    best: Estimate
    fit: Fit
    k: int
    accuracy: float = 0.02
    points: int = 8
    steps: int = 4

    def interval(self) -> tuple[float, float, np.ndarray]:
        """Return low and high end of the interval, and (value, chi-square rise) of the curve.

        Twice the rise of the cost is chi-square distributed with one degree of freedom, or F if
        the noise follows from the scatter: the interval ends at the square of the quantile.

        Returns
        -------
        low, high : float
            Ends; NaN, or the bound of the parameter, if the data set no end.
        curve : ndarray, shape (m, 2)
            Values of the parameter, and the rise of twice the cost there.
        """
        points = [(self.best.u[self.k], 0.0)]
        low, high = (self._value(self._end(sign, points)) for sign in (-1.0, 1.0))
        curve = [(self._value(u), rise) for u, rise in sorted(points)]
        return low, high, np.array(curve)

    def _value(self, coordinate: float) -> float:
        """Return the value of the profiled parameter at its coordinate."""
        u = self.best.u.copy()
        u[self.k] = coordinate
        return float(self.best.problem.parameters.values(u)[self.k])

    @property
    def goal(self) -> float:
        """Square root of the rise of twice the cost that defines the ends of the interval."""
        return self.best.quantile(self.fit.level)

    def rise(self, u: np.ndarray, predicted: np.ndarray, gain: float = 0.0) -> float:
        """Return the rise of twice the cost from the minimum to other coordinates.

        Both costs have the noise that would be if the tested coordinates were true: one that
        follows the predictions would otherwise be one of the estimate.

        Parameters
        ----------
        u : ndarray, shape (size,)
            Coordinates.
        predicted : ndarray, shape (points,)
            Predictions there.
        gain : float
            Fall of twice the cost by a last step that is not predicted.
        """
        best = self.best
        deviation = best.problem.deviation(predicted)
        residuals = best.problem.residuals(u, predicted, deviation, best.scatter)
        cost = best.loss.cost(residuals, predicted.size)
        rise = 2.0 * (cost - best.cost(deviation)) - gain
        return max(rise, 0.0)

    def _end(self, sign: float, points: list[tuple[float, float]]) -> float:
        """Return the low (sign -1) or high end of the interval, or the bound; nan if unknown.

        The others start in proportion to the parameter: first as the covariance has it, then as
        they were at the point before.
        """
        best, k, goal = self.best, self.k, self.goal
        variance = best.covariance[k, k]
        parameters = best.problem.parameters
        limits = parameters.limits(parameters.values(best.u))
        farthest = sign * float(parameters.coordinates(limits[int(sign > 0.0)])[k] - best.u[k])
        if not math.isfinite(variance):
            return math.nan
        if farthest <= 0.0:  # the estimate is at its bound
            return float(best.u[k])
        along = np.nan_to_num(best.covariance[:, k] / variance)
        before, step = (0.0, 0.0), min(goal * math.sqrt(variance), farthest)
        for _ in range(self.points):
            start = best.u + sign * step * along
            start[k] = best.u[k] + sign * step
            try:
                u, rise = self._smallest_rise(start)
            except FitError:
                return math.nan
            along = (u - best.u) / (sign * step)
            points.append((u[k], rise))
            root = math.sqrt(rise)
            if abs(root - goal) < self.accuracy * goal:
                return float(u[k])
            if step == farthest and root < goal:
                return float(u[k])
            slope = (root - before[0]) / (step - before[1]) if step != before[1] else 0.0
            further = step + (goal - root) / slope if slope > 0.0 else 2.0 * step
            before, step = (root, step), min(np.clip(further, 0.2 * step, 4.0 * step), farthest)
        is_open = sign < 0.0 and root < goal and parameters.logarithmic[k]
        return float(best.problem.bounds[0][k]) if is_open else math.nan

    def bounds(self) -> tuple[float, float]:
        """Return the bounds of a parameter that the data do not determine at the estimate.

        Where the predictions do not depend on it at the estimate, they may do so at larger or
        smaller values. If they exclude these, the other end is the bound of the parameter.

        Returns
        -------
        low, high : float
            Smallest and largest value that agree with the data; both nan if any value does.
        """
        parameters, failures = self.best.problem.parameters, self.best.problem.failures
        before = dict(failures)
        low, high = (self._bound(sign) for sign in (-1.0, 1.0))
        failures.clear()  # the estimate does not depend on values far from it
        failures.update(before)
        if math.isnan(low) and math.isnan(high):
            return low, high
        limits = parameters.limits(parameters.values(self.best.u))
        lower, upper = (float(bound[self.k]) for bound in limits)
        return lower if math.isnan(low) else low, upper if math.isnan(high) else high

    def _bound(self, sign: float, decades: int = 3) -> float:
        """Return the value above (sign 1) or below which the data exclude the parameter, or nan.

        The search goes outwards from the estimate and from the first value, by up to `decades`.
        """
        parameters, k = self.best.problem.parameters, self.k
        if not parameters.logarithmic[k]:
            return math.nan
        estimate = float(parameters.values(self.best.u)[k])

        def excess(value: float) -> float:
            if value == estimate:
                return -self.goal
            values = parameters.values(self.best.u)
            values[k] = value
            start = self.best.u.copy()
            start[k] = parameters.coordinates(values)[k]
            return math.sqrt(self._smallest_rise(start)[1]) - self.goal

        inner = estimate
        outer = sign * max(sign * inner, sign * float(parameters.start[k]))
        limits = parameters.limits(parameters.values(self.best.u))
        farthest = float(limits[int(sign > 0.0)][k])
        for _ in range(decades + 1):
            try:
                if outer != inner and excess(outer) > 0.0:
                    return float(brentq(excess, inner, outer, xtol=1e-6 * outer, rtol=0.02))
            except FitError:
                return math.nan
            if outer == farthest:
                return math.nan
            inner, outer = outer, sign * min(sign * outer * 10.0**sign, sign * farthest)
        return math.nan

    def _smallest_rise(self, u: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the minimum (coordinates, rise) with the parameter fixed, from a start `u`.

        Gauss-Newton steps with the derivatives at the estimate, which Broyden's update corrects:
        a step costs one prediction. If they do not converge, the full search takes over.

        Parameters
        ----------
        u : ndarray, shape (size,)
            Coordinates to start from.

        Raises
        ------
        FitError
            If the predictions there cannot be computed.
        """
        problem, best = self.best.problem, self.best
        varies = np.arange(problem.size) != self.k
        slopes, before = best.jacobian, (best.u, best.predicted)
        for _ in range(self.steps):
            predicted = problem.predict(u)
            if not np.isfinite(predicted).all():
                break
            change = u - before[0]
            missed = predicted - before[1] - slopes @ change
            slopes, before = slopes + np.outer(missed, change) / (change @ change), (u, predicted)
            noise = problem.deviation(predicted), best.scatter
            residuals = problem.residuals(u, predicted, *noise)
            if not np.isfinite(residuals).all():
                break
            root = best.loss.roots(residuals, problem.observed.size)
            rows = problem.residual_slopes(u, predicted, slopes, *noise)[:, varies]
            rows, residuals = root[:, None] * rows, root * residuals
            step = -np.linalg.lstsq(rows, residuals, rcond=1e-6)[0]
            gain = -residuals @ rows @ step  # twice the fall of the cost by the step
            tested, u = u, u.copy()
            u[varies] += step
            u = np.clip(u, *problem.bounds)
            if gain < 0.5 * self.accuracy * self.goal**2:
                return u, self.rise(tested, predicted, float(gain))
        at = Search(problem, self.fit, best.scatter).minimise(u, fixed=self.k)
        return at.u, self.rise(at.u, at.predicted)
