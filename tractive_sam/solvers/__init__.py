"""Methods that see nothing but a dimensionless problem and return an outcome.

Each is a frozen record of its settings with a method `solve(problem, tolerance, start)`, and so may
be one of your own: `solve(scene, solver=...)` takes any object that has it. They combine: on nested
meshes, one after the other, by way of easier problems.

    >>> plain = ts.solvers.InSequence(ts.solvers.ConjugateGradients(), ts.solvers.Newton())
    >>> alike = ts.solve(scene, solver=plain)
    >>> round(alike.Qx / contact.Qx, 6)
    1.0
"""

# Names given twice are for the rooms above, and no part of what users see.
from tractive_sam.results import Cost, Status
from tractive_sam.solvers.anderson import Anderson
from tractive_sam.solvers.anderson import combined as combined
from tractive_sam.solvers.bracketing import Bracketing
from tractive_sam.solvers.conjugate_gradients import ConjugateGradients
from tractive_sam.solvers.continuation import Continuation
from tractive_sam.solvers.from_rest import FromRest
from tractive_sam.solvers.gmres import gmres as gmres
from tractive_sam.solvers.in_sequence import InSequence, OneAfterTheOther
from tractive_sam.solvers.ladder import ALONE as ALONE
from tractive_sam.solvers.ladder import METHODS as METHODS
from tractive_sam.solvers.ladder import NEARBY as NEARBY
from tractive_sam.solvers.ladder import Ladder
from tractive_sam.solvers.ladder import Method as Method
from tractive_sam.solvers.ladder import falling_method as falling_method
from tractive_sam.solvers.nested import Nested
from tractive_sam.solvers.newton import Newton
from tractive_sam.solvers.newton_system import Iterate as Iterate
from tractive_sam.solvers.newton_system import System as System
from tractive_sam.solvers.outcome import Note, Outcome, Solver, Start
from tractive_sam.solvers.problem import Held, NormalProblem, PrescribedForces, Problem
from tractive_sam.solvers.problem import WearInPass as WearInPass
from tractive_sam.solvers.uniqueness import steepness as steepness
from tractive_sam.solvers.uzawa import Uzawa
from tractive_sam.solvers.watched import watched_by as watched_by

__all__ = [
    "Anderson",
    "Bracketing",
    "ConjugateGradients",
    "Continuation",
    "Cost",
    "FromRest",
    "Held",
    "InSequence",
    "Ladder",
    "Nested",
    "Newton",
    "NormalProblem",
    "Note",
    "OneAfterTheOther",
    "Outcome",
    "PrescribedForces",
    "Problem",
    "Solver",
    "Start",
    "Status",
    "Uzawa",
]
