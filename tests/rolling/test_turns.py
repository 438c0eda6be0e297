"""Bodies that return unequally often."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.rolling import steps
from tractive_sam.run.explain import explain

STEEL = {"young": 208e3, "poisson": 0.3}
COARSE = {"half_length": (0.45, 0.8), "elements": (21, 25)}
INTENSITY, CREEPAGE, LOAD = 2e-6, 0.005, 300.0


def discs(radius_A, radius_B, revolutions, hardness=(1.0, 1.0), driven="A", **wear):
    """Two crowned discs; the creepage drives one of them."""
    A, B = (
        STEEL | {"radius_x": radius, "radius_y": 65.0, "hardness": hard}
        for radius, hard in zip((radius_A, radius_B), hardness, strict=True)
    )
    return ts.Scene(
        body={"A": A, "B": B},
        load={"normal": LOAD},
        creepage={"longitudinal": -CREEPAGE if driven == "A" else CREEPAGE},
        friction={"mu": 0.6},
        wear={"intensity": INTENSITY, "revolutions": revolutions, "turns": "each"} | wear,
        grid=COARSE,
    )


def rolled(scene):
    return list(steps(Model(scene)))


@pytest.mark.parametrize("stepping", ["adaptive", "every-revolution"])
@pytest.mark.parametrize("radius_B", [20.0, 120.0, math.inf])
def test_depths_of_line_contacts_in_full_slip(stepping, radius_B):
    """i xi P a pass, in proportion to the share by hardness and the turns of each body."""
    A = STEEL | {"radius_x": 40.0, "radius_y": math.inf, "hardness": 3.0}
    B = STEEL | {"radius_x": radius_B, "radius_y": math.inf, "hardness": 1.0}
    scene = ts.Scene(
        body={"A": A, "B": B},
        load={"normal": LOAD},
        creepage={"longitudinal": -0.2},  # far beyond full slip
        friction={"mu": 0.3},
        wear={"intensity": 1e-8, "revolutions": 30, "turns": "each", "stepping": stepping},
    )
    scene = scene.replace(grid={"half_length": 1.1 * scene.hertz.a, "elements": 65})
    history = ts.roll(scene)
    assert history.finished, history.message
    a_pass, ratio = 1e-8 * 0.2 * LOAD, 40.0 / radius_B
    # Slip is creepage plus strain of the surfaces; the work of the strain over the contact is zero,
    # to the second order of 59 elements across.
    A, B = (history[f"wear_profile_{body}"][-1, 0] for body in "AB")
    assert pytest.approx(0.25 * 30 * a_pass, rel=1e-3) == A
    assert pytest.approx(0.75 * (29 * ratio + 1) * a_pass, rel=1e-3) == B


@pytest.mark.parametrize("stepping", ["adaptive", "every-revolution"])
def test_equal_radii_wear_as_the_sum_of_both_bit_for_bit(stepping):
    each, equal = (
        ts.roll(discs(32.5, 32.5, 6, (1.0, 2.5), turns=turns, stepping=stepping))
        for turns in ("each", "equal")
    )
    assert list(each["revolution"]) == list(equal["revolution"])
    for name in ("wear_profile", "wear_profile_A", "wear_profile_B", "entering_profile", "Qx"):
        np.testing.assert_array_equal(each[name], equal[name])


@pytest.mark.parametrize("radius_B", [10.0, math.inf])
def test_jumps_meet_every_revolution(radius_B):
    one_by_one, jumps = (
        rolled(discs(30.0, radius_B, 60, stepping=stepping))[-1]
        for stepping in ("every-revolution", "adaptive")
    )
    depth = one_by_one.leaving.max()
    assert one_by_one.contact.converged
    # Three times the tolerance of the stepping, 1e-3.
    assert np.abs(jumps.leaving - one_by_one.leaving).max() < 3e-3 * depth


def test_swapped_bodies_come_to_the_same_state():
    """60 revolutions of a disc of 30 mm, or 180 of the one of 10 mm that rolls on it."""
    large = rolled(discs(30.0, 10.0, 60, (1.0, 2.0)))[-1]
    small = rolled(discs(10.0, 30.0, 180, (2.0, 1.0), driven="B"))[-1]
    depth = large.entering.max()
    # What is met again begins a turn later, the longer one: it lags by up to half of what the
    # first pass wears more than the last one; and the tolerance of the stepping.
    lag = 0.5 * np.abs(large.gained).max()
    assert np.abs(large.entering - small.entering).max() < lag + 3e-3 * depth
    assert large.contact.Qx == pytest.approx(-small.contact.Qx, rel=1e-3)  # as the tolerance
    turns = {"large": large.contact.scene.turns, "small": small.contact.scene.turns}
    of = {
        (name, body): turns[name].depth_behind(body, state.entering, state.leaving).max()
        for name, state in (("large", large), ("small", small))
        for body in "AB"
    }
    # One pass in 60 counts with one ratio of turns, or with the other.
    assert of["large", "A"] == pytest.approx(of["small", "B"], rel=2 / 60)
    assert of["large", "B"] == pytest.approx(of["small", "A"], rel=2 / 60)


def test_resumed(tmp_path):
    """A roll that continues from the file of a shorter one equals an uninterrupted roll."""
    whole = discs(30.0, 12.0, 40, save=[0, 15, 40])
    roll = ts.roll(whole)
    path = tmp_path / "part.h5"
    ts.roll(whole.replace(**{"wear.revolutions": 15, "wear.save": [0, 15]}), path)
    resumed = ts.roll(whole, path, resume=True)
    for name in ("wear_profile", "wear_profile_B", "Qx", "jump"):
        np.testing.assert_array_equal(resumed[name], roll[name])


def test_explain_reports_whose_revolutions_are_counted():
    """And how often the other body turns."""
    for radii, known in (((30.0, 12.0), ("A", "2.5")), ((math.inf, 40.0), ("B", "only once"))):
        scene = discs(*radii, 3).replace(grid=None)
        (wear,) = (section for section in explain(scene) if section.title == "Wear")
        reported = dict(wear.rows)["turns"]
        assert all(word in reported for word in known)


def test_depths_of_the_bodies_add_up_to_what_enters_and_what_is_worn():
    """Before the revolution, in it, and by block, in proportion to shares and turns."""
    last = rolled(discs(30.0, 10.0, 3, (1.0, 2.0), stepping="every-revolution"))[-1]
    before, added = np.sum([last.worn_depths(body) for body in "AB"], axis=0)
    limits = {"rtol": 1e-12, "atol": 1e-12 * last.entering.max()}  # rounding
    np.testing.assert_allclose(before, last.entering, **limits)
    np.testing.assert_allclose(added, last.gained, **limits)
    np.testing.assert_allclose(last.worn_parts.sum(axis=(0, 1)), last.entering, **limits)
    A, B = last.worn_depths("A")[0], last.worn_depths("B")[0]
    # B is half as hard to wear off and turns three times as often.
    np.testing.assert_allclose(B, 1.5 * A, **limits)
