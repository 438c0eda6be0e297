"""Wear laws that were measured, at their borders and against each other."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.mechanics import (
    BRR,
    JENDEL,
    USFD,
    ArchardByWork,
    Energy,
    PerBody,
    Regimes,
    TGammaPerArea,
    TGammaTotal,
    WearMap,
)
from tractive_sam.mechanics.wear import JENDEL_BORDERS, JENDEL_LIMIT

STEEL = 7850.0


def sliding(work, pressure=1000.0):
    """Fields of elements of the given frictional work, along x."""
    work = np.atleast_2d(np.asarray(work, float))
    p = np.where(work > 0.0, pressure, 0.0)
    traction = np.stack((0.3 * p, np.zeros_like(p)))
    slip = np.stack((np.where(p > 0.0, -work / np.where(p > 0.0, 0.3 * p, 1.0), 0.0), 0.0 * p))
    return p, traction, slip


def below(border):
    return np.nextafter(border, 0.0)


def test_usfd_as_published():
    law = USFD["r8t-uic60"]
    for W, rate in ((0.0, 0.0), (5.0, 26.5), (50.0, 55.0), (77.2, 55.0), (100.0, 1466.32)):
        assert law.at(W) == pytest.approx(rate, rel=1e-14)
    # It jumps by 0.2 % at the first border, and is continuous at the second.
    assert law.at(10.4) == 55.0
    assert law.at(below(10.4)) == pytest.approx(55.12, rel=1e-14)
    assert law.at(below(77.2)) == law.at(77.2)


def test_brr_as_published():
    law = BRR["pearce-sherratt"]
    for T, rate in ((50.0, 12.5), (100.0, 25.0), (150.0, 25.0), (300.0, 1.19 * 300.0 - 154.0)):
        assert law.at(T) == pytest.approx(rate, rel=1e-14)
    assert law.at(below(100.0)) == pytest.approx(25.0, rel=1e-14)
    assert law.at(below(200.0)) == 25.0
    assert law.at(200.0) == pytest.approx(84.0, rel=1e-14)


def test_brr_wears_the_section_of_any_diameter():
    """0.25 T-gamma/D mm² a km, and pi D mm a turn; shared out by the work of each element."""
    law = TGammaTotal(BRR["pearce-sherratt"]).on(0.01)
    fields = sliding([[1.0, 2.0, 0.0, 5.0]])
    T = 8.0 * 0.01
    rate = law.rate(*fields)
    D = 920.0
    section = 0.25 * T / D * (np.pi * D * 1e-6)
    assert rate.sum() * 0.01 == pytest.approx(section, rel=1e-14, abs=0.0)
    np.testing.assert_allclose(rate / rate[0, 0], [[1.0, 2.0, 0.0, 5.0]], rtol=1e-14)


@pytest.mark.parametrize("name", JENDEL)
def test_jendel_at_its_borders(name):
    k = JENDEL[name][0]
    H, V, p = 3000.0, 2000.0, 1000.0
    law = WearMap(k, H, V, mu=(0.3, 0.3))
    slow, fast = (border / V for border in JENDEL_BORDERS)
    cases = [
        (below(slow), p, 0),
        (slow, p, 1),
        (below(fast), p, 1),
        (np.nextafter(fast, 1.0), p, 2),
        (slow, JENDEL_LIMIT * H, 1),
        (slow, np.nextafter(JENDEL_LIMIT * H, 9e9), 3),
    ]
    for s, pressure, regime in cases:
        p_n = np.full((1, 1), pressure)
        traction = np.stack((0.3 * p_n, 0.0 * p_n))
        slip = np.stack((-s + 0.0 * p_n, 0.0 * p_n))
        rate = law.rate(p_n, traction, slip)
        # V = k P s/H over the area: the depth over the distance rolled.
        assert rate[0, 0] == pytest.approx(k[regime] * pressure / H * s, rel=1e-12, abs=0.0)


def test_mass_to_depth():
    """55 µg off a mm² in a metre are 55e-3/7.85 mm³: 7.006e-3 mm deep after 1000 mm."""
    law = TGammaPerArea(USFD["r8t-uic60"], STEEL)
    rate = law.rate(*sliding([[50.0]]))
    assert rate[0, 0] == pytest.approx(55e-3 / 7.85 / 1000.0, rel=1e-14, abs=0.0)
    assert TGammaPerArea(USFD["r8t-uic60"], 2.0 * STEEL).rate(*sliding([[50.0]])) == 0.5 * rate


def test_of_the_whole_contact_it_is_the_same_where_the_law_is_straight():
    regimes = Regimes.through(((10.0, 50.0),))
    fields = sliding([[1.0, 2.0, 0.0, 5.0]])
    each, whole = (TGammaPerArea(regimes, STEEL, total).rate(*fields) for total in (False, True))
    np.testing.assert_allclose(whole, each, rtol=1e-14)
    # In a regime that does not rise, the contact wears as all of its area would.
    flat = TGammaPerArea(USFD["r8t-uic60"], STEEL, total=True).rate(*sliding([[20.0, 60.0, 0.0]]))
    assert flat.sum() == pytest.approx(2 * 55e-3 / STEEL, rel=1e-14, abs=0.0)


def test_a_table_goes_through_its_points_and_on():
    law = Regimes.through(((10.0, 50.0), (20.0, 70.0)))
    for W, rate in ((0.0, 0.0), (5.0, 25.0), (10.0, 50.0), (15.0, 60.0), (30.0, 90.0)):
        assert law.at(W) == pytest.approx(rate, rel=1e-14)
    assert Regimes.through(((0.0, 0.0), (10.0, 50.0), (20.0, 70.0))) == law


@pytest.mark.parametrize(
    "law",
    [
        Energy((3e-6, 1e-6), 0.4),
        TGammaPerArea(USFD["r8t-uic60"], STEEL),
        TGammaPerArea(Regimes.through(((10.0, 50.0), (20.0, 70.0))), STEEL),
        WearMap(JENDEL["middle"][0], 3000.0, 500.0, (0.3, 0.2), 0.3),
        PerBody(Energy((3e-6, 3e-6)), TGammaPerArea(USFD["r8t-uic60"], STEEL)),
    ],
)
def test_growth_with_the_load_is_its_derivative(law):
    """Except at the limits of regimes: none of these elements is there."""
    fields = sliding([[1.0, 5.0, 0.0, 15.0, 90.0]])
    h = 1e-4
    more, less = (law.rate(f * fields[0], f * fields[1], fields[2]) for f in (1 + h, 1 - h))
    p = np.where(fields[0] > 0.0, fields[0], 1.0)
    # To the third derivative, which straight laws have not: rounding.
    np.testing.assert_allclose(law.per_load(*fields), (more - less) / (2 * h * p), rtol=1e-9)


def test_energy_is_archard_where_all_slips_alike():
    """Exactly: with k = i/mu the formulas are equal."""
    random = np.random.default_rng(3)
    p = random.uniform(0.0, 1.0, (7, 5))
    fields = p, 0.3 * p * np.array([[[0.6]], [[0.8]]]), random.normal(size=(2, 7, 5))
    archard = ArchardByWork((2e-6, 2e-6), (0.25, 0.25), 0.3).rate(*fields)
    energy = Energy((2e-6 / 0.25, 2e-6 / 0.25), 0.3).rate(*fields)
    np.testing.assert_array_equal(energy, archard)


def test_energy_counts_the_work_along_each_axis():
    """Additive, by the work alone; less than Archard's norm for oblique slip."""
    random = np.random.default_rng(4)
    k, mu, angle = np.array((3e-6, 8e-6)), np.array((0.3, 0.2)), 0.4
    axes = np.array(((np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))))
    slip = random.normal(size=(2, 6, 5))
    in_axes = np.tensordot(axes, slip, axes=1)
    p = random.uniform(0.1, 1.0, (6, 5))
    norm = np.hypot(*(mu[:, None, None] * in_axes))  # of full slip: p_j = -p mu_j² s_j/norm
    traction = -p * np.tensordot(axes.T, mu[:, None, None] ** 2 * in_axes, axes=1) / norm
    work = p * mu[:, None, None] ** 2 * in_axes**2 / norm
    rate = Energy(tuple(k), angle).rate(p, traction, slip)
    # Rounding, here and below.
    np.testing.assert_allclose(rate, np.tensordot(k, work, axes=1), rtol=1e-12)
    parts = [Energy(one, angle).rate(p, traction, slip) for one in ((k[0], 0.0), (0.0, k[1]))]
    np.testing.assert_allclose(rate, sum(parts), rtol=1e-12)
    archard = ArchardByWork(tuple(k * mu), tuple(mu), angle).rate(p, traction, slip)
    np.testing.assert_allclose(
        archard, p * np.hypot(*((k * mu)[:, None, None] * in_axes)), rtol=1e-12
    )
    assert (rate < archard).all()
    along = np.tensordot(axes.T, in_axes * np.array((1.0, 0.0))[:, None, None], axes=1)
    sliding = p, -0.3 * p * along / np.hypot(*along), along
    laws = Energy(tuple(k), angle), ArchardByWork(tuple(k * mu), tuple(mu), angle)
    rates = [law.rate(*sliding) for law in laws]
    np.testing.assert_allclose(*rates, rtol=1e-12)


