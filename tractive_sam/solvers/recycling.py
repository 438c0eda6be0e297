"""Newton's method of a step: its linear systems share their Krylov vectors.

From one Newton step to the next only local terms of the matrix change, while stick and slip zones
move: the elastic operator A remains. Of every vector that it has acted on, the product with the
next matrix costs no application, so that each linear system goes on where the one before has
stopped (generalised conjugate residuals, Eisenstat, Elman & Schultz 1983, SIAM J. Numer. Anal. 20,
345-357, on vectors that are kept). For the same reason the slip that a step leads to is known
without an application, as long as nothing has to be brought back to a bound.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from tractive_sam.kernels.friction import OPEN
from tractive_sam.results import Cost
from tractive_sam.solvers.gmres import orthogonalised
from tractive_sam.solvers.newton import Newton
from tractive_sam.solvers.newton_system import ROUNDING, Iterate, System
from tractive_sam.solvers.outcome import Outcome, Start
from tractive_sam.solvers.problem import Problem

INSIDE = 0.999
"""Share of the bound below which a first guess is taken to stick."""


class WholeSystem(System):
    """The Newton system with the steps that `System` knows beforehand among its unknowns.

    So any field is a step of it, whatever its elements did when it was found: rows of an element
    that slips ask along its direction for what follows the bound, those of one that has left that
    pressure and traction vanish.
    """

    def __init__(self, problem: Problem, at: Iterate):
        self._open = at.law.state == OPEN
        super().__init__(problem, at, float)

    def completed(self, step: np.ndarray) -> np.ndarray:
        """The step itself: nothing is left to complete."""
        return step

    def right_hand_side(self) -> tuple[np.ndarray, np.ndarray]:
        """Right-hand side, and the fields known beforehand: none."""
        at, rhs = self.at, np.zeros(self.length)
        rows = self.fields(rhs)
        if self.free:
            rows[0] = np.where(at.active, -at.gap, -at.pressure)
        rows[-2:] = at.ratio * np.where(self._open, -at.traction, at.law.defect)
        missed = at.ratio * at.force_missed
        if self.under_load:
            missed = np.concatenate(([at.load_missed], missed))
        rhs[self.size :] = self.weight * missed
        return rhs, np.zeros(self.shape)

    def response(self, vector: np.ndarray) -> np.ndarray:
        """What the operator answers to the fields of a vector; one application."""
        return self._response(self.fields(vector))

    def product(self, vector: np.ndarray, response: np.ndarray) -> np.ndarray:
        """The matrix times a vector of which the response is known; overwritten by the next."""
        step = self.fields(vector)
        self._rows(step, self._extended(response.copy(), vector[self.size :]))
        if self.length > self.size:
            self._out[self.size :] = self.weight * self._resultants(step)
        return self._out

    def _rows(self, step: np.ndarray, response: np.ndarray) -> np.ndarray:
        at, rows, own = self.at, super()._rows(step, response), step[-2:]
        if self.free:
            rows[0] = np.where(at.active, rows[0], step[0])
            own = own - self._following * step[0]
        if at.law.falling is None:
            rows[-2:] += at.ratio * (at.law.direction * own).sum(axis=0) * at.law.direction
        rows[-2:] = np.where(self._open, at.ratio * step[-2:], rows[-2:])
        return rows

    def _approximate_inverse(self, rows: np.ndarray) -> np.ndarray:
        step, law = super()._approximate_inverse(rows), self.at.law
        tangential = rows[-2:] / self.at.ratio
        if law.falling is None:
            step[-2:] += (law.direction * tangential).sum(axis=0) * law.direction
        if self.free:
            step[0] = np.where(self.at.active, step[0], rows[0])
            step[-2:] += self._following * step[0]
        step[-2:] = np.where(self._open, tangential, step[-2:])
        return step


class Space:
    """Vectors and the responses to them, kept from one linear system to the next.

    Parameters
    ----------
    keeps : int
        Most vectors kept.
    """

    def __init__(self, keeps: int):
        self._keeps = keeps
        self._vectors: list[np.ndarray] = []
        self._responses: list[np.ndarray] = []

    def solve(
        self, system: WholeSystem, rhs: np.ndarray, tolerance: float, most: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Solve a system to a relative residual with at most so many applications.

        Returns
        -------
        vector, response : ndarray
            The solution, and what the operator answers to its fields.
        """
        basis, triangle = self._orthonormal(system)
        count = len(basis)
        basis = np.concatenate((basis, np.empty((16, rhs.size))))
        triangle = np.pad(triangle, (0, most))
        along = np.zeros(count + most)
        along[:count] = basis[:count] @ rhs
        left = rhs - along[:count] @ basis[:count]
        goal = tolerance * np.linalg.norm(rhs)
        for k in range(count, count + most):
            if np.linalg.norm(left) <= goal:
                break
            vector = system.preconditioner(left)
            response = system.response(vector)
            w, h, beyond = orthogonalised(system.product(vector, response), basis[:k])
            if beyond <= ROUNDING * np.linalg.norm(h):
                break
            if k == len(basis):
                basis = np.concatenate((basis, np.empty_like(basis[:16])))
            np.divide(w, beyond, out=basis[k])
            triangle[:k, k], triangle[k, k] = h, beyond
            along[k] = basis[k] @ left
            left = left - along[k] * basis[k]
            self._vectors.append(vector)
            self._responses.append(response)
        found = len(self._vectors)
        shares = np.linalg.solve(triangle[:found, :found], along[:found])
        vector, answer = np.zeros(rhs.size), np.zeros(system.shape)
        for share, one, response in zip(shares, self._vectors, self._responses, strict=True):
            vector += share * one
            answer += share * response
        del self._vectors[: -self._keeps], self._responses[: -self._keeps]
        return vector, answer

    def _orthonormal(self, system: WholeSystem) -> tuple[np.ndarray, np.ndarray]:
        """Products of the kept vectors: an orthonormal basis of them and the triangle to it.

        By the Cholesky factor of their products with each other; where rounding spoils it, nothing
        is kept.
        """
        products = np.empty((len(self._vectors), system.length))
        for row, vector, response in zip(products, self._vectors, self._responses, strict=True):
            row[:] = system.product(vector, response)
        try:
            lower = np.linalg.cholesky(products @ products.T)
            return np.linalg.solve(lower, products), lower.T
        except np.linalg.LinAlgError:
            self._vectors, self._responses = [], []
            return products[:0], np.zeros((0, 0))


