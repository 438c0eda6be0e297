"""The balance of wear with the work of friction, as a history reports it."""

from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.mechanics.wear import Archard
from tractive_sam.results import describe_balances

DISCS = ("grid.half_length=[0.35, 0.7]", "grid.elements=[21, 31]", "wear.revolutions=20")
STUCK = "creepage.longitudinal=-1e-4"
"""Two per cent of full slip."""


def rolled(*settings):
    scene = ts.Scene.builtin("twin-discs").replace(subsurface=None)
    return ts.roll(scene.with_set([*DISCS, *settings]))


def reported(history):
    return describe_balances(history, only_if_open=True)


@pytest.mark.parametrize(
    "settings",
    [
        (),
        (STUCK,),
        (STUCK, 'wear.stepping="every-revolution"'),
        ("creepage.longitudinal=0.0", "creepage.spin=1e-4"),
        (STUCK, "body.B.young=150e3"),
        (STUCK, "friction.mu=0.6", "wear.intensity=2e-6"),
        ("wear.intensity=[1e-6, 2e-6]",),
    ],
)
def test_wear_and_work_are_balanced(settings):
    history = rolled(*settings)
    assert history.finished
    assert np.isnan(history.wear_balance[0])  # the unworn bodies
    # Elements with negative work, which do not wear: none or few.
    np.testing.assert_allclose(history.wear_balance[1:], 1.0, rtol=1e-4)
    np.testing.assert_allclose(history.energy_balance, 1.0, rtol=1e-9)
    assert not reported(history)
    assert history.to_dict()["wear_balance"][0] is None


def test_the_papers_slip_misses_work_but_not_wear():
    history = rolled('solver.slip="upwind"')
    # To the residual of the contact: traction opposes the slip that wears.
    np.testing.assert_allclose(history.wear_balance[1:], 1.0, rtol=1e-6)
    assert history.energy_balance.max() < 0.98
    assert reported(history).keys() == {"energy"}


def test_wear_beyond_the_work_is_reported(monkeypatch):
    """By the pressure, elements that stick beside one that slips wear as if they slipped."""
    law = Archard((2e-6, 1e-6), np.pi / 4)
    monkeypatch.setattr(Model, "wear_law", law)
    history = rolled(STUCK)
    assert history.wear_balance[-1] > 1.5
    assert reported(history).keys() == {"wear"}


def test_wear_within_what_the_work_can_wear_is_not():
    """i/mu of 5e-6 and 2e-5 along the axes: sections between may all be right."""
    history = rolled("wear.intensity=[3e-6, 6e-6]")
    work = history["dissipation"]

    def balance(per_work):
        values = history.values | {"worn_area": per_work * work}
        return replace(history, values=values).wear_balance[1:]

    for per_work, expected in ((1e-5, 1.0), (4e-6, 0.8), (3e-5, 1.5)):
        np.testing.assert_allclose(balance(per_work), expected, rtol=1e-12)


def test_without_wear_there_is_no_balance():
    history = ts.roll(ts.Scene.builtin("spheres").replace(subsurface=None))
    assert np.isnan(history.wear_balance).all()
    assert "wear" not in describe_balances(history)


@pytest.mark.slow
@pytest.mark.parametrize("shear", [1.0, 8.0], ids=["equal", "dissimilar"])
@pytest.mark.parametrize(
    "setting", ["friction.mu=1e-14", "creepage.longitudinal=-1e-15", "creepage.longitudinal=0.0"]
)
def test_rounding_is_no_work(shear, setting):
    scene = ts.Scene.builtin("spheres").replace(**{"subsurface": None, "body.B.shear": shear})
    history = ts.roll(scene.with_set(["grid.elements=[31, 31]", setting]))
    assert history.finished
    assert not reported(history)
