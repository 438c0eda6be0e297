from dataclasses import replace

import numpy as np
import pytest
import scipy

from tractive_sam import plot
from tractive_sam.rail import ContactLocus, Profile, Wheel, find_contact_points, find_locus


@pytest.fixture(scope="module")
def locus(wheel, rail):
    return find_locus(wheel, rail, np.linspace(-4.0, 4.0, 21))


def of_difference(y, difference, radius=460.0, distance=1500.0):
    """A locus with a given rolling radius difference."""
    shape = np.zeros((2, y.size))
    at = radius + 0.5 * np.array([difference, -difference])
    none = y.astype(bool)
    points = np.zeros((2, y.size, 3))
    return ContactLocus(
        y, 0 * y, points, points[..., :2], points[..., :2], shape, at, none, radius, distance
    )


@pytest.mark.slow
def test_locus_is_antisymmetric(locus):
    assert np.abs(locus.radius_difference + locus.radius_difference[::-1]).max() < 1e-9
    assert np.abs(locus.roll + locus.roll[::-1]).max() < 1e-11
    assert np.abs(locus.angle[0] - locus.angle[1][::-1]).max() < 1e-9


def test_locus_does_not_depend_on_neighbours(locus, wheel, rail):
    one = find_locus(wheel, rail, [locus.y[15]])
    assert one.radius[0, 0] == pytest.approx(locus.radius[0, 15], abs=1e-9)


def test_contact_points_of_a_locus_are_on_both_profiles(locus, wheel, rail):
    placed = replace(wheel, y=locus.y[15], roll=locus.roll[15])
    assert find_contact_points(placed, rail).points[0, 1] == pytest.approx(locus.points[0, 15, 1])
    assert np.allclose(locus.rail[0, :, 0], locus.points[0, :, 1], atol=1e-9)


def test_conicity_of_s1002_on_uic60(locus):
    # 0.182 is the value without roll, which raises conicities by 2 to 3 %.
    assert 0.182 <= locus.conicity(3.0) <= 0.188
    assert 0.182 <= locus.klingel_conicity(3.0) <= 0.188


@pytest.mark.parametrize("amplitude", [1.0, 3.0, 7.9])
def test_a_cone_has_its_conicity_at_any_amplitude(amplitude):
    y = np.linspace(-8.0, 8.0, 33)
    cone = of_difference(y, 2.0 * 0.05 * y)
    assert cone.conicity(amplitude) == pytest.approx(0.05, rel=1e-9)
    assert cone.klingel_conicity(amplitude) == pytest.approx(0.05, rel=1e-6)  # quadrature


@pytest.mark.parametrize("rail_radius", [80.0, 300.0])
def test_roll_raises_the_conicity_of_a_cone_as_in_closed_form(rail_radius):
    """Cones on arcs of radius R, contact points 2b apart: (b + R tan)/(b - r tan) times the cone.

    Wickens, Fundamentals of Rail Vehicle Dynamics (2003), without curvature of the wheel.
    """
    cone, half, y = 0.025, 750.0, np.linspace(-30.0, 30.0, 61)
    tread = Profile.from_nodes(np.stack((y, -cone * y), 1), np.tile([1.0, -cone], (61, 1)))
    angle = np.linspace(-0.1, 0.1, 41) - np.arctan(cone)
    arc = rail_radius * np.stack((np.sin(angle), -np.cos(angle)), axis=1)
    tangents = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    rail = Profile.from_nodes(arc - arc[20] + [half, 0.0], tangents)
    positions, wheel = [-3.0, -1.5, 0.0, 1.5, 3.0], Wheel(tread, 460.0, 1360.0)
    without = find_locus(wheel, rail, positions, 0.0)
    assert without.klingel_conicity(3.0) == pytest.approx(cone, rel=1e-9)
    factor = (half + rail_radius * cone) / (half - 460.0 * cone)
    # The closed form is of first order in the angles: terms of the cone squared remain.
    assert find_locus(wheel, rail, positions).klingel_conicity(3.0) == pytest.approx(
        factor * cone, rel=1e-2 * cone**2 + 1e-5
    )


