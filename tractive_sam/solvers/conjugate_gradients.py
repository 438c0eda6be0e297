"""Preconditioned conjugate gradients for the normal problem.

The projected method of Polonsky & Keer (1999), Wear 231, 206-219, with the circulant inverse of the
operator as preconditioner: on a contact area that no longer changes it converges in about ten
iterations on any mesh.
"""

from dataclasses import dataclass

import numpy as np

from tractive_sam.results import Cost, Status
from tractive_sam.solvers.outcome import Note, Outcome, Start, closed
from tractive_sam.solvers.problem import NormalProblem


@dataclass(frozen=True)
class ConjugateGradients:
    """Conjugate gradients for the normal problem without tractions, for a load or an approach.

    Attributes
    ----------
    iterations : int
        Most iterations.
    """

    iterations: int = 500

    def solve(
        self, problem: NormalProblem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve the normal problem.

        Parameters
        ----------
        problem : NormalProblem
            The problem.
        tolerance : float
            Natural residual, relative, at which to stop.
        start : Start or Outcome, optional
            First guess; where its pressure is zero no contact is assumed at first.
        """
        applications = preconditionings = 0

        def apply(field: np.ndarray) -> np.ndarray:
            nonlocal applications
            applications += 1
            return problem.operators.normal(field[None])[0]

        def precondition(field: np.ndarray) -> np.ndarray:
            nonlocal preconditionings
            preconditionings += 1
            return problem.operators.normal_inverse(field[None])[0]

        under_load = problem.load is not None
        p = _first_guess(problem) if start is None else np.maximum(start.pressure, 0.0)
        p = _scale_to_load(problem, p)
        lift = apply(p)
        response = active = direction = gap_before = product_before = None
        status = Status.OUT_OF_ITERATIONS
        for taken in range(self.iterations + 1):
            gap = problem.gap + lift
            contact = p > 0.0
            # Under a load the approach is the one that the elements in contact have on average.
            delta = _mean(gap, contact) if under_load else problem.approach
            gap = gap - delta
            residual = natural_residual(p, gap)
            if residual <= tolerance:
                status = Status.CONVERGED
                break
            if taken == self.iterations:
                break
            was, active = active, contact | (gap < 0.0)
            unchanged = was is not None and np.array_equal(was, active)
            # The gap of the elements in contact, and of those that overlap, is the gradient.
            step = np.where(active, precondition(np.where(active, gap, 0.0)), 0.0)
            if under_load:
                # The part of the step that would change the load belongs to the approach.
                if not unchanged:
                    response = np.where(active, precondition(active.astype(float)), 0.0)
                step -= response * (step.sum() / response.sum())
            product = np.vdot(gap, step)
            if direction is None:
                direction = step
            else:
                # Polak-Ribiere: forgets directions of a contact area that has changed.
                beta = max(0.0, (product - np.vdot(gap_before, step)) / product_before)
                direction = step + beta * np.where(active, direction, 0.0)
                if under_load and not unchanged:
                    # Those of the former area must not change the load on this one.
                    direction -= response * (direction.sum() / response.sum())
            change = apply(direction)
            # Positive for any direction, but for gaps so wide that rounding leaves nothing of it.
            if not (curvature := np.vdot(direction, change)) > 0.0:
                break
            # To the least energy along the direction.
            length = np.vdot(gap, direction) / curvature
            p = p - length * direction
            if p.min() < 0.0:
                # Elements that would pull leave; then what was summed up no longer is the lift.
                p = _scale_to_load(problem, np.maximum(p, 0.0))
                lift = apply(p)
            else:
                lift = lift - length * change
            product_before, gap_before = product, gap
        return Outcome(
            status,
            float(residual),
            taken,
            Cost(applications, preconditionings),
            pressure=_scale_to_load(problem, closed(p, gap)),
            gap=gap,
            approach=float(delta),
            trace=(Note("conjugate gradients", status),),
        )


def natural_residual(pressure: np.ndarray, gap: np.ndarray) -> float:
    """Return |p - max(0, p - gap)| / |p|, zero exactly if Signorini's conditions hold."""
    size = np.linalg.norm(pressure)
    distance = np.linalg.norm(np.minimum(pressure, gap))
    return distance / size if size > 0.0 else float(distance > 0.0)


def _mean(values: np.ndarray, where: np.ndarray) -> float:
    """Return the mean of values over a mask."""
    return float(values[where].mean())


def _scale_to_load(problem: NormalProblem, pressure: np.ndarray) -> np.ndarray:
    """Return the pressure scaled to the prescribed load, if there is one."""
    if problem.load is None:
        return pressure
    if not pressure.any():  # a contact so small that interpolation or a step has lost it
        pressure = np.where(problem.gap == problem.gap.min(), 1.0, 0.0)
    return pressure * (problem.load / pressure.sum())


def _first_guess(problem: NormalProblem) -> np.ndarray:
    """Return the initial pressure: the depth of the undeformed bodies below some level."""
    level = problem.approach
    if problem.load is not None:
        level = np.quantile(problem.gap, 0.5)
    return np.maximum(level - problem.gap, 0.0)
