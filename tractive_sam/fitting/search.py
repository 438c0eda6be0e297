"""Search for the least cost of a fit, and intervals by the profile likelihood."""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.stats import qmc

from tractive_sam.fitting.design import Fit, FitError
from tractive_sam.fitting.estimate import Estimate, Loss
from tractive_sam.fitting.problem import FitProblem
from tractive_sam.schema import Fault


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
        inner = _Residuals(problem, u, varies, problem.deviation(larger), self.scatter or 1.0)
        self._check_start(problem.residuals(u, predicted, inner.deviation), predicted)
        low, high = problem.bounds
        message, iterations = "no coordinate varies", 0
        for _ in range(self.passes):
            if varies.any():
                # The cost is expected to be half the number of degrees of freedom.
                degrees = max(problem.observed.size + problem.priors - problem.size, 1)
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
                iterations += solution.nfev
            estimate = Estimate(
                problem, u, problem.predict(u, derivatives=True), inner.jacobian(u, self.near),
                Loss(fit.loss), iterations, message, fit.scatter, inner.scatter,
            )  # fmt: skip
            if self.scatter is None:
                estimate = estimate.with_scatter()
            if not varies.any() or iterations >= fit.iterations:
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
        reason = (problem.refusals or problem.failures or ["no result"])[-1]
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
        residuals = inner.residuals(part)
        root = Loss(self.fit.loss).roots(residuals, self.problem.observed.size)
        rows = root[:, None] * inner.slopes(part, self.near)
        low, high = (bound[inner.varies] for bound in self.problem.bounds)
        step = -np.linalg.lstsq(rows, root * residuals, rcond=1e-6)[0]
        step = np.clip(part + step, low, high) - part
        return float(np.square(rows @ step).sum())


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
    last : tuple of ndarray
        Coordinates at which derivatives were computed last, and these.
    """

    problem: FitProblem
    u: np.ndarray
    varies: np.ndarray
    deviation: np.ndarray
    scatter: float
    last: tuple[np.ndarray, np.ndarray] | None = None

    def at(self, part: np.ndarray) -> np.ndarray:
        """Return all coordinates, from those that vary."""
        u = self.u.copy()
        u[self.varies] = part
        return u

    def residuals(self, part: np.ndarray) -> np.ndarray:
        """Return (predicted - measured)/noise and residuals of priors, at varying coordinates."""
        u = self.at(part)
        predicted = self.problem.predict(u, derivatives=True)
        return self.problem.residuals(u, predicted, self.deviation, self.scatter)

    def slopes(self, part: np.ndarray, near: float = 0.0) -> np.ndarray:
        """Return the derivatives of the residuals by the coordinates that vary."""
        u = self.at(part)
        slopes = self.jacobian(u, near)
        predicted = self.problem.predict(u, derivatives=True)
        noise = (self.deviation, self.scatter)
        if self.varies.all() and not near:
            residuals = self.problem.residuals(u, predicted, *noise)
            self.problem.evaluations.add_iteration(float(np.square(residuals).sum()))
        return self.problem.residual_slopes(u, predicted, slopes, *noise)[:, self.varies]

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
        count = len(failures)
        low, high = (self._bound(sign) for sign in (-1.0, 1.0))
        del failures[count:]  # the estimate does not depend on values far from it
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