def test_cylinders_have_no_conicity():
    """As wheels whose difference is zero between two flanges, up to rounding."""
    y = np.linspace(-3.0, 3.0, 61)
    flanges = of_difference(y, np.sign(y) * (np.abs(y) > 1.75) + 1e-13 * np.cos(9.0 * y))
    assert flanges.klingel_conicity(1.7) == 0.0
    assert flanges.klingel_conicity(2.5) > 0.1
    assert of_difference(y, 0.0 * y).klingel_conicity(2.0) == 0.0


def test_a_difference_next_to_a_jump_has_a_reason():
    """A cone with a step of the difference at 1.55 mm, against reference values with a shift."""
    y = np.sort(np.append(np.linspace(-3.0, 3.0, 61), [-1.55, -1.55 - 1e-5, 1.55, 1.55 + 1e-5]))
    locus = of_difference(y, 0.05 * y + 2.0 * np.sign(y) * (np.abs(y) > 1.55))
    locus = replace(locus, jumps=np.diff(y, prepend=-9.0) < 1e-4)
    amplitudes, shifted = np.array([1.0, 1.6, 2.5, 4.0]), [0.025, locus.klingel_conicity(1.69), 0.9]
    check = locus.check_conicity("a", "b", amplitudes[:3], shifted, np.full(3, 1e-3))
    assert check.agrees.tolist() == [True, False, False]
    assert check.differs.tolist() == [False, False, True]
    assert "jumps at |y| = 1.550 mm" in check.reasons[1]
    assert locus.check_conicity("a", "b", amplitudes[3:], [0.1], [1.0]).amplitude.size == 0


def test_conicities_of_a_cubic_difference():
    """For 2 c y^3 the harmonic conicity is 3/4 c A^2, by Klingel's motion 0.7178 c A^2."""
    y = np.linspace(-5.0, 5.0, 2001)
    cubic = of_difference(y, 2.0 * 0.01 * y**3)
    assert cubic.conicity(4.0) == pytest.approx(0.75 * 0.01 * 16.0, rel=1e-4)
    quarter = scipy.special.gamma(0.25) ** 2 / (4.0 * np.sqrt(np.pi))  # of y'' = -y^3, A = 1
    exact = 0.5 * 2.0 * 0.01 * 16.0 * (0.5 * np.pi / quarter) ** 2
    assert cubic.klingel_conicity(4.0) == pytest.approx(exact, rel=1e-4)


def test_klingel_conicity_is_that_of_the_integrated_motion():
    """Against the wavelength of the ordinary differential equation, with a skewed difference."""
    y = np.linspace(-6.0, 6.0, 4001)
    skew = of_difference(y, 0.2 * y + 0.02 * y**2 + 0.004 * y**3)
    distance, radius = 1500.0, 460.0

    def motion(_x, state):
        difference = np.interp(state[0], y, skew.radius_difference)
        return state[1], -difference / (distance * radius)

    def crest(_x, state):
        return state[1]

    start, tolerance = skew.extremes(3.0)[0], {"rtol": 1e-10, "atol": 1e-14}
    found = scipy.integrate.solve_ivp(
        motion, (0.0, 3e4), (start, 0.0), events=crest, max_step=20.0, **tolerance
    )
    half = np.diff([x for x in found.t_events[0] if x > 1.0])[0]
    exact = distance * radius / 2.0 * (np.pi / half) ** 2
    assert skew.klingel_conicity(3.0) == pytest.approx(exact, rel=1e-4)


def test_a_motion_that_is_nearly_around_zero_is_found():
    """The even part of the difference has no integral from -3 to 3 mm, and a small one beyond."""
    y = np.linspace(-6.0, 6.0, 4001)
    skew = of_difference(y, 0.2 * y + 0.02 * (y**2 - 3.0) + 0.004 * y**3)
    exact, near = skew.klingel_conicity(3.0), skew.klingel_conicity(3.0 + 1.5e-5)
    assert near == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("amplitude", [0.0, -1.0, 4.1, np.nan])
def test_amplitudes_beyond_the_locus_are_refused(locus, amplitude):
    with pytest.raises(ValueError, match="amplitude"):
        locus.conicity(amplitude)
    with pytest.raises(ValueError, match="amplitude"):
        locus.klingel_conicity(amplitude)


