"""The methods that a scene may name, as data: what is tried first, and what after a failure."""

from dataclasses import dataclass, replace

from tractive_sam.solvers.falling_friction import Bracketing, Continuation, FromRest, UniqueSolution
from tractive_sam.solvers.krylov import ConjugateGradients
from tractive_sam.solvers.nested import AroundContact, Nested, RoughSequential, Sequential
from tractive_sam.solvers.newton import Newton
from tractive_sam.solvers.problem import Outcome, Problem, ProblemSolver, Start
from tractive_sam.solvers.projection import Anderson, Uzawa


@dataclass(frozen=True)
class Ladder:
    """Solver that tries several methods one after the other until one converges.

    Attributes
    ----------
    rungs : tuple of ProblemSolver
        The methods, the first one first.
    with_forces : int
        Number of methods, from the first one, that take prescribed tangential forces.
    begin : ProblemSolver, optional
        Finds a start for the second and later methods if there is none.
    """

    rungs: tuple[ProblemSolver, ...]
    with_forces: int
    begin: ProblemSolver | None = None

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem by the first method that converges; costs of all methods are added."""
        rungs = self.rungs[: self.with_forces] if len(problem.forces) else self.rungs
        outcome = rungs[0].solve(problem, tolerance, start)
        for rung in rungs[1:]:
            if outcome.converged:
                break
            if start is None and self.begin is not None:
                start = self.begin.solve(problem, tolerance)
                outcome = outcome.costing(start)
            outcome = rung.solve(problem, tolerance, start).after(outcome)
        return outcome


@dataclass(frozen=True)
class Method:
    """Solvers of a scene for bodies of equal and of different material, with descriptions.

    Attributes
    ----------
    alike : ProblemSolver
        For bodies of equal material: the pressure does not depend on the tractions.
    dissimilar : ProblemSolver
        For bodies of different material.
    description : str
        Description of the method.
    cure : str
        What to try if it does not converge.
    wears_in_pass : bool
        Whether it updates the wear of a pass within its iterations.
    predictable : bool
        Whether its cost is known beforehand.
    """

    alike: ProblemSolver
    dissimilar: ProblemSolver
    description: str
    cure: str = (
        "raise solver.tolerance, or refine the mesh with grid.elements if the contact is only a "
        "few elements wide"
    )
    wears_in_pass: bool = False
    predictable: bool = True


NORMAL = AroundContact(Nested(AroundContact(ConjugateGradients(), least_size=8192)))
PRESSURE_ONLY = Sequential(NORMAL)
"""Bodies without cause for traction."""

FIXED_PRESSURE, COUPLED = Newton(krylov=120), Newton(krylov=150)
NEARBY = Newton(
    krylov=60,  # three vectors of each iteration are stored
    halvings=3,
    rise=0.5,  # the response to a shorter step is known as well
    bounded=False,
    loosest=0.03,  # iterations cost less than the linearisations that they save
    aim=0.8,
    single_from=0,  # what is planned serves many steps
    gmres_from=50_000,  # above, three vectors would take most of the memory
)
"""Newton's method from a start nearby: a step or a revolution before."""

TANGENTIAL_NEWTON = Nested(FIXED_PRESSURE, nearby=NEARBY)
NEWTON = Sequential(NORMAL, TANGENTIAL_NEWTON)
ROUGH_SEQUENTIAL = RoughSequential(NORMAL, Nested(FIXED_PRESSURE))
"""Start of the method for dissimilar bodies."""

COUPLED_NEWTON = Nested(COUPLED, begin=ROUGH_SEQUENTIAL, nearby=NEARBY)

_NOT_AUTO = 'try solver.method = "auto"'

METHODS = {
    "auto": Method(
        alike=Sequential(
            NORMAL,
            Ladder(
                (
                    TANGENTIAL_NEWTON,
                    Bracketing(FIXED_PRESSURE, Continuation(FIXED_PRESSURE)),
                    Anderson(),
                ),
                with_forces=2,
            ),
        ),
        dissimilar=Ladder(
            (COUPLED_NEWTON, Bracketing(COUPLED, Continuation(COUPLED)), Anderson()),
            with_forces=2,
            begin=ROUGH_SEQUENTIAL,
        ),
        description="auto: newton; if it fails, continuation from full slip (given creepages) or a "
        "search between creepages (prescribed forces); then anderson (given creepages)",
    ),
    "newton": Method(NEWTON, COUPLED_NEWTON, "newton"),
    "anderson": Method(Sequential(NORMAL, Anderson()), Anderson(), "anderson", _NOT_AUTO),
    "uzawa": Method(Uzawa(), Uzawa(), "uzawa", _NOT_AUTO, wears_in_pass=True, predictable=False),
}
"""Methods by the names that ``solver.method`` may have."""


def falling_method(solver: ProblemSolver, sliding: bool) -> ProblemSolver:
    """Return a solver for friction that falls with sliding, built from another solver.

    Parameters
    ----------
    solver : ProblemSolver
        The method for friction that does not.
    sliding : bool
        Whether the solution reached from great speed is sought; else the one from rest.
    """
    if isinstance(solver, Sequential) and solver.tangential is not None:
        return replace(solver, tangential=falling_method(solver.tangential, sliding))
    nearby, last = solver, None
    if isinstance(solver, Ladder):
        nearby, last = solver.rungs[0], solver.rungs[1]
    # On the path from rest no start is near enough for the shorter method for a near start.
    far = replace(nearby, nearby=None) if isinstance(nearby, Nested) else nearby
    return UniqueSolution(nearby, FromRest(solver, far, last, sliding))
