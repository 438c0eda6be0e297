"""Solve one steady state of a model, in mm, N and MPa."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from tractive_sam.compute import ConvolutionMeter
from tractive_sam.contact.heat import solve_with_heat
from tractive_sam.contact.mesh import enlarge
from tractive_sam.contact.message import not_resolved
from tractive_sam.contact.model import Model
from tractive_sam.contact.solution import solve_problem, state_of, traction_of
from tractive_sam.contact.wheel_rail import GROWTHS, enlarge_for, find_pitch, share_load
from tractive_sam.results import State, Status
from tractive_sam.scene import FewestElements
from tractive_sam.solvers import Outcome, Problem, Start

DepthInPass = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""Function (p_n and p_t in MPa, s/V) -> depth of wear in mm below every element."""


def equilibrium(
    model: Model,
    depth: np.ndarray | DepthInPass | None = None,
    start: State | None = None,
    tolerance: float | None = None,
    check_resolution: bool = True,
) -> State:
    """Solve steady rolling of a model, of a wheel its largest patch; return it, converged or not.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    depth : ndarray, shape (n_x, n_y), or callable, optional
        Depth worn off both bodies, mm. A function of pressure, traction and slip is updated within
        the iteration, as in the paper, which needs ``method = "uzawa"``.
    start : State, optional
        A contact nearby, as initial guess.
    tolerance : float, optional
        Residual of the solution; by default `solver.tolerance` of the scene.
    check_resolution : bool
        Whether a contact of fewer elements than `FewestElements.contact` gets the status
        NOT_RESOLVED; the first contact of a course that presses the bodies together may be small.

    Returns
    -------
    State
        Converged or not: see its status and message.
    """
    # Also a single patch: the gap in an inclined plane depends on the depth of the wheel.
    if model.wheel_rail is not None and model.wheel_depth is None:
        return max(solve_patches(model, depth, start, tolerance), key=lambda contact: contact.P)
    tolerance = tolerance or model.scene.solver.tolerance
    meter = ConvolutionMeter(model.operators.lattice.padded)
    if model.scene.heat is None:
        contact = _equilibrium(model, depth, start, tolerance)
    else:
        contact = solve_with_heat(
            model, lambda warm, start: _equilibrium(warm, depth, start, tolerance), start
        )
    contact = contact.with_cost(replace(contact.cost, **meter.work))
    few = min(contact.elements_across) < FewestElements.contact and contact.touching.any()
    if check_resolution and contact.converged and few:
        return replace(contact, status=Status.NOT_RESOLVED, note=not_resolved(contact))
    return contact


def solve_patches(
    model: Model,
    depth: np.ndarray | DepthInPass | None = None,
    start: State | None = None,
    tolerance: float | None = None,
    load_tolerance: float = 1e-6,
) -> tuple[State, ...]:
    """Solve all contact patches of a wheel, which share one load; see `share_load`.

    A free pitch of its wheelset is found with them, see `find_pitch`.
    """

    def solve(patch: Model, start: State | None) -> State:
        # Other patches begin to touch with a few elements.
        return equilibrium(patch, depth, start, tolerance, patch.patch is model.patch)

    if model.finds_pitch:
        return find_pitch(
            model,
            lambda wheel, starts: share_load(wheel, solve, starts, load_tolerance),
            (start,),
            load_tolerance,
        )
    return share_load(model, solve, (start,), load_tolerance)


def solve_patches_on_fitted_mesh(
    model: Model, start: State | None = None, load_tolerance: float = 1e-6
) -> tuple[Model, tuple[State, ...]]:
    """Solve all patches of a wheel on a mesh enlarged to contain them; return model and contacts.

    Parameters
    ----------
    model : Model
        Model of a scene with a wheel.
    start : State, optional
        A similar contact in the first patch, used if it is on the mesh of the model.
    load_tolerance : float
        Relative error of the load that the patches carry together.

    Returns
    -------
    Model, tuple of State
        The model on the mesh of the patches, and these in the order of `WheelRail.patches`.
    """
    for _ in range(1 + GROWTHS):
        near = start if start is not None and start.grid == model.grid else None
        contacts = solve_patches(model, start=near, load_tolerance=load_tolerance)
        if (enlarged := enlarge_for(model, contacts)) is model:
            break
        model = enlarged
    return model, contacts


def _equilibrium(
    model: Model, depth: np.ndarray | DepthInPass | None, start: State | None, tolerance: float
) -> State:
    """Solve the steady rolling contact of one patch at constant temperature."""
    gap, in_pass = model.undeformed_gap, None
    if callable(depth):
        in_pass = _dimensionless_depth(model, depth)
    elif depth is not None:
        gap = gap + depth
    problem = model.problem(gap / model.units.gap, in_pass)
    first = None if start is None else dimensionless_start(model, start)
    outcome = solve_problem(model, problem, tolerance, first)
    other = None
    # Later contacts of a process, and iterations, repeat the warning of the first one.
    if start is None and model.wheel_rail is None and model.scene.heat is None:
        other = partial(_describe_other_solution, model, problem, tolerance, outcome)
    return _to_state(model, problem, outcome, depth, other)


