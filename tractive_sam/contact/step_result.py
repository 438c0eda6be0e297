"""Input and result of a step of transient rolling, or of a shift."""

from dataclasses import dataclass, field, replace

import numpy as np

from tractive_sam.results import Grid, State, widen_field
from tractive_sam.solvers import NormalProblem

Three = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class StepInput:
    """Prescribed quantities of a time step: distance, creepages or forces, load, friction.

    Attributes
    ----------
    distance : float
        Rolling distance, mm; 0: a shift.
    creepages : tuple of float
        Longitudinal, lateral and spin creepage, means over the distance; for a shift the shifts in
        x and y, mm, and the turn, radians. A creepage with a prescribed force is ignored.
    load, approach : float or None
        Normal load, N, or approach, mm, at the end of the step.
    forces : tuple of float or None
        (Q_x, Q_y) at the end, N, in place of creepages.
    friction : float
        Factor on the bound of friction at the end.
    friction_before : float, optional
        Factor at the beginning; by default the factor at the end.
    separation : ndarray, shape (n_x, n_y), or float
        Separation added to the undeformed gap at the end, mm.
    """

    distance: float = 0.0
    creepages: Three = (0.0, 0.0, 0.0)
    load: float | None = None
    approach: float | None = None
    forces: tuple[float | None, float | None] = (None, None)
    friction: float = 1.0
    friction_before: float | None = None
    separation: np.ndarray | float = 0.0

    @property
    def mean_friction(self) -> float:
        """Mean over the step of the factor on friction, on which wear depends."""
        first = self.friction if self.friction_before is None else self.friction_before
        return (first + self.friction) / 2.0


@dataclass(frozen=True, eq=False)
class StepResult:
    """Result of a time step: the contact at its end, its work, and the wear depth.

    Attributes
    ----------
    contact : State
        The contact. Its slip and creepages are means of the step per distance rolled; for a shift
        the slip itself, mm.
    supplied : float
        Work of the forces that drive the bodies, N mm: of tangential forces and, for dissimilar
        bodies, of the load.
    friction : float
        Work of friction, N mm.
    distance : float
        Rolling distance of the step, mm.
    shifted : bool
        Whether it was a shift.
    energy : float
        Elastic energy at the end, N mm: of the tractions, for dissimilar bodies with the pressure.
    displacement : ndarray, shape (2 or 3, n_x + reach, n_y)
        Dimensionless, at the nodes of the mesh and ahead of it.
    normal : NormalProblem, optional
        Normal problem that its pressure solves, if it does not depend on tractions.
    worn : ndarray, shape (2, n_x, n_y)
        Depth that the particles of A and B at the elements lost since the start, mm.
    gained : ndarray, shape (2, n_x, n_y)
        Part of it that they lost in the step.
    deep : float
        Depth worn in the step over the largest depth that pressure can follow.
    extrapolation_error : ndarray, shape (2, n_x, n_y), optional
        Traction less its linear extrapolation from the two steps before, MPa; None without one.
    """

    contact: State
    supplied: float = 0.0
    friction: float = 0.0
    distance: float = 0.0
    shifted: bool = False
    energy: float = 0.0
    displacement: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)), repr=False)
    normal: NormalProblem | None = field(default=None, repr=False)
    worn: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)), repr=False)
    gained: np.ndarray = field(default_factory=lambda: np.zeros((2, 0, 0)), repr=False)
    deep: float = 0.0
    extrapolation_error: np.ndarray | None = field(default=None, repr=False)

    def on(self, grid: Grid) -> "StepResult":
        """Return the result on a wider mesh: depths continue behind, displacement is empty.

        Behind the former mesh the depths equal the depth at its end.
        """
        worn, gained = (widen_field(depth, grid.elements) for depth in (self.worn, self.gained))
        behind = (grid.elements[0] - self.worn.shape[1]) // 2
        worn[:, :behind] = worn[:, behind : behind + 1]
        unknown = replace(
            self, displacement=np.zeros((2, 0, 0)), normal=None, extrapolation_error=None
        )
        return replace(unknown, contact=self.contact.on(grid), worn=worn, gained=gained)

    def since(self, earlier: "StepResult | None") -> "StepResult":
        """Return this step less the work, distance and wear of `earlier`, a shorter step."""
        if earlier is None:
            return self
        return replace(
            self,
            supplied=self.supplied - earlier.supplied,
            friction=self.friction - earlier.friction,
            distance=self.distance - earlier.distance,
            gained=self.gained - earlier.gained,
        )

    def has_pressure_of(self, normal: NormalProblem) -> bool:
        """Return whether the pressure of the step solves this normal problem."""
        if self.normal is None or not self.contact.touching.any():
            return False
        return normal.is_the_same_as(self.normal)
