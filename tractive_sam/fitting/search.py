"""Search for the least cost of a fit."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from tractive_sam.fitting.design import Fit, FitError
from tractive_sam.fitting.estimate import Estimate
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
    """

    problem: FitProblem
    fit: Fit
    accuracy: float = 0.03
    converged: float = 1e-7
    near: float = 0.01
    reach: float = math.log(3.0)

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
            best = result if result.cost < best.cost else best
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
        inner = _Residuals(problem, u, np.arange(problem.size) != (-1 if fixed is None else fixed))
        varies = inner.varies
        if not np.isfinite(inner.residuals(u[varies])).all():
            reason = problem.failures[-1] if problem.failures else "no result"
            value = f"first values at which the scene cannot be computed ({reason})"
            cure = "other starts, or a scene that can be computed there"
            raise FitError([Fault("fit.parameter", value, cure)])
        message, iterations = "no coordinate varies", 0
        if varies.any():
            low, high = problem.bounds
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
                max_nfev=fit.iterations,
            )
            u, message, iterations = inner.at(solution.x), ENDS[solution.status], solution.nfev
        predicted = problem.predict(u, derivatives=True)
        squares = np.square((problem.observed - predicted) / problem.noise)
        losses, weights = LOSSES[fit.loss](squares)
        prior, _ = LOSSES[fit.loss](np.square(problem.prior_residuals(u)))
        cost = 0.5 * float(losses.sum() + prior.sum())
        slopes = inner.jacobian(u, self.near)
        return Estimate(
            problem, u, predicted, slopes, weights, cost, iterations, message, fit.scatter
        )


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
    last : tuple of ndarray
        Coordinates at which derivatives were computed last, and these.
    """

    problem: FitProblem
    u: np.ndarray
    varies: np.ndarray
    last: tuple[np.ndarray, np.ndarray] | None = None

    def at(self, part: np.ndarray) -> np.ndarray:
        """Return all coordinates, from those that vary."""
        u = self.u.copy()
        u[self.varies] = part
        return u

    def residuals(self, part: np.ndarray) -> np.ndarray:
        """Return (predicted - measured)/noise and residuals of priors, at varying coordinates."""
        u = self.at(part)
        return self.problem.residuals(u, self.problem.predict(u, derivatives=True))

    def slopes(self, part: np.ndarray) -> np.ndarray:
        """Return the derivatives of the residuals by the coordinates that vary."""
        u = self.at(part)
        self.last = u, self.problem.jacobian(u)
        return self.problem.residual_slopes(*self.last)[:, self.varies]

    def jacobian(self, u: np.ndarray, near: float) -> np.ndarray:
        """Return the derivatives of predictions at `u`; those computed within `near` are reused."""
        if self.last is not None and np.abs(self.last[0] - u).max() < near:
            return self.last[1]
        return self.problem.jacobian(u)


ENDS = {
    0: "the search reached its most iterations",
    1: "the derivatives of the sum of squares are zero",
    2: "the sum of squares no longer falls",
    3: "the parameters no longer change",
    4: "neither the sum of squares nor the parameters change",
}
"""Ends of the search, by the status of `scipy.optimize.least_squares`."""

LOSSES = {
    "linear": lambda z: (z, np.ones_like(z)),
    "soft_l1": lambda z: (2.0 * (np.sqrt(1.0 + z) - 1.0), 1.0 / np.sqrt(1.0 + z)),
    "huber": lambda z: (
        np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
        np.where(z <= 1.0, 1.0, 1.0 / np.sqrt(np.maximum(z, 1.0))),
    ),
    "cauchy": lambda z: (np.log1p(z), 1.0 / (1.0 + z)),
    "arctan": lambda z: (np.arctan(z), 1.0 / (1.0 + z**2)),
}
"""Losses of squared residuals, and their derivatives, see `scipy.optimize.least_squares`."""
