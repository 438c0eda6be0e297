"""Curved patches: closed forms in the plane, exact geometry and motion, limits, conservation."""

import math
import warnings

import numpy as np
import pytest
from scipy.optimize import brentq

import tractive_sam as ts
from tests.plot.rendering import render
from tractive_sam import plot
from tractive_sam.mechanics import CurvedPatch, HalfSpaces, Material
from tractive_sam.mechanics.conformal import _differences
from tractive_sam.mechanics.elasticity import PARITIES
from tractive_sam.schema import PlausibilityWarning, SceneWarning
from tractive_sam.studies import cases

INF = float("inf")
STEEL = {"young": 208e3, "poisson": 0.3}
UNIT = Material(1.0, 0.3)
GROOVE = ts.Scene.builtin("ball-in-groove")


def bore(degrees, load, elements, radius=10.0, clearance=1e-4):
    """A disc in a bore under a load over E* times the clearance."""
    e_star = 208e3 / (2.0 * 0.91)
    body = {
        "A": STEEL | {"radius_x": radius - 0.5 * clearance, "radius_y": INF},
        "B": STEEL | {"radius_x": -radius - 0.5 * clearance, "radius_y": INF},
    }
    half = 1.3 * math.radians(degrees) * radius
    grid = {"half_length": [half], "elements": [elements]}
    load = {"normal": load * e_star * clearance}
    return ts.Scene(body=body, load=load, conformal={}, grid=grid)


# Half angle, load and pressure at the middle over E* clearance, and over E* clearance / R: the
# integral equation of a disc in a hole of equal material, solved on graded elements.
PLANE = [
    (5.0, 0.006006, 0.043856),
    (10.0, 0.024325, 0.089067),
    (20.0, 0.102379, 0.189646),
    (30.0, 0.251777, 0.317312),
    (45.0, 0.708436, 0.624919),
    (60.0, 1.874059, 1.333808),
]


@pytest.mark.parametrize(("degrees", "load", "peak"), PLANE)
def test_disc_in_a_bore(degrees, load, peak):
    contact = ts.solve(bore(degrees, load, 201))
    # Printed to six digits, and the elements of the mesh: a few 1e-5.
    assert math.degrees(contact.half_width_x / 10.0) == pytest.approx(degrees, rel=1e-4)
    assert contact.p_max / (208e3 / 1.82 * 1e-5) == pytest.approx(peak, rel=3e-5)
    assert contact.resultant == pytest.approx((0.0, load * 208e3 / 1.82 * 1e-4), abs=1e-6)
    assert contact.resultant[1] < contact.P


def test_the_plane_solution_has_second_order():
    peaks = [ts.solve(bore(60.0, PLANE[-1][1], n)).p_max for n in (51, 101, 201, 401)]
    coarse, middle, fine = np.abs(np.diff(peaks))
    # The edge moves through an element, so that single ratios vary.
    assert max(coarse, middle) > 16.0 * fine
    assert max(coarse, middle) < 2e-5 * peaks[-1]


def test_unequal_materials_in_a_bore():
    """The modes of a disc and of a hole, each by Michell's solution, added up to n = 4000."""
    law = CurvedPatch((10.0, INF), (-10.0001, INF), line=True).elasticity(
        Material(3.0, 0.2), Material(1.0, 0.4)
    )
    dx, count = 0.02, 900
    table = law.coefficients("zz", (count, 1), dx, 1.0)[:, 0]
    n, t = np.arange(2, 20001), dx * np.arange(count) / law.datum
    equal = n / (n**2 - 1.0) * (0.8 / 3.0 + 0.6)
    unequal = (0.1 / 1.0 - 0.3 / 3.0) / (n**2 - 1.0)
    uniform = 0.5 * ((0.6 / 2.0) / 3.0 + 0.5)
    mean = np.sinc(0.5 * dx * n / (np.pi * law.datum))
    at = [3, 60, 200, 500, 800]
    waves = np.cos(np.outer(t[at], n)) @ ((equal + unequal) * mean)
    exact = dx / np.pi * (waves + uniform)
    # A displacement in proportion to cos t is one of the disc as a whole.
    rigid = np.cos(t[at])
    share = (table[at] - exact)[0] / rigid[0]
    assert table[at] - exact == pytest.approx(share * rigid, abs=2e-6)


