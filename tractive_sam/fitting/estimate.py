"""Estimates, their covariance, robust losses, and what the data do not determine."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2 as chi2_distribution
from scipy.stats import norm
from scipy.stats import t as student

from tractive_sam.fitting.problem import FitProblem

LOSSES: Mapping[str, Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]] = {
    "linear": lambda z: (z, np.ones_like(z), np.zeros_like(z)),
    "soft_l1": lambda z: (
        2.0 * (np.sqrt(1.0 + z) - 1.0), (1.0 + z) ** -0.5, -0.5 * (1.0 + z) ** -1.5
    ),
    "huber": lambda z: (
        np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
        np.maximum(z, 1.0) ** -0.5,
        np.where(z <= 1.0, 0.0, -0.5 * np.maximum(z, 1.0) ** -1.5),
    ),
    "cauchy": lambda z: (np.log1p(z), 1.0 / (1.0 + z), -((1.0 + z) ** -2.0)),
    "arctan": lambda z: (
        np.arctan(z), 1.0 / (1.0 + z**2), -2.0 * z / np.square(1.0 + z**2)
    ),
}  # fmt: skip
"""Losses of squared residuals z and their two derivatives, see `scipy.optimize.least_squares`."""


@dataclass(frozen=True)
class Loss:
    """Loss of the residuals of data by its name in `LOSSES`; priors stay quadratic.

    In a cost, the loss is divided by the expected rise of twice itself at one standard deviation of
    the estimate. Data and priors then count by their information, and the rise of twice the cost
    is distributed as that of chi-square.

    Attributes
    ----------
    name : str
        Name of the loss.
    """

    name: str

    def terms(self, squares: np.ndarray, points: int) -> np.ndarray:
        """Return twice the costs of squared residuals, and two derivatives, (3, residuals).

        Parameters
        ----------
        squares : ndarray, shape (residuals,)
            Squared residuals: first those of `points` measured values, then those of priors.
        points : int
            Number of measured values.
        """
        terms = np.stack([squares, np.ones_like(squares), np.zeros_like(squares)])
        terms[:, :points] = np.stack(LOSSES[self.name](squares[:points])) / self.rise
        return terms

    def cost(self, residuals: np.ndarray, points: int) -> float:
        """Return the cost of residuals of `points` measured values, then of priors."""
        return 0.5 * float(self.terms(np.square(residuals), points)[0].sum())

    def roots(self, residuals: np.ndarray, points: int) -> np.ndarray:
        """Return the factors of residuals in the equivalent least squares, see `cost`."""
        return np.sqrt(self.terms(np.square(residuals), points)[1])

    def weights(self, residuals: np.ndarray) -> np.ndarray:
        """Return the weights of residuals of data: 1 for those that are small."""
        return LOSSES[self.name](np.square(residuals))[1]

    def inflation(self, residuals: np.ndarray, unknowns: int) -> float:
        """Return the variance of an estimate over the inverse of its weighted information.

        An M-estimate has the variance E(psi^2) / E(psi')^2 over the information of unit weights,
        with psi = w r. Weighted least squares would give 1 / E(w). The expectations are those of
        the residuals with outliers, but not below those of a normal residual, for which
        E(psi') = E(r psi) (Huber, Robust Statistics (1981), section 7.6, with the factor of few
        points, which belongs to the estimate from the residuals).

        Parameters
        ----------
        residuals : ndarray, shape (points,)
            Residuals over the noise.
        unknowns : int
            Number of fitted coordinates.
        """
        if self.name == "linear":
            return 1.0
        weights, squares, slopes = _normal_moments(self)
        share, z = unknowns / residuals.size, np.square(residuals)
        _, weight, change = LOSSES[self.name](z)
        bends = weight + 2.0 * z * change
        bend = max(float(bends.mean()), 0.2)  # all residuals may be outliers
        of_data = float(np.square(weight * residuals).mean() * weight.mean()) / bend**2
        of_data /= max(1.0 - share, share)
        few = (1.0 + share * float(bends.var()) / bend**2) ** 2
        return max(few * of_data, squares * weights / slopes**2)

    @property
    def rise(self) -> float:
        """Expected rise of the sum of losses at one standard deviation: 1 for least squares."""
        _, squares, slopes = _normal_moments(self)
        return squares / slopes

    def scatter(self, residuals: np.ndarray, degrees: float) -> float:
        """Return the scale s of residuals r: sum of (r/s)^2 is the degrees of freedom.

        For robust losses, squares are bounded by 1, and so are those expected (Huber's Proposal 2,
        Robust Statistics (1981), section 6.4): otherwise, one outlier would determine the scale.
        """
        squares = np.sort(np.square(residuals))
        if self.name == "linear":
            return math.sqrt(squares.sum() / degrees)
        expected = chi2_distribution.cdf(1.0, 3) + chi2_distribution.sf(1.0, 1)
        # Counting any k largest squares as 1 is an upper limit, so that the scale is the least one.
        left = degrees * expected - np.arange(squares.size)[::-1]
        return math.sqrt((np.cumsum(squares)[left > 0.0] / left[left > 0.0]).min())


@cache
def _normal_moments(loss: Loss) -> tuple[float, float, float]:
    """Return the expectations of w, (w r)^2 and w r^2 for a standard normal residual r."""
    nodes, shares = np.polynomial.hermite_e.hermegauss(99)
    shares = shares / shares.sum()
    weights = loss.weights(nodes)
    moments = (weights, np.square(weights * nodes), weights * np.square(nodes))
    means = [float(shares @ moment) for moment in moments]
    return means[0], means[1], means[2]


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
        """Sum of the squares of the residuals, chi-square."""
        return float(np.square(self.residuals).sum())

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
