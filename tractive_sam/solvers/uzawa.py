"""Uzawa's method: the paper's solver and the baseline that the others are measured against."""

from dataclasses import dataclass
from itertools import count
from typing import ClassVar

import numpy as np

from tractive_sam.solvers.projection import ProjectedMap, Projection, States


@dataclass(frozen=True)
class Uzawa(Projection):
    """Solver by Uzawa's iteration: repeated projected steps (paper, section 7.5).

    Departures from the paper: the paper stops on the change of the iterate, which is small also
    after a short step; here the residual of the contact conditions has to fall. The paper leaves
    the choice of the steps to the user; here they follow from a bound and are shortened if the
    residual does not fall.

    Attributes
    ----------
    step_factor : float
        Step of the slip over its bound: fastest at 31 x 31 and at 91 x 91 on the scene `spheres`; 8
        and 10 times the bound diverge there.
    iterations : int
        Most iterations.
    patience : int
        Iterations without a smaller residual after which the step counts as too long.
    shorter : float
        Factor by which the step is shortened then.
    """

    step_factor: float = 5.5
    iterations: int = 100_000
    patience: int = 400
    shorter: float = 0.7

    name: ClassVar[str] = "uzawa"

    def _states(self, mapping: ProjectedMap, state: np.ndarray) -> States:
        """Yield (map, state) to evaluate; shorten the steps if the residual stagnates."""
        best, smallest, since = state, np.inf, 0
        for taken in count():
            evaluation = yield mapping, state
            if evaluation.residual < smallest:
                best, smallest, since = state, evaluation.residual, taken
            elif not np.isfinite(evaluation.residual) or taken - since > self.patience:
                mapping = mapping.shortened(self.shorter)
                state, since = best, taken
                continue
            state = evaluation.image
