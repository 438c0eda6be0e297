"""One step of transient rolling, or a shift, solved and put back into mm, N and MPa.

See `operators.kinematics` for the slip of a step. Of the past a step knows only the step before:
its pressure, tractions and gap.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.contact.measured import sampled
from tractive_sam.contact.model import Model
from tractive_sam.contact.solution import solve_problem, state_of
from tractive_sam.contact.step_work import Particles, StepWork
from tractive_sam.mechanics import Friction, FrictionLaw, PreviousShare, WearConditions, WearLaw
from tractive_sam.operators import Advection, ConvolutionMeter, RollingStep
from tractive_sam.results import Cost, Grid, State, Status, widened
from tractive_sam.solvers import (
    ALONE,
    NormalProblem,
    Note,
    Outcome,
    Problem,
    Start,
)


def travelled(model: Model, distance: float) -> np.ndarray | float:
    """What the profiles fixed to the bodies add to the gap after a distance, mm."""
    grid, added = model.grid, 0.0
    for x, y, separation in model.profiles:
        at_x = np.clip(grid.x + distance, x[0], x[-1])
        added = added + sampled((x, y, separation), at_x, np.clip(grid.y, y[0], y[-1]))
    return added


Three = tuple[float, float, float]

MOST_WORN = 1.0
"""Depth that a step may wear over the elastic depth of a ripple as short as elements are."""

TOO_DEEP = (
    "the wear of a step is too deep for the contact to answer to: lower transient.step or "
    "wear.intensity (wear.coefficient)"
)


@dataclass(frozen=True, eq=False)
class Asked:
    """What a step is asked to do.

    Attributes
    ----------
    distance : float
        Advection rolled, mm; 0: a shift.
    creepages : tuple of float
        Longitudinal, lateral and spin creepage, means over the way; of a shift the shifts in x and
        y, mm, and the turn, radians. Where a force is given, that one does not count.
    load, approach : float or None
        Normal load, N, or approach, mm, at the end of the step.
    forces : tuple of float or None
        (Q_x, Q_y) at the end, N, in place of creepages.
    friction : float
        Factor on the bound of friction at the end.
    friction_before : float, optional
        The same at the beginning; by default that at the end.
    separation : ndarray, shape (n_x, n_y), or float
        What is added to the undeformed gap at the end, mm.
    """

    distance: float = 0.0
    creepages: Three = (0.0, 0.0, 0.0)
    load: float | None = None
    approach: float | None = None
    forces: tuple[float | None, float | None] = (None, None)
    friction: float = 1.0
    friction_before: float | None = None
    separation: np.ndarray | float = 0.0

    @property
    def mean_friction(self) -> float:
        """Factor on the bound of friction on the mean of the way: what wears goes by it."""
        first = self.friction if self.friction_before is None else self.friction_before
        return (first + self.friction) / 2.0


@dataclass(frozen=True, eq=False)
class Stepped:
    """A contact at the end of a step, and the work of the step.

    Attributes
    ----------
    contact : State
        Its slip is the mean one of the step per distance rolled; of a shift the slip itself, mm.
        Likewise its creepages, with those that were found.
    supplied : float
        Work of what drives the bodies, N mm: by tangential forces and, of dissimilar bodies, by the
        load.
    friction : float
        Work of friction, N mm.
    distance : float
        Advection rolled in the step, mm.
    shifted : bool
        Whether it was a shift.
    energy : float
        Elastic energy at the end, N mm: of the tractions, of dissimilar bodies with the pressure.
    displacement : ndarray, shape (2 or 3, n_x + reach, n_y)
        Dimensionless, at the nodes of the mesh and ahead of it.
    normal : NormalProblem, optional
        What its pressure solves, where tractions do not change that.
    worn : ndarray, shape (2, n_x, n_y)
        Depth worn since the start off the particles of A and B that are at the elements, mm.
    gained : ndarray, shape (2, n_x, n_y)
        What of it the step wore.
    deep : float
        What the step wore over the most that pressure can answer to.
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

    def on(self, grid: Grid) -> "Stepped":
        """The same on a wider mesh of the same elements, see `State.on`.

        What has passed the mesh is as deep as at its end.
        """
        worn, gained = (widened(one, grid.elements) for one in (self.worn, self.gained))
        behind = (grid.elements[0] - self.worn.shape[1]) // 2
        worn[:, :behind] = worn[:, behind : behind + 1]
        of_mesh = {"displacement": np.zeros((2, 0, 0)), "normal": None}
        return replace(self, contact=self.contact.on(grid), worn=worn, gained=gained, **of_mesh)

    def since(self, earlier: "Stepped | None") -> "Stepped":
        """Return the step with what it did after a shorter step from the same contact."""
        if earlier is None:
            return self
        return replace(
            self,
            supplied=self.supplied - earlier.supplied,
            friction=self.friction - earlier.friction,
            distance=self.distance - earlier.distance,
            gained=self.gained - earlier.gained,
        )

    def presses_like(self, normal: NormalProblem) -> bool:
        """Whether its pressure is known to solve a normal problem."""
        known = self.normal is not None and self.contact.touching.any()
        return bool(known and normal.is_the_same_as(self.normal))


