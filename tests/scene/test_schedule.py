"""The coordinate along which a scene is solved, its end, and the places of stored fields."""

import pytest

import tractive_sam as ts

SPHERES = ts.Scene.builtin("spheres")
WORN = {"coefficient": 1e-4, "revolutions": 20, "save": [0, 5]}


def test_one_contact_is_solved_at_the_start_only():
    schedule = SPHERES.schedule
    assert (schedule.end, schedule.stops, schedule.adaptive) == (0, (0,), False)
    assert schedule.message_start == ""


def test_wear_is_rolled_to_its_last_revolution_whether_that_is_saved_or_not():
    schedule = SPHERES.replace(wear=WORN).schedule
    assert schedule.revolves
    assert schedule.stops == (0, 5, 20)
    assert 5 in schedule
    assert 20 not in schedule


@pytest.mark.parametrize(("start", "rolls"), [("rest", True), ("shift", False)])
def test_a_transient_goes_along_its_distance_and_wears(start, rolls):
    transient = {"distance": [0, 2, 5], "start": start, "load": {"normal": [0.1, 0.4, 0.2]}}
    scene = SPHERES.replace(transient=transient)
    schedule = scene.schedule
    assert (schedule.end, schedule.save) == (5, (0, 2, 5))
    assert (schedule.rolls, schedule.shifts, schedule.revolves) == (rolls, not rolls, False)
    assert schedule.courses == {"load.normal": (0.1, 0.4, 0.2)}
    assert scene.under_largest_load.load.normal == 0.4
    assert scene.under_largest_load.schedule.end == 0


@pytest.mark.parametrize(
    ("key", "given"),
    [
        ("friction.mu", True),
        ("wear", False),
        ("wear.temperature", False),
        ("duty", False),  # empty
        ("schedule.shifts", False),  # a property that does not hold
        ("schedule.rolls", True),
        ("no.such.key", False),
    ],
)
def test_a_scene_has_what_is_given(key, given):
    assert SPHERES.has(key) is given