# Waves n and k, and the sum of both radial compliances over that of half-spaces; for k -> 0 it is
# Michell's n²/(n² - 1).
WAVES = [
    (2, 1.0, 1.129662),
    (2, 5.0, 0.983678),
    (5, 2.0, 1.027853),
    (10, 10.0, 1.001102),
    (3, 20.0, 0.997780),
    (3, 1e-3, 9.0 / 8.0),
    (7, 1e-3, 49.0 / 48.0),
]


@pytest.mark.parametrize("concave", ["A", "B"])
@pytest.mark.parametrize(("n", "k", "ratio"), WAVES)
def test_waves_around_a_cylinder(concave, n, k, ratio):
    law = ts.ConformalBodies(UNIT, UNIT, 2.0, concave)
    waves = law.spectrum(np.array([n]), np.array([0.5 * k]))["zz"][0, 0]
    assert waves * math.hypot(n, k) / (2.0 * 1.4) == pytest.approx(ratio, rel=1e-6)


def test_short_waves_are_those_of_half_spaces():
    A, B = Material(3.0, 0.2), Material(1.0, 0.4)
    n, k = 800, np.array([600.0])
    flat = HalfSpaces(A, B)
    for concave in "AB":
        waves = ts.ConformalBodies(A, B, 1.0, concave).spectrum(np.array([n]), k)
        for component in PARITIES:
            value = flat.response(component, k, np.array([float(n)]))[0]
            value = value.imag if component in ("xz", "yz") else value.real
            # The difference decreases with the wave number, here 1000.
            size = flat.response("zz", k, np.array([float(n)]))[0]
            assert waves[component][0, 0] == pytest.approx(value, abs=1e-2 * size)


def test_coefficients_are_those_of_half_spaces_for_a_large_radius():
    flat = HalfSpaces(UNIT, UNIT)
    size = flat.coefficients("zz", (1, 1), 0.1, 0.2)[0, 0]
    for radius in (1e4, 1e6):
        law = ts.ConformalBodies(UNIT, UNIT, radius)
        for component in PARITIES:
            table = law.coefficients(component, (12, 12), 0.1, 0.2)
            even = flat.coefficients(component, (12, 12), 0.1, 0.2)
            # In proportion to the element over the radius.
            assert np.abs(table - even).max() < 0.2 / radius * size * 12


def test_coefficients_do_not_depend_on_the_number_of_waves():
    law = ts.ConformalBodies(UNIT, Material(2.0, 0.25), 10.0)
    few, many = (_differences.__wrapped__(law, (9, 9), 0.1, 0.2, most) for most in (200, 600))
    size = law.coefficients("zz", (1, 1), 0.1, 0.2)[0, 0]
    for component in PARITIES:
        # Of unlike bodies and of couplings the rest decreases with the second power of the waves.
        tolerance = 5e-4
        assert few[component] == pytest.approx(many[component], abs=tolerance * size)


def test_gap_of_a_ball_in_a_ring():
    """The separation of a sphere and of a torus along the normals of the patch, exact."""
    r, groove, ring = 5.0, 5.2, 20.0
    patch = CurvedPatch((r, r), (ring, -groove))
    for x, theta in ((0.0, 0.6), (0.1, 0.7), (0.15, -0.3), (0.2, 0.0)):
        place = np.array([x, patch.radius * np.sin(theta), patch.radius * (1.0 - np.cos(theta))])
        normal = np.array([0.0, -np.sin(theta), np.cos(theta)])

        def above_ball(s, place=place, normal=normal):
            return np.linalg.norm(place + s * normal - [0.0, 0.0, r]) - r

        def below_ring(s, place=place, normal=normal):
            x, y, z = place + s * normal
            return np.hypot(np.hypot(x, z + ring) - ring - groove, y) - groove

        exact = brentq(above_ball, -0.5, 0.5) - brentq(below_ring, -0.5, 0.5)
        gap = float(patch.gap(x, patch.radius * theta))
        # The curvature at x = 0 counts, and the normal is that of the cylinder: x²/R².
        assert gap == pytest.approx(exact, rel=4e-3, abs=1e-12)


