"""The contacts of a table: the jobs of its points, their solutions, and its nodes."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from tractive_sam.lookup import creepages_at, creepages_by_coordinates
from tractive_sam.reference import full_slip_with_spin
from tractive_sam.schema import Fault
from tractive_sam.tables.contacts import Solved
from tractive_sam.tables.design import TableDesign, TableError
from tractive_sam.tables.grid import CreepageGrid
from tractive_sam.tables.refinement import Refinement, TableProgress
from tractive_sam.tables.solving import Job, Solve

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
        if point[-1] == 1.0 and self.design.closed_form:
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
