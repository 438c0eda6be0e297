"""Rolling of bodies that relax, against semi-analytical solutions and exact limits."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model

# Both bodies alike, with E* = 1 MPa and R = 100 mm; the load makes the glassy a = 1 mm.
YOUNG = 2.0 * (1.0 - 0.3**2)
ROUND = {"young": YOUNG, "poisson": 0.3, "radius_x": 200.0, "radius_y": 200.0}
LONG = ROUND | {"radius_y": np.inf}
SPEED = 100.0
LINE = ts.Scene(
    body={"A": LONG, "B": LONG},
    load={"normal": np.pi / 400.0},
    grid={"half_length": [2.0], "elements": [64]},
)
SPHERE = ts.Scene(
    body={"A": ROUND, "B": ROUND},
    load={"normal": 4.0 / 300.0},
    grid={"half_length": [2.0, 2.0], "elements": [24, 24]},
)
RUBBER = ts.Scene.builtin("rubber-roller")


def relaxing(scene, terms, bodies="AB", **changes):
    """A scene with terms (ratio, V tau in mm) of both bodies."""
    each = [{"ratio": ratio, "time": length / SPEED} for ratio, length in terms]
    terms = {f"body.{body}.relaxation": each for body in bodies}
    return scene.replace(**terms, **({"creepage": {"speed": SPEED}} | changes))


def rolling(scene, ratio, length, half_length, elements):
    """The contact of bodies with one term, on a mesh."""
    count = 1 if scene.line else 2
    grid = {"half_length": (half_length,) * count, "elements": (elements,) * count}
    return ts.solve(relaxing(scene, [(ratio, length)], grid=grid))


@pytest.mark.parametrize(
    ("ratio", "length", "a", "lead", "pressure", "moment"),
    [
        (1.0, 0.2, 1.36443, 1.41176, 0.71031, 0.089440),
        (1.0, 1.0, 1.19235, 1.36980, 0.83189, 0.262159),
        (1.0, 5.0, 1.02281, 1.19598, 0.97909, 0.197942),
        (9.0, 1.0, 2.71802, 3.12836, 0.45655, 0.745958),
        (9.0, 5.0, 1.46932, 2.65611, 0.85860, 1.510026),
        (1.0, 0.02, 1.409214, 1.414187, 0.707134, 0.009894),
        (1.0, 50.0, 1.000453, 1.040733, 0.999564, 0.042780),
        (3.0, 0.5, 1.814310, 1.987019, 0.510098, 0.317047),
    ],
)
def test_cylinder(ratio, length, a, lead, pressure, moment):
    """Integral equation of Cauchy type with two unknown edges, by quadrature."""
    contact = rolling(LINE, ratio, length, 1.05 * lead, 256)
    assert contact.half_width_x == pytest.approx(a, rel=1e-3)
    assert contact.p_max / 0.005 == pytest.approx(pressure, rel=1e-3)
    assert contact.My / contact.P == pytest.approx(moment, rel=1e-3)


def test_cylinder_is_of_second_order():
    """The largest of a few meshes, as the place of the edges within elements varies."""
    exact, errors = np.array((0.83189, 0.262159)), []
    for counts in ((40, 46, 54), (160, 184, 216)):
        contacts = [rolling(LINE, 1.0, 1.0, 1.5, n) for n in counts]
        found = np.array([(c.p_max / 0.005, c.My / c.P) for c in contacts])
        errors.append(np.abs(found / exact - 1.0).max(axis=0))
    # Four times the elements: a sixteenth of the error by the second order, an eighth by 1.5.
    assert (errors[1] < errors[0] / 8.0).all()


@pytest.mark.parametrize(
    ("ratio", "length", "approach", "moment"),
    [(1.0, 0.2, 1.5807, 0.0850), (1.0, 1.0, 1.4859, 0.1992), (9.0, 5.0, 3.0722, 0.7460)],
)
def test_sphere(ratio, length, approach, moment):
    """Dense equations with coefficients by quadrature, extrapolated in the element size."""
    contact = rolling(SPHERE, ratio, length, 2.3 if ratio > 1.0 else 1.5, 48)
    assert contact.approach / 0.01 == pytest.approx(approach, rel=3e-3)
    assert contact.My / contact.P == pytest.approx(moment, rel=3e-3)


def test_slow_and_fast_rolling():
    """Exact limits: the pressure moves by f/(1 + f) V tau; the fast moment of a sphere."""
    slow = rolling(LINE, 2.0, 1e-3, 2.0, 512)
    # Where V tau is less than an element, the error of the moment is about an element over a.
    assert slow.My / slow.P == pytest.approx(2.0 / 3.0 * 1e-3, rel=6e-3)
    fast = rolling(SPHERE, 2.0, 1e3, 1.1, 32)
    # The next order is 6 % at V tau = 50 a for f = 1, and falls in proportion to it.
    assert fast.My * 1e3 / fast.P == pytest.approx(0.8 * 2.0, rel=2e-2)


@pytest.mark.parametrize(("length", "softening"), [(1e-4, 3.0), (1e7, 1.0)])
def test_approach_of_a_line_in_slow_and_fast_rolling(length, softening):
    """Relative to points at the distance of the datum, which relax as well."""
    contact = rolling(LINE, 2.0, length, 2.0, 64)
    young = {f"body.{body}.young": YOUNG / softening for body in "AB"}
    elastic = ts.solve(LINE.replace(**young, **{"grid.elements": (64,)}))
    # The logarithm far away is that of polynomials between points in the ratio 13/12.
    assert contact.approach == pytest.approx(elastic.approach, rel=1e-4)


def test_terms_of_ratio_zero_are_the_plain_body():
    plain, zero = ts.solve(LINE), ts.solve(relaxing(LINE, [(0.0, 1.0)]))
    assert np.array_equal(plain.pressure, zero.pressure)
    assert plain.approach == zero.approach


def test_terms_of_equal_time_add():
    """Two terms, and their sum as one, in either body or in both."""
    one = ts.solve(relaxing(LINE, [(1.0, 0.7)]))
    two = ts.solve(relaxing(LINE, [(0.4, 0.7), (0.6, 0.7)]))
    assert two.pressure == pytest.approx(one.pressure, abs=1e-6 * one.p_max)
    half = ts.solve(relaxing(LINE, [(2.0, 0.7)], bodies="B", friction=None))
    assert half.My == pytest.approx(one.My, rel=1e-6)


def test_modulus_and_compliance():
    """Relaxation of the modulus and the creep that follows from it, terms and step responses."""
    g, tau = np.array((0.3, 0.4)), np.array((0.01, 0.2))
    terms = np.array(ts.creep_terms(list(zip(g, tau, strict=True)))).T
    s = np.geomspace(0.1, 1e4, 20)[:, None]
    modulus = 1.0 - (g * 1.0 / (1.0 + s * tau)).sum(axis=1)
    creep = 1.0 + (terms[0] / (1.0 + s * terms[1])).sum(axis=1)
    assert modulus * creep == pytest.approx(1.0, rel=1e-12)
    by_modulus = [{"ratio": 0.5, "time": 0.005, "of": "modulus"}]
    terms = {f"body.{body}.relaxation": by_modulus for body in "AB"}
    scene = LINE.replace(**terms, creepage={"speed": SPEED})
    assert ts.solve(scene).My == pytest.approx(ts.solve(relaxing(LINE, [(1.0, 1.0)])).My, rel=1e-6)


def dashpots(contact, ratio, length):
    """Power over speed of the dashpots of one term: f/T (p - q) L (p - q), from far behind on.

    The force q of the spring follows the pressure, q - T dq/dx = p; exact for steps of p.
    """
    n, dx = contact.grid.elements[0], contact.grid.dx
    behind = 10 * n
    p = np.concatenate((np.zeros(behind), contact.pressure[:, 0], np.zeros(3)))
    q, fall = np.zeros(len(p) + 1), np.exp(-dx / length)
    for i in range(len(p) - 1, -1, -1):  # at the rear faces of elements
        q[i] = fall * q[i + 1] + (1.0 - fall) * p[i]
    # Mean over an element of p - q, which falls exponentially from its front on.
    missed = (p - q[1:]) * length / dx * (1.0 - fall)
    law = ts.Laws.of(contact.scene).elasticity
    plain = ts.LinearHalfSpaces(law.A.body, law.B.body, law.datum)
    table = plain.coefficients("zz", (len(p), 1), dx, 1.0)[:, 0]
    i = np.arange(len(p))
    return ratio / length * dx * missed @ (table[abs(i[:, None] - i)] @ missed)


def test_bulk_dissipation_is_that_of_the_dashpots():
    contact = rolling(LINE, 1.0, 1.0, 1.5, 100)
    assert sum(contact.bulk_dissipation.values()) == pytest.approx(
        dashpots(contact, 1.0, 1.0), rel=2e-3
    )  # the means over elements are of second order
    assert contact.bulk_dissipation["A"] == pytest.approx(contact.bulk_dissipation["B"])


@pytest.mark.parametrize(
    "scene",
    [
        RUBBER.replace(grid={"half_length": [2.5], "elements": [60]}),
        relaxing(
            SPHERE,
            [(2.0, 0.5)],
            bodies="A",
            friction={"mu": 0.3},
            creepage={"speed": SPEED, "longitudinal": -5e-4, "lateral": 2e-4, "spin": 1e-4},
        ),
        relaxing(
            SPHERE, [(2.0, 0.5)], friction={"mu": 0.3}, load={"normal": 0.01, "force_x": 0.002}
        ),
    ],
    ids=["roller", "dissimilar", "alike"],
)
def test_energy(scene):
    """Forces, creepages and the slope of the gap supply what friction and bulk dissipate."""
    contact = ts.solve(scene)
    inside = contact.bulk_dissipation
    assert inside["A"] > 0.0
    assert inside["B"] >= -1e-12 * inside["A"]
    assert contact.dissipation > 0.0
    lost = contact.dissipation + inside["A"] + inside["B"]
    assert lost == pytest.approx(contact.work_supplied, rel=1e-9)  # an identity up to rounding


def test_resistance_is_moment_over_radius():
    contact = ts.solve(RUBBER)
    radius = RUBBER.body.radii[0]
    assert contact.rolling_resistance == pytest.approx(contact.My / radius, rel=1e-4)


def test_tractions_of_bodies_that_relax_alike():
    """In slow rolling tractions are those of bodies with the modulus long after loading."""
    creep = {"speed": SPEED, "longitudinal": -1e-3}
    friction = {"mu": 0.3}
    grid = {"half_length": [2.2], "elements": [128]}
    slow = ts.solve(relaxing(LINE, [(1.0, 1e-4)], friction=friction, creepage=creep, grid=grid))
    soft = LINE.replace(
        **{"body.A.young": YOUNG / 2.0, "body.B.young": YOUNG / 2.0},
        friction=friction,
        creepage=creep,
        grid=grid,
    )
    assert slow.Qx == pytest.approx(ts.solve(soft).Qx, rel=1e-3)  # V tau is 1e-4 of a


def test_stress_below_the_surface_is_that_of_the_tractions():
    """Creep changes no stress of a half-space under given tractions."""
    scene = relaxing(LINE, [(1.0, 1.0)])
    contact = ts.solve(scene)
    law = ts.Laws.of(LINE).elasticity
    plain = ts.Laws.of_contact(contact).replace(elasticity=law)
    points = np.array([[0.1, 0.0, 0.5], [-0.3, 0.0, 1.0]])
    found = ts.stress_at(contact, points)
    assert found == pytest.approx(ts.stress_at(contact, points, laws=plain), rel=1e-9)


@pytest.mark.parametrize("length", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize("ratio", [0.1, 100.0])
def test_dense_equations(ratio, length):
    """Pivots of dense equations, at strong and at weak damping."""
    # The contact is glassy in fast rolling.
    half = 1.2 * (1.0 + (ratio if length < 1e3 else 0.0)) ** (1.0 / 3.0)
    grid = {"half_length": (half, half), "elements": (15, 15)}
    scene = relaxing(SPHERE, [(ratio, length)], grid=grid)
    contact, model = ts.solve(scene), Model(scene)
    gap = (model.undeformed_gap / model.units.gap).ravel()
    matrix = model.operators.normal.as_matrix().reshape(gap.size, gap.size)
    assert np.linalg.eigvalsh(matrix + matrix.T).min() > 0.0
    active = contact.touching.ravel()
    inner = np.flatnonzero(active)
    rows = np.block(
        [
            [matrix[np.ix_(inner, inner)], -np.ones((inner.size, 1))],
            [np.ones((1, inner.size)), np.zeros((1, 1))],
        ]
    )
    *pressure, approach = np.linalg.solve(rows, np.append(-gap[inner], model.load))
    found = contact.pressure.ravel()[inner] / model.units.pressure
    assert np.min(pressure) > 0.0
    assert found == pytest.approx(np.array(pressure), abs=1e-5 * max(pressure))
    remaining = gap + matrix[:, inner] @ np.array(pressure) - approach
    assert remaining[~active].min() > -1e-9 * approach


def test_file_and_history(tmp_path):
    scene = RUBBER.replace(grid={"half_length": [2.5], "elements": [40]})
    history = ts.roll(scene, tmp_path / "roller.nc")
    contact = ts.solve(scene)
    stored = ts.open_history(tmp_path / "roller.nc")
    assert stored["My"][-1] == history["My"][-1] == pytest.approx(contact.My, rel=1e-6)
    read = stored.state()
    assert read.bulk_dissipation == pytest.approx(contact.bulk_dissipation, rel=1e-6)
