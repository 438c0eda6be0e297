"""Steps of error control, and the stops that wrap it, on a curve with a known error."""

from itertools import pairwise

import pytest

from tractive_sam.rolling.process import LONGEST_GROWTH, ErrorControl, Stops

END = 10**5


def walk(stops, error_of, approach=1.0, settled=1):
    """Every accepted step from 0 to the end, and how many were refused."""
    control, here, wish, steps, refused = Stops(ErrorControl(3), stops, approach), 0, 1, [], 0
    while here < stops[-1]:
        step = control.first(here, wish, settled)
        while (error := error_of(here, step.length)) > 1.0 and step.length > 1:
            step = control.shorter(step, error)
            refused += 1
        here += step.length
        wish = control.next(step, error)
        steps.append(step)
    assert here == stops[-1]
    return steps, refused


def of_order_three(scale):
    return lambda here, length: (length / scale(here)) ** 3


def test_steps_are_as_long_as_their_error_allows():
    steps, refused = walk((END,), of_order_three(lambda here: 100.0))
    assert refused == 0
    lengths = [step.length for step in steps]
    assert all(b <= LONGEST_GROWTH * a for a, b in pairwise(lengths))
    # Integer steps: by rounding down, and by the safety of 0.8, a little shorter than 100.
    assert 70 <= lengths[20] <= 80


def test_a_refused_step_is_not_tried_again_and_does_not_grow():
    control = Stops(ErrorControl(3), (END,))
    step = control.first(0, 1000, 1)
    shorter = control.shorter(step, 27.0)
    assert shorter.length == pytest.approx(0.8 * 1000 / 3, abs=1)
    assert control.next(shorter, 1e-9) == shorter.length


def test_after_a_drop_of_the_scale_one_step_is_refused():
    """What was refused is not the wish of the step after it."""
    _, refused = walk((END,), of_order_three(lambda here: 300.0 if here < END / 2 else 100.0))
    assert refused == 1


def test_what_a_stop_cuts_short_continues_as_wished():
    control = Stops(ErrorControl(3), (10, END))
    step = control.first(0, 400, 1)
    assert step.length == 10
    assert control.next(step, 1e-9) == 400


def test_stops_are_met_exactly_and_cost_little():
    stops = (7, 1000, 1003, END)
    free, _ = walk((END,), of_order_three(lambda here: 100.0))
    steps, refused = walk(stops, of_order_three(lambda here: 100.0))
    met, here = set(), 0
    for step in steps:
        here += step.length
        met.add(here)
    assert met >= set(stops)
    assert refused == 0
    assert len(steps) <= len(free) + 2 * len(stops)


def test_steps_towards_a_stop_get_shorter_until_they_are_settled():
    control = Stops(ErrorControl(3), (1000,), 0.25)
    assert control.first(0, 900, 20).length == 250
    assert control.first(970, 900, 20).length == 20
    assert control.first(985, 900, 20).length == 15


def test_units_other_than_one():
    """A distance, in halves of a length."""
    control = Stops(ErrorControl(3, unit=0.5), (3.25,))
    assert control.next(control.first(0.0, 1.0, 0.5), 1.0) == 0.5
    assert control.first(3.0, 1.0, 0.5).length == 0.25
