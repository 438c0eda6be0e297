"""Smallest balls, critical planes and shakedown of cycles, against closed forms and brute force."""

import math
import os
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from tractive_sam.kernels import critical_plane, fatigue
from tractive_sam.mechanics import (
    Crossland,
    DangVan,
    FatemiSocie,
    Findley,
    OrthogonalShear,
    Woehler,
    enclosing_radius,
    max_shear,
    residual_shear,
    von_mises,
)
from tractive_sam.mechanics.fatigue import to_paths
from tractive_sam.reference import line_pressure_stress, line_shear_stress

compiled = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT", "0") != "0", reason="takes minutes without the compiler"
)

RNG = np.random.default_rng(20)
CRITERIA = (DangVan(0.3), Crossland(0.3), Findley(0.3), FatemiSocie(0.3, 2.0))
JUDGES = (*CRITERIA, OrthogonalShear(), enclosing_radius, residual_shear)


def line(mu, depths, points=801, nu=0.3):
    """The cycles below a sliding line contact of unit semi-axis and pressure, (6, n, depths)."""
    x, z = np.linspace(-5.0, 5.0, points)[:, None], np.asarray(depths, float)
    cycle = line_pressure_stress(x, z, 1.0, 1.0, nu) + mu * line_shear_stress(x, z, 1.0, 1.0, nu)
    return np.concatenate((cycle, np.zeros_like(cycle[:, :1])), axis=1)


def random_cycles(number=5, points=12):
    return RNG.normal(size=(6, points, number))


def turned(cycle, rotation):
    tensor = np.moveaxis(cycle[[[0, 3, 4], [3, 1, 5], [4, 5, 2]]], (0, 1), (-2, -1))
    tensor = np.moveaxis(rotation @ tensor @ rotation.T, (-2, -1), (0, 1))
    return tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def ball(points):
    """Return the smallest ball around points (m, n) by both kernels."""
    m, n = points.shape
    squares = np.empty(n)
    if m == 2:
        support, weights = np.zeros(3, int), np.empty(3)
        count, radius2 = fatigue.enclosing_circle(support, weights, points, squares)
        return support[:count], weights[:count], radius2
    support, weights = np.empty(m + 2, int), np.empty(m + 2)
    count, radius2 = fatigue.enclosing_ball(np.empty(m), support, weights, points, squares)
    return support[:count], weights[:count], radius2


@pytest.mark.slow
@pytest.mark.parametrize("m", [2, 3, 5])
@pytest.mark.parametrize("whole", [True, False])
def test_a_smallest_ball_is_the_optimum_of_its_dual(m, whole):
    """Weights that are positive and add up to one bound any ball from below."""
    for _ in range(60):
        # Integers coincide and lie on common spheres.
        points = RNG.integers(-2, 3, (m, 25)).astype(float) if whole else RNG.normal(size=(m, 25))
        support, weights, radius2 = ball(points)
        assert (weights > -1e-12).all()
        assert weights.sum() == pytest.approx(1.0, abs=1e-12)
        centre = points[:, support] @ weights
        bound = weights @ (points[:, support] ** 2).sum(axis=0) - centre @ centre
        assert radius2 == pytest.approx(bound, rel=1e-11)  # rounding of a few digits
        assert ((points - centre[:, None]) ** 2).sum(axis=0).max() <= radius2 * (1 + 1e-12)


def test_distances_of_deviators_are_those_of_j2():
    cycle = random_cycles(1, 30)
    deviators = np.empty((5, 30))
    fatigue.deviators(deviators, to_paths(cycle)[0])
    np.testing.assert_allclose(
        np.linalg.norm(deviators, axis=0), von_mises(cycle)[:, 0] / math.sqrt(3.0), rtol=1e-13
    )
    tresca = [fatigue.tresca(one) for one in deviators.T]
    np.testing.assert_allclose(tresca, max_shear(cycle)[:, 0], rtol=1e-9)  # by an arc cosine


@pytest.mark.slow
@pytest.mark.parametrize("criterion", CRITERIA, ids=lambda one: one.name)
def test_rotation_of_the_axes_changes_nothing(criterion):
    cycle = random_cycles()
    before = criterion(cycle)
    for seed in range(3):
        rotation = Rotation.random(random_state=seed).as_matrix()
        np.testing.assert_allclose(criterion(turned(cycle, rotation)), before, rtol=1e-10)


def room(points):
    """What the kernels of a plane work in."""
    return (
        np.empty((3, points)),
        np.empty(points),
        np.zeros(3, int),
        np.empty(3),
        np.empty((6, 6)),
        np.empty((4, 6)),
    )


def plane(cycle, normal, sum_k, product_k, within=None):
    within = room(cycle.shape[1]) if within is None else within
    return critical_plane.evaluate_plane(to_paths(cycle)[0], normal, sum_k, product_k, within)


