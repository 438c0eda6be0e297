"""Intervals by the profile likelihood: one parameter is fixed, and all others are fitted again."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from tractive_sam.fitting.design import Fit, FitError
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.search import Search


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
        return self.best.quantile(self.fit.level) * math.sqrt(self.best.loss.rise)

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
        rise = 2.0 * (best.loss.cost(residuals) - best.cost(deviation)) - gain
        return max(rise, 0.0)

    def _end(self, sign: float, points: list[tuple[float, float]]) -> float:
        """Return the low (sign -1) or high end of the interval, or the bound; nan if unknown.

        The others start in proportion to the parameter: first as the covariance has it, then as
        they were at the point before.
        """
        best, k, goal = self.best, self.k, self.goal
        variance = best.covariance[k, k]
        farthest = sign * (float(best.problem.parameters.bounds[int(sign > 0.0)][k]) - best.u[k])
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
        is_open = sign < 0.0 and root < goal and best.problem.parameters.logarithmic[k]
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
        del failures[count:]  # values that the scene does not allow are no failures of the fit
        if math.isnan(low) and math.isnan(high):
            return low, high
        lower, upper = (float(bound[self.k]) for bound in parameters.value_bounds)
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
        farthest = float(parameters.value_bounds[int(sign > 0.0)][k])
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
            root = np.sqrt(best.loss.weights(residuals))
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
