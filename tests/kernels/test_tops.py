"""Local maxima of layers, and the ways up to tops."""

import numpy as np
import pytest

from tractive_sam.kernels.tops import ENDED, GOES_ON, LOST, climb, find_tops, stencil

NONE = np.empty((1, 0, 0))
TOP = np.array((0.3, -0.2, 1.3))
TURNED = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
CURVED = TURNED @ np.diag((-1.0, -0.4, -0.1)) @ TURNED.T


def hill(points):
    """A parabola of value 2 at its top."""
    aside = points - TOP
    return 2.0 + 0.5 * np.einsum("...i,ij,...j", aside, CURVED, aside)


def step(at, function=hill, floor=0.1, least=0.0, barred=False, first=True, of=None, highest=1e3):
    """Return paths after one step: places, states, whether barred, and values."""
    at = np.array(at, dtype=float)
    count = len(at)
    of = np.zeros(count, dtype=int) if of is None else np.array(of)
    bars, best = np.full(count, barred), np.zeros(of.max() + 1)
    values = function(stencil(at))
    bounds = np.full(count, highest), np.full(count, least)
    fates = climb(at, bars, best, values, of, *bounds, floor, first)
    return at, fates, bars, values[:, 0]


def test_a_step_leads_to_the_top_of_a_parabola():
    (at,), (fate,), _, (value,) = step([TOP + np.array((0.2, 0.1, -0.3))])
    np.testing.assert_allclose(at, TOP, atol=1e-9)  # differences of values of order one
    assert value == pytest.approx(2.0, abs=1e-12)
    assert fate == GOES_ON  # it gained too much to be sure


def test_a_path_ends_where_nothing_is_gained():
    _, (fate,), _, _ = step([TOP + 1e-3])
    assert fate == ENDED


def test_steps_are_at_most_half_the_depth():
    start = np.array((5.0, 5.0, 1.0))
    (at,), _, _, _ = step([start])
    assert np.linalg.norm(at - start) == pytest.approx(0.5)
    assert hill(at) > hill(start)


def test_uphill_where_it_curves_upwards():
    (at,), _, _, _ = step([(0.2, 0.1, 1.0)], lambda p: p[..., 0] ** 2 - p[..., 1] ** 2 + p[..., 2])
    assert at[0] > 0.2
    assert at[1] < 0.1
    assert at[2] > 1.0


def test_along_the_floor_where_that_is_an_obstacle():
    floor = 2.0  # below the top
    (at,), (fate,), (barred,), _ = step([(0.5, 0.0, floor)], floor=floor)
    assert at[2] == floor
    assert fate == GOES_ON
    assert not barred
    within = TOP[:2] - np.linalg.solve(CURVED[:2, :2], CURVED[:2, 2] * (floor - TOP[2]))
    np.testing.assert_allclose(at[:2], within, atol=1e-9)
    # Below a higher surface a path is tried once, unless the value falls steeply from the start.
    wide = {"floor": floor, "least": 3.0}
    _, (fate,), _, _ = step([(0.5, 0.0, floor)], **wide)
    assert fate == LOST
    flat = lambda points: 2.0 - 0.03 * np.linalg.norm(points - TOP, axis=-1) ** 2  # noqa: E731
    _, (fate,), (barred,), _ = step([(0.5, 0.0, floor)], flat, **wide)
    assert (fate, barred) == (GOES_ON, True)
    _, (fate,), _, _ = step([(0.5, 0.0, floor)], flat, **wide, barred=True, first=False)
    assert fate == LOST


def test_of_paths_to_one_maximum_the_highest_continues():
    starts = [
        TOP + np.array((0.4, 0.0, 0.0)),
        TOP + np.array((0.3, 0.0, 0.0)),
        TOP + np.array((-0.3, 0.1, 0.0)),
    ]

    def uneven(points):
        return hill(points) + 1e-3 * points[..., 0] ** 3

    _, fates, _, values = step(starts, uneven)
    assert (fates == GOES_ON).sum() == 1
    assert fates[values.argmax()] == GOES_ON
    _, fates, _, _ = step(starts, uneven, of=(0, 1, 2))
    assert (fates == GOES_ON).all()


def test_a_path_that_cannot_reach_where_another_ended_is_given_up():
    starts = [TOP + 1e-3, TOP + np.array((0.9, 0.0, 0.0))]
    for highest, fate in ((1.99, LOST), (2.01, GOES_ON)):
        _, fates, _, _ = step(starts, highest=highest)
        assert tuple(fates) == (ENDED, fate)


def layer(nx, ny, tops):
    """Bumps (x, y, height) two steps wide."""
    x, y = np.mgrid[:nx, :ny]
    bumps = [h * np.exp(-((x - a) ** 2 + (y - b) ** 2) / 8.0) for a, b, h in tops]
    return np.sum(bumps, axis=0)[None]


def test_finds_the_tops_between_the_points():
    values = layer(24, 32, [(5.3, 6.8, 1.0), (16.6, 22.1, 0.5)])
    found = find_tops(values, NONE, NONE)
    assert len(found) == 2
    np.testing.assert_allclose(
        found[:, 2:4], [(5.3, 6.8), (16.6, 22.1)], atol=0.02
    )  # not parabolas
    assert not found[:, [0, 4]].any()


def test_compares_with_the_stored_layers():
    values = layer(24, 32, [(5.3, 6.8, 1.0), (16.6, 22.1, 0.5)])
    coarse = 0.25 * sum(values[:, i::2, j::2] for i in (0, 1) for j in (0, 1))
    assert len(find_tops(values, NONE, 0.8 * coarse)) == 2
    assert len(find_tops(values, 1.2 * values, 0.8 * coarse)) == 0
    assert len(find_tops(0.8 * coarse, values, NONE)) == 0
    between = find_tops(values, 0.6 * values, 0.9 * values)[:, 4]
    # 0.6, 1, 0.9: the parabola's top is 0.3 below the middle.
    np.testing.assert_allclose(between, 0.3)


def test_of_equal_values_one_is_the_top():
    assert len(find_tops(np.ones((2, 9, 7)), np.empty((2, 0, 0)), np.empty((2, 0, 0)))) == 2
    assert len(find_tops(np.zeros((1, 9, 7)), NONE, NONE)) == 0