def test_each_body_by_its_own():
    fields = sliding([[1.0, 30.0, 0.0], [2.0, 60.0, 0.0]])
    A, B = Energy((3e-6, 3e-6)), TGammaPerArea(USFD["r8t-uic60"], STEEL)
    both = PerBody(A, B)
    np.testing.assert_array_equal(both.rate(*fields), A.rate(*fields) + B.rate(*fields))
    shares = both.shares(*fields)
    np.testing.assert_allclose(shares.sum(axis=0), 1.0, rtol=1e-15)
    np.testing.assert_allclose(
        shares[0, :2], A.rate(*fields).sum(axis=0)[:2] / both.rate(*fields).sum(axis=0)[:2]
    )
    # A row that does not wear has the shares of the contact.
    assert shares[0, 2] == pytest.approx(A.rate(*fields).sum() / both.rate(*fields).sum())
    np.testing.assert_array_equal(PerBody(A=A).shares(*fields), [[1.0] * 3, [0.0] * 3])


def test_beyond_the_tests_is_reported():
    law = TGammaPerArea(USFD["r8t-uic60"], STEEL)
    assert not law.beyond_tests(*sliding([[119.0]]))
    assert "T-gamma/A = 130" in law.beyond_tests(*sliding([[130.0]]))
    whole = TGammaPerArea(USFD["r8t-uic60"], STEEL, total=True)
    assert not whole.beyond_tests(*sliding([[130.0, 10.0]]))
    assert PerBody(B=law).beyond_tests(*sliding([[130.0]])).startswith("body B")


def test_sets_are_named_with_their_sources():
    for one in (*USFD.values(), *BRR.values()):
        assert "Wear" in one.source
    assert all("Wear" in source for _, source in JENDEL.values())
    assert ts.Wear(law="jendel", revolutions=1).sets == {"A": "middle", "B": "middle"}