@dataclass(frozen=True, eq=False)
class Carriage:
    """How particles came to the nodes in a step.

    Attributes
    ----------
    way : Advection
        Their way.
    held : ndarray of bool, shape (n_x, n_y)
        Which of them are interpolated by a parabola, see `Advection.before`.
    displacement : ndarray, shape (2 or 3, n_x, n_y)
        Dimensionless displacements that they had before.
    rigid : ndarray, shape (2, n_x, n_y)
        Slip of the undeformed bodies, dimensionless.
    found : ndarray or float
        The part of it that was found where a force is given.
    law : FrictionLaw
        That of friction at rest, with what the particles remember.
    """

    way: Advection
    held: np.ndarray
    displacement: np.ndarray
    rigid: np.ndarray
    found: np.ndarray | float
    law: FrictionLaw


class Stepper:
    """Takes steps of a model, each from the one before.

    Parameters
    ----------
    model : Model
        The scene in numbers; what a step asks takes the place of its load, creepages and forces.

    Raises
    ------
    ValueError
        If there is an interfacial layer.
    """

    def __init__(self, model: Model):
        if model.elasticity.layer:
            raise ValueError("laws: a transient takes no interfacial layer")
        self.model, self.wear_law, self.work = model, model.wear_law, StepWork(model)
        self.operators = model.operators

    def step(
        self, before: Stepped, asked: Asked, earlier: Stepped | None = None, ratio: float = 0.0
    ) -> Stepped:
        """Take a step.

        Parameters
        ----------
        before : Stepped
            The one before.
        asked : Asked
            What is asked.
        earlier : Stepped, optional
            The one before that: what the first guess is extrapolated from. With a negative ratio
            the end of a longer step: the first guess is interpolated.
        ratio : float
            Length of the step over that of the one before, or minus that over the longer one.

        Returns
        -------
        Stepped
            Converged or not: see its contact.
        """
        meter = ConvolutionMeter(self.model.operators.lattice.padded)
        now = self._taken(before, asked, earlier, ratio)
        return replace(now, contact=now.contact.with_convolutions(meter.convolutions))

    def _taken(
        self, before: Stepped, asked: Asked, earlier: Stepped | None, ratio: float
    ) -> Stepped:
        model, grid = self.model, self.model.grid
        way = Advection.from_distance(asked.distance / grid.dx)
        past, displacement = before.contact, self._displacement(before, way.reach)
        touching = _ahead(past.pressure, way.reach) > 0.0
        held = way.held(touching) & model.stencil.staggered
        rigid = self._rigid(asked, way, way.middle(held))
        came = way.before(displacement, held)

        worn = way.carried(before.worn)
        expected = worn + self._expected(before, earlier, ratio)
        gap = np.where(past.touching, 0.0, past.gap) / model.units.gap
        ahead = _ahead(gap, way.reach, edge=True)
        law = self._law(before, asked, way)
        problem = replace(
            self._problem(asked, expected.sum(axis=0), law),
            rigid=rigid - came[-2:],
            forces=model.forces_of(asked.forces),
            kinematics=RollingStep(
                model.stencil, self._entering(way.before(ahead, held), ahead), way.length
            ),
        )
        start = self._start(before, way, asked, earlier, ratio)
        if before.presses_like(problem.normal):
            pressure, height = past.pressure / model.units.pressure, past.gap / model.units.gap
            approach = past.approach / model.units.gap
            start = replace(start, pressure=pressure, gap=height, approach=approach)
        outcome = solve_problem(model, problem, model.scene.solver.tolerance, start)
        if outcome.top is not None:  # its creepage is over an element's length, like the slip
            force, creepage = outcome.top
            outcome = replace(outcome, top=(force, creepage / way.length))
        if len(problem.forces) and outcome.creepage is None:
            outcome = _without_contact(problem, outcome)
        now = self._ended(asked, way, problem, outcome, worn)
        if not now.contact.converged:
            return now
        found = problem.forces.slip(outcome.creepage) if len(problem.forces) else 0.0
        carried = Carriage(way, held, came, rigid + found, found, law)
        return self._worked(before, asked, now, carried)

    def _entering(self, gap: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        """Return the gap that particles close before they are held in a step, dimensionless.

        Upwind slip holds a particle from the first node ahead of the contact on: in steps of one
        element from where it was, and it closes nothing.

        Parameters
        ----------
        gap : ndarray, shape (n_x, n_y)
            Gap of the particles before the step.
        nodes : ndarray, shape (n_x + reach, n_y)
            Gap at the nodes before it.
        """
        if self.model.stencil.staggered:
            return gap
        edge = nodes.copy()
        for i in range(len(nodes) - 2, -1, -1):
            edge[i] = np.where(nodes[i] > 0.0, nodes[i], edge[i + 1])
        return np.maximum(gap - edge[: len(gap)], 0.0)

    def _expected(
        self, before: Stepped, earlier: Stepped | None, ratio: float
    ) -> np.ndarray | float:
        """Return the depths that a step is expected to wear, mm; arguments as of `step`."""
        if earlier is None:
            return 0.0
        return ratio * before.gained if ratio >= 0.0 else -ratio * earlier.gained

    def open_beside(self, stepped: Stepped, separation: np.ndarray | float) -> Stepped:
        """A step whose mesh was widened, with the gap and the wear beside the mesh that it had."""
        contact, units = stepped.contact, self.model.units
        unknown = np.isinf(contact.gap)
        if not unknown.any():
            return stepped
        depth, fields = self.off(stepped.worn.sum(axis=0)), self._fields(contact)
        pressed = (contact.pressure / units.pressure)[None]
        coupled = self.model.elasticity.coupled
        moved = self.operators.coupled(fields) if coupled else self.operators.normal(pressed)
        undeformed = self.model.undeformed_gap + separation + depth
        gap = undeformed + units.gap * moved[0] - contact.approach
        contact = replace(contact, gap=np.where(unknown, gap, contact.gap), wear=depth)
        return replace(stepped, contact=contact)

    def _law(self, before: Stepped, asked: Asked, way: Advection) -> FrictionLaw:
        """Return the law of friction in a step, with what its particles remember.

        Raises
        ------
        ValueError
            If the law falls with the speed of sliding, and a shift has none.
        """
        law, grid, past = self.model.friction_law, self.model.grid, before.contact
        if not law.falls:
            return law
        if not way.length:
            raise ValueError(
                "laws.friction: friction falls with the speed of sliding, and a shift (a step of "
                "no distance) has none; roll a short distance in its place"
            )
        rest = law.weakened(asked.friction_before or asked.friction).bound(
            past.pressure, grid.x[:, None], grid.y[None, :]
        )
        bound = past.pressure if past.traction_bound is None else past.traction_bound
        touching = rest.radius > 0.0
        lost = np.where(touching, 1.0 - bound / np.where(touching, rest.radius, 1.0), 0.0)
        return law.with_previous(
            PreviousShare(grid.x, grid.y, 1.0 - way.carried(lost), asked.distance)
        )

    def _problem(
        self, asked: Asked, worn: np.ndarray | float = 0.0, law: FrictionLaw | None = None
    ) -> Problem:
        """The normal problem and the friction of a step, with what was worn since the start."""
        model, grid, units = self.model, self.model.grid, self.model.units
        load = None if asked.load is None else asked.load / (units.pressure * grid.element_area)
        approach = 0.0 if asked.approach is None else asked.approach / units.gap
        undeformed = model.undeformed_gap + asked.separation + self.off(worn)
        law = (law or model.friction_law).weakened(asked.friction)
        x, y = grid.x[:, None], grid.y[None, :]
        # A slip of a step is over an element's length, the speed of sliding over the way rolled.
        per_way = units.slip * grid.dx / (asked.distance or grid.dx)
        return Problem(
            NormalProblem(self.operators, undeformed / units.gap, load, approach),
            np.zeros((2, *grid.elements)),
            Friction(law, x, y, units.pressure, per_way),
            kinematics=RollingStep(model.stencil),
        )

    def off(self, worn: np.ndarray | float) -> np.ndarray:
        """Depth worn off both bodies, with that before the start, mm."""
        began = self.model.worn_before
        return np.zeros(self.model.grid.elements) + worn + (0.0 if began is None else began)

    def pressed(self, asked: Asked) -> State:
        """The bodies pressed together without traction, whatever else is asked for."""
        problem = self._problem(asked)
        outcome = ALONE.solve(problem, self.model.scene.solver.tolerance)
        slip = np.zeros_like(problem.rigid)
        creepages, depth = (0.0, 0.0, 0.0), self.off(0.0)
        return state_of(self.model, problem, outcome, slip, creepages, depth)

    def at_rest(self, contact: State) -> Stepped:
        """A contact from which steps may be taken: its energy and displacements."""
        displacement = self._displacement(Stepped(contact), 0)
        energy, none = self.work.energy(self._fields(contact), displacement), self._unworn
        return Stepped(contact, energy=energy, displacement=displacement, worn=none, gained=none)

    @property
    def _unworn(self) -> np.ndarray:
        return np.zeros((2, *self.model.grid.elements))

    def _fields(self, contact: State) -> np.ndarray:
        """Dimensionless tractions of a contact; of dissimilar bodies after the pressure."""
        unit = self.model.units.pressure
        traction = self.model.frame.to_scaled(contact.traction) / unit
        if not self.model.elasticity.coupled:
            return traction
        return np.concatenate((contact.pressure[None] / unit, traction))

    def _displacement(self, of: Stepped, reach: int) -> np.ndarray:
        """Dimensionless displacements at the nodes of the mesh and ahead of it."""
        nx = self.model.grid.elements[0]
        if of.displacement.shape[1] >= nx + reach:
            return of.displacement[:, : nx + reach]
        fields = _ahead(self._fields(of.contact), reach)
        operators = self.operators.part(fields.shape[1:]) if reach else self.operators
        return (operators.coupled_displacement if len(fields) == 3 else operators.tangential)(
            fields
        )

    def _rigid(self, asked: Asked, way: Advection, middle: np.ndarray | float) -> np.ndarray:
        """Slip of the undeformed bodies in a step, dimensionless, shape (2, n_x, n_y).

        Parameters
        ----------
        asked : Asked
            Creepages of the step; one in place of which a force is given does not count.
        way : Advection
            Its length.
        middle : ndarray, shape (n_x, n_y), or float
            Distance from the nodes to the places where the rigid slip is taken, in elements.
        """
        model, grid = self.model, self.model.grid
        given = [
            0.0 if force is not None else one
            for one, force in zip(asked.creepages, (*asked.forces, None), strict=True)
        ]
        if not model.stencil.staggered and way.length:
            middle = middle - 0.5
        x, y = grid.x[:, None] + grid.dx * middle, grid.y[None, :]
        longitudinal, lateral, spin = given
        slip = np.stack(np.broadcast_arrays(longitudinal - spin * y, lateral + spin * x))
        over = way.length if asked.distance else 1.0 / grid.dx
        return model.frame.slip_to_scaled(slip) * (over / model.units.slip)

    def _start(
        self, before: Stepped, way: Advection, asked: Asked, earlier: Stepped | None, ratio: float
    ) -> Start:
        """Where the solution is sought first: on the line through the two steps before."""
        units, frame, columns = self.model.units, self.model.frame, self.model.grid.elements[0]
        over = (way.length or 1.0 / self.model.grid.dx) / units.slip
        first, share = (before, 0.0) if earlier is None else (earlier, ratio)

        def extrapolate(of: Callable[[Stepped], Any]) -> Any:
            now = of(before)
            return now + share * (now - of(first)) if share else now

        pressure = extrapolate(lambda one: one.contact.pressure)
        found = [
            extrapolate(lambda one, k=k: getattr(one.contact, k))
            for k, force in zip(("xi_x", "xi_y"), asked.forces, strict=True)
            if force is not None
        ]
        response = extrapolate(lambda one: self._displacement(one, 0)[:, :columns])
        pulled = pressure < 0.0
        coupled = self.model.elasticity.coupled
        return Start(
            np.maximum(pressure, 0.0) / units.pressure,
            frame.to_scaled(extrapolate(lambda one: one.contact.traction)) / units.pressure,
            extrapolate(lambda one: one.contact.approach) / units.gap,
            np.nan_to_num(found) * over,
            None if coupled and pulled.any() else response,
        )

    def _ended(
        self, asked: Asked, way: Advection, problem: Problem, outcome: Outcome, worn: np.ndarray
    ) -> Stepped:
        """Return the contact at the end of a step in mm, N and MPa, without its work."""
        model, units = self.model, self.model.units
        known = [k for k in (0, 1) if asked.forces[k] is not None]
        creepages = list(asked.creepages)
        over = way.length or 1.0 / model.grid.dx
        for k, value in zip(known, outcome.creepage if known else (), strict=True):
            creepages[k] = float(value) * units.slip / over
        slip = units.slip / over * model.frame.slip_to_physical(outcome.slip)
        if way.length:
            slip = model.stencil.at_centres(slip)
        depth = self.off(worn.sum(axis=0))
        contact = state_of(model, problem, outcome, slip, tuple(creepages), depth)
        return Stepped(
            contact,
            distance=asked.distance,
            shifted=not asked.distance,
            normal=None if model.elasticity.coupled else problem.normal,
            worn=worn,
            gained=self._unworn,
        )

    def _worked(self, before: Stepped, asked: Asked, now: Stepped, carried: Carriage) -> Stepped:
        """Return a step with its work, its energy and what it wears, see `step_work`."""
        way, work = carried.way, self.work
        displacement = self._displacement(now, max(way.reach, 1))
        further = way.part and self.model.elasticity.coupled  # see _later
        cost = now.contact.cost + Cost(2.0 if further else 1.0)  # for the displacement
        now = replace(now, contact=replace(now.contact, cost=cost), displacement=displacement)
        groups = self._particles(before, asked, now, carried)
        energy = work.energy(self._fields(now.contact), displacement)
        supplied, friction = work.supplied(groups), work.friction(groups)
        if way.part:
            friction = supplied - (energy - before.energy)
            groups = work.matched(groups, friction)
        now = replace(now, supplied=supplied, friction=friction, energy=energy)
        return now if self.wear_law is None else self._wear(asked, now, carried, groups)

    def _particles(
        self, before: Stepped, asked: Asked, now: Stepped, carried: Carriage
    ) -> tuple[Particles, ...]:
        """Return the particles whose tractions do the work of a step."""
        way, held, past = carried.way, carried.held, before.contact
        columns, fields = self.model.grid.elements[0], self._fields(past)
        change = now.displacement[:, :columns] - carried.displacement
        after = Particles(now.contact.pressure, self._fields(now.contact), change, carried.rigid)
        if not way.part:
            came = way.before(_ahead(fields, way.reach), held)
            pressed = way.before(_ahead(past.pressure[None], way.reach), held)[0]
            mean = 0.5 * (after.pressure + pressed), 0.5 * (after.fields + came)
            return (replace(after, pressure=mean[0], fields=mean[1]),)
        moves = way.spread((~now.contact.sticking).astype(float), np.zeros_like(held))
        earlier = Particles(
            past.pressure,
            fields,
            self._later(now, way, held) - self._displacement(before, 0)[:, :columns],
            self._rigid(asked, way, -0.5 * way.length) + carried.found,
            earlier=True,
            wearing=(moves[:columns] > 0.0).astype(float),
        )
        return replace(after, weight=0.5), replace(earlier, weight=0.5)

    def _later(self, now: Stepped, way: Advection, held: np.ndarray) -> np.ndarray:
        """Displacements after a step of the particles that were at the nodes before it.

        Of dissimilar bodies the adjoint of the interpolation, as the pressure does work on them. Of
        alike ones a straight line, which takes no application: they only distribute the wear.
        """
        columns = self.model.grid.elements[0]
        if not self.model.elasticity.coupled:
            return way.after(now.displacement[:, :columns])
        spread = way.spread(self._fields(now.contact), held)
        return self.operators.part(spread.shape[1:]).coupled_displacement(spread)[:, :columns]

    def _wear(
        self, asked: Asked, now: Stepped, carried: Carriage, groups: tuple[Particles, ...]
    ) -> Stepped:
        """Return a step with what its particles wear off."""
        gained, deep, way = self._unworn, 0.0, carried.way
        law = self.wear_law.with_friction(carried.law).weakened(asked.mean_friction)
        law = law.under(WearConditions(now.contact.wear, math.nan))
        for one in groups:
            depth = self._gained(asked, self._rubbing(now, one, way), law)
            deep = max(deep, self._deep(one.pressure, depth))
            gained += one.weight * (way.carried(depth) if one.earlier else depth)
        worn = now.worn + gained
        contact = replace(now.contact, wear=self.off(worn.sum(axis=0)))
        if deep > 1.0:
            contact = replace(contact, status=Status.OUT_OF_ITERATIONS, note=TOO_DEEP)
        return replace(now, contact=contact, worn=worn, gained=gained, deep=deep)

    def _rubbing(self, now: Stepped, particles: Particles, way: Advection) -> Particles:
        """Return particles with the tractions that wear.

        A shift slips with the traction that it ends with: where that has turned round on the way,
        its mean opposes neither.
        """
        if way.length:
            return particles
        last, pressure = now.contact.pressure, particles.pressure
        share = np.divide(pressure, last, out=np.zeros_like(last), where=last > 0.0)
        ending = np.where(last > 0.0, share * self._fields(now.contact), particles.fields)
        return replace(particles, fields=ending)

    def _gained(self, asked: Asked, particles: Particles, law: WearLaw) -> np.ndarray:
        """Depths that a step wears off A and B, shape (2, n_x, n_y), mm.

        Of each particle by its pressure, its traction, and all that it has slipped. A law that
        depends on the work of friction wears exactly by `Stepped.friction` where bodies roll. A
        shift wears as if it rolled the length of an element, which matters to a law that is not
        linear in the slip only.
        """
        model, units = self.model, self.model.units
        over = asked.distance or model.grid.dx
        slipped = particles.wearing * particles.slip
        slip = units.slip * model.grid.dx / over * model.frame.slip_to_physical(slipped)
        traction = units.pressure * model.frame.to_physical(particles.traction)
        return over * law.rates(model.scene.wear_share, particles.pressure, traction, slip)

    def _deep(self, pressure: np.ndarray, gained: np.ndarray) -> float:
        """What a step wears over the most that pressure can answer to.

        The gap of a step holds the wear that those before foretell, w' = 2 w_1 - w_2, w_1 of one
        and w_2 of two steps ago. Pressure answers a ripple of it by its stiffness, and what it
        wears off, by the mean pressure of a step, is w = w_1 - r (w' + w_1')/2, r the depth of a
        step over the elastic depth of the ripple: beyond r = 1.15 ripples grow.
        """
        units = self.model.units
        elastic = self.operators.ripple_compliance * units.gap * pressure / units.pressure
        worn = gained.sum(axis=0)
        return float(np.max(worn[worn > 0.0] / (MOST_WORN * elastic[worn > 0.0]), initial=0.0))


def _without_contact(problem: Problem, outcome: Outcome) -> Outcome:
    """What comes of forces where the bodies have parted: none can be had."""
    none = np.zeros(len(problem.forces))
    if not problem.forces.target.any():
        return replace(outcome, creepage=none)
    note = Note("the bodies have parted and carry no force", Status.DIVERGED)
    return replace(outcome, status=Status.DIVERGED, residual=1.0, creepage=none, trace=(note,))


def _ahead(fields: np.ndarray, reach: int, edge: bool = False) -> np.ndarray:
    """Fields with nodes ahead of the mesh: zero there, or as they are at its edge."""
    if not reach:
        return fields
    count, columns = fields.shape[-2:]
    nodes = np.zeros((*fields.shape[:-2], count + reach, columns))
    nodes[..., :count, :] = fields
    if edge:
        nodes[..., count:, :] = fields[..., -1:, :]
    return nodes
