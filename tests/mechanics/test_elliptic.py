import numpy as np
import pytest
from scipy import special

from tractive_sam.mechanics.elliptic import elliprd, elliprf

DECADES = np.logspace(-12, 12, 49)


@pytest.mark.parametrize(
    ("own", "known"), [(elliprf, special.elliprf), (elliprd, special.elliprd)], ids=["RF", "RD"]
)
def test_of_ellipses_from_a_circle_to_a_line(own, known):
    found = [own(0.0, one, 1.0 / one) for one in DECADES]
    np.testing.assert_allclose(found, known(0.0, DECADES, 1.0 / DECADES), rtol=2e-15)  # rounding


def test_integrals_of_three_numbers():
    for x, y, z in np.random.default_rng(1).uniform(0.1, 10.0, (20, 3)):
        assert elliprf(x, y, z) == pytest.approx(elliprf(z, x, y), rel=2e-15)  # rounding
        # R_D(x, y, z) + R_D(y, z, x) + R_D(z, x, y) = 3 / sqrt(x y z), DLMF 19.21.8
        whole = elliprd(x, y, z) + elliprd(y, z, x) + elliprd(z, x, y)
        assert whole == pytest.approx(3.0 / np.sqrt(x * y * z), rel=2e-15)  # rounding
