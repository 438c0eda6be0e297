"""Stress of a loaded rectangle against point forces, its laws, and hard digits."""

import math

import numpy as np
import pytest

from tractive_sam.kernels.stress import (
    COMPONENTS,
    far_integrals,
    near_integrals,
    near_radius,
    nodes_needed,
    stress_patch,
)

XX, YY, ZZ, XY, XZ, YZ = range(6)
P_X, P_Y, P_N = range(3)


def patch(x, y, z, dx=1.0, dy=1.0, nu=0.28):
    """(3, 6): loads, components."""
    return np.array(stress_patch(float(x), float(y), float(z), float(dx), float(dy), float(nu)))


def distance(a, b):
    """Largest difference over the loads, relative to the size of the stress tensor b."""
    return (np.linalg.norm(a - b, axis=1) / np.linalg.norm(b, axis=1)).max()


def force_normal(x, y, z, nu):
    """Boussinesq's point force along +z: the usual textbook form, stacked components."""
    R = np.sqrt(x * x + y * y + z * z)
    f = 1 / (2 * np.pi * R**2)
    k, s = 1 - 2 * nu, R + z
    bend = (2 * R + z) / (R * s**2)
    return f * np.array(
        [
            -3 * x * x * z / R**3 + k * (z / R - R / s + x * x * bend),
            -3 * y * y * z / R**3 + k * (z / R - R / s + y * y * bend),
            -3 * z**3 / R**3,
            -3 * x * y * z / R**3 + k * x * y * bend,
            -3 * x * z * z / R**3,
            -3 * y * z * z / R**3,
        ]
    )


def force_shear_x(x, y, z, nu):
    """Cerruti's point force along +x: Johnson (1985), eq. (3.76)."""
    R = np.sqrt(x * x + y * y + z * z)
    k, s = 1 - 2 * nu, R + z
    xx = x / R**3 - 3 * x / (R * s**2) + x**3 / (R**3 * s**2) + 2 * x**3 / (R**2 * s**3)
    yy = x / R**3 - x / (R * s**2) + x * y * y / (R**3 * s**2) + 2 * x * y * y / (R**2 * s**3)
    xy = -y / (R * s**2) + x * x * y / (R**3 * s**2) + 2 * x * x * y / (R**2 * s**3)
    return np.array(
        [
            -3 * x**3 / R**5 + k * xx,
            -3 * x * y * y / R**5 + k * yy,
            -3 * x * z * z / R**5,
            -3 * x * x * y / R**5 + k * xy,
            -3 * x * x * z / R**5,
            -3 * x * y * z / R**5,
        ]
    ) / (2 * np.pi)


def point_forces(x, y, z, nu):
    """(3, 6, ...): unit forces along x, y and z."""
    yy_first = [YY, XX, ZZ, XY, YZ, XZ]
    along_y = force_shear_x(y, x, z, nu)[yy_first]
    return np.stack([force_shear_x(x, y, z, nu), along_y, force_normal(x, y, z, nu)])


def by_quadrature(x, y, z, dx, dy, nu):
    """Point forces over the patch by 14 Gauss points on panels no longer than the depth: 1e-15."""
    (xs, wx), (ys, wy) = panels(dx, z), panels(dy, z)
    values = point_forces(x - xs[:, None], y - ys, z, nu)
    return np.einsum("lcij,i,j->lc", values, wx, wy)


def panels(side, longest):
    count = math.ceil(side / longest)
    node, weight = np.polynomial.legendre.leggauss(14)
    centres = (np.arange(count) - (count - 1) / 2) * (side / count)
    nodes = centres[:, None] + node * side / (2 * count)
    return nodes.ravel(), np.tile(weight * side / (2 * count), count)


