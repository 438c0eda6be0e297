"""The numerical model of a scene: mesh, undeformed gap, rigid slip, units and operators."""

import math
from collections.abc import Callable
from copy import copy
from dataclasses import astuple, dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from tractive_sam.contact.laws import Laws
from tractive_sam.contact.measured import Gap, lowest_separation, resample, sample_gap
from tractive_sam.contact.mesh import choose_grid
from tractive_sam.mechanics import (
    Coulomb,
    Elasticity,
    FlatPatch,
    Frame,
    FrictionLaw,
    FrictionOnMesh,
    RelaxingHalfSpaces,
    WearLaw,
)
from tractive_sam.operators import (
    STAGGERED,
    UPWIND,
    Lattice,
    Operators,
    SteadyRolling,
    Stencil,
    operators_of,
)
from tractive_sam.rail import Patch
from tractive_sam.results import Grid, State
from tractive_sam.scene import Scene, WheelRail
from tractive_sam.schema import required
from tractive_sam.solvers import (
    METHODS,
    Method,
    NormalProblem,
    PrescribedForces,
    Problem,
    ProblemSolver,
    WearInPass,
)


@dataclass(frozen=True)
class Units:
    """Units of pressure, gap and slip that make a problem of order one.

    Attributes
    ----------
    pressure : float
        p*, MPa.
    gap : float
        g*, mm; for half-spaces p* l / E*, with l the mean semi-axis of the contact.
    slip : float
        s*, dimensionless; for half-spaces max(mu1, mu2)² p* / G.
    """

    pressure: float
    gap: float
    slip: float

    @classmethod
    def of_contact(
        cls,
        scene: Scene,
        grid: Grid,
        elasticity: Elasticity,
        frame: Frame,
        undeformed_gap: Callable[[], np.ndarray],
    ) -> Self:
        """Return the units of a scene, from its Hertz contact, or from the mesh without one.

        `undeformed_gap` computes the gap, mm; only a prescribed approach without Hertz needs it.
        """
        hertz, sides = scene.hertz, (grid.dx, grid.dy)
        if hertz is not None:
            length = hertz.mean_semi_axis
        elif grid.line:
            length = 0.5 * grid.half_length[0]
        else:
            length = 0.5 * math.sqrt(grid.half_length[0] * grid.half_length[1])
        gap = elasticity.gap_per_pressure(length, *sides)
        load = scene.normal_load
        if hertz is not None:
            pressure = hertz.p0
        elif load is not None:
            pressure = load / (2.0 * length if grid.line else math.pi * length**2)
        else:
            approach = required(scene.load.approach, "load.approach")
            interference = approach - float(undeformed_gap().min())
            # Without contact the unit only has to be positive.
            pressure = (abs(interference) or 1e-3 * length) / gap
        slip = max(frame.mu) ** 2 * elasticity.slip_per_traction(*sides)
        return cls(pressure, gap * pressure, slip * pressure)


@dataclass(frozen=True, eq=False)
class Worn:
    """Wear depth of both bodies across the track, with which a roll begins.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Lateral positions, ascending, mm.
    depths : ndarray, shape (2, n)
        Depths of A and of B, mm.
    """

    y: np.ndarray
    depths: np.ndarray

    def on(self, grid: Grid) -> np.ndarray:
        """Return wear depths (2, n_y), mm, interpolated at a mesh's rows; constant beyond.

        Raises
        ------
        ValueError
            If only one of the depths and the mesh belongs to a line contact.
        """
        if (self.y.size == 1) != (grid.directions == 1):
            raise ValueError("start: both runs must be line contacts, or neither")
        y = grid.y + grid.shift
        return np.stack([np.interp(y, self.y, depth) for depth in self.depths])


