"""Solve one step of transient rolling, or a shift, in mm, N and MPa: its input, wear and work.

A particle at x was at x + d before the step. With the tractions p and the displacements u = A p of
the nodes before (0) and after (1), and T the interpolation of nodal values to x + d, its slip is

    S_1 = w + u_1 - T u_0,        u_0 = A p_0.

Half the work of friction is done by the tractions after the step, on the particles that carry them:
-p_1 . S_1 / 2. The other half is done by the tractions before it, on the particles that carried
them. These were at nodes, and are between nodes after the step. With the adjoint of T their slip is

    S_0 = w + A T' p_1 - u_0.

As A is symmetric, p_1 . T A p_0 = p_0 . A T' p_1, and the elastic parts of both halves add up to

    -(p_1 . A p_1 - p_0 . A p_0) / 2,

the change of the elastic energy: work supplied = work of friction + change of energy, for every T
and any d. Pressure and normal displacement of dissimilar bodies enter alike.

For distances of a full number of elements T moves nodes onto nodes, and both halves belong to one
set of particles: their mean traction does the work. At other distances the mean of p_1 and T p_0
does not: T' T is less than one for fields that change from node to node, above all at the trailing
edge.

See `operators.kinematics` for the slip of a step. A step depends only on the pressure, tractions
and gap of the step before.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from tractive_sam.compute import ConvolutionMeter, Mirror
from tractive_sam.contact.memory import Memory, Recalling, Remembered, displace, loads_of
from tractive_sam.contact.model import Model
from tractive_sam.contact.particles import Particles, StepWork
from tractive_sam.contact.solution import solve_problem, state_of
from tractive_sam.mechanics import (
    FrictionLaw,
    FrictionOnMesh,
    PreviousShare,
    RelaxingHalfSpaces,
    WearConditions,
    WearLaw,
)
from tractive_sam.operators import Advection, FrictionSlip, RollingStep
from tractive_sam.results import Cost, Grid, State, Status, widen_field
from tractive_sam.solvers import (
    PRESSURE_ONLY,
    NormalProblem,
    Note,
    OnHalfMesh,
    Outcome,
    Problem,
    Start,
    needed,
)

Three = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class StepInput:
    """Prescribed quantities of a time step: distance, creepages or forces, load, friction.

    Attributes
    ----------
    distance : float
        Rolling distance, mm; 0: a shift.
    creepages : tuple of float
        Longitudinal, lateral and spin creepage, means over the distance; for a shift the shifts in
        x and y, mm, and the turn, radians. A creepage with a prescribed force is ignored.
    load, approach : float or None
        Normal load, N, or approach, mm, at the end of the step.
    forces : tuple of float or None
        (Q_x, Q_y) at the end, N, in place of creepages.
    friction : float
        Factor on the bound of friction at the end.
    friction_before : float, optional
        Factor at the beginning; by default the factor at the end.
    separation : ndarray, shape (n_x, n_y), or float
        Separation added to the undeformed gap at the end, mm.
    time : float
        Time that a step without distance takes, s, in which bodies may relax.
    """

    distance: float = 0.0
    creepages: Three = (0.0, 0.0, 0.0)
    load: float | None = None
    approach: float | None = None
    forces: tuple[float | None, float | None] = (None, None)
    friction: float = 1.0
    friction_before: float | None = None
    separation: np.ndarray | float = 0.0
    time: float = 0.0

    @property
    def mean_friction(self) -> float:
        """Mean over the step of the factor on friction, on which wear depends."""
        first = self.friction if self.friction_before is None else self.friction_before
        return (first + self.friction) / 2.0


@dataclass(frozen=True, eq=False)
class StepResult:
    """Result of a time step: the contact at its end, its work, and the wear depth.

    Attributes
    ----------
    contact : State
        The contact. Its slip and creepages are means of the step per distance rolled; for a shift
        the slip itself, mm.
    supplied : float
        Work of the forces that drive the bodies, N mm: of tangential forces and, for dissimilar
        bodies and those that relax, of the load.
    friction : float
        Work of friction, N mm.
    distance : float
        Rolling distance of the step, mm.
    shifted : bool
        Whether it was a shift.
    energy : float
        Elastic energy at the end, N mm: of the tractions, for dissimilar bodies and those that
        relax with the pressure.
    displacement : ndarray, shape (2 or 3, n_x + reach, n_y)
        Dimensionless, at the nodes of the mesh and ahead of it.
    normal : NormalProblem, optional
        Normal problem that its pressure solves, if it does not depend on tractions.
    worn : ndarray, shape (2, n_x, n_y)
        Depth that the particles of A and B at the elements lost since the start, mm.
    gained : ndarray, shape (2, n_x, n_y)
        Part of it that they lost in the step.
    deep : float
        Depth worn in the step over the largest depth that pressure can follow.
    extrapolation_error : ndarray, shape (2, n_x, n_y), optional
        Traction less its linear extrapolation from the two steps before, MPa; None without one.
    memory : Remembered, optional
        What bodies that relax remember at its end.
    bulk : ndarray, shape (2,)
        Work that A and B dissipated inside in the step, N mm.
    """

    contact: State
    supplied: float = 0.0
    friction: float = 0.0
    distance: float = 0.0
    shifted: bool = False
    energy: float = 0.0
    displacement: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)), repr=False)
    normal: NormalProblem | None = field(default=None, repr=False)
    worn: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)), repr=False)
    gained: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)), repr=False)
    deep: float = 0.0
    extrapolation_error: np.ndarray | None = field(default=None, repr=False)
    memory: Remembered | None = field(default=None, repr=False)
    bulk: np.ndarray = field(default_factory=lambda: np.zeros(2), repr=False)

    def on(self, grid: Grid) -> "StepResult":
        """Return the result on a wider mesh: depths continue behind, displacement is empty.

        Behind the former mesh the depths equal the depth at its end.
        """
        worn, gained = (widen_field(depth, grid.elements) for depth in (self.worn, self.gained))
        behind = (grid.elements[0] - self.worn.shape[1]) // 2
        worn[:, :behind] = worn[:, behind : behind + 1]
        unknown = replace(
            self, displacement=np.zeros((2, 0, 0)), normal=None, extrapolation_error=None
        )
        if self.memory is not None:
            unknown = replace(unknown, memory=self.memory.on(self.contact.grid, grid))
        return replace(unknown, contact=self.contact.on(grid), worn=worn, gained=gained)

    def since(self, earlier: "StepResult | None") -> "StepResult":
        """Return this step less the work, distance and wear of `earlier`, a shorter step."""
        if earlier is None:
            return self
        return replace(
            self,
            supplied=self.supplied - earlier.supplied,
            friction=self.friction - earlier.friction,
            distance=self.distance - earlier.distance,
            gained=self.gained - earlier.gained,
            bulk=self.bulk - earlier.bulk,
        )


@dataclass(frozen=True, eq=False)
class StepWear:
    """Wear of both bodies in one time step: the depths that sliding particles lose.

    Attributes
    ----------
    model : Model
        The scene in numbers.
    law : WearLaw
        The law of wear on its mesh.
    """

    model: Model
    law: WearLaw

    deepest: ClassVar[float] = 1.0
    """Allowed depth of a step over the elastic depth of a ripple as short as the elements."""

    def add_wear(
        self,
        inputs: StepInput,
        result: StepResult,
        advection: Advection,
        friction: FrictionLaw,
        groups: tuple[Particles, ...],
    ) -> StepResult:
        """Return the result of a step with the depths added that sliding particles lose, mm.

        Parameters
        ----------
        inputs : StepInput
            Prescribed quantities of the step.
        result : StepResult
            The step, with the depths before it.
        advection : Advection
            Distance that its particles moved.
        friction : FrictionLaw
            The friction law of the step.
        groups : tuple of Particles
            The particles with tractions that do work.
        """
        gained, deep = np.zeros_like(result.worn), 0.0
        grid = self.model.grid
        law = self.law.with_friction(friction, grid.x[:, None], grid.y[None, :])
        law = law.weakened(inputs.mean_friction)
        law = law.under(WearConditions(result.contact.wear, math.nan))
        if not advection.length:
            groups = tuple(self._with_last_traction(result, group) for group in groups)
        for group in groups:
            depth = self._depths(inputs, group, law)
            deep = max(deep, self._relative_depth(group.pressure, depth))
            gained += group.weight * (advection.move_depths(depth) if group.earlier else depth)
        worn = result.worn + gained
        contact = replace(result.contact, wear=self.model.add_initial_wear(worn.sum(axis=0)))
        if deep > 1.0:
            note = (
                "the wear of a step is too deep for the pressure to follow: lower transient.step "
                "or wear.intensity (wear.coefficient)"
            )
            contact = replace(contact, status=Status.OUT_OF_ITERATIONS, note=note)
        return replace(result, contact=contact, worn=worn, gained=gained, deep=deep)

    def _with_last_traction(self, result: StepResult, particles: Particles) -> Particles:
        """Return particles with the last traction of the shift, scaled to the pressure of each.

        They slip with that traction. If it turned in the shift, the mean traction does not oppose
        the slip.
        """
        last, pressure = result.contact.pressure, particles.pressure
        share = np.divide(pressure, last, out=np.zeros_like(last), where=last > 0.0)
        fields = self.model.scaled_fields(result.contact)
        return replace(particles, fields=np.where(last > 0.0, share * fields, particles.fields))

    def _depths(self, inputs: StepInput, particles: Particles, law: WearLaw) -> np.ndarray:
        """Return the depths that particles lose in a step from A and B, shape (2, n_x, n_y), mm.

        They follow from the pressure, the traction and the slip of each particle. A law that
        depends on the work of friction wears exactly by `StepResult.friction` if the bodies roll. A
        shift wears as if it rolled the length of an element, which matters only to a law that is
        not linear in the slip.
        """
        model, units = self.model, self.model.units
        distance = inputs.distance or model.grid.dx
        slipped = particles.wearing * particles.slip
        slip = units.slip * model.grid.dx / distance * model.frame.slip_to_physical(slipped)
        traction = units.pressure * model.frame.to_physical(particles.traction)
        return distance * law.rates(model.scene.wear_share, particles.pressure, traction, slip)

    def _relative_depth(self, pressure: np.ndarray, gained: np.ndarray) -> float:
        """Return the largest ratio of a step's wear to its stable limit; ripples grow above 1.

        The gap of a step contains the wear w' = 2 w_1 - w_2 that is extrapolated from one (w_1) and
        two (w_2) steps before. Pressure responds to a ripple of it by its stiffness. The mean
        pressure of a step then wears w = w_1 - r (w' + w_1')/2, with r the depth of a step over the
        elastic depth of the ripple: beyond r = 1.15 ripples grow.
        """
        units, operators = self.model.units, self.model.operators
        elastic = operators.ripple_compliance * units.gap * pressure / units.pressure
        worn = gained.sum(axis=0)
        return float(np.max(worn[worn > 0.0] / (self.deepest * elastic[worn > 0.0]), initial=0.0))


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
        self.memory = Memory(model) if isinstance(model.elasticity, RelaxingHalfSpaces) else None
        self.at_once = self.operators if self.memory is None else self.memory.operators()
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
        recalling = None
        if self.memory is not None:
            past = needed(before.memory, "before.memory"), loads_of(before.contact)
            recalling = self.memory.recall(*past, advection.length, inputs.time)
        problem = self._problem(inputs, rigid, kinematics, law, depth.sum(axis=0), recalling)
        start = self._start(problem, before, motion, inputs, expected, earlier, ratio)
        outcome = self._solve(problem, start, advection.length)
        result, cost = self._result(inputs, advection, problem, outcome, worn), outcome.cost
        if result.contact.converged:
            if len(problem.forces):
                slip = problem.forces.slip(needed(outcome.creepage, "outcome.creepage"))
                motion = replace(motion, rigid=motion.rigid + slip, computed=slip)
            result, groups = self._with_work(before, inputs, result, motion, recalling)
            between = advection.part and self.model.elasticity.coupled  # _later_displacement
            cost += Cost(2.0 if between else 1.0)  # for the displacement
            if self.wear is not None:
                result = self.wear.add_wear(inputs, result, advection, law, groups)
        contact = result.contact.with_cost(replace(cost, **meter.work))
        contact.reuse_values(before.contact)
        missed = contact.traction - expected if ratio > 0.0 else None
        return replace(result, contact=contact, extrapolation_error=missed)

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
        if self.memory is not None or self.model.elasticity.coupled:
            moved = self.displacement(result, 0)
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
        recalling: Recalling | None = None,
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
        operators, gap = self.at_once, undeformed / units.gap
        if self.memory is not None and recalling is not None:
            operators = self.memory.operators(recalling.size)
            moved = self.memory.displacement(recalling.carried).sum(axis=0)
            moved = self.memory.scaled(moved)
            gap, rigid = gap + moved[0], rigid + moved[1:]
        return Problem(
            NormalProblem(operators, gap, load, approach),
            rigid,
            FrictionOnMesh(law, x, y, units.pressure, slip_unit),
            model.forces_of(inputs.forces),
            kinematics=kinematics,
        )

    def press(self, inputs: StepInput) -> State:
        """Solve the contact under the load of a step without traction; creepages are ignored."""
        model, none = self.model, np.zeros((2, *self.model.grid.elements))
        problem = self._problem(inputs, none, RollingStep(model.stencil), model.friction_law)
        outcome = OnHalfMesh(PRESSURE_ONLY).solve(problem, model.scene.solver.tolerance)
        depth = model.add_initial_wear(0.0)
        return state_of(model, problem, outcome, none, (0.0, 0.0, 0.0), depth)

    def at_rest(self, contact: State, steady: bool = False) -> StepResult:
        """Return a contact as the step before the first one, with its energy and displacements.

        Bodies that relax have rolled steadily (`steady`), or were just pressed together.
        """
        none = np.zeros((2, *self.model.grid.elements))
        result = StepResult(contact, worn=none, gained=none)
        if self.memory is not None:
            result = replace(result, memory=self.memory.begin(loads_of(result.contact), steady))
        result = replace(result, displacement=self.displacement(result, 1))
        return replace(result, energy=self._energy(result))

    def displacement(self, result: StepResult, reach: int) -> np.ndarray:
        """Return dimensionless displacements of a step at the nodes and at `reach` nodes ahead."""
        nx = self.model.grid.elements[0]
        if result.displacement.shape[1] >= nx + reach:
            return result.displacement[:, : nx + reach]
        fields = self.model.scaled_fields(result.contact)
        # Solved on the upper half, they are equal on both.
        alike = len(fields) == 2 and self.operators.keep_symmetry
        mirror = Mirror.of(fields) if alike else None
        first = 0 if mirror is None else fields.shape[2] // 2
        nodes = np.zeros((len(fields), nx + reach, fields.shape[2] - first))
        nodes[:, :nx] = fields[..., first:]
        operators = self.at_once
        if reach or mirror:
            operators = operators.part(nodes.shape[1:], mirror, first)
        moved = displace(operators, nodes)
        if self.memory is not None and result.memory is not None:
            memory = self.memory.moved(result.memory, loads_of(result.contact), reach)
            by_memory = memory.moved[:, :, : nx + reach].sum(axis=0)
            return moved + self.memory.scaled(by_memory)
        return moved if mirror is None else mirror.unfold(moved)

    def _energy(self, result: StepResult) -> float:
        """Return the elastic energy at the end of a step, N mm, with that of a memory's springs."""
        fields, displacement = self.model.scaled_fields(result.contact), result.displacement
        if self.memory is None or result.memory is None:
            return self.work.energy(fields, displacement)
        columns = fields.shape[1]
        moved = self.memory.scaled(result.memory.moved[:, :, :columns].sum(axis=0))
        at_once = self.work.energy(fields, displacement[:, :columns] - moved)
        return at_once + float(result.memory.stored.sum())

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
        if (
            before.normal is not None
            and last.touching.any()
            and problem.free_pressure.is_the_same_as(before.normal)
        ):
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
        self,
        before: StepResult,
        inputs: StepInput,
        result: StepResult,
        motion: ParticleMotion,
        recalling: Recalling | None,
    ) -> tuple[StepResult, tuple[Particles, ...]]:
        """Return a step with its work and elastic energy, and the particles that wear.

        See `step_work`.
        """
        work, ahead = self.work, max(motion.advection.reach, 1)
        if self.memory is not None and recalling is not None:
            past = needed(before.memory, "before.memory"), loads_of(before.contact)
            last = self.memory.after(*past, recalling, loads_of(result.contact), ahead)
            result = replace(result, memory=last)
        result = replace(result, displacement=self.displacement(result, ahead))
        groups = self._particles(before, inputs, result, motion)
        if self.memory is not None:
            result = replace(result, bulk=self._bulk(before, result, groups))
        energy = self._energy(result)
        supplied, friction = work.supplied(groups), work.friction(groups)
        if motion.advection.part:
            friction = supplied - (energy - before.energy) - float(result.bulk.sum())
            groups = work.match_work(groups, friction)
        return replace(result, supplied=supplied, friction=friction, energy=energy), groups

    def _bulk(
        self, before: StepResult, result: StepResult, groups: Iterable[Particles]
    ) -> np.ndarray:
        """Return the work that A and B dissipated inside in a step, N mm, shape (2,).

        It is what the work on the memory has not added to the energy of its springs.
        """
        memory, last = needed(self.memory, "memory"), needed(result.memory, "result.memory")
        lost = needed(before.memory, "before.memory").stored - last.stored
        for group in groups:
            moved = memory.scaled(needed(group.recalled, "group.recalled"))
            fields, work = group.fields, self.work
            each = [work.normal(fields, m) + work.tangential(fields, m) for m in moved]
            lost = lost + group.weight * np.array(each)
        return memory.by_body(lost)

    def _particles(
        self, before: StepResult, inputs: StepInput, result: StepResult, motion: ParticleMotion
    ) -> tuple[Particles, ...]:
        """Return particles that do the work of a step: one mean group, or two, before and after."""
        advection, curved, past = motion.advection, motion.curved, before.contact
        columns, fields = self.model.grid.elements[0], self.model.scaled_fields(past)
        change = result.displacement[:, :columns] - motion.displacement
        recalled, recalled_earlier = self._recalled(before, result, motion)
        pressure, last = result.contact.pressure, self.model.scaled_fields(result.contact)
        if not advection.part:
            previous = advection.previous_values(advection.with_nodes_ahead(fields), curved)
            pressed = advection.previous_values(advection.with_nodes_ahead(past.pressure), curved)
            mean = 0.5 * (pressure + pressed), 0.5 * (last + previous)
            return (Particles(*mean, change, motion.rigid, recalled=recalled),)
        after = Particles(pressure, last, change, motion.rigid, weight=0.5, recalled=recalled)
        moves = advection.spread((~result.contact.sticking).astype(float), np.zeros_like(curved))
        earlier = Particles(
            past.pressure,
            fields,
            self._later_displacement(result, motion) - self.displacement(before, 0)[:, :columns],
            self.rigid_slip(inputs, advection, -0.5 * advection.length) + motion.computed,
            earlier=True,
            weight=0.5,
            wearing=(moves[:columns] > 0.0).astype(float),
            recalled=recalled_earlier,
        )
        return after, earlier

    def _recalled(
        self, before: StepResult, result: StepResult, motion: ParticleMotion
    ) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Return changes by the memory of each term, mm, of particles at nodes after and before."""
        if self.memory is None or before.memory is None or result.memory is None:
            return None, None
        advection, columns = motion.advection, self.model.grid.elements[0]
        past = self.memory.moved(before.memory, loads_of(before.contact), advection.reach).moved
        last = result.memory.moved[:, :, :columns]
        nodes = past[:, :, : columns + advection.reach]
        changed = last - advection.previous_values(nodes, motion.curved)
        return changed, advection.after(last) - past[:, :, :columns]

    def _later_displacement(self, result: StepResult, motion: ParticleMotion) -> np.ndarray:
        """Return displacements after a step of the particles that were at the nodes before it.

        For dissimilar bodies the adjoint of the interpolation, as the pressure does work on them.
        For bodies of equal material they only distribute the wear, and linear interpolation
        suffices, without an application of an operator.
        """
        columns = self.model.grid.elements[0]
        fields = self.model.scaled_fields(result.contact)
        if len(fields) == 2:
            return motion.advection.after(result.displacement[:, :columns])
        spread = motion.advection.spread(fields, motion.curved)
        moved = displace(self.at_once.part(spread.shape[1:]), spread)[:, :columns]
        if self.memory is not None and result.memory is not None:
            recalled = result.memory.moved[:, :, :columns].sum(axis=0)
            moved = moved + self.memory.scaled(motion.advection.after(recalled))
        return moved


def _without_contact(problem: Problem, outcome: Outcome) -> Outcome:
    """Return the outcome of separate bodies: failed if forces other than 0 are prescribed."""
    none = np.zeros(len(problem.forces))
    if not problem.forces.target.any():
        return replace(outcome, creepage=none)
    note = Note("the bodies have separated and carry no force", Status.DIVERGED)
    return replace(outcome, status=Status.DIVERGED, residual=1.0, creepage=none, trace=(note,))
