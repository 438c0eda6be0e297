"""Estimates from independent rows of samples: percentiles, moments and Sobol indices.

The points of a quasi-random row are not independent: the error of an estimate follows from the
differences between the rows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from scipy.special import stdtrit


@dataclass(frozen=True, eq=False)
class Measure:
    """Empirical distribution of an outcome: atoms with weights, in rows of independent samples.

    Attributes
    ----------
    atoms : ndarray, shape (R, n)
        Values.
    weights : ndarray, shape (R, n)
        Their shares, which sum to 1 in each row; some are negative with two levels of meshes.
    """

    atoms: np.ndarray
    weights: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray) -> Measure:
        """Return the measure of values of shape (R, n); nan has no weight."""
        known = np.isfinite(values)
        shares = known / np.maximum(known.sum(axis=1, keepdims=True), 1)
        return cls(np.where(known, values, 0.0), shares)

    @classmethod
    def of_levels(cls, coarse: np.ndarray, fine: np.ndarray) -> Measure:
        """Return the two-level measure: E f = E g(c) + E (f - g(c)), g linear, for indicators too.

        It has no error of the coarse mesh, whatever g is: a good g makes its variance small. After
        M. B. Giles, Operations Research 56 (2008) 607-617, with the indicator f <= q for quantiles.

        Parameters
        ----------
        coarse : ndarray, shape (R, n)
            Values on the coarse mesh.
        fine : ndarray, shape (R, n_1)
            Values on the fine mesh of the first samples of each row.
        """
        first = coarse[:, : fine.shape[1]]
        both = np.isfinite(first) & np.isfinite(fine)
        c, f = first[both], fine[both]
        scatters = c.size > 2 and np.ptp(c) > 0.0
        slope = float(np.cov(c, f)[0, 1] / np.var(c, ddof=1)) if scatters else 1.0
        shift = float(f.mean() - slope * c.mean()) if c.size else 0.0
        parts = [slope * coarse + shift]
        parts += [np.where(both, x, np.nan) for x in (fine, slope * first + shift)]
        main, more, less = map(cls.of, parts)
        atoms = np.concatenate([main.atoms, more.atoms, less.atoms], axis=1)
        return cls(atoms, np.concatenate([main.weights, more.weights, -less.weights], axis=1))

    @cached_property
    def _curve(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the probabilities and values of the quantile function, both rising.

        With negative weights, the distribution function falls in places: its levels are put in
        rising order (V. Chernozhukov et al., Econometrica 78 (2010) 1093-1125).
        """
        used = self.weights.ravel() != 0.0
        atoms, weights = self.atoms.ravel()[used], self.weights.ravel()[used]
        order = np.argsort(atoms, kind="stable")
        atoms, levels = atoms[order], np.cumsum(weights[order] / weights.sum())[:-1]
        order = np.argsort(levels, kind="stable")
        rising = np.concatenate([[0.0], levels[order], [1.0]])
        values = atoms[0] + np.concatenate([[0.0], np.cumsum(np.diff(atoms)[order])])
        return 0.5 * (rising[1:] + rising[:-1]), values

    def quantile(self, p: float) -> float:
        """Return the value below which a share p lies; infinite beyond the sample."""
        probability, values = self._curve
        if not probability[0] <= p <= probability[-1]:
            return math.inf if p > probability[-1] else -math.inf
        return float(np.interp(p, probability, values))

    @cached_property
    def _without_one(self) -> list[Measure]:
        """Return the measures that leave out one row each."""
        return [Measure(np.delete(self.atoms, k, 0), np.delete(self.weights, k, 0))
                for k in range(len(self.weights))]  # fmt: skip

    def percentile(self, p: float, level: float) -> tuple[float, float, float]:
        """Return the quantile at p, and the low and high ends of its interval.

        The error of the share of values below the quantile is that of the jackknife over the rows;
        the ends are the quantiles at p less and plus this error (R. S. Woodruff, JASA 47 (1952)
        635-646). The shares of the rows at the quantile alone would overstate it with two levels: a
        pair on either side of it changes the distribution only between its two values.
        """
        value = self.quantile(p)
        probability, values = self._curve
        if math.isinf(value):  # beyond the sample: its last value, with an open end
            value = float(values[-1 if value > 0.0 else 0])
        rows = len(self.weights)
        shares = np.interp([one.quantile(p) for one in self._without_one], values, probability)
        error = math.sqrt(rows - 1.0) * float(np.std(shares))
        each = np.count_nonzero(self.weights > 0.0) / rows
        error = max(error, 1.0 / (each * math.sqrt(12.0 * rows)))  # the steps of the shares
        reach = float(stdtrit(rows - 1, 0.5 + 0.5 * level)) * error
        return value, self.quantile(p - reach), self.quantile(p + reach)

    def moments(self, level: float) -> np.ndarray:
        """Return value, low and high of mean and standard deviation, shape (2, 3)."""
        mean = (self.weights * self.atoms).sum(axis=1)
        square = (self.weights * np.square(self.atoms - mean.mean())).sum(axis=1)
        sd = math.sqrt(max(float(square.mean()), 0.0))
        halves = [half_width(mean, level), half_width(square, level) / (2.0 * sd) if sd else 0.0]
        centre = np.array([mean.mean(), sd])
        return np.stack([centre, centre - halves, centre + halves], axis=1)


