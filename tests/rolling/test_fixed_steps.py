"""Jumps to each saved revolution: as accurate as adaptive jumps, and smooth."""

import numpy as np
import pytest

import tractive_sam as ts


@pytest.fixture(scope="module")
def discs():
    wear = {"coefficient": {"A": 1.3e-4, "B": 2.2e-4}, "revolutions": 3000, "turns": "equal"}
    scene = ts.Scene.builtin("twin-discs").replace(subsurface=None, wear=wear)
    return scene.replace(**{"grid.elements": (13, 27)})


def test_fixed_steps_are_those_of_save(discs):
    adaptive = ts.roll(discs, progress=False)
    steps = tuple(adaptive["revolution"].tolist())
    fixed = ts.roll(discs.replace(**{"wear.stepping": "saved", "wear.save": steps}), progress=False)
    assert fixed.finished
    assert fixed["revolution"].tolist() == list(steps)
    # The tolerance of the stepping is 1e-3 of the depth.
    assert fixed["worn_mass"][-1] == pytest.approx(adaptive["worn_mass"][-1], rel=1e-3)


def test_fixed_steps_leave_no_noise_in_the_wear(discs):
    """The wear is smooth over the coefficient: differences of third order nearly vanish."""
    steps = (0, 1, 2, 4, 8, 16, 30, 60, 120, 240, 480, 1000, 2000, 3000)
    fixed = discs.replace(**{"wear.stepping": "saved", "wear.save": steps})
    masses = [
        ts.roll(fixed.replace(**{"wear.coefficient.A": 1.3e-4 * (1.0 + one)}), progress=False)[
            "worn_mass"
        ][-1, 0]
        for one in (-0.015, -0.005, 0.005, 0.015)
    ]
    # Adaptive steps leave 1e-4.
    assert abs(np.diff(masses, 3)[0]) < 2e-5 * masses[0]


def test_the_first_jump_has_the_rate_of_the_bodies_as_they_are(discs):
    """A jump from the unworn bodies wears as ten revolutions, not from a rate of zero."""
    wear = {"wear.revolutions": 10, "wear.save": (0, 10)}
    jumped = ts.roll(discs.replace(**wear, **{"wear.stepping": "saved"}), progress=False)
    each = ts.roll(discs.replace(**wear, **{"wear.stepping": "every-revolution"}), progress=False)
    assert jumped["revolution"].tolist() == [0, 1, 10]
    # Two jumps of an implicit formula of second order.
    assert jumped["worn_mass"][-1] == pytest.approx(each["worn_mass"][-1], rel=1e-3)
