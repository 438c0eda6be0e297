"""Neighbours that one worker computes in turn."""

from collections.abc import Container, Iterable

import numpy as np

from tractive_sam.run import snake
from tractive_sam.studies.task import Task

Chain = tuple[Task, ...]
"""What a worker is handed at once."""

SPAN = 2.0
"""Time that a chain is expected to take at most, s, unless it is of one case: what a worker that
dies takes with it, and what others wait for at the end."""


def in_turn(shape: tuple[int, ...]) -> np.ndarray:
    """When each case of a study comes, by its number, if each is to be beside the one before."""
    places = np.array([np.ravel_multi_index(place, shape) for place in snake(shape)])
    return np.argsort(places)


def chained(tasks: Iterable[Task], alone: Container[str] = ()) -> list[Chain]:
    """Cut tasks into chains: those with a results file are alone, and those named by digest."""
    chains: list[list[Task]] = []
    room = 0.0
    for task in tasks:
        joins = task.file is None and task.case.digest not in alone
        room -= task.seconds
        if joins and room >= 0.0:
            chains[-1].append(task)
        else:
            chains.append([task])
            room = SPAN - task.seconds if joins else 0.0
    return [tuple(chain) for chain in chains]