def _describe_other_solution(
    model: Model, problem: Problem, tolerance: float, outcome: Outcome
) -> str:
    """Return text with the forces of a solution and of the one for the other `friction.start`."""
    starts = {False: "rest", True: "sliding"}
    sliding = model.starts_sliding
    other, texts = solve_problem(model, problem, tolerance, sliding=not sliding), []
    if not other.converged or len(problem.forces):
        return ""
    for found in (outcome, other):
        traction = traction_of(model, found.fields.traction)
        force = traction.sum(axis=(1, 2)) * model.grid.element_area
        texts.append(f"Qx = {force[0]:.5g}, Qy = {force[1]:.5g} {model.scene.force_unit}")
    if texts[0] == texts[1]:
        return "; both values of friction.start give the same forces here"
    return (
        f"; this solution has {texts[0]}, and the one with friction.start = "
        f'"{starts[not sliding]}" has {texts[1]}'
    )


def solve_blocks_on_fitted_mesh(model: Model) -> tuple[Model, tuple[State, ...]]:
    """Solve each block's contact before rolling on a mesh enlarged to fit; return model, contacts.

    Returns
    -------
    Model, tuple of State
        The model on a mesh that holds the contacts.
    tuple of State
        The contact of each block.
    """
    contacts = _solve_blocks(model)
    for _ in range(GROWTHS):
        # A mesh chosen from a measured gap cannot grow beyond the gap.
        chosen = not model.scene.has_fixed_domain and model.scene.hertz is not None
        if all(contact.status is not Status.OFF_GRID for contact in contacts) or not chosen:
            break
        model = model.on(enlarge(model.grid))
        contacts = _solve_blocks(model)
    return model, contacts


def solve_on_fitted_mesh(model: Model) -> tuple[Model, State]:
    """Solve a model's only contact on a mesh enlarged to contain it; return model and contact."""
    model, (contact,) = solve_blocks_on_fitted_mesh(model)
    return model, contact


def _solve_blocks(model: Model) -> tuple[State, ...]:
    """Solve the contact of each block before rolling, with the initial wear."""
    return tuple(equilibrium(block, block.initial_wear) for block in model.blocks)


def dimensionless_start(model: Model, contact: State) -> Start:
    """Return a contact as a dimensionless initial guess; the inverse of `state_of`."""
    units = model.units
    creepage = np.array([contact.xi_x, contact.xi_y])[list(model.free)]
    return Start(
        contact.pressure / units.pressure,
        model.frame.to_scaled(contact.traction) / units.pressure,
        contact.approach / units.gap,
        creepage / units.slip,
    )


def _dimensionless_depth(model: Model, depth: DepthInPass) -> DepthInPass:
    """Return a function from dimensionless pressure, traction and slip to wear depth in a pass."""
    units = model.units

    def scaled(pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        fields = (
            units.pressure * pressure,
            traction_of(model, traction),
            _physical_slip(model, slip),
        )
        return depth(*fields) / units.gap

    return scaled


def _physical_slip(model: Model, scaled: np.ndarray) -> np.ndarray:
    """Return the slip s/V at element centres, for wear and heat, from the scaled slip."""
    return model.stencil.at_centres(model.units.slip * model.frame.slip_to_physical(scaled))


def _rolling_resistance(
    model: Model, pressure: np.ndarray, gap: np.ndarray, depth: np.ndarray
) -> float:
    """Return the rolling resistance, N, of pressure on worn slopes; 0 for equal materials.

    `gap` is the remaining gap of the solved contact, and `depth` the wear depth, both in mm.

    It uses central differences d of h - g, with g the remaining gap. In contact g is zero, but the
    outermost elements reach beyond its edge, and with g the balance of work holds on any mesh: h -
    g is the approach minus the displacement A_nn p_n + A_nt p_t. As d is antisymmetric and commutes
    with the operators, and by reciprocity, A_nt = A_tn^T,

        p_n . d(h - g) = -p_n . d A_nt p_t = p_t . d A_tn p_n,

    the work of p_t on the slip by p_n; the work of p_t on its own slip is zero. So resistance and
    creepages supply the dissipation of the slip at the centres (`Stencil.at_centres`).
    """
    if not model.elasticity.coupled:
        return 0.0
    slope = np.gradient(model.undeformed_gap + depth - gap, model.grid.dx, axis=0)
    return float((pressure * slope).sum() * model.grid.element_area)


def _work_beyond_creepage(model: Model, traction: np.ndarray) -> float:
    """Return the work, N, of tractions on rigid slip beyond creepages and spin; 0 without wheel.

    On a wheel, points beside the tangent plane of the patch have another rolling radius.
    """
    if model.patch is None:
        return 0.0
    beyond = model.rigid_slip - model.rigid_slip_by(*model.creepages(None))
    return float(-(traction * beyond).sum() * model.grid.element_area)


def _to_state(
    model: Model,
    problem: Problem,
    outcome: Outcome,
    depth: np.ndarray | DepthInPass | None,
    describe_other: Callable[[], str] | None = None,
) -> State:
    """Return the contact, in mm, N and MPa, of the outcome of a steady problem."""
    units, fields = model.units, outcome.fields
    pressure = units.pressure * fields.pressure
    traction, gap = traction_of(model, fields.traction), units.gap * fields.gap
    slip = _physical_slip(model, fields.slip)
    if callable(depth):
        depth = depth(pressure, traction, np.where(pressure > 0.0, slip, 0.0))
    elif depth is None:
        depth = np.zeros(model.grid.elements)
    creepages = model.creepages(outcome.creepage)
    resistance = _rolling_resistance(model, pressure, gap, depth)
    resistance += _work_beyond_creepage(model, traction)
    return state_of(model, problem, outcome, slip, creepages, depth, resistance, describe_other)
