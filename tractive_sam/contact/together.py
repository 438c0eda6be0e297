"""Pressure and tractions at once: dissimilar bodies, and the paper's own scheme."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tractive_sam.contact.guess import Guess
from tractive_sam.contact.in_sequence import slip_by_pressure, solve_normal, solve_tangential
from tractive_sam.contact.model import Model
from tractive_sam.solvers.anderson import anderson
from tractive_sam.solvers.continuation import continued
from tractive_sam.solvers.coupled_newton import coupled_newton
from tractive_sam.solvers.fixed_point import ANDERSON_STEP, UZAWA_STEP, CoupledMap
from tractive_sam.solvers.load_control import under_load
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

    By the method of the scene; "auto" is Newton's, then continued, then Anderson's.
    """
    solver = model.scene.solver
    earlier = None
    if first is None:
        first, earlier = _one_after_the_other(model, gap)
    if solver.method == "anderson":
        outcome = projected(model, gap, first)
    else:
        problem = _problem(model, gap)
        outcome = _newton_from(problem, solver.tolerance, first)
        outcome = replace(outcome, trace=(f"coupled newton: {outcome.status}",))
        if not outcome.converged and solver.method == "auto":
            outcome = continued(problem, solver.tolerance, _newton_from, first).after(outcome)
            if not (outcome.converged or len(model.transmission)):
                outcome = projected(model, gap, first).after(outcome)
    return outcome if earlier is None else outcome.after(earlier)


def _newton_from(problem: CoupledProblem, tolerance: float, first: Guess | Outcome) -> Outcome:
    creepage = first.creepage if len(problem.transmission) else None
    return coupled_newton(
        problem, tolerance, first.pressure, first.traction, first.approach, creepage
    )


def _one_after_the_other(model: Model, gap: np.ndarray) -> tuple[Guess, Outcome]:
    normal = solve_normal(model, gap, None, _ROUGHLY)
    rigid = model.scaled_rigid_slip + slip_by_pressure(model, normal.pressure)
    tangential = solve_tangential(model, normal.pressure, normal.gap, rigid, None, _ROUGHLY)
    earlier, creepage = tangential.after(normal), tangential.creepage
    if not tangential.converged and len(model.transmission):
        # The slip by the uncoupled pressure can be more than the forces can be had with: then the
        # creepages are left to the coupled method.
        tangential = solve_tangential(
            model,
            normal.pressure,
            normal.gap,
            rigid,
            None,
            _ROUGHLY,
            transmission=Transmission(),
        )
        earlier, creepage = tangential.after(earlier), np.zeros(len(model.transmission))
    return Guess(normal.pressure, tangential.traction, normal.approach, creepage), earlier


def projected(
    model: Model,
    gap: np.ndarray,
    first: Guess | None,
    wear: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None,
) -> Outcome:
    """Uzawa's or Anderson's method on pressure and tractions at once (paper, section 7.5).

    Parameters
    ----------
    model : Model
        The scene in numbers.
    gap : ndarray, shape (n_x, n_y)
        Undeformed separation, dimensionless.
    first : Guess, optional
        Where to start; the normal problem solved roughly by default.
    wear : callable, optional
        Dimensionless wear of a pass, from dimensionless pressure and slip, added to the gap.
    """
    solver = model.scene.solver
    if first is None:
        normal = solve_normal(model, gap, None, _ROUGHLY)
        none = np.zeros((2, *gap.shape))
        first = Guess(normal.pressure, none, normal.approach, np.zeros(0))
    by_uzawa = solver.method == "uzawa"
    method, step = (uzawa, UZAWA_STEP) if by_uzawa else (anderson, ANDERSON_STEP)
    mapping = CoupledMap(_problem(model, gap), first.pressure > 0.0, wear, step)
    if model.load is None:
        outcome = method(mapping, solver.tolerance, first.state)
        outcome = replace(outcome, approach=model.given_approach)
    else:
        outcome = under_load(method, mapping, solver.tolerance, first.state, first.approach)
    return replace(outcome, trace=(f"{method.__name__}: {outcome.status}",))
