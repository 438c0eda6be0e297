"""Adaptive jumps against revolution by revolution."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import trapezoid

from tractive_sam.contact import Model, equilibrium
from tractive_sam.results import Status
from tractive_sam.rolling import steps
from tractive_sam.rolling.passage import RowContact, passage_at, wear_response
from tractive_sam.scene import Scene

COARSE = ("grid.half_length=[0.35, 0.8]", "grid.elements=[21, 35]", "friction.angle=0")


def rolled(revolutions, *settings):
    settings = [*COARSE, f"wear.revolutions={revolutions}", *settings]
    return list(steps(Model(Scene.builtin("twin-discs").with_set(settings))))


@pytest.fixture(scope="module")
def every():
    return rolled(300, 'wear.stepping="every-revolution"')


@pytest.fixture(scope="module")
def passage():
    """The hundredth revolution."""
    return rolled(100)[-1]


def deviation(adaptive, every):
    """Largest difference of the last profile, relative to its depth."""
    truth = every[-1].leaving
    return np.abs(adaptive[-1].leaving - truth).max() / truth.max()


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_every_profile_is_within_three_times_the_tolerance(every, tolerance):
    adaptive = rolled(300, f"wear.tolerance={tolerance}")
    for passage in adaptive[1:]:
        truth = every[passage.revolution].leaving
        assert np.abs(passage.leaving - truth).max() < 3 * tolerance * truth.max()
    assert adaptive[-1].contact.Qx == pytest.approx(every[-1].contact.Qx, rel=tolerance)


def test_a_jump_of_one_revolution_is_that_revolution():
    """To the residual that the wear within a pass may leave, which is the tolerance."""
    adaptive = rolled(6, "wear.tolerance=1e-9", "wear.save=[0, 1, 2, 3, 4, 5, 6]")
    truth = rolled(6, 'wear.stepping="every-revolution"')[-1].leaving
    np.testing.assert_allclose(adaptive[-1].leaving, truth, atol=1e-8 * truth.max())


def test_contacts_no_sharper_than_their_jumps(monkeypatch):
    """They change the profile by a thousandth of what jumps may, in fewer applications."""
    loose = rolled(100)
    monkeypatch.setattr(
        "tractive_sam.rolling.passage.equilibrium",
        lambda model, wear, start=None, tolerance=None: equilibrium(model, wear, start),
    )
    sharp = rolled(100)
    assert deviation(loose, sharp) < 1e-6
    assert all(one.contact.residual <= 1e-3 for one in loose)
    cost = [sum(one.contact.cost.applications for one in course) for course in (loose, sharp)]
    assert cost[0] < 0.8 * cost[1]  # .76 measured


@pytest.mark.slow
def test_error_falls_with_the_tolerance():
    """Over thousands of revolutions; in few, jumps are short for the sake of the last one."""
    wide = ("grid.half_length=[0.35, 1.1]", "grid.elements=[21, 47]")
    finest, fine, coarse = (rolled(3000, *wide, f"wear.tolerance={t}") for t in (1e-5, 1e-4, 1e-2))
    # At the finest tolerance rows at the rim differ from the roll of every revolution by 1e-4.
    assert deviation(fine, finest) < 0.5 * deviation(coarse, finest)
    assert deviation(fine, finest) < 2e-4
    # Loose tolerances are held as well, in no more contacts than strict ones.
    assert deviation(coarse, finest) < 1e-2
    assert sum(p.solves for p in coarse) <= sum(p.solves for p in fine)


@pytest.mark.slow
def test_needs_few_contacts(every):
    adaptive = rolled(300)
    assert sum(p.solves for p in adaptive) < 0.2 * sum(p.solves for p in every)


def test_meets_the_revolutions_to_be_saved():
    adaptive = rolled(200, "wear.save=[0, 7, 50, 101, 200]")
    assert {0, 7, 50, 101, 200} <= {p.revolution for p in adaptive}
    assert all(a.revolution < b.revolution for a, b in pairwise(adaptive))


def test_jumps_grow_far_beyond_the_explicit_limit_without_ripple():
    """Explicit jumps are stable up to some tens of revolutions here."""
    wide = ("grid.half_length=[0.35, 1.1]", "grid.elements=[21, 47]")
    adaptive = rolled(4000, *wide, "wear.save=[0, 4000]")
    assert max(b.revolution - a.revolution for a, b in pairwise(adaptive)) > 200
    last = adaptive[-1].contact
    assert last.converged, last.message
    # Away from the rim, at which an element carries a spike, the worn disc wears evenly.
    carried = last.pressure.sum(axis=0)
    inside = np.flatnonzero(carried)[4:-4]
    second = np.abs(np.diff(carried[inside], 2)).max()
    assert second < 0.05 * carried[inside].mean()


def test_worn_volume_follows_the_energy_law():
    """The integral of the frictional work over the revolutions, by the trapezoidal rule."""
    adaptive = rolled(300)
    n = np.array([p.revolution for p in adaptive[1:]])
    rate = [2e-6 / 0.6 * p.contact.dissipation for p in adaptive[1:]]
    worn = [p.leaving.sum() * p.contact.grid.dy for p in adaptive[1:]]
    expected = worn[0] + trapezoid(rate, n)
    # The tolerance of the stepping, and the trapezoids.
    assert worn[-1] == pytest.approx(expected, rel=1e-3)


def test_continues_from_any_passage():
    adaptive = rolled(200, "wear.save=[0, 200]")
    model = Model(adaptive[0].contact.scene)
    middle = adaptive[len(adaptive) // 2]
    again = list(steps(model, middle))
    assert [p.revolution for p in again] == [
        p.revolution for p in adaptive if p.revolution > middle.revolution
    ]
    np.testing.assert_allclose(again[-1].leaving, adaptive[-1].leaving, rtol=1e-10)


def test_response_is_near_the_derivative_of_the_wear_of_a_pass(passage):
    """A smooth wave of the profile: slip and contact area, held fixed, cost some ten per cent."""
    model = Model(passage.contact.scene)
    y = model.grid.y
    touching = passage.contact.touching.any(axis=0)
    wave = np.where(touching, np.cos(2 * np.pi * y / 0.4), 0.0)
    h = 1e-6
    worn = [
        passage_at(model, 1, passage.entering + s * h * wave, passage.contact, 1e-8).worn
        for s in (1, -1)
    ]
    derivative = (worn[0] - worn[1]) / (2 * h)
    response = wear_response(model, passage.contact) @ wave
    inside = np.flatnonzero(touching)[3:-3]
    scale = np.abs(derivative[inside]).max()
    np.testing.assert_allclose(response[inside], derivative[inside], atol=0.35 * scale)


def test_response_damps(passage):
    response = wear_response(Model(passage.contact.scene), passage.contact)
    assert np.linalg.eigvals(response).real.max() < 1e-12


@pytest.fixture
def rows(passage):
    model, contact = Model(passage.contact.scene), passage.contact
    return RowContact(model, contact, 1.0, passage.entering, passage.worn, closing=1e-3)


def test_rows_wear_at_their_profile_as_their_contact(rows, passage):
    response, rate = rows.linear(rows.touching)
    # To the roundoff of an inverse of some tens of rows.
    expected, scale = passage.worn, passage.worn.max()
    np.testing.assert_allclose(rate + response @ passage.entering, expected, atol=1e-10 * scale)
    np.testing.assert_array_equal(rows.update(rows.touching, passage.entering), rows.touching)
    of_contact = wear_response(Model(passage.contact.scene), passage.contact)
    inside = np.flatnonzero(passage.worn)[2:-2]  # rows beside have other elements
    block = np.ix_(inside, inside)
    # Elements that come into contact beside those of a row make it stiffer by a seventh.
    np.testing.assert_allclose(
        response[block], of_contact[block], atol=0.15 * np.abs(response).max()
    )


def test_rows_carry_the_load_or_are_open(rows, passage):
    """A deep groove opens the middle and brings rows beside the contact into it, as solved."""
    model = Model(passage.contact.scene)
    middle = np.abs(model.grid.y) < 0.25
    profile, touching = passage.entering + np.where(middle, 4e-3, 0.0), rows.touching
    for _ in range(20):
        touching, before = rows.update(touching, profile), touching
        if np.array_equal(touching, before):
            break
    assert np.array_equal(touching, before)
    response, rate = rows.linear(touching)
    rate += response @ profile
    assert not touching[middle[rows.rows]].any()
    assert (touching & ~rows.touching).any()
    solved = passage_at(model, 101, profile, passage.contacts, 1e-8).contact.touching.any(axis=0)
    np.testing.assert_array_equal(rows.rows[touching][[0, -1]], np.flatnonzero(solved)[[0, -1]])
    assert (rate[rows.rows[touching]] > 0.0).all()
    np.testing.assert_array_equal(np.flatnonzero(rate), rows.rows[touching])


def test_jumps_pass_several_rows_that_come_into_contact():
    """A solve that is repeated in each jump would double the 33 contacts."""
    wide = ("grid.half_length=[0.35, 1.1]", "grid.elements=[21, 47]")
    adaptive = rolled(4000, *wide, "wear.save=[0, 4000]")
    assert sum(p.solves for p in adaptive) <= 38
    rows = [np.count_nonzero(adaptive[k].contact.touching.any(axis=0)) for k in (0, -1)]
    assert rows[1] > rows[0] + 10  # 19 and 37


@pytest.mark.slow
@pytest.mark.parametrize("stepping", ["adaptive", "every-revolution"])
def test_bodies_at_a_given_approach_wear_until_they_hardly_touch(stepping):
    """The gap of the unworn bodies and the depth worn off add up to the approach."""
    approach, wear = "load.approach=0.004", ("wear.intensity=3e-4", "wear.save=[300]")
    last = rolled(300, approach, *wear, f'wear.stepping="{stepping}"')[-1].contact
    assert last.status is Status.NOT_RESOLVED  # two elements along x are left
    model = Model(Scene.builtin("twin-discs").with_set([*COARSE, approach]))
    middle = model.undeformed_gap[10]
    touched = middle < 0.9 * 0.004
    np.testing.assert_allclose((middle + last.wear[10])[touched], 0.004, rtol=0.03)
    assert last.P < 4.0  # of 187 N at the beginning


def test_elements_that_enter_at_the_rim_do_not_show_in_every_pressure():
    """There a spike as wide as an element rises and falls; what 5 % of the load exceed does not."""
    settings = ["friction.angle=0", "grid.elements=[21, 61]", "wear.revolutions=6000"]
    model = Model(Scene.builtin("twin-discs").with_set([*settings, "wear.save=[6000]"]))
    late = [passage for passage in steps(model) if passage.revolution > 2500]
    course = np.log([passage.revolution for passage in late])

    def zigzag(name):
        values = np.array([getattr(passage.contact, name) for passage in late])
        smooth = np.polynomial.Polynomial.fit(course, values, 3)(course)
        return np.abs(values / smooth - 1.0).max()

    print(zigzag("p_max"), zigzag("p_95"))
    assert zigzag("p_max") > 0.05
    assert zigzag("p_95") < 0.01