def random_points(count, seed):
    """Points, patch sides (up to 1 : 5) and Poisson's ratios around a patch."""
    rng = np.random.default_rng(seed)
    lower = [-2.5, -2.5, -0.8, 0.4, 0.4, 0.0]
    upper = [2.5, 2.5, 0.8, 2.0, 2.0, 0.5]
    draws = rng.uniform(lower, upper, size=(count, 6)).tolist()
    return [(x, y, 10**log_z, dx, dy, nu) for x, y, log_z, dx, dy, nu in draws]


@pytest.mark.parametrize("point", random_points(24, 0))
def test_equals_quadrature_of_point_forces(point):
    # The corner sums lose digits with (distance / side)³: 7 here.
    assert distance(patch(*point), by_quadrature(*point)) < 1e-11


# Sixty-digit corner sums at points with cancellation in the closed form: nu = 1/2 beside the patch
# at z/dx = 1e-8, beside the line of an edge, far and slender, far below, on an edge, on the far
# axis of symmetry.
HARD = [
    (
        (0.0, 3.0, 1e-08, 1.0, 1.0, 0.5),
        [0.0, 0.0, 0.0, -0.0005155627922391, -1.798706753258e-12, 0.0],
        [-0.0005155627922391, -0.05326079212483, -6.313352270632e-19, 0, 0, -1.825286564137e-10],
        [-1.798706753258e-12, -1.825286564137e-10, -2.203e-27, 0.0, 0.0, -6.313352270632e-19],
    ),
    (
        (0.5 + 2**-30, -4.0, 2.0**-34, 1.0, 1.0, 0.5),
        [-0.0001132021506696, -0.003557161344783, 0, 0.0005952153180948, -8.882e-15, 5.282e-14],
        [0.0005952153180948, 0.02878344305184, 0, -0.003557161344783, 5.282e-14, -4.252828e-13],
        [-8.881963432958e-15, -4.252827764114e-13, 0, 5.281791939662e-14, -7.882882e-25, 6.3e-24],
    ),
    (
        (6.0, 1e-06, 1e-08, 1.0, 0.05, 0.5),
        [-0.0006677731587074, -3.927688764502e-09, 0, -1.120704980837e-10, -1.120738092e-12, 0],
        [-1.120704980837e-10, -1.98667608094e-15, 0, -3.927688764502e-09, 0, -6.622372e-18],
        [-1.120738092341e-12, -6.622372089185e-18, 0, -1.885257024834e-19, -1.885312980e-21, 0],
    ),
    (
        (1000.0, -3000.0, 1e-08, 1.0, 1.0, 0.28),
        [-5.274501677643e-09, -7.609776782159e-09, 0, 9.180048529413e-09, -1.5e-20, 4.5e-20],
        [2.536592448578e-09, 3.611624293083e-08, 0, -9.824262142437e-09, 4.5e-20, -1.36e-19],
        [-5.602253996812e-09, 5.602253996683e-09, 0, -4.201690497561e-09, 0, 0],
    ),
    (
        (0.0, 0.0, 1e4, 1.0, 1.0, 0.28),
        [0, 0, 0, 0, -3.978873554087e-18, 0],
        [0, 0, 0, 0, 0, -3.978873554087e-18],
        [3.501408699479e-10, 3.501408699479e-10, -4.774648272862e-09, 0, 0, 0],
    ),
    (
        (-0.5, 0.3, 1e-08, 1.0, 2.0, 0.28),
        [
            11.32537769759,
            3.187914216585,
            0.3183098861838,
            -0.05231179471645,
            -0.4999999930425,
            7e-10,
        ],
        [-0.02107806966971, -0.1606454215113, 0, 5.737095776022, 7.159e-10, -0.4999999926076],
        [-0.3868508508424, -0.3931491369124, -0.5, -0.02266508499347, 0.3183098861838, -2e-17],
    ),
    (
        (1e-06, -20.0, 1e-08, 1.0, 1.0, 0.5),
        [-3.736015167e-14, -5.966433325467e-11, 0, 2.489643857712e-07, -1.246118835e-16, 0],
        [2.489643857712e-07, 0.00119378599215, 0, -5.966433325467e-11, 0, -5.972661578e-13],
        [-1.246118834577e-16, -5.972661578304e-13, 0, 2.985702286965e-20, 0, 0],
    ),
]


