from itertools import pairwise

import numpy as np
import pytest
import scipy

import tractive_sam as ts
from tractive_sam.rail import BUILTIN, Profile, builtin_profile, place_rail
from tractive_sam.rail.builtin import s1002_pieces


def circle(radius=13.0, number=200):
    angles = np.linspace(-1.2, 1.2, number)
    centre = np.array([0.0, radius])
    points = centre + radius * np.stack((np.sin(angles), -np.cos(angles)), axis=1)
    return Profile.from_pieces([(points, np.stack((np.cos(angles), np.sin(angles)), axis=1))])


def test_s1002_joints_are_those_of_the_published_coefficients():
    pieces = s1002_pieces()
    jumps = [float(b[0][0, 1] - a[0][-1, 1]) for a, b in pairwise(pieces)]
    assert abs(jumps[4]) == pytest.approx(1.2e-4, rel=0.02)  # published with two digits
    assert jumps[5] == pytest.approx(3.7e-5, rel=0.02)
    assert np.abs(jumps[:4] + jumps[6:]).max() < 1e-7  # rounded coefficients


def test_s1002_is_continuous_and_close_to_its_pieces():
    wheel = builtin_profile("S1002")
    for points, _ in s1002_pieces():
        inside = points[(points[:, 0] > -69.9)]
        # The pieces towards the flange are moved by the two gaps at the joints.
        assert np.abs(wheel.height(inside[:, 0]) - inside[:, 1]).max() < 9e-5
    assert float(wheel.height(-55.0)) == pytest.approx(28.0, abs=9e-5)  # flange height
    assert float(wheel.height(0.0)) == pytest.approx(0.0, abs=1e-9)  # tread datum


@pytest.mark.parametrize(
    ("y", "radius"), [(-36.0, 13.0), (-45.0, -20.0), (-55.0, -12.0), (-66.0, -20.5), (50.0, np.inf)]
)
def test_s1002_has_the_radii_of_its_arcs(y, radius):
    wheel = builtin_profile("S1002")
    # Second derivatives of a cubic between nodes 0.1 mm apart: 1e-5 of them.
    found = float(wheel.curvature(wheel.locate(y)))
    assert found == pytest.approx(1.0 / radius, rel=2e-5, abs=1e-9)


@pytest.mark.parametrize(("name", "first", "second"), [("60E1", 10.228, 26.0265)])
def test_rail_head_is_a_chain_of_tangent_arcs(name, first, second):
    rail = builtin_profile(name)
    for y, radius in ((5.0, 300.0), (18.0, 80.0), (30.0, 13.0)):
        for side in (-1.0, 1.0):
            found = float(rail.curvature(rail.locate(side * y)))
            assert found == pytest.approx(1.0 / radius, rel=2e-5)
    flank = rail.at(rail.s[-1], 1)
    assert flank[1] / flank[0] == pytest.approx(20.0, rel=1e-9)
    # Heights of the two changes of radius, from the chain of chords.
    angle = np.arcsin(first / 300.0)
    assert float(rail.height(first)) == pytest.approx(300.0 * (1 - np.cos(angle)), abs=1e-9)
    centre = first - 80.0 * np.sin(angle)
    change = 80.0 * (np.cos(angle) - np.cos(np.arcsin((second - centre) / 80.0)))
    known = 300.0 * (1 - np.cos(angle)) + change
    assert float(rail.height(second)) == pytest.approx(known, abs=1e-9)


def test_60e1_has_its_published_width():
    rail = builtin_profile("60E1")
    depth = scipy.optimize.brentq(
        lambda s: rail.at(s)[1] - 14.3, 0.5 * rail.s[-1], rail.s[-1], xtol=1e-12
    )
    assert rail.at(depth)[0] == pytest.approx(36.0, abs=5e-4)  # 72 mm at a depth of 14.3 mm


def test_unknown_profile_is_reported_with_what_is_there():
    with pytest.raises(ValueError, match="60E1"):
        builtin_profile("60E9")


def test_arc_length_and_curvature_of_a_circle():
    arc = circle()
    assert arc.s[-1] == pytest.approx(2.4 * 13.0, rel=1e-12)
    errors = []
    for number in (50, 100):
        one = circle(number=number)
        s = np.linspace(one.s[0], one.s[-1], 777)
        off = np.hypot(*(one.at(s) - np.array([0.0, 13.0])).T) - 13.0
        errors.append(np.abs(off).max())
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)  # fourth order


def test_a_turn_and_its_inverse_restore_a_profile():
    wheel = builtin_profile("S1002")
    turned = wheel.moved(0.3, (0.0, 0.0))
    assert np.allclose(turned.angle(turned.s) - wheel.angle(wheel.s), 0.3, atol=1e-12)
    assert np.abs(turned.moved(-0.3, (0.0, 0.0)).points - wheel.points).max() < 1e-12


