"""What a solver is given: dimensionless contact problems (units: `operators.half_space`)."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from tractive_sam.operators import HalfSpace
from tractive_sam.operators.stencil import FrictionSlip


def block_mean(values: np.ndarray, block: tuple[int, int], mode: str) -> np.ndarray:
    """Means over blocks of the last two axes; `mode` fills up the last ones as `numpy.pad`."""
    (nx, ny), (bx, by) = values.shape[-2:], block
    pad = [(0, 0)] * (values.ndim - 2) + [(0, -nx % bx), (0, -ny % by)]
    v = np.pad(values, pad, mode=mode)
    parts = [v[..., i::bx, j::by] for i in range(bx) for j in range(by)]
    return sum(parts) / len(parts)


@dataclass(frozen=True)
class NormalProblem:
    """Find pi_n >= 0 with eta = gap + A_nn pi_n - delta >= 0 and pi_n eta = 0.

    Parameters
    ----------
    half_space : HalfSpace
        The operators.
    gap : ndarray, shape (n_x, n_y)
        Separation of the undeformed surfaces.
    load : float or None
        Sum of pi_n over the elements; None where the approach is given.
    approach : float
        delta; where the load is given, a first guess that is not used.
    """

    half_space: HalfSpace
    gap: np.ndarray
    load: float | None
    approach: float = 0.0

    def coarsened(self) -> "NormalProblem":
        """The same problem on elements of twice the size."""
        block = self.half_space.mesh.block
        return replace(
            self,
            half_space=self.half_space.coarsened,
            gap=block_mean(self.gap, block, "edge"),
            load=None if self.load is None else self.load / math.prod(block),
        )


@dataclass(frozen=True)
class Transmission:
    """Forces to transmit, and the creepages that become unknowns instead.

    A unit of the unknown zeta_k adds the constant slip v_k to every element, and the force k is the
    sum of v_k . pi_t over the elements: work per revolution is force times creepage.

    Parameters
    ----------
    vectors : ndarray, shape (m, 2)
        v_k, in the scaled frame.
    target : ndarray, shape (m,)
        Forces to transmit.
    """

    vectors: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    target: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __len__(self) -> int:
        return len(self.target)

    @property
    def least(self) -> float:
        """Smallest size of the sum of all tractions that has the forces.

        No more than the sum of the bound can be had, in any direction.
        """
        if not len(self):
            return 0.0
        return float(np.linalg.norm(np.linalg.pinv(self.vectors) @ self.target))

    def others(self, slip: np.ndarray, creepage: np.ndarray) -> float:
        """Largest slip but for the creepages sought; the size of those that matter beside it."""
        if not len(self):
            return 0.0
        return float(np.abs(slip - self.slip(creepage)).max())

    def reach(self, creepage: np.ndarray, change: np.ndarray, others: float) -> float:
        """Longest part of a change that trusts its linearisation, at most 1.

        Where nearly everything slips the forces hardly answer the creepages, and a Newton step
        would run away. Full slip begins at a slip of order one, or of that of `others`.
        """
        size = np.abs(change).max(initial=0.0)
        trusted = 3.0 + np.abs(creepage).max(initial=0.0) + others
        return float(min(1.0, trusted / size)) if size > 0.0 else 1.0

    def lost(self, creepage: np.ndarray, others: float) -> bool:
        """Whether the creepages have run away: the forces are beyond what friction can carry."""
        return bool(np.abs(creepage).max(initial=0.0) > 1e4 * (1.0 + others))

    def slip(self, creepage: np.ndarray) -> np.ndarray:
        """Constant slip of the unknown creepages, shape (2, 1, 1)."""
        return (creepage @ self.vectors)[:, None, None]

    def force(self, traction: np.ndarray) -> np.ndarray:
        """Forces of a field of tractions, shape (m,)."""
        return self.vectors @ traction.sum(axis=(1, 2))

    def coarsened(self, block: tuple[int, int]) -> "Transmission":
        """The same forces on elements each of which stands for a block."""
        return replace(self, target=self.target / math.prod(block))


@dataclass(frozen=True)
class TangentialProblem:
    """Find |pi_t| <= bound with sigma = rigid + D pi_t and pi_t = -bound sigma/|sigma| in slip.

    Which sigma an element answers for is the stencil's (`operators.stencil`).

    Parameters
    ----------
    half_space : HalfSpace
        The operators.
    rigid : ndarray, shape (2, n_x, n_y)
        Slip of the undeformed bodies (and, of dissimilar bodies, the slip by the pressure).
    bound : ndarray, shape (n_x, n_y)
        The pressure pi_n; zero outside the contact.
    gap : ndarray, shape (n_x, n_y)
        Gap eta of the normal problem; it tells where within their elements the edges lie.
    transmission : Transmission
        Forces given in place of creepages.
    """

    half_space: HalfSpace
    rigid: np.ndarray
    bound: np.ndarray
    gap: np.ndarray
    transmission: Transmission = field(default_factory=Transmission)

    @cached_property
    def friction_slip(self) -> FrictionSlip:
        """The slip that the friction law sees."""
        return self.half_space.friction_slip(self.bound, self.gap)

    def coarsened(self) -> "TangentialProblem":
        """The same problem on elements of twice the size."""
        block = self.half_space.mesh.block
        return replace(
            self,
            half_space=self.half_space.coarsened,
            rigid=block_mean(self.rigid, block, "edge"),
            bound=block_mean(self.bound, block, "constant"),
            gap=block_mean(self.gap, block, "edge"),
            transmission=self.transmission.coarsened(block),
        )


@dataclass(frozen=True)
class CoupledProblem:
    """Both problems at once, for bodies whose pressure slips and whose tractions lift.

    Fields as in `NormalProblem` and `TangentialProblem`; the bound is the unknown pressure.
    """

    half_space: HalfSpace
    gap: np.ndarray
    rigid: np.ndarray
    load: float | None
    approach: float = 0.0
    transmission: Transmission = field(default_factory=Transmission)

    @property
    def normal(self) -> NormalProblem:
        """The normal problem without the lift by tractions."""
        return NormalProblem(self.half_space, self.gap, self.load, self.approach)

    def tangential(self, pressure: np.ndarray, gap: np.ndarray) -> TangentialProblem:
        """The tangential problem under a pressure and the gap that goes with it."""
        rigid = self.rigid + self.half_space.slip_by_pressure(pressure)
        return TangentialProblem(self.half_space, rigid, pressure, gap, self.transmission)

    def coarsened(self) -> "CoupledProblem":
        """The same problem on elements of twice the size."""
        normal = self.normal.coarsened()
        block = self.half_space.mesh.block
        return replace(
            self,
            half_space=normal.half_space,
            gap=normal.gap,
            rigid=block_mean(self.rigid, block, "edge"),
            load=normal.load,
            transmission=self.transmission.coarsened(block),
        )
