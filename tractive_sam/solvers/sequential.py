"""First the normal problem, then the tangential one: all that bodies of equal material need."""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.operators import Box
from tractive_sam.results import Cost, Status
from tractive_sam.solvers.conjugate_gradients import natural_residual
from tractive_sam.solvers.nested import shares
from tractive_sam.solvers.outcome import Note, Outcome, ProblemSolver, Start, needed
from tractive_sam.solvers.problem import NormalProblem, PrescribedForces, Problem


@dataclass(frozen=True)
class Sequential:
    """Solver of the normal problem without tractions, then of the tangential problem.

    The tangential problem has the pressure found, on the rectangle around the contact.

    Attributes
    ----------
    normal, tangential : ProblemSolver
        Methods of both problems. Without the second there is no traction.
    around : int
        Elements around a contact nearby in which the normal problem is solved.
    """

    normal: ProblemSolver
    tangential: ProblemSolver | None = None
    around: int = 2

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem with free or fixed pressure; see `ProblemSolver`."""
        if problem.is_pressure_fixed:
            return self._tangential(problem, tolerance, start)
        touching = start is not None and start.pressure is not None and start.pressure.any()
        normal = self._normal(problem.free_pressure, tolerance, start if touching else None)
        pressure = needed(normal.pressure, "outcome.pressure")
        inner = problem.with_pressure(pressure, needed(normal.gap, "outcome.gap"))
        if not (normal.converged and self.tangential is not None and pressure.any()):
            return replace(normal, traction=np.zeros_like(inner.rigid), slip=inner.rigid)
        tangential = self._tangential(inner, tolerance, start)
        residual = max(normal.residual, tangential.residual)
        return replace(_with_pressure(tangential.after(normal), normal), residual=residual)

    def _normal(
        self, problem: NormalProblem, tolerance: float, start: Start | Outcome | None
    ) -> Outcome:
        """Solve the normal problem, first on a rectangle around a contact nearby."""
        if start is None:
            return self.normal.solve(problem, tolerance)
        if isinstance(start, Start) and start.gap is not None:
            fields = start.pressure, start.gap, None, None, start.approach
            return Outcome(Status.CONVERGED, 0.0, 0, Cost(), *fields)
        shape, nearby = problem.gap.shape, needed(start.pressure, "start.pressure")
        box = rectangle(nearby > 0.0, self.around)
        if box == tuple(slice(0, n) for n in shape):
            return self.normal.solve(problem, tolerance, start)
        near = self.normal.solve(problem.within(box), tolerance, Start(nearby[box]))
        pressure = embed(needed(near.pressure, "outcome.pressure"), box, shape)
        gap = problem.gap + problem.operators.normal(pressure[None])[0] - near.approach
        residual, cost = natural_residual(pressure, gap), near.cost + Cost(1.0)
        near = replace(near, pressure=pressure, gap=gap, residual=residual, cost=cost)
        if near.converged and residual <= tolerance:
            return near
        return self.normal.solve(problem, tolerance, near).costing(near)

    def _tangential(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None
    ) -> Outcome:
        """Solve the tangential problem under the pressure of the normal solution."""
        pressure = problem.fixed_pressure.pressure
        if len(problem.forces):
            share = problem.forces.minimum / problem.bound(pressure).radius.sum()
            if share > 1.0:
                return _refuse_forces(problem, share)
        box = rectangle(pressure > 0.0)
        if start is not None:
            start = _on_part(problem, start, box)
        inner, shape = problem.within(box), pressure.shape
        outcome = needed(self.tangential, "tangential").solve(inner, tolerance, start)
        traction = needed(outcome.traction, "outcome.traction")
        slip = needed(outcome.slip, "outcome.slip")
        normal = inner.fixed_pressure
        sliding, bound = inner.sliding(normal.pressure, normal.gap, traction, slip)
        return replace(
            outcome,
            traction=embed(traction, box, shape),
            slip=embed(slip, box, shape),
            sliding=embed(sliding, box, shape),
            radius=embed(bound.radius, box, shape),
        )


def _on_part(problem: Problem, start: Start | Outcome, box: Box) -> Start:
    """Return the start of a tangential problem on a rectangle, from a start on the mesh."""
    if start.traction is None:
        return Start(creepage=start.creepage)
    traction, response = start.traction[:, *box], getattr(start, "response", None)
    if response is not None:  # of all tractions, or of none
        is_complete = np.count_nonzero(traction) == np.count_nonzero(start.traction)
        response = response[-2:, *box] if is_complete else None
    elif start.pressure is not None:
        bound = problem.friction.bound(start.pressure).radius[box]
        traction = (
            shares(traction, bound) * problem.bound(problem.fixed_pressure.pressure).radius[box]
        )
    return Start(traction=traction, creepage=start.creepage, response=response)


@dataclass(frozen=True)
class RoughSequential:
    """Sequential solver of low accuracy; coupled methods start from its outcome.

    Attributes
    ----------
    normal, tangential : ProblemSolver
        Methods of both problems.
    rough : float
        Residual to which to solve, for any tolerance.
    """

    normal: ProblemSolver
    tangential: ProblemSolver
    rough: float = 1e-3

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem with free pressure approximately; tolerance and start are ignored."""
        normal = self.normal.solve(problem.normal, self.rough)
        pressure = needed(normal.pressure, "outcome.pressure")
        tangential = problem.with_pressure(pressure, needed(normal.gap, "outcome.gap"))
        outcome = self.tangential.solve(tangential, self.rough)
        if not outcome.converged and len(problem.forces):
            # The slip by the uncoupled pressure can be more than these forces allow: then the
            # coupled method finds the creepages.
            under_creepages = replace(tangential, forces=PrescribedForces())
            without = self.tangential.solve(under_creepages, self.rough).after(outcome)
            outcome = replace(without, creepage=np.zeros(len(problem.forces)))
        return _with_pressure(outcome.after(normal), normal)


def _with_pressure(tangential: Outcome, normal: Outcome) -> Outcome:
    """Return a tangential outcome with pressure, gap and approach of a normal outcome."""
    return replace(tangential, pressure=normal.pressure, gap=normal.gap, approach=normal.approach)


def _refuse_forces(problem: Problem, share: float) -> Outcome:
    """Return an unconverged outcome, as the forces are `share` (> 1) of what friction can carry."""
    none = np.zeros_like(problem.rigid)
    note = Note(f"the forces take {share:.1%} of what friction can carry", Status.DIVERGED)
    creepage = np.zeros(len(problem.forces))
    return Outcome(
        Status.DIVERGED, 1.0, 0, Cost(), traction=none, slip=none, creepage=creepage, trace=(note,)
    )


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
