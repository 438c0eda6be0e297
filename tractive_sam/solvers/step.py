"""The contact problem of a step of transient rolling, or of a shift."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self, cast

import numpy as np

from tractive_sam.operators import FrictionSlip, StepOperators
from tractive_sam.solvers.problem import Box, Problem, block_mean

FAR = 60
"""Elements along a contact from which on the slip of each counts the less, the more there are."""


@dataclass(frozen=True, eq=False)
class StepProblem(Problem):
    """A `Problem` whose slip is that of a step, over the length of an element.

    Its operators are `operators.step.StepOperators`, and `rigid` holds all of the slip that does
    not change with the tractions sought: what the undeformed bodies slip on the way, less the
    displacements that the particles had before.

    Parameters
    ----------
    entering : ndarray, shape (n_x, n_y)
        Gap that particles close in the step before they are held.
    ahead : float
        Way of the step, in elements.
    """

    entering: np.ndarray = field(default_factory=lambda: np.zeros((1, 1)))
    ahead: float = 0.0
    joint = True

    def friction_slip(self, pressure: np.ndarray, gap: np.ndarray) -> FrictionSlip:
        """See `Problem.friction_slip`."""
        if self.held:
            return self._entering_held
        return self._entering(pressure)

    @cached_property
    def _entering_held(self) -> FrictionSlip:
        return self._entering(self.normal.pressure)

    def _entering(self, pressure: np.ndarray) -> FrictionSlip:
        operators = cast(StepOperators, self.operators)
        return operators.entering_slip(pressure, self.entering, self.ahead)

    def slip_weight(self, radius: np.ndarray) -> float:
        """See `Problem.slip_weight`: less, the more elements displace each other.

        Slip is displacement here. Counted in full, a step from rest is taken to slip everywhere,
        and where all tractions at their bound displace much too far, back again in the next.
        """
        along = np.count_nonzero((radius > 0.0).any(axis=1))
        first, _, second = cast(StepOperators, self.operators).self_influence
        return FAR / (max(along, FAR) * max(first, second))

    def coarsened(self) -> Self:
        """See `Problem.coarsened`; the slip is over the length of an element, which is twice it."""
        block = self.operators.lattice.block
        coarse = super().coarsened()
        return replace(
            coarse,
            rigid=coarse.rigid / block[0],
            entering=block_mean(self.entering, block, "edge"),
            ahead=self.ahead / block[0],
            friction=replace(coarse.friction, slip=block[0] * coarse.friction.slip),
        )

    def within(self, box: Box) -> Self:
        """See `Problem.within`."""
        return replace(super().within(box), entering=self.entering[box])
