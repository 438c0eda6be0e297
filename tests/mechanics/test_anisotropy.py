"""Anisotropic bodies: spectra, element integrals, contacts, and their limits."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.solvers.small import with_fixed_pressure
from tractive_sam.contact import Model
from tractive_sam.mechanics import Strips
from tractive_sam.operators.elastic import Lattice, Operators
from tractive_sam.reference.rolling import creep_coefficients
from tractive_sam.solvers.ladder import FIXED_PRESSURE

IRON = {"C11": 231.4e3, "C12": 134.7e3, "C44": 116.4e3}
SILICON = {"C11": 165.7e3, "C12": 63.9e3, "C44": 79.6e3}
FIBRES = dict.fromkeys(("C22", "C33"), 10e3) | dict.fromkeys(("C12", "C13", "C23"), 4e3)
FIBRES |= {"C11": 140e3, "C44": 3.5e3, "C55": 5e3, "C66": 5e3}
ON_110 = {"normal": (1.0, 1.0, 0.0), "along": (0.0, 0.0, 1.0)}
ON_111 = {"normal": (1.0, 1.0, 1.0), "along": (1.0, -1.0, 0.0)}
STEEL = {"young": 208e3, "poisson": 0.3}
RIGID = {"young": 1e15, "poisson": 0.3}
FLAT = {"radius_x": np.inf, "radius_y": np.inf}
BALL = {"radius_x": 10.0, "radius_y": 10.0}


def material(**stiffness):
    return ts.Stiffness(**stiffness).material


def random_material(seed, most=10.0):
    """A stable stiffness without symmetry, with eigenvalues of a ratio up to `most`."""
    rng = np.random.default_rng(seed)
    vectors = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    C = vectors @ np.diag(1e4 * most ** rng.uniform(0.0, 1.0, 6)) @ vectors.T
    return ts.AnisotropicMaterial.from_matrix(0.5 * (C + C.T))


def isotropic(of):
    """An isotropic material, by its stiffness."""
    lame = 2.0 * of.shear * of.poisson / (1.0 - 2.0 * of.poisson)
    C = np.diag([2.0 * of.shear] * 3 + [of.shear] * 3)
    C[:3, :3] += lame
    return ts.AnisotropicMaterial.from_matrix(C)


def integrate_response(of, angle, count=720):
    """k S by the integrals of Barnett and Lothe around the direction: no eigenvalues."""
    index = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
    c = np.array(of.stiffness)[index][:, :, index]
    x, z = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([0.0, 0.0, 1.0])
    L, S = np.zeros((3, 3)), np.zeros((3, 3))
    for phi in np.arange(count) * np.pi / count:
        m, n = np.cos(phi) * x + np.sin(phi) * z, np.cos(phi) * z - np.sin(phi) * x
        mm, mn, nn = (np.einsum("ijkl,j,l->ik", c, a, b) for a, b in ((m, m), (m, n), (n, n)))
        inverse = np.linalg.inv(nn)
        S -= inverse @ mn.T / count
        L += (mm - mn @ inverse @ mn.T) / count
    return (np.eye(3) - 1j * S) @ np.linalg.inv(L)


BODIES = {
    "(110)": material(**IRON, **ON_110),
    "(111)": material(**IRON, **ON_111),
    "fibres": material(**FIBRES, phi1=20.0, Phi=40.0),
    "isotropic": isotropic(ts.Material.from_young(208e3, 0.3)),
    "random": random_material(1),
    "unequal": random_material(2, 1e3),
}


@pytest.mark.parametrize("name", BODIES)
def test_spectrum(name):
    angles = np.array([0.0, 0.3, 2.0, 5.0])
    found = BODIES[name].response(angles)
    for angle, S in zip(angles, found, strict=True):
        expected = integrate_response(BODIES[name], angle)
        # rounding; ratios of 1000 cost digits in the integrals
        np.testing.assert_allclose(S, expected, rtol=0.0, atol=1e-10 * abs(expected).max())
    np.testing.assert_array_equal(found, found.swapaxes(1, 2).conj())


def test_spectrum_of_fibres():
    found = 1e6 * material(**FIBRES).response(np.array([np.pi / 6]))[0]
    expected = [[48.28106, -0.9884439, 25.737j], [-0.9884439, 228.6068, 18.66737j]]
    np.testing.assert_allclose(found[:2], expected, rtol=1e-6)  # digits of the expected values
    assert found[2, 2].real == pytest.approx(172.9303, rel=1e-6)


def at_offset(law, component, i, j, sides):
    """The coefficient at an offset of any sign, from its parts."""
    parts = law.parts(component).items()
    tables = [(law.coefficients(k, (abs(i) + 1, abs(j) + 1), *sides)[-1, -1], p) for k, p in parts]
    return sum(v * (x if i < 0 else 1) * (y if j < 0 else 1) for v, (x, y) in tables)


@pytest.mark.parametrize("component", ["xx", "xy", "zz", "xz", "yz"])
def test_coefficients_are_integrals_of_the_response(component):
    """The force on an element, in polar coordinates: the real part of S turned, by quadrature.

    u(x) = int S_R(phi + 90 degrees)/(2 pi r) - PV int S_I(theta)/cos(theta - phi)/(4 pi² r).
    """
    law = ts.AnisotropicHalfSpaces(random_material(3), BODIES["(111)"])
    i, j = ("xyz".index(axis) for axis in component)

    def response(angle):
        A, B = law.A.response(angle), law.B.response(angle)
        return (A + B.conj())[:, i, j]

    def kernel(x, y):
        phi, r = np.arctan2(y, x), np.hypot(x, y)
        even = response(np.array([phi + 0.5 * np.pi]))[0].real
        t = (np.arange(64) + 0.5) * np.pi / 64  # midpoints avoid the pole symmetrically
        odd = np.mean(response(phi + 0.5 * np.pi + t).imag / -np.sin(t))
        return even / (2.0 * np.pi * r) - odd / (2.0 * np.pi * r)

    nodes, weights = np.polynomial.legendre.leggauss(6)
    sides = 0.1, 0.15
    for at in ((2, 3), (-3, 1), (1, -4)):
        value = sum(
            0.25 * wx * wy * sides[0] * sides[1]
            * kernel((at[0] + 0.5 * nx) * sides[0], (at[1] + 0.5 * ny) * sides[1])
            for nx, wx in zip(nodes, weights, strict=True)
            for ny, wy in zip(nodes, weights, strict=True)
        )  # fmt: skip
        size = at_offset(law, "zz", *at, sides)
        assert at_offset(law, component, *at, sides) == pytest.approx(value, abs=1e-7 * size)


@pytest.mark.parametrize("other", [(208e3, 0.3), (70e3, 0.33)])
def test_isotropic_stiffness_is_the_isotropic_body(other):
    pair = ts.Material.from_young(208e3, 0.3), ts.Material.from_young(*other)
    kinds = ((ts.AnisotropicHalfSpaces, ts.HalfSpaces, ()),)
    kinds += ((ts.AnisotropicHalfSpaces, Strips, (10.0,)),)
    for kind, plain, datum in kinds:
        found, expected = kind(*map(isotropic, pair), *datum), plain(*pair, *datum)
        assert found.coupled == expected.coupled
        for component in ("xx", "xy", "yy", "zz", "xz", "yz"):
            assert len(found.parts(component)) == 1
            tables = [law.coefficients(component, (9, 12), 0.1, 0.13) for law in (found, expected)]
            size = abs(expected.coefficients("zz", (1, 1), 0.1, 0.13)).max()
            # rounding: antiderivatives far from the element are a hundred times larger
            np.testing.assert_allclose(*tables, rtol=0.0, atol=1e-13 * size)


def test_isotropic_stiffness_in_any_axes_is_solved_in_closed_form():
    lame, G = 120e3, 80e3
    five = {"C11": lame + 2 * G, "C12": lame, "C13": lame, "C33": lame + 2 * G, "C44": G}
    for changes in ({}, {"phi1": 20.0, "Phi": 50.0, "phi2": 10.0}):
        found = material(**five, **changes)
        assert isinstance(found, ts.TransverseMaterial)
        assert pytest.approx(lame + 2 * G, rel=1e-14) == found.C33  # rounding
    assert material(**five) == ts.TransverseMaterial(**five)


def test_operators_are_reciprocal():
    """All couplings: the convolution is the dense matrix, which is symmetric and positive."""
    shape, sides = (6, 5), (0.1, 0.13)
    law = ts.AnisotropicHalfSpaces(random_material(4), random_material(5))
    assert (law.coupled, law.interchangeable) == (True, False)
    operators = Operators(Lattice(shape, *sides), law, 1.0, 1.0)
    matrix = operators.coupled_displacement.as_matrix()
    matrix[30:] *= sides[0]  # displacement over dx
    size = abs(matrix).max()
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-14 * size)  # rounding
    assert np.linalg.eigvalsh(matrix)[0] > 0.0
    steps = [(i, j) for i in range(shape[0]) for j in range(shape[1])]
    dense = [
        [at_offset(law, "xz", here[0] - there[0], here[1] - there[1], sides) for there in steps]
        for here in steps
    ]
    np.testing.assert_allclose(matrix[30:60, :30], dense, atol=1e-14 * size)
    slip, both = operators.slip.as_matrix(), operators.coupled.as_matrix()
    np.testing.assert_allclose(slip, both[30:, 30:], atol=1e-14 * abs(slip).max())


def test_stuck_circle():
    """Mindlin: a circle that moves as a whole has the compliance <S>/(4 a), all six entries.

    Of equal bodies: the part of the response that is odd would change the distribution.
    """
    n, angles = 17, np.arange(64) * np.pi / 32
    dx = 1.0 / n
    x = dx * (np.arange(n) - 0.5 * (n - 1))
    stuck = np.tile((np.hypot(x[:, None], x) <= 0.5).ravel(), 3)
    units = np.repeat(np.eye(3), stuck.sum() // 3, axis=0)

    def stiffness_over_theory(of):
        law = ts.AnisotropicHalfSpaces(of, of)
        operators = Operators(Lattice((n, n), dx, dx), law, 1.0, 1.0 / dx)
        matrix = operators.coupled_displacement.as_matrix()[np.ix_(stuck, stuck)]
        mean = 2.0 * of.response(angles).mean(axis=0).real[[2, 0, 1]][:, [2, 0, 1]]
        return units.T @ np.linalg.solve(matrix, units) @ mean

    # Steps of the border and elements of constant traction change isotropic bodies as much.
    found = stiffness_over_theory(BODIES["(111)"])
    size = stiffness_over_theory(BODIES["isotropic"])[0, 0]
    np.testing.assert_allclose(found / size, np.eye(3), atol=1e-3)


CONTACTS = [
    (IRON, (0.15150459, 0.15150459, 2080.1267, 0.002295364)),
    (IRON | ON_110, (0.14287150, 0.15179523, 2201.5961, 0.002172703)),
    (IRON | ON_111, (0.14628139, 0.14628139, 2231.3270, 0.002139825)),
    (SILICON, (0.16571268, 0.16571268, 1738.7211, 0.002746069)),
    (FIBRES, (0.38935972, 0.43890439, 279.3962, 0.017211903)),
]


@pytest.mark.parametrize(("stiffness", "expected"), CONTACTS)
def test_hertz_contact(stiffness, expected):
    """A rigid ball, against Willis's integrals by quadrature; solved, of second order."""
    bodies = {"A": RIGID | BALL, "B": FLAT | {"stiffness": stiffness}}
    scene = ts.Scene(body=bodies, load={"normal": 100.0})
    h = scene.hertz
    np.testing.assert_allclose((h.a, h.b, h.p0, h.approach), expected, rtol=3e-7)  # digits
    by_pressure = scene.replace(load={"pressure": h.p0}).hertz
    by_approach = scene.replace(load={"approach": h.approach}).hertz
    assert by_pressure.load == pytest.approx(100.0, rel=1e-12)  # rounding
    assert by_approach.load == pytest.approx(100.0, rel=1e-12)
    half = [1.15 * h.a, 1.15 * h.b]
    errors = []
    for n in (21, 41):
        grid = {"half_length": half, "elements": [n, n]}
        contact = ts.solve(scene.replace(grid=grid))
        errors.append(abs(contact.approach / h.approach - 1.0))
    assert errors[1] < 2e-4
    assert errors[0] > 2.8 * errors[1]  # second order: 4, less the effect of the edge


