"""Interpolation that does not overshoot."""

import numpy as np

from tractive_sam.kernels.compiled import compiled


@compiled
def monotone(out, x, values, at):
    """Set `out` to values interpolated by cubics that are monotone wherever the values are.

    Source: Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, with the three-point formula
    at the ends.

    Parameters
    ----------
    out : ndarray, shape (rows, m)
        Set to the interpolated values.
    x : ndarray, shape (n,)
        Ascending, at least three.
    values : ndarray, shape (rows, n)
        There.
    at : ndarray, shape (rows, m)
        Places, ascending in each row; beyond the ends the last cubic continues.
    """
    n = x.size
    h, rise, slope = np.diff(x), np.empty(n - 1), np.empty(n)
    for row in range(values.shape[0]):
        for k in range(n - 1):
            rise[k] = (values[row, k + 1] - values[row, k]) / h[k]
        for k in range(1, n - 1):
            slope[k] = 0.0
            if rise[k - 1] * rise[k] > 0.0:
                back, front = 2.0 * h[k] + h[k - 1], h[k] + 2.0 * h[k - 1]
                slope[k] = (back + front) / (back / rise[k - 1] + front / rise[k])
        slope[0] = _end_slope(h[0], h[1], rise[0], rise[1])
        slope[n - 1] = _end_slope(h[n - 2], h[n - 3], rise[n - 2], rise[n - 3])
        k = 0
        for j in range(at.shape[1]):
            while k < n - 2 and at[row, j] >= x[k + 1]:
                k += 1
            t = at[row, j] - x[k]
            c = (3.0 * rise[k] - 2.0 * slope[k] - slope[k + 1]) / h[k]
            d = (slope[k] + slope[k + 1] - 2.0 * rise[k]) / h[k] ** 2
            out[row, j] = values[row, k] + t * (slope[k] + t * (c + t * d))


@compiled(inner=True)
def _end_slope(h, further, rise, next_rise):
    """Return the slope at an end from a parabola through three points, limited to be monotone."""
    slope = ((2.0 * h + further) * rise - h * next_rise) / (h + further)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope
