"""When what was computed is put on disk."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

SHARE = 0.02
"""Most of the time that is spent on checkpoints."""


class Checkpoints:
    """So often that it takes no more than a share of the time; the first at once.

    Parameters
    ----------
    share : float
        Of the time; infinite for one after every record.
    """

    def __init__(self, share: float = SHARE) -> None:
        self._share, self._next = share, -math.inf

    @property
    def due(self) -> bool:
        """Whether it is time for the next one."""
        return perf_counter() >= self._next

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Take one: what the block takes tells when the next one is due."""
        began = perf_counter()
        yield
        ended = perf_counter()
        self._next = ended + (ended - began) / self._share