def test_hertz_ellipse_turns_with_the_axes():
    """The contact of equal radii turns with the fibres: half lengths of the turned ellipse."""
    bodies = {"A": RIGID | BALL, "B": FLAT | {"stiffness": FIBRES}}
    scene = ts.Scene(body=bodies, load={"normal": 100.0})
    h, turned = scene.hertz, scene.replace(**{"body.B.stiffness.phi1": 30.0}).hertz
    assert turned.p0 == pytest.approx(h.p0, rel=1e-9)  # rounding
    x = np.sqrt(0.75 * h.a**2 + 0.25 * h.b**2)
    assert turned.a == pytest.approx(x, rel=1e-9)


def rolling(A, B, **changes):
    round_ = {"radius_x": 40.0, "radius_y": 40.0}
    bodies = {"A": round_ | A, "B": round_ | B}
    creepage = {"longitudinal": -4e-4, "lateral": 2e-4, "spin": 1e-4}
    scene = ts.Scene(body=bodies, load={"normal": 100.0}, friction={"mu": 0.3}, creepage=creepage)
    h = scene.hertz
    grid = {"half_length": [1.15 * h.a, 1.15 * h.b], "elements": [25, 25]}
    return scene.replace(grid=grid, **changes)


def test_transverse_isotropy_is_that_in_closed_form():
    """The law of any anisotropy with the stiffness of zinc, against the closed form."""
    five = {"C11": 165e3, "C12": 31.1e3, "C13": 50e3, "C33": 61.8e3, "C44": 39.6e3}
    scene = rolling({"stiffness": five}, STEEL)
    laws = ts.Laws.of(scene)
    C = np.diag([165e3, 165e3, 61.8e3, 39.6e3, 39.6e3, 66.95e3])
    C[0, 1] = C[1, 0] = 31.1e3
    C[:2, 2] = C[2, :2] = 50e3
    zinc = ts.AnisotropicMaterial.from_matrix(C)
    np.testing.assert_allclose(zinc.compliances, laws.elasticity.A.compliances, rtol=1e-13)
    any_body = laws.replace(elasticity=ts.AnisotropicHalfSpaces(zinc, laws.elasticity.B))
    found, expected = ts.solve(scene, laws=any_body), ts.solve(scene)
    for name in ("Qx", "Qy", "Mz", "p_max", "approach"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-6)  # tolerance