class Model:
    """The dimensionless contact problems of a scene on its mesh, with laws, units and operators.

    Parameters
    ----------
    scene : Scene
        Scene to model.
    measured : Gap, optional
        The measured separation that the scene's [gap] names; required if it names a file.
    grid : Grid, optional
        Mesh to use instead of the scene's.
    laws : Laws, optional
        Laws to use instead of the scene's.
    solver : ProblemSolver, optional
        Method to use instead of the scene's; it solves a `Problem` with free pressure.
    began : Worn, optional
        Worn bodies with which rolling begins; new ones by default.
    profiles : tuple of Gap
        Profiles that a [transient] fixes to the bodies.
    datum : str
        Origin of the approach: "vertex", or "node", the nearest element, which results files of
        earlier versions need to resume.
    wheel_rail : WheelRail, optional
        Geometry of worn profiles in place of the profiles of the scene.
    """

    depth_only = ("load", "approach", "undeformed_gap")
    """Cached properties that differ between the depths of a wheel."""
    patch_only = ("rigid_slip", "scaled_rigid_slip", "friction_law")
    """Other cached properties that differ between its patches."""

    def __init__(
        self,
        scene: Scene,
        measured: Gap | None = None,
        grid: Grid | None = None,
        laws: Laws | None = None,
        solver: ProblemSolver | None = None,
        began: Worn | None = None,
        profiles: tuple[Gap, ...] = (),
        datum: str = "vertex",
        wheel_rail: WheelRail | None = None,
    ):
        self.scene, self.began, self.datum = scene, began, datum
        self.laws = laws or Laws.of(scene)
        self.method = (
            METHODS[scene.solver.method] if solver is None else Method(solver, solver, repr(solver))
        )
        self._solver = solver
        self.measured, self.profiles = measured, profiles
        if wheel_rail is None and scene.wheelset is not None:
            wheel_rail = scene.wheel_rail
        self.wheel_rail = wheel_rail
        self.patch = self.wheel_rail.patches[0] if self.wheel_rail else None
        self.wheel_depth: float | None = None
        patches = self.wheel_rail.patches if self.wheel_rail else ()
        self.shape = scene.patch
        self.grid = grid or choose_grid(scene, measured, profiles, patches=patches)
        self.elasticity = self.laws.elasticity.spanning(2.0 * self.grid.half_length[0])

    def on(self, grid: Grid) -> "Model":
        """Return the model of the same scene on another mesh."""
        model = Model(
            self.scene,
            self.measured,
            grid,
            self.laws,
            self._solver,
            self.began,
            self.profiles,
            self.datum,
            self.wheel_rail,
        )
        model.patch, model.wheel_depth = self.patch, self.wheel_depth
        return model

    def with_laws(self, laws: Laws) -> "Model":
        """Return the model with another elastic law, on the same mesh; itself if it is equal."""
        if laws.elasticity == self.laws.elasticity:
            return self
        model = self.on(self.grid)
        model.laws = laws
        model.elasticity = laws.elasticity.spanning(2.0 * self.grid.half_length[0])
        return model

    def of_patch(self, patch: Patch, wheel_depth: float | None = None) -> "Model":
        """Return the model of another contact patch of a wheel on this mesh.

        Parameters
        ----------
        patch : Patch
            The patch.
        wheel_depth : float, optional
            Vertical distance of the wheel below its first touch, mm, in place of the load of the
            scene.
        """
        _ = self.operators, self.units  # computed once for all patches
        model = copy(self)
        model.patch, model.wheel_depth = patch, wheel_depth
        same = patch is self.patch
        for name in self.depth_only if same else (*self.depth_only, *self.patch_only):
            model.__dict__.pop(name, None)
        return model

    def at_pitch(self, pitch: float) -> "Model":
        """Return the model of a wheel on this mesh with another pitch of its wheelset."""
        _ = self.operators, self.units, self.undeformed_gap  # do not depend on the pitch
        model = copy(self)
        model.wheel_rail = replace(required(self.wheel_rail, "wheel"), pitch=pitch)
        for name in self.patch_only:
            model.__dict__.pop(name, None)
        return model

    @cached_property
    def approach(self) -> float | None:
        """Largest overlap of bodies, mm; None unless prescribed for a wheel or a curved patch.

        It is negative if they do not touch.
        """
        if self.wheel_depth is None:
            return None
        return -required(self.patch, "wheel").lowered(self.wheel_depth).opening

    @cached_property
    def blocks(self) -> tuple["Model", ...]:
        """Models to solve: one for each different block of [[duty]], else this model alone."""
        spectrum = self.scene.spectrum
        if spectrum is None:
            return (self,)
        return tuple(
            Model(
                scene,
                self.measured,
                self.grid.shifted(shift),
                self.laws.of_block(self.scene, scene),
                self._solver,
                self.began,
                datum=self.datum,
            )
            for scene, shift in zip(spectrum.scenes, spectrum.shifts, strict=True)
        )

    @property
    def weights(self) -> tuple[float, ...]:
        """Share of each duty block in the revolutions of a cycle; their sum is 1."""
        spectrum = self.scene.spectrum
        if spectrum is None:
            return (1.0,)
        return tuple(n / spectrum.cycle for n in spectrum.revolutions)

    def block_at(self, revolution: int) -> int:
        """Return the index of the duty block rolled at a revolution, if blocks keep their order."""
        return 0 if self.scene.spectrum is None else self.scene.spectrum.block_at(revolution)

    @property
    def initial_wear(self) -> np.ndarray | None:
        """Initial wear depth of both bodies together (n_x, n_y), mm; None for unworn bodies."""
        if self.began is None:
            return None
        return np.tile(self.began.on(self.grid).sum(axis=0), (self.grid.elements[0], 1))

    def with_friction(self, law: FrictionLaw) -> "Model":
        """Return a copy with another friction law for the same scaled frame (`Frame`).

        Both models share the elastic operators.
        """
        _ = self.operators, self.units, self.undeformed_gap  # computed once for both
        model = copy(self)
        model.laws = self.laws.replace(friction=law)
        for name in ("friction_law", "blocks"):
            model.__dict__.pop(name, None)
        return model

    @cached_property
    def undeformed_gap(self) -> np.ndarray:
        """Separation of the unworn, undeformed bodies (n_x, n_y), mm; zero at their first touch.

        The approach is counted from there: the vertex of the radii, or the lowest point of radii
        and measured gap, which may lie between elements. With ``gap.datum = "separation"`` the
        separation is not shifted.
        """
        if self.patch is not None:
            depth = self.patch.depth if self.wheel_depth is None else self.wheel_depth
            patch = self.patch.lowered(depth)
            return patch.gap(self.grid.x, self.grid.y) - patch.opening
        gap = self.shape.gap(self.grid.x[:, None], self.grid.y[None, :])
        if self.measured is not None:
            taken = resample(self.measured, self.grid)
            # Subtract first: a distance common to all elements would cost digits of the parabola.
            if self.scene.gap is None or self.scene.gap.datum == "touch":
                taken = taken - lowest_separation(
                    self.measured, self.grid, taken, self.scene.body.radii
                )
            gap = gap + taken
        return gap if self.datum == "vertex" else gap - gap.min()

    def tilted(self, tilt: float) -> "Model":
        """Return the model with rollers at an angle of their axes, mrad, beside that of the scene.

        It shares the operators and the units.
        """
        _ = self.operators, self.units
        model = copy(self)
        model.__dict__["undeformed_gap"] = self.undeformed_gap + 1e-3 * tilt * self.grid.y
        return model

    def pressed(self, approach: float) -> "Model":
        """Return the model of a curved patch at an approach, mm, along the normal at its middle.

        Beside the middle the surfaces approach less along their normal. The model shares the
        operators and the units.
        """
        _ = self.operators, self.units
        model = copy(self)
        _, normal = self.shape.normal(self.grid.x[:, None], self.grid.y[None, :])
        gap = self.undeformed_gap + approach * (1.0 - normal)
        model.__dict__ |= {"undeformed_gap": gap, "approach": approach}
        model.__dict__.pop("load", None)
        return model

    def add_initial_wear(self, worn: np.ndarray | float) -> np.ndarray:
        """Return a wear depth of both bodies plus the depth worn before the start, mm."""
        before = self.initial_wear
        return np.zeros(self.grid.elements) + worn + (0.0 if before is None else before)

    def scaled_fields(self, contact: State) -> np.ndarray:
        """Return dimensionless tractions of a contact, after the pressure if that does work.

        That of dissimilar bodies and of bodies that relax does.
        """
        traction = self.frame.to_scaled(contact.traction) / self.units.pressure
        if not (self.elasticity.coupled or isinstance(self.elasticity, RelaxingHalfSpaces)):
            return traction
        return np.concatenate((contact.pressure[None] / self.units.pressure, traction))

    def profile_offset(self, distance: float) -> np.ndarray | float:
        """Return the gap that profiles fixed to the bodies add after a rolling distance, mm."""
        grid = self.grid
        added: np.ndarray | float = 0.0
        for x, y, separation in self.profiles:
            at_x = np.clip(grid.x + distance, x[0], x[-1])
            added = added + sample_gap((x, y, separation), at_x, np.clip(grid.y, y[0], y[-1]))
        return added

    @cached_property
    def friction_law(self) -> FrictionLaw:
        """Friction law on the rows of the mesh; Coulomb's with mu = 1 without friction."""
        return (self.laws.friction or Coulomb()).on_rows(self.grid.y, self.lateral_positions)

    @property
    def lateral_positions(self) -> np.ndarray:
        """Positions y of the rows, mm: on a rail those in the track, outward; shape (n_y,)."""
        if self.patch is None:
            return self.grid.y
        height = self.patch.rail_at(np.zeros(1), self.grid.y)[0]
        y, normal = self.patch.lateral[1], self.patch.normal[1]
        return np.asarray(self.patch.origin[1] + self.grid.y * y + height * normal)

    @property
    def starts_sliding(self) -> bool:
        """Whether a falling friction law is solved from full sliding, not from rest."""
        friction = self.scene.friction
        return friction is not None and friction.start == "sliding"

    @cached_property
    def frame(self) -> Frame:
        """Scaled tribological frame of the friction law."""
        return self.friction_law.frame

    @property
    def wear_law(self) -> WearLaw | None:
        """Wear law on this mesh and for its friction; None without wear."""
        law, grid = self.laws.wear, self.grid
        if law is None:
            return None
        law = law.on(grid.element_area)
        return law.with_friction(self.friction_law, grid.x[:, None], grid.y[None, :])

    @cached_property
    def units(self) -> Units:
        """Units of pressure, gap and slip, from the Hertz contact, or from the mesh without one."""
        return Units.of_contact(
            self.scene, self.grid, self.elasticity, self.frame, lambda: self.undeformed_gap
        )

    @cached_property
    def operators(self) -> Operators:
        """Elastic operators on the mesh, dimensionless."""
        grid = self.grid
        lattice = Lattice(grid.elements, grid.dx, grid.dy, first=float(grid.y[0]))
        pressure, gap, slip = astuple(self.units)
        return operators_of(lattice, self.elasticity, gap / pressure, slip / pressure, self.frame)

    @cached_property
    def free(self) -> tuple[bool, bool]:
        """Whether xi_x and xi_y are unknown, as the force along their axis is prescribed."""
        load = self.scene.load
        return load.force_x is not None, load.force_y is not None

    @cached_property
    def transmits(self) -> bool:
        """Whether there may be tangential traction: friction, and creepage, force or coupling."""
        creepage = self.scene.creepage
        moving = creepage.longitudinal or creepage.lateral or creepage.spin
        moving = moving or any(self.free) or not self.shape.is_flat
        caused = moving or self.elasticity.coupled
        return self.laws.friction is not None and bool(caused or not self.scene.schedule.revolves)

    @property
    def stencil(self) -> Stencil:
        """Stencil from displacements to the slip of an element: upwind or staggered."""
        return UPWIND if self.scene.solver.slip == "upwind" else STAGGERED

    @cached_property
    def rigid_slip(self) -> np.ndarray:
        """Slip s/V of the undeformed bodies by the prescribed creepages, shape (2, n_x, n_y)."""
        if self._rolls_with_wheelset:
            x = self.grid.x + self.stencil.rigid_ahead * self.grid.dx
            patch, wheel_rail = required(self.patch, "wheel"), required(self.wheel_rail, "wheel")
            return patch.rigid_slip(x, self.grid.y, wheel_rail.pitch)
        ahead = self.stencil.rigid_ahead * self.grid.dx
        rolling = self.shape.rolling_slip(self.grid.x[:, None] + ahead, self.grid.y)
        return self.rigid_slip_by(*self._motion) + rolling

    @property
    def finds_pitch(self) -> bool:
        """Whether the pitch of a wheelset follows from the tractions on its wheels."""
        wheelset = self.scene.wheelset
        is_free = wheelset is not None and wheelset.pitch == "free"
        return is_free and self._rolls_with_wheelset and self.transmits

    @property
    def _rolls_with_wheelset(self) -> bool:
        """Whether the creepages of the patch follow from the motion of its wheelset."""
        scene = self.scene
        return self.patch is not None and scene.wheel_rail.is_motion(scene.creepage)

    @property
    def _motion(self) -> tuple[float, float, float]:
        """Longitudinal and lateral creepage and spin, from the wheelset or from the scene."""
        if self._rolls_with_wheelset:
            patch, wheel_rail = required(self.patch, "wheel"), required(self.wheel_rail, "wheel")
            return patch.creepages(wheel_rail.pitch)
        creepage = self.scene.creepage
        return creepage.longitudinal, creepage.lateral, creepage.spin

    def rigid_slip_by(
        self, longitudinal: float, lateral: float, spin: float, *, flat: bool = False
    ) -> np.ndarray:
        """Return the slip s/V of undeformed bodies by given creepages, at the stencil's points.

        With `flat`, that of a flat patch, also on a curved one.
        """
        x = (self.grid.x + self.stencil.rigid_ahead * self.grid.dx)[:, None]
        y = self.grid.y[None, :]
        shape = FlatPatch(*self.scene.body.radii) if flat else self.shape
        return shape.slip(x, y, longitudinal, lateral, spin)

    @cached_property
    def scaled_rigid_slip(self) -> np.ndarray:
        """Slip of the undeformed bodies in the scaled frame and in units of slip."""
        return self.frame.slip_to_scaled(self.rigid_slip) / self.units.slip

    @cached_property
    def load(self) -> float | None:
        """Prescribed load as the sum of dimensionless pressure over the elements, or None."""
        normal = self.scene.normal_load if self.approach is None else None
        return None if normal is None else normal / (self.units.pressure * self.grid.element_area)

    @cached_property
    def forces(self) -> PrescribedForces:
        """Tangential forces prescribed by the scene, dimensionless."""
        return self.forces_of((self.scene.load.force_x, self.scene.load.force_y))

    def forces_of(self, forces: tuple[float | None, float | None]) -> PrescribedForces:
        """Return prescribed forces (Q_x, Q_y), N, in dimensionless form; None: a creepage."""
        prescribed = [(k, q) for k, q in enumerate(forces) if q is not None]
        if not prescribed:
            return PrescribedForces()
        unit = self.units.pressure * self.grid.element_area
        vectors = np.stack([self.frame.matrix[:, k] for k, _ in prescribed])
        return PrescribedForces(vectors, np.array([q / unit for _, q in prescribed]))

    def problem(self, gap: np.ndarray, wear: WearInPass | None = None) -> Problem:
        """Return the dimensionless problem of steady rolling for a gap of the undeformed bodies.

        Parameters
        ----------
        gap : ndarray, shape (n_x, n_y)
            Separation in units of gap.
        wear : callable, optional
            Wear within the pass.
        """
        approach = self.scene.load.approach if self.approach is None else self.approach
        scaled = 0.0 if approach is None else approach / self.units.gap  # 0: the load is given
        normal = NormalProblem(self.operators, gap, self.load, scaled)
        x, y = self.grid.x[:, None], self.grid.y[None, :]
        friction = FrictionOnMesh(self.friction_law, x, y, self.units.pressure, self.units.slip)
        kinematics = SteadyRolling(self.stencil)
        return Problem(normal, self.scaled_rigid_slip, friction, self.forces, wear, kinematics)

    def creepages(self, computed: np.ndarray | None) -> tuple[float, float, float]:
        """Return (xi_x, xi_y, spin), with scaled `computed` ones where forces are prescribed."""
        longitudinal, lateral, spin = self._motion
        values = [longitudinal, lateral]
        if computed is not None:
            unknown = [k for k in (0, 1) if self.free[k]]
            for k, value in zip(unknown, computed, strict=True):
                values[k] = float(value) * self.units.slip
        return values[0], values[1], spin
