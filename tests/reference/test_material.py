import math

import pytest

from tractive_sam.mechanics.elasticity import Material, combine

STEEL = Material.from_young(208e3, 0.3)
ALUMINIUM = Material.from_young(70e3, 0.33)


def test_young_and_shear_round_trip():
    assert STEEL.young == pytest.approx(208e3, rel=1e-15)
    assert STEEL.shear == pytest.approx(80e3, rel=1e-15)


def test_equal_bodies_are_uncoupled_and_keep_their_constants():
    pair = combine(STEEL, STEEL)
    assert pair.shear == pytest.approx(STEEL.shear, rel=1e-15)
    assert pair.poisson == pytest.approx(STEEL.poisson, rel=1e-15)
    assert pair.coupling == 0


def test_contact_modulus_is_that_of_the_two_plane_strain_compliances():
    pair = combine(ALUMINIUM, STEEL)
    compliance = sum((1 - m.poisson**2) / m.young for m in (ALUMINIUM, STEEL))
    assert pair.E_star == pair.plane_strain_modulus
    assert 1 / pair.E_star == pytest.approx(compliance, rel=1e-14)


def test_swapping_the_bodies_turns_only_the_coupling_around():
    there, back = combine(ALUMINIUM, STEEL), combine(STEEL, ALUMINIUM)
    assert there.coupling == pytest.approx(-back.coupling, rel=1e-14)
    assert there.coupling > 0  # the more compliant body is above
    assert (there.shear, there.poisson) == pytest.approx((back.shear, back.poisson))


@pytest.mark.parametrize("rigid", [1e12, math.inf])
def test_rigid_plane(rigid):
    pair = combine(Material(1.0, 0.0), Material(rigid, 0.3))
    assert pair.shear == pytest.approx(2.0)
    assert pair.poisson == pytest.approx(0.0, abs=1e-11)
    assert pair.coupling == pytest.approx(0.5)


def test_incompressible_bodies_are_uncoupled():
    assert combine(Material(1.0, 0.5), Material(50.0, 0.5)).coupling == 0


@pytest.mark.parametrize(
    ("shear", "poisson", "fault"),
    [
        (0, 0.3, "shear"),
        (-1, 0.3, "shear"),
        (1, 0.51, "Poisson"),
        (1, -1, "Poisson"),
        (1, math.nan, "Poisson"),
    ],
)
def test_impossible_material(shear, poisson, fault):
    with pytest.raises(ValueError, match=fault):
        Material(shear, poisson)


def test_two_rigid_bodies():
    with pytest.raises(ValueError, match="elastic"):
        combine(Material(math.inf, 0.3), Material(math.inf, 0.3))
