"""Newton's method of a step: it spares applications of the elastic operator.

A step of a transient begins near its solution, and what it costs are the last digits of its linear
systems. They are solved by generalised conjugate residuals (Eisenstat, Elman & Schultz 1983, SIAM
J. Numer. Anal. 20, 345-357), each iteration preconditioned by a few ones of GMRES on nearly the
same system, of half the work or less, whose loads act across the edges of the mesh
(`Operators.nearby`; van der Vorst & Vuik 1994, Numer. Linear Algebra Appl. 1, 369-386). What an
iteration cannot foresee are those loads only: it gains a digit and more.

A step is a sum of vectors that the operator has acted on. So the slip that it leads to is known
without an application, as long as nothing has to be brought back to a bound.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from tractive_sam.results import Cost
from tractive_sam.solvers.gmres import gmres, orthogonalised
from tractive_sam.solvers.newton import Newton
from tractive_sam.solvers.newton_system import Iterate, System
from tractive_sam.solvers.outcome import Outcome, Start, closed
from tractive_sam.solvers.problem import Problem

ROUNDING = 1e-13
"""Part of a new vector below which rounding has spoilt its digits."""

INSIDE = 0.999
"""Share of the bound below which a first guess is taken to stick."""


def conjugate_residuals(
    system: System,
    preconditioner: Callable[[np.ndarray], np.ndarray],
    tolerance: float,
    most: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Solve a system to a relative residual with at most so many applications.

    Parameters
    ----------
    system : System
        The system.
    preconditioner : callable
        Nearly the inverse of its matrix; not necessarily linear.
    tolerance : float
        Norm of the residual, relative to that of the right-hand side, at which to stop.
    most : int
        Most applications.

    Returns
    -------
    vector, response : ndarray
        The solution, and what the operator answers to its fields.
    """
    left = system.right_hand_side()
    goal = tolerance * np.linalg.norm(left)
    basis = np.empty((min(most, 15), left.size))
    found: list[tuple[np.ndarray, np.ndarray]] = []
    triangle, along = np.zeros((most, most)), np.zeros(most)
    while len(found) < most and np.linalg.norm(left) > goal:
        k = len(found)
        vector = preconditioner(left)
        response = system.response(vector)
        w, h, beyond = orthogonalised(system.product(vector, response.copy()), basis[:k])
        if beyond <= ROUNDING * np.linalg.norm(h):
            break
        if k == len(basis):
            basis = np.concatenate((basis, np.empty_like(basis)))
        np.divide(w, beyond, out=basis[k])
        triangle[:k, k], triangle[k, k] = h, beyond
        along[k] = basis[k] @ left
        left = left - along[k] * basis[k]
        found.append((vector, response))
    count = len(found)
    shares = np.linalg.solve(triangle[:count, :count], along[:count])
    vector, answer = np.zeros(left.size), np.zeros(system.shape)
    for share, (one, response) in zip(shares, found, strict=True):
        vector += share * one
        answer += share * response
    return vector, answer


@dataclass(frozen=True)
class Sparing(Newton):
    """Newton's method that spares applications; see the module.

    Attributes
    ----------
    krylov : int
        As of `Newton`; of each application three vectors are held.
    inner : int
        Most iterations of GMRES that precondition one of the system.
    near : float
        Relative residual at which they end.
    """

    halvings: int = 3
    rise: float = 0.5  # what a shorter step leads to is known as well
    loosest: float = 0.5
    aim: float = 0.6
    krylov: int = 40
    inner: int = 6
    near: float = 0.03

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """See `Newton.solve`."""
        outcome = super().solve(problem, tolerance, start)
        # What is beyond a bound, or left where there is no contact, is part of the residual.
        pressure = outcome.pressure
        if not problem.held:
            pressure = closed(pressure, outcome.gap)
        bound = problem.bound(pressure).radius
        traction = problem.project(outcome.traction, bound, physical=True)
        return replace(outcome, pressure=pressure, traction=traction)

    def _is_closed(self, at: Iterate) -> bool:
        """See `Newton._is_closed`: `solve` cleans what it returns, without an application."""
        return True

    def _first(self, problem: Problem, start: Start | Outcome | None) -> tuple[Iterate, Cost]:
        at, cost = super()._first(problem, start)
        sticks = np.hypot(*at.traction) < INSIDE * at.bound.radius
        if not len(problem.forces) or start is None or not sticks.any():
            return at, cost
        # Creepages by which what is to stick slips least.
        slip = at.slip[:, sticks].mean(axis=1)
        change = np.linalg.lstsq(problem.forces.vectors.T, -slip, rcond=None)[0]
        return at.creeping(problem, at.creepage + change), cost

    def _advanced(
        self, problem: Problem, at: Iterate, goal: float, stalled: bool, bounded: bool
    ) -> tuple[Iterate, Cost]:
        """See `Newton._advanced`."""
        system = System(problem, at, float)
        preconditioner, near = system.preconditioner, system
        if problem.nearby is not None:
            near = System(problem.nearby, at, self.precision(self.near, at.pressure.size))
            preconditioner = partial(self._nearly, near)
        vector, answer = conjugate_residuals(system, preconditioner, goal, self.krylov)
        # Bringing tractions back takes an application each: only where leaving them has stalled.
        ahead, trials = self._led(
            problem,
            at,
            system.fields(vector),
            vector[system.size :],
            answer,
            stalled,
            not bounded,
        )
        beside = near.preconditionings + (0 if near is system else near.applications)
        return ahead, Cost(system.applications + trials, beside)

    def _nearly(self, near: System, left: np.ndarray) -> np.ndarray:
        """Roughly the solution of a system nearby."""
        rows = left.astype(near.kind)
        found = gmres(near.operator, near.preconditioner, rows, self.near, self.inner)
        return found[0].astype(float)