def half_width(rows: np.ndarray, level: float) -> float:
    """Return the half width of the interval of the mean of independent numbers (Student's t)."""
    t = float(stdtrit(rows.size - 1, 0.5 + 0.5 * level))
    return t * float(np.std(rows, ddof=1)) / math.sqrt(rows.size)


@dataclass(frozen=True, eq=False)
class Model:
    """Quadratic q = a + b.z + z.Mz / 2 of independent scores z, or exp(q): its indices are exact.

    Products of powers of log-normal keys are exponentials of linear functions.

    Attributes
    ----------
    constant : float
        a.
    slope : ndarray, shape (d,)
        b.
    curvature : ndarray, shape (d, d)
        M.
    sign : float
        1 or -1 for exp(q) and -exp(q); 0 for q.
    """

    constant: float
    slope: np.ndarray
    curvature: np.ndarray
    sign: float = 0.0

    @classmethod
    def fitted(
        cls, scores: np.ndarray, values: np.ndarray, exponential: bool, curved: bool
    ) -> Model:
        """Return the least-squares model of values (n,) at scores (n, d), without M or `curved`.

        The values of an exponential have one sign; its logarithm is fitted. M needs n of at least
        four times the number of coefficients.
        """
        known, d = np.isfinite(values), scores.shape[-1]
        z, y = scores[known], values[known]
        sign = float(np.sign(y[0])) if exponential else 0.0
        i, j = np.triu_indices(d)
        terms = [np.ones((len(z), 1)), z]
        if curved and len(z) > 4 * (1 + d + len(i)):
            terms.append(z[:, i] * z[:, j])
        target = np.log(sign * y) if sign else y
        found = np.linalg.lstsq(np.concatenate(terms, axis=1), target, rcond=None)[0]
        half = np.zeros((d, d))
        half[i, j] = found[1 + d :] if len(terms) > 2 else 0.0
        return cls(float(found[0]), found[1 : 1 + d], half + half.T, sign)

    def at(self, scores: np.ndarray) -> np.ndarray:
        """Return the model at scores of shape (..., d)."""
        half = 0.5 * (scores @ self.curvature * scores).sum(axis=-1)
        q = self.constant + scores @ self.slope + half
        return self.sign * np.exp(q) if self.sign else q

    def mean(self) -> float:
        """Return the mean of the model; infinite if it has none."""
        if self.sign:
            return self.sign * _mean_exponential(self.constant, self.slope, self.curvature)
        return self.constant + 0.5 * float(np.trace(self.curvature))

    def variance(self, known: np.ndarray) -> float:
        """Return the variance of the mean for given values of some scores, by index.

        It is the covariance of two outcomes that share these scores: of an exponential, the
        integral over two sets of the others has a closed form.
        """
        b, m = self.slope[known], self.curvature[np.ix_(known, known)]
        if not self.sign:
            return float(b @ b + 0.5 * np.square(m).sum())
        n, rest = len(known), np.setdiff1d(np.arange(self.slope.size), known)
        both = np.concatenate([known, rest, rest])
        slope, curvature = self.slope[both], self.curvature[np.ix_(both, both)]
        slope[:n] *= 2.0
        curvature[:n, :n] *= 2.0
        first, second = slice(n, n + rest.size), slice(n + rest.size, None)
        curvature[first, second] = curvature[second, first] = 0.0
        return _mean_exponential(2.0 * self.constant, slope, curvature) - self.mean() ** 2