@dataclass(frozen=True)
class Recycling(Newton):
    """Newton's method whose linear systems share their Krylov vectors; see the module.

    Attributes
    ----------
    keeps : int
        Most vectors that a linear system leaves to the next.
    """

    halvings: int = 3
    rise: float = 0.5  # what a shorter step leads to is known as well
    loosest: float = 0.5
    aim: float = 0.6
    keeps: int = 30

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """See `Newton.solve`."""
        outcome = super().solve(problem, tolerance, start)
        # What is beyond a bound, or left where there is no contact, is part of the residual.
        pressure = outcome.pressure
        if not problem.held:
            pressure = np.where(pressure > outcome.gap, pressure, 0.0)
        bound = problem.bound(pressure).radius
        traction = problem.project(outcome.traction, bound, physical=True)
        return replace(outcome, pressure=pressure, traction=traction)

    def _first(self, problem: Problem, start: Start | Outcome | None) -> tuple[Iterate, Cost]:
        at, cost = super()._first(problem, start)
        sticks = np.hypot(*at.traction) < INSIDE * at.bound.radius
        if not len(problem.forces) or start is None or not sticks.any():
            return at, cost
        # Creepages by which what is to stick slips least.
        slip = at.slip[:, sticks].mean(axis=1)
        change = np.linalg.lstsq(problem.forces.vectors.T, -slip, rcond=None)[0]
        return at.creeping(problem, at.creepage + change), cost

    def _advancing(self, problem: Problem) -> Callable[..., tuple[Iterate, Cost]]:
        return partial(self._advanced_in, Space(self.keeps), problem)

    def _advanced_in(
        self,
        space: Space,
        problem: Problem,
        at: Iterate,
        goal: float,
        stalled: bool,
        bounded: bool,
    ) -> tuple[Iterate, Cost]:
        system = WholeSystem(problem, at)
        vector, answer = space.solve(system, system.right_hand_side()[0], goal, self.krylov)
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
