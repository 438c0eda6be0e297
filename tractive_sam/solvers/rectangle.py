"""Problems on the rectangle of elements around a contact."""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.operators import Box
from tractive_sam.results import Cost
from tractive_sam.solvers.conjugate_gradients import natural_residual
from tractive_sam.solvers.outcome import Outcome, ProblemSolver, Start, needed
from tractive_sam.solvers.problem import NormalProblem


@dataclass(frozen=True)
class AroundContact:
    """Solver of a normal problem around the contact of its start; checks the gap beyond it.

    If the contact exceeds the rectangle, the problem is solved on the mesh. Without a start, or on
    a small mesh, it is solved on the mesh at once.

    Attributes
    ----------
    solver : ProblemSolver
        Method for normal problems.
    around : int
        Elements around the contact of the start.
    least_size : int
        Elements of the smallest mesh on which a rectangle is used. A start from a coarser mesh
        already solves most of the problem, and on fewer than about 8,000 elements the check of the
        gap then costs as much as the rectangle saves.
    """

    solver: ProblemSolver
    around: int = 2
    least_size: int = 0

    def solve(
        self, problem: NormalProblem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve near the contact of the start; on all elements if the gap shows more contact."""
        shape = problem.gap.shape
        nearby = None if start is None or problem.gap.size < self.least_size else start.pressure
        if nearby is None or not nearby.any():
            return self.solver.solve(problem, tolerance, start)
        box = rectangle(nearby > 0.0, self.around)
        if box == tuple(slice(0, n) for n in shape):
            return self.solver.solve(problem, tolerance, start)
        near = self.solver.solve(problem.within(box), tolerance, Start(nearby[box]))
        pressure = embed(needed(near.pressure, "outcome.pressure"), box, shape)
        gap = problem.gap + problem.operators.normal(pressure[None])[0] - near.approach
        residual, cost = natural_residual(pressure, gap), near.cost + Cost(1.0)
        near = replace(near, pressure=pressure, gap=gap, residual=residual, cost=cost)
        if near.converged and residual <= tolerance:
            return near
        return self.solver.solve(problem, tolerance, near).costing(near)


def rectangle(contact: np.ndarray, around: int = 0) -> Box:
    """Return the box around a contact: a further row on both sides in x, and `around` elements.

    The slip at the centre of an element depends on the slip of the row behind it, the slip of a
    leading element on the gap ahead.
    """
    i = np.flatnonzero(contact.any(axis=1))
    j = np.flatnonzero(contact.any(axis=0))
    nx, ny = contact.shape
    along = _round_up(i[0] - 1 - around, i[-1] + 2 + around, nx)
    return along, _round_up(j[0] - around, j[-1] + 1 + around, ny)


def _round_up(first: int, end: int, size: int) -> slice:
    """Return a slice that contains the elements first to end, of one of few lengths.

    Contacts that grow element by element then share their operators and plans, at the price of at
    most a sixteenth more elements, or three.
    """
    first, end = max(first, 0), min(end, size)
    step = max(4, 2 ** int(np.log2((end - first) / 16 + 1)))
    length = min(-(-(end - first) // step) * step, size)
    first = min(first, size - length)
    return slice(first, first + length)


def embed(field: np.ndarray, box: Box, shape: tuple[int, int]) -> np.ndarray:
    """Return a field on a box as a field on the full mesh, zero outside the box."""
    full = np.zeros((*field.shape[:-2], *shape), field.dtype)
    full[..., *box] = field
    return full
