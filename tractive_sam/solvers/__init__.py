"""Methods that see nothing but a dimensionless problem and return an outcome.

Each is a frozen record of its settings with a method `solve(problem, tolerance, start)`, and so may
be one of your own: `solve(scene, solver=...)` takes any object that has it. They combine: on nested
meshes, one after the other, by way of easier problems.

    >>> plain = ts.solvers.InSequence(ts.solvers.ConjugateGradients(), ts.solvers.Newton())
    >>> alike = ts.solve(scene, solver=plain)
    >>> round(alike.Qx / contact.Qx, 6)
    1.0
"""

import lazy_loader

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, _ = lazy_loader.attach_stub(__name__, __file__)

# Others are for the packages above, and no part of what users see.
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