def test_slip_of_rolling_is_that_of_two_rotations():
    for (inner, outer), rise in (
        (((5.0, 5.0), (20.0, -5.2)), 1.0),
        (((9.0, -5.2), (7.0, 5.0)), -1),
    ):
        patch = CurvedPatch(inner, outer)
        assert patch.rise == rise
        x, y = np.linspace(-0.1, 0.1, 5)[:, None], np.linspace(-3.0, 3.0, 7)[None, :]
        theta = y / patch.radius
        place = np.stack(
            np.broadcast_arrays(
                x, patch.radius * np.sin(theta), rise * patch.radius * (1.0 - np.cos(theta))
            )
        )
        tangent = np.stack([0.0 * theta, np.cos(theta), rise * np.sin(theta)])
        velocity = 0.0
        for radius, side, sign in ((inner[0], 1.0, 1.0), (outer[0], -1.0, -1.0)):
            centre = np.array([0.0, 0.0, side * radius])[:, None, None]
            rotation = np.array([0.0, side / radius, 0.0])
            velocity = velocity + sign * np.cross(rotation, place - centre, axisb=0, axisc=0)
        slip = patch.rolling_slip(x, y[0])
        assert slip[0] == pytest.approx(velocity[0], abs=1e-14)
        assert slip[1] == pytest.approx((velocity * tangent).sum(axis=0), abs=1e-14)


def test_a_ball_in_a_groove_carries_its_load():
    contact = ts.solve(GROOVE)
    # The tolerance of the solver.
    assert contact.resultant == pytest.approx((0.0, 2000.0), abs=1e-5 * 2000.0)
    assert contact.dissipation == pytest.approx(contact.work_supplied, rel=1e-9)  # rounding
    rolled = ts.roll(GROOVE)
    assert rolled["Fz"][0] == pytest.approx(2000.0, rel=1e-5)
    deeper = GROOVE.replace(
        **{"load.approach": contact.approach, "grid.half_length": contact.grid.half_length}
    )
    assert ts.solve(deeper).resultant[1] == pytest.approx(2000.0, rel=1e-5)


def test_exchanged_bodies_have_exchanged_forces():
    A, B = (GROOVE.body.entries()[name] for name in "AB")
    motion = {"creepage.longitudinal": 0.001, "creepage.lateral": 5e-4, "creepage.spin": 0.01}
    first = ts.solve(GROOVE.replace(**motion))
    # A turn by half a circle about x exchanges the bodies: y and z change their signs.
    turned = motion | {"creepage.longitudinal": -0.001, "creepage.spin": 0.01}
    second = ts.solve(GROOVE.replace(body={"A": B, "B": A}, **turned))
    assert second.p_max == pytest.approx(first.p_max, rel=1e-6)
    assert second.pressure == pytest.approx(first.pressure[:, ::-1], abs=1e-5 * first.p_max)
    # The force on the other body, and its turn.
    assert second.Qx == pytest.approx(-first.Qx, rel=1e-5)
    assert second.Qy == pytest.approx(first.Qy, rel=1e-5)


def test_a_small_contact_is_flat():
    """The difference of curved and flat contacts decreases with the square of the half angle."""
    differences = []
    for load in (0.02, 2.0, 200.0):
        curved = GROOVE.replace(**{"load.normal": load, "friction": None, "creepage": None})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SceneWarning)
            flat = curved.replace(conformal=None)
        p = [ts.solve(scene).p_max for scene in (curved, flat)]
        differences.append(abs(p[0] / p[1] - 1.0))
    # (1/100)^(2/3) = 1/21, less for terms of higher order in a half angle of 9 degrees.
    assert differences[1] == pytest.approx(differences[2] / 21.5, rel=0.2)
    assert differences[0] == pytest.approx(differences[1] / 21.5, rel=0.2)


def test_meshes_converge_with_second_order():
    peaks, forces = [], []
    for elements in ([13, 19], [27, 39], [55, 79]):
        contact = ts.solve(GROOVE.replace(**{"grid.elements": elements}))
        peaks.append(contact.p_max)
        forces.append(contact.Qx)
    assert abs(peaks[2] - peaks[1]) < 2e-3 * peaks[2]
    assert abs(forces[2] - forces[1]) < 0.5 * abs(forces[1] - forces[0]) + 1e-3 * abs(forces[2])


