from dataclasses import replace

import numpy as np
import pytest

from tractive_sam.rail import (
    NoContactError,
    Profile,
    Wheel,
    builtin_profile,
    find_contact_points,
    find_patches,
    free_roll,
    lowest_gap,
    place_rail,
)

E_STAR = 82e3 / (1.0 - 0.28)


def surface_points(wheel, s, around):
    """Points of the wheel at arc lengths and angles around the axle, in the track frame."""
    local = wheel.profile.at(s)
    radius = wheel.radius + local[:, 1]
    lateral = np.broadcast_to((wheel.datum + local[:, 0])[:, None], (s.size, around.size))
    q = np.stack((radius[:, None] * np.sin(around), lateral, radius[:, None] * np.cos(around)), -1)
    return q @ wheel.turn.T + wheel.centre


@pytest.mark.parametrize("yaw", [0.0, 0.02])
def test_silhouette_has_normals_across_the_rail(wheel, yaw):
    """By differences along both directions of the surface of revolution."""
    turned = replace(wheel, yaw=yaw, roll=0.003, y=2.0)
    places = turned.profile.s[400:1100:50]  # flange root and tread
    for s, point, angle in zip(places, *turned.silhouette(places), strict=True):
        q = turned.turn.T @ (point - turned.centre)
        around, step = np.arctan2(q[0], q[2]), 1e-5
        patch = surface_points(
            turned, s + step * np.arange(-1, 2), around + step * np.arange(-1, 2)
        )
        assert patch[1, 1] == pytest.approx(point, abs=1e-9)
        normal = np.cross(patch[2, 1] - patch[0, 1], patch[1, 2] - patch[1, 0])
        normal /= np.linalg.norm(normal)
        assert normal[0] == pytest.approx(0.0, abs=1e-6)  # differences of 1e-5 of 460 mm
        assert np.arctan(-normal[1] / normal[2]) == pytest.approx(angle, abs=1e-6)


def test_contact_point_has_equal_angles_and_the_least_distance(wheel, rail):
    placed = replace(wheel, y=2.0, yaw=0.004)
    found = find_contact_points(placed, rail)
    assert found.angles[0, 0] == pytest.approx(found.angles[1, 0], abs=1e-9)
    s = found.s[0] + np.linspace(-1.0, 1.0, 2001)
    points, _ = placed.silhouette(s)
    gap = rail.height(points[:, 1]) - points[:, 2]
    assert gap.min() >= found.gap[0] - 1e-12


def test_a_wheelset_in_the_middle_is_symmetric(wheel, rail):
    assert free_roll(wheel, rail) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("y", [0.7, 3.0, 5.5])
def test_mirrored_positions_have_mirrored_contacts(wheel, rail, y):
    one, other = replace(wheel, y=y, yaw=0.005), replace(wheel, y=-y, yaw=-0.005)
    roll = free_roll(one, rail)
    assert free_roll(other, rail) == pytest.approx(-roll, abs=1e-12)
    left = replace(other, roll=-roll).mirrored()
    assert find_contact_points(left, rail).s[0] == pytest.approx(
        find_contact_points(replace(one, roll=roll), rail).s[0], abs=1e-9
    )


def test_both_wheels_rest_on_the_rails(wheel, rail):
    placed = replace(wheel, y=4.0)
    placed = replace(placed, roll=free_roll(placed, rail))
    assert lowest_gap(placed, rail) == pytest.approx(lowest_gap(placed.mirrored(), rail), abs=1e-10)


def test_patch_is_in_the_tangent_plane_of_a_cone_on_a_cylinder():
    """A conical wheel touches a rail of one radius at equal angles."""
    y = np.linspace(-40.0, 40.0, 801)
    cone = np.stack((y, -y / 20.0), axis=1)
    tangents = np.tile(np.array([1.0, -1.0 / 20.0]) / np.hypot(1.0, 0.05), (801, 1))
    steep = np.array([1.0, -28.0]) / np.hypot(1.0, 28.0)
    flange = np.array([[-41.0, 30.0], [-40.0, 2.0]]), np.stack((steep, steep))
    profile = Profile.from_pieces([flange, (cone, tangents)])
    angles = np.linspace(-0.1, 0.1, 801)
    arc = np.stack((300.0 * np.sin(angles), 300.0 * (1 - np.cos(angles))), axis=1)
    rail = Profile.from_pieces([(arc, np.stack((np.cos(angles), np.sin(angles)), axis=1))])
    placed = rail.moved(0.0, (750.0, 0.0))
    (patch,) = find_patches(Wheel(profile, 460.0, 1360.0), placed, 1e4, E_STAR)
    angle = -np.arctan(0.05)
    assert patch.angle == pytest.approx(angle, abs=2e-5)  # the wheel's angle and half the rail's
    assert patch.origin[1] == pytest.approx(750.0 + 300.0 * np.sin(angle), abs=0.02)
    radius = 460.0 - 0.05 * 300.0 * np.sin(angle)
    assert patch.rolling_radius == pytest.approx(radius, abs=1e-3)
    v = np.linspace(-5.0, 5.0, 21)
    expected = 300.0 * (1.0 - np.cos(np.arcsin(v / 300.0 + np.sin(patch.angle - angle))))
    found = patch.gap(np.zeros(1), v)[0]
    assert np.abs(found - found.min() - expected + expected.min()).max() < 2e-4
    x = np.linspace(-6.0, 6.0, 5)
    height = patch.gap(x, np.zeros(1))[:, 0]
    # A cone cut by the plane through x and its normal; the next term is of the order tan^2.
    assert height - height[2] == pytest.approx(x**2 / (2.0 * patch.radius_x), rel=1e-4, abs=1e-12)


