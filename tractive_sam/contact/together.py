"""Pressure and tractions at once: dissimilar bodies, and the paper's own scheme."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tractive_sam.contact.guess import Guess
from tractive_sam.contact.model import Model
from tractive_sam.solvers.anderson import anderson
from tractive_sam.solvers.bracketing import led
from tractive_sam.solvers.conjugate_gradients import conjugate_gradients
from tractive_sam.solvers.coupled_newton import coupled_newton
from tractive_sam.solvers.fixed_point import ANDERSON_STEP, UZAWA_STEP, CoupledMap
from tractive_sam.solvers.load_control import under_load
from tractive_sam.solvers.nested import nested_coupled, nested_normal, nested_tangential
from tractive_sam.solvers.newton import newton
from tractive_sam.solvers.outcome import Outcome
from tractive_sam.solvers.problem import CoupledProblem, Transmission
from tractive_sam.solvers.uzawa import uzawa

_ROUGHLY = 1e-3
"""Residual of the problems solved one after the other, from which the coupled method starts."""


def _problem(model: Model, gap: np.ndarray) -> CoupledProblem:
    return CoupledProblem(
        model.half_space,
        gap,
        model.scaled_rigid_slip,
        model.load,
        model.given_approach,
        model.transmission,
    )


def together(model: Model, gap: np.ndarray, first: Guess | None) -> Outcome:
    """The coupled problem of dissimilar bodies.

    By the method of the scene; "auto" is Newton's, then by easier problems, then Anderson's.
    """
    method, tolerance = model.scene.solver.method, model.scene.solver.tolerance
    problem = _problem(model, gap)
    if method == "anderson":
        return projected(model, gap, first)
    if first is None:
        outcome = nested_coupled(problem, tolerance, _newton_from, _one_after_the_other)
    else:
        outcome = _newton_from(problem, tolerance, first)
    outcome = replace(outcome, trace=(f"coupled newton: {outcome.status}",))
    if outcome.converged or method == "newton":
        return outcome
    if first is None:
        first = _one_after_the_other(problem)
        outcome = outcome.after(replace(first, trace=()))
    outcome = led(problem, tolerance, _newton_from, first).after(outcome)
    if outcome.converged or len(problem.transmission):
        return outcome
    return projected(model, gap, first).after(outcome)


def _newton_from(problem: CoupledProblem, tolerance: float, first: Guess | Outcome) -> Outcome:
    creepage = first.creepage if len(problem.transmission) else None
    return coupled_newton(
        problem, tolerance, first.pressure, first.traction, first.approach, creepage
    )


def _one_after_the_other(problem: CoupledProblem) -> Outcome:
    """The normal problem, and the tangential one under its pressure, roughly."""
    normal = nested_normal(problem.normal, _ROUGHLY, conjugate_gradients)
    alone = problem.tangential(normal.pressure, normal.gap)
    tangential = nested_tangential(alone, _ROUGHLY, newton)
    outcome = tangential.after(normal)
    if not tangential.converged and len(problem.transmission):
        # The slip by the uncoupled pressure can be more than the forces can be had with: then the
        # creepages are left to the coupled method.
        given = nested_tangential(replace(alone, transmission=Transmission()), _ROUGHLY, newton)
        outcome = replace(given.after(outcome), creepage=np.zeros(len(problem.transmission)))
    return replace(outcome, pressure=normal.pressure, gap=normal.gap, approach=normal.approach)


def projected(
    model: Model,
    gap: np.ndarray,
    first: Guess | Outcome | None,
    wear: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray] | None = None,
) -> Outcome:
    """Uzawa's or Anderson's method on pressure and tractions at once (paper, section 7.5).

    Parameters
    ----------
    model : Model
        The scene in numbers.
    gap : ndarray, shape (n_x, n_y)
        Undeformed separation, dimensionless.
    first : Guess or Outcome, optional
        Where to start; the normal problem solved roughly by default.
    wear : callable, optional
        Dimensionless wear of a pass, from dimensionless pressure, traction and slip, added to
        the gap.
    """
    solver, problem = model.scene.solver, _problem(model, gap)
    if first is None:
        normal = nested_normal(problem.normal, _ROUGHLY, conjugate_gradients)
        first = replace(normal, traction=np.zeros_like(problem.rigid))
    by_uzawa = solver.method == "uzawa"
    method, step = (uzawa, UZAWA_STEP) if by_uzawa else (anderson, ANDERSON_STEP)
    mapping = CoupledMap(problem, first.pressure > 0.0, wear, step)
    state = np.concatenate((first.pressure[None], first.traction))
    if model.load is None:
        outcome = method(mapping, solver.tolerance, state)
        outcome = replace(outcome, approach=model.given_approach)
    else:
        outcome = under_load(method, mapping, solver.tolerance, state, first.approach)
    return replace(outcome, trace=(f"{method.__name__}: {outcome.status}",))
