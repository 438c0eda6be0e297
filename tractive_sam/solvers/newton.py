"""Preconditioned semismooth Newton-Krylov method for the tangential problem.

The friction law is the root of F(p) = p - disc(p - s(p)). Where an element sticks a Newton step
asks that its slip vanish; where it slips the traction moves along the disc. The linear systems are
solved by GMRES, preconditioned by the **upwind sweep**: on the contact, D = -dA/dx is inverted by
the circulant inverse of A followed by a sum from the leading edge, where the traction is zero, and
in the slip zone the sweep includes the local term of the friction law.
"""

import numpy as np

from tractive_sam.kernels import friction
from tractive_sam.results.status import Cost
from tractive_sam.solvers.gmres import gmres
from tractive_sam.solvers.newton_steps import damped, newton_steps, precision
from tractive_sam.solvers.outcome import Outcome
from tractive_sam.solvers.problem import TangentialProblem

STEPS = 60
KRYLOV = 120


class _Iterate:
    """Traction, creepages and what the friction law says of them."""

    def __init__(self, problem: TangentialProblem, traction: np.ndarray, creepage: np.ndarray):
        shape = problem.bound.shape
        self.traction = traction
        self.creepage = creepage
        self.slip = (
            problem.rigid + problem.transmission.slip(creepage) + problem.half_space.slip(traction)
        )
        self.others = problem.transmission.others(self.slip, creepage)
        self.state = np.empty(shape, np.int8)
        self.direction = np.empty((2, *shape))
        self.kappa = np.empty(shape)
        self.across = np.empty((2, 2, *shape))
        self.defect = np.empty((2, *shape))
        weights = problem.half_space.frame.weights
        squares, merit = friction.linearise(
            traction,
            problem.friction_slip.sticking(self.slip, traction),
            problem.bound,
            problem.half_space.stencil.staggered,
            *weights,
            self.state,
            self.direction,
            self.kappa,
            self.across,
            self.defect,
        )
        self.shortfall = problem.transmission.target - problem.transmission.force(traction)
        # Forces, given and missed, count as if spread evenly over the contact.
        elements = max(np.count_nonzero(problem.bound > 0.0), 1)
        missed = np.sum(self.shortfall**2) / elements
        squares += missed
        size = np.linalg.norm(traction + self.defect)
        size = max(size, np.linalg.norm(problem.transmission.target) / np.sqrt(elements))
        self.residual = np.sqrt(squares) / size if size > 0.0 else 0.0
        self.merit = np.sqrt(merit + missed)


