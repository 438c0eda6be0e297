"""Search for the least cost of a fit."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from tractive_sam.fitting.design import Fit, FitError
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.losses import Loss
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
                    loss=fit.loss,
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
        """Raise a FitError if the residuals at the start of a search are not finite."""
        if np.isfinite(residuals).all():
            return
        problem = self.problem
        key, cure = "fit.parameter", "other starts, or a scene that can be computed there"
        reason = problem.failures[-1] if problem.failures else "no result"
        value = f"first values at which the scene cannot be computed ({reason})"
        if np.isfinite(predicted).all():
            key, cure = "fit.data", "data of the sign of the model, or { relative = ... }"
            value = "noise by a factor, and predictions that are zero or of another sign"
        raise FitError([Fault(key, value, cure)])

    def _remaining(self, inner: "_Residuals", u: np.ndarray) -> float:
        """Return the square of the step to the minimum, in standard deviations, linearised."""
        part = u[inner.varies]
        residuals = inner.residuals(part)
        root = np.sqrt(Loss(self.fit.loss).weights(residuals))
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
