"""The status and the cost of a solve."""

from dataclasses import dataclass, field
from enum import StrEnum
from operator import add


class Status(StrEnum):
    """How a solve ended: converged, or the reason for its failure."""

    CONVERGED = "converged"
    OUT_OF_ITERATIONS = "out of iterations"
    DIVERGED = "diverged"
    OFF_GRID = "off grid"
    NOT_RESOLVED = "not resolved"
    INACCURATE = "inaccurate"


@dataclass(frozen=True)
class Cost:
    """Computational cost of a solve, in counts that do not depend on the machine, and its time.

    Attributes
    ----------
    applications : float
        Applications of the displacement, slip or coupled operator; on coarser meshes weighted by
        their share of the elements.
    preconditioner : float
        Applications of circulant inverses and, within a step of a transient, of the operators on a
        shorter period; each has as many transforms, of a quarter to half the size.
    convolutions : float
        All padded transforms of the solve, of operators and preconditioners, over the number in one
        application of the tangential operator on the mesh (`compute.fft`).
    over_application : float
        CPU time of the solve over the time of such an application, measured in the solve. The first
        solve on a mesh also plans its transforms. It is not compared.
    """

    applications: float = 0.0
    preconditioner: float = 0.0
    convolutions: float = 0.0
    over_application: float = field(default=0.0, compare=False)

    def __add__(self, other: "Cost") -> "Cost":
        return Cost(*map(add, vars(self).values(), vars(other).values()))

    def scaled(self, share: float) -> "Cost":
        """Return the cost multiplied by a share, for work on a coarser mesh."""
        return Cost(*(share * part for part in vars(self).values()))