@pytest.mark.parametrize(("point", "p_x", "p_y", "p_n"), HARD)
def test_keeps_digits_where_the_closed_form_cancels(point, p_x, p_y, p_n):
    assert distance(patch(*point), np.array([p_x, p_y, p_n])) < 1e-9  # as asked; ours: below 3e-10


@pytest.mark.parametrize(("dx", "dy"), [(1.0, 1.0), (1.0, 0.3), (0.1, 1.0)])
@pytest.mark.parametrize("direction", [(1, 0, 1e-9), (0, 1, 1e-3), (1, 1, 1), (0.2, 0.1, 1)])
def test_corner_sums_meet_quadrature(dx, dy, direction):
    unit = np.array(direction) / np.linalg.norm(direction)
    x, y, z = (near_radius(dx, dy) * unit).tolist()
    nx, ny = (nodes_needed(side / near_radius(dx, dy)) for side in (dx, dy))
    near = np.array(near_integrals(x, y, z, dx, dy))
    far = np.array(far_integrals(x, y, z, dx, dy, nx, ny))
    # 1e-10 of the largest: both have about 1e-11 here
    np.testing.assert_allclose(near, far, rtol=0, atol=1e-10 * abs(far).max())


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_tends_to_the_point_force(nu):
    direction = np.array([0.5, -0.7, 0.6])
    errors = []
    for r in (10.0, 20.0, 40.0, 80.0):
        far = point_forces(*(r * direction), nu) * 0.8  # the area
        errors.append(distance(patch(*(r * direction), 1.0, 0.8, nu), far))
    ratios = np.divide(errors[:-1], errors[1:])
    np.testing.assert_allclose(ratios, 4, rtol=0.05)  # second order in size / distance


def derivative(f, point, axis, h):
    """Sixth-order central difference."""
    step = np.zeros(3)
    step[axis] = h
    weights = {1: 45, 2: -9, 3: 1}
    return sum(
        w * (f(*(point + n * step)) - f(*(point - n * step))) for n, w in weights.items()
    ) / (60 * h)


@pytest.mark.parametrize("point", random_points(10, 1))
def test_equilibrium(point):
    x, y, z, dx, dy, nu = point
    gradient = [
        derivative(lambda *p: patch(*p, dx, dy, nu), np.array([x, y, z]), axis, 0.01 * z)
        for axis in range(3)
    ]
    rows = [(XX, XY, XZ), (XY, YY, YZ), (XZ, YZ, ZZ)]
    for row in rows:
        divergence = sum(gradient[axis][:, c] for axis, c in enumerate(row))
        # (h/z)^6 of the differences: 1e-12 relative to the gradient, with a constant of about 100
        np.testing.assert_allclose(divergence, 0, atol=1e-9 * np.abs(gradient).max())


@pytest.mark.parametrize(("x", "y"), [(0, 0), (0.3, -0.35), (-0.499999, 0.39)])
def test_surface_under_the_patch(x, y):
    s = patch(x, y, 0, 1.0, 0.8)
    tractions = s[:, [XZ, YZ, ZZ]]
    np.testing.assert_allclose(tractions, -np.eye(3), atol=1e-14)  # rounding of 2 pi / 2 pi


@pytest.mark.parametrize(("x", "y"), [(0.500001, 0), (0.6, 0.41), (-3, 0.4), (0, -50), (900, 7)])
def test_surface_next_to_the_patch(x, y):
    s = patch(x, y, 0, 1.0, 0.8)
    np.testing.assert_array_equal(s[:, [XZ, YZ, ZZ]], 0)