@pytest.mark.parametrize("other", [STEEL, {"stiffness": FIBRES | {"phi1": -30.0}}])
def test_mirrored_axes_mirror_the_contact(other):
    """Axes and creepages mirrored at y = 0: the same Q_x, the opposite Q_y and M_z."""
    scene = rolling({"stiffness": FIBRES | {"phi1": 30.0}}, other)
    angles = {"body.A.stiffness.phi1": -30.0}
    if "stiffness" in other:
        angles["body.B.stiffness.phi1"] = 30.0
    turned = {"creepage.lateral": -2e-4, "creepage.spin": -1e-4}
    found, expected = ts.solve(scene.replace(**angles, **turned)), ts.solve(scene)
    assert found.Qx == pytest.approx(expected.Qx, rel=1e-6)  # tolerance of the solution
    assert found.Qy == pytest.approx(-expected.Qy, rel=1e-5)
    assert found.Mz == pytest.approx(-expected.Mz, rel=1e-5)


def test_equal_crystals_without_symmetry_pull_sideways_in_free_rolling():
    """Their pressure displaces both surfaces alike, unlike that of isotropic bodies."""
    scene = rolling({"stiffness": IRON | ON_111}, {"stiffness": IRON | ON_111})
    free = {"creepage.longitudinal": 0.0, "creepage.lateral": 0.0, "creepage.spin": 0.0}
    contact = ts.solve(scene.replace(**free))
    assert contact.laws.elasticity.coupled
    assert abs(contact.Qy) > 0.03 * contact.P
    assert abs(contact.Qx) < 1e-3 * contact.P  # the plane y-z is one of symmetry
    balance = contact.Qx * 0.0 + contact.rolling_resistance
    assert balance == pytest.approx(contact.dissipation, rel=1e-3)


