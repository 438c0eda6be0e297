"""What a solver returns: a solution with its residual, its cost and how it ended."""

from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.results.status import Cost, Status


def relative(distance: float, size: float) -> float:
    """A distance over a size, or the distance itself where there is no size."""
    return float(distance / size) if size > 0.0 else float(distance)


@dataclass(frozen=True)
class Outcome:
    """Result of a solver, dimensionless; fields of a problem it did not solve are None.

    Attributes
    ----------
    status : Status
        How it ended; only CONVERGED is a solution.
    residual : float
        Natural residual of the contact conditions, relative: the distance of the pressure from its
        projection, |p - project(p - r)| / |p| with r the gap, and that of the tractions, with r the
        slip, each over its own size; the larger one, where both are solved for.
    iterations : int
        Outer iterations on the finest mesh.
    cost : Cost
        Work done, coarser meshes included.
    pressure, gap : ndarray, shape (n_x, n_y), optional
        pi_n and eta.
    traction, slip : ndarray, shape (2, n_x, n_y), optional
        pi_t and sigma.
    approach : float, optional
        delta.
    creepage : ndarray, shape (m,), optional
        The creepages found where forces were given.
    trace : tuple of str
        What was done, step by step: methods tried, meshes, fallbacks.
    """

    status: Status
    residual: float
    iterations: int
    cost: Cost
    pressure: np.ndarray | None = None
    gap: np.ndarray | None = None
    traction: np.ndarray | None = None
    slip: np.ndarray | None = None
    approach: float | None = None
    creepage: np.ndarray | None = None
    trace: tuple[str, ...] = ()

    @property
    def converged(self) -> bool:
        """Whether the contact conditions hold to the tolerance asked for."""
        return self.status is Status.CONVERGED

    def after(self, earlier: "Outcome", share: float = 1.0) -> "Outcome":
        """This outcome with the cost and trace of the work that led to it."""
        return replace(
            self,
            cost=self.cost + earlier.cost.scaled(share),
            trace=earlier.trace + self.trace,
        )
