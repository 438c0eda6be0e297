"""The nodes of a table on its grid, and their contacts, solved here or on workers."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import groupby
from time import process_time
from typing import TypeAlias

import numpy as np

from tractive_sam import interrupt
from tractive_sam.lookup import MIRROR, creepages_at, creepages_by_coordinates
from tractive_sam.reference import full_slip_with_spin
from tractive_sam.scene import describe_changes, hashes_of
from tractive_sam.schema import Fault, SceneError
from tractive_sam.studies import Workers, computed
from tractive_sam.tables.design import Contacts, Solved, TableDesign, TableError


@dataclass(frozen=True)
class Refinement:
    """Settings of the adaptive refinement of a creep-force table.

    Attributes
    ----------
    full : float
        r over r_0 that is solved for full slip if it has no closed form: the share of stick is
        as small.
    samples : int
        Check points in the middle of every interval of every axis.
    anywhere : int
        Check points anywhere, at most as many as nodes. The points that led to a refinement say
        less about others: a table is complete only if as many new ones have small errors. If three
        in a thousand exceed `miss`, a thousand random points find one in 95 of 100 cases; these are
        distributed more evenly.
    miss : float
        Error over the tolerance from which a point anywhere leads to a refinement.
    worst : float
        The corresponding error over the largest one: nodes for the worst points often reduce
        smaller errors.
    checks : int
        Final check points anywhere, which measure the errors; at most as many as nodes.
    rounds : int
        Largest number of refinements.
    step : float
        Step of differences of closed forms along heading and tilt.
    first_u : tuple of float
        First nodes along u: closest at the onset of full slip, at which forces change abruptly.
    """

    full: float = 1e4
    samples: int = 5
    anywhere: int = 1000
    miss: float = 0.5
    worst: float = 0.5
    checks: int = 200
    rounds: int = 24
    step: float = 1e-4
    first_u: tuple[float, ...] = (0.0, 0.2, 0.4, 0.475, 0.55, 0.625, 0.7, 0.85, 1.0)

    @property
    def last_u(self) -> float:
        """Largest scaled creepage u that is solved to stand for full slip."""
        return self.full / (1.0 + self.full)


@dataclass(frozen=True)
class TableProgress:
    """Progress of the construction of a table: nodes, solved nodes, refinements.

    Attributes
    ----------
    nodes, done : int
        Number of nodes of the present grid, and of those that are solved.
    round : int
        Number of refinements.
    """

    nodes: int
    done: int
    round: int


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


def solve_jobs(text: str, jobs: Sequence[Job], files: tuple[tuple[str, str], ...] = ()) -> Batch:
    """Solve jobs with equal positions, for a design given as TOML text.

    Parameters
    ----------
    text : str
        The design.
    jobs : sequence of Job
        The jobs.
    files : tuple of (str, str)
        Path and SHA-256 of each file that the design names.

    Raises
    ------
    SceneError
        If a file has changed.
    """
    began = process_time()
    design, contacts = _contacts_at(text, files, jobs[0].place)
    before, wanted, solutions = contacts.solved, NODE_SHARE * design.tolerance, []
    for job in jobs:
        interrupt.raise_if_interrupted()
        w, elements = np.array(job.w), design.elements * (2 if job.finer else 1)
        solutions.append(contacts.solve(w, elements, design.finest, wanted, job.gradient))
    return Batch(solutions, contacts.solved - before, process_time() - began)


@lru_cache(maxsize=1)
def _design(text: str, files: tuple[tuple[str, str], ...]) -> TableDesign:
    """Return the design in a TOML text, cached."""
    design = TableDesign.from_toml_text(text)
    check_files(dict(files), design.files)
    return design


@lru_cache(maxsize=64)
def _contacts_at(
    text: str, files: tuple[tuple[str, str], ...], place: Place
) -> tuple[TableDesign, Contacts]:
    """Return the design in a TOML text, and its solver of contacts at a position."""
    design = _design(text, files)
    contacts = design.contacts(place)
    check_files(dict(files), hashes_of([contacts.scene]))
    return design, contacts


def check_files(before: Mapping[str, str], now: Mapping[str, str]) -> None:
    """Raise a SceneError that names the files whose hashes, by path, differ.

    Raises
    ------
    SceneError
        If a file has changed since its design was read.
    """
    if changed := describe_changes(before, now):
        allowed = "the content with which the table was begun; restore it, or build another table"
        raise SceneError([Fault(Fault.FILE, f"{changed}, which has changed", allowed)])


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
    text, files = design.to_toml(), tuple(design.files.items())

    def run(jobs: Sequence[Job]) -> Iterator[tuple[int, Batch]]:
        for first, some in divide_jobs(jobs):
            yield first, solve_jobs(text, some, files)

    return run


def solve_on_workers(design: TableDesign, workers: Workers) -> Solve:
    """Return a function that solves jobs on workers and yields (first job's index, batch)."""
    text, files = design.to_toml(), tuple(design.files.items())

    def run(jobs: Sequence[Job]) -> Iterator[tuple[int, Batch]]:
        parts = divide_jobs(jobs)
        calls = [(solve_jobs, text, some, files) for _, some in parts]
        for k, batch in computed(calls, workers):
            yield parts[k][0], batch

    return run


HEADINGS, TILTS = 5, 4
"""First numbers of nodes over half a circle of heading, and from zero tilt to the pole."""


@dataclass(frozen=True)
class CreepageGrid:
    """Symmetric grid of heading and tilt (directions of creepage) of a table.

    Parameters
    ----------
    mirrored, reversed : bool
        Whether forces are mirrored with creepages at y = 0, and reversed with them. With both, the
        table contains a quarter of all creepages; else all of them, and half are solved.
    """

    reversal = np.full(3, -1.0)

    pole = 0.5 * math.pi

    mirrored: bool
    reversed: bool

    @property
    def full_range(self) -> bool:
        """Whether the table covers all headings and tilts, or only a quarter by symmetry."""
        return not (self.mirrored and self.reversed)

    @property
    def first(self) -> list[np.ndarray]:
        """First nodes [heading, tilt] in radians, before refinement; a quarter if symmetric."""
        if self.full_range:
            return [
                np.linspace(-math.pi, math.pi, 2 * HEADINGS - 1),
                np.linspace(-self.pole, self.pole, 2 * TILTS - 1),
            ]
        return [np.linspace(-self.pole, self.pole, HEADINGS), np.linspace(0.0, self.pole, TILTS)]

    def alike(self, axis: int, intervals: np.ndarray, count: int) -> np.ndarray:
        """Return indices of intervals of heading (0) or tilt (1) and of their mirror images."""
        if axis == 0 or (axis == 1 and self.full_range):
            intervals = np.union1d(intervals, count - 1 - intervals)
        if axis == 0 and self.full_range:
            intervals = np.union1d(intervals, (intervals + count // 2) % count)
        return intervals.astype(int)

    def canonical(
        self, creepages: tuple[float, ...]
    ) -> tuple[tuple[float, float, float], np.ndarray]:
        """Return (equivalent node that is solved, signs (3,) of its forces) for creepages."""
        heading, tilt, u = creepages
        # Digits of a heading, so that it does not depend on how it is mirrored or turned.
        digits, none = 12, np.ones(3)
        if u == 0.0:
            return (0.0, 0.0, 0.0), none
        if abs(tilt) == self.pole:  # for pure spin the heading has no effect
            heading = 0.0
        heading = math.pi if heading == -math.pi else heading
        outside = tilt < 0.0 or (tilt == 0.0 and heading < 0.0)
        if outside and self.mirrored:
            mirrored = heading if heading == math.pi else -heading
            return (round(mirrored, digits), -tilt, u), MIRROR
        if outside and self.reversed:
            turned = heading + math.pi if heading <= 0.0 else heading - math.pi
            turned = math.pi if turned <= -math.pi else turned
            return (0.0 if tilt == -self.pole else round(turned, digits), -tilt, u), self.reversal
        return (round(heading, digits), tilt, u), none


Point: TypeAlias = tuple[float, ...]
"""Coordinates on all axes: the axes of the design, then heading, tilt and u."""


@dataclass(frozen=True, eq=False)
class _Node:
    """Solved contact that stands for a node, and the signs of its creepages and forces there."""

    job: Job
    signs: np.ndarray


@dataclass(eq=False)
class TableContacts:
    """All solved contacts and nodes of a table under construction.

    Attributes
    ----------
    design : TableDesign
        The design of the table.
    solver : callable
        Solver of jobs.
    report : callable
        Called with the progress whenever contacts have been solved.
    refinement : Refinement
        Settings.
    solved : dict
        Solution of each job.
    nodes : dict
        Solution of each node, with its gradient by heading, tilt and u.
    number : int
        Number of contacts solved.
    seconds : float
        CPU time that they took.
    round : int
        Number of refinements, for the progress.
    """

    design: TableDesign
    solver: Solve
    report: Callable[[TableProgress], None]
    refinement: Refinement
    solved: dict[Job, Solved] = field(default_factory=dict)
    nodes: dict[Point, Solved] = field(default_factory=dict)
    number: int = 0
    seconds: float = 0.0
    round: int = 0

    def __post_init__(self) -> None:
        self.grid = CreepageGrid(*self.design.symmetries)
        self.lead = len(self.design.names)

    def solve_nodes(self, points: Sequence[Point]) -> list[Solved]:
        """Return the solutions at nodes; nodes without a solution yet are solved."""
        new = {point: self._canonical_node(point) for point in points if point not in self.nodes}
        self.solve([node.job for node in new.values() if node is not None], len(points))
        for point, node in new.items():
            self.nodes[point] = self._node(point, node)
        return [self.nodes[point] for point in points]

    def forces(self, points: Sequence[Point], nodes: int) -> np.ndarray:
        """Solve scaled forces at points that need not be nodes; return them, shape (P, 3)."""
        jobs = [self.job(point[: self.lead], point[self.lead :], False) for point in points]
        self.solve(jobs, nodes)
        return np.array([self.solved[job].force for job in jobs])

    def _canonical_node(self, point: Point) -> _Node | None:
        """Return the contact to solve for a node; None if full slip has a closed form."""
        if point[-1] == 1.0 and self.design.scene is None and not self.design.axis:
            return None
        place = point[: self.lead]
        creepages, signs = self.grid.canonical(point[self.lead :])
        return _Node(self.job(place, creepages), signs)

    def job(self, place: Point, creepages: Point, gradient: bool = True) -> Job:
        """Return the job that solves the contact at a position of the axes, heading, tilt and u."""
        heading, tilt, u = creepages
        w = creepages_at(self.design.ratio(place), heading, tilt, min(u, self.refinement.last_u))
        return Job(place, (float(w[0]), float(w[1]), float(w[2])), gradient)

    def _node(self, point: Point, node: _Node | None) -> Solved:
        """Return the solution at a node, its gradient by heading, tilt and u."""
        ratio = self.design.ratio(point[: self.lead])
        heading, tilt, u = point[self.lead :]
        if node is None:
            return _full_slip_node(ratio, heading, tilt, self.refinement.step)
        solved = self.solved[node.job]
        by_w = node.signs[:, None] * solved.gradient * node.signs
        by = by_w @ creepages_by_coordinates(ratio, heading, tilt, min(u, self.refinement.last_u))
        return Solved(node.signs * solved.force, solved.bar, by)

    def solve(self, jobs: Iterable[Job], nodes: int) -> None:
        """Solve jobs without solution, report progress; TableError if an error bar is too large."""
        new = dict.fromkeys(job for job in jobs if job not in self.solved)
        unsolved = sorted(new, key=lambda job: job.place)
        done = 0
        for first, batch in self.solver(unsolved):
            self.solved.update(zip(unsolved[first:], batch.solutions, strict=False))
            self.number += batch.contacts
            self.seconds += batch.seconds
            done += len(batch.solutions)
            self.report(TableProgress(nodes, nodes - len(unsolved) + done, self.round))
            for solved in batch.solutions:
                self._check_bar(solved)

    def _check_bar(self, solved: Solved) -> None:
        """Raise a TableError if the error bar of a contact exceeds the tolerance of the design."""
        design = self.design
        if solved.bar.max() > design.tolerance:
            fault = Fault(
                "tolerance",
                f"{design.tolerance:g}, but an error bar of "
                f"{solved.bar.max():.2g} on {design.finest} elements",
                "a larger tolerance, or a larger finest",
            )
            raise TableError([fault])


def _full_slip_node(ratio: float, heading: float, tilt: float, step: float) -> Solved:
    """Return the solution at full slip in closed form, its gradient by differences."""

    def force(heading: float, tilt: float) -> np.ndarray:
        w = creepages_at(ratio, heading, tilt, 1.0)
        w[np.abs(w) < 1e-15] = 0.0
        return np.array(full_slip_with_spin(ratio, (w[0], w[1]), w[2]))

    by_heading = (force(heading + step, tilt) - force(heading - step, tilt)) / (2.0 * step)
    by_tilt = (force(heading, tilt + step) - force(heading, tilt - step)) / (2.0 * step)
    slopes = np.stack([by_heading, by_tilt, np.zeros(3)], axis=1)
    return Solved(force(heading, tilt), np.zeros(3), slopes)