def test_wear_of_a_circle_is_a_smaller_circle():
    arc = circle()
    worn = arc.worn(np.full(arc.s.size, 0.5), outward=-1.0)  # a rail: its centre is below
    assert np.allclose(np.hypot(*(worn.points - [0.0, 13.0]).T), 12.5, atol=1e-12)
    s = np.linspace(1.0, worn.s[-1] - 1.0, 100)
    assert np.allclose(worn.curvature(s), 1.0 / 12.5, rtol=1e-4)  # nodes 0.15 mm apart


@pytest.mark.parametrize("name", [name for name in BUILTIN if name != "S1002"])
@pytest.mark.parametrize("inclination", [20.0, 40.0, np.inf])
def test_placed_rail_keeps_the_gauge_and_its_top(name, inclination):
    rail = place_rail(builtin_profile(name), inclination, 1435.0)
    s = np.linspace(rail.s[0], rail.s[-1], 20001)
    points = rail.at(s)
    assert points[:, 1].min() == pytest.approx(0.0, abs=1e-6)  # sampled every 6 um of arc length
    face = points[(points[:, 1] <= 14.0) & (points[:, 0] < points[:, 0].mean()), 0].min()
    assert face == pytest.approx(717.5, abs=1e-3)  # the flank falls 6 um between samples
    top = rail.at(rail.locate(float(points[np.argmin(points[:, 1]), 0])), 1)
    assert abs(top[1]) < 1e-4


def test_a_rail_that_ends_above_the_gauge_depth_is_refused():
    full = builtin_profile("60E1")
    inner = slice(300, -300)
    part = Profile(full.s[inner], full.points[inner], full.tangents[inner])
    with pytest.raises(ValueError, match="14"):
        place_rail(part, 40.0, 1435.0)


FACTORS = (0.1, 0.3, -0.05)


def test_grinding_removes_the_sum_of_its_splines():
    """A spline has its width as its area, and 2/3 as its largest value."""
    rail = builtin_profile("60E1")
    ground = rail.ground(-12.0, 12.0, FACTORS, -1.0)
    y, width = np.linspace(-20.0, 20.0, 4001), 24.0 / (len(FACTORS) + 3)
    depth = ground.height(y) - rail.height(y)
    # Along the normals: the profile is flat to 3 degrees there.
    assert depth.sum() * 0.01 == pytest.approx(sum(FACTORS) * width, rel=5e-3)
    # Akima's interpolant of the depth ends between nodes.
    assert np.abs(depth[np.abs(y) > 12.0]).max() < 1e-7
    single = rail.ground(-12.0, 12.0, (0.3,), -1.0).height([0.0]) - rail.height([0.0])
    assert single == pytest.approx(0.2, rel=1e-3)
    same = rail.ground(-12.0, 12.0, (0.0, 0.0), -1.0)
    np.testing.assert_allclose(same.height(y), rail.height(y), atol=1e-12)


@pytest.mark.parametrize(
    ("ground", "key"),
    [
        ({"start": 5.0, "end": -5.0, "depths": [0.1]}, "rail.profile"),
        ({"start": -500.0, "end": -5.0, "depths": [0.1]}, "rail.profile"),
        ({"start": -5.0, "end": 5.0, "depths": []}, "rail.ground.depths"),
        ({"start": -5.0, "end": 5.0, "depths": ["deep"]}, "rail.ground.depths"),
        ({"start": -5.0, "depths": [0.1]}, "rail.ground.end"),
    ],
)
def test_wrong_grinding_has_a_fault(ground, key):
    scene = ts.Scene.builtin("wheel-rail")
    with pytest.raises(ts.SceneError, match=key.replace(".", r"\.")):
        scene.replace(**{"rail.ground": ground})


@pytest.mark.slow
def test_a_design_grinds_a_rail_for_less_pressure():
    zero = {"start": -30.0, "end": 0.0, "depths": [0.0]}
    scene = ts.Scene.builtin("wheel-rail").replace(subsurface=None, **{"rail.ground": zero})
    free = [{"key": "rail.ground.depths[0]", "lower": 0.0, "upper": 0.2}]
    table = {"scene": scene, "minimise": "p_max", "free": free, "mesh_check": False}
    found = ts.design(table | {"tolerance": 5e-2})
    best = scene.replace(**found.values)
    assert 0.0 < found.values["rail.ground.depths[0]"] < 0.2
    assert ts.solve(best).p_max < 0.9 * ts.solve(scene).p_max
