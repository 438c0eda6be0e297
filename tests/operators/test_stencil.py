"""The stencil: leading elements, what their faces slip, and the slip that wears."""

import numpy as np
import pytest

from tractive_sam.mechanics.elasticity import HalfSpaces, Material
from tractive_sam.mechanics.friction import Coulomb, Frame
from tractive_sam.operators import STAGGERED, UPWIND, Lattice, Operators, SteadyRolling
from tractive_sam.operators.stencil import edge_angles, entry_beyond, entry_change
from tractive_sam.solvers import ConjugateGradients, NormalProblem

N, SIDE = 24, 2.3
X = SIDE * ((np.arange(N) + 0.5) / N - 0.5)
DX, DY = SIDE / N, 0.8 * SIDE / N
FRAME = Frame((0.5, 0.2), 0.4)


def half_space(poisson=0.3, frame=FRAME):
    bodies = HalfSpaces(Material(1.0, poisson), Material(1.0, poisson))
    pair = bodies.material
    units = 1.0 / pair.E_star, max(frame.mu) ** 2 / pair.shear
    return Operators(Lattice((N, N), DX, DY), bodies, *units, frame)


@pytest.fixture(scope="module")
def normal():
    """Undeformed gap, pressure and gap of a ball, dimensionless."""
    shape = 0.5 * (X[:, None] ** 2 + 0.64 * X[None, :] ** 2)
    outcome = ConjugateGradients().solve(NormalProblem(half_space(), shape, None, 0.3), 1e-12)
    assert outcome.converged
    return shape, outcome.pressure, outcome.gap


def test_leading_elements(normal):
    _, pressure, gap = normal
    i, j = STAGGERED.leading(pressure, gap)
    assert set(j) == set(np.flatnonzero(pressure.any(axis=0)))  # one in every row
    assert (pressure[i, j] > 0).all()
    assert not pressure[i + 1, j].any()
    assert UPWIND.leading(pressure, gap)[0].size == 0


def test_edge_angles_of_an_ellipse():
    y = 0.8 * X
    pressure = np.sqrt(np.maximum(1.0 - X[:, None] ** 2 - (y[None, :] / 0.7) ** 2, 0.0))
    i, j = STAGGERED.leading(pressure, np.where(pressure > 0, 0.0, 1.0))
    keep = np.abs(y[j]) < 0.5  # beyond, a neighbour is out of contact and reports less
    i, j = i[keep], j[keep]
    angle = edge_angles(pressure, i, j, DX / DY)
    truth = np.arctan2(y[j] / 0.49, X[i])
    # Half an element from the point at which the gradient is taken: 0.05 over the radius.
    np.testing.assert_allclose(angle, truth, atol=0.1)


@pytest.mark.parametrize("share", [(0.3, 0.0), (0.0, 0.3), (-0.2, 0.1)])
def test_a_share_of_the_pressure_sticks_everywhere(normal, share):
    """Without Poisson's ratio shear displaces as pressure does: u_t is that share of u_n.

    What must vanish is then smooth up to the leading elements: the share of the undeformed slope.
    """
    shape, pressure, gap = normal
    space = half_space(poisson=0.0)
    traction = np.array(share)[:, None, None] * pressure
    slip = SteadyRolling(STAGGERED).friction_slip(space, pressure, gap)
    sticking = slip.sticking(space.slip(traction), traction) * (1.0 + slip.stiffness)
    slope = np.diff(shape, axis=0, append=np.nan) / DX
    # Physical: s = share (h_ahead - h)/dx; here in the scaled frame and in units of slip.
    F = FRAME.matrix
    unit = FRAME.mu[0] ** 2  # p*/E* over s*, for nu = 0
    expected = (F @ F.T @ np.array(share))[:, None, None] * slope / unit
    inside = pressure > 0.0
    np.testing.assert_allclose(sticking[:, inside], expected[:, inside], atol=1e-9)


def test_change_is_the_derivative(normal):
    """Of the slip that must vanish, with the edge that turns and the divisor."""
    _, pressure, gap = normal
    space, rng = half_space(), np.random.default_rng(0)
    traction = rng.normal(size=(2, N, N)) * pressure
    step, slip, moving, widening = (
        rng.normal(size=s) for s in ((3, N, N), (2, N, N), (2, N, N), (N, N))
    )
    step[0] *= pressure  # an edge that stays
    at = SteadyRolling(STAGGERED).friction_slip(space, pressure, gap)
    h, values = 1e-6, []
    for sign in (h, -h):
        now = SteadyRolling(STAGGERED).friction_slip(
            space, pressure + sign * step[0], gap + sign * widening
        )
        values.append(now.sticking(slip + sign * moving, traction + sign * step[1:]))
    changed = at.sticking_change(moving, traction, step, widening, slip)
    i, j = STAGGERED.leading(pressure, gap)
    difference = (values[0] - values[1]) / (2 * h)
    np.testing.assert_allclose(changed[:, i, j], difference[:, i, j], rtol=1e-6, atol=1e-7)


def test_stiffness_bounds_the_answer_to_the_traction(normal):
    """Divided by it, an element answers its own traction no more than one to one."""
    _, pressure, gap = normal
    slip = SteadyRolling(STAGGERED).friction_slip(half_space(), pressure, gap)
    zero = np.zeros((2, N, N))
    for angle in np.linspace(0, np.pi, 7):
        unit = np.stack((np.full((N, N), np.cos(angle)), np.full((N, N), np.sin(angle))))
        answer = np.hypot(*slip.sticking(zero, unit))
        assert answer.max() < 1.0
        assert ((answer > 0) == (slip.stiffness > 0)).all()


def test_upwind_does_not_change_the_slip(normal):
    _, pressure, gap = normal
    slip = np.random.default_rng(0).normal(size=(2, N, N))
    seen = SteadyRolling(UPWIND).friction_slip(half_space(), pressure, gap)
    assert seen.sticking(slip, slip) is slip
    assert Coulomb.opposed_slip(slip, pressure, staggered=False) is slip
    assert UPWIND.at_centres(slip) is slip


def test_slip_that_wears_does_no_elastic_work():
    """The mean of both faces is a central difference, antisymmetric with the displacement."""
    space = half_space()
    traction = np.zeros((2, N, N))
    traction[:, 1:-1, 1:-1] = np.random.default_rng(1).normal(size=(2, N - 2, N - 2))
    slip = STAGGERED.at_centres(space.slip(traction))
    work = (slip * traction).sum()
    assert abs(work) < 1e-12 * np.linalg.norm(slip) * np.linalg.norm(traction)


def test_the_edge_lies_where_the_squared_pressure_falls_to_zero():
    """Ahead of a leading element, at the part t of an element: (1 - t)/t, and its derivative."""
    t, here = np.array([0.2, 0.5, 0.7]), (np.full(3, 5), np.arange(3))
    bound = np.sqrt(np.maximum(5.0 + t - np.arange(8.0)[:, None], 0.0))
    np.testing.assert_allclose(entry_beyond(bound, *here), (1.0 - t) / t, rtol=1e-12)  # rounding
    change = np.cos(np.arange(24.0).reshape(8, 3))
    after, before = (entry_beyond(bound + h * change, *here) for h in (1e-5, -1e-5))
    # Central differences: h squared.
    np.testing.assert_allclose(
        entry_change(bound, change, *here), (after - before) / 2e-5, rtol=1e-7
    )
