"""What a pass of a solved contact does to its bodies, against closed forms."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.results import BodyFatigue
from tractive_sam.subsurface import cycle_depths

ASKED = {"shear_yield": 300.0, "criterion": "orthogonal-shear", "limit": 250.0}


def cylinders(mu, elements, **requested):
    """In full slip; nothing else changes a line contact of equal materials."""
    scene = ts.Scene.builtin("cylinders")
    grid = {"half_length": 1.1 * scene.hertz.a, "elements": elements}
    tables = {"friction.mu": mu, "creepage.longitudinal": -0.05, "grid": grid}
    return scene.replace(subsurface=None, fatigue=ASKED | requested, **tables)


@pytest.mark.parametrize(
    ("mu", "certain", "depth"), [(0.1, 3.564, 0.46), (0.2, 3.202, 0.42), (0.3, 2.900, 0.38)]
)
def test_shakedown_below_a_line_contact(mu, certain, depth):
    scene = cylinders(mu, 101)
    p0, a = scene.hertz.p0, scene.hertz.a
    for cycled in ts.fatigue(ts.solve(scene)).values():
        left = cycled.largest("residual_shear")
        assert p0 / left.interior == pytest.approx(certain, rel=5e-4)  # of 83 elements
        assert left.interior_at[2] / a == pytest.approx(depth, abs=0.02)  # flat
        assert cycled.shakedown_lower == pytest.approx(300.0 / left.value)
        assert cycled.shakedown_lower <= cycled.shakedown_upper


def test_shakedown_at_the_surface_of_a_line_contact_falls_towards_its_limit():
    errors = []
    for elements in (51, 101, 201):
        scene = cylinders(0.3, elements)
        cycled = ts.fatigue(ts.solve(scene))["A"]
        errors.append(
            abs(scene.hertz.p0 / cycled.largest("residual_shear").surface / 2.99702 - 1.0)
        )
    assert errors[2] < 1e-3  # of 182 elements
    assert errors[2] < errors[0]


@pytest.mark.parametrize(
    ("ratio", "shear", "depth"),
    [(0.5, 0.2372, 0.4351), (1.0, 0.2139, 0.3509), (2.0, 0.1731, 0.2481)],
)
def test_orthogonal_shear_below_frictionless_ellipses(ratio, shear, depth):
    """Lundberg and Palmgren (1947): tau_0/p0 and the depth over the semi-axis in x."""
    scene = ts.Scene.builtin("spheres").replace(
        friction=None, creepage=None, grid=None, subsurface=None, fatigue=ASKED | {"bodies": ["A"]}
    )
    # Radii for which the semi-axes have this ratio.
    low, high = 1e-3, 1e3
    for _ in range(60):
        middle = math.sqrt(low * high)
        bent = scene.replace(
            **{"body.B.radius_y": 460.0 * middle, "body.A.radius_y": 460.0 * middle}
        )
        low, high = (middle, high) if bent.hertz.a / bent.hertz.b > ratio else (low, middle)
    scene, hertz = bent, bent.hertz
    grid = {"half_length": [1.1 * hertz.a, 1.1 * hertz.b], "elements": [61, 61]}
    cycled = ts.fatigue(ts.solve(scene.replace(grid=grid)))["A"]
    top = cycled.largest()
    assert top.interior * 250.0 / hertz.p0 == pytest.approx(shear, rel=3e-3)  # of 55 elements
    assert top.interior_at[2] / hertz.a == pytest.approx(depth, abs=0.02)
    assert abs(top.interior_at[1]) < 0.05 * hertz.b


def test_equal_bodies_without_friction_are_alike():
    scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 21]"])
    scene = scene.replace(friction=None, creepage=None, subsurface=None, fatigue=ASKED)
    cycled = ts.fatigue(ts.solve(scene))
    for name in ("utilisation", "residual_shear", "path_radius"):
        there, here = (getattr(cycled[body], name) for body in "AB")
        np.testing.assert_allclose(there, here, rtol=1e-12, atol=1e-9)
        np.testing.assert_allclose(there, there[::-1], rtol=1e-7, atol=1e-6)  # even in y


DISSIMILAR = {
    "A": {"young": 208e3, "poisson": 0.3, "radius_x": 20.0, "radius_y": 30.0},
    "B": {"young": 120e3, "poisson": 0.22, "radius_x": 40.0, "radius_y": math.inf},
}
PATHS = {
    "spin": ts.Scene(
        body=DISSIMILAR,
        load={"normal": 200.0},
        creepage={"longitudinal": -0.003, "lateral": 0.002, "spin": 0.01},
        friction={"mu": [0.45, 0.25], "angle": 25.0},
        grid={"half_length": [0.45, 0.55], "elements": [17, 17]},
        fatigue=ASKED | {"elements": 8},
    ),
    "braking": ts.Scene(
        body=DISSIMILAR,
        load={"normal": 200.0},
        creepage={"longitudinal": 0.02},
        friction={"mu": 0.15},
        grid={"half_length": [0.3, 0.5], "elements": [17, 17]},
        fatigue=ASKED | {"elements": 8},
    ),
    "light": cylinders(0.1, 31),
    "rough": cylinders(0.4, 31),
}


def whole_path(contact, y, depth, body):
    """Stress at the centres of elements within 4 a, and closely on to 4000 a."""
    a, dx = contact.half_width_x, contact.grid.dx
    beside = contact.grid.x[-1] + dx * np.arange(1, math.ceil(3.0 * a / dx))
    further = beside[-1] * np.geomspace(1.0, 1e3, 150)[1:]
    x = np.concatenate((contact.grid.x, beside, -beside, further, -further))
    path = ts.stress_path(contact, y, depth, body, x=x)
    return np.array([np.append(path[name], 0.0) for name in ("xx", "yy", "zz", "xy", "xz", "yz")])


@pytest.mark.slow
@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("shallow", [False, True])
def test_paths_include_the_maxima_outside_the_contact(name, shallow):
    """Tension behind the contact has its maximum several semi-axes away."""
    contact = ts.solve(PATHS[name])
    a, y = contact.half_width_x, contact.grid.y
    depths = np.array([0.0, 0.1, 0.3]) * a if shallow else cycle_depths(contact)
    rows = np.unique([y.size // 2, y.size // 3])
    # 1e-3: the spacing of the columns. The centre of a ball moves with the spacing, the radius with
    # its square.
    for criterion, rtol in (
        (ts.Crossland(0.4), 1e-3),
        (ts.Findley(0.3), 1e-3),
        (ts.FatemiSocie(0.8, 500.0), 1e-3),
        (ts.OrthogonalShear(), 1e-3),
        (ts.DangVan(0.33), 4e-3),
    ):
        laws = ts.Laws.of(contact.scene).replace(fatigue=criterion)
        for body, found in ts.fatigue(contact, depths=depths, laws=laws).items():
            whole = [
                [float(criterion(whole_path(contact, y[j], z, body))) for z in depths[1:]]
                for j in rows
            ]
            here = 250.0 * found.utilisation[rows, 1:]
            np.testing.assert_allclose(here, whole, rtol=rtol, err_msg=f"{criterion} {body}")


def test_mirrored_contacts_stress_mirrored_material():
    """Also outside the contact: blocks of elements act as point forces there."""
    scene = PATHS["spin"].replace(friction={"mu": 0.3}, **{"load.normal": 150.0})
    crossland = {"criterion": "crossland", "sensitivity": 0.4}
    for rows in (16, 17):
        each = []
        for sign in (1.0, -1.0):
            creepage = {"longitudinal": -0.003, "lateral": 0.002 * sign, "spin": 0.01 * sign}
            changes = {"creepage": creepage, "fatigue": ASKED | crossland | {"elements": 8}}
            tables = changes | {"grid.elements": [17, rows]}
            each.append(ts.fatigue(ts.solve(scene.replace(**tables)))["A"].utilisation)
        np.testing.assert_allclose(each[0], each[1][::-1], rtol=1e-6)  # of the contacts


@pytest.mark.slow
def test_the_surface_changes_little_as_the_edge_crosses_an_element():
    """A flip from record to record would make the jumps of a roll short, and its damage wrong."""
    scene = ts.Scene.builtin("spheres").replace(
        creepage={"longitudinal": -0.05}, subsurface=None, fatigue=ASKED | {"bodies": ["A"]}
    )
    scene = scene.with_set(["fatigue.criterion=dang-van", "fatigue.sensitivity=0.333"])
    half = [1.3 * scene.hertz.a] * 2
    used = []
    for larger in np.linspace(1.0, 1.25, 11):  # by which the edge goes 1.2 elements outward
        grid = {"half_length": half, "elements": [41, 41]}
        loaded = scene.replace(grid=grid, load={"normal": larger * scene.load.normal})
        cycled = ts.fatigue(ts.solve(loaded))["A"]
        used.append(cycled.utilisation[14:27, 0] / loaded.hertz.p0)  # up to 0.4 b
    # For a sphere all are equal; the edge in its elements makes 1 %.
    assert np.ptp(np.log(used), axis=0).max() < 0.02


def test_without_a_yield_stress_or_a_limit_the_rest_is_reported():
    scene = cylinders(0.1, 21)
    contact = ts.solve(scene)
    depths = cycle_depths(contact)
    cycled = ts.fatigue(ts.solve(scene.replace(fatigue={"limit": 250.0, "sensitivity": 0.3})))["A"]
    assert math.isnan(cycled.shakedown_lower)
    assert math.isnan(cycled.load_factor(math.nan))
    assert cycled.utilisation_max > 0.0
    cycled = ts.fatigue(ts.solve(scene.replace(fatigue={"yield_strength": 500.0})))["B"]
    assert math.isnan(cycled.utilisation_max)
    assert cycled.shakedown_upper > 0.0
    np.testing.assert_array_equal(cycled.depth, depths)
    with pytest.raises(ValueError, match="fatigue"):
        ts.fatigue(ts.solve(scene.replace(fatigue=None)))
    with pytest.raises(ValueError, match="depths"):
        ts.fatigue(contact, depths=depths[1:])


def test_a_criterion_user_defined_is_requested():
    class Doubled(ts.CycleCriterion):
        name, long_name = "doubled", "range of the orthogonal shear stress"

        def __call__(self, cycle):
            return 2.0 * ts.OrthogonalShear()(cycle)

    contact = ts.solve(cylinders(0.1, 21))
    laws = ts.Laws.of(contact.scene)
    own = ts.fatigue(contact, laws=laws.replace(fatigue=Doubled()))["A"]
    np.testing.assert_allclose(own.utilisation, 2.0 * ts.fatigue(contact)["A"].utilisation)


def test_every_record_has_its_columns():
    scene = ts.Scene.builtin("twin-discs").with_set(
        ["grid.elements=[15, 31]", "wear.revolutions=3", "wear.save=[0, 3]"]
    )
    requested = {"shear_yield": 300.0, "sensitivity": 0.333, "limit": 250.0}
    scene = scene.replace(subsurface=None, fatigue=requested)
    history = ts.roll(scene)
    for row, revolution in ((0, 0), (-1, 3)):
        for k, cycled in enumerate(ts.fatigue(history.state(revolution)).values()):
            for name in ("shakedown_lower", "shakedown_upper"):
                assert history[name][row, k] == pytest.approx(getattr(cycled, name), rel=1e-9)
            assert history["utilisation"][row, k] == pytest.approx(cycled.utilisation_max, rel=1e-9)
    k = 300.0 / history["p_max"][0]
    assert history["fi_surf"][0] <= 0.6 - k
    reported = history.to_dict()
    assert set(reported["utilisation"]) == {"A", "B"}
    assert reported["utilisation_at"]["A"][0][0] is None  # all x count
    assert "utilisation" not in ts.roll(scene.replace(fatigue=None, wear=None)).columns


def volume_life(scene, life, elements):
    """By the orthogonal shear, on a mesh that goes with the contact."""
    hertz = scene.hertz
    half = 1.1 * hertz.a if scene.line else [1.1 * hertz.a, 1.1 * hertz.b]
    grid = {"half_length": half, "elements": elements}
    cycled = ts.fatigue(ts.solve(scene.replace(grid=grid)))["A"]
    volume = life.volume(cycled.y, cycled.depth, 250.0 * cycled.utilisation, around=100.0)
    return life.life(volume)


@pytest.mark.parametrize(
    ("name", "slope", "exponent", "elements"),
    [("spheres", 10.0 / 9.0, 3.0, [21, 21]), ("cylinders", 9.0 / 8.0, 4.0, 41)],
)
def test_the_load_life_exponents_of_lundberg_and_palmgren(name, slope, exponent, elements):
    scene = ts.Scene.builtin(name).replace(friction=None, creepage=None, grid=None, subsurface=None)
    scene = scene.replace(fatigue=ASKED | {"bodies": ["A"]})
    life = ts.VolumeLife(slope=slope)
    light = volume_life(scene, life, elements)
    heavy = scene.replace(**{"load.normal": 2.0 * scene.load.normal})
    # Equal numbers on a mesh that is larger by this factor, to the solver's tolerance.
    assert light / volume_life(heavy, life, elements) == pytest.approx(2.0**exponent, rel=1e-5)


def test_survival_is_that_of_weibull():
    life = ts.VolumeLife(constant=1e-3, limit=100.0)
    y, depth = np.linspace(-1.0, 1.0, 5), np.linspace(0.0, 1.0, 9)
    stress = np.full((5, 9), 90.0)
    assert life.volume(y, depth, stress) == 0.0  # below the limit
    assert life.life(0.0) == math.inf
    volume = life.volume(y, depth, stress + 11.0, around=2.0)
    assert volume > 0.0
    assert life.survival(volume, life.life(volume, 0.9)) == pytest.approx(0.9, rel=1e-12)


def test_rounding_does_not_choose_between_tied_rows():
    """The best residual stress of a depth leaves two rows equal, which rounding reports apart."""
    depth = np.array([0.0, 0.1, 0.25, 0.4, 0.6])
    rows = np.array([0.3, 0.7, 1.0, 1.0, 0.9, 0.2, 0.4, 1.0, 0.1])
    values = rows[:, None] * np.array([0.5, 0.9, 1.0, 0.8, 0.3])

    def largest(values):
        fatigue = BodyFatigue("A", np.arange(9.0), depth, values, values, values, None, 1.0)
        return fatigue.largest("residual_shear").interior

    found = []
    for row in (2, 3, 7):
        rounded = values.copy()
        rounded[row] *= 1.0 + 4e-16
        found += [largest(rounded), largest(rounded[::-1])]
    np.testing.assert_allclose(found, found[0], rtol=1e-14)  # rounding of a few sums
    assert found[0] >= values.max()