def test_a_difference_without_restoring_does_not_return():
    y = np.linspace(-5.0, 5.0, 101)
    with pytest.raises(ValueError, match="amplitude 3 mm"):
        of_difference(y, -0.1 * y).klingel_conicity(3.0)


@pytest.mark.slow
def test_jumps_of_the_contact_are_marked(wheel, rail):
    locus = find_locus(wheel, rail, np.arange(4.0, 6.01, 0.1))
    assert locus.jumps.any()
    assert not locus.jumps.all()


def test_the_error_bar_holds_the_error_of_the_conicity():
    """Linear interpolation of a cubic with a step, against 2001 positions."""

    def found(number):
        y = np.sort(np.append(np.linspace(-5.0, 5.0, number), [-0.7 - 1e-4, 0.7 + 1e-4]))
        locus = of_difference(y, 0.02 * y**3 + 0.3 * np.sign(y) * (np.abs(y) > 0.7))
        return replace(locus, jumps=np.diff(y, prepend=-9.0) < 1e-3)

    exact, coarse = found(2001).conicity(3.0), found(21)
    assert 0.0 < abs(coarse.conicity(3.0) - exact) < coarse.conicity_error(3.0) < 0.1 * exact
    with pytest.warns(UserWarning, match="not resolved"):
        error = abs(coarse.conicity(0.3) - found(2001).conicity(0.3))
    assert error < coarse.conicity_error(0.3)  # no position of the coarse locus is within 0.3 mm


def test_jumps_are_located_between_positions(wheel, rail):
    """The conicity of small motions hardly depends on the number of positions."""
    coarse, fine = (find_locus(wheel, rail, np.linspace(-1.2, 1.2, n)) for n in (7, 13))
    assert coarse.jumps.sum() == 2
    # The jump of the radius difference, 0.4 mm, is located to 1e-4 mm.
    error = coarse.conicity_error(1.0) + 1e-4
    assert coarse.conicity(1.0) == pytest.approx(fine.conicity(1.0), abs=error)


def test_columns_are_complete(locus):
    columns = locus.columns()
    assert len(columns) == 12
    assert {array.shape for array in columns.values()} == {locus.y.shape}


@pytest.mark.slow
def test_fast_movements_are_no_jumps(wheel, rail):
    """The contact moves through the root by up to 30 times the displacement, and jumps once."""
    positions = np.arange(6.15, 6.41, 0.05)
    locus = find_locus(wheel, rail, positions)
    moved = np.abs(np.diff(locus.wheel[0, :, 0]))
    assert (moved > 0.4).sum() >= 3
    (jump,) = np.flatnonzero(locus.jumps)
    assert 6.25 < locus.y[jump - 1] < locus.y[jump] < 6.3
    assert locus.y[jump] - locus.y[jump - 1] < 1e-4  # mm, after twelve halvings


def test_hollow_wheels_have_a_curve_of_conicity_with_gaps():
    """The middle of a difference -y + y^3/2 repels, and no motion passes it below y = 2."""
    y = np.linspace(-3.0, 3.0, 601)
    hollow = of_difference(y, 0.02 * (-y + 0.5 * y**3))
    assert hollow.conicity(1.0) < 0.0 < hollow.conicity(2.5)
    with pytest.raises(ValueError, match="amplitude"):
        hollow.klingel_conicity(1.0)
    axes = plot.conicity(hollow).axes[0]
    (harmonic, klingel, *_) = axes.lines
    amplitudes, values = harmonic.get_data()
    assert axes.get_ylim()[0] < values.min() < 0.0
    # The potential -y^2/2 + y^4/8 of the middle is exceeded from an amplitude of 2 on.
    finite, inside = np.isfinite(klingel.get_ydata()), np.abs(amplitudes - 2.0) > 0.01
    np.testing.assert_array_equal(finite[inside], amplitudes[inside] > 2.0)


def test_a_motion_that_leaves_the_positions_is_cured_by_a_larger_reach():
    y = np.linspace(-6.0, 6.0, 121)
    aside = of_difference(y, 0.1 * (y - 2.0))
    assert aside.klingel_conicity(3.0) == pytest.approx(0.05, rel=1e-6)
    with pytest.raises(ValueError, match="larger reach"):
        aside.klingel_conicity(5.0)
