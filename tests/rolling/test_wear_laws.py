"""Rolling by wear laws that are no straight lines, and by one for each body."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.schema import PlausibilityWarning

DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None)
DISCS = DISCS.with_set(
    ["grid.half_length=[0.35, 0.7]", "grid.elements=[15, 21]", "friction.mu=0.5"]
)
HARD = ["body.A.hardness=2500", "body.B.hardness=3000", "creepage.speed=2000"]
LAWS = {
    "usfd": ["wear.law=usfd"],
    "whole": ["wear.law=usfd", "wear.by=contact"],
    "brr": ["wear.law=brr"],
    "jendel": ["wear.law=jendel", *HARD],
    "table": ["wear.law={table=[[10, 50], [20, 200]]}"],
    "own": ['wear.law={A="usfd", B="archard"}', "wear.coefficient.B=1e-3"],
}


def rolled(*settings, revolutions=60):
    return ts.roll(DISCS.with_set([f"wear.revolutions={revolutions}", *settings]))


def test_energy_is_archard_in_full_slip():
    """k = i/mu, exactly, with isotropic friction: stepping and all."""
    archard, energy = (
        rolled("wear.intensity=2e-6"),
        rolled("wear.law=energy", "wear.coefficient=4e-3"),
    )
    for name in ("wear_max", "worn_volume", "wear_profile", "jump"):
        np.testing.assert_array_equal(archard[name], energy[name])
    np.testing.assert_allclose(energy.wear_balance[1:], 1.0, rtol=1e-4)  # as Archard's


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_jumps_meet_what_is_rolled_one_by_one(name):
    jumps = rolled(*LAWS[name])
    letter = rolled(*LAWS[name], 'wear.stepping="every-revolution"')
    assert jumps.finished, jumps.message
    assert letter.finished, letter.message
    assert len(jumps) < 0.5 * len(letter)
    for column in ("wear_profile", "wear_profile_A", "wear_profile_B"):
        last = letter[column][-1]
        # The tolerance of the stepping, and its lag of a pass.
        np.testing.assert_allclose(jumps[column][-1], last, atol=3e-3 * last.max(), rtol=0.0)


@pytest.mark.parametrize("name", LAWS)
def test_profiles_of_the_bodies_add_up(name):
    history = rolled(*LAWS[name])
    both = history["wear_profile_A"] + history["wear_profile_B"]
    np.testing.assert_allclose(both, history["wear_profile"], atol=1e-12 * both.max(), rtol=1e-12)


def test_each_body_wears_by_its_own_law():
    """If the contact hardly changes, each wears as it would alone."""
    one = ["wear.revolutions=1"]
    own = rolled(*LAWS["own"], *one)
    A = rolled('wear.law={A="usfd"}', *one)
    B = rolled('wear.law={B="archard"}', "wear.coefficient.B=1e-3", *one)
    # One pass wears 1e-4 of the approach.
    for body, single in (("A", A), ("B", B)):
        k = "AB".index(body)
        assert own["worn_volume"][-1, k] == pytest.approx(single["worn_volume"][-1, k], rel=1e-2)
    assert A["worn_volume"][-1, 1] == B["worn_volume"][-1, 0] == 0.0


def test_straight_laws_of_each_body_are_shares():
    """Archard for A and for B, each with its coefficient: as with both together."""
    together = rolled("wear.coefficient={A=1e-3, B=3e-3}")
    own = rolled('wear.law={A="archard", B="archard"}', "wear.coefficient={A=1e-3, B=3e-3}")
    for name in ("wear_profile", "wear_profile_A", "wear_profile_B", "worn_volume"):
        last = together[name][-1]
        np.testing.assert_allclose(own[name][-1], last, rtol=1e-9, atol=1e-12 * last.max())


def test_unequal_turns_of_bodies_with_laws_of_their_own():
    """A line contact in full slip: depths are rates times turns."""
    steel = {"young": 208e3, "poisson": 0.3, "radius_y": math.inf}
    scene = ts.Scene(
        body={"A": steel | {"radius_x": 40.0}, "B": steel | {"radius_x": 20.0}},
        load={"normal": 300.0},
        creepage={"longitudinal": -0.2},  # far beyond full slip
        friction={"mu": 0.3},
        wear={
            "law": {"A": "archard", "B": "energy"},
            "coefficient": {"A": 1e-6, "B": 4e-6},
            "revolutions": 30,
            "turns": "each",
        },
    )
    history = ts.roll(scene)
    assert history.finished, history.message
    # Slip is creepage plus strain of the surfaces; the work of the strain over the contact is zero.
    A, B = (history[f"wear_profile_{body}"][-1, 0] for body in "AB")
    assert pytest.approx(30 * 1e-9 * 0.2 * 300.0, rel=1e-5) == A
    assert pytest.approx((29 * 2.0 + 1.0) * 4e-9 * 0.3 * 0.2 * 300.0, rel=1e-5) == B


def test_wear_by_usfd_is_that_of_its_work():
    """In the mild regime, 5.3 µg/(m mm²) per N/mm² off each body."""
    history = rolled("wear.law=usfd", "wear.revolutions=1", "creepage.longitudinal=-0.002")
    contact = history.state(1)
    assert (-(contact.traction * contact.slip).sum(axis=0)).max() < 10.4
    wanted = 2 * 5.3e-3 / 7850.0 * contact.dissipation
    assert history["worn_area"][-1] == pytest.approx(wanted, rel=1e-9)


def test_what_goes_beyond_the_tests_is_noted():
    with pytest.warns(PlausibilityWarning, match="T-gamma/A"):
        rolled("wear.law=usfd", "wear.revolutions=1", "creepage.longitudinal=-0.6")


@pytest.mark.slow
def test_parts_are_kept(tmp_path):
    scene = DISCS.with_set(["wear.revolutions=20", *LAWS["own"]]).replace(grid=None)
    history = ts.roll(scene, tmp_path / "a.h5")
    assert history["worn_by"].shape == (len(history), 1, 2, len(history.y))
    np.testing.assert_allclose(
        history["worn_by"].sum(axis=(1, 2)), history["entering_profile"], atol=1e-14
    )
    memory = ts.roll(scene)
    np.testing.assert_allclose(history["worn_by"], memory["worn_by"], atol=1e-14)


@pytest.mark.parametrize(
    ("settings", "key"),
    [
        (["wear.law=jendel"], "body.A.hardness"),
        (["wear.law=jendel", *HARD[:2]], "creepage.speed"),
        (["wear.law=usfd", "wear.intensity=1e-6"], "wear.intensity"),
        (["wear.law=energy"], "wear.intensity"),
        (["wear.law=usfd", "wear.set=none"], "wear.set"),
        (['wear.law={A="usfd", B="energy"}', "wear.coefficient.A=1"], "wear.coefficient.A"),
        (["wear.law={}"], "wear.law.table"),
        (["wear.law={table=[[2, 1], [1, 2]]}"], "wear.law.table"),
        (["wear.law={table=[[0, 1], [1, 2]]}"], "wear.law.table"),
        (["wear.law=table"], "wear.law"),
        (["wear.law=brr", "body.A.radius_y=inf", "grid.half_length=0.35", "grid.elements=15"],
         "wear.law"),
    ],
)  # fmt: skip
def test_a_law_without_what_it_needs_is_reported(settings, key):
    with pytest.raises(ts.SceneError) as caught:
        DISCS.with_set(settings)
    assert key in [fault.key for fault in caught.value.faults]
