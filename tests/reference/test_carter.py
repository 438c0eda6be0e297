import math

import numpy as np
import pytest
from scipy.integrate import quad

from tractive_sam.mechanics.elasticity import Material, combine
from tractive_sam.mechanics.hertz_contact import combined_radius, hertz_line
from tractive_sam.reference import Carter

STEEL = combine(Material(82000.0, 0.28), Material(82000.0, 0.28))
RADIUS = combined_radius(500.0, 500.0)
LINE = hertz_line(STEEL.E_star, RADIUS, math.pi * STEEL.E_star / (4 * RADIUS))  # a = 1 mm
MU = 0.3
CREEPAGES = pytest.mark.parametrize("creepage", [-2.4e-4, 1e-4, -6e-4, -2e-3])


def integral(function, contact):
    """Over the contact; the traction and the slip change form at the trailing end of the stick."""
    seam = contact.hertz.a - 2 * contact.stick_half_width
    return sum(quad(function, *ends, limit=200)[0] for ends in [(-1.0, seam), (seam, 1.0)])


@CREEPAGES
def test_traction_carries_the_force(creepage):
    contact = Carter(LINE, MU, creepage)
    expected = contact.force_ratio * MU * LINE.load_per_length
    assert integral(contact.traction, contact) == pytest.approx(expected, rel=1e-8)


@CREEPAGES
def test_friction_law(creepage):
    contact = Carter(LINE, MU, creepage)
    x = np.linspace(-1.1, 1.1, 500)
    bound, traction, slip = MU * LINE.pressure(x), contact.traction(x), contact.slip(x)
    assert np.all(np.abs(traction) <= bound * (1 + 1e-12))
    slides = slip != 0
    # full friction, against the slip
    np.testing.assert_allclose(traction[slides], -np.sign(slip[slides]) * bound[slides])
    assert np.sign(contact.force_ratio) == -np.sign(creepage)


@CREEPAGES
def test_energy_law(creepage):
    """All the power of the creepage is dissipated: this ties the slip to the tractions."""
    contact = Carter(LINE, MU, creepage)
    dissipated = integral(lambda x: -contact.traction(x) * contact.slip(x), contact)
    force = contact.force_ratio * MU * LINE.load_per_length
    assert dissipated == pytest.approx(-force * creepage, rel=1e-8)


@pytest.mark.parametrize("creepage", [-2.4e-4, 1e-4, -2e-3])
def test_slip_is_the_creepage_less_the_strain(creepage):
    """du_x/dx of the half-plane, -2/(pi E*) PV integral of p/(x - s), on a Chebyshev grid.

    With p = f(s) sqrt(1 - s²) the rule with nodes cos(pi j/n) is free of the singularity at the
    midpoints; the square-root kink at the end of the stick zone leaves an error of order 1/n.
    """
    contact = Carter(LINE, MU, creepage)
    n = 4000
    angle = np.pi * np.arange(1, n) / n
    nodes, weights = np.cos(angle), np.pi / n * np.sin(angle)
    x = np.cos(np.pi * (np.arange(200, n - 200, 37) + 0.5) / n)
    strain = (
        -2 / (np.pi * STEEL.E_star) * ((contact.traction(nodes) * weights) / (x[:, None] - nodes))
    )
    np.testing.assert_allclose(
        contact.slip(x), creepage - strain.sum(axis=1), atol=2e-3 * abs(creepage)
    )


@pytest.mark.parametrize("ratio", [-1.0, -0.3, 1e-9, 0.5, 0.99])
def test_force_inverts_the_creepage(ratio):
    contact = Carter.from_force_ratio(LINE, MU, ratio)
    assert contact.force_ratio == pytest.approx(ratio, rel=1e-6)


def test_more_than_friction_can_carry():
    with pytest.raises(ValueError, match=r"Q/\(mu P\)"):
        Carter.from_force_ratio(LINE, MU, 1.001)


def test_full_slip():
    contact = Carter(LINE, MU, -2 * MU * LINE.a / RADIUS)
    assert contact.stick_half_width == 0
    assert contact.force_ratio == 1
    assert contact.slip(1.0) == pytest.approx(-MU / RADIUS)
    assert contact.slip(1.001) == 0


def test_free_rolling():
    contact = Carter(LINE, MU, 0.0)
    assert contact.force_ratio == 0
    assert not contact.traction([-0.5, 0.5]).any()
    assert not contact.slip([-0.5, 0.5]).any()


def test_published_formulas():
    """`carter` of the reference numbers; a - c = |xi| R / mu = 0.2 a for its example."""
    contact = Carter(LINE, MU, -2.4e-4)
    assert pytest.approx(1.0) == LINE.a
    assert contact.stick_half_width == pytest.approx(0.8)
    assert contact.force_ratio == pytest.approx(1 - 0.8**2)
