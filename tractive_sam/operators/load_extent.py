"""Position and extent of a load, which decide the length of a transform."""

import numpy as np


def extent(occupied: np.ndarray) -> slice:
    """Return the slice from the first to the last True of a mask; slice(0, 1) if there is none."""
    where = np.flatnonzero(occupied)
    return slice(where[0], where[-1] + 1) if where.size else slice(0, 1)


def largest_offset(occupied: np.ndarray) -> int:
    """Return the largest distance, in elements, from a loaded element to any other on an axis.

    `occupied` is a mask of the loaded places along one axis of the mesh, shape (n,).
    """
    loaded = extent(occupied)
    return max(loaded.stop - 1, occupied.size - 1 - loaded.start)