@pytest.mark.parametrize(("sum_k", "product_k"), [(0.3, 0.0), (0.0, 0.3)])
def test_steps_towards_a_critical_plane_are_newtons(sum_k, product_k):
    """By differences of the value of planes held by equal points, two and three."""
    number, difference = {2: 0, 3: 0}, 1e-4
    for cycle in random_cycles(40).transpose(2, 0, 1):
        normal, within, near = RNG.normal(size=3), room(12), np.empty(3)
        normal /= np.linalg.norm(normal)

        def value(a, b, normal=normal, within=within, near=near, cycle=cycle):
            critical_plane.turn_normal(near, normal, a * difference, b * difference)
            found, held, at = plane(cycle[..., None], near, sum_k, product_k, within)
            return found, (frozenset(within[2][:held]), at)

        around = {(a, b): value(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)}
        if len({points for _, points in around.values()}) > 1:
            continue
        here, held, at = plane(cycle[..., None], normal, sum_k, product_k, within)
        path = to_paths(cycle[..., None])[0]
        step = critical_plane.newton_step(path, here, held, at, sum_k, product_k, within)
        v = {k: one / difference for k, (one, _) in around.items()}
        ga, gb = 0.5 * (v[1, 0] - v[-1, 0]), 0.5 * (v[0, 1] - v[0, -1])
        haa, hbb = v[1, 0] + v[-1, 0] - 2.0 * v[0, 0], v[0, 1] + v[0, -1] - 2.0 * v[0, 0]
        hab = 0.25 * (v[1, 1] + v[-1, -1] - v[1, -1] - v[-1, 1])
        second = (one / difference for one in (haa, hab, hbb))
        # The square of the difference, and rounding over it.
        np.testing.assert_allclose(
            step, critical_plane.solve_newton_step(here, ga, gb, *second), atol=1e-5
        )
        number[held] += 1
    assert min(number.values()) > 5


def unit_vectors(number):
    normals = RNG.normal(size=(number, 3))
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def triangle_radius(corners):
    """Radius of the smallest circle around three points each, (..., 3, 2)."""
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=-2), axis=-1)
    longest = sides.max(axis=-1)
    edges = corners[..., 1:, :] - corners[..., :1, :]
    double_area = np.abs(edges[..., 0, 0] * edges[..., 1, 1] - edges[..., 0, 1] * edges[..., 1, 0])
    is_acute = (sides**2).sum(axis=-1) > 2.0 * longest**2
    around = sides.prod(axis=-1) / np.maximum(2.0 * double_area, 1e-300)
    return np.where(is_acute, around, 0.5 * longest)


def values_on_planes(cycle, normals, sum_k, product_k):
    """Return what a critical plane maximises on many planes, from its definition, (planes,).

    The smallest circle around points is the largest one around three of them (Helly).
    """
    tensors = np.moveaxis(cycle[[[0, 3, 4], [3, 1, 5], [4, 5, 2]]], -1, 0)
    tractions = np.einsum("ijk,nk->nij", tensors, normals)
    along = np.einsum("nij,nj->ni", tractions, normals)
    across = np.cross(normals, np.roll(normals, 1, axis=1) * [1.0, -1.0, 1.0])
    across /= np.linalg.norm(across, axis=1)[:, None]
    axes = np.stack((across, np.cross(normals, across)), axis=1)
    shear = np.einsum("nij,nkj->nik", tractions, axes)
    corners = np.array(list(combinations(range(cycle.shape[1]), 3)))
    radius = triangle_radius(shear[:, corners]).max(axis=1)
    high = along.max(axis=1)
    return radius * np.maximum(1.0 + product_k * high, 0.0) + sum_k * high


def find_critical_value(cycle, sum_k, product_k):
    """Return the largest value by a search of random planes that narrows around the best ones."""
    normals, reach = unit_vectors(1500), 0.1
    values = values_on_planes(cycle, normals, sum_k, product_k)
    for _ in range(4):
        best = normals[np.argsort(values)[-10:]]
        near = best[:, None] + reach * RNG.normal(size=(10, 30, 3))
        near = np.concatenate((best, near.reshape(-1, 3)))
        normals, reach = near / np.linalg.norm(near, axis=1)[:, None], 0.25 * reach
        values = values_on_planes(cycle, normals, sum_k, product_k)
    return values.max()


