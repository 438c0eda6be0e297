"""Solvers that combine others: on nested meshes, and the normal problem before the tangential one.

A coarse mesh finds the contact, its stick and slip zones and its smooth fields at a fraction of
the cost; the finest mesh then needs a few steps only, however fine it is. Bodies of equal material
need no more than both problems in sequence, the second on the rectangle around the contact.
"""

import math
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from tractive_sam.operators import Box, Lattice
from tractive_sam.results import Cost, Status
from tractive_sam.solvers.krylov import natural_residual
from tractive_sam.solvers.problem import (
    NormalProblem,
    Note,
    Outcome,
    PrescribedForces,
    Problem,
    ProblemSolver,
    Start,
    needed,
    report_progress,
)

AnyProblem = TypeVar("AnyProblem", NormalProblem, Problem)


def refine(values: np.ndarray, lattice: Lattice) -> np.ndarray:
    """Interpolate the last two axes bilinearly to the lattice of elements of half the size."""
    # Where an axis of symmetry halves the first row, every other row lies on a coarse one.
    across = (0.75, 0.75) if lattice.first_share == 1.0 else (0.5, 1.0)
    for axis, shares in ((-2, (0.75, 0.75)), (-1, across)):
        v = np.moveaxis(values, axis, 0)
        before, after = np.concatenate((v[:1], v[:-1])), np.concatenate((v[1:], v[-1:]))
        fine = np.empty((2 * len(v), *v.shape[1:]))
        fine[::2] = shares[0] * v + (1.0 - shares[0]) * before
        fine[1::2] = shares[1] * v + (1.0 - shares[1]) * after
        values = np.moveaxis(fine, 0, axis)
    nx, ny = lattice.shape
    return values[..., :nx, :ny]


