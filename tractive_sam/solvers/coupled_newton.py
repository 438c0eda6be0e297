"""Semismooth Newton-Krylov method for dissimilar bodies: pressure and tractions at once.

Pressure makes dissimilar surfaces slip and tractions make them lift, so that neither problem can be
solved by itself. Alternating between them diverges for strong coupling; here both are unknowns of
the same Newton iteration. Its linear systems are preconditioned by the circulant inverse for the
pressure and the upwind sweep (`solvers.newton`) for the tractions.
"""

import numpy as np

from tractive_sam.kernels import friction
from tractive_sam.results.status import Cost
from tractive_sam.solvers.gmres import gmres
from tractive_sam.solvers.newton_steps import damped, newton_steps, precision
from tractive_sam.solvers.outcome import Outcome, relative
from tractive_sam.solvers.problem import CoupledProblem

STEPS = 60
KRYLOV = 150


class _Iterate:
    """Pressure, tractions, approach, creepages, and what the contact conditions say of them.

    Tractions may be tiny beside the pressure: they and their slip count `ratio` times, the size of
    the pressure over theirs. The merit counts them as many times as asked for.
    """

    def __init__(self, problem: CoupledProblem, pressure, traction, approach, creepage, ratio=1.0):
        shape = pressure.shape
        self.pressure = np.maximum(pressure, 0.0)
        self.traction = np.empty_like(traction)
        weights = problem.half_space.frame.weights
        friction.project(traction, self.pressure, self.traction, *weights)
        self.approach, self.creepage = approach, creepage
        response = problem.half_space.coupled(np.concatenate((self.pressure[None], self.traction)))
        self.gap = problem.gap + response[0] - approach
        self.slip = problem.rigid + problem.transmission.slip(creepage) + response[1:]
        self.friction_slip = problem.half_space.friction_slip(self.pressure, self.gap)
        self.active = self.pressure > self.gap
        self.others = problem.transmission.others(self.slip, creepage)
        self.state = np.empty(shape, np.int8)
        self.direction = np.empty((2, *shape))
        self.kappa = np.empty(shape)
        self.across = np.empty((2, 2, *shape))
        self.defect = np.empty((2, *shape))
        squares, self._tangential = friction.linearise(
            self.traction,
            self.friction_slip.sticking(self.slip, self.traction),
            self.pressure,
            problem.half_space.stencil.staggered,
            *weights,
            self.state,
            self.direction,
            self.kappa,
            self.across,
            self.defect,
        )
        # Resultants, given and missed, count as if spread evenly over the contact.
        self.load_missed = 0.0 if problem.load is None else problem.load - self.pressure.sum()
        self.force_missed = problem.transmission.target - problem.transmission.force(self.traction)
        elements = max(np.count_nonzero(self.active), 1)
        missed = np.sum(self.force_missed**2) / elements
        self._normal = np.sum(np.minimum(self.pressure, self.gap) ** 2)
        self._normal += self.load_missed**2 / elements
        self._tangential += missed
        size = np.linalg.norm(self.pressure)
        asked = np.linalg.norm(problem.transmission.target) / np.sqrt(elements)
        drag = max(np.linalg.norm(self.traction + self.defect), asked)
        self.residual = max(
            relative(np.sqrt(self._normal), size), relative(np.sqrt(squares + missed), drag)
        )
        self.ratio = max(size / drag, 1.0) if drag > 0.0 else 1.0
        self.merit = self.merit_by(ratio)
        # An element about to leave takes its traction along.
        self.leaving = ~self.active & (self.pressure > 0.0)
        self.state[~self.active] = friction.OPEN

    def merit_by(self, ratio: float) -> float:
        """Size of what the conditions miss, where those of the tractions count `ratio` times."""
        return float(np.sqrt(self._normal + ratio**2 * self._tangential))