def test_newton_steps_under_a_fixed_pressure():
    """Slip that pressure causes ahead of the edge does not change with the tractions."""
    copper = {"stiffness": {"crystal": "copper"} | ON_111}
    model = Model(rolling(copper, copper))
    problem = model.problem(model.undeformed_gap / model.units.gap)
    outcome = FIXED_PRESSURE.solve(with_fixed_pressure(problem), 1e-9)
    assert outcome.converged
    assert outcome.iterations < 10  # the steps with a wrong derivative did not converge


def test_carter():
    """The creepage is (a - c) mu/R times the ratio of the compliances along x and z."""
    body = {"radius_x": 20.0, "radius_y": np.inf, "stiffness": IRON | ON_110}
    scene = ts.Scene(body={"A": body, "B": body}, load={"normal": 100.0}, friction={"mu": 0.3})
    S = material(**IRON, **ON_110).response(np.zeros(1))[0].real
    xi = -0.3 * 0.5 * scene.hertz.a / 10.0 * S[0, 0] / S[2, 2]
    contact = ts.solve(scene.replace(**{"creepage.longitudinal": xi}))
    assert contact.p_max == pytest.approx(scene.hertz.p0, rel=1e-4)  # 512 elements
    assert contact.Qx / 30.0 == pytest.approx(0.75, rel=1e-3)  # stick edge within an element


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:friction.mu")
def test_kalker():
    """Creep coefficients of zinc, by the law of any anisotropy, are those of `tangential`.

    Two meshes are extrapolated, whose errors change with the elements at the edge.
    """
    five = {"C11": 165e3, "C12": 31.1e3, "C13": 50e3, "C33": 61.8e3, "C44": 39.6e3}
    body = {"radius_x": 40.0, "radius_y": 40.0, "stiffness": five}
    scene = ts.Scene(
        body={"A": body, "B": body}, load={"normal": 100.0}, friction={"mu": 1000.0}
    )  # fmt: skip
    half, zinc = [1.1 * scene.hertz.a] * 2, scene.body.A.response
    any_body = ts.AnisotropicMaterial.from_matrix(zinc.stiffness)
    laws = ts.Laws.of(scene).replace(elasticity=ts.AnisotropicHalfSpaces(any_body, any_body))
    found = []
    for n in (44, 88):
        on_mesh = scene.replace(grid={"half_length": half, "elements": [n, n]})
        long, wide, turn = (
            ts.solve(on_mesh.replace(creepage={name: 1e-9}), laws=laws)
            for name in ("longitudinal", "lateral", "spin")
        )
        size = np.sqrt(np.count_nonzero(long.touching) * long.grid.element_area / np.pi)
        forces = np.array((long.Qx, wide.Qy, turn.Qy / size, turn.Mz / size**2))
        found.append(-forces / (1e-9 * size**2 * zinc.tangential.shear))
    expected = creep_coefficients(1.0, zinc.tangential.poisson)
    np.testing.assert_allclose(2.0 * found[1] - found[0], expected, rtol=8e-3)


