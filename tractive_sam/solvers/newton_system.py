"""One step of Newton's method: an iterate, and the linear system at it.

Vectors of the system are [fields, approach (under load), creepages]; see `Problem` for the fields.
Everything tangential is written once, for fields[-2:], whether or not there is a pressure before.
"""

from functools import cached_property
from math import prod, sqrt

import numpy as np

from tractive_sam.solvers.outcome import closed, relative
from tractive_sam.solvers.problem import Problem


class Iterate:
    """Newton iterate: fields, approach and creepages, with the residual of contact conditions.

    Tractions may be tiny compared with the pressure. They and their slip are weighted by `ratio`,
    the size of the pressure over the size of the tractions, as in the merit.

    Tractions beyond their bound are returned to it, which is safer while stick and slip zones move.
    But if mu1 and mu2 differ much, a step can push an element that is at its bound, and assumed to
    stick, outwards along the weak axis. Returned every time, it never slips. If not `bounded` it
    stays outside, and the next linearisation finds that it slips.

    The response of the operator to the fields may be known (`response`); if it is not, or a
    traction was returned to its bound, `applications` is one.
    """

    rounding = 4.0 * float(np.finfo(float).eps)
    """Relative rounding error of a response of the operator."""

    def __init__(
        self,
        problem: Problem,
        pressure: np.ndarray,
        traction: np.ndarray,
        approach: float,
        creepage: np.ndarray,
        ratio: float = 1.0,
        bounded: bool = True,
        response: np.ndarray | None = None,
    ):
        fixed, normal, forces = problem.is_pressure_fixed, problem.normal, problem.forces
        self.pressure = pressure if fixed else np.maximum(pressure, 0.0)
        self.bound = problem.bound(self.pressure)
        self.traction, self._bounded = traction, bounded
        if bounded:
            self.traction = problem.project(traction, self.bound.radius, physical=True)
        self.approach, self.creepage = approach, creepage
        self.applications = 0
        if response is None or self._was_changed_from(pressure, traction):
            response, self.applications = problem.response(self.fields(fixed)), 1
        self.response = response
        self.slip = problem.rigid + response[-2:]
        if len(forces):
            self.slip += forces.slip(creepage)
        self.gap = normal.gap if fixed else normal.gap + response[0] - approach
        self.active = problem.touching if fixed else self.pressure > self.gap
        # An element with an open gap has left the contact, whatever pressure a step has left on it.
        touching = self.pressure if fixed else closed(self.pressure, self.gap)
        self.seen = problem.friction_slip(touching, self.gap)
        # The tractions lie within the bound at rest, the law needs the bound under the slip.
        self.bound = problem.bound_sliding(
            self.bound, self.pressure, self.traction, self.slip, self.seen
        )
        self.law = problem.linearise(
            self.traction, self.slip, self.bound, self.seen, None if fixed else self.active
        )
        self.elastic_slip = forces.elastic_slip(self.slip, creepage)
        self._set_residual(problem)
        self.merit = self.merit_by(ratio)

    def _set_residual(self, problem: Problem) -> None:
        """Compute and store the residual, the missing load and forces, and their weights."""
        forces = problem.forces
        # Resultants, given and missed, count as if spread evenly over the contact.
        self.elements = elements = max(int(np.count_nonzero(self.active)), 1)
        self.load_missed = 0.0 if problem.load is None else problem.load - self.pressure.sum()
        self.force_missed, missed, wanted = forces.target, 0.0, 0.0
        if len(forces):
            self.force_missed = forces.target - forces.force(self.traction)
            missed = np.sum(self.force_missed**2) / elements
            wanted = float(np.linalg.norm(forces.target) / np.sqrt(elements))
        self.drag = drag = max(sqrt(self.law.reached), wanted)
        self._tangential = self.law.merit + missed
        self._normal = 0.0
        defect = sqrt(self.law.squares + missed)
        # Tractions cannot be known better than the slip, which is rounded as its parts are.
        largest = max(self.response[-2:].max(), -self.response[-2:].min())
        rounded = self.rounding * sqrt(self.pressure.size) * largest
        self.residual = relative(defect, drag) if defect > rounded else 0.0
        self.ratio = 1.0
        if not problem.is_pressure_fixed:
            self._normal = np.sum(np.minimum(self.pressure, self.gap) ** 2)
            self._normal += self.load_missed**2 / elements
            # No less than of a pressure that has the load: to have none is no solution.
            even = (problem.load or 0.0) / np.sqrt(elements)
            size = max(float(np.linalg.norm(self.pressure)), float(even))
            self.residual = max(relative(np.sqrt(self._normal), size), self.residual)
            self.ratio = float(max(size / drag, 1.0)) if drag > 0.0 else 1.0

    def _was_changed_from(self, pressure: np.ndarray, traction: np.ndarray) -> bool:
        """Return whether making the fields admissible has changed these fields."""
        fields = ((self.traction, traction), (self.pressure, pressure))
        return any(new is not before and (new != before).any() for new, before in fields)

    def with_creepage(self, problem: Problem, creepage: np.ndarray) -> "Iterate":
        """Return the iterate with other creepages."""
        fields = self.pressure, self.traction, self.approach
        return Iterate(problem, *fields, creepage, 1.0, False, self.response)

    @property
    def is_admissible(self) -> bool:
        """Return whether open gaps carry no pressure, and tractions are within their bound."""
        return self._bounded and not (self.pressure[~self.active] > 0.0).any()

    def within_bound(self, problem: Problem) -> "Iterate":
        """Return the iterate without pressure on open gaps, with tractions within their bound."""
        pressure = self.pressure if problem.is_pressure_fixed else closed(self.pressure, self.gap)
        return Iterate(problem, pressure, self.traction, self.approach, self.creepage)

    def fields(self, fixed: bool) -> np.ndarray:
        """Return the unknown fields: tractions, preceded by the pressure unless it is fixed."""
        return self.traction if fixed else np.concatenate((self.pressure[None], self.traction))

    def merit_by(self, ratio: float) -> float:
        """Return the norm of the residual, with its tangential part weighted by `ratio`."""
        # The ratio may be larger than what a square can be.
        return float(np.hypot(np.sqrt(self._normal), ratio * np.sqrt(self._tangential)))


