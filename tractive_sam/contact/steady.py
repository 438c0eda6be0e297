"""One steady state of a model, solved and put back into mm, N and MPa."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tractive_sam.contact.heat import warmed
from tractive_sam.contact.mesh import grown
from tractive_sam.contact.message import not_resolved
from tractive_sam.contact.model import Model
from tractive_sam.contact.solution import solve_problem, state_of, traction_of
from tractive_sam.operators import ConvolutionMeter
from tractive_sam.results import State, Status
from tractive_sam.scene import FewestElements
from tractive_sam.solvers import Outcome, Problem, Start

GROWTHS = 8
"""Most enlargements of a mesh that the scene left to us."""

DepthInPass = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""(p_n and p_t in MPa, s/V) -> depth of wear in mm below every element."""


def equilibrium(
    model: Model,
    depth: np.ndarray | DepthInPass | None = None,
    start: State | None = None,
    tolerance: float | None = None,
    check_resolution: bool = True,
) -> State:
    """Solve one steady state.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    depth : ndarray, shape (n_x, n_y), or callable, optional
        Depth worn off both bodies, mm. As a function of pressure, traction and slip it is
        updated within the iteration, as the paper does it; that is for ``method = "uzawa"`` only.
    start : State, optional
        A contact nearby, as first guess.
    tolerance : float, optional
        Residual to solve to; by default that of the scene.
    check_resolution : bool
        Whether a contact of fewer elements than `FewestElements.contact` is not resolved; the
        first contact of a course that presses the bodies together may be so small.

    Returns
    -------
    State
        Converged or not: see its status and message.
    """
    tolerance = tolerance or model.scene.solver.tolerance
    meter = ConvolutionMeter(model.operators.lattice.padded)
    if model.scene.heat is None:
        contact = _equilibrium(model, depth, start, tolerance)
    else:
        contact = warmed(
            model, lambda warm, start: _equilibrium(warm, depth, start, tolerance), start
        )
    contact = contact.with_convolutions(meter.convolutions)
    few = min(contact.elements_across) < FewestElements.contact and contact.touching.any()
    if check_resolution and contact.converged and few:
        return replace(contact, status=Status.NOT_RESOLVED, note=not_resolved(contact))
    return contact


def _equilibrium(
    model: Model, depth: np.ndarray | DepthInPass | None, start: State | None, tolerance: float
) -> State:
    gap, in_pass = model.undeformed_gap, None
    if callable(depth):
        in_pass = _dimensionless(model, depth)
    elif depth is not None:
        gap = gap + depth
    problem = model.problem(gap / model.units.gap, in_pass)
    first = None if start is None else start_of(model, start)
    outcome = solve_problem(model, problem, tolerance, first)
    return _contact(model, problem, outcome, depth)


def fitted_blocks(model: Model) -> tuple[Model, tuple[State, ...]]:
    """Solve the bodies as they are, enlarging a mesh left to us until it holds the contacts.

    Returns
    -------
    Model, tuple of State
        The model on the mesh of the contacts, one of each block.
    """
    contacts = _as_they_are(model)
    for _ in range(GROWTHS):
        # Beyond a measured gap from which the mesh was chosen there is nothing to grow into.
        chosen = not model.scene.has_fixed_domain and model.scene.hertz is not None
        if all(one.status is not Status.OFF_GRID for one in contacts) or not chosen:
            break
        model = model.on(grown(model.grid))
        contacts = _as_they_are(model)
    return model, contacts


def fitted(model: Model) -> tuple[Model, State]:
    """The same of one contact."""
    model, (contact,) = fitted_blocks(model)
    return model, contact


def _as_they_are(model: Model) -> tuple[State, ...]:
    return tuple(equilibrium(one, one.worn_before) for one in model.blocks)


def start_of(model: Model, contact: State) -> Start:
    """The solution of a contact nearby, dimensionless: the inverse of what makes a `State`."""
    units = model.units
    creepage = np.array([contact.xi_x, contact.xi_y])[list(model.free)]
    return Start(
        contact.pressure / units.pressure,
        model.frame.to_scaled(contact.traction) / units.pressure,
        contact.approach / units.gap,
        creepage / units.slip,
    )


def _dimensionless(model: Model, depth: DepthInPass) -> DepthInPass:
    units = model.units

    def scaled(pressure: np.ndarray, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
        fields = units.pressure * pressure, traction_of(model, traction), _slip(model, slip)
        return depth(*fields) / units.gap

    return scaled


def _slip(model: Model, scaled: np.ndarray) -> np.ndarray:
    """s/V that wears and dissipates, from what the stencil solves for."""
    return model.stencil.at_centres(model.units.slip * model.frame.slip_to_physical(scaled))


def _rolling_resistance(
    model: Model, pressure: np.ndarray, gap: np.ndarray, depth: np.ndarray
) -> float:
    """Work of the pressure on the slope of the undeformed, worn bodies, N.

    By central differences d of h less the gap g that is left. In contact g is zero, but the
    outermost elements reach beyond its edge, and with g the balance of work holds on any mesh:
    h - g is the approach less the displacement A_nn p_n + A_nt p_t. As d is antisymmetric and
    commutes with the operators, and by reciprocity, A_nt = A_tn^T,

        p_n . d(h - g) = -p_n . d A_nt p_t = p_t . d A_tn p_n,

    the work of p_t on the slip by p_n; that by p_t itself does none. So resistance and creepages
    supply what the slip at the centres (`Stencil.at_centres`) dissipates.
    """
    if not model.elasticity.coupled:
        return 0.0
    slope = np.gradient(model.undeformed_gap + depth - gap, model.grid.dx, axis=0)
    return float((pressure * slope).sum() * model.grid.element_area)


def _contact(
    model: Model, problem: Problem, outcome: Outcome, depth: np.ndarray | DepthInPass | None
) -> State:
    units = model.units
    pressure = units.pressure * outcome.pressure
    traction, gap = traction_of(model, outcome.traction), units.gap * outcome.gap
    slip = _slip(model, outcome.slip)
    if callable(depth):
        depth = depth(pressure, traction, np.where(pressure > 0.0, slip, 0.0))
    elif depth is None:
        depth = np.zeros(model.grid.elements)
    creepages = model.creepages(outcome.creepage)
    resistance = _rolling_resistance(model, pressure, gap, depth)
    return state_of(model, problem, outcome, slip, creepages, depth, resistance)
