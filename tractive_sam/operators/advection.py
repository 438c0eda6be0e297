"""Advection: the place of a particle before a step, and the values that it brings from there.

A particle at x was at x + d before a step of the distance d. Fields are known at nodes only: of
d = (m + f) dx the part f of an element is interpolated.

**Interpolation that keeps a steady state.** With the differences d_k of the displacements from node
to node, and the node m ahead as the origin, the parabola through the nodes 0, 1 and 2 makes of the
slip f (d_0 + (1 - f)/2 (d_0 - d_1)). If the faces 0 and 1 slip by as much as the rigid bodies do,
so does the particle. So the steady solution is a fixed point for any d up to dx, in every pair of
neighbours that stick. A parabola on the side that material comes from damps odd-even waves (Warming
& Beam 1976, AIAA J. 14, 1241-1249), and its error is proportional to dx². If one of its nodes is
out of contact, the interpolation is a straight line.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Advection:
    """Interpolation of nodal fields that material carries along x by d in a step.

    Attributes
    ----------
    elements : int
        m, the number of full elements.
    part : float
        f, the fraction of a further element, from 0 to 1.
    """

    elements: int
    part: float

    @classmethod
    def from_distance(cls, distance: float, rounding: float = 2e-6) -> "Advection":
        """Return the advection over a distance, in elements; nearly full numbers are rounded.

        Parameters
        ----------
        distance : float
            Distance of the step, in elements.
        rounding : float
            A distance within this part of an element of a full number is rounded; knots move by
            half of it.
        """
        elements = round(distance)
        if abs(distance - elements) <= rounding:
            return cls(elements, 0.0)
        elements = int(np.floor(distance))
        return cls(elements, distance - elements)

    @property
    def length(self) -> float:
        """Distance that particles move in the step, in elements (d/dx)."""
        return self.elements + self.part

    @property
    def reach(self) -> int:
        """Number of nodes ahead of the mesh that `previous_values` needs."""
        return self.elements + (2 if self.part else 0)

    def middle(self, parabola: np.ndarray) -> np.ndarray | float:
        """Return the mean distance of particles from their node in the step, (n_x, n_y), elements.

        It is one number for steps of full elements. Spin makes the rigid slip linear along the
        path, so that its mean is its value in the middle. On a path that is interpolated by a
        straight line the rigid slip is so, too.

        Parameters
        ----------
        parabola : ndarray of bool, shape (n_x, n_y)
            See `previous_values`.
        """
        m, f, d = self.elements, self.part, self.length
        if not f:
            return 0.5 * d
        return np.where(parabola, 0.5 * d, (0.5 * m * m + f * (m + 0.5)) / d)

    def previous_values(self, nodes: np.ndarray, parabola: np.ndarray) -> np.ndarray:
        """Return a field before the step at the old positions of particles that are now at nodes.

        Parameters
        ----------
        nodes : ndarray, shape (..., n_x + reach, n_y)
            Values at nodes.
        parabola : ndarray of bool, shape (n_x, n_y)
            True for particles with values on a parabola, False for values on a straight line.
        """
        f, count = self.part, parabola.shape[0]
        first = range(self.elements, self.elements + (3 if f else 1))
        here, *further = (nodes[..., k : k + count, :] for k in first)
        if not f:
            return here
        ahead, beyond = further
        curved = 0.5 * f * (f - 1.0) * np.where(parabola, here - 2.0 * ahead + beyond, 0.0)
        return (1.0 - f) * here + f * ahead + curved

    def spread(self, values: np.ndarray, parabola: np.ndarray) -> np.ndarray:
        """Return the adjoint of `previous_values`: distribute values of particles to the nodes.

        Parameters
        ----------
        values : ndarray, shape (..., n_x, n_y)
            Values of the particles that are at the nodes after the step.
        parabola : ndarray of bool, shape (n_x, n_y)
            See `previous_values`.

        Returns
        -------
        ndarray, shape (..., n_x + reach, n_y)
            Values at the nodes before the step. Their scalar product with any nodal field equals
            the product of `values` with the field at the former places of the particles.
        """
        f, count = self.part, values.shape[-2]
        nodes = np.zeros((*values.shape[:-2], count + self.reach, values.shape[-1]))
        curved = 0.5 * f * (f - 1.0) * np.where(parabola, values, 0.0)
        parts = ((1.0 - f) * values + curved, f * values - 2.0 * curved, curved)
        for k, part in enumerate(parts if f else (values,), self.elements):
            nodes[..., k : k + count, :] += part
        return nodes

    def after(self, nodes: np.ndarray) -> np.ndarray:
        """Return a field after the step at the new positions of particles that began at nodes.

        By a straight line between nodes; behind the mesh as at its end.

        Parameters
        ----------
        nodes : ndarray, shape (..., n_x, n_y)
            Values at nodes after the step.
        """
        at = np.arange(nodes.shape[-2]) - self.elements
        here, behind = (nodes[..., np.maximum(k, 0), :] for k in (at, at - 1))
        return (1.0 - self.part) * here + self.part * behind

    def move_depths(self, nodes: np.ndarray) -> np.ndarray:
        """Return depths moved with the material by one step, conservative and never negative.

        A part of an element moves as a flux from node to node, with slopes that make no new
        extremes (van Leer 1974, J. Comput. Phys. 14, 361-370). Like the parabola it is of second
        order for smooth depths.

        Parameters
        ----------
        nodes : ndarray, shape (..., n_x, n_y)
            Depths at nodes a step before; new particles enter with zero.

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

        def leaving(back: np.ndarray, values: np.ndarray, front: np.ndarray) -> np.ndarray:
            behind, along = values - back, front - values
            product, size = behind * along, behind + along
            slope = np.divide(2.0 * product, size, out=np.zeros_like(size), where=product > 0.0)
            return f * (values - 0.5 * (1.0 - f) * slope)

        return here + leaving(here, ahead, beyond) - leaving(before, here, ahead)

    def with_nodes_ahead(self, fields: np.ndarray, edge: bool = False) -> np.ndarray:
        """Append `reach` nodes ahead of the mesh (+x): zeros, or with `edge` the last row's values.

        Parameters
        ----------
        fields : ndarray, shape (..., n_x, n_y)
            At the nodes of the mesh.
        edge : bool
            Whether the nodes ahead have the values at the edge.
        """
        if not self.reach:
            return fields
        count, columns = fields.shape[-2:]
        nodes = np.zeros((*fields.shape[:-2], count + self.reach, columns))
        nodes[..., :count, :] = fields
        if edge:
            nodes[..., count:, :] = fields[..., -1:, :]
        return nodes

    def parabola_mask(self, contact: np.ndarray) -> np.ndarray:
        """Return a mask of particles from between nodes all in contact; all True for full steps.

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
