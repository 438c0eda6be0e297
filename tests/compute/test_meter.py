"""Convolutions are counted wherever they are made, in applications of the tangential operator."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.compute import ConvolutionMeter
from tractive_sam.contact import Model

SPHERES = ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 25]"])


@pytest.fixture
def operators():
    return Model(SPHERES).operators


def test_an_application_of_the_tangential_operator_is_one(operators):
    meter = ConvolutionMeter(operators.lattice.padded)
    for _ in range(3):
        operators.slip(np.ones((2, 21, 25)))
    assert meter.convolutions == pytest.approx(3.0)  # a sum of integers over one


def test_a_clock_too_coarse_for_a_convolution_gives_no_time_over_it(operators, monkeypatch):
    monkeypatch.setattr("tractive_sam.compute.fft.process_time", lambda: 1.0)
    monkeypatch.setattr("tractive_sam.compute.host.process_time", lambda: 1.0)
    meter = ConvolutionMeter(operators.lattice.padded)
    operators.slip(np.ones((2, 21, 25)))
    assert np.isnan(meter.over_application)


def test_half_the_fields_count_half(operators):
    meter = ConvolutionMeter(operators.lattice.padded)
    operators.normal(np.ones((1, 21, 25)))
    assert meter.convolutions == pytest.approx(0.5)


def test_applications_of_three_fields_are_at_most_one_and_a_half():
    """Uzawa iterates without a preconditioner, on the pressure and both tractions."""
    plain = ts.solve(SPHERES.replace(**{"solver.method": "uzawa", "solver.tolerance": 1e-4}))
    count = plain.cost.applications + plain.cost.preconditioner
    assert 0.0 < plain.cost.convolutions <= 1.5 * count


def test_preconditioners_count():
    contact = ts.solve(SPHERES)
    frictionless = ts.solve(SPHERES.replace(friction=None, creepage=None))
    assert contact.cost.preconditioner > 0.0
    assert 0.0 < frictionless.cost.convolutions < contact.cost.convolutions


def test_a_history_records_them(tmp_path):
    discs = ts.Scene.builtin("twin-discs").replace(subsurface=None)
    discs = discs.with_set(["wear.revolutions=2", "wear.save=[2]", "grid.elements=[15, 31]"])
    history = ts.roll(discs, tmp_path / "discs.h5")
    assert (history["convolutions"] > 0.0).all()
    assert history.state(2).cost.convolutions == history["convolutions"][-1]
    rolling = {"transient": {"distance": [0.0, 0.1], "step": 0.02}}
    steps = ts.roll(SPHERES.replace(**rolling))
    assert (steps["convolutions"][1:] > 0.0).all()
    # Convolutions in single precision take no less than a quarter of the time.
    for one in (history, steps):
        assert (one["over_application"] > 0.25 * one["convolutions"])[1:].all()
