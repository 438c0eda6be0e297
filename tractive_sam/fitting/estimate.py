"""Estimates, their covariance, and what the data do not determine."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import chi2 as chi2_distribution
from scipy.stats import norm

from tractive_sam.fitting.problem import FitProblem


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
        """Sum of the squares of the residuals, chi-square."""
        return float(np.square(self.residuals).sum())

    @cached_property
    def weighted(self) -> np.ndarray:
        """Derivatives of predictions over noise, weighted by the loss, shape (points, size)."""
        return (np.sqrt(self.weights) / self.problem.noise)[:, None] * self.jacobian

    @cached_property
    def directions(self) -> "Directions":
        """Directions of the coordinates, split by whether data and priors determine them."""
        prior = self.problem.prior_jacobian(self.u)
        return Directions.of(np.concatenate([self.weighted, prior]))

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the coordinates (size, size); inf for variances of undetermined ones."""
        return self.directions.covariance

    @property
    def degrees(self) -> int:
        """Degrees of freedom: points and priors less determined coordinates."""
        return len(self.residuals) + self.problem.priors - len(self.directions.sizes)

    def chi2_range(self, level: float) -> tuple[float, float]:
        """Return the range (low, high) of chi-square for a probability; nan if degrees <= 0."""
        if self.degrees <= 0:
            return math.nan, math.nan
        low, high = chi2_distribution.interval(level, self.degrees)
        return float(low), float(high)

    def interval(self, level: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return low ends, high ends, standard deviations; nan, nan, inf if undetermined."""
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
        """Factor on the noise that makes chi-square its degrees; 1 unless `by_scatter`."""
        if not self.by_scatter or self.degrees <= 0:
            return 1.0
        return math.sqrt(self.chi2 / self.degrees)

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
        return self.scatter * np.sqrt(np.square(spread).sum(axis=1))

    def shift(self, change: np.ndarray) -> np.ndarray:
        """Return the change of the fitted coordinates if the predictions change by `change`."""
        weights = np.sqrt(self.weights) / self.problem.noise
        spread = self.directions.covariance_root
        return -spread @ (spread.T @ (self.weighted.T @ (weights * change)))


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
    NOISE = 1e-4
    """Noise of derivatives by differences, over the largest of them."""

    @classmethod
    def of(cls, weighted: np.ndarray) -> "Directions":
        """Split the coordinate space by the singular values of weighted derivatives."""
        _, sizes, rows = np.linalg.svd(weighted, full_matrices=True)
        sizes = np.pad(sizes, (0, rows.shape[0] - sizes.size))
        determined = sizes > max(cls.UNDETERMINED, cls.NOISE * sizes.max(initial=0.0))
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