@pytest.mark.slow
@pytest.mark.parametrize(("sum_k", "product_k"), [(0.0, 0.0), (0.3, 0.0), (1.0, 0.0), (0.0, 0.3)])
def test_the_critical_plane_is_that_of_brute_force(sum_k, product_k):
    """Random cycles, components out of phase, and stress below lines, with many close maxima."""
    turn = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)[None, :, None]
    mean, amplitude, phase = RNG.normal(size=(3, 6, 1, 2))
    out_of_phase = mean + amplitude * np.sin(RNG.integers(1, 3, (6, 1, 2)) * turn + 9.0 * phase)
    below_lines = line(0.3, [0.1, 0.5], points=15)
    for cycles in (random_cycles(2, 5), random_cycles(2), out_of_phase, below_lines):
        found = np.empty(cycles.shape[2])
        critical_plane.critical_plane(found, to_paths(cycles), sum_k, product_k)
        searched = [find_critical_value(one, sum_k, product_k) for one in np.moveaxis(cycles, 2, 0)]
        assert (found >= np.array(searched) * (1.0 - critical_plane.ENOUGH)).all()
        # The search ends .001 from a plane; at a bend of the maximum values fall in proportion.
        np.testing.assert_allclose(searched, found, rtol=2e-3)


@compiled
def test_cycles_that_do_no_harm_or_are_none_end_at_once():
    """Of uniform pressure no plane is better than another; nan is its own cycle's only."""
    pressure = np.zeros((6, 5, 1))
    pressure[:3] = -100.0
    assert Findley(0.3)(pressure) == 0.0
    for points in (slice(None), 7):  # all of the cycle, or one point during the run
        cycles = random_cycles(3)
        cycles[4, points, 1] = np.nan
        for judge in JUDGES:
            found = judge(cycles)
            assert np.isnan(found[1])
            # The search, accurate to 1e-4, begins at the cycle before.
            np.testing.assert_allclose(
                found[::2], judge(cycles[..., ::2]), rtol=critical_plane.ENOUGH
            )


@pytest.mark.parametrize("shape", [(6,), (5, 6), (12, 6), (6, 0, 3)])
def test_a_cycle_of_another_shape_is_refused(shape):
    for judge in JUDGES:
        with pytest.raises(ValueError, match=r"\(6, n, ...\)"):
            judge(np.zeros(shape))


@pytest.mark.slow
@compiled
def test_balls_begun_by_the_one_before_are_the_same():
    """Paths beside each other, paths that have nothing in common, and points that coincide."""
    sliding = to_paths(line(0.3, np.linspace(0.01, 1.5, 40), points=61))
    mixed = np.concatenate((sliding, to_paths(random_cycles(40, 62)), sliding[::-1], 0.0 * sliding))
    together, single = np.empty(len(mixed)), np.empty(len(mixed))
    fatigue.enclosing_radii(together, mixed)
    for k in range(len(mixed)):
        fatigue.enclosing_radii(single[k : k + 1], mixed[k : k + 1])
    np.testing.assert_allclose(together, single, rtol=1e-12)  # of the last step


@pytest.mark.parametrize(("tau", "sigma"), [(180.0, 300.0), (200.0, 330.0)])
def test_limits_in_torsion_and_bending_are_recovered(tau, sigma):
    """Both reach the limit of a criterion with a sensitivity that follows from them."""
    torsion, bending = np.zeros((6, 3)), np.zeros((6, 3))
    torsion[3, :2] = tau, -tau
    bending[0, :2] = sigma, -sigma
    for criterion in (
        DangVan(3.0 * (tau / sigma - 0.5)),
        Crossland(3.0 * tau / sigma - math.sqrt(3.0)),
    ):
        assert float(criterion(torsion)) == pytest.approx(tau, rel=1e-12)
        assert float(criterion(bending)) == pytest.approx(tau, rel=1e-12)
    share = 2.0 * tau / sigma - 1.0  # k / sqrt(1 + k²)
    k = share / math.sqrt(1.0 - share**2)
    limit = tau * math.sqrt(1.0 + k * k)
    assert float(Findley(k)(torsion)) == pytest.approx(limit, rel=1e-10)
    assert float(Findley(k)(bending)) == pytest.approx(limit, rel=1e-10)


DEPTHS = np.linspace(0.3, 0.75, 91)
SPACED = 3e-4
"""Error of cycles of 801 points: a parabola misses that much between them."""


def largest(values):
    k = int(np.argmax(values))
    return float(values[k]), float(DEPTHS[k])


@compiled
@pytest.mark.parametrize(
    ("criterion", "value", "depth"),
    [
        (OrthogonalShear(), 0.25, 0.5),
        (Findley(0.0), 0.25, 0.5),
        (Findley(0.5), 0.25, 0.5),
        (Crossland(0.0), 0.25, 0.5),
        (DangVan(0.0), 0.25, 0.5),
    ],
    ids=repr,
)
def test_a_frictionless_line_contact(criterion, value, depth):
    found, at = largest(criterion(line(0.0, DEPTHS)))
    assert found == pytest.approx(value, rel=SPACED)
    assert at == pytest.approx(depth, abs=0.02)  # flat at the top


