"""Temperature by moving heat sources: against Green's function, closed forms and each other."""

from itertools import pairwise
from math import asinh, log, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import dblquad

from tractive_sam.operators.heat import STEPS_FROM, SurfaceHeat, temperature_coefficients
from tractive_sam.results import Grid


def at(x, y, k, dx=1.0, dy=1.0):
    """By unit diffusivity and conductivity, of the speed 2 k."""
    return temperature_coefficients(np.atleast_1d(x), np.atleast_1d(y), dx, dy, 2.0 * k, 1.0, 1.0)


@pytest.mark.parametrize(
    ("place", "k"),
    [
        ((0.0, 0.0), 1e-3),
        ((0.0, 0.0), 0.3),
        ((0.0, 0.0), 3.0),
        ((1.0, 0.0), 3.0),
        ((-2.0, 1.0), 0.3),
    ],
)
def test_element_against_greens_function(place, k):
    """exp(-k (r + x))/(2 pi r), integrated by adaptive quadrature from singularity to side."""
    x, y = place
    parts = [0.0] if place == (0.0, 0.0) else []
    sides_x, sides_y = (sorted([c - 0.5, c + 0.5, *parts]) for c in place)
    direct = sum(
        dblquad(
            lambda b, a: np.exp(-k * (np.hypot(a, b) + a)) / np.hypot(a, b), *across, *along,
            epsabs=1e-11, epsrel=1e-10,
        )[0]
        for across in pairwise(sides_x)
        for along in pairwise(sides_y)
    )  # fmt: skip
    assert at(x, y, k)[0, 0] == pytest.approx(direct / (2.0 * pi), rel=1e-9)  # quadrature


def test_element_at_rest():
    assert at(0.0, 0.0, 0.0)[0, 0] == pytest.approx(4.0 * asinh(1.0) / (2.0 * pi), rel=1e-13)
    assert at(100.0, 0.0, 0.0)[0, 0] == pytest.approx(1 / (200.0 * pi), rel=1e-5)  # 1/24e4


@pytest.mark.parametrize("peclet", 10.0 ** np.arange(-3, 10))
def test_any_speed(peclet):
    """Finite, positive, falling upstream; its size is near the limit of rest or of the strip."""
    n, dx = 41, 0.05
    x = dx * np.arange(1 - n, n)
    known = at(x, dx * np.arange(n), peclet, dx, dx)
    assert np.isfinite(known).all()
    assert known.min() >= 0.0
    here = known[n - 1, 0]
    rest = 2.0 * dx * asinh(1.0) / pi
    strip = 2.0 * sqrt(0.5 * dx / (2.0 * peclet) / pi)
    assert here < min(rest, 1.01 * strip)
    if peclet * dx > 1e3:
        assert here == pytest.approx(strip, rel=1e-3)  # 1/(4 k dx)
    if peclet < 1e-2:
        assert here == pytest.approx(rest, rel=1e-2)  # k dx
    assert (np.diff(known[n - 1 :, 0]) <= 0.0).all()


def test_continuous_where_fronts_become_steps():
    x, y = np.arange(-20.0, 21.0), np.arange(21.0)
    below, above = (at(x, y, STEPS_FROM * (1.0 + e)) for e in (-1e-12, 1e-12))
    assert np.abs(above - below).max() < 2e-8 * below.max()  # (0.1/(k dx))^2


def covered(n, half):
    """Shares of the elements of a square mesh that a disc of unit radius covers."""
    grid = Grid((half, half), (n, n))
    fine = (np.arange(20) + 0.5) / 20 - 0.5
    X, Y = grid.x[:, None, None, None], grid.y[None, :, None, None]
    inside = (X + grid.dx * fine[:, None]) ** 2 + (Y + grid.dy * fine) ** 2 < 1.0
    return grid, inside.mean(axis=(2, 3))


@pytest.mark.parametrize(
    ("peclet", "largest", "mean"),
    [
        (0.0, 1.0, 8.0 / (3.0 * pi)),
        (1.0, 0.7324, 0.5554),
        (5.0, 0.4527, 0.2942),
        (20.0, 0.2455, 0.1522),
        (100.0, 0.1121, 0.0687),
    ],
)
def test_disc(peclet, largest, mean):
    """T_max and mean lambda/(q a); the others are Tian and Kennedy's to 2 %, and mesh-converged."""
    errors = []
    for n in (32, 64, 128):
        grid, share = covered(n, 1.1)
        warm = SurfaceHeat(grid, 2.0 * peclet, 1.0, 1.0)(share)
        average = (warm * share).sum() / share.sum()
        errors.append((abs(warm.max() / largest - 1.0), abs(average / mean - 1.0)))
    assert max(errors[-1]) < 1e-3  # requested: 1e-2
    assert errors[-1][1] < errors[0][1]


def test_strips():
    n, speed = 512, 2e6
    grid = Grid((1.0, 0.5), (n, 1))
    heat = SurfaceHeat(grid, speed, 1.0, 1.0)
    uniform = heat(np.ones((n, 1)))[:, 0]
    way = 1.0 - grid.x
    strip = 2.0 * np.sqrt(way / (pi * speed))
    np.testing.assert_allclose(uniform, strip, rtol=1e-4)  # 1/(4 k dx) in the first element
    elliptic = heat(np.sqrt(1.0 - grid.x**2)[:, None])[:, 0]
    assert elliptic.max() * sqrt(pi * speed) == pytest.approx(2.1883, rel=1e-4)  # its digits
    assert way[elliptic.argmax()] == pytest.approx(1.65, abs=0.005)


def test_heat_goes_with_the_body():
    """Far behind a source the section it warmed holds the heat: integral of T over depth and y.

    At the surface T across the wake is q A/(lambda sqrt(...)) times a bell; its integral over y
    equals the one of a strip of equal heat.
    """
    speed, behind = 200.0, -30.0
    y = 0.05 * np.arange(-600, 601)
    wake = temperature_coefficients(np.array([behind]), y, 0.5, 0.5, speed, 1.0, 1.0)[0]
    strip = temperature_coefficients(np.array([behind]), np.zeros(1), 0.5, np.inf, speed, 1.0, 1.0)[
        0, 0
    ]
    assert wake.sum() * 0.05 == pytest.approx(0.5 * strip, rel=1e-6)  # the bell's tails


def test_self_heating_is_logarithmic_in_slow_lines():
    """Two lines at rest differ by ln 2/pi for twice the speed, as the closed form K_0 has it."""
    slow, slower = (at(0.0, 0.0, k, dy=np.inf)[0, 0] for k in (2e-4, 1e-4))
    assert slower - slow == pytest.approx(log(2.0) / pi, rel=1e-3)  # k dx ln(k dx)