@pytest.mark.parametrize(("x", "y"), [(0, 0), (0.2, 0.3), (0.7, -0.2), (4, 0.4), (20, 30)])
def test_surface_is_the_limit_from_inside(x, y):
    s = patch(x, y, 0)
    assert distance(patch(x, y, 1e-10), s) < 1e-8  # first order in z, slope about 10


@pytest.mark.parametrize(("x", "y"), [(0.5, 0.1), (-0.5, 0.1), (0.1, 0.4), (0.1, -0.4)])
def test_edge_takes_the_mean_of_its_sides(x, y):
    h = 1e-9
    on_x_edge = abs(x) == 0.5
    step = (h, 0) if on_x_edge else (0, h)
    mean = (
        patch(x + step[0], y + step[1], 0, 1, 0.8) + patch(x - step[0], y - step[1], 0, 1, 0.8)
    ) / 2
    s = patch(x, y, 0, 1, 0.8)
    finite = np.ones((3, 6), dtype=bool)
    infinite = [(P_X, XX), (P_X, YY), (P_Y, XY)] if on_x_edge else [(P_Y, XX), (P_Y, YY), (P_X, XY)]
    for load, component in infinite:
        finite[load, component] = False
        assert abs(mean[load, component]) > 1  # it is infinite on the edge
    np.testing.assert_allclose(s[finite], mean[finite], atol=1e-7)  # h ln h
    assert np.isfinite(s).all()


@pytest.mark.parametrize(("x", "y"), [(0.5, 0.4), (-0.5, 0.4), (0.5, 0), (0, -0.4), (-0.5, -3)])
def test_borders_are_finite_and_know_no_unit(x, y):
    s = patch(x, y, 0, 1.0, 0.8)
    assert np.isfinite(s).all()
    scaled = patch(*(1e3 * np.array([x, y, 0, 1.0, 0.8])))
    np.testing.assert_allclose(scaled, s, atol=1e-13)


def test_corner_carries_a_quarter():
    s = patch(0.5, 0.4, 0, 1.0, 0.8)
    np.testing.assert_allclose(s[:, [XZ, YZ, ZZ]], -np.eye(3) / 4, atol=1e-15)


@pytest.mark.parametrize("point", random_points(10, 2))
def test_split_patch_adds_up(point):
    x, y, z, dx, dy, nu = point
    left = 0.3 * dx
    parts = patch(x + (dx - left) / 2, y, z, left, dy, nu) + patch(
        x - left / 2, y, z, dx - left, dy, nu
    )
    assert distance(parts, patch(*point)) < 1e-12  # rounding, and z, y of order one


def test_split_patch_adds_up_far_away():
    parts = [
        patch(37.0 - i, -11.0 - j, 2.0, 1.0, 1.0, 0.3)
        for i in np.arange(-3.5, 4)
        for j in np.arange(-3.5, 4)
    ]
    assert distance(sum(parts), patch(37.0, -11.0, 2.0, 8.0, 8.0, 0.3)) < 1e-10


def parity(axis):
    """Signs (3, 6) of the coefficients in a mirror: one for every index, and one for the load."""
    odd = [[(c.count(axis) + (load == axis)) % 2 for c in COMPONENTS] for load in "xyn"]
    return 1 - 2 * np.array(odd)


@pytest.mark.parametrize("point", random_points(5, 3))
def test_mirrors(point):
    x, y, z, dx, dy, nu = point
    s = patch(*point)
    # 1e-13: x and y < 0 take other branches
    assert distance(parity("x") * patch(-x, y, z, dx, dy, nu), s) < 1e-13
    assert distance(parity("y") * patch(x, -y, z, dx, dy, nu), s) < 1e-13


@pytest.mark.parametrize("point", random_points(5, 4))
def test_exchange_of_axes(point):
    x, y, z, dx, dy, nu = point
    exchanged = patch(y, x, z, dy, dx, nu)[[P_Y, P_X, P_N]][:, [YY, XX, ZZ, XY, YZ, XZ]]
    assert distance(exchanged, patch(*point)) < 1e-13


