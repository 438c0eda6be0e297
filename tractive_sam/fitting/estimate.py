"""Least squares: estimates, their covariance, and what the data do not determine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2 as chi2_distribution
from scipy.stats import norm, qmc

from tractive_sam.fitting.design import Fit, FitError
from tractive_sam.fitting.problem import FitProblem
from tractive_sam.schema import Fault

TOLERANCE = 2e-5
"""Relative change of the cost at which the search ends: some 0.01 standard deviations of a
parameter from the minimum. Elements that begin to slip leave kinks of about this size. Of
noiseless data the cost falls to zero, and `CONVERGED` decides."""

CONVERGED = 1e-7
"""Change of the coordinates at which the search ends."""

NEAR = 0.01
"""Change of the coordinates up to which derivatives are not computed again: they change by about
as much, and so do the intervals."""

RANDOM = math.log(3.0)
"""Half width of the region of random starts where a parameter has no bounds."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """A minimum of the weighted squares.

    Attributes
    ----------
    problem : Problem
        What was minimised.
    u : ndarray, shape (size,)
        Coordinates of the minimum.
    predicted : ndarray, shape (points,)
        Predictions there.
    jacobian : ndarray, shape (points, size)
        Derivatives of the predictions by the coordinates.
    weights : ndarray, shape (points,)
        Weights by a robust loss; otherwise 1.
    cost : float
        Half the sum of losses, priors included.
    iterations : int
        Iterations of the search.
    message : str
        How the search ended.
    by_scatter : bool
        Whether the scatter of the residuals scales the noise.
    """

    problem: FitProblem
    u: np.ndarray
    predicted: np.ndarray
    jacobian: np.ndarray
    weights: np.ndarray
    cost: float
    iterations: int
    message: str
    by_scatter: bool = False

    @cached_property
    def residuals(self) -> np.ndarray:
        """Measured less predicted, over the noise, shape (points,)."""
        return (self.problem.observed - self.predicted) / self.problem.noise

    @property
    def chi2(self) -> float:
        """Sum of the squares of the residuals."""
        return float(np.square(self.residuals).sum())

    @cached_property
    def weighted(self) -> np.ndarray:
        """Derivatives of the weighted residuals, without priors, shape (points, size)."""
        return (np.sqrt(self.weights) / self.problem.noise)[:, None] * self.jacobian

    @cached_property
    def directions(self) -> Directions:
        """Directions of the coordinates by how well data and priors determine them."""
        prior = self.problem.prior_jacobian(self.u)
        return Directions.of(np.concatenate([self.weighted, prior]))

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the coordinates; infinite variances of those that are not determined."""
        return self.directions.covariance

    @property
    def degrees(self) -> int:
        """Degrees of freedom: points and priors less determined coordinates."""
        priors = int(np.isfinite(self.problem.parameters.prior[:, 0]).sum())
        return len(self.residuals) + priors - len(self.directions.sizes)

    def chi2_range(self, level: float) -> tuple[float, float]:
        """Return the range in which chi-square is expected with a probability; nan without one."""
        if self.degrees <= 0:
            return math.nan, math.nan
        low, high = chi2_distribution.interval(level, self.degrees)
        return float(low), float(high)

    def interval(self, level: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return low and high ends of the linearised intervals, and standard deviations."""
        parameters = self.problem.parameters
        n = len(parameters)
        deviation = np.sqrt(np.diag(self.covariance)[:n])
        deviation = self.scatter * deviation
        reach = norm.ppf(0.5 + 0.5 * level) * deviation
        ends = [parameters.values(self.u[:n] + sign * reach) for sign in (-1.0, 1.0)]
        low, high = (np.where(np.isfinite(reach), end, math.nan) for end in ends)
        slopes = np.abs(parameters.slopes(self.u))
        return low, high, np.where(np.isfinite(reach), slopes * deviation, math.inf)

    @property
    def scatter(self) -> float:
        """Factor on the stated noise by the scatter of the residuals, where it is to be used."""
        if not self.by_scatter or self.degrees <= 0:
            return 1.0
        return math.sqrt(self.chi2 / self.degrees)

    @property
    def correlation(self) -> np.ndarray:
        """Correlation of the parameters, shape (n, n); nan of those that are not determined."""
        n = len(self.problem.parameters)
        covariance = self.covariance[:n, :n]
        deviation = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore"):
            return covariance / np.outer(deviation, deviation)

    @property
    def band(self) -> np.ndarray:
        """Standard deviation of the predictions by that of the parameters, shape (points,)."""
        return self.spread(self.jacobian)

    def spread(self, slopes: np.ndarray) -> np.ndarray:
        """Return standard deviations of numbers with derivatives `slopes`, shape (k, size)."""
        spread = slopes @ self.directions.rooted
        return self.scatter * np.sqrt(np.square(spread).sum(axis=1))

    def shift(self, change: np.ndarray) -> np.ndarray:
        """Return the change of the coordinates if the predictions change, shape (size,)."""
        weights = np.sqrt(self.weights) / self.problem.noise
        spread = self.directions.rooted
        return -spread @ (spread.T @ (self.weighted.T @ (weights * change)))


@dataclass(frozen=True, eq=False)
class Directions:
    """Directions of the coordinates, by how much the weighted residuals respond.

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
    """Change of the residuals by less than this where a parameter changes e-fold: an interval of
    95 % would span a factor of some 700."""
    NOISE = 1e-4
    """Noise of derivatives by differences, over the largest of them."""

    @classmethod
    def of(cls, weighted: np.ndarray) -> Directions:
        """Divide the coordinates by the singular values of weighted derivatives."""
        _, sizes, rows = np.linalg.svd(weighted, full_matrices=True)
        sizes = np.pad(sizes, (0, rows.shape[0] - sizes.size))
        known = sizes > max(cls.UNDETERMINED, cls.NOISE * sizes.max(initial=0.0))
        return cls(sizes[known], rows[known].T, rows[~known].T)

    @property
    def rooted(self) -> np.ndarray:
        """Matrix S with the covariance S S^T of what is determined."""
        return self.determined / self.sizes

    @property
    def covariance(self) -> np.ndarray:
        """Covariance; infinite variances of coordinates that are not determined."""
        found = self.rooted @ self.rooted.T
        lost = np.square(self.null).sum(axis=1) > self.involved**2
        found[lost], found[:, lost] = math.nan, math.nan
        found[lost, lost] = math.inf
        return found

    @property
    def involved(self) -> float:
        """Share of a direction from which on a coordinate belongs to it."""
        return 0.02


def estimate(problem: FitProblem, fit: Fit, start: np.ndarray | None = None) -> Estimate:
    """Minimise the weighted squares from the first values, and from random ones if requested.

    Parameters
    ----------
    problem : Problem
        The problem.
    fit : Fit
        Loss, starts and iterations.
    start : ndarray, optional
        Coordinates to start from; by default the first values.

    Raises
    ------
    FitError
        If the first values cannot be computed.
    """
    n = len(problem.parameters)
    first = np.zeros(problem.size)
    first[:n] = 1.0 if start is None else start[:n]
    found = search(problem, fit, problem.aligned(first))
    for u in _random_starts(problem, fit):
        try:
            other = search(problem, fit, problem.aligned(u))
        except FitError:  # a random start that the scene does not allow
            continue
        found = other if other.cost < found.cost else found
    return found


def _random_starts(problem: FitProblem, fit: Fit) -> list[np.ndarray]:
    """Return random starting points of the search, within the bounds."""
    n = len(problem.parameters)
    if fit.starts < 2:
        return []
    low, high = (np.array(one) for one in problem.parameters.bounds)
    low = np.where(np.isfinite(low), low, 1.0 - RANDOM)
    high = np.where(np.isfinite(high), high, 1.0 + RANDOM)
    shares = qmc.LatinHypercube(n, rng=np.random.default_rng(fit.seed)).random(fit.starts - 1)
    starts = np.zeros((fit.starts - 1, problem.size))
    starts[:, :n] = low + shares * (high - low)
    return list(starts)


@dataclass(eq=False)
class _Search:
    """Residuals and derivatives over the coordinates that vary.

    Attributes
    ----------
    problem : Problem
        The problem.
    u : ndarray, shape (size,)
        Coordinates; those that are held stay as they are.
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
        """Return all coordinates."""
        found = self.u.copy()
        found[self.varies] = part
        return found

    def residuals(self, part: np.ndarray) -> np.ndarray:
        """Return predicted less measured values over the noise, and those of the priors."""
        u = self.at(part)
        left = (self.problem.predict(u) - self.problem.observed) / self.problem.noise
        return np.concatenate([left, self.problem.prior_residuals(u)])

    def slopes(self, part: np.ndarray) -> np.ndarray:
        """Return the derivatives of the residuals."""
        u = self.at(part)
        self.last = u, self.problem.jacobian(u)
        rows = self.last[1] / self.problem.noise[:, None]
        return np.concatenate([rows, self.problem.prior_jacobian(u)])[:, self.varies]

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """Return the derivatives of the predictions, those of coordinates close by if known."""
        if self.last is not None and np.abs(self.last[0] - u).max() < NEAR:
            return self.last[1]
        return self.problem.jacobian(u)


def search(problem: FitProblem, fit: Fit, u: np.ndarray, fixed: int | None = None) -> Estimate:
    """Minimise from one start.

    Parameters
    ----------
    problem : Problem
        The problem.
    fit : Fit
        Loss and iterations.
    u : ndarray, shape (size,)
        Coordinates to start from.
    held : int, optional
        A coordinate that stays as it is.

    Raises
    ------
    FitError
        If the predictions at the start, or derivatives, cannot be computed.
    """
    inner = _Search(problem, u, np.arange(problem.size) != (-1 if fixed is None else fixed))
    varies, n = inner.varies, len(problem.parameters)
    if not np.isfinite(inner.residuals(u[varies])).all():
        reason = problem.failures[-1] if problem.failures else "a scene that is solved"
        cure = f"other starts, or a scene that is computed there: {reason}"
        raise FitError([Fault("fit.parameter", "first values that are not computed", cure)])
    message, iterations = "no coordinate varies", 0
    if varies.any():
        low, high = (np.full(problem.size, bound) for bound in (-np.inf, np.inf))
        low[:n], high[:n] = problem.parameters.bounds
        found = least_squares(
            inner.residuals,
            np.clip(u, low, high)[varies],
            inner.slopes,
            bounds=(low[varies], high[varies]),
            loss=fit.loss,
            ftol=TOLERANCE,
            xtol=CONVERGED,
            gtol=1e-8,
            max_nfev=fit.iterations,
        )
        u, message, iterations = inner.at(found.x), ENDS[found.status], found.nfev
    predicted = problem.predict(u)
    squares = np.square((problem.observed - predicted) / problem.noise)
    losses, weights = LOSSES[fit.loss](squares)
    prior, _ = LOSSES[fit.loss](np.square(problem.prior_residuals(u)))
    cost = 0.5 * float(losses.sum() + prior.sum())
    slopes = inner.jacobian(u)
    return Estimate(problem, u, predicted, slopes, weights, cost, iterations, message, fit.scatter)


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