def test_line_contact_of_crystals_without_symmetry():
    """Plane strain of all couplings: traction along y under creepage along x."""
    body = {"radius_x": 20.0, "radius_y": np.inf, "stiffness": FIBRES | {"phi1": 30.0}}
    scene = ts.Scene(body={"A": body, "B": body}, load={"normal": 50.0}, friction={"mu": 0.3})
    contact = ts.solve(scene.replace(**{"creepage.longitudinal": -1e-3}))
    assert contact.converged
    assert contact.p_max == pytest.approx(scene.hertz.p0, rel=1e-4)  # 512 elements
    assert abs(contact.Qy) > 0.01 * contact.Qx > 0.0


def test_layer_of_the_other_body():
    """A layer as stiff as its body changes nothing: the sum of both laws."""
    thin = {"thickness": 0.1} | STEEL
    nearly = {"thickness": 0.1, "young": 208e3 * (1.0 + 1e-9), "poisson": 0.3}
    plain = ts.solve(rolling({"stiffness": IRON}, STEEL))
    layered = ts.solve(rolling({"stiffness": IRON}, STEEL | {"layer": [nearly]}))
    alike = ts.solve(rolling({"stiffness": IRON}, STEEL | {"layer": [thin]}))
    assert alike.Qx == plain.Qx
    assert layered.Qx == pytest.approx(plain.Qx, rel=1e-4)  # meshes by different estimates
    assert layered.approach == pytest.approx(plain.approach, rel=1e-3)


