"""Preconditioned conjugate gradients for the normal problem.

The projected method of Polonsky & Keer (1999), Wear 231, 206-219, with the circulant inverse of the
operator as preconditioner: on a contact area that no longer changes it converges in about ten
iterations on any mesh.
"""

from dataclasses import dataclass
from math import sqrt
from typing import NamedTuple

import numpy as np

from tractive_sam.compute import backend_of
from tractive_sam.results import Cost, Status
from tractive_sam.solvers.outcome import Note, Outcome, Start, closed, needed
from tractive_sam.solvers.problem import NormalProblem


@dataclass(frozen=True)
class ConjugateGradients:
    """Conjugate gradient solver for the normal problem without tractions, for load or approach.

    Attributes
    ----------
    iterations : int
        Most iterations.
    """

    iterations: int = 500

    def solve(
        self, problem: NormalProblem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve the normal problem to a tolerance, and return the outcome.

        Parameters
        ----------
        problem : NormalProblem
            The problem.
        tolerance : float
            Natural residual, relative, at which to stop.
        start : Start or Outcome, optional
            Initial guess; elements with zero pressure are assumed out of contact at first.
        """
        pressure = _first_guess(problem)
        if start is not None:
            pressure = needed(start.pressure, "start.pressure")
            pressure = backend_of(pressure).xp.maximum(pressure, 0.0)
        at, status = _Iteration(problem, pressure), Status.OUT_OF_ITERATIONS
        for taken in range(self.iterations + 1):
            residual = natural_residual(at.pressure, at.gap)
            if residual <= tolerance:
                status = Status.CONVERGED
                break
            if taken == self.iterations or not at.advance():
                break
        return Outcome(
            status,
            residual,
            taken,
            Cost(at.applications, at.preconditionings),
            pressure=_scale_to_load(problem, closed(at.pressure, at.gap)),
            gap=at.gap,
            approach=at.approach,
            trace=(Note("conjugate gradients", status),),
        )


class _Iteration:
    """State of the conjugate gradients: pressure, displacement, gap, approach, last direction.

    Attributes
    ----------
    applications, preconditionings : int
        Work done.
    """

    def __init__(self, problem: NormalProblem, pressure: np.ndarray):
        self.problem, self.under_load = problem, problem.load is not None
        self.applications = self.preconditionings = 0
        self.backend = backend_of(pressure)
        self._active = pressure < 0.0  # none yet
        self._response = pressure
        self._last: _Search | None = None
        self._set_pressure(pressure)

    def _set_pressure(self, pressure: np.ndarray) -> None:
        """Set the pressure, scaled to the load, and compute displacement and gap."""
        self.pressure = _scale_to_load(self.problem, pressure)
        self._set_lift(self._apply(self.pressure))

    def _set_lift(self, lift: np.ndarray) -> None:
        """Set the displacement by the pressure, and compute the approach and the gap."""
        self._lift, self.approach = lift, self.problem.approach
        gap = self.problem.gap + lift
        if self.under_load:
            # The approach is the one that the elements in contact have on average.
            self.approach = float(self.backend.xp.mean(gap[self.pressure > 0.0]))
        self.gap = gap - self.approach

    def advance(self) -> bool:
        """Minimise the energy along a new direction; return False if that has no minimum."""
        xp, dot = self.backend.xp, self.backend.dot
        active = (self.pressure > 0.0) | (self.gap < 0.0)
        unchanged = bool(xp.all(active == self._active))
        self._active = active
        if self.under_load and not unchanged:
            self._response = self._precondition(xp.ones_like(self.gap))
        # The gap of the elements in contact, and of those that overlap, is the gradient.
        step = self._precondition(self.gap)
        if self.under_load:
            step = self._without_load(step)
        direction, product = step, dot(self.gap, step)
        if (last := self._last) is not None:
            # Polak-Ribiere: forgets directions of a contact area that has changed.
            beta = max(0.0, (product - dot(last.gap, step)) / last.product)
            direction = step + beta * xp.where(active, last.direction, 0.0)
            if self.under_load and not unchanged:
                # Elements of the former area must not change the load on this one.
                direction = self._without_load(direction)
        self._last = _Search(direction, self.gap, product)
        return self._minimise_along(direction)

    def _minimise_along(self, direction: np.ndarray) -> bool:
        """Minimise along a direction, without tension; return False if that has no curvature."""
        xp, dot, change = self.backend.xp, self.backend.dot, self._apply(direction)
        # Positive for any direction, but for gaps so wide that rounding leaves nothing of it.
        if not (curvature := dot(direction, change)) > 0.0:
            return False
        length = dot(self.gap, direction) / curvature
        self.pressure = self.pressure - length * direction
        if xp.min(self.pressure) < 0.0:
            # Elements that would pull leave; then what was summed up no longer is the lift.
            self._set_pressure(xp.maximum(self.pressure, 0.0))
        else:
            self._set_lift(self._lift - length * change)
        return True

    def _apply(self, field: np.ndarray) -> np.ndarray:
        """Return the normal displacement by a pressure, and count the application."""
        self.applications += 1
        return self.problem.operators.normal(field[None, ...])[0, ...]

    def _precondition(self, gap: np.ndarray) -> np.ndarray:
        """Return the approximate pressure of the active elements that causes a gap."""
        self.preconditionings += 1
        where, inverse = self.backend.xp.where, self.problem.operators.normal_inverse
        gap = where(self._active, gap, 0.0)
        return where(self._active, inverse(gap[None, ...])[0, ...], 0.0)

    def _without_load(self, step: np.ndarray) -> np.ndarray:
        """Return a step of the pressure without the part that changes the load."""
        total = self.backend.xp.sum
        return step - self._response * (total(step) / total(self._response))


class _Search(NamedTuple):
    """Last search direction, with the gap there and the product of gap and step."""

    direction: np.ndarray
    gap: np.ndarray
    product: float


def natural_residual(pressure: np.ndarray, gap: np.ndarray) -> float:
    """Return |p - max(0, p - gap)| / |p|, zero exactly if Signorini's conditions hold."""
    backend = backend_of(pressure)
    missed = backend.xp.minimum(pressure, gap)
    size, distance = sqrt(backend.dot(pressure, pressure)), sqrt(backend.dot(missed, missed))
    return distance / size if size > 0.0 else float(distance > 0.0)


def _scale_to_load(problem: NormalProblem, pressure: np.ndarray) -> np.ndarray:
    """Return the pressure scaled to the prescribed load, if there is one."""
    if problem.load is None:
        return pressure
    xp, gap = backend_of(pressure).xp, problem.gap
    if not xp.any(pressure > 0.0):  # so small a contact that interpolation or a step has lost it
        pressure = xp.where(gap == xp.min(gap), xp.ones_like(gap), 0.0)
    return pressure * (problem.load / xp.sum(pressure))


def _first_guess(problem: NormalProblem) -> np.ndarray:
    """Return an initial pressure: the depth to which the undeformed bodies overlap."""
    level, backend = problem.approach, backend_of(problem.gap)
    if problem.load is not None:
        level = float(np.median(backend.to_numpy(problem.gap)))
    return backend.xp.maximum(level - problem.gap, 0.0)
