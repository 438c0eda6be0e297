"""Newton's method of a step: no application of the elastic operator is lost.

A step of a transient begins near its solution, and what it costs are the iterations of its linear
systems. They are solved by generalised conjugate residuals (Eisenstat, Elman & Schultz 1983, SIAM
J. Numer. Anal. 20, 345-357): their solution is a sum of vectors that the operator has acted on. So
the slip that a step leads to is known without an application, as long as nothing has to be brought
back to a bound.
"""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from tractive_sam.results import Cost
from tractive_sam.solvers.gmres import orthogonalised
from tractive_sam.solvers.newton import Newton
from tractive_sam.solvers.newton_system import Iterate, System
from tractive_sam.solvers.outcome import Outcome, Start, closed
from tractive_sam.solvers.problem import Problem

ROUNDING = 1e-13
"""Part of a new vector below which rounding has spoilt its digits."""

INSIDE = 0.999
"""Share of the bound below which a first guess is taken to stick."""


def conjugate_residuals(
    system: System, tolerance: float, most: int
) -> tuple[np.ndarray, np.ndarray]:
    """Solve a system to a relative residual with at most so many applications.

    Parameters
    ----------
    system : System
        The system.
    tolerance : float
        Norm of the residual, relative to that of the right-hand side, at which to stop.
    most : int
        Most applications.

    Returns
    -------
    vector : ndarray, shape (n,)
        The solution.
    response : ndarray, shape (2 or 3, n_x, n_y)
        What the operator answers to its fields.
    """
    left = system.right_hand_side()
    goal = tolerance * np.linalg.norm(left)
    found: list[tuple[np.ndarray, np.ndarray]] = []
    basis = np.empty((min(most, 15), left.size))
    triangle, along = np.zeros((most, most)), np.zeros(most)
    while len(found) < most and sqrt(left @ left) > goal:
        k = len(found)
        vector = system.preconditioner(left)
        response = system.response(vector)
        w, h, beyond = orthogonalised(system.product(vector, response.copy()), basis[:k])
        if beyond <= ROUNDING * np.linalg.norm(h):
            break
        if k == len(basis):
            basis = np.concatenate((basis, np.empty_like(basis)))
        np.divide(w, beyond, out=basis[k])
        triangle[:k, k], triangle[k, k] = h, beyond
        along[k] = basis[k] @ left
        left -= along[k] * basis[k]
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
    """

    halvings: int = 3
    rise: float = 0.5  # what a shorter step leads to is known as well
    loosest: float = 0.03  # iterations cost less than the linearisations that they spare
    aim: float = 0.6
    krylov: int = 60

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
        if not len(problem.forces) or start is None:
            return at, cost
        sticks = np.hypot(*at.traction) < INSIDE * at.bound.radius
        if not sticks.any():
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
        vector, answer = conjugate_residuals(system, goal, self.krylov)
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
        return ahead, Cost(system.applications + trials, system.preconditionings)
