"""Rectangle integrals against quadrature of the point kernels, and their laws."""

import numpy as np
import pytest
from scipy.integrate import quad_vec

from tractive_sam.kernels import half_space
from tractive_sam.kernels.half_space import quadrant

GAUSS = np.polynomial.legendre.leggauss(40)
NODES, WEIGHTS = 0.5 * (GAUSS[0] + 1.0), 0.5 * GAUSS[1]


def integrands(x, y):
    r = np.hypot(x, y)
    return np.stack((1 / r, x**2 / r**3, y**2 / r**3, x * y / r**3, x / r**2, y / r**2))


def from_corner(lx, ly):
    """Integrals over the rectangle from the origin to (lx, ly), signed like lx ly.

    The integrands are homogeneous of degree -1, so that over the two triangles between the origin
    and the far sides (Duffy) the radial integral is trivial; the other is done adaptively.
    """
    if lx == 0.0 or ly == 0.0:
        return np.zeros(6)
    sides = (lambda v: integrands(lx, v * ly)), (lambda v: integrands(v * lx, ly))
    return sum(quad_vec(side, 0, 1, epsabs=0, epsrel=1e-12)[0] for side in sides) * lx * ly


def near_truth(x, y, dx, dy):
    # Observer minus source: the rectangle as seen from the observer runs from x - dx/2 to x + dx/2.
    x1, x2, y1, y2 = x - dx / 2, x + dx / 2, y - dy / 2, y + dy / 2
    corners = ((x2, y2, 1), (x1, y1, 1), (x1, y2, -1), (x2, y1, -1))
    return sum(sign * from_corner(a, b) for a, b, sign in corners)


def far_truth(x, y, dx, dy):
    u, v = np.meshgrid(x + dx * (NODES - 0.5), y + dy * (NODES - 0.5), indexing="ij")
    return (integrands(u, v) * np.outer(WEIGHTS, WEIGHTS)).sum(axis=(1, 2)) * dx * dy


def error(x, y, dx, dy, truth):
    """Largest error over the size of the integrals there (r1 bounds the first four)."""
    value = np.array(half_space.integrals(x, y, dx, dy))
    return np.abs(value - truth).max() / np.abs(truth).max()


SHAPES = [(1.0, 1.0), (1.0, 0.3), (0.1, 2.0)]


@pytest.mark.slow
@pytest.mark.parametrize(("dx", "dy"), SHAPES)
def test_near_the_rectangle(dx, dy):
    rng = np.random.default_rng(1)
    for x, y in rng.uniform(-1.5, 1.5, (60, 2)) * (dx, dy):
        # The truth itself is a difference of integrals good to 1e-12.
        assert error(x, y, dx, dy, near_truth(x, y, dx, dy)) < 1e-11


@pytest.mark.parametrize(("dx", "dy"), SHAPES)
@pytest.mark.parametrize(
    ("i", "j"), [(0, 0), (0.5, 0), (0, 0.5), (0.5, 0.5), (-0.5, 0.25), (-0.5, -0.5), (1.5, 0.5)]
)
def test_centre_edges_corners_and_their_continuation(dx, dy, i, j):
    assert error(i * dx, j * dy, dx, dy, near_truth(i * dx, j * dy, dx, dy)) < 1e-11


@pytest.mark.parametrize(("dx", "dy"), SHAPES)
@pytest.mark.parametrize("distance", [3.0, 11.9, 12.1, 100.0, 1e3, 1e5])
def test_far_from_the_rectangle(dx, dy, distance):
    for angle in np.linspace(0, 2 * np.pi, 17):
        x, y = distance * max(dx, dy) * np.array([np.cos(angle), np.sin(angle)])
        # Corner differences lose (r/side)^2 ln r digits up to the switch at 12 sides: 1e-11.
        assert error(x, y, dx, dy, far_truth(x, y, dx, dy)) < 2e-11


def test_a_split_rectangle_adds_up():
    x, y, dx, dy = 0.37, -0.81, 0.9, 1.3
    halves = [np.array(half_space.integrals(x + s * dx / 4, y, dx / 2, dy)) for s in (-1, 1)]
    np.testing.assert_allclose(sum(halves), half_space.integrals(x, y, dx, dy), rtol=1e-13)


def test_parities():
    value = np.array(half_space.integrals(0.8, 0.3, 1.0, 0.7))
    in_x = np.array(half_space.integrals(-0.8, 0.3, 1.0, 0.7))
    in_y = np.array(half_space.integrals(0.8, -0.3, 1.0, 0.7))
    np.testing.assert_allclose(in_x, value * [1, 1, 1, -1, -1, 1], rtol=1e-13)
    np.testing.assert_allclose(in_y, value * [1, 1, 1, -1, 1, -1], rtol=1e-13)


def test_trace_of_the_tangential_kernel():
    """x²/r³ + y²/r³ = 1/r."""
    r1, xx, yy, *_ = half_space.integrals(0.2, 0.4, 1.0, 0.5)
    assert xx + yy == pytest.approx(r1, rel=1e-14)


def test_far_limit_is_the_point_kernel():
    """The error of the point kernel falls with the square of the distance."""
    errors = []
    for r in (40.0, 80.0):
        x, y = r * 0.6, r * 0.8
        ratio = half_space.integrals(x, y, 1.0, 1.0) / integrands(x, y)
        errors.append(np.abs(ratio - 1.0).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.01)  # next term: fourth order


@pytest.mark.parametrize(("dx", "dy"), SHAPES)
def test_the_quadrant_holds_the_integrals(dx, dy):
    """Also where the expansion takes over from the corners, and at the origin."""
    table, (i, j) = quadrant(40, 30, dx, dy), np.indices((40, 30))
    exact = half_space.integrals(i * dx, j * dy, dx, dy)
    # Differences of corners lose digits with the ratio of the sides.
    error = np.abs(table - exact).max(axis=0) / exact.max(axis=0)
    assert error.max() < 1e-12 * max(dx / dy, dy / dx)


def test_integrals_do_not_depend_on_the_size_of_the_table():
    """A resumed run has smaller tables than the interrupted one, and must follow it exactly."""
    large = quadrant(70, 60, 1.0, 1.3)
    for nx, ny in ((18, 11), (58, 49), (40, 57)):
        assert np.array_equal(quadrant(nx, ny, 1.0, 1.3), large[:, :nx, :ny])
