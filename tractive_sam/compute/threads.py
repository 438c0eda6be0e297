"""How many threads work: one, but for transforms so large that more of them pay."""

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import numpy as np
from threadpoolctl import ThreadpoolController


def threads_for_transform(padded: tuple[int, int], large: int = 2**19, max_threads: int = 4) -> int:
    """Return the threads for an FFT: 1 if small, else OMP_NUM_THREADS or cores, at most 4.

    The environment variable OMP_NUM_THREADS limits it, as in most libraries.

    Parameters
    ----------
    padded : pair of int
        Size of the padded array.
    large : int
        Numbers of a padded array from which threads pay; below, they cost more than they bring.
    max_threads : int
        Threads of a large transform; memory feeds no more of them.
    """
    if math.prod(padded) < large:
        return 1
    bound = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    allowed = int(bound) if bound.isdigit() else cores()
    return max(1, min(max_threads, allowed))


def cores() -> int:
    """Return the number of cores that the process may use; if unknown, all of the machine."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def numeric_settings() -> Iterator[None]:
    """Limit BLAS to one thread and ignore underflow within the block or function.

    Vectors are too short here for more threads, and threads that wait take cores from others.
    Numbers near zero, such as residuals, may underflow to zero, whatever `np.seterr` prescribes.
    """
    with _controller().limit(limits=1, user_api="blas"), np.errstate(under="ignore"):
        yield


@cache
def _controller() -> ThreadpoolController:
    """Return the controller of BLAS thread pools (threadpoolctl), created once."""
    return ThreadpoolController()