def _mean_exponential(constant: float, slope: np.ndarray, curvature: np.ndarray) -> float:
    """Return the mean of exp(a + b.z + z.Mz / 2) of independent normal scores; inf if none."""
    values, vectors = np.linalg.eigh(np.eye(slope.size) - curvature)
    if slope.size and values[0] <= 0.0:
        return math.inf
    power = constant + 0.5 * float((np.square(slope @ vectors) / values - np.log(values)).sum())
    return math.exp(power) if power < 300.0 else math.inf


def sobol_indices(
    scores: np.ndarray, values: np.ndarray, causes: Sequence[np.ndarray], level: float
) -> np.ndarray:
    """Return first-order and total Sobol indices of causes with their intervals, shape (C, 2, 3).

    First order: the correlation of f_B and f_AB, which share the cause (A. Janon et al., ESAIM:
    Probability and Statistics 18 (2014) 342-364); total: half the mean square of f_A - f_AB over
    the variance. A model with exact variances is the control variate of all means. That of a row
    is fitted to the other rows, so that rows have no bias and their differences show the error.
    The interval is that of a ratio of means over independent rows, linearised. With heavy tails, a
    few samples decide and most rows agree by chance: what the model leaves unexplained changes a
    mean by at least its share over the effective number of samples.

    Parameters
    ----------
    scores : ndarray, shape (2 + C, R, n, d)
        Scores of two samples A and B in R rows, and of A with each cause of B.
    values : ndarray, shape (2 + C, R, n)
        Outcomes; nan: unknown.
    causes : sequence of ndarray
        Indices of the scores of each of the C causes.
    level : float
        Probability of the interval.
    """
    models, rest, (rows, d) = list[Model](), np.array(math.inf), scores.shape[1:4:2]
    known = np.isfinite(values)
    same_sign = (values[known] > 0.0).all() or (values[known] < 0.0).all()
    for kind in product((False, True)[: 1 + same_sign], (False, True)):
        each = [Model.fitted(np.delete(scores, r, 1).reshape(-1, d),
                             np.delete(values, r, 1).ravel(), *kind)
                for r in range(rows)]  # fmt: skip
        errors = values - np.stack([one.at(scores[:, r]) for r, one in enumerate(each)], axis=1)
        has_variance = all(math.isfinite(one.variance(np.arange(d))) for one in each)
        if has_variance and not np.nansum(errors**2) >= np.nansum(rest**2):
            models, rest = each, errors
    means = np.array([one.mean() for one in models])[:, None]
    f = values - means - np.nanmean(rest)
    g = values - rest - means
    squares = np.square(f[:2])
    unexplained = float(np.nanmean(rest**2) / max(np.nanmean(squares), 1e-300))
    effective = float(np.nansum(squares) ** 2 / max(np.nansum(squares**2), 1e-300))
    t = float(stdtrit(rows - 1, 0.5 + 0.5 * level))
    result = np.zeros((len(causes), 2, 3))
    variance = np.array([one.variance(np.arange(d)) for one in models])
    for j, cause in enumerate(causes):
        others = np.setdiff1d(np.arange(d), cause)
        exact = [variance, [one.variance(cause) for one in models],
                 variance, variance - [one.variance(others) for one in models]]  # fmt: skip
        both = known[[0, 1, 2 + j]].all(axis=0)
        parts = np.array([
            [0.5 * (b**2 + ab**2), b * ab, 0.5 * (a**2 + ab**2), 0.5 * (a - ab) ** 2]
            for a, b, ab in (np.where(both, x[[0, 1, 2 + j]], 0.0) for x in (f, g))
        ])  # fmt: skip
        sums = (parts[0] - parts[1]).sum(axis=-1) + np.array(exact) * both.sum(axis=1)
        for k, (whole, part) in enumerate(sums.reshape(2, 2, rows)):
            if whole.sum() > 0.0:
                index = part.sum() / whole.sum()
                half = half_width((part - index * whole) * (rows / whole.sum()), level)
                half = max(half, t * math.sqrt(abs(index) * unexplained / effective))
                result[j, k] = index, index - half, index + half
    return result