def test_heights_over_the_plane_are_on_the_wheel(wheel, rail):
    placed = replace(wheel, y=5.5, yaw=0.0132, roll=-4.8e-4)
    patch = find_patches(placed, rail, 1e4, E_STAR)[0].lowered(0.0)
    x, y = np.linspace(-4.0, 4.0, 7), np.linspace(-1.0, 1.0, 5)
    height, s = patch.wheel_at(x[:, None], y[None, :])
    for k, j in ((0, 0), (3, 2), (6, 4)):
        point = patch.origin + np.array([x[k], 0, 0]) + y[j] * patch.lateral
        q = patch.wheel.turn.T @ (point + height[k, j] * patch.normal - patch.wheel.centre)
        local = placed.profile.at(s[k, j])
        assert np.hypot(q[0], q[2]) == pytest.approx(460.0 + local[1], abs=1e-9)
        assert q[1] == pytest.approx(placed.datum + local[0], abs=1e-9)


def test_overlap_of_a_lowered_wheel_hardly_depends_on_the_plane(wheel, rail):
    """In a plane that is not tangent, the wheel also moves along the plane."""
    placed = replace(wheel, y=8.0, yaw=0.0192, roll=-8.606e-3)
    patch = find_patches(placed, rail, 1e4, E_STAR)[0]
    tilted = replace(patch, angle=patch.angle + 0.1)
    overlap = -patch.lowered(0.05).opening
    assert overlap == pytest.approx(0.05 * np.cos(patch.angle), rel=0.02)  # curvature of the wheel
    assert -tilted.lowered(0.05).opening == pytest.approx(overlap, rel=0.02)


def test_rigid_slip_is_creepage_and_spin_in_a_plane(wheel, rail):
    placed = replace(wheel, y=5.5, yaw=0.0132, roll=-4.8e-4)
    patch = find_patches(placed, rail, 1e4, E_STAR)[0]
    longitudinal, lateral, spin = patch.creepages(0.001)
    x, y = np.linspace(-4.0, 4.0, 7), np.linspace(-1.0, 1.0, 5)
    slip = patch.rigid_slip(x, y, 0.001)
    height = patch.rail_at(np.zeros(1), y)[0]
    # Out of the plane the rolling radius differs by the height.
    expected = longitudinal - spin * y + height * np.cos(patch.angle) * 1.001 / 460.0
    assert np.abs(slip[0] - expected).max() < 2e-6  # roll and yaw: 5e-4 and 1e-4 of it
    assert np.abs(slip[1] - lateral - spin * x[:, None]).max() < 2e-5
    assert lateral == pytest.approx(-0.0132 / np.cos(patch.angle), rel=0.02)


def test_two_point_contact_has_two_patches(wheel, rail):
    placed = replace(wheel, y=5.0, yaw=0.012, roll=-3.554e-4)
    patches = find_patches(placed, rail, 1e4, E_STAR)
    assert len(patches) == 2
    assert patches[0].angle < -0.25 < patches[1].angle < 0.0


@pytest.mark.slow
def test_position_sweep_has_no_jumps(wheel, rail):
    """Over 0.05 mm the centre of a patch moves little, unless another patch appears."""
    origins, numbers = [], []
    for y in np.arange(0.0, 4.0, 0.05):
        patches = find_patches(replace(wheel, y=y), rail, 1e4, E_STAR)
        origins.append(patches[0].origin[1])
        numbers.append(len(patches))
    steady = np.diff(numbers) == 0
    assert np.abs(np.diff(origins))[steady].max() < 1.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"y": 300.0}, "does not meet"),
        ({"y": 25.0}, "derailed"),
        ({"inner": 1410.0, "y": 4.0}, "derailed"),
        ({"y": -70.0}, "end"),
    ],
)
def test_positions_without_contact_are_reported(wheel, rail, change, message):
    with pytest.raises(NoContactError, match=message):
        lowest_gap(replace(wheel, **change), rail)


def test_a_load_that_no_rail_carries_is_reported(wheel, rail):
    with pytest.raises(NoContactError, match=r"1e\+09 N"):
        find_patches(wheel, rail, 1e9, E_STAR)


def test_60e1_at_1_20_touches_farther_outside(wheel, rail):
    steep = place_rail(builtin_profile("60E1"), 20.0, 1435.0)
    assert (
        find_contact_points(wheel, steep).points[0, 1]
        > find_contact_points(wheel, rail).points[0, 1]
    )
