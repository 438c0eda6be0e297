"""Position and extent of a load, which decide the length of a transform."""

import numpy as np


def extent(occupied: np.ndarray) -> slice:
    """Return the slice from the first to the last occupied place; one place if none is occupied."""
    where = np.flatnonzero(occupied)
    return slice(where[0], where[-1] + 1) if where.size else slice(0, 1)


def reach(occupied: np.ndarray) -> int:
    """Return the largest offset between an occupied place and any other place."""
    loaded = extent(occupied)
    return max(loaded.stop - 1, occupied.size - 1 - loaded.start)
