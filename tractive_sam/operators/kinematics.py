"""Kinematics: how the slip of the particles follows from the displacements of the surfaces.

Steady rolling, a time step of rolling and a shift pose one contact problem. With the displacement
u = A p by the tractions, over an element's length dx, and the slip W of the undeformed bodies,

    steady rolling    sigma(x) = W(x) + u(x) - u(x + dx) = W(x) - du/dx dx,
    step              sigma(x) = W(x) + u_n(x) - u_(n-1)(x + d),

for a particle at x that was at x + d before, a step of the distance d ago; d = 0 is a shift. In a
step the unknown tractions enter by A itself, symmetric and positive definite, so that it has one
solution for any d, and what the particles were displaced before belongs to W
(`operators.advection`).

**When a step is steady.** For d = dx the steady solution of both stencils (`operators.stencil`) is
a fixed point: u(x) - u(x + dx) is its slip -du/dx dx.

**Entering the contact.** A particle that was out of contact before is held from the moment at which
its gap has closed. As in the steady state, its slip until then is -share x gap: near the edge the
tractions are a smooth share of the pressure, and so are their displacements, which differ by the
gap there from a smooth course. Both are interpolated alike and so match at any d. Upwind slip holds
a particle from the first node ahead of the contact on, as in steps of one element: its slip is
-share x (gap less the gap at that node), which is zero in steps up to one element.

**Direction of slip.** The mean slip of the path belongs to its middle, d/2 ahead of the particle;
it is turned back to the particle's place (`kernels.friction.turn`), by half an element at most.
Turned from farther, the slip depends less on the traction of the element than on its neighbours,
and a step in which slip reverses may have no solution.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from tractive_sam.compute import Convolution
from tractive_sam.mechanics import Linearisation
from tractive_sam.operators.elastic import Box, Entries, Lattice, Operators
from tractive_sam.operators.stencil import UPWIND, FrictionSlip, Stencil


@dataclass(frozen=True, eq=False)
class Kinematics(ABC):
    """Relation between tangential displacement and slip: steady rolling, or a step of rolling.

    Attributes
    ----------
    stencil : Stencil
        Place in an element at which its slip is taken.
    """

    stencil: Stencil = UPWIND

    joint: ClassVar[bool]
    """Whether all elements slip by each other's tractions; else by those ahead of them only."""

    @abstractmethod
    def tangential(self, operators: Operators) -> Convolution:
        """Return the operator from tangential tractions to slip (step: displacement over dx)."""

    @abstractmethod
    def coupled(self, operators: Operators) -> Convolution:
        """Return the operator from pressure and tractions to gap and slip (step: displacement)."""

    @abstractmethod
    def by_pressure(self, operators: Operators, pressure: np.ndarray) -> np.ndarray:
        """Return the slip (step: displacement over dx) by a pressure, (2, n_x, n_y)."""

    @abstractmethod
    def self_influence(self, operators: Operators) -> Entries:
        """Return slip (step: displacement over dx) by an element's own traction, (11, 12, 22)."""

    @abstractmethod
    def friction_slip(
        self, operators: Operators, pressure: np.ndarray, gap: np.ndarray
    ) -> FrictionSlip:
        """Return the `FrictionSlip` (slip corrected at edges) of a pressure and a gap."""

    @abstractmethod
    def approximate_inverse(
        self, operators: Operators, law: Linearisation, stiffness: np.ndarray
    ) -> Callable[[np.ndarray], np.ndarray]:
        """Return a preconditioner: approximate inverse of the linearised friction conditions.

        Parameters
        ----------
        operators : Operators
            The elastic operators.
        law : Linearisation
            The friction law at an iterate.
        stiffness : ndarray, shape (n_x, n_y)
            `FrictionSlip.stiffness`.

        Returns
        -------
        callable
            From and to arrays of shape (2, n_x, n_y).
        """

    def slip_weight(self, operators: Operators, radius: np.ndarray) -> float:
        """Return the weight of slip relative to tractions in iterations: 1 if not overridden."""
        return 1.0

    def slip_scale(self, block: int) -> float:
        """Return the factor of slip on elements `block` times as long: 1 if not overridden."""
        return 1.0

    @property
    def gaps(self) -> tuple[np.ndarray, ...]:
        """Fields that are even in y in a symmetric problem: none, if not overridden."""
        return ()

    def coarsened(self, lattice: Lattice) -> Self:
        """Return the kinematics for merged elements of a lattice: itself, if not overridden."""
        return self

    def within(self, box: Box) -> Self:
        """Return the kinematics for a rectangle (box) of the mesh: itself, if not overridden."""
        return self


