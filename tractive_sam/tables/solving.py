"""Contacts of a table, solved in this process or on the workers of a scheduler."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby
from time import process_time
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.studies import computed
from tractive_sam.tables.contacts import Contacts, Solved
from tractive_sam.tables.design import TableDesign

NODE_SHARE = 0.4
"""Share of the tolerance for the error bar of a node, and for the interpolation along one axis: the
errors along the three axes of largest curvature seldom add up."""

Place = tuple[float, ...]


@dataclass(frozen=True)
class Job:
    """Contact to solve for a table: position along the axes, and scaled creepages.

    Attributes
    ----------
    place : tuple of float
        Position along the axes other than creepages.
    w : tuple of float
        Scaled creepages.
    gradient : bool
        Whether the derivatives by creepages are needed.
    finer : bool
        Whether to begin with twice the elements of the design, to check others.
    """

    place: Place
    w: tuple[float, float, float]
    gradient: bool = True
    finer: bool = False


@dataclass(frozen=True)
class Batch:
    """Solutions of some jobs, with the number of contacts solved and the CPU seconds."""

    solutions: list[Solved]
    contacts: int
    seconds: float


Solve = Callable[[Sequence[Job]], Iterator[tuple[int, Batch]]]
"""Solves jobs; yields batches with the number of their first job as they are complete."""


def solve_jobs(text: str, jobs: Sequence[Job]) -> Batch:
    """Solve jobs with equal positions, for a design given as TOML text."""
    began = process_time()
    design, contacts = _contacts_at(text, jobs[0].place)
    before, wanted, solutions = contacts.solved, NODE_SHARE * design.tolerance, []
    for job in jobs:
        interrupt.raise_if_interrupted()
        w, elements = np.array(job.w), design.elements * (2 if job.finer else 1)
        solutions.append(contacts.solve(w, elements, design.finest, wanted, job.gradient))
    return Batch(solutions, contacts.solved - before, process_time() - began)


@lru_cache(maxsize=1)
def _design(text: str) -> TableDesign:
    """Return the design in a TOML text, cached."""
    return TableDesign.from_toml_text(text)


@lru_cache(maxsize=64)
def _contacts_at(text: str, place: Place) -> tuple[TableDesign, Contacts]:
    """Return the design in a TOML text, and its solver of contacts at a position."""
    design = _design(text)
    return design, design.contacts(place)


def divide_jobs(jobs: Sequence[Job], max_jobs: int = 20) -> list[tuple[int, Sequence[Job]]]:
    """Divide jobs into groups of at most `max_jobs` at one position: (first job's index, group).

    A part has at most that many jobs: a worker that dies loses them.
    """
    parts: list[tuple[int, Sequence[Job]]] = []
    first = 0
    for _, alike in groupby(jobs, key=lambda job: job.place):
        place_jobs = list(alike)
        starts = range(0, len(place_jobs), max_jobs)
        parts += [(first + k, place_jobs[k : k + max_jobs]) for k in starts]
        first += len(place_jobs)
    return parts


def solve_here(design: TableDesign) -> Solve:
    """Return a function that solves jobs in this process and yields (first job's index, batch)."""
    text = design.to_toml()

    def run(jobs: Sequence[Job]) -> Iterator[tuple[int, Batch]]:
        for first, some in divide_jobs(jobs):
            yield first, solve_jobs(text, some)

    return run


def solve_on_workers(
    design: TableDesign, address: str, security: Any, log: Callable[[str], None]
) -> Solve:
    """Return a function that solves jobs on Dask workers and yields (first job's index, batch)."""
    text = design.to_toml()

    def run(jobs: Sequence[Job]) -> Iterator[tuple[int, Batch]]:
        parts = divide_jobs(jobs)
        calls = [(solve_jobs, text, some) for _, some in parts]
        for k, batch in computed(calls, address, log, security):
            yield parts[k][0], batch

    return run
