import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import ellipe, ellipkm1

from tractive_sam.mechanics.elasticity import Material, combine
from tractive_sam.mechanics.hertz_contact import combined_radius, hertz, hertz_line

ASPECTS = [1e-4, 0.01, 0.3, 0.999999, 1.0, 1.000001, 7.0, 100.0, 1e4]
SCALES = st.floats(1e-3, 1e3)


def test_pressure_carries_the_load():
    contact = hertz(1.3, 10.0, 40.0, load=2.0)
    x = np.linspace(-contact.a, contact.a, 801)
    y = np.linspace(-contact.b, contact.b, 801)
    pressure = contact.pressure(x[:, None], y)
    total = pressure.sum() * (x[1] - x[0]) * (y[1] - y[0])
    # the rule sees the square-root edge to the power 3/2 of its step
    assert total == pytest.approx(contact.load, rel=1e-4)
    assert pressure.max() == pytest.approx(contact.p0)
    assert contact.mean_pressure == pytest.approx(2 / 3 * contact.p0)


def test_no_pressure_outside():
    contact = hertz(1.0, 1.0, 2.0, load=1.0)
    assert contact.pressure(1.01 * contact.a, 0.0) == 0
    assert contact.pressure(0.8 * contact.a, 0.8 * contact.b) == 0


def test_circle():
    e_star, radius, load = 3.0, 5.0, 0.7
    contact = hertz(e_star, radius, radius, load=load)
    assert contact.a == pytest.approx((3 * load * radius / (4 * e_star)) ** (1 / 3), rel=1e-15)
    assert contact.b == contact.a
    assert contact.approach == pytest.approx(contact.a**2 / radius, rel=1e-15)
    assert contact.p0 == pytest.approx(2 * e_star * contact.a / (math.pi * radius), rel=1e-15)


@pytest.mark.parametrize("aspect", ASPECTS)
def test_swapping_the_axes(aspect):
    one, other = hertz(1.0, aspect, 1.0, load=1.0), hertz(1.0, 1.0, aspect, load=1.0)
    assert (one.a, one.b) == pytest.approx((other.b, other.a), rel=2e-15)
    assert (one.p0, one.approach) == pytest.approx((other.p0, other.approach), rel=2e-15)


@pytest.mark.slow
@given(SCALES, SCALES, SCALES, SCALES)
def test_load_and_approach_round_trip(e_star, radius_x, radius_y, load):
    contact = hertz(e_star, radius_x, radius_y, load=load)
    back = hertz(e_star, radius_x, radius_y, approach=contact.approach)
    expected = pytest.approx((contact.a, contact.b, contact.p0, contact.load), rel=1e-14)
    assert (back.a, back.b, back.p0, back.load) == expected


@given(SCALES, SCALES, SCALES, st.floats(1e-2, 1e2))
def test_scaling(stiffen, stretch, load, aspect):
    """Lengths and moduli are free: only P / (E* R²) and the shape matter."""
    unit = hertz(1.0, aspect, 1.0, load=load)
    scaled = hertz(stiffen, aspect * stretch, stretch, load=load * stiffen * stretch**2)
    assert scaled.a == pytest.approx(unit.a * stretch, rel=1e-13)
    assert scaled.approach == pytest.approx(unit.approach * stretch, rel=1e-13)
    assert scaled.p0 == pytest.approx(unit.p0 * stiffen, rel=1e-13)


@pytest.mark.parametrize("aspect", ASPECTS)
def test_load_is_the_derivative_of_the_energy(aspect):
    """P = dU/d delta, with the energy of the pressure's work: U = 2/5 P delta."""

    def energy(approach):
        return 0.4 * hertz(1.0, aspect, 1.0, approach=approach).load * approach

    step = 1e-4
    slope = (energy(1 + step) - energy(1 - step)) / (2 * step)
    assert slope == pytest.approx(hertz(1.0, aspect, 1.0, approach=1.0).load, rel=1e-7)


@pytest.mark.parametrize("aspect", [0.01, 0.3, 0.9, 1.1, 7.0, 100.0])
def test_displacement_closes_the_gap(aspect):
    """The displacement integral over the ellipse, by quadrature, at its centre and vertices.

    Along a ray through a point, pi E* u is the integral of the pressure over all directions and
    distances: one smooth integral over the direction remains.
    """
    radius_x, radius_y, e_star = aspect, 1.0, 1.0
    contact = hertz(e_star, radius_x, radius_y, load=1e-6)
    a, b = contact.a, contact.b

    def displacement(x, y):
        def along(direction):
            cos, sin = math.cos(direction), math.sin(direction)
            # 1 - ((x + r cos)/a)² - ((y + r sin)/b)² = C - 2 B r - A r², integrated to its root
            A = (cos / a) ** 2 + (sin / b) ** 2
            B = x * cos / a**2 + y * sin / b**2
            C = 1 - (x / a) ** 2 - (y / b) ** 2
            # over the full chord: the two opposite directions together
            return math.pi * (B**2 / A + C) / (2 * math.sqrt(A))

        value, _ = quad(along, 0, math.pi, limit=400, epsabs=0, epsrel=1e-11, points=[math.pi / 2])
        return contact.p0 * value / (math.pi * e_star)

    for x, y in [(0, 0), (a, 0), (0, b), (0.5 * a, -0.5 * b)]:
        closed = contact.approach - x**2 / (2 * radius_x) - y**2 / (2 * radius_y)
        assert displacement(x, y) == pytest.approx(closed, rel=1e-10, abs=1e-10 * contact.approach)


