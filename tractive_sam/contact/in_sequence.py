"""First the normal problem, then the tangential one: all that bodies of equal material need."""

from dataclasses import replace

import numpy as np

from tractive_sam.contact.guess import Guess
from tractive_sam.contact.model import Model
from tractive_sam.results.status import Cost, Status
from tractive_sam.solvers.anderson import anderson
from tractive_sam.solvers.bracketing import led
from tractive_sam.solvers.conjugate_gradients import conjugate_gradients
from tractive_sam.solvers.fixed_point import ANDERSON_STEP, TangentialMap
from tractive_sam.solvers.nested import nested_normal, nested_tangential
from tractive_sam.solvers.newton import newton
from tractive_sam.solvers.outcome import Outcome
from tractive_sam.solvers.problem import NormalProblem, TangentialProblem


def solve_normal(model: Model, gap: np.ndarray, first: Guess | None, tolerance: float) -> Outcome:
    """The normal problem without the lift by tractions."""
    problem = NormalProblem(model.half_space, gap, model.load, model.given_approach)
    if first is None or not first.pressure.any():
        return nested_normal(problem, tolerance, conjugate_gradients)
    return conjugate_gradients(problem, tolerance, first.pressure)


def solve_tangential(
    model: Model,
    pressure: np.ndarray,
    gap: np.ndarray,
    rigid: np.ndarray,
    first: Guess | None,
    tolerance: float,
) -> Outcome:
    """The tangential problem under a given pressure, on the rectangle around the contact."""
    box = _rectangle(pressure > 0.0)
    problem = TangentialProblem(
        model.half_space_of(pressure[box].shape),
        rigid[:, *box],
        pressure[box],
        gap[box],
        model.transmission,
    )
    needed = problem.transmission.least / problem.bound.sum()
    if needed > 1.0:
        return _beyond(pressure.shape, len(problem.transmission), needed)
    begin = None if first is None else first.traction[:, *box]
    outcome = _by_method(model, problem, begin, first, tolerance)
    return replace(
        outcome,
        traction=_placed(outcome.traction, box, pressure.shape),
        slip=_placed(outcome.slip, box, pressure.shape),
    )


def _beyond(shape: tuple[int, int], forces: int, needed: float) -> Outcome:
    """What comes of forces that are more than friction can carry, however fast the bodies creep."""
    none = np.zeros((2, *shape))
    told = f"the forces take {needed:.1%} of what friction can carry"
    return Outcome(
        Status.DIVERGED,
        1.0,
        0,
        Cost(),
        traction=none,
        slip=none,
        creepage=np.zeros(forces),
        trace=(told,),
    )


def _by_method(model, problem, begin, first, tolerance) -> Outcome:
    """The method of the scene; "auto" is Newton's, then by easier problems, then Anderson's."""
    method = model.scene.solver.method
    if method == "anderson":
        return _anderson(problem, tolerance, begin)
    if begin is None:
        outcome = nested_tangential(problem, tolerance, newton)
    else:
        outcome = newton(problem, tolerance, begin, first.creepage)
    outcome = replace(outcome, trace=(*outcome.trace, f"newton: {outcome.status}"))
    if outcome.converged or method == "newton":
        return outcome
    outcome = led(problem, tolerance, _newton_from, None).after(outcome)
    if outcome.converged or len(problem.transmission):
        return outcome
    return _anderson(problem, tolerance, outcome.traction).after(outcome)


def _newton_from(problem: TangentialProblem, tolerance: float, first: Outcome | None) -> Outcome:
    if first is None:
        return newton(problem, tolerance)
    return newton(problem, tolerance, first.traction, first.creepage)


def _anderson(problem: TangentialProblem, tolerance: float, begin: np.ndarray | None) -> Outcome:
    if begin is None or not np.isfinite(begin).all():
        begin = np.zeros_like(problem.rigid)
    outcome = anderson(TangentialMap(problem, ANDERSON_STEP), tolerance, begin)
    return replace(outcome, trace=(f"anderson: {outcome.status}",))


def in_sequence(model: Model, gap: np.ndarray, first: Guess | None) -> Outcome:
    """Solve the normal problem and then, where there is cause for traction, the tangential one."""
    tolerance = model.scene.solver.tolerance
    normal = solve_normal(model, gap, first, tolerance)
    normal = replace(normal, trace=(f"conjugate gradients: {normal.status}",))
    pressure = normal.pressure
    if not (normal.converged and model.transmits and pressure.any()):
        slip = model.scaled_rigid_slip
        if model.dissimilar:
            slip = slip + model.half_space.slip_by_pressure(pressure)
        return replace(normal, traction=np.zeros_like(slip), slip=slip)
    tangential = solve_tangential(
        model, pressure, normal.gap, model.scaled_rigid_slip, first, tolerance
    )
    return replace(
        tangential.after(normal),
        pressure=pressure,
        gap=normal.gap,
        approach=normal.approach,
        residual=max(normal.residual, tangential.residual),
    )


def _rectangle(contact: np.ndarray) -> tuple[slice, slice]:
    """The contact and a row on both sides.

    The slip at the centre of an element needs that of the row behind it, the slip of a leading
    element the gap ahead.
    """
    i = np.flatnonzero(contact.any(axis=1))
    j = np.flatnonzero(contact.any(axis=0))
    nx, ny = contact.shape
    return _rounded(max(i[0] - 1, 0), min(i[-1] + 2, nx), nx), _rounded(j[0], j[-1] + 1, ny)


def _rounded(first: int, end: int, most: int) -> slice:
    """At least these elements, a whole number of steps where there are that many.

    Contacts that grow element by element then share their operators and plans, at the price of at
    most a sixteenth more elements, or three.
    """
    step = max(4, 2 ** int(np.log2((end - first) / 16 + 1)))
    length = min(-(-(end - first) // step) * step, most)
    first = min(first, most - length)
    return slice(first, first + length)


def _placed(field: np.ndarray, box: tuple[slice, slice], shape: tuple[int, int]) -> np.ndarray:
    """A field on the rectangle as a field on the mesh, zero around it."""
    whole = np.zeros((2, *shape))
    whole[:, *box] = field
    return whole
