"""Chains of neighbouring cases, which one worker computes one after another."""

from collections.abc import Container, Iterable

import numpy as np

from tractive_sam.run import neighbouring_places
from tractive_sam.studies.task import Task

Chain = tuple[Task, ...]
"""Tasks that a worker receives together."""


def neighbour_order(shape: tuple[int, ...]) -> np.ndarray:
    """Return the position of each case in an order in which neighbours follow one another."""
    places = np.array([np.ravel_multi_index(place, shape) for place in neighbouring_places(shape)])
    return np.argsort(places)


def make_chains(
    tasks: Iterable[Task], single: Container[str] = (), *, longest: float = 2.0
) -> list[Chain]:
    """Divide tasks into chains of <= `longest` s; tasks with a file or in `single` remain alone.

    Parameters
    ----------
    tasks : iterable of Task
        Tasks in their order.
    single : container of str
        Hashes of cases that are separate chains, as are those with a results file.
    longest : float
        Expected seconds of a chain of several cases: the loss if a worker dies, and the time for
        which others wait at the end.
    """
    chains: list[list[Task]] = []
    remaining = 0.0
    for task in tasks:
        joins = task.file is None and task.case.digest not in single
        remaining -= task.seconds
        if joins and remaining >= 0.0:
            chains[-1].append(task)
        else:
            chains.append([task])
            remaining = longest - task.seconds if joins else 0.0
    return [tuple(chain) for chain in chains]