@pytest.mark.parametrize("point", random_points(5, 5))
def test_laws_in_nu(point):
    x, y, z, dx, dy, _ = point
    s0, s1, s2 = (patch(x, y, z, dx, dy, nu) for nu in (0.0, 0.25, 0.5))
    np.testing.assert_array_equal(s0[:, [ZZ, XZ, YZ]], s2[:, [ZZ, XZ, YZ]])  # equilibrium alone
    np.testing.assert_allclose(s1, (s0 + s2) / 2, atol=1e-15)  # linear in nu
    # the dilatation is harmonic and its nu dependence a factor: trace ~ 1 + nu
    traces = [s[:, :3].sum(axis=1) / (1 + nu) for s, nu in ((s0, 0.0), (s1, 0.25), (s2, 0.5))]
    np.testing.assert_allclose(traces[1:], [traces[0]] * 2, atol=1e-14)


@pytest.mark.parametrize("point", random_points(5, 6))
def test_normal_and_shear_share_their_transverse_stresses(point):
    s = patch(*point)
    assert s[P_N, XZ] == s[P_X, ZZ]
    assert s[P_N, YZ] == s[P_Y, ZZ]
    assert s[P_X, YZ] == s[P_Y, XZ]


@pytest.mark.parametrize("z", [0.5, 1.0, 4.0])
def test_force_through_a_plane_balances_the_load(z):
    # polar, r = z tan(t): smooth in t up to r = infinity, periodic in the angle
    node, weight = np.polynomial.legendre.leggauss(60)
    t, angles = 0.25 * math.pi * (node + 1), 2 * math.pi * np.arange(96) / 96
    r, w = z * np.tan(t), z * 0.25 * math.pi * weight / np.cos(t) ** 2
    force = sum(
        wi * ri * patch(ri * np.cos(a), ri * np.sin(a), z, 1.0, 0.8)[:, [XZ, YZ, ZZ]]
        for ri, wi in zip(r, w, strict=True)
        for a in angles
    )
    # the quadrature's own error, at the smallest depth
    np.testing.assert_allclose(force * 2 * math.pi / 96, -0.8 * np.eye(3), atol=1e-9)


def test_long_patch_tends_to_plane_strain():
    errors = []
    for length in (100.0, 1000.0, 10000.0):
        s = patch(0.7, 0, 0.4, 1.0, length, 0.3)[[P_X, P_N]]
        errors.append(np.abs(s[:, YY] - 0.3 * (s[:, XX] + s[:, ZZ])).max())
    # the ends, at length / 2, strain the middle as 1 / length; next order 3 %
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 10, rtol=0.03)


# Square patch of side 1, p_n = p_x = 1, nu = 0.28, below its centre, as another program (CONTACT)
# prints it: xx, zz, xz. It evaluates beside the point requested (its values fit x = -1.1e-4, its
# sigma_xz at z = 0 is -0.998999), hence 2.5e-4 absolute.
PRINTED = {
    0.5: (-0.076184, -0.700842, -0.149363),
    1.0: (0.0039769, -0.336086, -0.024183),
    2.5: (0.0044578, -0.071611, -0.00092701),
    5.0: (0.0013245, -0.018785, -6.181e-05),
}


@pytest.mark.parametrize("z", PRINTED)
def test_agrees_with_another_program(z):
    s = patch(0, 0, z)
    together = s[P_X] + s[P_N]
    np.testing.assert_allclose(together[[XX, ZZ, XZ]], PRINTED[z], atol=2.5e-4)


def test_agrees_with_another_program_at_the_surface():
    s = patch(0, 0, 0)
    together = s[P_X] + s[P_N]
    printed = [-0.779815, -0.779977, -1.0, -0.998999]
    np.testing.assert_allclose(together[[XX, YY, ZZ, XZ]], printed, atol=1.1e-3)
    np.testing.assert_allclose(together[[XX, YY]], -(0.5 + 0.28), atol=1e-15)  # exactly