class _Linearised:
    """The Newton system at an iterate; vectors are [traction change, creepage change].

    `kind` is the type of their numbers.
    """

    def __init__(self, problem: TangentialProblem, at: _Iterate, kind: type):
        self.at = at
        self.half_space = problem.half_space
        self.bound = problem.bound
        self.friction_slip = problem.friction_slip
        self.stiffness = problem.friction_slip.stiffness
        self.vectors = problem.transmission.vectors
        self.shape = problem.rigid.shape
        self.size = problem.rigid.size
        self.weight = 1.0 / np.sqrt(max(np.count_nonzero(problem.bound > 0.0), 1))
        self._row = np.empty(self.shape, kind)
        self._rough = np.empty(problem.bound.shape)
        self._smooth = np.empty(self.shape, kind)
        self._out = np.empty(self.size + len(self.vectors), kind)
        self.preconditionings = 0
        if len(self.vectors):
            self._border()

    def _rows(self, step, slip):
        at = self.at
        slip = self.friction_slip.sticking(slip, step)
        friction.tangent_row(
            at.state, at.direction, at.kappa, at.across, self.bound, step, slip, self._row
        )
        return self._row

    def right_hand_side(self) -> tuple[np.ndarray, np.ndarray]:
        """Right-hand side and the part of the step that is known beforehand.

        Where an element slips, its step normal to the disc is the defect's; only the step along
        the disc is unknown.
        """
        at = self.at
        n = np.where(at.state == friction.SLIP, at.direction, 0.0)
        known = (at.defect * n).sum(axis=0) * n
        rhs = np.zeros_like(self._out)
        field = rhs[: self.size].reshape(self.shape)
        if known.any():
            field -= self._rows(known, self.half_space.slip(known.astype(field.dtype)))
        # disc(p - s) - p is already scaled like the rows: -s in stick, kappa-weighted in slip.
        field += np.where(at.state == friction.OPEN, 0.0, at.defect - known)
        rhs[self.size :] = self.weight * (at.shortfall - self.vectors @ known.sum(axis=(1, 2)))
        return rhs, known

    def operator(self, vector: np.ndarray) -> np.ndarray:
        """Apply the Newton matrix."""
        step = vector[: self.size].reshape(self.shape)
        slip = self.half_space.slip(step)
        if len(self.vectors):
            slip += (vector[self.size :] @ self.vectors)[:, None, None]
            self._out[self.size :] = self.weight * (self.vectors @ step.sum(axis=(1, 2)))
        self._out[: self.size] = self._rows(step, slip).ravel()
        return self._out

    def _sweep(self, rows: np.ndarray) -> np.ndarray:
        at = self.at
        own = self.half_space.slip_of_itself
        friction.split(
            at.state, at.direction, at.kappa, self.stiffness, own, rows, self._smooth, self._rough
        )
        increments = self.half_space.tangential_inverse(self._smooth)
        self.preconditionings += 1
        out = np.empty_like(self._smooth)
        friction.sweep(
            at.state, at.direction, at.kappa, self.stiffness, own, increments, self._rough, out
        )
        return out

    def _border(self):
        """Response of the traction to each creepage, and of the forces to it (bordering)."""
        zero = np.zeros_like(self._row)
        self._response = [
            self._sweep(self._rows(zero, np.broadcast_to(v[:, None, None], self.shape)).copy())
            for v in self.vectors
        ]
        self._schur = np.array(
            [[v @ r.sum(axis=(1, 2)) for r in self._response] for v in self.vectors]
        )

    def preconditioner(self, vector: np.ndarray) -> np.ndarray:
        """Apply the upwind sweep, bordered by the forces."""
        step = self._sweep(vector[: self.size].reshape(self.shape))
        out = np.empty_like(vector)
        if len(self.vectors):
            missed = self.vectors @ step.sum(axis=(1, 2)) - vector[self.size :] / self.weight
            # Least squares: in full slip the forces do not answer the creepages.
            creepage = np.linalg.lstsq(self._schur, missed, rcond=1e-12)[0]
            for c, response in zip(creepage, self._response, strict=True):
                step -= c * response
            out[self.size :] = creepage
        out[: self.size] = step.ravel()
        return out


def newton(
    problem: TangentialProblem,
    tolerance: float,
    traction: np.ndarray | None = None,
    creepage: np.ndarray | None = None,
    steps: int = STEPS,
) -> Outcome:
    """Solve the tangential problem by semismooth Newton steps.

    Parameters
    ----------
    problem : TangentialProblem
        The problem.
    tolerance : float
        Natural residual, relative, at which to stop.
    traction : ndarray, shape (2, n_x, n_y), optional
        First guess; zero by default.
    creepage : ndarray, shape (m,), optional
        First guess of the creepages to be found.
    steps : int
        Most Newton steps.
    """
    first = np.zeros_like(problem.rigid) if traction is None else traction
    first_creepage = np.zeros(len(problem.transmission)) if creepage is None else creepage
    before = problem.half_space.slip.applications
    preconditionings = 0
    projected = np.empty_like(first)
    weights = problem.half_space.frame.weights
    friction.project(first, problem.bound, projected)

    def advance(at: _Iterate, goal: float, stalled: bool) -> _Iterate:
        nonlocal preconditionings
        system = _Linearised(problem, at, precision(goal, problem.bound.size))
        rhs, known = system.right_hand_side()
        vector, _ = gmres(system.operator, system.preconditioner, rhs, goal, KRYLOV)
        vector = vector.astype(float)
        preconditionings += system.preconditionings
        step = known + vector[: system.size].reshape(system.shape)
        creepage = vector[system.size :]

        def trial(length: float) -> _Iterate:
            projected = np.empty_like(step)
            friction.project(at.traction + length * step, problem.bound, projected, *weights)
            return _Iterate(problem, projected, at.creepage + length * creepage)

        length = problem.transmission.reach(at.creepage, creepage, at.others)
        return damped(trial, at.merit, length, stalled)

    at, taken, status = newton_steps(
        _Iterate(problem, projected, first_creepage),
        advance,
        problem.transmission,
        tolerance,
        steps,
    )
    return Outcome(
        status,
        float(at.residual),
        taken,
        Cost(problem.half_space.slip.applications - before, preconditionings),
        traction=at.traction,
        slip=at.slip,
        creepage=at.creepage,
    )
