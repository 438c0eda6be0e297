"""Solve one step of transient rolling, or a shift, in mm, N and MPa.

See `operators.kinematics` for the slip of a step. A step depends only on the pressure, tractions
and gap of the step before.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tractive_sam.compute import ConvolutionMeter
from tractive_sam.contact.model import Model
from tractive_sam.contact.solution import solve_problem, state_of
from tractive_sam.contact.step_result import StepInput, StepResult
from tractive_sam.contact.step_wear import StepWear
from tractive_sam.contact.step_work import Particles, StepWork
from tractive_sam.mechanics import FrictionLaw, FrictionOnMesh, PreviousShare
from tractive_sam.operators import Advection, FrictionSlip, RollingStep
from tractive_sam.results import Cost, State, Status
from tractive_sam.solvers import PRESSURE_ONLY, NormalProblem, Note, Outcome, Problem, Start, needed


@dataclass(frozen=True, eq=False)
class ParticleMotion:
    """Motion of surface particles to the nodes of the mesh during a time step.

    Attributes
    ----------
    advection : Advection
        Distance that they moved.
    curved : ndarray of bool, shape (n_x, n_y)
        Particles that are interpolated by a parabola, see `Advection.before`.
    displacement : ndarray, shape (2 or 3, n_x, n_y)
        Dimensionless displacements that they had before.
    rigid : ndarray, shape (2, n_x, n_y)
        Slip of the undeformed bodies, dimensionless.
    computed : ndarray or float
        The part of it by creepages that were computed for prescribed forces.
    """

    advection: Advection
    curved: np.ndarray
    displacement: np.ndarray
    rigid: np.ndarray
    computed: np.ndarray | float = 0.0


class Stepper:
    """Solver of time steps of a model, each from the step before; raises for an interfacial layer.

    Parameters
    ----------
    model : Model
        The scene in numbers; the inputs of a step replace its load, creepages and forces.

    Raises
    ------
    ValueError
        If there is an interfacial layer.
    """

    def __init__(self, model: Model):
        if model.elasticity.layer:
            raise ValueError(
                "laws: a transient does not model an interfacial layer; give other laws.elasticity"
            )
        self.model, self.operators, self.work = model, model.operators, StepWork(model)
        law = model.wear_law
        self.wear = None if law is None else StepWear(model, law)
        self._edges: list[FrictionSlip] = []

    def step(
        self,
        before: StepResult,
        inputs: StepInput,
        earlier: StepResult | None = None,
        ratio: float = 0.0,
    ) -> StepResult:
        """Solve one time step; return its contact, converged or not, with its work and wear.

        Parameters
        ----------
        before : StepResult
            The step before.
        inputs : StepInput
            Prescribed quantities of the step.
        earlier : StepResult, optional
            The step before that one: the initial guess is extrapolated from both. With a negative
            ratio the end of a longer step: the initial guess is interpolated.
        ratio : float
            Ratio of the lengths of the step and the step before; minus the ratio to the longer
            step.

        Returns
        -------
        StepResult
            Converged or not: see its contact.
        """
        meter = ConvolutionMeter(self.operators.lattice.padded)
        advection = Advection.from_distance(inputs.distance / self.model.grid.dx)
        motion, law = self._motion(before, inputs, advection), self._law(before, inputs, advection)
        worn = before.worn if self.wear is None else advection.move_depths(before.worn)
        depth, expected = worn, before.contact.traction
        if earlier is not None:
            depth = worn + (ratio * before.gained if ratio >= 0.0 else -ratio * earlier.gained)
            expected = expected + ratio * (expected - earlier.contact.traction)
        rigid = motion.rigid - motion.displacement[-2:]
        kinematics = self._kinematics(before.contact, motion)
        problem = self._problem(inputs, rigid, kinematics, law, depth.sum(axis=0))
        start = self._start(problem, before, motion, inputs, expected, earlier, ratio)
        outcome = self._solve(problem, start, advection.length)
        result, cost = self._result(inputs, advection, problem, outcome, worn), outcome.cost
        if ratio > 0.0:
            result = replace(result, extrapolation_error=result.contact.traction - expected)
        if result.contact.converged:
            if len(problem.forces):
                slip = problem.forces.slip(needed(outcome.creepage, "outcome.creepage"))
                motion = replace(motion, rigid=motion.rigid + slip, computed=slip)
            result, groups = self._with_work(before, inputs, result, motion)
            between = advection.part and self.model.elasticity.coupled  # _later_displacement
            cost += Cost(2.0 if between else 1.0)  # for the displacement
            if self.wear is not None:
                result = self.wear.add_wear(inputs, result, advection, law, groups)
        contact = result.contact.with_cost(replace(cost, **meter.work))
        contact.reuse_values(before.contact)
        return replace(result, contact=contact)

    def _motion(
        self, before: StepResult, inputs: StepInput, advection: Advection
    ) -> ParticleMotion:
        """Return the motion of particles to the nodes, without the slip of unknown creepages."""
        touching = advection.with_nodes_ahead(before.contact.pressure) > 0.0
        curved = advection.parabola_mask(touching) & self.model.stencil.staggered
        rigid = self.rigid_slip(inputs, advection, advection.middle(curved))
        displacement = self.displacement(before, advection.reach)
        return ParticleMotion(
            advection, curved, advection.previous_values(displacement, curved), rigid
        )

    def _kinematics(self, past: State, motion: ParticleMotion) -> RollingStep:
        """Return the kinematics of a step, with the gap that entering particles close.

        With upwind slip a particle sticks from the first node ahead of the contact: a step of one
        element moves it from there, and it closes no gap.
        """
        stencil, advection = self.model.stencil, motion.advection
        gap = np.where(past.touching, 0.0, past.gap) / self.model.units.gap
        nodes = advection.with_nodes_ahead(gap, edge=True)
        entering = advection.previous_values(nodes, motion.curved)
        if not stencil.staggered:
            edge = nodes.copy()
            for i in range(len(nodes) - 2, -1, -1):
                edge[i] = np.where(nodes[i] > 0.0, nodes[i], edge[i + 1])
            entering = np.maximum(entering - edge[: len(entering)], 0.0)
        return RollingStep(stencil, entering, advection.length, memory=self._edges)

    def _solve(self, problem: Problem, start: Start, length: float) -> Outcome:
        """Solve the problem of a step; without contact, prescribed forces must be zero."""
        outcome = solve_problem(self.model, problem, self.model.scene.solver.tolerance, start)
        if outcome.top is not None:  # its creepage is per element length, like the slip
            force, creepage = outcome.top
            outcome = replace(outcome, top=(force, creepage / length))
        if len(problem.forces) and outcome.creepage is None:
            outcome = _without_contact(problem, outcome)
        return outcome

    def with_gap_outside(self, result: StepResult, separation: np.ndarray | float) -> StepResult:
        """Return a step on a widened mesh with gap and wear computed outside the former mesh."""
        contact, units = result.contact, self.model.units
        unknown = np.isinf(contact.gap)
        if not unknown.any():
            return result
        depth = self.model.add_initial_wear(result.worn.sum(axis=0))
        if self.model.elasticity.coupled:
            moved = self.operators.coupled_displacement(self.model.scaled_fields(contact))
        else:
            moved = self.operators.normal((contact.pressure / units.pressure)[None])
        undeformed = self.model.undeformed_gap + separation + depth
        gap = undeformed + units.gap * moved[0] - contact.approach
        contact = replace(contact, gap=np.where(unknown, gap, contact.gap), wear=depth)
        return replace(result, contact=contact)

    def _law(self, before: StepResult, inputs: StepInput, advection: Advection) -> FrictionLaw:
        """Return the friction law of a step, with past friction if it falls; raise for a shift.

        Raises
        ------
        ValueError
            If the law falls with the sliding speed, which a shift does not have.
        """
        law, grid, past = self.model.friction_law, self.model.grid, before.contact
        if not law.falls:
            return law
        if not advection.length:
            raise ValueError(
                "laws.friction: friction falls with the sliding speed, and a shift (a step without "
                "distance) has none; roll a short distance instead"
            )
        rest = law.weakened(inputs.friction_before or inputs.friction).bound(
            past.pressure, grid.x[:, None], grid.y[None, :]
        )
        bound = past.pressure if past.traction_bound is None else past.traction_bound
        touching = rest.radius > 0.0
        lost = np.where(touching, 1.0 - bound / np.where(touching, rest.radius, 1.0), 0.0)
        share = 1.0 - advection.move_depths(lost)
        return law.with_previous(PreviousShare(grid.x, grid.y, share, inputs.distance))

    def _problem(
        self,
        inputs: StepInput,
        rigid: np.ndarray,
        kinematics: RollingStep,
        law: FrictionLaw,
        worn: np.ndarray | float = 0.0,
    ) -> Problem:
        """Return the dimensionless problem of a step for a wear depth, mm."""
        model, grid, units = self.model, self.model.grid, self.model.units
        load = None if inputs.load is None else inputs.load / (units.pressure * grid.element_area)
        approach = 0.0 if inputs.approach is None else inputs.approach / units.gap
        undeformed = model.undeformed_gap + inputs.separation + model.add_initial_wear(worn)
        law = law.weakened(inputs.friction)
        x, y = grid.x[:, None], grid.y[None, :]
        # The slip of a step is per element length, the sliding speed per distance.
        slip_unit = units.slip * grid.dx / (inputs.distance or grid.dx)
        return Problem(
            NormalProblem(self.operators, undeformed / units.gap, load, approach),
            rigid,
            FrictionOnMesh(law, x, y, units.pressure, slip_unit),
            model.forces_of(inputs.forces),
            kinematics=kinematics,
        )

    def press(self, inputs: StepInput) -> State:
        """Solve the contact under the load of a step without traction; creepages are ignored."""
        model, none = self.model, np.zeros((2, *self.model.grid.elements))
        problem = self._problem(inputs, none, RollingStep(model.stencil), model.friction_law)
        outcome = PRESSURE_ONLY.solve(problem, model.scene.solver.tolerance)
        depth = model.add_initial_wear(0.0)
        return state_of(model, problem, outcome, none, (0.0, 0.0, 0.0), depth)

    def at_rest(self, contact: State) -> StepResult:
        """Return a contact as the step before the first one, with its energy and displacements."""
        displacement = self.displacement(StepResult(contact), 1)
        energy = self.work.energy(self.model.scaled_fields(contact), displacement)
        none = np.zeros((2, *self.model.grid.elements))
        return StepResult(contact, energy=energy, displacement=displacement, worn=none, gained=none)

    def displacement(self, result: StepResult, reach: int) -> np.ndarray:
        """Return dimensionless displacements of a step at the nodes and at `reach` nodes ahead."""
        nx = self.model.grid.elements[0]
        if result.displacement.shape[1] >= nx + reach:
            return result.displacement[:, : nx + reach]
        fields = self.model.scaled_fields(result.contact)
        nodes = np.zeros((len(fields), nx + reach, fields.shape[2]))
        nodes[:, :nx] = fields
        operators = self.operators.part(nodes.shape[1:]) if reach else self.operators
        with_pressure = len(fields) == 3
        return (operators.coupled_displacement if with_pressure else operators.tangential)(nodes)

    def rigid_slip(
        self, inputs: StepInput, advection: Advection, middle: np.ndarray | float
    ) -> np.ndarray:
        """Return the slip of the undeformed bodies in a step, dimensionless, (2, n_x, n_y).

        Parameters
        ----------
        inputs : StepInput
            Creepages of the step; a creepage with a prescribed force is ignored.
        advection : Advection
            Distance of the step.
        middle : ndarray, shape (n_x, n_y), or float
            Distance from the nodes to the points of the rigid slip, in elements.
        """
        model, grid = self.model, self.model.grid
        longitudinal, lateral, spin = (
            0.0 if force is not None else creepage
            for creepage, force in zip(inputs.creepages, (*inputs.forces, None), strict=True)
        )
        if not model.stencil.staggered and advection.length:
            middle = middle - 0.5
        scale = self._distance(advection) / model.units.slip
        translation = model.frame.matrix @ (longitudinal, lateral)
        slip = np.empty((2, *grid.elements))
        slip[:] = scale * translation[:, None, None]
        if spin:
            x, y = grid.x[:, None] + grid.dx * middle, grid.y[None, :]
            turned = np.stack(np.broadcast_arrays(-y, x))
            slip += scale * spin * model.frame.slip_to_scaled(turned)
        return slip

    def _distance(self, advection: Advection) -> float:
        """Return the rolled distance in elements, which divides slip; 1 mm for a shift."""
        return advection.length or 1.0 / self.model.grid.dx

    def _start(
        self,
        problem: Problem,
        before: StepResult,
        motion: ParticleMotion,
        inputs: StepInput,
        expected: np.ndarray,
        earlier: StepResult | None,
        ratio: float,
    ) -> Start:
        """Return the initial guess of a step: extrapolated from two steps, or the last step.

        What the extrapolation missed a step before moves with the particles that stick, for example
        the border between particles that entered before and after a change of the creepages. It is
        added to `expected`, the extrapolated traction, MPa. If the pressure before the step still
        solves the normal problem, it is not extrapolated.
        """
        model, units = self.model, self.model.units
        last, first = before.contact, (earlier or before).contact
        per_distance = units.slip / self._distance(motion.advection)

        def extrapolate(value: Any, earlier_value: Any) -> Any:
            return value if first is last else value + ratio * (value - earlier_value)

        creepages = [
            extrapolate(getattr(last, name), getattr(first, name))
            for name, force in zip(("xi_x", "xi_y"), inputs.forces, strict=True)
            if force is not None
        ]
        gap, pressure, approach = None, last.pressure, last.approach
        if before.has_pressure_of(problem.free_pressure):
            gap = last.gap / units.gap
        else:
            pressure = extrapolate(pressure, first.pressure)
            approach = extrapolate(approach, first.approach)
        if before.extrapolation_error is not None and ratio > 0.0:
            sticking, advection = last.sticking, motion.advection
            missed = advection.with_nodes_ahead(np.where(sticking, before.extrapolation_error, 0.0))
            missed = advection.previous_values(missed, motion.curved)
            expected = expected + np.where(sticking, ratio * missed, 0.0)
        return Start(
            np.maximum(pressure, 0.0) / units.pressure,
            model.frame.to_scaled(expected) / units.pressure,
            approach / units.gap,
            np.nan_to_num(creepages) / per_distance if creepages else None,
            gap,
        )

    def _result(
        self,
        inputs: StepInput,
        advection: Advection,
        problem: Problem,
        outcome: Outcome,
        worn: np.ndarray,
    ) -> StepResult:
        """Return the contact at the end of a step in mm, N and MPa, still without work and wear."""
        model, creepages = self.model, list(inputs.creepages)
        per_distance = model.units.slip / self._distance(advection)
        sought = [k for k in (0, 1) if inputs.forces[k] is not None]
        if sought:
            computed = needed(outcome.creepage, "outcome.creepage")
            for k, value in zip(sought, computed, strict=True):
                creepages[k] = float(value) * per_distance
        slip = per_distance * model.frame.slip_to_physical(outcome.fields.slip)
        if advection.length:
            slip = model.stencil.at_centres(slip)
        longitudinal, lateral, spin = creepages
        depth = model.add_initial_wear(worn.sum(axis=0))
        contact = state_of(model, problem, outcome, slip, (longitudinal, lateral, spin), depth)
        return StepResult(
            contact,
            distance=inputs.distance,
            shifted=not inputs.distance,
            normal=None if model.elasticity.coupled else problem.free_pressure,
            worn=worn,
            gained=np.zeros_like(worn),
        )

    def _with_work(
        self, before: StepResult, inputs: StepInput, result: StepResult, motion: ParticleMotion
    ) -> tuple[StepResult, tuple[Particles, ...]]:
        """Return a step with its work and elastic energy, and the particles that wear.

        See `step_work`.
        """
        work, displacement = self.work, self.displacement(result, max(motion.advection.reach, 1))
        result = replace(result, displacement=displacement)
        groups = self._particles(before, inputs, result, motion)
        energy = work.energy(self.model.scaled_fields(result.contact), displacement)
        supplied, friction = work.supplied(groups), work.friction(groups)
        if motion.advection.part:
            friction = supplied - (energy - before.energy)
            groups = work.match_work(groups, friction)
        return replace(result, supplied=supplied, friction=friction, energy=energy), groups

    def _particles(
        self, before: StepResult, inputs: StepInput, result: StepResult, motion: ParticleMotion
    ) -> tuple[Particles, ...]:
        """Return particles that do the work of a step: one mean group, or two, before and after."""
        advection, curved, past = motion.advection, motion.curved, before.contact
        columns, fields = self.model.grid.elements[0], self.model.scaled_fields(past)
        change = result.displacement[:, :columns] - motion.displacement
        pressure, last = result.contact.pressure, self.model.scaled_fields(result.contact)
        if not advection.part:
            previous = advection.previous_values(advection.with_nodes_ahead(fields), curved)
            pressed = advection.previous_values(advection.with_nodes_ahead(past.pressure), curved)
            mean = 0.5 * (pressure + pressed), 0.5 * (last + previous)
            return (Particles(*mean, change, motion.rigid),)
        after = Particles(pressure, last, change, motion.rigid, weight=0.5)
        moves = advection.spread((~result.contact.sticking).astype(float), np.zeros_like(curved))
        earlier = Particles(
            past.pressure,
            fields,
            self._later_displacement(result, motion) - self.displacement(before, 0)[:, :columns],
            self.rigid_slip(inputs, advection, -0.5 * advection.length) + motion.computed,
            earlier=True,
            weight=0.5,
            wearing=(moves[:columns] > 0.0).astype(float),
        )
        return after, earlier

    def _later_displacement(self, result: StepResult, motion: ParticleMotion) -> np.ndarray:
        """Return displacements after a step of the particles that were at the nodes before it.

        For dissimilar bodies the adjoint of the interpolation, as the pressure does work on them.
        For bodies of equal material they only distribute the wear, and linear interpolation
        suffices, without an application of an operator.
        """
        columns = self.model.grid.elements[0]
        if not self.model.elasticity.coupled:
            return motion.advection.after(result.displacement[:, :columns])
        fields = self.model.scaled_fields(result.contact)
        spread = motion.advection.spread(fields, motion.curved)
        return self.operators.part(spread.shape[1:]).coupled_displacement(spread)[:, :columns]


def _without_contact(problem: Problem, outcome: Outcome) -> Outcome:
    """Return the outcome of separate bodies: failed if forces other than 0 are prescribed."""
    none = np.zeros(len(problem.forces))
    if not problem.forces.target.any():
        return replace(outcome, creepage=none)
    note = Note("the bodies have separated and carry no force", Status.DIVERGED)
    return replace(outcome, status=Status.DIVERGED, residual=1.0, creepage=none, trace=(note,))