class System:
    """Linear system of a Newton step at an iterate, in the number type `kind`.

    An `approximate` system has the response of `Problem.approximate`.

    An element in contact asks that its gap close, one that has left that its pressure vanish, and
    the friction law for what `Linearisation` says. A slipping traction follows its bound along its
    direction, and with it the pressure.

    Attributes
    ----------
    applications, preconditionings : int
        Work done.
    """

    def __init__(
        self, problem: Problem, at: Iterate, kind: type[np.floating], approximate: bool = False
    ):
        self.problem, self.at, self.kind = problem, at, kind
        self._respond = (problem.approximate if approximate else problem).response
        self.operators, self.vectors = problem.operators, problem.forces.vectors
        self.free, self.under_load = not problem.is_pressure_fixed, problem.load is not None
        self.shape = problem.shape
        self.size = prod(self.shape)
        self.length = self.size + self.under_load + len(self.vectors)
        self.weight = 1.0 / sqrt(at.elements)
        self._inverse = problem.kinematics.approximate_inverse(
            self.operators, at.law, at.seen.stiffness
        )
        self.applications = self.preconditionings = 0
        # The traction of an element that slips, per pressure that its bound rises with.
        self._following = at.law.direction * at.bound.by_pressure if self.free else None
        self._out: np.ndarray = np.empty(self.length, kind)
        self._rows_made = self.fields(self._out)

    def fields(self, vector: np.ndarray) -> np.ndarray:
        """Return pressure and tractions in a vector of unknowns, a view of its first part.

        The shape is (3, n_x, n_y); under a fixed pressure (2, n_x, n_y), the tractions only.
        """
        return vector[: self.size].reshape(self.shape)

    def _rows(self, step: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the linearised contact conditions for a step and its elastic response.

        They are the fields of the vector that `operator` returns, and overwritten by the next ones.
        """
        at, rows, tangential = self.at, self._rows_made, step[-2:]
        if self.free:
            rows[0] = np.where(at.active, response[0], step[0])
            slip = at.seen.sticking_change(response[1:], at.traction, step, response[0], at.slip)
            tangential = tangential - self._following * step[0]
        else:
            slip = at.seen.sticking(response, step)
        at.law.rows(tangential, slip, rows[-2:])
        if at.ratio != 1.0:
            rows[-2:] *= at.ratio
        return rows

    def _resultants(self, step: np.ndarray) -> np.ndarray:
        """Return load (if prescribed) and tangential forces of a step of the fields."""
        sums = self.at.ratio * self.vectors @ step[-2:].sum(axis=(1, 2))
        return np.concatenate(([step[0].sum()], sums)) if self.under_load else sums

    def _extended(self, response: np.ndarray, extra: np.ndarray) -> np.ndarray:
        """Return a change of gap and slip plus that due to changed approach and creepages."""
        if extra.size:
            response = response.copy()
        if self.under_load:
            response[0] -= extra[0]
        if len(self.vectors):
            response[-2:] += (extra[int(self.under_load) :] @ self.vectors)[:, None, None]
        return response

    def right_hand_side(self) -> np.ndarray:
        """Return the right-hand side: the negative residual of the contact conditions."""
        at = self.at
        rhs: np.ndarray = np.zeros(self.length, self.kind)
        rows = self.fields(rhs)
        if self.free:
            rows[0] = np.where(at.active, -at.gap, -at.pressure)
        rows[-2:] = at.ratio * at.law.defect
        missed = at.ratio * at.force_missed
        if self.under_load:
            missed = np.concatenate(([at.load_missed], missed))
        rhs[self.size :] = self.weight * missed
        return rhs

    def response(self, vector: np.ndarray) -> np.ndarray:
        """Return the elastic gap and slip due to the fields in a vector of unknowns."""
        self.applications += 1
        return self._respond(self.fields(vector))

    def product(self, vector: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the matrix times a vector with a known response; the next call overwrites it."""
        step = self.fields(vector)
        self._rows(step, self._extended(response, vector[self.size :]))
        if self.length > self.size:
            self._out[self.size :] = self.weight * self._resultants(step)
        return self._out

    def operator(self, vector: np.ndarray) -> np.ndarray:
        """Return the Newton matrix times a vector; the next call overwrites the result."""
        return self.product(vector, self.response(vector))

    def _approximate_inverse(self, rows: np.ndarray) -> np.ndarray:
        """Return fields that approximately cause these rows: the block preconditioner."""
        at = self.at
        tangential = rows[-2:] if at.ratio == 1.0 else rows[-2:] / at.ratio
        step = self._inverse(tangential)
        self.preconditionings += 1
        if not self.free:
            return step
        normal = np.where(at.active, self.operators.normal_inverse(rows[:1])[0], rows[0])
        return np.concatenate((normal[None], step + self._following * normal))

    @cached_property
    def _border(self) -> tuple[list[np.ndarray], np.ndarray]:
        """Preconditioned columns of approach and creepages, and their Schur complement."""
        count = self.length - self.size
        zero: np.ndarray = np.zeros(self.shape, self.kind)
        responses = [
            self._approximate_inverse(self._rows(zero, self._extended(zero, unit)).copy())
            for unit in np.eye(count)
        ]
        sums = [self._resultants(response) for response in responses]
        return responses, np.array(sums).T.reshape(count, count)

    def preconditioner(self, vector: np.ndarray) -> np.ndarray:
        """Apply the preconditioner: the approximate inverse bordered by load and forces."""
        step = self._approximate_inverse(self.fields(vector))
        if self.length == self.size:
            return step.reshape(-1)
        out: np.ndarray = np.empty(self.length, self.kind)
        responses, schur = self._border
        missed = self._resultants(step) - vector[self.size :] / self.weight
        # Least squares: in full slip the forces do not answer the creepages.
        extra = np.linalg.lstsq(schur, missed, rcond=1e-12)[0]
        for c, response in zip(extra, responses, strict=True):
            step -= c * response
        out[self.size :] = extra
        out[: self.size] = step.ravel()
        return out
