"""Samples over the revolutions, between which is interpolated."""

import pytest

from tractive_sam.run.error_bars import Sample
from tractive_sam.run.refined_runs import CoarseRun


def sample(value):
    return Sample({"Qx": value}, {"Qx": 1.0}, 1e-8)


def test_what_is_added_after_a_reading_counts():
    run = CoarseRun()
    for revolution in (0, 10, 20):
        run = run.with_sample(revolution, sample(float(revolution)))
    run.at(15)
    run = run.with_sample(100, sample(7.0))
    again = CoarseRun((0, 10, 20, 100), tuple(map(sample, (0.0, 10.0, 20.0, 7.0))))
    assert run.at(50).values["Qx"] == again.at(50).values["Qx"]
    assert run.at(101) is None
    assert run.at(100).values["Qx"] == pytest.approx(7.0)