@compiled
def test_a_frictionless_line_contact_by_dang_van():
    found, at = largest(DangVan(1.0 / 3.0)(line(0.0, DEPTHS, points=4001)))
    assert found == pytest.approx(0.1636, rel=1e-3)  # the reference was found with as many digits
    assert at == pytest.approx(0.61, abs=0.02)


@compiled
@pytest.mark.parametrize(
    ("mu", "certain", "depth", "impossible"),
    [
        (0.0, 4.0, 0.5, 4.0),
        (0.1, 3.564, 0.46, 3.986),
        (0.2, 3.202, 0.42, 3.944),
        (0.3, 2.900, 0.38, 3.86),
    ],
)
def test_shakedown_of_a_line_contact_in_full_slip(mu, certain, depth, impossible):
    """The largest p0/k inside the body (Johnson, Contact Mechanics, fig. 9.4)."""
    cycles = line(mu, DEPTHS)
    left = np.array([residual_shear(cycles[..., k : k + 1])[0] for k in range(DEPTHS.size)])
    found, at = largest(left)
    assert 1.0 / found == pytest.approx(certain, rel=SPACED)
    assert at == pytest.approx(depth, abs=0.015)  # between depths
    assert (enclosing_radius(cycles) <= left * (1.0 + 1e-12)).all()
    if mu < 0.25:  # from there on the surface is the first to become impossible
        assert 1.0 / enclosing_radius(cycles).max() == pytest.approx(impossible, rel=1e-3)


@compiled
def test_shakedown_at_the_surface_is_worse_than_the_shear_there():
    """The stress along y counts: von Mises at Poisson's ratio .3 allows less than p0/k = 1/mu.

    The two residual stresses by a search that knows nothing of balls.
    """
    cycle = line(0.3, [0.0])

    def left(residual):
        stress = cycle[..., 0].copy()
        stress[:2] += residual[:, None]
        return von_mises(stress).max() / math.sqrt(3.0)

    starts = (np.zeros(2), np.array([0.3, 0.3]), np.array([0.0, -0.3]))
    options = {"xatol": 1e-9, "fatol": 1e-12}
    searched = min(minimize(left, at, method="Nelder-Mead", options=options).fun for at in starts)
    assert residual_shear(cycle)[0] == pytest.approx(searched, rel=1e-6)  # of the search
    assert 1.0 / searched == pytest.approx(2.99702, rel=2e-4)  # points are .0125 apart
    assert searched > 0.3


def test_one_residual_stress_serves_a_whole_depth():
    """Points that share a depth leave no less than each alone, and what is left is an optimum."""
    cycles = random_cycles(4, 10)
    together = residual_shear(cycles)
    single = [residual_shear(cycles[..., k : k + 1])[0] for k in range(4)]
    assert (together >= np.array(single) - 1e-12).all()

    def left(residual):
        stress = cycles.copy()
        stress[0] += residual[:4]
        stress[1] += residual[4]
        return von_mises(stress).max() / math.sqrt(3.0)

    for step in 0.02 * RNG.normal(size=(200, 5)):
        assert left(step) >= together.max()
    options = {"xatol": 1e-8, "fatol": 1e-10, "maxiter": 20_000, "adaptive": True}
    searched = minimize(left, np.zeros(5), method="Nelder-Mead", options=options).fun
    assert together.max() <= searched * (1.0 + 1e-9)
    assert together.max() == pytest.approx(searched, rel=2e-2)  # of the search, at a kink


@compiled
def test_the_lower_bound_is_below_the_upper_one():
    """The ball may choose any residual deviator, the lower bound two of its components."""
    cycles = random_cycles(200, 15)
    assert (enclosing_radius(cycles) <= residual_shear(cycles) * (1.0 + 1e-12)).all()


def test_a_constant_cycle_does_nothing():
    cycle = np.repeat(random_cycles(3, 1), 7, axis=1)
    assert (enclosing_radius(cycle) < 1e-7).all()
    assert (Findley(0.0)(cycle) < 1e-7).all()
    assert (OrthogonalShear()(cycle) == 0.0).all()


def test_lives_and_the_knee():
    line_, knee = Woehler(1e6, 8.0), Woehler(1e6, 8.0, knee=True)
    used = np.array([0.0, 0.5, 1.0, 2.0])
    np.testing.assert_allclose(line_.damage(used), [0.0, 2.0**-8 / 1e6, 1e-6, 256e-6], rtol=1e-13)
    np.testing.assert_allclose(knee.damage(used), [0.0, 0.0, 0.0, 256e-6], rtol=1e-13)
    assert np.isfinite(Woehler(1e-30, 100.0).damage(np.array([1e300]))).all()
