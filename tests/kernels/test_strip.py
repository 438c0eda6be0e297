"""Strip integrals against quadrature, and as the limit of long rectangles."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from tractive_sam.kernels import half_space

DX, DATUM = 0.7, 5.0
PLACES = [0.0, 0.1, 0.35, 0.36, 1.0, 8.0]


@pytest.mark.parametrize("x", PLACES)
def test_logarithm(x):
    """-2 ln(|x|/d) over the strip, with the integrable singularity in its place."""
    ends = sorted({-DX / 2, min(max(x, -DX / 2), DX / 2), DX / 2})
    truth = sum(
        quad(lambda s: -2 * np.log(abs(x - s) / DATUM), *part)[0] for part in pairwise(ends)
    )
    assert half_space.integrate_logarithm(x, DX, DATUM) == pytest.approx(truth, rel=1e-10)


@pytest.mark.parametrize(
    "integral",
    [lambda x, dx: half_space.integrate_logarithm(x, dx, DATUM), half_space.integrate_sign],
)
def test_a_split_strip_adds_up(integral):
    x = np.array([*PLACES, -0.2, -3.0, 1e4])
    halves = integral(x - DX / 4, DX / 2) + integral(x + DX / 4, DX / 2)
    np.testing.assert_allclose(integral(x, DX), halves, rtol=1e-13, atol=1e-13)


def test_parities():
    x = np.array(PLACES)
    np.testing.assert_array_equal(
        half_space.integrate_logarithm(-x, DX, DATUM), half_space.integrate_logarithm(x, DX, DATUM)
    )
    np.testing.assert_array_equal(
        half_space.integrate_sign(-x, DX), -half_space.integrate_sign(x, DX)
    )


def test_far_away_it_is_the_line_load():
    """Next term (dx/x)²/24, times 2 dx; the difference of antiderivatives alone would lose it."""
    x = 1e3 * DX
    assert half_space.integrate_logarithm(x, DX, x) == pytest.approx(
        DX * (DX / x) ** 2 / 12, rel=1e-3
    )


def test_long_rectangles_tend_to_strips():
    """Relative to the datum, which removes the constant that a long load adds everywhere.

    The rest falls with distance over length, in some of them with its square.
    """
    x = np.array(PLACES)
    errors = []
    for length in (1e4, 1e5):
        at = [half_space.integrals(place, 0.0, DX, length) for place in x]
        r1, xx, yy, xy, x2, y2 = np.transpose(at)
        far = half_space.integrals(DATUM, 0.0, DX, length)
        log = half_space.integrate_logarithm(x, DX, DATUM) - half_space.integrate_logarithm(
            DATUM, DX, DATUM
        )
        assert np.abs([xy, y2]).max() < 1e-16 * length  # rounding of corners that far away
        errors.append(
            max(
                np.abs(r1 - far[0] - log).max(),
                np.abs(xx - far[1]).max(),
                np.abs(yy - far[2] - log).max(),
                np.abs(x2 - half_space.integrate_sign(x, DX)).max(),
            )
        )
    assert errors[0] < 1e-2
    assert errors[1] < 0.15 * errors[0]