def test_a_program_with_the_same_geometry_has_the_same_pressure():
    """CONTACT's printed values for a flange root and for a ball in a groove, of half-spaces."""
    steel = {"shear": 82e3, "poisson": 0.28}
    wheel = steel | {"radius_x": 460.0 * math.sqrt(2.0), "radius_y": -10.2}
    rail = steel | {"radius_x": INF, "radius_y": 10.0}
    grid = {"half_length": [10.2, 7.8], "elements": [51, 39]}
    scene = ts.Scene(
        body={"A": wheel, "B": rail}, load={"approach": 0.09089}, conformal={}, grid=grid
    )
    flat = ts.Laws.of(scene).replace(elasticity=HalfSpaces(**scene.materials))
    contact = ts.solve(scene, laws=flat)
    # There, the curvature along x is the same at all angles.
    assert contact.p_max == pytest.approx(1012.0, rel=8e-3)
    steel = {"shear": 80e3, "poisson": 0.28}
    ball = steel | {"radius_x": 420.0, "radius_y": 10.0}
    grid = {"half_length": [4.552, 4.625], "elements": [95, 37]}
    groove = ts.Scene(
        body={"A": ball, "B": steel | {"radius_x": INF, "radius_y": -10.25}},
        load={"normal": 1e4, "force_x": 0.0},
        friction={"mu": 0.3},
        conformal={},
        grid=grid,
    )
    contact = ts.solve(
        groove,
        laws=flat.replace(
            friction=ts.Coulomb(mu=(0.3, 0.3)), elasticity=HalfSpaces(**groove.materials)
        ),
    )
    assert contact.p_max == pytest.approx(530.2, rel=1e-3)  # another rule for the edge
    assert pytest.approx(9915.0, rel=5e-4) == contact.P
    assert contact.xi_x == pytest.approx(-2.301e-4, rel=1e-2)
    assert np.count_nonzero(contact.touching) == 1187