@pytest.mark.parametrize(
    ("key", "stiffness"),
    [
        ("crystal", {"crystal": "kryptonite"}),
        ("stiffness.C11", {"crystal": "iron", "C11": 2e5}),
        ("stiffness.C44", {"C11": 2e5, "C12": 1e5}),
        ("stiffness.C33", {"C11": 2e5, "C12": 1e5, "C44": 1e5, "C13": 1e5}),
        ("stiffness.C55", {k: v for k, v in FIBRES.items() if k != "C55"}),
        ("stiffness.C22", IRON | {"C14": 1e3}),
        ("stiffness.C12", IRON | {"C12": 3e5}),
        ("stiffness.C12", IRON | {"C12": -1.5e5}),
        ("stiffness.C44", IRON | {"C44": -1.0}),
        ("stiffness.C44", IRON | {"C44": "soft"}),
        ("stiffness.C14", FIBRES | {"C14": 1e5}),
        ("stiffness.C13", FIBRES | {"C12": 30e3, "C13": -30e3, "C23": 9e3}),
        ("stiffness.along", IRON | {"normal": (1.0, 1.0, 0.0)}),
        ("stiffness.normal", IRON | {"along": (1.0, 1.0, 0.0)}),
        ("stiffness.along", IRON | {"normal": (1.0, 1.0, 0.0), "along": (1.0, 0.0, 0.0)}),
        ("stiffness.normal", IRON | {"normal": (0.0, 0.0, 0.0), "along": (1.0, 0.0, 0.0)}),
        ("stiffness.phi1", IRON | ON_110 | {"phi1": 3.0}),
        ("stiffness.normal", IRON | {"normal": (1.0, 1.0), "along": (1.0, 0.0, 0.0)}),
        ("stiffness.C67", IRON | {"C67": 1.0}),
        ("stiffness.C11", {}),
    ],
)
def test_faults_name_the_key(key, stiffness):
    with pytest.raises(ts.SceneError) as error:
        rolling({"stiffness": stiffness}, STEEL)
    assert key in str(error.value)


@pytest.mark.parametrize("stiffness", [np.eye(5), np.diag([1, 1, 1, 1, 1, -1]), np.tri(6)])
def test_unstable_material(stiffness):
    with pytest.raises(ValueError, match="stiffness"):
        ts.AnisotropicMaterial.from_matrix(stiffness)


def test_scene_round_trips_and_describes():
    scene = rolling({"stiffness": {"crystal": "silicon"} | ON_111}, STEEL)
    assert ts.Scene.from_toml_text(scene.to_toml()) == scene
    assert "means over the directions" in str(ts.explain(scene))


def test_jacobian():
    """Against differences, also of the jump by pressure ahead of the leading edge."""
    copper = {"stiffness": {"crystal": "copper"} | ON_111}
    scene = rolling(copper, copper).replace(**{"solver.tolerance": 1e-10})
    jacobian = ts.solve(scene, jacobian=True).jacobian
    for name, key, step in (("xi_y", "creepage.lateral", 1e-7), ("mu1", "friction.mu", 1e-5)):
        values = [
            {key: 2e-4 + sign * step} if name == "xi_y" else {key: (0.3 + sign * step, 0.3)}
            for sign in (1.0, -1.0)
        ]
        after, before = (ts.solve(scene.replace(**value)) for value in values)
        for result in ("Qx", "Qy", "Mz"):
            change = (getattr(after, result) - getattr(before, result)) / (2.0 * step)
            found = float(jacobian.loc[result, name])
            assert found == pytest.approx(change, rel=1e-4)  # rounding of small differences


def test_study_of_the_direction_of_fibres(tmp_path):
    """The angle is a numeric key; 180 degrees later the fibres are the same."""
    (tmp_path / "fibres.toml").write_text(rolling({"stiffness": FIBRES}, STEEL).to_toml())
    axis = {"key": "body.A.stiffness.phi1", "values": [0.0, 45.0, 180.0]}
    study = ts.Study(scene=str(tmp_path / "fibres.toml"), axis=[axis])
    data = ts.study(study, tmp_path / "fibres.nc").dataset()
    Qx, Qy = data["Qx"].values, data["Qy"].values
    assert Qx[2] == pytest.approx(Qx[0], rel=1e-6)  # tolerance of the solution
    assert abs(Qy[1] - Qy[0]) > 0.01


def test_transient_and_wear():
    """Turned crystals in a transient and with wear; the balance of energy holds."""
    wear = {"coefficient": 1e-7, "revolutions": 2}
    scene = rolling({"stiffness": {"crystal": "copper"} | ON_111}, STEEL, wear=wear)
    history = ts.roll(scene)
    assert history["wear_max"][-1] > 0.0
    stages = [{"distance": [0.0, 0.1], "creepage": {"longitudinal": [0.0, -4e-4]}}]
    transient = rolling({"stiffness": {"crystal": "copper"} | ON_111}, STEEL)
    steps = ts.roll(transient.replace(transient={"stage": stages}))
    stored = steps["elastic_energy"] - steps["elastic_energy"][0]
    supplied, lost = (np.cumsum(steps[k][1:]) for k in ("step_work", "step_friction"))
    np.testing.assert_allclose(supplied, stored[1:] + lost, atol=1e-3 * supplied[-1])
