"""Solve the contact problem of a model, in steady rolling, a step or a shift.

The kinematics (`operators.kinematics`) define the problem; the outcome is converted to a contact in
mm, N and MPa. Its message states the meaning of its status, and what to try without a solution.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from tractive_sam.contact.mesh import describe_grid_entries, enlarge
from tractive_sam.contact.model import Model
from tractive_sam.mechanics import Coulomb
from tractive_sam.results import Grid, State, Status
from tractive_sam.scene import FewestElements
from tractive_sam.schema import SeveralSolutionsWarning, warn
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


def message(status: Status, outcome: Outcome, model: Model, steepness: float = 0.0) -> str:
    """Return the message of a solved problem: its failure and the cure, or remarks.

    Parameters
    ----------
    status : Status
        State at the end of the solve.
    outcome : Outcome
        The last iterate and its residual.
    model : Model
        The model that was solved.
    steepness : float
        `solvers.falling_friction.steepness` of the outcome.
    """
    if status is Status.CONVERGED:
        return _remarks(outcome, model)
    if status is Status.OFF_GRID:
        return _at_edge(model)
    return _failure(outcome, model, steepness)


def _remarks(outcome: Outcome, model: Model) -> str:
    """Return remarks on a solution as text: failed methods, no contact, too few elements; or ""."""
    text = ""
    if any(note.status is not Status.CONVERGED for note in outcome.trace):
        text += f", by way of {', '.join(map(str, outcome.trace))}"
    touching = needed(outcome.pressure, "outcome.pressure") > 0.0
    if not touching.any():
        keys = model.scene.schedule.course_keys
        key = keys.get("load.approach", "load.approach")
        text += f"; the bodies do not touch: {key} is less than the gap at every element"
    across = [int(touching.any(axis=1 - axis).sum()) for axis in (0, 1) if touching.shape[axis] > 1]
    if 0 < min(across) < FewestElements.slip:
        text += (
            f"; only {' x '.join(map(str, across))} elements are in contact: refine the mesh "
            "with grid.elements or reduce grid.half_length"
        )
    return text


def _at_edge(model: Model) -> str:
    """Return the message for a contact that reaches the edge of its mesh, with a larger mesh."""
    text = (
        f"the contact reaches the edge of the mesh, {_half_length(model.grid)} mm: enlarge it, "
        f"as by {describe_grid_entries(enlarge(model.grid))}"
    )
    if model.scene.body.infinitely_long and model.measured is not None:
        text += "; with radius_y = inf only a [gap] that rises towards its sides ends it in y"
    return text


def _failure(outcome: Outcome, model: Model, steepness: float) -> str:
    """Return the message for a solve that did not converge, with its probable cause."""
    scene = model.scene
    reached = (
        f"not converged: residual {outcome.residual:.1e} after {outcome.iterations} iterations "
        f"({', '.join(map(str, outcome.trace))}), tolerance {scene.solver.tolerance:.1e}; "
    )
    forces = [f"load.{key}" for key in ("force_x", "force_y") if getattr(scene.load, key)]
    courses = scene.schedule.course_keys.items()
    forces += [key for name, key in courses if name.startswith("load.force")]
    if outcome.top is not None:
        force, creepage = outcome.top
        top = force * model.units.pressure * model.grid.element_area
        return reached + (
            f"{forces[0]} is beyond the top of the traction curve, {top:.5g} {scene.force_unit} at "
            f"a creepage of {creepage * model.units.slip:.3g}: friction falls with sliding, "
            f"and no creepage gives more; lower {forces[0]}, or give the creepage"
        )
    if forces and outcome.status is Status.DIVERGED:
        return reached + (
            "the prescribed tangential force may exceed what friction can carry together with the "
            f"other creepages and the spin: lower {' or '.join(forces)}, or raise friction.mu"
        )
    if steepness >= 1.0:
        reached += f"none was found within {outcome.cost.applications:.0f} applications; "
        return reached + too_steep(steepness, model.scene.transient is not None)
    if not model.friction_law.falls:
        return reached + model.method.cure
    return (
        f"{reached}friction may fall too fast with sliding: increase friction.memory or "
        "friction.half_speed, or coarsen the mesh if there is a friction.layer; otherwise, "
        f"{model.method.cure}"
    )


def not_resolved(contact: State, largest: Sequence[float] | None = None) -> str:
    """Return the message for a contact of too few elements, with a finer mesh.

    Parameters
    ----------
    contact : State
        The contact; of a [transient] its last one.
    largest : sequence of float, optional
        Elements in x and in y of the largest contact of a [transient].
    """
    grid, scene, across = contact.grid, contact.scene, contact.elements_across
    subject = "the contact covers"
    if largest is not None:
        subject = "the largest contact of the [transient] covers"
        across = tuple(map(int, largest[: len(across)]))
    text = (
        f"{subject} {' x '.join(map(str, across))} elements of "
        f"{' x '.join(f'{side:.3g}' for side in grid.sides)} mm, too few to be resolved: its "
        "numbers depend on the mesh; "
        f"at least {FewestElements.contact} elements in each direction are needed, "
        f"{FewestElements.slip} for a stick and a slip area. "
    )
    needed = [math.ceil(FewestElements.slip / count) for count in across]
    refined = (n * more for n, more in zip(grid.elements, (*needed, 1), strict=False))
    nx, ny = refined
    finer = replace(grid, elements=(nx, ny))
    advised = describe_grid_entries(finer)
    smooth = scene.gap is None and largest is None and not contact.wear.any()
    if smooth and scene.hertz is not None:
        semi_axes = (scene.hertz.a, scene.hertz.b)[: len(across)]
        half_length = ", ".join(f"{1.15 * semi_axis:.3g}" for semi_axis in semi_axes)
        advised = f"grid.half_length = [{half_length}], or leave [grid] out"
    return text + f"Use {advised}; check the units of [load] (N, MPa, mm) and of the radii (mm)"


def too_steep(steepness: float, in_step: bool = False) -> str:
    """Return the message for friction that falls too fast with sliding for a single solution.

    Parameters
    ----------
    steepness : float
        `solvers.falling_friction.steepness`.
    in_step : bool
        Whether the contact is a step of a transient.

    The number is a power of ten, so that the contacts of a process have equal texts, and one
    warning.
    """
    power = 10 ** math.floor(math.log10(max(steepness, 1.0)))
    by = f" (more than {power} times)" if power > 1 else ""
    if in_step:
        return (
            "friction.law: with sliding, friction falls faster than the elastic traction of all "
            f"elements together rises{by}, so a step may have several solutions; friction.start "
            'selects the solution with less sliding, "rest", or with more sliding, "sliding", in '
            "every step, and the course may lead to another solution than steady rolling with the "
            "same values; for a single solution increase transient.step, friction.memory or "
            "friction.half_speed"
        )
    return (
        "friction.law: with sliding, friction falls faster than the elastic traction of an element "
        f"rises{by}, so several solutions may exist, and the mesh decides which one is found; "
        'friction.start selects the solution reached from friction at rest, "rest", or at high '
        'speed, "sliding"; for a single solution increase friction.memory or friction.half_speed, '
        "or coarsen the mesh if there is a friction.layer"
    )


def _half_length(grid: Grid) -> str:
    """Return the half lengths of a mesh as text, "1 x 0.5"."""
    sides = zip(grid.half_length, grid.elements, strict=True)
    return " x ".join(f"{length:g}" for length, elements in sides if elements > 1)


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
        Returns text on the solution for the other `friction.start`, for a second warning if several
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
        warn(too_steep(steepness, problem.kinematics.joint), SeveralSolutionsWarning)
        if describe_other is not None and (other := describe_other()):
            warn(other, SeveralSolutionsWarning)
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
