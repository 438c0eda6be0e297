"""Local maxima: of fields in layers that lie one below the other, and by Newton steps."""

import numpy as np

STEP = 0.1
"""Step of the differences over the depth: their error is a hundredth."""

LOST, ENDED, GOES_ON = range(3)
"""State of a search path: abandoned, converged, or running."""

_AXES = np.eye(3)
# 0, x_i, -x_i, x_j + x_k and -(x_j + x_k), for i = 1 to 3.
_STENCIL = np.concatenate((np.zeros((1, 3)), _AXES, -_AXES, 1.0 - _AXES, _AXES - 1.0))


def find_tops(values, above, below):
    """Return local maxima of fields, (n, 5): field, value, i, j and position between layers.

    Layers cover one rectangle, each by equal steps in x and in y.

    Parameters
    ----------
    values : ndarray, shape (m, n_x, n_y)
        Values of the fields; only values above 0 count.
    above, below : ndarray, shape (m, k_x, k_y)
        Values of the layers next to it; empty if there is none.

    Returns
    -------
    ndarray, shape (n, 5)
        For each maximum its field, its value, its place (i, j) in steps from the first point and
        the place between the layers, 0 in this one and 1 in the one below: the tops of parabolas
        through the neighbouring values.
    """
    # Steps in x and y to the farthest values of its layer that a local maximum is compared with.
    around = 2
    nx, ny = values.shape[1:]
    is_largest = (values == _largest_around(values, around)) & (values > 0.0)
    tops = []
    for m, i, j in np.argwhere(is_largest).tolist():
        here = values[m, i, j]
        k, h = max(i - around, 0), max(j - around, 0)
        window = values[m, k : i + around + 1, h : j + around + 1]
        if divmod(int(window.argmax()), window.shape[1]) != (i - k, j - h):
            continue  # of equal values the first one counts
        higher, lower = (_next_to(layer[m], i, j, nx, ny) for layer in (above, below))
        if higher > here or lower > here:
            continue
        x = i + _vertex(*values[m, i - 1 : i + 2, j]) if 0 < i < nx - 1 else i
        y = j + _vertex(*values[m, i, j - 1 : j + 2]) if 0 < j < ny - 1 else j
        deeper = _vertex(higher, here, lower) if higher >= 0.0 and lower >= 0.0 else 0.0
        tops.append((m, here, x, y, deeper))
    return np.array(tops).reshape(-1, 5)


def _largest_around(values, around):
    """Return the largest value within `around` points of each point, in x and in y."""
    largest = values
    for _ in range(2):
        source, largest = largest, largest.copy()
        for n in range(1, around + 1):
            np.maximum(largest[:, n:], source[:, :-n], out=largest[:, n:])
            np.maximum(largest[:, :-n], source[:, n:], out=largest[:, :-n])
        largest = largest.swapaxes(1, 2)
    return largest


