"""Small problems with dense truth: the matrices of the operators, and plain iterations on them."""

from dataclasses import replace

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.scene import Scene
from tractive_sam.solvers import ConjugateGradients, Problem
from tractive_sam.solvers.ladder import NORMAL

ALIKE = ("grid.half_length=[4.08, 4.08]", "creepage.lateral=0.0005")
DISSIMILAR = (*ALIKE, "body.B.shear=8.0", "body.B.poisson=0.45")


def problem_of(*settings, elements=13, slip="upwind") -> Problem:
    """The contact problem of two spheres, by default with the slip of the paper."""
    mesh = (f"grid.elements=[{elements}, {elements}]", f'solver.slip="{slip}"')
    model = Model(Scene.builtin("spheres").with_set([*settings, *mesh]))
    return model.problem(model.undeformed_gap / model.units.gap)


def with_fixed_pressure(problem: Problem) -> Problem:
    """The tangential problem under the pressure without tractions."""
    normal = NORMAL.solve(problem.normal, 1e-12)
    return problem.with_pressure(normal.pressure, normal.gap)


def tangential_problem(elements=21, slip="auto") -> Problem:
    """The tangential problem of two spheres that roll with longitudinal creepage."""
    return with_fixed_pressure(
        problem_of("grid.half_length=[4.08, 4.08]", elements=elements, slip=slip)
    )


def given_approach(problem: Problem) -> Problem:
    """Return nearly this contact under the approach that its load takes without tractions."""
    approach = ConjugateGradients().solve(problem.normal, 1e-12).approach
    return replace(problem, normal=replace(problem.normal, load=None, approach=approach))


def disc(traction, radius):
    """The nearest point of the disc, by plain numpy."""
    size = np.hypot(*traction)
    return traction * np.minimum(1.0, radius / np.maximum(size, 1e-300))
