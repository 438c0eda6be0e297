"""Contacts of a table, solved in this process or on the workers of a scheduler."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby
from time import process_time

import numpy as np

from tractive_sam import interrupt
from tractive_sam.studies import computed
from tractive_sam.tables.contacts import Contacts, Solved
from tractive_sam.tables.design import TableDesign

SHARE = 0.4
"""Of the tolerance, what an error bar of a node may take, and an interpolation along one axis: of
three axes along which a table is curved most the errors seldom add up."""

AT_ONCE = 20
"""Contacts that a worker is handed at once: what one that dies takes with it."""

Place = tuple[float, ...]


@dataclass(frozen=True)
class Job:
    """A contact to be solved.

    Attributes
    ----------
    place : tuple of float
        Where it is along the axes beside those of creepages.
    w : tuple of float
        Scaled creepages.
    gradient : bool
        Whether their derivatives are needed.
    finer : bool
        Whether to begin with twice the elements of the design, to check what others gave.
    """

    place: Place
    w: tuple[float, float, float]
    gradient: bool = True
    finer: bool = False


@dataclass(frozen=True)
class Batch:
    """What came of some jobs: solutions, the contacts solved for them, and the time of a core."""

    found: list[Solved]
    contacts: int
    seconds: float


Solve = Callable[[Sequence[Job]], Iterator[tuple[int, Batch]]]
"""Solves jobs; tells batches with the number of their first job as they are done."""


def solve(text: str, jobs: Sequence[Job]) -> Batch:
    """Solve jobs of one place of the design that a text tells."""
    began = process_time()
    design, contacts = _at(text, jobs[0].place)
    before, wanted, found = contacts.solved, SHARE * design.tolerance, []
    for job in jobs:
        interrupt.raise_if_interrupted()
        w, elements = np.array(job.w), design.elements * (2 if job.finer else 1)
        found.append(contacts.solve(w, elements, design.finest, wanted, job.gradient))
    return Batch(found, contacts.solved - before, process_time() - began)


@lru_cache(maxsize=1)
def _design(text: str) -> TableDesign:
    return TableDesign.from_toml_text(text)


@lru_cache(maxsize=64)
def _at(text: str, place: Place) -> tuple[TableDesign, Contacts]:
    design = _design(text)
    return design, design.contacts(place)


def parts_of(jobs: Sequence[Job]) -> list[tuple[int, Sequence[Job]]]:
    """Jobs of one place each, cut, with the number of the first one."""
    found: list[tuple[int, Sequence[Job]]] = []
    first = 0
    for _, alike in groupby(jobs, key=lambda job: job.place):
        several = list(alike)
        found += [(first + k, several[k : k + AT_ONCE]) for k in range(0, len(several), AT_ONCE)]
        first += len(several)
    return found


def here(design: TableDesign) -> Solve:
    """Solves in this process."""
    text = design.to_toml()

    def run(jobs: Sequence[Job]) -> Iterator[tuple[int, Batch]]:
        for first, some in parts_of(jobs):
            yield first, solve(text, some)

    return run


def elsewhere(design: TableDesign, address: str, security, say: Callable[[str], None]) -> Solve:
    """Solves on the workers of a scheduler; what one of them took with it is handed out again."""
    text = design.to_toml()

    def run(jobs: Sequence[Job]) -> Iterator[tuple[int, Batch]]:
        parts = parts_of(jobs)
        calls = [(solve, text, some) for _, some in parts]
        for k, batch in computed(calls, address, say, security):
            yield parts[k][0], batch

    return run
