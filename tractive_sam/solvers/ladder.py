"""The methods that a scene may name, as data: what is tried, and what where that fails."""

from dataclasses import dataclass, replace

from tractive_sam.solvers.anderson import Anderson
from tractive_sam.solvers.bracketing import Bracketing
from tractive_sam.solvers.conjugate_gradients import ConjugateGradients
from tractive_sam.solvers.continuation import Continuation
from tractive_sam.solvers.from_rest import FromRest
from tractive_sam.solvers.in_sequence import InSequence, OneAfterTheOther
from tractive_sam.solvers.nested import Nested
from tractive_sam.solvers.newton import Newton
from tractive_sam.solvers.outcome import Outcome, Solver, Start
from tractive_sam.solvers.problem import Problem
from tractive_sam.solvers.sparing import Sparing
from tractive_sam.solvers.uniqueness import OneSolution
from tractive_sam.solvers.uzawa import Uzawa


@dataclass(frozen=True)
class Ladder:
    """Methods one after the other, until one converges.

    Attributes
    ----------
    rungs : tuple of Solver
        The methods, the first one first.
    with_forces : int
        How many of them take prescribed tangential forces.
    begin : Solver, optional
        Finds a start for the second and later ones where there is none.
    """

    rungs: tuple[Solver, ...]
    with_forces: int
    begin: Solver | None = None

    def solve(
        self, problem: Problem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve a problem; see `Solver`. The outcome has the cost and trace of every rung."""
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
    """A method of a scene.

    Attributes
    ----------
    alike : Solver
        Of bodies of equal material, the pressure of which does not feel the tractions.
    dissimilar : Solver
        Of others.
    told : str
        What it does.
    cure : str
        What to try where it does not converge.
    wears_in_pass : bool
        Whether it updates the wear of a pass within its iterations.
    predictable : bool
        Whether its cost is known beforehand.
    """

    alike: Solver
    dissimilar: Solver
    told: str
    cure: str = (
        "raise solver.tolerance, or refine the mesh with grid.elements where the contact is only a "
        "few elements wide"
    )
    wears_in_pass: bool = False
    predictable: bool = True

    @classmethod
    def of(cls, solver: Solver) -> "Method":
        """A solver of one's own, for all bodies."""
        return cls(solver, solver, repr(solver))


NORMAL = Nested(ConjugateGradients())
ALONE = InSequence(NORMAL)
"""Bodies without cause for traction."""

HELD, COUPLED = Newton(krylov=120), Newton(krylov=150)
NEWTON = InSequence(NORMAL, Nested(HELD))
ONE_AFTER_THE_OTHER = OneAfterTheOther(NORMAL, Nested(HELD))
"""Where the method for dissimilar bodies starts."""

COUPLED_NEWTON = Nested(COUPLED, begin=ONE_AFTER_THE_OTHER)

_NOT_AUTO = 'try solver.method = "auto"'

METHODS = {
    "auto": Method(
        alike=InSequence(
            NORMAL,
            Ladder((Nested(HELD), Bracketing(HELD, Continuation(HELD)), Anderson()), with_forces=2),
        ),
        dissimilar=Ladder(
            (COUPLED_NEWTON, Bracketing(COUPLED, Continuation(COUPLED)), Anderson()),
            with_forces=2,
            begin=ONE_AFTER_THE_OTHER,
        ),
        told="auto: newton; where that fails, of given creepages continued from full slip, then "
        "anderson, and of prescribed forces by creepages in place of a force",
    ),
    "newton": Method(NEWTON, COUPLED_NEWTON, "newton"),
    "anderson": Method(InSequence(NORMAL, Anderson()), Anderson(), "anderson", _NOT_AUTO),
    "uzawa": Method(Uzawa(), Uzawa(), "uzawa", _NOT_AUTO, wears_in_pass=True, predictable=False),
}
"""By the names that ``solver.method`` may have."""

STEPS = Method(
    alike=InSequence(
        NORMAL,
        Ladder(
            (Nested(Sparing()), Bracketing(HELD, Continuation(HELD)), Anderson()),
            with_forces=2,
        ),
    ),
    dissimilar=Ladder(
        (
            Nested(Sparing(), begin=ONE_AFTER_THE_OTHER),
            Bracketing(COUPLED, Continuation(COUPLED)),
            Anderson(),
        ),
        with_forces=2,
        begin=ONE_AFTER_THE_OTHER,
    ),
    told="newton, from the two steps before; where that fails as auto",
)
"""That of a step of a transient."""


def single_solution_method(solver: Solver, sliding: bool) -> Solver:
    """Return a method of steps for friction that falls with sliding.

    Parameters
    ----------
    solver : Solver
        The method of steps whose friction does not.
    sliding : bool
        Of several solutions, whether the one reached from great speed is sought, not from rest.
    """
    if isinstance(solver, InSequence):
        return replace(solver, tangential=single_solution_method(solver.tangential, sliding))
    nearby = solver.rungs[0] if isinstance(solver, Ladder) else solver
    return OneSolution(nearby, FromRest(solver, nearby, sliding))
