"""Dimensionless contact problems, the input of solvers (units: `operators.elastic`).

The pressure is an unknown of a `Problem`, or it is **fixed**: of bodies of equal material it does
not depend on the tractions and is solved for beforehand. Problems are never changed, other ones are
made.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

from tractive_sam.compute import backend_of
from tractive_sam.deprecation import renamed_attributes
from tractive_sam.mechanics import Bound, FrictionOnMesh, Linearisation
from tractive_sam.operators import (
    Box,
    FrictionSlip,
    Kinematics,
    Operators,
    SteadyRolling,
    block_mean,
)

WearInPass = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""(pi_n, pi_t, sigma) -> depth worn within the pass, in units of gap, shape (n_x, n_y)."""


@dataclass(frozen=True, eq=False)
class NormalProblem:
    """Normal contact problem: find pi_n >= 0, eta = gap + A_nn pi_n - delta >= 0, pi_n eta = 0.

    Parameters
    ----------
    operators : Operators
        The elastic operators.
    gap : ndarray, shape (n_x, n_y)
        Separation of the undeformed surfaces.
    load : float or None
        Sum of pi_n over the elements; None if the approach is given.
    approach : float
        delta; not used if the load is given.
    """

    operators: Operators
    gap: np.ndarray
    load: float | None
    approach: float = 0.0

    def is_the_same_as(self, problem: "NormalProblem") -> bool:
        """Return whether two problems have equal gap, load and approach."""
        prescribed = self.load == problem.load and self.approach == problem.approach
        return prescribed and np.array_equal(self.gap, problem.gap)

    def within(self, box: Box) -> "NormalProblem":
        """Return the problem restricted to a rectangle (box) of elements."""
        gap = np.ascontiguousarray(self.gap[box])
        return replace(self, operators=self.operators.part(gap.shape), gap=gap)

    def coarsened(self) -> "NormalProblem":
        """Return the problem on a mesh of elements of twice the size."""
        block = self.operators.lattice.coarsening
        return replace(
            self,
            operators=self.operators.coarsened,
            gap=block_mean(self.gap, block, "edge"),
            load=None if self.load is None else self.load / math.prod(block),
        )


@dataclass(frozen=True, eq=False)
class PrescribedForces:
    """Prescribed tangential forces; their creepages are unknowns of the problem.

    A unit of the unknown zeta_k adds the constant slip v_k to every element, and the force k is the
    sum of v_k . pi_t over the elements: work per revolution is force times creepage.

    Parameters
    ----------
    vectors : ndarray, shape (m, 2)
        v_k, in the scaled frame.
    target : ndarray, shape (m,)
        The forces.
    """

    vectors: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    target: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __len__(self) -> int:
        return len(self.target)

    @property
    def minimum(self) -> float:
        """Least sum of traction magnitudes that gives the forces; 0 if none is prescribed.

        No more than the sum of the bound can be had, in any direction.
        """
        if not len(self):
            return 0.0
        return float(np.linalg.norm(np.linalg.pinv(self.vectors) @ self.target))

    def elastic_slip(self, slip: np.ndarray, creepage: np.ndarray) -> float:
        """Return the largest slip without the unknown creepages; 0 if no force is prescribed."""
        if not len(self):
            return 0.0
        return float(np.abs(slip - self.slip(creepage)).max())

    def trust_fraction(self, creepage: np.ndarray, change: np.ndarray, elastic: float) -> float:
        """Return the fraction (at most 1) of a change of creepages that a step may take.

        If nearly everything slips the forces hardly depend on the creepages, and a Newton step
        would diverge. Full slip begins at a slip of order one, or of the `elastic` slip.
        """
        size = np.abs(change).max(initial=0.0)
        trusted = 3.0 + np.abs(creepage).max(initial=0.0) + elastic
        return float(min(1.0, trusted / size)) if size > 0.0 else 1.0

    def diverged(self, creepage: np.ndarray, elastic: float) -> bool:
        """Return whether creepages are so large that friction cannot carry the forces."""
        return bool(np.abs(creepage).max(initial=0.0) > 1e4 * (1.0 + elastic))

    def slip(self, creepage: np.ndarray) -> np.ndarray:
        """Return the constant slip that the unknown creepages cause, shape (2, 1, 1)."""
        return (creepage @ self.vectors)[:, None, None]

    def force(self, traction: np.ndarray) -> np.ndarray:
        """Return the tangential forces of a field of tractions, shape (m,)."""
        return self.vectors @ traction.sum(axis=(1, 2))

    def coarsened(self, block: tuple[int, int]) -> "PrescribedForces":
        """Return the forces for a mesh with elements that combine `block` of this one."""
        return replace(self, target=self.target / math.prod(block))


