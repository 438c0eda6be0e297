"""What is left of a roll is foreseen by the contacts that it took, not by revolutions."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.rolling import Forecast

COLUMNS = ("revolution", "jump", "solves", "seconds")

MESH = ("grid.half_length=[0.35, 1.4]", "grid.elements=[21, 61]")


def foreseen(history):
    """Contacts done and foreseen, and those that were left, with each record."""
    forecast, total = Forecast(history.scene), history["solves"].sum()
    columns = [*(history[name] for name in COLUMNS), history["wear_max"] / history["approach"]]
    for numbers in zip(*(column.tolist() for column in columns), strict=True):
        forecast.add(*map(float, numbers))
        yield forecast.done / total, forecast.left, total - forecast.done


def all_revolutions(beta):
    """All revolutions of the discs on a coarse mesh."""
    settings = (*MESH, f"friction.angle={beta}")
    return pytest.param("twin-discs", settings, marks=pytest.mark.slow, id=f"{beta} degrees")


def spheres(coefficient, revolutions, *settings):
    worn = (f"wear.coefficient={coefficient}", f"wear.revolutions={revolutions}", *settings)
    return pytest.param("spheres", worn, id=f"spheres, {coefficient}")


SHORT = (20, 50, 200)
"""Revolutions of rolls that take about ten contacts."""

SMALL = ("grid.half_length=[4.5, 4.5]", "grid.elements=[41, 41]")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "settings"),
    [
        *map(all_revolutions, (0, 45, 90)),
        ("twin-discs", (*MESH, "wear.revolutions=500", "wear.save=[0, 500]")),
        ("twin-discs", (*MESH, "wear.revolutions=2000", "wear.save=[0, 2000]")),
        spheres(1e-4, 20000, "wear.save=[0, 500]"),
        spheres(10.0, 5000, *SMALL, "creepage.longitudinal=-0.005"),
        *(("twin-discs", (*MESH, f"wear.revolutions={n}", "wear.save=[0]")) for n in SHORT),
        ("twin-discs", (*MESH, "wear.revolutions=100", "wear.save=[0, 33, 50, 100]")),
        spheres(1e-3, 50, *SMALL, "wear.save=[0]"),
    ],
)
def test_within_a_factor_of_two_from_a_tenth_on(name, settings):
    scene = ts.Scene.builtin(name).replace(subsurface=None).with_set(settings)
    # The last contact may be foreseen as two.
    course = [one for one in foreseen(ts.roll(scene)) if one[0] >= 0.1 and one[2] > 1]
    ratios = [left / truly for _, left, truly in course]
    assert len(ratios) > 4  # or little is reported
    assert min(ratios) >= 0.5
    assert max(ratios) <= 2.0


def test_one_by_one_all_is_known():
    scene = ts.Scene.builtin("twin-discs").with_set(
        ["wear.revolutions=10", "wear.save=[0, 10]", 'wear.stepping="every-revolution"']
    )
    forecast = Forecast(scene)
    for revolution in range(11):
        forecast.add(revolution, 1.0, 1.0, 5.0 if revolution == 0 else 0.5)
        assert forecast.left == 10 - revolution
        # Of the first contact, which compiles, nothing is concluded for the others.
        assert forecast.remaining_seconds == (50.0 if revolution == 0 else 0.5 * forecast.left)


@pytest.mark.parametrize("wear", [None, {"coefficient": 1e-4}])
def test_steps_of_a_transient_are_those_of_its_courses(wear):
    forecast = Forecast(ts.Scene.builtin("fretting").replace(wear=wear))
    for k in range(51):  # of 0.1, from 0 to 5
        forecast.add(0.1 * k, 1.0, 1.0, 1.0)
        assert k == 0 or forecast.left == pytest.approx(50 - k)


def test_nothing_is_left_at_the_end_nor_without_wear():
    assert list(foreseen(ts.roll(ts.Scene.builtin("spheres"))))[-1][1:] == (0.0, 0.0)
    scene = ts.Scene.builtin("twin-discs")
    forecast = Forecast(scene)
    forecast.add(14999.0, 100.0, 1.0, 1.0)
    assert forecast.left == 1
    forecast.add(15000.0, 100.0, 1.0, 1.0)
    assert forecast.left == 0


def test_endless_rolls_are_foreseen_at_once():
    scene = ts.Scene.builtin("twin-discs").with_set(
        ["wear.revolutions=1000000000", "wear.save=[0]"]
    )
    forecast = Forecast(scene)
    forecast.add(1000.0, 1.0, 1.0, 1.0)
    assert np.isfinite(forecast.left)
    assert forecast.left > 1e5