class _Linearised:
    """The Newton system; vectors are [pressure, traction, approach (under load), creepages].

    `kind` is the type of their numbers.
    """

    def __init__(self, problem: CoupledProblem, at: _Iterate, kind: type):
        self.at = at
        self.kind = kind
        self.half_space = problem.half_space
        self.stiffness = at.friction_slip.stiffness
        self.vectors = problem.transmission.vectors
        self.under_load = problem.load is not None
        self.shape = (3, *at.pressure.shape)
        self.size = int(np.prod(self.shape))
        self.length = self.size + self.under_load + len(self.vectors)
        self.weight = 1.0 / np.sqrt(max(np.count_nonzero(at.active), 1))
        self.normal = np.where(at.state == friction.SLIP, at.direction, 0.0)
        self._row = np.empty((2, *at.pressure.shape), kind)
        self._smooth = np.empty_like(self._row)
        self._rough = np.empty_like(at.pressure)
        self.preconditionings = 0
        self._border()

    def _fields(self, vector):
        return vector[: self.size].reshape(self.shape)

    def _rows(self, step, whole, response):
        """Linearised conditions of a change of the unknowns.

        ``whole`` is that of all tractions (`complete`), ``response`` that of gap and slip by it.
        """
        at = self.at
        slip = at.friction_slip.sticking_change(response[1:], at.traction, whole, response[0])
        friction.tangent_row(
            at.state, at.direction, at.kappa, at.across, at.pressure, step[1:], slip, self._row
        )
        self._row *= at.ratio
        return np.concatenate((np.where(at.active, response[0], 0.0)[None], self._row))

    def _resultants(self, step):
        sums = list(self.at.ratio * self.vectors @ step[1:].sum(axis=(1, 2)))
        return np.array([step[0].sum(), *sums] if self.under_load else sums)

    def _extend(self, response, extra):
        """Add the change of approach and creepages to a change of gap and slip."""
        if self.under_load:
            response[0] -= extra[0]
        response[1:] += (extra[int(self.under_load) :] @ self.vectors)[:, None, None]
        return response

    def complete(self, step: np.ndarray) -> np.ndarray:
        """Add the change of a slipping traction that follows its changing bound."""
        step = step.copy()
        step[1:] += self.normal * step[0]
        return step

    def right_hand_side(self):
        """Right-hand side, and the part of the step known beforehand."""
        at = self.at
        known = np.zeros(self.shape)
        known[0] = np.where(at.leaving, -at.pressure, 0.0)
        known[1:] = (at.defect * self.normal).sum(axis=0) * self.normal
        known[1:] -= np.where(at.active, 0.0, at.traction)
        rhs = np.zeros(self.length, self.kind)
        field = self._fields(rhs)
        if known.any():
            response = self.half_space.coupled(known.astype(self.kind))
            field -= self._rows(np.zeros(self.shape, self.kind), known, response)
        field[0] -= np.where(at.active, at.gap, 0.0)
        field[1:] += at.ratio * np.where(at.state == friction.OPEN, 0.0, at.defect - known[1:])
        forces = at.ratio * at.force_missed
        missed = np.array([at.load_missed, *forces] if self.under_load else forces)
        rhs[self.size :] = self.weight * (missed - self._resultants(known))
        return rhs, known

    def operator(self, vector: np.ndarray) -> np.ndarray:
        """Apply the Newton matrix."""
        free = self._fields(vector)
        step = self.complete(free)
        response = self._extend(self.half_space.coupled(step), vector[self.size :])
        out = np.empty(self.length, self.kind)
        self._fields(out)[:] = self._rows(free, step, response)
        out[self.size :] = self.weight * self._resultants(step)
        return out

    def _approximate_inverse(self, rows: np.ndarray) -> np.ndarray:
        at, own = self.at, self.half_space.slip_of_itself
        out = np.empty(self.shape, self.kind)
        out[0] = np.where(at.active, self.half_space.normal_inverse(rows[:1])[0], 0.0)
        friction.split(
            at.state,
            at.direction,
            at.kappa,
            self.stiffness,
            own,
            rows[1:] / at.ratio,
            self._smooth,
            self._rough,
        )
        increments = self.half_space.tangential_inverse(self._smooth)
        friction.sweep(
            at.state,
            at.direction,
            at.kappa,
            self.stiffness,
            own,
            increments,
            self._rough,
            out[1:],
        )
        self.preconditionings += 1
        return out

    def _border(self):
        """Responses to the unknown approach and creepages, and of the resultants to them."""
        count = self.length - self.size
        zero = np.zeros(self.shape, self.kind)
        self._responses = [
            self._approximate_inverse(self._rows(zero, zero, self._extend(zero.copy(), unit)))
            for unit in np.eye(count)
        ]
        self._schur = np.array(
            [self._resultants(self.complete(r)) for r in self._responses]
        ).T.reshape(count, count)

    def preconditioner(self, vector: np.ndarray) -> np.ndarray:
        """Apply the approximate inverse, bordered by the resultants."""
        step = self._approximate_inverse(self._fields(vector))
        out = np.empty(self.length, self.kind)
        if self._responses:
            missed = self._resultants(self.complete(step)) - vector[self.size :] / self.weight
            # Least squares: in full slip the forces do not answer the creepages.
            extra = np.linalg.lstsq(self._schur, missed, rcond=1e-12)[0]
            for c, response in zip(extra, self._responses, strict=True):
                step -= c * response
            out[self.size :] = extra
        self._fields(out)[:] = step
        return out


def coupled_newton(
    problem: CoupledProblem,
    tolerance: float,
    pressure: np.ndarray,
    traction: np.ndarray,
    approach: float,
    creepage: np.ndarray | None = None,
    steps: int = STEPS,
) -> Outcome:
    """Solve the coupled problem by semismooth Newton steps from a first guess.

    Parameters
    ----------
    problem : CoupledProblem
        The problem.
    tolerance : float
        Natural residual, relative, at which to stop.
    pressure, traction, approach, creepage
        First guess, as in `Outcome`.
    steps : int
        Most Newton steps.
    """
    before = problem.half_space.coupled.applications
    preconditionings = 0
    creepage = np.zeros(len(problem.transmission)) if creepage is None else creepage
    approach = approach if problem.load is not None else problem.approach
    under_load = problem.load is not None

    def advance(at: _Iterate, goal: float, stalled: bool) -> _Iterate:
        nonlocal preconditionings
        system = _Linearised(problem, at, precision(goal, at.pressure.size))
        rhs, known = system.right_hand_side()
        vector, _ = gmres(system.operator, system.preconditioner, rhs, goal, KRYLOV)
        vector = vector.astype(float)
        preconditionings += system.preconditionings
        step = known + system.complete(vector[: system.size].reshape(system.shape))
        closer = vector[system.size] if under_load else 0.0
        faster = vector[system.size + under_load :]

        def trial(length: float) -> _Iterate:
            return _Iterate(
                problem,
                at.pressure + length * step[0],
                at.traction + length * step[1:],
                at.approach + length * closer,
                at.creepage + length * faster,
                at.ratio,
            )

        reach = problem.transmission.reach(at.creepage, faster, at.others)
        return damped(trial, at.merit_by(at.ratio), reach, stalled)

    at, taken, status = newton_steps(
        _Iterate(problem, pressure, traction, approach, creepage),
        advance,
        problem.transmission,
        tolerance,
        steps,
    )
    return Outcome(
        status,
        float(at.residual),
        taken,
        Cost(problem.half_space.coupled.applications - before, preconditionings),
        pressure=at.pressure,
        gap=at.gap,
        traction=at.traction,
        slip=at.slip,
        approach=float(at.approach),
        creepage=at.creepage,
    )
