"""Solve one steady state of a model, in mm, N and MPa, or all patches of a wheel on a rail.

The patches of a wheel share one approach, and carry its load together. The wheel is a vertical
distance d below its first touch. The approach of a patch is the largest overlap of the undeformed
surfaces there, normal to its plane. At the contact angle delta, its pressure and its lateral
traction carry P cos(delta) - Q_y sin(delta) of the vertical force.

A free wheelset turns so fast that the tractions of its two wheels have no moment about the axle.
The other wheel is computed for it with an equal load, on a rail and with friction in the mirror;
where the wheelset stands in the middle of the track, it is the mirror image.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from tractive_sam.compute import ConvolutionMeter
from tractive_sam.contact.heat import solve_with_heat
from tractive_sam.contact.memory import displace
from tractive_sam.contact.mesh import enlarge
from tractive_sam.contact.model import Model
from tractive_sam.contact.solution import not_resolved, solve_problem, state_of, traction_of
from tractive_sam.mechanics import RelaxingBody, RelaxingHalfSpaces
from tractive_sam.operators import STAGGERED, Operators
from tractive_sam.results import Cost, State, Status
from tractive_sam.scene import FewestElements
from tractive_sam.schema import required
from tractive_sam.solvers import Outcome, Problem, Start, needed

GROWTHS = 8
"""Largest number of enlargements of a mesh that the scene does not fix."""

Solve = Callable[[Model, State | None], State]
"""Solves a patch at a depth of the wheel, from the contact at another depth."""


@dataclass
class LoadedWheel:
    """Wheel that is lowered until its patches carry its load, beginning at its last depth.

    It uses the secant method for the load to the power 2/3, which for a Hertz contact is linear in
    the depth of the wheel.

    Attributes
    ----------
    model : Model
        Model of a scene with a wheel.
    solve : callable
        Solves a patch at a depth.
    starts : sequence of State or None
        Similar contacts in the first patches, then those at the last depth.
    load_error : float
        Relative error of the load that the last contacts carry.
    """

    model: Model
    solve: Solve
    starts: Sequence[State | None] = ()
    load_error: float = np.inf
    _depth: float | None = None
    _slope: float | None = None

    def share_load(
        self, tolerance: float, max_steps: int = 12, pitch: float | None = None
    ) -> tuple[State, ...]:
        """Solve all patches at a depth at which they carry the load; see `share_load`.

        A `pitch` replaces that of the model.
        """
        model = self.model if pitch is None else self.model.at_pitch(pitch)
        wheelset = required(model.scene.wheelset, "wheelset")
        patches = required(model.wheel_rail, "wheel").patches
        by_normal = wheelset.load is None
        load = required(wheelset.load or wheelset.normal_load, "wheelset.load")
        models, cost = [model.of_patch(patch) for patch in patches], Cost()
        last = [*self.starts, *(None for _ in patches)][: len(patches)]
        depth, previous = self._depth, (0.0, 0.0)
        if depth is None:
            hertz = model.scene.hertz
            unworn = None if hertz is None else hertz.approach
            approach = required(unworn, "body") if last[0] is None else last[0].approach
            depth = approach / np.cos(patches[0].angle)
        for step in range(max_steps):
            contacts = [
                self.solve(local.of_patch(patch, depth), before)
                for local, patch, before in zip(models, patches, last, strict=True)
            ]
            cost = sum((contact.cost for contact in contacts), cost)
            carried = sum(
                contact.P
                if by_normal
                else float(contact.P * np.cos(patch.angle) - contact.Qy * np.sin(patch.angle))
                for contact, patch in zip(contacts, patches, strict=True)
            )
            self.load_error = abs(carried / load - 1.0)
            unsolved = {contact.status for contact in contacts if not contact.converged}
            # At a smaller depth the contact may be within the mesh, at a larger one resolved by it.
            too_deep = unsolved == {Status.OFF_GRID} and carried > (1.0 + tolerance) * load
            too_flat = unsolved == {Status.NOT_RESOLVED} and carried < (1.0 - tolerance) * load
            if unsolved and not (too_deep or too_flat):
                break
            last = [contact if contact.touching.any() else None for contact in contacts]
            power = max(carried, 0.0) ** (2.0 / 3.0)
            if step or self._slope is None:
                self._slope = (power - previous[1]) / (depth - previous[0])
            previous = depth, power
            depth += (load ** (2.0 / 3.0) - power) / self._slope
            # The next pitch begins at the depth that follows from this one.
            self.starts, self._depth = last, depth
            if not (unsolved or self.load_error > tolerance):
                break
        return (contacts[0].with_cost(cost), *contacts[1:])

    def share_load_on_fitted_mesh(self, tolerance: float, pitch: float) -> tuple[State, ...]:
        """Solve all patches as `share_load`, on a mesh that is enlarged to contain them."""
        contacts = self.share_load(tolerance, pitch=pitch)
        for _ in range(GROWTHS):
            if (larger := enlarge_for(self.model, contacts)) is self.model:
                break
            self.model, self.starts = larger, ()
            contacts = self.share_load(tolerance, pitch=pitch)
        return contacts


def share_load(
    model: Model,
    solve: Solve,
    starts: Sequence[State | None] = (),
    tolerance: float = 1e-6,
    max_steps: int = 12,
) -> tuple[State, ...]:
    """Solve all patches of a wheel at the depth at which they together carry its load.

    The first patch has the cost of all.

    Parameters
    ----------
    model : Model
        Model of a scene with a wheel.
    solve : callable
        Solves a patch.
    starts : sequence of State or None
        Similar contacts in the first patches.
    tolerance : float
        Relative error of the load.
    max_steps : int
        Largest number of depths; the contacts at the last one are returned even if the load is not
        within the tolerance.

    Returns
    -------
    tuple of State
        The patches in the order of `WheelRail.patches`; one that is open has no pressure.
    """
    return LoadedWheel(model, solve, starts).share_load(tolerance, max_steps)


def find_pitch(
    model: Model,
    solve: Solve,
    starts: Sequence[State | None],
    tolerance: float,
    max_steps: int = 30,
) -> tuple[State, ...]:
    """Solve the patches of a wheel at the pitch at which no moment acts on its axle.

    The moment rises or falls with the pitch throughout. The method is the secant method within the
    interval that contains the root; its first step is that of sticking contacts. Before the last
    pitches, the load needs to be as exact as the moment memory.

    Parameters
    ----------
    model : Model
        Model of a scene with a wheel whose pitch is free.
    solve : callable
        Solves a patch.
    starts : sequence of State or None
        Similar contacts in the first patches; their pitch is the first one.
    tolerance : float
        Error of the moment over load times radius times the friction of full sliding, and relative
        error of the loads.
    max_steps : int
        Largest number of pitches; the contacts at the last one are returned in any case.
    """
    geometry = required(model.wheel_rail, "wheel")
    wheelset = required(model.scene.wheelset, "wheelset")
    are_mirrored = wheelset.y == wheelset.yaw == 0.0 and wheelset.roll in ("free", 0.0)
    wheels = [LoadedWheel(model, solve, starts)]
    if not are_mirrored:
        opposite = Model(model.scene.opposite_wheel, wheel_rail=geometry.opposite)
        wheels.append(LoadedWheel(opposite, solve))
    pitch = geometry.pitch
    if starts and starts[0] is not None:
        pitch = geometry.patches[0].pitch_at(starts[0].xi_x)
    radius, (long, wide) = geometry.wheel.radius, geometry.patches[0].half_length
    # Of sticking contacts, half as large as the overlap: Kalker's 4 G a b.
    slope = 1.5 * model.scene.material.E_star * long * wide * radius * len(wheels)
    largest = required(model.scene.normal_load, "load") * radius * len(wheels)
    largest *= max(required(model.scene.friction, "friction").mu)
    below, above, cost, rough = -np.inf, np.inf, Cost(), 1e-3
    before: tuple[float, float, float] | None = None
    for _ in range(max_steps):
        moment = 0.0
        solved: list[tuple[State, ...]] = []
        for wheel in wheels:
            # The caller enlarges the mesh of the first wheel.
            lower = wheel.share_load_on_fitted_mesh if solved else wheel.share_load
            contacts = lower(max(tolerance, rough), pitch=pitch)
            cost = cost + contacts[0].cost
            solved.append(contacts)
            if not all(contact.converged for contact in contacts):
                break
            patches = required(wheel.model.wheel_rail, "wheel").patches
            pairs = [*zip(contacts, patches, strict=True)]
            moment += sum(p.moment_about_axle((c.Qx, c.Qy), c.Mz) for c, p in pairs)
        other = next((contact for contact in solved[-1] if not contact.converged), None)
        if other is not None and len(solved) > 1:
            note = f"the other wheel, which determines wheelset.pitch: {other.message}"
            status = Status.NOT_RESOLVED if other.status is Status.OFF_GRID else other.status
            solved[0] = tuple(replace(c, status=status, note=note) for c in solved[0])
        if other is not None:
            break
        load_error = max(wheel.load_error for wheel in wheels)
        if max(abs(moment) / largest, load_error) <= tolerance:
            break
        # Tractions change with the load by at most this moment, which says nothing of the pitch.
        by_load = load_error * largest
        if abs(moment) > by_load:
            below, above = (pitch, above) if moment < 0.0 else (below, pitch)
        if before is not None and abs(moment - before[1]) > max(by_load, before[2]):
            slope = max((moment - before[1]) / (pitch - before[0]), 1e-3 * slope)
        before, step = (pitch, moment, by_load), -moment / slope
        if not below < pitch + step < above:
            step = 0.5 * (below + above) - pitch
        pitch += step
        rough = min(rough, 0.01 * abs(moment) / largest)
    return (solved[0][0].with_cost(cost), *solved[0][1:])


def enlarge_for(model: Model, contacts: Sequence[State]) -> Model:
    """Return a model on a mesh enlarged along the axes in which contacts reach its edge, if any."""
    edges = [contact.at_edge for contact in contacts if contact.status is Status.OFF_GRID]
    if not edges or model.scene.has_fixed_domain:
        return model
    along, across = map(any, zip(*edges, strict=True))
    return model.on(enlarge(model.grid, (along, across)))


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

    def solve(model: Model, start: State | None, tolerance: float = tolerance) -> State:
        if model.scene.heat is None:
            return _equilibrium(model, depth, start, tolerance)
        return solve_with_heat(
            model, lambda warm, start: _equilibrium(warm, depth, start, tolerance), start
        )

    moment = model.scene.load.moment
    if not model.shape.is_flat:
        contact = _find_approach(model, solve, start, tolerance)
    elif moment is None:
        contact = replace(solve(model, start), tilt=model.scene.load.tilt or 0.0)
    else:
        contact = _find_tilt(model, partial(solve, tolerance=min(tolerance, 1e-9)), start, moment)
    contact = contact.with_cost(replace(contact.cost, **meter.work))
    few = min(contact.elements_across) < FewestElements.contact and contact.touching.any()
    if check_resolution and contact.converged and few:
        return replace(contact, status=Status.NOT_RESOLVED, note=not_resolved(contact))
    return contact


def _find_approach(
    model: Model, solve: Solve, start: State | None, tolerance: float, most: int = 30
) -> State:
    """Solve the contact of a curved patch at its approach, or at that at which it carries its load.

    It uses the secant method for the load to the power 2/3, as `LoadedWheel`.

    Parameters
    ----------
    model : Model
        The model.
    solve : callable
        Solves a model from a similar contact.
    start : State or None
        A similar contact.
    tolerance : float
        Relative error of the load.
    most : int
        Largest number of solutions.
    """
    load, cost = model.scene.normal_load, Cost()
    if load is None:
        return solve(model.pressed(required(model.scene.load.approach, "load.approach")), start)
    hertz = model.scene.hertz
    assert hertz is not None  # of bodies that conform
    approach = hertz.approach if start is None else start.approach
    before, target = (0.0, 0.0), load ** (2.0 / 3.0)
    for _ in range(most):
        contact = solve(model.pressed(approach), start)
        cost, carried = cost + contact.cost, contact.resultant[1]
        too_deep = contact.status is Status.OFF_GRID and carried > load
        if not (contact.converged or too_deep) or abs(carried - load) <= tolerance * load:
            break
        power = max(carried, 0.0) ** (2.0 / 3.0)
        slope = (power - before[1]) / (approach - before[0])
        before, start = (approach, power), contact
        approach = (
            min(approach + (target - power) / slope, 3.0 * approach) if slope else 2.0 * approach
        )
    return contact.with_cost(cost)


def _find_tilt(
    model: Model, solve: Solve, start: State | None, moment: float, most: int = 15
) -> State:
    """Solve a contact at the tilt at which its pressure has a moment about x, by secants.

    The moment falls as the tilt rises. The error of the moment is 1e-9 of the load times the
    half length of the mesh, or what the solution of the contact leaves after `most` steps.

    Parameters
    ----------
    model : Model
        The model without tilt.
    solve : callable
        Solves a model from a similar contact.
    start : State or None
        A similar contact, with its tilt.
    moment : float
        Prescribed moment, N mm.
    most : int
        Largest number of solutions.
    """
    tilt, cost, before = 0.0 if start is None else start.tilt, Cost(), None
    for _ in range(most):
        contact = solve(model.tilted(tilt), start)
        contact = replace(contact, tilt=tilt)
        cost = cost + contact.cost
        if not contact.converged or not contact.touching.any():
            break
        missed = contact.Mx - moment
        length = contact.P * model.grid.half_length[1]
        if abs(missed) <= 1e-9 * length:
            break
        if before is None or missed == before[1]:
            # By a twentieth of the approach at the ends of the contact.
            step = 50.0 * contact.approach / max(contact.half_width_y, model.grid.dy)
            step = math.copysign(step, missed)
        else:
            step = -missed * (tilt - before[0]) / (missed - before[1])
        before, start, tilt = (tilt, missed), contact, tilt + step
    return contact.with_cost(cost)


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
        return find_pitch(model, solve, (start,), load_tolerance)
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
    other = solve_problem(model, problem, tolerance, sliding=not sliding)
    if not other.converged or len(problem.forces):
        return ""
    tractions = [traction_of(model, found.fields.traction) for found in (outcome, other)]
    forces = np.sum(tractions, axis=(2, 3)) * model.grid.element_area
    digit = 1e-5 * np.abs(tractions[0]).sum() * model.grid.element_area  # above both residuals
    if np.abs(forces[1] - forces[0]).max() <= digit:
        return 'friction.start: "rest" and "sliding" give the same forces here'
    here, there = (f"Qx = {Qx:.5g}, Qy = {Qy:.5g} {model.scene.force_unit}" for Qx, Qy in forces)
    return (
        f"friction.start: this solution has {here}, and the one with "
        f'"{starts[not sliding]}" has {there}'
    )


def solve_on_fitted_mesh(model: Model) -> tuple[Model, tuple[State, ...]]:
    """Solve the contact of each block before rolling, on a mesh enlarged to contain them.

    Parameters
    ----------
    model : Model
        The scene in numbers, with its initial wear.

    Returns
    -------
    Model, tuple of State
        The model on a mesh that holds the contacts.
    tuple of State
        The contact of each block.
    """
    # A mesh chosen from a measured gap cannot grow beyond the gap.
    known = model.scene.hertz is not None or model.scene.body.has_roller
    growths = GROWTHS if known and not model.scene.has_fixed_domain else 0
    while True:
        contacts = tuple([equilibrium(block, block.initial_wear) for block in model.blocks])
        if not growths or all(contact.status is not Status.OFF_GRID for contact in contacts):
            return model, contacts
        model, growths = model.on(enlarge(model.grid)), growths - 1


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
    """Return the rolling resistance, N, of pressure on slopes; 0 for equal elastic materials.

    `gap` is the remaining gap of the solved contact, and `depth` the wear depth, both in mm.

    It uses central differences d of h - g, with g the remaining gap. In contact g is zero, but the
    outermost elements reach beyond its edge, and with g the balance of work holds on any mesh: h -
    g is the approach minus the displacement A_nn p_n + A_nt p_t. As d is antisymmetric and commutes
    with the operators, and by reciprocity, A_nt = A_tn^T,

        p_n . d(h - g) = -p_n . d A_nt p_t = p_t . d A_tn p_n,

    the work of p_t on the slip by p_n; the work of p_t on its own slip is zero. So resistance and
    creepages supply the dissipation of the slip at the centres (`Stencil.at_centres`). Bodies that
    relax dissipate in addition the work of all tractions on d of their displacements.
    """
    if not model.elasticity.coupled and model.elasticity.symmetric:
        return 0.0
    slope = np.gradient(model.undeformed_gap + depth - gap, model.grid.dx, axis=0)
    return float((pressure * slope).sum() * model.grid.element_area)


def _bulk_dissipation(model: Model, problem: Problem, outcome: Outcome) -> dict[str, float]:
    """Return the work per distance, N, that each body dissipates inside; empty if none relaxes.

    It is that of pressure and tractions on the displacements by the memory of the body; see
    `_rolling_resistance`. Gap and slip of the outcome contain those of both bodies.
    """
    law, units = getattr(model.elasticity, "bodies", model.elasticity), model.units
    if not isinstance(law, RelaxingHalfSpaces):
        return {}
    found = outcome.fields
    fields = np.concatenate((found.pressure[None], found.traction))
    scale = np.array((units.gap / model.grid.dx, units.slip, units.slip))[:, None, None]
    scale *= units.pressure * model.grid.element_area
    bodies: dict[str, Any] = {"A": law.A, "B": law.B}
    relaxing = [name for name, body in bodies.items() if isinstance(body, RelaxingBody)]
    if len(relaxing) == 1 or law.A == law.B:
        change, moved = np.empty_like(fields), found.gap - problem.free_pressure.gap
        if problem.wear is not None:
            moved -= problem.wear(found.pressure, found.traction, found.slip)
        change[0] = np.gradient(moved, axis=0)
        slip = found.slip - problem.rigid
        if len(problem.forces):
            slip -= problem.forces.slip(needed(outcome.creepage, "outcome.creepage"))
        change[1:] = -STAGGERED.at_centres(slip)
        each = (0.0 - float((fields * scale * change).sum())) / len(relaxing)
        return {name: each if name in relaxing else 0.0 for name in bodies}
    work = {}
    for name, other in ("AB", "BA"):
        single = replace(law, **{other: bodies[other].body})
        scales = units.gap / units.pressure, units.slip / units.pressure, model.frame
        moved = displace(Operators(model.operators.lattice, single, *scales), fields)
        work[name] = 0.0 - float((fields * scale * np.gradient(moved, axis=1)).sum())
    return work


def _work_beyond_creepage(model: Model, traction: np.ndarray) -> float:
    """Return the work, N, of tractions on rigid slip beyond creepages and spin; 0 in a plane.

    Points beside the tangent plane of the patch of a wheel, or of a curved patch, have another
    rolling radius.
    """
    if model.patch is None and model.shape.is_flat:
        return 0.0
    beyond = model.rigid_slip - model.rigid_slip_by(*model.creepages(None), flat=True)
    return float(-(traction * model.stencil.at_centres(beyond)).sum() * model.grid.element_area)


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
    contact = state_of(model, problem, outcome, slip, creepages, depth, resistance, describe_other)
    bulk = _bulk_dissipation(model, problem, outcome)
    return replace(contact, bulk_dissipation=bulk) if bulk else contact
