"""The operators of a step: where a particle was before it, and what it slips on the way.

A particle at x was at x + d a step of the distance d before. With the displacement u = A p of the
tractions, over an element's length dx, it slips by

    sigma(x) = W(x) + u_n(x) - u_(n-1)(x + d),

W the rigid slip on the way. The unknown p_n enters by A itself, symmetric and positive definite, so
that a step has one solution for any d; d = 0 is a shift. All on nodes: of d = (m + f) dx the part f
of an element is interpolated.

**What is steady.** For d = dx the steady solution of either stencil (`operators.stencil`) is a
fixed point: u(x) - u(x + dx) is its slip -du/dx. So it is for any other d up to dx, wherever two
neighbours stick. With the differences d_k of the displacements from node to node, and the node m
ahead as the origin, the interpolation by the parabola through the nodes 0, 1 and 2 makes of the
slip f (d_0 + (1 - f)/2 (d_0 - d_1)): where the faces 0 and 1 slip by as much as the rigid bodies
do, so does the particle. A parabola on the side that material comes from damps odd-even waves
(Warming & Beam 1976, AIAA J. 14, 1241-1249), and its error goes with dx².

**Entering the contact.** A particle that was out of contact before is held from the moment at which
its gap has closed. As in the steady state, what it slipped till then is -share x gap: near the edge
the tractions are a smooth share of the pressure, and so are their displacements, which differ by
the gap there from a smooth course. Interpolated in the same way, both match at any d. Upwind slip
holds a particle from the first node ahead of the contact on, as in steps of one element: it slips
by -share x (gap less the gap at that node), which is nothing in steps up to one element. There the
interpolation is a straight line, as it is wherever one of its nodes is out of contact.

**Where slip points.** The mean slip of the way belongs to its middle, d/2 ahead of the particle; it
is turned back to the particle's place (`kernels.friction.turn`), by half an element at most. From
farther, what is turned answers the element's own traction less than that of its neighbours, and
where slip reverses a step may have no solution.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tractive_sam.kernels import spectral
from tractive_sam.mechanics import Linearisation
from tractive_sam.operators.convolution import Convolution
from tractive_sam.operators.elastic import Operators
from tractive_sam.operators.stencil import FrictionSlip

RIPPLES = 15
"""Elements along each axis, an odd number, of the ripple by whose middle one its depth is told."""

WHOLE = 2e-6
"""Part of an element that a step may differ from whole ones: rounding moves knots by half of it."""


@dataclass(frozen=True)
class Way:
    """The way of particles in a step.

    Attributes
    ----------
    elements : int
        m, whole elements.
    part : float
        f, of one more, from 0 to 1.
    """

    elements: int
    part: float

    @classmethod
    def of(cls, distance: float) -> "Way":
        """Of a distance in elements."""
        whole = round(distance)
        if abs(distance - whole) <= WHOLE:
            return cls(whole, 0.0)
        whole = int(np.floor(distance))
        return cls(whole, distance - whole)

    @property
    def length(self) -> float:
        """d/dx."""
        return self.elements + self.part

    @property
    def reach(self) -> int:
        """Nodes ahead that `before` needs."""
        return self.elements + (2 if self.part else 0)

    def middle(self, parabola: np.ndarray) -> np.ndarray:
        """Return the distance from particles to the middle of their way, in elements.

        Spin makes the rigid slip linear over the way, so that its mean is that in the middle. Where
        the way is interpolated by a straight line, so is the rigid slip on it.

        Parameters
        ----------
        parabola : ndarray of bool, shape (n_x, n_y)
            See `before`.
        """
        m, f, d = self.elements, self.part, max(self.length, 1e-300)
        return np.where(parabola, 0.5 * d, (0.5 * m * m + f * (m + 0.5)) / d)

    def before(self, nodes: np.ndarray, parabola: np.ndarray) -> np.ndarray:
        """Values a step before at the places where the particles of the nodes were.

        Parameters
        ----------
        nodes : ndarray, shape (..., n_x + reach, n_y)
            Values at nodes.
        parabola : ndarray of bool, shape (n_x, n_y)
            Particles whose values lie on a parabola, of others on a straight line.
        """
        f, count = self.part, parabola.shape[0]
        here, ahead, beyond = (
            nodes[..., k : k + count, :]
            for k in np.minimum(self.elements + np.arange(3), nodes.shape[-2] - count)
        )
        if not f:
            return here
        curved = 0.5 * f * (f - 1.0) * np.where(parabola, here - 2.0 * ahead + beyond, 0.0)
        return (1.0 - f) * here + f * ahead + curved

    def spread(self, values: np.ndarray, parabola: np.ndarray) -> np.ndarray:
        """Return values of particles spread over the nodes: the adjoint of `before`.

        Parameters
        ----------
        values : ndarray, shape (..., n_x, n_y)
            Values of the particles that are at the nodes after the step.
        parabola : ndarray of bool, shape (n_x, n_y)
            See `before`.

        Returns
        -------
        ndarray, shape (..., n_x + reach, n_y)
            At the nodes before the step: the sum of the products with any nodal field is that of
            `values` with the field at the places where the particles were.
        """
        f, count = self.part, values.shape[-2]
        nodes = np.zeros((*values.shape[:-2], count + self.reach, values.shape[-1]))
        curved = 0.5 * f * (f - 1.0) * np.where(parabola, values, 0.0)
        parts = ((1.0 - f) * values + curved, f * values - 2.0 * curved, curved)
        for k, part in enumerate(parts if f else (values,), self.elements):
            nodes[..., k : k + count, :] += part
        return nodes

    def after(self, nodes: np.ndarray) -> np.ndarray:
        """Return values after a step at the places that the particles of the nodes have reached.

        By a straight line between nodes; behind the mesh as at its end.

        Parameters
        ----------
        nodes : ndarray, shape (..., n_x, n_y)
            Values at nodes after the step.
        """
        at = np.arange(nodes.shape[-2]) - self.elements
        here, behind = (nodes[..., np.maximum(k, 0), :] for k in (at, at - 1))
        return (1.0 - self.part) * here + self.part * behind

    def carried(self, nodes: np.ndarray) -> np.ndarray:
        """Depths that move with the material: none becomes negative, and their sum is kept.

        Of parts of an element as the flux from node to node, by slopes that make no new extremes
        (van Leer 1974, J. Comput. Phys. 14, 361-370): of second order, like the parabola, where it
        is smooth.

        Parameters
        ----------
        nodes : ndarray, shape (..., n_x, n_y)
            At nodes a step before; new particles come in with nothing.

        Returns
        -------
        ndarray, shape (..., n_x, n_y)
        """
        count, f = nodes.shape[-2], self.part
        sides = [(0, 0)] * (nodes.ndim - 2) + [(1, self.reach), (0, 0)]
        wide = np.pad(nodes, sides)
        wide[..., 0, :] = nodes[..., 0, :]  # as deep behind the mesh as at its end
        if not f:
            return wide[..., 1 + self.elements :, :][..., :count, :]
        before, here, ahead, beyond = (
            wide[..., self.elements + k :, :][..., :count, :] for k in range(4)
        )

        def leaving(back: np.ndarray, now: np.ndarray, front: np.ndarray) -> np.ndarray:
            behind, along = now - back, front - now
            product, size = behind * along, behind + along
            slope = np.divide(2.0 * product, size, out=np.zeros_like(size), where=product > 0.0)
            return f * (now - 0.5 * (1.0 - f) * slope)

        return here + leaving(here, ahead, beyond) - leaving(before, here, ahead)

    def held(self, contact: np.ndarray) -> np.ndarray:
        """Particles whose three nodes were in contact, shape (n_x, n_y), as `parabola`.

        Parameters
        ----------
        contact : ndarray of bool, shape (n_x + reach, n_y)
            Nodes in contact a step before.
        """
        count = contact.shape[0] - self.reach
        if not self.part:
            return np.ones((count, contact.shape[1]), bool)
        here, ahead, beyond = (contact[self.elements + k :][:count] for k in range(3))
        return here & ahead & beyond


class EnteringSlip(FrictionSlip):
    """The slip that the friction law sees in a step: the gap before it is what it was."""

    def sticking_change(
        self,
        slip: np.ndarray,
        traction: np.ndarray,
        change: np.ndarray,
        gap: np.ndarray,
        at: np.ndarray,
    ) -> np.ndarray:
        """See `FrictionSlip.sticking_change`."""
        return super().sticking_change(slip, traction, change, np.zeros_like(gap), at)


def _turning(elements: int) -> np.ndarray:
    """1 and -1 in turn, of a few elements in a row; half at the ends: nothing in all."""
    if elements == 1:
        return np.ones(1)
    signs = (-1.0) ** np.arange(RIPPLES)
    signs[[0, -1]] *= 0.5
    return signs


class StepOperators(Operators):
    """Operators of a step: its slip is the displacement itself, over the length of an element."""

    @property
    def slip(self) -> Convolution:
        """pi_t -> A_tt pi_t / dx."""
        return self.tangential

    @cached_property
    def self_influence(self) -> tuple[float, float, float]:
        """Entries (11, 12, 22) of the displacement of an element by itself."""
        alone = self.on(self.lattice.of((1, 1))).tangential
        first, second = (alone(unit.reshape(2, 1, 1)).ravel() for unit in np.eye(2))
        return float(first[0]), float(first[1]), float(second[1])

    @cached_property
    def ripple(self) -> float:
        """What A_nn answers to pressure of one that turns its sign from element to element."""
        first, second = (_turning(n) for n in self.lattice.shape)
        signs = np.outer(first, second)
        response = self.on(self.lattice.of(signs.shape)).normal(signs[None])[0]
        i, j = first.size // 2, second.size // 2
        return float(signs[i, j] * response[i, j])

    @cached_property
    def coupled(self) -> Convolution:
        """(pi_n, pi_t) -> (A_nn pi_n + A_nt pi_t, (A_tn pi_n + A_tt pi_t) / dx)."""
        F, per_gap = self.frame.matrix, self._per_gap
        per_slip = self._per_slip / self.lattice.dx
        t11, t12, t22 = self._displacement_per_dx()
        # Reciprocity: u_n from p_x is minus u_x from p_n, A_zx = -A_xz.
        drag = [1j * self._displacement(k).imag for k in ("xz", "yz")]
        first, second = (row[0] * drag[0] + row[1] * drag[1] for row in F)
        entries = np.stack(
            [
                one + 0j
                for one in (
                    *(self._normal_spectrum(), -per_gap * first, -per_gap * second),
                    *(per_slip * first, t11, t12),
                    *(per_slip * second, t12, t22),
                )
            ]
        )
        return self._convolution(entries, spectral.full_3x3, 3)

    def entering_slip(self, pressure: np.ndarray, gap: np.ndarray, ahead: float) -> FrictionSlip:
        """The slip that the friction law sees in a step.

        Parameters
        ----------
        pressure : ndarray, shape (n_x, n_y)
            Dimensionless pressure after the step.
        gap : ndarray, shape (n_x, n_y)
            Dimensionless gap that the particles close before they are held.
        ahead : float
            Way of the step in elements: its slip belongs to places half as far ahead.
        """
        staggered = self.stencil.staggered
        entering = np.nonzero((pressure > 0.0) & (gap > 0.0))
        back = min(ahead, 1.0) if staggered else 0.0
        aspect = self.lattice.dx / self.lattice.dy
        return EnteringSlip(back, pressure, gap, entering, entering, aspect, self._opening)

    def approximate_inverse(
        self, law: Linearisation, rows: np.ndarray, stiffness: np.ndarray
    ) -> np.ndarray:
        """Tractions whose rows of a friction law are nearly those given."""
        own = self.self_influence
        return law.approximate_inverse_of_step(rows, self.tangential_inverse, own, stiffness)