def _next_to(values, i, j, nx, ny):
    """Return the value of another layer nearest to point (i, j) of nx x ny; -1 if it is empty."""
    if values.size == 0:
        return -1.0
    kx, ky = values.shape
    return values[(2 * i + 1) * kx // (2 * nx), (2 * j + 1) * ky // (2 * ny)]


def _vertex(before, here, behind):
    """Return the offset of a parabola's maximum from the middle of three values, in steps."""
    bend = 2.0 * here - before - behind
    return 0.5 * (behind - before) / bend if bend > 0.0 else 0.0


def stencil(at):
    """Return the points (m, 13, 3) around each of m points at which `climb` needs values."""
    return at[:, None] + STEP * at[:, None, 2:] * _STENCIL


def climb(at, barred, best, values, of, highest, threshold, floor, first):
    """Move the points of search paths by a Newton step towards maxima; return each path's state.

    The step leads to the top of the parabola through the values; uphill if the function curves
    upwards; along the floor if the floor bars the path.

    Parameters
    ----------
    at : ndarray, shape (m, 3)
        Places of the paths, before and after; the last coordinate is the depth.
    barred : ndarray of bool, shape (m,)
        Paths that are low but barred by the floor, in the step before; set to the paths of this
        step.
    best : ndarray, shape (k,)
        The highest value of each function at which a path ended.
    values : ndarray, shape (m, 13)
        Values at the points of `stencil`. The gain of the step is added to the first one.
    of : ndarray of int, shape (m,)
        Index of the function of each path.
    highest : ndarray, shape (m,)
        Bound of the value that a path can reach: it is abandoned if another one has reached more.
    threshold : ndarray, shape (m,)
        A path is low if its value is below this.
    floor : float
        Least depth.
    first : bool
        Whether these are the first steps.

    Returns
    -------
    ndarray of int, shape (m,)
        The state of each path.
    """
    # Relative fall of a value at the floor, over a fifth of the depth, away from the surface: if it
    # falls by more, no maximum lies below. In 114 contacts of the twin discs the fall was at most a
    # third of this whenever a maximum was found from there.
    steep = 1e-2
    # A step that gains less than this part of the value is the last but one.
    settled_step = 3e-4
    here, low = values[:, 0].copy(), (at[:, 2] <= floor) & (values[:, 0] < threshold)
    gain = _step(at, values, floor)
    settled = gain < settled_step * here
    stays = low & (at[:, 2] <= floor)  # beside the start the path down may be free
    lost = stays & (barred | settled)
    if first:
        lost |= low & (values[:, 6] - values[:, 3] > steep * here)
    ended = settled & ~lost
    np.maximum.at(best, of[ended], here[ended])
    barred[:] = stays
    values[:, 0] += gain
    running = ~(lost | settled | (highest < best[of]))
    running &= ~_follows(at, values[:, 0], np.where(running, of, -1))
    return np.select((ended, running), (ENDED, GOES_ON), LOST)


def last_steps(at, values, floor):
    """Move the points by the last Newton step of `climb`; return the values reached, (m,)."""
    return values[:, 0] + _step(at, values, floor)


def _follows(at, values, of):
    """Return which paths are near a path with a higher value of the same function."""
    # Paths nearer to each other than this share of the depth lead to one maximum.
    same = 0.3
    squares = ((at - at[:, None]) ** 2).sum(axis=-1)
    near = squares < (same * at[:, 2:]) ** 2
    return (near & (of == of[:, None]) & (values > values[:, None])).any(axis=1)


def _step(at, v, floor):
    """Move points by limited Newton steps uphill, not above depth `floor`; return their gains."""
    # Longest step of a path over the depth.
    longest = 0.5
    gradient = 0.5 * (v[:, 1:4] - v[:, 4:7])
    curvature, mixed = (v[:, k : k + 3] + v[:, k + 3 : k + 6] - 2.0 * v[:, :1] for k in (1, 7))
    hessian = np.empty((len(at), 3, 3))
    i, j, k = [0, 1, 2], [1, 2, 0], [2, 0, 1]
    hessian[:, i, i] = curvature
    hessian[:, j, k] = 0.5 * (mixed - curvature[:, j] - curvature[:, k])
    hessian[:, k, j] = hessian[:, j, k]
    step = _uphill(gradient, hessian)
    stopped = (at[:, 2] <= floor) & (step[:, 2] < 0.0)
    if stopped.any():
        gradient[stopped, 2] = hessian[stopped, 2, :2] = hessian[stopped, :2, 2] = 0.0
        step = _uphill(gradient, hessian)
    length = np.sqrt((step**2).sum(axis=1, keepdims=True))
    step *= longest / STEP / np.maximum(length, longest / STEP)
    at += STEP * at[:, 2:] * step
    at[:, 2] = np.maximum(at[:, 2], floor)
    return 0.5 * (gradient * step).sum(axis=1)


def _uphill(gradient, hessian):
    """Return Newton steps (m, 3) by the size of each curvature, which lead uphill."""
    # Least curvature over the largest one.
    flattest = 1e-2
    curvature, axes = np.linalg.eigh(hessian)
    size = np.abs(curvature)
    least = np.maximum(flattest * size.max(axis=1, keepdims=True), 1e-300)
    along = np.einsum("mij,mi->mj", axes, gradient) / np.maximum(size, least)
    return np.einsum("mij,mj->mi", axes, along)
