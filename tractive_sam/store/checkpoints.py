"""Times at which computed records are written to the disk."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter


class Checkpoints:
    """Timer of checkpoints that limits the share of the wall time spent on them.

    Parameters
    ----------
    share : float
        Largest share of the wall time; infinite for a checkpoint after every record.
    """

    def __init__(self, share: float = 0.02) -> None:
        self._share, self._next = share, -math.inf

    @property
    def is_due(self) -> bool:
        """Whether it is time for the next checkpoint."""
        return perf_counter() >= self._next

    @contextmanager
    def take(self) -> Iterator[None]:
        """Measure the duration of the block, one checkpoint, and schedule the next one."""
        start = perf_counter()
        yield
        end = perf_counter()
        self._next = end + (end - start) / self._share