def shares(traction: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """Return tractions over their bound, (2, n_x, n_y), extended one element beyond contact."""
    inside = bound > 0.0
    share = np.where(inside, traction, 0.0) / np.where(inside, bound, 1.0)
    nx, ny = inside.shape
    sums = np.zeros((3, nx + 2, ny + 2))
    sums[:2, 1:-1, 1:-1], sums[2, 1:-1, 1:-1] = share, inside
    sums = sums[:, :-2] + sums[:, 1:-1] + sums[:, 2:]
    sums = sums[..., :-2] + sums[..., 1:-1] + sums[..., 2:]
    neighbours = ~inside & (sums[2] > 0.0)
    share[:, neighbours] = sums[:2, neighbours] / sums[2, neighbours]
    return share


def refine_pressure(pressure: np.ndarray, gap: np.ndarray, lattice: Lattice) -> np.ndarray:
    """Interpolate pressure to a finer mesh by its square, which the gap continues outside.

    At a distance d from the edge the pressure inside rises like d^1/2 and the gap outside like
    d^3/2, so p² continues as -gap^2/3. The factor is taken from a Hertzian line contact, with gap =
    2/3 p^3 continued, in the dimensionless units of the problem.
    """
    peak = pressure.max()
    if peak == 0.0:
        return np.zeros(lattice.shape)
    outside = np.cbrt(np.maximum(1.5 * gap / peak, 0.0)) ** 2
    squares = np.where(pressure > 0.0, (pressure / peak) ** 2, -outside)
    return peak * np.sqrt(np.maximum(refine(squares, lattice), 0.0))


@dataclass(frozen=True)
class Nested:
    """Solver on successively finer meshes, each started from the solution on the coarser one.

    From a start that is given it solves on the finest mesh at once.

    Attributes
    ----------
    solver : ProblemSolver
        Method on each mesh.
    begin : ProblemSolver, optional
        Finds the start on the coarsest mesh, or above a mesh that was not solved; without it
        `solver` starts from nothing there.
    nearby : ProblemSolver, optional
        Method from a start that is given; by default `solver`.
    coarsest : int
        A mesh is coarsened as long as its shorter side has more elements than this.
    coarse_tolerance : float
        Residual on coarser meshes: below their own discretisation error.
    """

    solver: ProblemSolver
    begin: ProblemSolver | None = None
    nearby: ProblemSolver | None = None
    coarsest: int = 24
    coarse_tolerance: float = 1e-3

    def solve(
        self, problem: AnyProblem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem on coarser meshes first, or from a start on its mesh alone."""
        if start is not None:
            return (self.nearby or self.solver).solve(problem, tolerance, start)
        problems = [problem]
        while True:
            lattice = problems[-1].operators.lattice
            sides = zip(lattice.whole, lattice.coarsening, strict=True)
            if min(side for side, block in sides if block > 1) <= self.coarsest:
                break
            problems.append(problems[-1].coarsened())
        solved, rough = None, max(tolerance, self.coarse_tolerance)
        for at in reversed(problems):
            aim, size = tolerance if at is problem else rough, at.operators.lattice.shape
            earlier = []
            if solved is not None:
                coarse, outcome = solved
                start = refined(outcome, coarse, at)
                share = math.prod(coarse.operators.lattice.shape) / math.prod(size)
                earlier.append((outcome, share))
            report_progress(size, 1.0)
            if start is None and self.begin is not None:
                start = self.begin.solve(at, aim)
                earlier.append((start, 1.0))
            fine = self.solver.solve(at, aim, start)
            for before, share in earlier:
                fine = fine.costing(before, share)
            solved = at, fine
        return fine


def refined(
    coarse: Outcome, coarse_problem: AnyProblem, problem: AnyProblem
) -> Start | Outcome | None:
    """Return a start from the solution on a coarser mesh, or None if that cannot help.

    Tractions that did not converge still show which elements stick. Pressure and tractions of
    dissimilar bodies that did not converge are no help.
    """
    if isinstance(problem, NormalProblem):
        pressure = _refined_pressure(coarse, problem)
        return Start(pressure, approach=needed(coarse.approach, "outcome.approach"))
    if problem.is_pressure_fixed:
        if not np.isfinite(coarse.residual):
            return None
        coarse_pressure = coarse_problem.fixed_pressure.pressure
        pressure = problem.fixed_pressure.pressure
    else:
        coarse_pressure = needed(coarse.pressure, "outcome.pressure")
        if not (coarse.converged and coarse_pressure.any()):
            return None
        pressure = _refined_pressure(coarse, problem.free_pressure)
    bound, fine_bound = coarse_problem.bound(coarse_pressure), problem.bound(pressure)
    coarse_traction = needed(coarse.traction, "outcome.traction")
    lattice = problem.operators.lattice
    share = lattice.clear_axis(refine(shares(coarse_traction, bound.radius), lattice))
    return replace(coarse, pressure=pressure, traction=share * fine_bound.radius)


def _refined_pressure(coarse: Outcome, problem: NormalProblem) -> np.ndarray:
    """Return the pressure on a coarser mesh interpolated to the mesh of a problem."""
    pressure, gap = needed(coarse.pressure, "outcome.pressure"), needed(coarse.gap, "outcome.gap")
    return refine_pressure(pressure, gap, problem.operators.lattice)


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
        box = rectangle(nearby > 0.0, problem.operators.lattice, self.around)
        if box == tuple(slice(0, n) for n in shape):
            return self.solver.solve(problem, tolerance, start)
        near = self.solver.solve(problem.within(box), tolerance, Start(nearby[box]))
        pressure = embed(needed(near.pressure, "outcome.pressure"), box, shape)
        gap = problem.gap + problem.operators.normal(pressure[None])[0] - near.approach
        residual, cost = (
            natural_residual(pressure, gap, problem.operators.lattice),
            near.cost + Cost(1.0),
        )
        near = replace(near, pressure=pressure, gap=gap, residual=residual, cost=cost)
        if near.converged and residual <= tolerance:
            return near
        return self.solver.solve(problem, tolerance, near).costing(near)


def rectangle(contact: np.ndarray, lattice: Lattice, around: int = 0) -> Box:
    """Return the box around a contact: a further row on both sides in x, and `around` elements.

    The slip at the centre of an element depends on the slip of the row behind it, the slip of a
    leading element on the gap ahead. On the half of a symmetric mesh it begins at the axis.
    """
    i = np.flatnonzero(contact.any(axis=1))
    j = np.flatnonzero(contact.any(axis=0))
    nx, ny = contact.shape
    along = _round_up(i[0] - 1 - around, i[-1] + 2 + around, nx)
    first = 0 if lattice.mirror else j[0] - around
    return along, _round_up(first, j[-1] + 1 + around, ny)


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


@dataclass(frozen=True)
class OnHalfMesh:
    """Solver of problems that are symmetric in y, on half of their mesh; of others, on all of it.

    Attributes
    ----------
    solver : ProblemSolver
        Method on either mesh.
    """

    solver: ProblemSolver

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem, on half of its mesh if it has a `Problem.mirror`."""
        mirror = problem.mirror
        if mirror is None:
            return self.solver.solve(problem, tolerance, start)
        ny = problem.rigid.shape[-1]

        def cut(field: np.ndarray | None) -> np.ndarray | None:
            return None if field is None else field[..., ny // 2 :].copy()

        def unfold(field: np.ndarray | None) -> np.ndarray | None:
            return None if field is None else mirror.unfold(field)

        if start is not None:
            approach, gap = start.approach or 0.0, cut(start.gap)
            start = Start(cut(start.pressure), cut(start.traction), approach, gap=gap)
        half = self.solver.solve(problem.upper_half(mirror), tolerance, start)
        return replace(
            half,
            pressure=unfold(half.pressure),
            gap=unfold(half.gap),
            traction=unfold(half.traction),
            slip=unfold(half.slip),
            sliding=unfold(half.sliding),
            radius=unfold(half.radius),
        )


def embed(field: np.ndarray, box: Box, shape: tuple[int, int]) -> np.ndarray:
    """Return a field on a box as a field on the full mesh, zero outside the box."""
    full = np.zeros((*field.shape[:-2], *shape), field.dtype)
    full[..., *box] = field
    return full


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
        if isinstance(start, Start) and touching and start.gap is not None:  # solved already
            fields = start.pressure, start.gap, None, None, start.approach
            normal = Outcome(Status.CONVERGED, 0.0, 0, Cost(), *fields)
        else:
            normal = self.normal.solve(
                problem.free_pressure, tolerance, start if touching else None
            )
        pressure = needed(normal.pressure, "outcome.pressure")
        inner = problem.with_pressure(pressure, needed(normal.gap, "outcome.gap"))
        if not (normal.converged and self.tangential is not None and pressure.any()):
            return replace(normal, traction=np.zeros_like(inner.rigid), slip=inner.rigid)
        tangential = self._tangential(inner, tolerance, start)
        return _with_pressure(tangential, normal)

    def _tangential(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None
    ) -> Outcome:
        """Solve the tangential problem under a fixed pressure; refuse forces above the bound."""
        pressure = problem.fixed_pressure.pressure
        if len(problem.forces):
            share = problem.forces.minimum / problem.bound(pressure).radius.sum()
            if share > 1.0:
                return _refuse_forces(problem, share)
        box = rectangle(pressure > 0.0, problem.operators.lattice)
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
    return replace(
        tangential,
        **{name: getattr(normal, name) for name in ("pressure", "gap", "approach")},
        residual=max(normal.residual, tangential.residual),
        cost=tangential.cost + normal.cost,
        trace=normal.trace + tangential.trace,
    )


def _refuse_forces(problem: Problem, share: float) -> Outcome:
    """Return an unconverged outcome, as the forces are `share` (> 1) of what friction can carry."""
    none = np.zeros_like(problem.rigid)
    note = Note(f"the forces take {share:.1%} of what friction can carry", Status.DIVERGED)
    creepage = np.zeros(len(problem.forces))
    return Outcome(
        Status.DIVERGED, 1.0, 0, Cost(), traction=none, slip=none, creepage=creepage, trace=(note,)
    )
