"""Error of damage by the error of the utilisation."""

import numpy as np
import pytest

import tractive_sam as ts


@pytest.mark.parametrize("exponent", [3.0, 10.0])
def test_the_error_of_damage_is_what_an_error_of_utilisation_makes(exponent):
    life = ts.Woehler(cycles=1e6, exponent=exponent)
    low, high = life.damage(np.array([0.8, 0.8 * 1.004]))
    assert life.relative_error(4e-3) == pytest.approx(high / low - 1.0, rel=1e-12)  # rounding
    assert life.relative_error(1e-9) == pytest.approx(exponent * 1e-9, rel=1e-6)
