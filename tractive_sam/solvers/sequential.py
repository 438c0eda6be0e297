"""First the normal problem, then the tangential one: all that bodies of equal material need."""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.operators import Box
from tractive_sam.results import Cost, Status
from tractive_sam.solvers.nested import embed, rectangle, shares
from tractive_sam.solvers.problem import (
    NormalProblem,
    Note,
    Outcome,
    PrescribedForces,
    Problem,
    ProblemSolver,
    Start,
    needed,
)


@dataclass(frozen=True)
class Sequential:
    """Solver of the normal problem without tractions, then of the tangential problem.

    The tangential problem has the pressure found, on the rectangle around the contact.

    Attributes
    ----------
    normal, tangential : ProblemSolver
        Methods of both problems. Without the second there is no traction.
    """

    normal: ProblemSolver
    tangential: ProblemSolver | None = None

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve the pressure, then the tractions; these are zero without contact."""
        if problem.is_pressure_fixed:
            return self._tangential(problem, tolerance, start)
        touching = start is not None and start.pressure is not None and start.pressure.any()
        normal = self._normal(problem.free_pressure, tolerance, start if touching else None)
        pressure = needed(normal.pressure, "outcome.pressure")
        inner = problem.with_pressure(pressure, needed(normal.gap, "outcome.gap"))
        if not (normal.converged and self.tangential is not None and pressure.any()):
            return replace(normal, traction=np.zeros_like(inner.rigid), slip=inner.rigid)
        tangential = self._tangential(inner, tolerance, start)
        return _with_pressure(tangential, normal)

    def _normal(
        self, problem: NormalProblem, tolerance: float, start: Start | Outcome | None
    ) -> Outcome:
        """Solve the normal problem, unless the start is its solution."""
        if isinstance(start, Start) and start.gap is not None:
            fields = start.pressure, start.gap, None, None, start.approach
            return Outcome(Status.CONVERGED, 0.0, 0, Cost(), *fields)
        return self.normal.solve(problem, tolerance, start)

    def _tangential(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None
    ) -> Outcome:
        """Solve the tangential problem under a fixed pressure; refuse forces above the bound."""
        pressure = problem.fixed_pressure.pressure
        if len(problem.forces):
            share = problem.forces.minimum / problem.bound(pressure).radius.sum()
            if share > 1.0:
                return _refuse_forces(problem, share)
        box = rectangle(pressure > 0.0)
        if start is not None:
            start = _start_on_rectangle(problem, start, box)
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


def _start_on_rectangle(problem: Problem, start: Start | Outcome, box: Box) -> Start:
    """Return the start of a tangential problem on a rectangle, from a start on the mesh."""
    if start.traction is None:
        return Start(creepage=start.creepage)
    traction, pressure = start.traction[:, *box], problem.fixed_pressure.pressure
    if start.pressure is not None and start.pressure is not pressure:
        bound = problem.friction.bound(start.pressure).radius[box]
        traction = shares(traction, bound) * problem.bound(pressure).radius[box]
    return Start(traction=traction, creepage=start.creepage)


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
        """Solve roughly, ignoring tolerance and start; if forces fail, without them."""
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
        return _with_pressure(outcome, normal)


def _with_pressure(tangential: Outcome, normal: Outcome) -> Outcome:
    """Return the outcome of both problems: pressure, gap and approach of the normal one."""
    found = {name: getattr(normal, name) for name in ("pressure", "gap", "approach")}
    residual = max(normal.residual, tangential.residual)
    return replace(tangential.after(normal), **found, residual=residual)


def _refuse_forces(problem: Problem, share: float) -> Outcome:
    """Return an unconverged outcome, as the forces are `share` (> 1) of what friction can carry."""
    none = np.zeros_like(problem.rigid)
    note = Note(f"the forces take {share:.1%} of what friction can carry", Status.DIVERGED)
    creepage = np.zeros(len(problem.forces))
    return Outcome(
        Status.DIVERGED, 1.0, 0, Cost(), traction=none, slip=none, creepage=creepage, trace=(note,)
    )
