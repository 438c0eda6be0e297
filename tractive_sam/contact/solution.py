"""Solve the contact problem of a model, in steady rolling, a step or a shift.

The kinematics (`operators.kinematics`) define the problem; the outcome is converted to a contact in
mm, N and MPa.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tractive_sam.contact.message import message, too_steep
from tractive_sam.contact.model import Model
from tractive_sam.mechanics import Coulomb
from tractive_sam.results import State, Status
from tractive_sam.schema import warn
from tractive_sam.solvers import (
    PRESSURE_ONLY,
    OnHalfMesh,
    Outcome,
    Problem,
    ProblemSolver,
    Start,
    falling_method,
    needed,
)
from tractive_sam.solvers import steepness as steepness_of


def solve_problem(
    model: Model,
    problem: Problem,
    tolerance: float,
    start: Start | None = None,
    sliding: bool | None = None,
) -> Outcome:
    """Solve a dimensionless problem of a model, with the method of its friction and materials.

    Parameters
    ----------
    model : Model
        The scene in numbers: its method, and the start of a falling friction law.
    problem : Problem
        The problem, with its pressure free.
    tolerance : float
        Residual of the solution.
    start : Start, optional
        Initial guess.
    sliding : bool, optional
        Whether the solution reached from high sliding speed is sought if friction falls; by default
        `friction.start` of the scene.
    """
    normal, coupled = problem.free_pressure, model.elasticity.coupled
    if normal.load is None and normal.gap.min() >= normal.approach:
        return PRESSURE_ONLY.solve(problem, tolerance)  # the bodies do not touch
    if coupled and start is not None and not needed(start.pressure, "start.pressure").any():
        start = None  # Newton's method needs a contact area to start
    return OnHalfMesh(_solver_of(model, problem, sliding)).solve(problem, tolerance, start)


def _solver_of(model: Model, problem: Problem, sliding: bool | None) -> ProblemSolver:
    """Return the solver for a problem whose bodies touch, by its friction and materials."""
    if model.laws.friction is None or not problem.has_tangential_cause:
        return PRESSURE_ONLY
    solver = model.method.dissimilar if model.elasticity.coupled else model.method.alike
    if not problem.friction.law.falls:
        return solver
    return falling_method(solver, model.starts_sliding if sliding is None else sliding)


def traction_of(model: Model, scaled: np.ndarray) -> np.ndarray:
    """Return the traction p_t, MPa, of a scaled, dimensionless traction."""
    return model.units.pressure * model.frame.to_physical(scaled)


def _traction_bound(model: Model, pressure: np.ndarray, radius: np.ndarray) -> np.ndarray | None:
    """Return the scaled traction bound, MPa; None if it is the pressure (Coulomb friction)."""
    is_coulomb = type(model.friction_law) is Coulomb
    if is_coulomb and (np.abs(radius - pressure) <= 1e-12 * pressure).all():  # up to rounding
        return None
    return model.units.pressure * radius


def state_of(
    model: Model,
    problem: Problem,
    outcome: Outcome,
    slip: np.ndarray,
    creepages: tuple[float, float, float],
    depth: np.ndarray,
    resistance: float = 0.0,
    describe_other: Callable[[], str] | None = None,
) -> State:
    """Return the contact, in mm, N and MPa, of the outcome of a dimensionless problem.

    Parameters
    ----------
    model : Model
        The model, with its mesh.
    problem : Problem
        The solved problem.
    outcome : Outcome
        The outcome of its solution, converged or not.
    slip : ndarray, shape (2, n_x, n_y)
        Slip to report, s/V.
    creepages : tuple of float
        Longitudinal and lateral creepage and spin.
    depth : ndarray, shape (n_x, n_y)
        Depth worn off both bodies, mm.
    resistance : float
        Rolling resistance, N.
    describe_other : callable, optional
        Returns text on the solution for the other `friction.start`, for the warning that several
        solutions may exist.
    """
    units, fields = model.units, outcome.fields
    sliding, bound, steepness = _friction_state(model, problem, outcome)
    contact = State(
        model.scene,
        model.grid,
        units.pressure * fields.pressure,
        traction_of(model, fields.traction),
        np.where(fields.pressure > 0.0, slip, 0.0),
        units.gap * fields.gap,
        depth,
        units.gap * needed(outcome.approach, "outcome.approach"),
        *creepages,
        resistance,
        sliding,
        outcome.status,
        message(outcome.status, outcome, model, steepness),
        outcome.residual,
        outcome.cost,
        tuple(map(str, outcome.trace)),
        frame=None if model.laws.friction is None else model.frame,
        traction_bound=bound,
        laws=model.laws,
    )
    if contact.converged and steepness >= 1.0:
        other = "" if describe_other is None else describe_other()
        warn(too_steep(steepness, problem.kinematics.joint) + other)
    if contact.converged and any(contact.at_edge):
        status = Status.OFF_GRID
        contact = replace(contact, status=status, note=message(status, outcome, model))
    return contact


def _friction_state(
    model: Model, problem: Problem, outcome: Outcome
) -> tuple[np.ndarray, np.ndarray | None, float]:
    """Return the mask of sliding elements, the traction bound, MPa, and how steeply friction falls.

    The bound is None if it is the pressure, the steepness 0 unless friction falls with sliding.
    """
    fields = outcome.fields
    if model.laws.friction is None:
        return fields.pressure > 0.0, None, 0.0
    sliding, radius = outcome.sliding, outcome.radius
    if sliding is None or radius is None:
        sliding, allowed = problem.sliding(*fields)
        radius = allowed.radius
    bound = _traction_bound(model, fields.pressure, radius)
    if not model.friction_law.falls:
        return sliding, bound, 0.0
    steepness = outcome.steepness
    return sliding, bound, steepness_of(problem, *fields) if steepness is None else steepness
