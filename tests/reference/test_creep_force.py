import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tractive_sam.reference import (
    creep_parameter,
    kalker_simplified,
    vermeulen_johnson,
    vermeulen_johnson_inverse,
)

CURVES = pytest.mark.parametrize("curve", [vermeulen_johnson, kalker_simplified])


@CURVES
def test_grows_from_zero_and_saturates_at_full_slip(curve):
    xi = np.linspace(0, 1, 201)
    assert curve(0.0) == 0
    assert np.all(np.diff(curve(xi)) > 0)
    assert curve(1.0) == 1
    assert np.all(curve([1.5, 40.0]) == 1)


@CURVES
def test_meets_full_slip_smoothly(curve):
    assert 1 - curve(1 - 1e-4) < 1e-5


@CURVES
def test_odd(curve):
    xi = np.linspace(0, 2, 50)
    np.testing.assert_array_equal(curve(-xi), -curve(xi))


@pytest.mark.parametrize(
    ("curve", "slope"), [(vermeulen_johnson, 3), (kalker_simplified, 0.75 * math.pi)]
)
def test_initial_slope_keeps_its_digits(curve, slope):
    assert curve(1e-12) == pytest.approx(slope * 1e-12, rel=1e-11)


@given(st.floats(0, 1))
def test_paper_formulas(xi):
    assert vermeulen_johnson(xi) == pytest.approx(1 - (1 - xi) ** 3, abs=1e-15)
    plain = 1.5 * xi * math.acos(xi) + 1 - (1 + xi**2 / 2) * math.sqrt(1 - xi**2)
    assert kalker_simplified(xi) == pytest.approx(plain, abs=1e-15)


@given(st.floats(-1, 1))
def test_inverse(ratio):
    assert vermeulen_johnson(vermeulen_johnson_inverse(ratio)) == pytest.approx(ratio, rel=1e-14)


def test_inverse_of_what_friction_cannot_carry():
    with pytest.raises(ValueError, match=r"Q/\(mu P\)"):
        vermeulen_johnson_inverse([0.5, 1.01])


def test_driving_creepage_has_a_positive_parameter():
    xi = creep_parameter([-0.0031, 0.0031], shear=1.0, a=3.5, mu=0.4, load=0.47, poisson=0.28)
    assert xi[0] == -xi[1] > 0
    assert xi[0] == pytest.approx(0.0031 * 16 * 3.5**2 / (3 * 0.4 * 0.47 * (4 - 3 * 0.28)))


def test_published_curves(published):
    rows = published["creep_force_curve_spheres"]["rows"]
    xi = [row["xi"] for row in rows]
    johnson, kalker, computed = (
        [row[key] for row in rows] for key in ("vermeulen_johnson", "kalker_eq42", "mesh_limit")
    )
    np.testing.assert_allclose(vermeulen_johnson(xi), johnson, atol=6e-5)
    np.testing.assert_allclose(kalker_simplified(xi), kalker, atol=6e-5)
    # the two approximations enclose the half-space solution, within its error of 1e-3
    assert np.all(kalker_simplified(xi) < np.add(computed, 1e-3))
    assert np.all(vermeulen_johnson(xi) > np.subtract(computed, 1e-3))
