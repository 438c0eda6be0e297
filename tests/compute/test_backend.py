"""The same contact with NumPy and with a library that has only the array API standard."""

from dataclasses import replace

import numpy as np
import pytest

from tests.solvers.small import ALIKE, DISSIMILAR, given_approach, problem_of
from tractive_sam.compute import backend_of
from tractive_sam.solvers import ConjugateGradients, Start, Uzawa

strict = pytest.importorskip("array_api_strict")

TIGHT = 1e-6
CLOSE = 1e-12  # of the largest value: both take the same steps, and round differently


def largest_difference(found, wanted):
    assert not isinstance(found, np.ndarray)
    return np.abs(backend_of(found).to_numpy(found) - wanted).max() / np.abs(wanted).max()


def in_both(problem):
    """The problem with arrays of NumPy, and with arrays of the other library."""
    normal = replace(problem.normal, gap=strict.asarray(problem.normal.gap))
    return problem, replace(problem, normal=normal, rigid=strict.asarray(problem.rigid))


@pytest.mark.slow
def test_a_rolling_contact_is_the_same():
    found = []
    for problem in in_both(problem_of(*ALIKE, elements=11, slip="auto")):
        normal = ConjugateGradients().solve(problem.normal, TIGHT)
        rolling = Uzawa().solve(problem.with_pressure(normal.pressure, normal.gap), TIGHT)
        assert normal.converged
        assert rolling.converged
        found.append((normal.pressure, normal.gap, rolling.traction, rolling.slip))
    assert all(largest_difference(*pair) < CLOSE for pair in zip(*found[::-1], strict=True))


@pytest.mark.slow
def test_a_contact_of_dissimilar_bodies_is_the_same():
    found = []
    for problem in in_both(given_approach(problem_of(*DISSIMILAR, elements=15))):
        normal = ConjugateGradients().solve(problem.normal, 1e-3)
        start = Start(pressure=normal.pressure, approach=normal.approach)
        outcome = Uzawa().solve(problem, TIGHT, start)
        assert outcome.converged
        found.append((outcome.pressure, outcome.gap, outcome.traction, outcome.slip))
    assert all(largest_difference(*pair) < CLOSE for pair in zip(*found[::-1], strict=True))


def test_operators_and_friction_are_the_same():
    rng = np.random.default_rng(5)
    slip, traction = rng.standard_normal((2, 2, 7, 9))
    pressure = np.maximum(rng.standard_normal((7, 9)), 0.0)
    places, factor, answer = np.nonzero(pressure > 1.0), rng.random(9), rng.random((9, 2, 2))
    number = len(places[0])
    operator = problem_of(*DISSIMILAR).operators.part((7, 9)).coupled
    found = []
    for asarray in (np.asarray, strict.asarray):
        p, s, t = (asarray(field) for field in (pressure, slip, traction))
        backend = backend_of(p)
        found.append(
            (
                operator(backend.concat((p[None, ...], t))),
                backend.project(t, p),
                backend.turn(s, p, 0.8),
                backend.add_leading_response(s, t, places, factor[:number], answer[:number]),
            )
        )
    assert all(largest_difference(*pair) < CLOSE for pair in zip(*found[::-1], strict=True))
