"""Influence coefficients of bodies that relax, against quadrature of their memory."""

from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.kernels.half_space import integrals
from tractive_sam.mechanics.relaxation import FadingMemory

SPEED, COUNT = 100.0, 40
RUBBER, RIGID = ts.Material(1.0, 0.3), ts.Material(np.inf, 0.5)


def quadrature(component, x, y, sides, reach, step=0.0):
    """The integral of exp(-s/T) K(x + s)/T, in panels between the edges of the element.

    With a step d, times min(s/d, 1).
    """
    dx = sides[0]
    edges = [s for s in (-0.5 * dx - x, 0.5 * dx - x, step) if s > 0.0]
    edges = np.unique([0.0, *edges, *np.geomspace(min(dx, reach) / 50.0, 45.0 * reach, 60)])
    nodes, weights = np.polynomial.legendre.leggauss(16)
    low, high = edges[edges <= 45.0 * reach][:-1, None], edges[edges <= 45.0 * reach][1:, None]
    s = low + 0.5 * (high - low) * (1.0 + nodes)
    r1, _, _, xy, x2, _ = integrals((x + s).ravel(), np.full(s.size, y), *sides)
    zz, LL, TT, Lz = RUBBER.compliances
    kernel = {"zz": zz * r1, "xy": (TT - LL) * xy, "xz": -Lz * x2}[component].reshape(s.shape) / (
        2.0 * np.pi
    )
    weights = weights * np.exp(-s / reach) / reach * np.minimum(s / step if step else 1.0, 1.0)
    return float((0.5 * (high - low) * weights * kernel).sum())


@pytest.mark.parametrize("sides", [(0.1, 0.1), (0.1, 0.4), (0.4, 0.1)])
@pytest.mark.parametrize(("reach", "error"), [(1e-3, 1e-5), (0.03, 2e-4), (1.0, 3e-5), (1e3, 1e-6)])
def test_memory_is_that_of_quadrature(sides, reach, error):
    """Errors over the largest coefficient; the polynomials meet the bends at element edges.

    The bends of "xz" are sharper.
    """
    body = ts.RelaxingBody(RUBBER, ((1.0, reach / SPEED),))
    law = ts.RelaxingHalfSpaces(body, RIGID, speed=SPEED)
    plain = ts.LinearHalfSpaces(RUBBER, RIGID)
    largest = plain.coefficients("zz", (1, 1), *sides)[0, 0]
    for component, parity in (("zz", 1.0), ("xy", -1.0), ("xz", -1.0)):
        offsets = component, (COUNT, COUNT), *sides
        even = law.coefficients(*offsets) - plain.coefficients(*offsets)
        lag = law.lag(*offsets)
        for i, j in ((-30, 0), (-2, 1), (-1, 0), (0, 0), (0, 5), (1, 0), (2, 1), (8, 0), (30, 5)):
            found = even[abs(i), j] + lag[abs(i), j]
            if i < 0:
                found = parity * (even[-i, j] - lag[-i, j])
            exact = quadrature(component, i * sides[0], j * sides[1], sides, reach)
            assert found == pytest.approx(
                exact, abs=(10.0 if component == "xz" else 1.0) * error * largest
            )


@pytest.mark.parametrize("step", [0.003, 0.1, 0.137, 0.5])
@pytest.mark.parametrize("reach", [0.03, 0.3, 30.0])
def test_memory_after_a_step_is_that_of_quadrature(reach, step):
    """With the bounds of the memory itself; also far ahead only."""
    law = FadingMemory(RUBBER, RIGID, None, 1.0, reach, step)
    largest = ts.LinearHalfSpaces(RUBBER, RIGID).coefficients("zz", (1, 1), 0.1, 0.1)[0, 0]
    for component, parity in (("zz", 1.0), ("xy", -1.0), ("xz", -1.0)):
        offsets = component, (COUNT, COUNT), 0.1, 0.1
        even, lag = law.coefficients(*offsets), law.lag(*offsets)
        for i, j in ((-30, 0), (-1, 0), (0, 0), (0, 5), (1, 0), (2, 1), (30, 5)):
            found = even[i, j] + lag[i, j] if i >= 0 else parity * (even[-i, j] - lag[-i, j])
            exact = quadrature(component, 0.1 * i, 0.1 * j, (0.1, 0.1), reach, step)
            assert found == pytest.approx(exact, abs=2e-4 * largest)
        far = replace(law, far=True)
        ahead = far.coefficients(*offsets) + far.lag(*offsets)
        assert ahead[12:] == pytest.approx((even + lag)[12:], abs=1e-8 * largest)


def test_spectrum_is_that_of_the_periodic_response():
    """The preconditioner; both differ by the mean over an element of short waves alone."""
    body = ts.RelaxingBody(RUBBER, ((1.0, 0.002), (2.0, 0.01)))
    law = ts.RelaxingHalfSpaces(body, RIGID, speed=SPEED)
    plain = ts.LinearHalfSpaces(RUBBER, RIGID)
    ratio = law.periodic("zz", (32, 32), 0.1, 0.1) / plain.periodic("zz", (32, 32), 0.1, 0.1)
    k = 2.0 * np.pi * np.fft.fftfreq(32) / 0.1
    assert ratio == pytest.approx(np.repeat(body.factor(k, SPEED)[:, None], 17, axis=1), rel=1e-12)
    assert (ratio.real > 1.0).all()
