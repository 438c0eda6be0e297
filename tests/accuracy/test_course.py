"""Samples over the revolutions, between which is interpolated."""

import pytest

from tractive_sam.run.accuracy.course import Course
from tractive_sam.run.accuracy.error_bars import Sample


def sample(value):
    return Sample({"Qx": value}, {"Qx": 1.0}, 1e-8)


def test_what_is_added_after_a_reading_counts():
    course = Course()
    for revolution in (0, 10, 20):
        course.add(revolution, sample(float(revolution)))
    course.at(15)
    course.add(100, sample(7.0))
    again = Course()
    for revolution, value in ((0, 0.0), (10, 10.0), (20, 20.0), (100, 7.0)):
        again.add(revolution, sample(value))
    assert course.at(50).values["Qx"] == again.at(50).values["Qx"]
    assert course.at(101) is None
    assert course.at(100).values["Qx"] == pytest.approx(7.0)