@dataclass(frozen=True, eq=False)
class SteadyRolling(Kinematics):
    """Steady rolling: slip is a difference of displacements along x.

    Attributes
    ----------
    zones_from : int
        Elements from which on the inverse by zones takes less time than the upwind sweep.
    longest : float
        Length over width of elements up to which it does: the weights of the inverse by zones
        follow from waves along x, and the elements of a row act on each other less than on the next
        row if they are longer.
    """

    zones_from: int = 12_000
    longest: float = 1.5

    joint = False

    def tangential(self, operators: Operators) -> Convolution:
        """Return the operator from tangential tractions to slip, D_tt."""
        return operators.slip

    def coupled(self, operators: Operators) -> Convolution:
        """Return the operator from pressure and tangential tractions to gap and slip."""
        return operators.coupled

    def by_pressure(self, operators: Operators, pressure: np.ndarray) -> np.ndarray:
        """Return the slip by a pressure, (2, n_x, n_y)."""
        return operators.slip_by_pressure(pressure)

    def self_influence(self, operators: Operators) -> Entries:
        """Return the slip of an element due to its own traction, entries (11, 12, 22)."""
        return operators.self_influence

    def friction_slip(
        self, operators: Operators, pressure: np.ndarray, gap: np.ndarray
    ) -> FrictionSlip:
        """Return the `FrictionSlip` (slip corrected at edges) of a pressure and a gap."""
        lattice, stencil = operators.lattice, self.stencil
        leading = stencil.leading(pressure, gap)
        seen = stencil.staggered, pressure, gap, leading, (leading[0] + 1, leading[1])
        aspect = lattice.dx / lattice.dy
        layer, mirror = operators.layer_slip, lattice.mirror
        return FrictionSlip(*seen, aspect, operators.opening, layer, mirror=mirror)

    def approximate_inverse(
        self, operators: Operators, law: Linearisation, stiffness: np.ndarray
    ) -> Callable[[np.ndarray], np.ndarray]:
        """Return a preconditioner of the linearised friction conditions.

        It is the upwind sweep, or on large meshes the inverse by zones (`ZoneInverse`), for
        isotropic friction and bodies of equal material. Parameters as in
        `Kinematics.approximate_inverse`.
        """
        (first, second), lattice = operators.frame.mu, operators.lattice
        short = lattice.dx <= self.longest * lattice.dy
        alike = first == second and not operators.elasticity.coupled
        if alike and short and law.state.size >= self.zones_from:
            return operators.zone_inverse.at(law, stiffness)
        return law.upwind_inverse(operators.self_influence, operators.tangential_inverse, stiffness)


@dataclass(frozen=True, eq=False)
class RollingStep(Kinematics):
    """Step of transient rolling or shift: slip is the change of displacement of a particle.

    Attributes
    ----------
    entering : ndarray, shape (n_x, n_y)
        Dimensionless gap that particles close in the step before they are held.
    length : float
        Distance rolled, in elements; 0 in a shift.
    far : int
        Number of elements along a contact from which on the slip of each counts the less, the more
        there are.
    memory : list of FrictionSlip
        Friction slip of the last step, which steps under the same pressure and gap share.
    """

    entering: np.ndarray = field(default_factory=lambda: np.zeros((1, 1)))
    length: float = 0.0
    far: int = 60
    memory: list[FrictionSlip] = field(default_factory=list, repr=False)

    joint = True

    def tangential(self, operators: Operators) -> Convolution:
        """Return the operator from tangential tractions to displacement over dx, A_tt / dx."""
        return operators.tangential

    def coupled(self, operators: Operators) -> Convolution:
        """Return the operator from pressure and tractions to gap and displacement over dx."""
        return operators.coupled_displacement

    def by_pressure(self, operators: Operators, pressure: np.ndarray) -> np.ndarray:
        """Return the tangential displacement over dx by a pressure, (2, n_x, n_y)."""
        return operators.displacement_by_pressure(pressure)

    def self_influence(self, operators: Operators) -> Entries:
        """Return the displacement over dx by an element's own traction, entries (11, 12, 22)."""
        return operators.self_displacement

    def friction_slip(
        self, operators: Operators, pressure: np.ndarray, gap: np.ndarray
    ) -> FrictionSlip:
        """Return the friction slip of a step: its gap is `entering`; the argument is unused."""
        lattice = operators.lattice
        back = min(self.length, 1.0) if self.stencil.staggered else 0.0
        for last in self.memory:
            same = last.staggered == back and np.array_equal(last.bound, pressure)
            if same and np.array_equal(last.gap, self.entering):
                return last
        i, j = np.nonzero((pressure > 0.0) & (self.entering > 0.0))
        seen = back, pressure, self.entering, (i, j), (i, j), lattice.dx / lattice.dy
        self.memory[:] = [FrictionSlip(*seen, operators.opening, None, False, lattice.mirror)]
        return self.memory[0]

    def approximate_inverse(
        self, operators: Operators, law: Linearisation, stiffness: np.ndarray
    ) -> Callable[[np.ndarray], np.ndarray]:
        """Return a preconditioner: the circulant inverse combined with the local friction terms.

        Parameters as in `Kinematics.approximate_inverse`.
        """
        elastic = operators.self_displacement, operators.tangential_inverse
        return law.inverse_of_step(*elastic, stiffness)

    def slip_weight(self, operators: Operators, radius: np.ndarray) -> float:
        """Return the weight of slip relative to tractions; less than 1 for large compliances.

        Slip is displacement here. With its full weight a step from rest would slip everywhere; if
        all tractions at their bound displace much too far, the next iteration would return.
        """
        along = int(np.count_nonzero((radius > 0.0).any(axis=1)))
        first, _, second = operators.self_displacement
        return self.far / (max(along, self.far) * max(first, second))

    def slip_scale(self, block: int) -> float:
        """Return the factor of slip on elements `block` times as long: 1/block.

        The unit of slip includes the length of an element.
        """
        return 1.0 / block

    @property
    def gaps(self) -> tuple[np.ndarray, ...]:
        """The gap that particles close, even in y in a symmetric problem."""
        return (self.entering,)

    def coarsened(self, lattice: Lattice) -> Self:
        """Return the step for merged elements of a lattice: mean gap, fewer elements rolled."""
        entering, length = lattice.merge(self.entering), self.length / lattice.coarsening[0]
        return replace(self, entering=entering, length=length)

    def within(self, box: Box) -> Self:
        """Return the step restricted to a rectangle (box) of the mesh."""
        return replace(self, entering=self.entering[box])