BAD = {
    "body.B.radius_y": ({"body.B.radius_y": 20.0}, "radius_y"),
    "gap": ({"gap": {"y": [-1.0, 0.0, 1.0], "separation": [0.0, 0.0, 0.0]}}, "gap"),
    "subsurface": ({"subsurface": {"depth": 1.0}}, "subsurface"),
    "fatigue": ({"fatigue": {"shear_yield": 300.0}}, "fatigue"),
    "transient": (
        {"transient": {"distance": [0.0, 1.0], "load": {"normal": [1.0, 2.0]}}},
        "transient",
    ),
    "force_y": ({"load.force_y": 1.0, "creepage": None}, r"load\.force_y"),
    "pressure": ({"load.pressure": 1000.0}, r"load\.pressure"),
    "layer": (
        {"body.A.layer": [{"thickness": 0.1, "young": 1e5, "poisson": 0.3}]},
        r"body\.A",
    ),
    "stiffness": (
        {
            "body.A": {
                "radius_x": 5.0,
                "radius_y": 5.0,
                "stiffness": {"C11": 165e3, "C12": 31e3, "C13": 50e3, "C33": 62e3, "C44": 40e3},
            }
        },
        r"body\.A",
    ),
    "angle": ({"conformal.angle": 90.0}, r"conformal\.angle"),
    "unknown": ({"conformal.clearance": 0.2}, r"conformal\.clearance"),
    "half length": ({"grid.half_length": [0.3, 16.0]}, r"grid\.half_length"),
    "load": ({"load.normal": 3e5}, r"load\.normal"),
    "shift": ({"duty": [{"revolutions": 1, "shift_y": 0.1}]}, r"shift_y"),
    "residual": ({"residual": {"A": {"depth": [0, 1], "xx": [0, 0]}}}, "residual"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name):
    change, key = BAD[name]
    with pytest.raises(ts.SceneError, match=key):
        GROOVE.replace(**change)


def test_bad_input_of_a_bore():
    scene = bore(20.0, 0.1, 51)
    with pytest.raises(ts.SceneError, match="friction"):
        scene.replace(friction={"mu": 0.1})
    with pytest.raises(ts.SceneError, match=r"conformal\.angle"):
        scene.replace(**{"conformal.angle": 10.0})
    with pytest.raises(ts.SceneError, match=r"radius_x"):
        scene.replace(**{"body.B.radius_x": 20.0})


def test_what_a_curved_patch_does_not_have():
    contact = ts.solve(GROOVE)
    with pytest.raises(ValueError, match="stress in body A"):
        ts.stress_maximum(contact, "A")
    with pytest.raises(ValueError, match="jacobian"):
        ts.solve(GROOVE, jacobian=True)
    with pytest.raises(ts.SceneError, match="conformal"):
        ts.compare_levels(GROOVE)
    with pytest.raises(ts.TableError, match="conformal"):
        ts.TableDesign(scene=GROOVE)


def test_notes_explanation_and_figure():
    with warnings.catch_warnings():
        warnings.simplefilter("error", PlausibilityWarning)
        GROOVE.replace(**{"load.normal": 2500.0})
    text = str(ts.explain(GROOVE))
    for part in (
        "curved patch",
        "R = 5.1 mm; B is concave",
        "Heathcote",
        "of a convex and a concave body",
    ):
        assert part in text
    figure = render(plot.conformal_patch(ts.solve(GROOVE)))
    assert figure is not None
    render(plot.conformal_patch(ts.solve(bore(30.0, 0.25, 51))))


def test_wear_resumes(tmp_path):
    wear = {"coefficient": 1e-3, "revolutions": 4, "save": [2, 4], "turns": "each"}
    scene = GROOVE.replace(wear=wear, **{"grid.elements": [9, 15]})
    complete, path = ts.roll(scene), tmp_path / "groove.h5"
    ts.roll(scene.replace(**{"wear.revolutions": 2, "wear.save": [2]}), path)
    resumed = ts.roll(scene, path, resume=True)
    for name in ("p_max", "approach", "Fz", "wear_max"):
        np.testing.assert_array_equal(resumed[name], complete[name])
    assert complete["Fz"] == pytest.approx(2000.0, rel=1e-5)  # the tolerance of wear
    assert complete["wear_max"][-1] > 0.0


def test_study_of_the_clearance():
    base = GROOVE.replace(**{"friction": None, "creepage": None, "grid.elements": [9, 15]})
    design = {"scene": base.entries(), "axis": [{"key": "body.B.radius_y", "values": [-5.4, -5.1]}]}
    wide, tight = (ts.solve(case.scene) for case in cases(ts.Study(**design)))
    assert tight.half_width_y > wide.half_width_y


@pytest.mark.parametrize("component", ["zz", "yy", "xx", "yz"])
def test_loads_along_the_cylinder_have_the_waves_of_the_plane(component):
    """The sum of the coefficients along x is the displacement by a strip, wave by wave."""
    law, count = ts.ConformalBodies(UNIT, Material(2.0, 0.25), 1.0), 64
    dy = 2.0 * np.pi / count
    table = law.coefficients(component, (120, count // 2 + 1), 0.5, dy)
    strip = 2.0 * table.sum(axis=0) - table[0]
    parity = -1.0 if component == "yz" else 1.0
    around = np.concatenate((strip, parity * strip[-2:0:-1]))
    waves = np.fft.rfft(around)[2:8] / count
    n, k = (
        np.arange(2, 2000),
        np.array([1e-3]),
    )  # finite, as the fields of the plane are not independent
    exact = law.spectrum(n, k)[component][:, 0] * dy / (2.0 * np.pi) * np.sinc(0.5 * dy * n / np.pi)
    # The waves that the samples do not distinguish: n + 64 m, and -n + 64 m.
    folded = np.zeros(6)
    for m in range(30):
        folded += exact[64 * m : 64 * m + 6]
        folded += parity * exact[64 * m + 60 - np.arange(6)] if m < 29 else 0.0
    found = waves.imag if component == "yz" else waves.real
    # Waves shorter than an element, which fold into these, are those of half-spaces.
    assert found == pytest.approx(folded, abs=2e-3 * np.abs(folded).max())