@pytest.mark.parametrize("aspect", [1.5, 20.0, 1e4, 1e8])
def test_complete_elliptic_integrals_of_the_textbook(aspect):
    """R_x/R_y = (k^-2 E - K) / (K - E) with k = b/a and modulus 1 - k² (Johnson, section 4.2)."""
    contact = hertz(1.0, aspect, 1.0, load=1.0)
    k2 = (contact.b / contact.a) ** 2
    K, E = ellipkm1(k2), ellipe(1 - k2)
    assert (E / k2 - K) / (K - E) == pytest.approx(aspect, rel=1e-13)
    assert contact.approach == pytest.approx(contact.p0 * contact.b * K, rel=1e-13)


def test_long_ellipse_tends_to_the_line():
    """The middle section of an ever longer ellipse carries the pressure of a line contact."""
    errors = []
    for aspect in (1e2, 1e4, 1e6):
        contact = hertz(1.0, 1.0, aspect, load=1.0)
        line = hertz_line(1.0, 1.0, math.pi * contact.a * contact.p0 / 2)
        errors.append(abs(contact.p0 / line.p0 - 1))
    assert errors[0] > 10 * errors[1] > 100 * errors[2]


def test_line_equilibrium_and_curvature():
    line = hertz_line(2.0, 3.0, 0.4)
    carried, _ = quad(line.pressure, -line.a, line.a)
    assert carried == pytest.approx(0.4)
    # an elliptic pressure has the displacement -p0 x² / (E* a)
    assert line.p0 / (2.0 * line.a) == pytest.approx(1 / (2 * line.radius))


@pytest.mark.parametrize(
    ("radii", "combined"),
    [((2.0, 2.0), 1.0), ((2.0, math.inf), 2.0), ((1.0, -2.0), 2.0), ((2.0, -1.0), -2.0)],
)
def test_combined_radius(radii, combined):
    assert combined_radius(*radii) == pytest.approx(combined)


@pytest.mark.parametrize("radii", [(math.inf, math.inf), (2.0, -2.0)])
def test_flat_pair_has_an_infinite_radius(radii):
    assert combined_radius(*radii) == math.inf


@pytest.mark.parametrize(
    "wrong",
    [
        {"load": 0.0},
        {"load": math.inf},
        {"approach": -1.0},
        {"load": 1.0, "approach": 1.0},
        {},
        {"load": 1.0, "radius_x": math.inf},
        {"load": 1.0, "e_star": math.nan},
    ],
)
def test_impossible_contact(wrong):
    with pytest.raises(ValueError, match=[*(wrong or ["load"])][-1]):
        hertz(**({"e_star": 1.0, "radius_x": 1.0, "radius_y": 1.0} | wrong))


def test_impossible_line():
    with pytest.raises(ValueError, match="radius"):
        hertz_line(1.0, math.inf, 1.0)


def test_published_spheres(published):
    numbers = published["hertz"]["spheres"]
    pair = combine(Material(1.0, 0.28), Material(1.0, 0.28))
    contact = hertz(pair.E_star, 337.5 / 2, 337.5 / 2, load=0.4705)
    assert pair.E_star == pytest.approx(numbers["E_star"], rel=1e-6)
    assert (contact.a, contact.p0) == pytest.approx((numbers["a"], numbers["p0"]), rel=1e-6)


@pytest.mark.parametrize(("name", "crown"), [("twin-discs", 32.5), ("twin-discs-isotropic", 125.0)])
def test_published_discs(published, name, crown):
    numbers = published["hertz"][name]
    steel = Material.from_young(208e3, 0.3)
    radius_x = combined_radius(32.5, 32.3)
    contact = hertz(combine(steel, steel).E_star, radius_x, crown, load=300.0)
    assert contact.a == pytest.approx(numbers["a"], abs=6e-6)
    assert contact.b == pytest.approx(numbers["b"], abs=6e-6)
    assert contact.p0 == pytest.approx(numbers["p0"], abs=6e-3)
    assert contact.approach == pytest.approx(numbers["approach"], abs=6e-7)