@dataclass(frozen=True, eq=False)
class FixedPressure:
    """Fixed pressure and gap, under which only the tractions are unknown.

    Parameters
    ----------
    operators : Operators
        The elastic operators.
    pressure, gap : ndarray, shape (n_x, n_y)
        pi_n and eta; the gap determines the positions of edges within their elements.
    """

    operators: Operators
    pressure: np.ndarray
    gap: np.ndarray

    def coarsened(self) -> "FixedPressure":
        """Return pressure and gap on a mesh of elements of twice the size."""
        block = self.operators.lattice.coarsening
        return FixedPressure(
            self.operators.coarsened,
            block_mean(self.pressure, block, "constant"),
            block_mean(self.gap, block, "edge"),
        )


@renamed_attributes(held="is_pressure_fixed", holding="with_pressure", eased="at_speed_ratio")
@dataclass(frozen=True, eq=False)
class Problem:
    """Contact problem: find pressure, tractions and slip that meet the contact conditions.

    The normal conditions are those of `NormalProblem`, with the lift by tractions; in slip
    pi_t = -radius sigma/|sigma|, sigma = rigid + creepages + D_tn pi_n + D_tt pi_t. The kinematics
    define D and the sigma in the friction law of an element.

    Unknowns and the response to them are **fields** of shape (3, n_x, n_y): pressure and tractions,
    gap and slip. Under a fixed pressure their shape is (2, n_x, n_y): tractions, and slip. So
    `fields[-2:]` are always the tangential ones.

    Parameters
    ----------
    normal : NormalProblem or FixedPressure
        The normal block, free or fixed; it has the operators.
    rigid : ndarray, shape (2, n_x, n_y)
        Slip that does not depend on the unknowns: the slip of the undeformed bodies, in a step less
        the former displacements of the particles, under a fixed pressure plus the slip that it
        causes.
    friction : FrictionOnMesh
        The friction law on the mesh.
    forces : PrescribedForces
        Forces prescribed in place of creepages.
    wear : callable, optional
        Wear within the pass, added to the gap. Only iterations that evaluate the gap itself support
        it (`Uzawa`).
    kinematics : Kinematics
        How slip follows from displacement.
    """

    normal: NormalProblem | FixedPressure
    rigid: np.ndarray
    friction: FrictionOnMesh = field(default_factory=FrictionOnMesh)
    forces: PrescribedForces = field(default_factory=PrescribedForces)
    wear: WearInPass | None = None
    kinematics: Kinematics = field(default_factory=SteadyRolling)

    @property
    def operators(self) -> Operators:
        """Elastic operators of the problem."""
        return self.normal.operators

    @property
    def coupled(self) -> bool:
        """Whether pressure causes slip and tractions change the gap."""
        return self.operators.elasticity.coupled

    @property
    def has_tangential_cause(self) -> bool:
        """Whether creepages, forces or coupling cause slip; otherwise tractions are zero."""
        return self.coupled or len(self.forces) > 0 or bool(self.rigid.any())

    @property
    def is_pressure_fixed(self) -> bool:
        """Whether the pressure is fixed, and only the tractions are unknown."""
        return isinstance(self.normal, FixedPressure)

    @property
    def fixed_pressure(self) -> FixedPressure:
        """Fixed pressure and its gap; raises a TypeError if the pressure is unknown."""
        if isinstance(self.normal, NormalProblem):
            raise TypeError("problem.normal: must be a FixedPressure here")
        return self.normal

    @property
    def free_pressure(self) -> NormalProblem:
        """Normal problem; raises a TypeError if the pressure is fixed."""
        if isinstance(self.normal, FixedPressure):
            raise TypeError("problem.normal: must be a NormalProblem here")
        return self.normal

    @property
    def load(self) -> float | None:
        """Prescribed sum of the pressure; None for a prescribed approach or pressure."""
        return None if isinstance(self.normal, FixedPressure) else self.normal.load

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the unknown fields: (3, n_x, n_y), or (2, n_x, n_y) under a fixed pressure."""
        return (2 if self.is_pressure_fixed else 3, *self.rigid.shape[1:])

    def with_pressure(self, pressure: np.ndarray, gap: np.ndarray) -> "Problem":
        """Return the tangential problem under a fixed pressure, including the slip by pressure."""
        rigid = self.rigid
        if self.coupled:
            backend = backend_of(rigid)
            fields = backend.concat((pressure[None, ...], backend.xp.zeros_like(rigid)))
            rigid = rigid + self.kinematics.coupled(self.operators)(fields)[1:, ...]
        return replace(
            self, normal=FixedPressure(self.operators, pressure, gap), rigid=rigid, wear=None
        )

    def within(self, box: Box) -> Self:
        """Return the problem (its pressure must be fixed) on a rectangle (box) of elements."""
        friction, normal = self.friction, self.fixed_pressure
        # Contiguous, for the vector instructions of the kernels.
        pressure, gap = (
            np.ascontiguousarray(field[box]) for field in (normal.pressure, normal.gap)
        )
        fixed = FixedPressure(self.operators.part(pressure.shape), pressure, gap)
        x = friction.x[box[0]] if len(friction.x) > 1 else friction.x
        y = friction.y[:, box[1]] if friction.y.shape[1] > 1 else friction.y
        return replace(
            self,
            normal=fixed,
            rigid=np.ascontiguousarray(self.rigid[:, *box]),
            friction=friction.on_elements(x, y),
            kinematics=self.kinematics.within(box),
        )

    def coarsened(self) -> Self:
        """Return the problem on a mesh of elements of twice the size."""
        block = self.operators.lattice.coarsening
        friction, scale = self.friction, self.kinematics.slip_scale(block[0])
        friction = friction.on_elements(
            block_mean(friction.x, (block[0], 1), "edge"),
            block_mean(friction.y, (1, block[1]), "edge"),
        )
        return replace(
            self,
            normal=self.normal.coarsened(),
            rigid=scale * block_mean(self.rigid, block, "edge"),
            friction=replace(friction, slip=friction.slip / scale),
            forces=self.forces.coarsened(block),
            kinematics=self.kinematics.coarsened(block),
        )

    def response(self, fields: np.ndarray) -> np.ndarray:
        """Return the elastic gap and slip due to fields (pressure, tractions)."""
        if self.coupled and not self.is_pressure_fixed:
            return self.kinematics.coupled(self.operators)(fields)
        slip = self.kinematics.tangential(self.operators)(fields[-2:, ...])
        if self.is_pressure_fixed:
            return slip
        return backend_of(fields).concat((self.operators.normal(fields[:1, ...]), slip))

    @cached_property
    def approximate(self) -> Self:
        """Problem with the approximate operators; only its response is used."""
        return replace(self, normal=replace(self.normal, operators=self.operators.approximate))

    def bound(self, pressure: np.ndarray) -> Bound:
        """Return the traction bound of the friction law under a pressure, at zero slip."""
        return self._fixed_bound if self.is_pressure_fixed else self.friction.bound(pressure)

    def bound_sliding(
        self,
        bound: Bound,
        pressure: np.ndarray,
        traction: np.ndarray,
        slip: np.ndarray,
        seen: FrictionSlip,
    ) -> Bound:
        """Return the traction bound under the slip; the given bound unless friction falls."""
        if not self.friction.law.falls:
            return bound
        sticking = seen.sticking(slip, traction)
        return self.friction.bound_sliding(pressure, sticking, seen.bound, seen.staggered)

    def friction_slip(self, pressure: np.ndarray, gap: np.ndarray) -> FrictionSlip:
        """Return the `FrictionSlip` (slip corrected at edges) under a pressure and a gap."""
        if self.is_pressure_fixed:
            return self._fixed_slip
        return self.kinematics.friction_slip(self.operators, pressure, gap)

    @cached_property
    def touching(self) -> np.ndarray:
        """Mask of the elements in contact under the fixed pressure, shape (n_x, n_y)."""
        return self.fixed_pressure.pressure > 0.0

    @cached_property
    def _fixed_bound(self) -> Bound:
        """Traction bound of the friction law under the fixed pressure, at zero slip."""
        return self.friction.bound(self.fixed_pressure.pressure)

    @cached_property
    def _fixed_weight(self) -> float:
        """Weight of slip relative to tractions under the fixed pressure."""
        return self.kinematics.slip_weight(self.operators, self._fixed_bound.radius)

    @cached_property
    def _fixed_slip(self) -> FrictionSlip:
        """`FrictionSlip` (slip corrected at edges) under the fixed pressure."""
        normal = self.fixed_pressure
        return self.kinematics.friction_slip(self.operators, normal.pressure, normal.gap)

    def project(self, traction: np.ndarray, radius: np.ndarray, physical: bool) -> np.ndarray:
        """Return the scaled tractions within the bound nearest to these (`physical`: unscaled)."""
        return self.friction.law.project(traction, radius, physical)

    def opposed(self, traction: np.ndarray, slip: np.ndarray, seen: FrictionSlip) -> np.ndarray:
        """Return the slip that tractions oppose in each element, from the slip of leading faces."""
        sticking = seen.sticking(slip, traction)
        return self.friction.law.opposed_slip(sticking, seen.bound, seen.staggered)

    def linearise(
        self,
        traction: np.ndarray,
        slip: np.ndarray,
        bound: Bound,
        seen: FrictionSlip,
        active: np.ndarray | None,
    ) -> Linearisation:
        """Return the friction law linearised at tractions and slip."""
        sticking = seen.sticking(slip, traction)
        if self.is_pressure_fixed:
            weight = self._fixed_weight
        else:
            weight = self.kinematics.slip_weight(self.operators, bound.radius)
        return self.friction.law.linearise(
            traction, sticking, bound, seen.bound, seen.staggered, active, weight
        )

    def sliding(
        self, pressure: np.ndarray, gap: np.ndarray, traction: np.ndarray, slip: np.ndarray
    ) -> tuple[np.ndarray, Bound]:
        """Return a mask of the elements that slide in a solution, and the traction bound.

        Returns
        -------
        sliding : ndarray of bool, shape (n_x, n_y)
            Elements in contact with a traction that is at its bound and opposes the slip.
        bound : Bound
            Bound under this slip.
        """
        seen = self.friction_slip(pressure, gap)
        opposed = self.opposed(traction, slip, seen)
        bound = self.bound_sliding(self.bound(pressure), pressure, traction, slip, seen)
        beyond = ((traction - opposed) ** 2).sum(axis=0) > bound.radius**2
        return (pressure > 0.0) & beyond, bound

    def at_speed_ratio(self, ratio: float) -> "Problem":
        """Return the problem at `ratio` times the rolling speed; 0 gives static friction."""
        return replace(self, friction=self.friction.at_speed_ratio(ratio))
