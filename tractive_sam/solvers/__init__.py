"""Solution methods: each receives only a dimensionless problem and returns an outcome.

Each is a frozen record of its settings with a method `solve(problem, tolerance, start)`;
`solve(scene, solver=...)` takes any object with that method. They combine: on nested meshes, in
sequence, by easier problems.

    >>> plain = ts.solvers.Sequential(ts.solvers.ConjugateGradients(), ts.solvers.Newton())
    >>> alike = ts.solve(scene, solver=plain)
    >>> round(alike.Qx / contact.Qx, 6)
    1.0
"""

from tractive_sam.lazy_names import attach_names, with_renamed

# Names, listed in __init__.pyi, are looked up when first used.
_lookup, __dir__, _ = attach_names(__name__, __file__)
_RENAMED = {
    "Held": "FixedPressure",
    "InSequence": "Sequential",
    "OneAfterTheOther": "RoughSequential",
    "Solver": "ProblemSolver",
}
__getattr__ = with_renamed(__name__, _lookup, _RENAMED)

# Others are for the packages above, and no part of what users see.
__all__ = [
    "Anderson",
    "Bracketing",
    "ConjugateGradients",
    "Continuation",
    "Cost",
    "FixedPressure",
    "FromRest",
    "Ladder",
    "Nested",
    "Newton",
    "NormalProblem",
    "Note",
    "Outcome",
    "PrescribedForces",
    "Problem",
    "ProblemSolver",
    "RoughSequential",
    "Sequential",
    "Start",
    "Status",
    "Uzawa",
]
