"""Input and output of a solver: a start, and a solution with its residual, cost and course."""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

from tractive_sam.compute import backend_of
from tractive_sam.results import Cost, Status

Part = TypeVar("Part")


def needed(part: Part | None, name: str) -> Part:
    """Return an optional value unchanged; raise a TypeError that names it if it is None.

    Raises
    ------
    TypeError
        If it is missing, as in the outcome of a user-defined solver.
    """
    if part is None:
        raise TypeError(f"{name}: must be given here, and is None")
    return part


class ContactFields(NamedTuple):
    """Dimensionless fields of a solution: pressure, gap, traction, slip."""

    pressure: np.ndarray
    gap: np.ndarray
    traction: np.ndarray
    slip: np.ndarray


def relative(distance: float, size: float) -> float:
    """Return a distance divided by a size; the distance itself if the size is zero."""
    return float(distance / size) if size > 0.0 else float(distance)


def closed(pressure: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Return the pressure of elements in contact (pressure > gap), and zero elsewhere.

    An element is in contact if its pressure exceeds its gap, both dimensionless, so that the
    projection of the pressure, max(0, pressure - gap), is positive. Elsewhere an iteration leaves
    pressures of the size of its residual.

    Parameters
    ----------
    pressure, gap : ndarray, shape (n_x, n_y)
        pi_n and eta.
    """
    return backend_of(pressure).xp.where(pressure > gap, pressure, 0.0)


@dataclass(frozen=True)
class Note:
    """Entry of a solver's trace: method and mesh, how it ended, and further text.

    Attributes
    ----------
    what : str
        The method, and on what.
    status : Status
        How it ended.
    more : str
        How far it came.
    """

    what: str
    status: Status
    more: str = ""

    def __str__(self) -> str:
        return f"{self.what}: {self.status}{self.more}"


@dataclass(frozen=True, eq=False)
class Start:
    """Initial guess of a solver: any of pressure, traction, approach, creepages.

    An `Outcome` will do as well. The gap may be known, if pressure, gap and approach already solve
    the normal problem without tractions.
    """

    pressure: np.ndarray | None = None
    traction: np.ndarray | None = None
    approach: float = 0.0
    creepage: np.ndarray | None = None
    gap: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Outcome:
    """Result of a solver, dimensionless: fields, status, residual, cost and trace.

    Attributes
    ----------
    status : Status
        State at the end; only CONVERGED is a solution.
    residual : float
        Natural residual of the contact conditions, relative: the distance of the pressure from its
        projection, |p - project(p - r)| / |p| with r the gap, and the distance of the tractions,
        with r the slip, each over its size. If both are unknown, the larger one.
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
        The creepages found for prescribed forces.
    trace : tuple of Note
        Methods tried and fallbacks, step by step.
    top : (float, float), optional
        The largest force and its creepage, if no creepage has the first of the prescribed forces
        because friction falls with sliding.
    steepness : float, optional
        `solvers.uniqueness.steepness` of the solution, if the method has needed it.
    sliding, radius : ndarray, shape (n_x, n_y), optional
        Elements that slide, and the radius of the bound (`Problem.sliding`), if the method knows
        them.
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
    trace: tuple[Note, ...] = ()
    top: tuple[float, float] | None = None
    steepness: float | None = None
    sliding: np.ndarray | None = None
    radius: np.ndarray | None = None

    @property
    def converged(self) -> bool:
        """Whether the contact conditions hold to the tolerance."""
        return self.status is Status.CONVERGED

    @property
    def fields(self) -> ContactFields:
        """Fields of the contact; raises a TypeError if one of them was not solved for."""
        return ContactFields(
            *(needed(getattr(self, name), f"outcome.{name}") for name in ContactFields._fields)
        )

    def costing(self, earlier: "Outcome", share: float = 1.0) -> "Outcome":
        """Return the outcome with the cost of an earlier one added (times `share`)."""
        return replace(self, cost=self.cost + earlier.cost.scaled(share))

    def after(self, earlier: "Outcome") -> "Outcome":
        """Return the outcome with the cost and the trace of an earlier one added."""
        return replace(self.costing(earlier), trace=earlier.trace + self.trace)


class ProblemSolver(Protocol):
    """Protocol of solvers of contact problems: objects with a method `solve`."""

    def solve(self, problem: Any, tolerance: float, start: Any = None) -> Outcome:
        """Solve a problem, from a start if there is one; return the outcome, converged or not.

        Parameters
        ----------
        problem : Problem or NormalProblem
            The problem.
        tolerance : float
            Natural residual, relative, at which to stop.
        start : Start or Outcome, optional
            First guess.
        """
        ...
