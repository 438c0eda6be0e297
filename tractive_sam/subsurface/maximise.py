"""The local maximum of a smooth function of three coordinates."""

from collections.abc import Callable
from itertools import combinations
from math import hypot

import numpy as np

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Points (n, 3) and what they are near, (3,) -> values (n,)."""

STEPS = 6
"""Largest number of Newton steps: a longer search swings between elements near the surface."""

STEP = 0.1
"""Step of the differences over the depth: their error is a hundredth."""

FLATTEST = 1e-3
"""Least curvature over the largest one."""

SETTLED = 1e-2
"""A step shorter than this share of the depth is the last."""

NEAR = 0.15
"""After a step shorter than this share of the depth the next one goes by the same curvatures."""

STEEP = 1e-2
"""Part of itself by which a value at the floor falls, over a fifth of the depth, away from the
surface: beyond it no top lies below. Where one was found from there, it fell by a third of that at
most (114 contacts of the twin discs)."""

_AXES = np.concatenate((np.eye(3), -np.eye(3)))
_PAIRS = np.array([e + s * f for e, f in combinations(np.eye(3), 2) for s in (1.0, -1.0)])
_STENCIL = np.concatenate((np.zeros((1, 3)), _AXES, _PAIRS, -_PAIRS))
_DOWN = np.array([[0.0, 0.0, step] for step in (0.0, 1.0, -1.0)])

_Hessian = tuple[float, float, float, float, float, float]
"""Second derivatives 11, 12, 13, 22, 23, 33: in plain numbers, as numpy takes far longer."""


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
    if at[2] <= floor:
        here, below, above = function(at + STEP * at[2] * _DOWN, at)
        if here < least and above - below > STEEP * here:
            return None
    unit, hessian, barred = STEP * at[2], None, False
    for _ in range(STEPS):
        stencil = _STENCIL if hessian is None else _STENCIL[:7]
        values = function(at + unit * stencil, at).tolist()
        hessian = hessian or _hessian(values)
        step = unit * np.array(_step(_gradient(values), hessian, at[2] <= floor))
        length, longest = hypot(*step), 0.5 * at[2]
        if length > longest:
            step *= longest / length
        moved = at + step
        moved[2] = max(moved[2], floor)
        if at[2] <= floor and moved[2] <= floor and values[0] < least:
            if barred:
                return None
            barred = True  # beside the start the way down may be free
        length = hypot(*(moved - at)) / at[2]
        at = moved
        if length < SETTLED:
            break
        if length >= NEAR:
            unit, hessian = STEP * at[2], None
    return at


def _gradient(values: list[float]) -> tuple[float, float, float]:
    x, y, z = (0.5 * (values[k] - values[k + 3]) for k in (1, 2, 3))
    return x, y, z


def _hessian(values: list[float]) -> _Hessian:
    """From the stencil, negative definite."""
    twice = 2.0 * values[0]
    xx, yy, zz = (values[k] + values[k + 3] - twice for k in (1, 2, 3))
    xy, xz, yz = (
        0.25 * (values[k] + values[k + 6] - values[k + 1] - values[k + 7]) for k in (7, 9, 11)
    )
    hessian = xx, xy, xz, yy, yz, zz
    if _falls_all_ways(hessian):
        return hessian
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    curvatures, directions = np.linalg.eigh(matrix)
    # Where it curves upwards, go uphill all the same.
    curvatures = -np.maximum(np.abs(curvatures), FLATTEST * np.abs(curvatures).max())
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = (directions * curvatures @ directions.T).tolist()
    return xx, xy, xz, yy, yz, zz


def _falls_all_ways(hessian: _Hessian) -> bool:
    """Whether it is well negative definite, by its leading minors."""
    a, b, c, d, e, f = hessian
    minor = a * d - b * b
    whole = f * minor - a * e * e + 2.0 * b * c * e - d * c * c
    size = max(-a, -d, -f)
    return a < 0.0 < minor and whole < -FLATTEST * size**3


def _step(
    gradient: tuple[float, float, float], hessian: _Hessian, barred: bool
) -> tuple[float, float, float]:
    """To the top of the parabola; along the floor where the way down is barred."""
    (u, v, w), (a, b, c, d, e, f) = gradient, hessian
    # Adjoint of the Hessian, by rows.
    aa, ab, ac = d * f - e * e, c * e - b * f, b * e - c * d
    bb, bc, cc = a * f - c * c, b * c - a * e, a * d - b * b
    whole = -(a * aa + b * ab + c * ac)
    down = (ac * u + bc * v + cc * w) / whole
    if barred and down < 0.0:
        return (b * v - d * u) / cc, (b * u - a * v) / cc, 0.0
    return (aa * u + ab * v + ac * w) / whole, (ab * u + bb * v + bc * w) / whole, down
