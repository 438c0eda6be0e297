"""Intervals by the profile likelihood: one parameter held, all others fitted again."""

from __future__ import annotations

import math

import numpy as np
from scipy.stats import norm

from tractive_sam.fitting.design import Fit, FitError
from tractive_sam.fitting.estimate import Estimate, search

CLOSE = 0.02
"""Error of the root of the rise of the cost at which an end of an interval is accepted."""

MOST = 8
"""Most points on each side of the estimate."""


def profile_interval(found: Estimate, fit: Fit, k: int) -> tuple[float, float, np.ndarray]:
    """Return the ends of an interval by the profile likelihood, and the points of the curve.

    Twice the rise of the cost is chi-square distributed with one degree of freedom: the interval
    ends where it is the square of the quantile.

    Parameters
    ----------
    found : Estimate
        The minimum.
    fit : Fit
        The loss, and the probability of the interval.
    k : int
        The parameter.

    Returns
    -------
    low, high : float
        Ends; infinite where the data set no end, or the bound of the parameter.
    curve : ndarray, shape (m, 2)
        Values of the parameter, and the rise of twice the cost there.
    """
    goal = found.scatter * float(norm.ppf(0.5 + 0.5 * fit.level))
    deviation = math.sqrt(found.covariance[k, k])
    points = [(found.u[k], 0.0)]
    ends = [_end(found, fit, k, sign, goal, deviation, points) for sign in (-1.0, 1.0)]
    values = [_value(found, k, u) for u, _ in sorted(points)]
    curve = np.array([values, [rise for _, rise in sorted(points)]]).T
    low, high = (_value(found, k, end) if math.isfinite(end) else math.nan for end in ends)
    return low, high, curve


def _value(found: Estimate, k: int, u: float) -> float:
    """Return the value of a parameter at a coordinate."""
    at = found.u.copy()
    at[k] = u
    return float(found.problem.parameters.values(at)[k])


def _end(
    found: Estimate, fit: Fit, k: int, sign: float, goal: float, deviation: float, points: list
) -> float:
    """Return the coordinate of one end, by the secant of the root of the rise."""
    if not math.isfinite(deviation):
        return math.nan
    bound = float(found.problem.parameters.bounds[int(sign > 0.0)][k])
    covariance = found.covariance[:, k] / found.covariance[k, k]
    before, step = (0.0, 0.0), goal * deviation
    for _ in range(MOST):
        step = min(step, sign * (bound - found.u[k]))
        start = found.u + sign * step * np.nan_to_num(covariance)
        start[k] = found.u[k] + sign * step
        try:
            there = search(found.problem, fit, start, fixed=k)
        except FitError:
            return math.nan
        rise = max(2.0 * (there.cost - found.cost), 0.0)
        points.append((start[k], rise))
        root = math.sqrt(rise)
        if abs(root - goal) < CLOSE * goal:
            return float(start[k])
        if step == sign * (bound - found.u[k]) and root < goal:
            return bound
        slope = (root - before[0]) / (step - before[1]) if step != before[1] else 0.0
        before_step, before = step, (root, step)
        step = before_step + (goal - root) / slope if slope > 0.0 else 2.0 * before_step
        step = min(max(step, 0.2 * before_step), 4.0 * before_step)
    return math.nan
