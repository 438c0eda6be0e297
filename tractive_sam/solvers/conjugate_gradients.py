"""Preconditioned conjugate gradients for the normal problem.

The projected method of Polonsky & Keer (1999), Wear 231, 206-219, with the circulant inverse of the
operator as preconditioner: on a contact area that no longer changes it converges in about ten
iterations on any mesh.
"""

import numpy as np

from tractive_sam.results.status import Cost, Status
from tractive_sam.solvers.outcome import Outcome
from tractive_sam.solvers.problem import NormalProblem

ITERATIONS = 500


def conjugate_gradients(
    problem: NormalProblem,
    tolerance: float,
    pressure: np.ndarray | None = None,
    iterations: int = ITERATIONS,
) -> Outcome:
    """Solve the normal problem under given load or approach.

    Parameters
    ----------
    problem : NormalProblem
        The problem.
    tolerance : float
        Natural residual, relative, at which to stop.
    pressure : ndarray, shape (n_x, n_y), optional
        First guess; where it is zero no contact is assumed at first.
    iterations : int
        Most iterations.
    """
    normal, inverse = problem.half_space.normal, problem.half_space.normal_inverse
    before = normal.applications, inverse.applications
    apply = lambda field: normal(field[None])[0]  # noqa: E731
    precondition = lambda field: inverse(field[None])[0]  # noqa: E731

    p = _first_guess(problem) if pressure is None else np.maximum(pressure, 0.0)
    p = _loaded(problem, p)
    lift = apply(p)
    response = active = direction = gap_before = None
    product_before = 0.0
    status = Status.OUT_OF_ITERATIONS
    taken = 0
    for taken in range(iterations + 1):
        gap = problem.gap + lift
        contact = p > 0.0
        delta = problem.approach if problem.load is None else _mean(gap, contact)
        gap = gap - delta
        residual = natural_residual(p, gap)
        if residual <= tolerance:
            status = Status.CONVERGED
            break
        if taken == iterations:
            break
        was, active = active, contact | (gap < 0.0)
        unchanged = was is not None and np.array_equal(was, active)
        step = np.where(active, precondition(np.where(active, gap, 0.0)), 0.0)
        if problem.load is not None:
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
            if problem.load is not None and not unchanged:
                direction -= response * (direction.sum() / response.sum())
        change = apply(direction)
        length = np.vdot(gap, direction) / np.vdot(direction, change)
        p = p - length * direction
        if p.min() < 0.0:
            p = _loaded(problem, np.maximum(p, 0.0))
            lift = apply(p)
        else:
            lift = lift - length * change
        product_before, gap_before = product, gap
    cost = Cost(normal.applications - before[0], inverse.applications - before[1])
    return Outcome(status, float(residual), taken, cost, pressure=p, gap=gap, approach=float(delta))


def natural_residual(pressure: np.ndarray, gap: np.ndarray) -> float:
    """|p - max(0, p - gap)| / |p|: zero exactly where Signorini's conditions hold."""
    size = np.linalg.norm(pressure)
    distance = np.linalg.norm(np.minimum(pressure, gap))
    return distance / size if size > 0.0 else float(distance > 0.0)


def _mean(values: np.ndarray, where: np.ndarray) -> float:
    return float(values[where].mean())


def _loaded(problem: NormalProblem, pressure: np.ndarray) -> np.ndarray:
    """The pressure scaled to the load, where that is given."""
    if problem.load is None:
        return pressure
    if not pressure.any():  # a contact so small that interpolation or a step has lost it
        pressure = np.where(problem.gap == problem.gap.min(), 1.0, 0.0)
    return pressure * (problem.load / pressure.sum())


def _first_guess(problem: NormalProblem) -> np.ndarray:
    """Pressure like the depth of the undeformed bodies below a level that gives some contact."""
    level = problem.approach
    if problem.load is not None:
        level = np.quantile(problem.gap, 0.5)
    return np.maximum(level - problem.gap, 0.0)
