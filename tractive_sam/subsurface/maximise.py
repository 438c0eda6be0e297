"""The local maximum of a smooth function of three coordinates."""

from collections.abc import Callable
from itertools import combinations

import numpy as np

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Points (n, 3) and what they are near, (3,) -> values (n,)."""

STEPS = 6
"""Largest number of Newton steps: a longer search swings between elements near the surface."""

FLATTEST = 1e-3
"""Least curvature over the largest one."""

SETTLED = 1e-2
"""A step shorter than this share of the depth is the last."""

_AXES = np.concatenate((np.eye(3), -np.eye(3)))
_PAIRS = np.array([e + s * f for e, f in combinations(np.eye(3), 2) for s in (1.0, -1.0)])
_STENCIL = np.concatenate((np.zeros((1, 3)), _AXES, _PAIRS, -_PAIRS))


def maximise(
    function: Function, start: np.ndarray, floor: float, least: float
) -> np.ndarray | None:
    """Find a local maximum by Newton steps on differences.

    Lengths go with the depth, over which fields below a surface change.

    Parameters
    ----------
    function : callable
        What is to be largest.
    start : ndarray, shape (3,)
        Where to begin; the last coordinate is the depth.
    floor : float
        Least depth.
    least : float
        A way that the floor bars is given up where the value is below this one.

    Returns
    -------
    ndarray, shape (3,)
        The point reached, or None.
    """
    at = np.array(start)
    for _ in range(STEPS):
        unit = _unit(at)
        values = function(at + unit * _STENCIL, at)
        moved = _step(at, _gradient(values, unit), _hessian(values, unit), floor)
        if at[2] <= floor and moved[2] <= floor and values[0] < least:
            return None
        length = np.linalg.norm(moved - at) / at[2]
        at = moved
        if length < SETTLED:
            break
    return at


def _unit(at: np.ndarray) -> float:
    """Step of the differences, a tenth of the depth: their error is a hundredth."""
    return 0.1 * at[2]


def _gradient(values: np.ndarray, unit: float) -> np.ndarray:
    return (values[1:4] - values[4:7]) / (2.0 * unit)


def _hessian(values: np.ndarray, unit: float) -> np.ndarray:
    """Second derivatives from the stencil, negative definite."""
    hessian = np.diag(values[1:4] + values[4:7] - 2.0 * values[0])
    pairs = values[7:13] + values[13:]
    for k, (i, j) in enumerate(combinations(range(3), 2)):
        hessian[i, j] = hessian[j, i] = 0.25 * (pairs[2 * k] - pairs[2 * k + 1])
    hessian /= unit**2
    if _falls_all_ways(hessian.tolist()):
        return hessian
    curvatures, directions = np.linalg.eigh(hessian)
    # Where it curves upwards, go uphill all the same.
    curvatures = -np.maximum(np.abs(curvatures), FLATTEST * np.abs(curvatures).max())
    return directions * curvatures @ directions.T


def _falls_all_ways(hessian: list[list[float]]) -> bool:
    """Whether it is well negative definite, by its leading minors: numpy takes far longer."""
    (a, b, c), (_, d, e), (_, _, f) = hessian
    minor = a * d - b * b
    whole = f * minor - a * e * e + 2.0 * b * c * e - d * c * c
    size = max(-a, -d, -f)
    return a < 0.0 < minor and whole < -FLATTEST * size**3


def _step(at: np.ndarray, gradient: np.ndarray, hessian: np.ndarray, floor: float) -> np.ndarray:
    step = -np.linalg.solve(hessian, gradient)
    if at[2] <= floor and step[2] < 0.0:
        # Along the floor, the way down being barred.
        step = np.append(-np.linalg.solve(hessian[:2, :2], gradient[:2]), 0.0)
    length, longest = np.linalg.norm(step), 0.5 * at[2]
    if length > longest:
        step *= longest / length
    moved = at + step
    moved[2] = max(moved[2], floor)
    return moved
