"""Places at which nodes are added, and the end of a build, on laws with a closed form."""

from functools import partial

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.lookup import creepages_at
from tractive_sam.tables.builder import TableBuilder
from tractive_sam.tables.design import Solved
from tractive_sam.tables.solving import Batch, Refinement, TableContacts

REFINEMENT = Refinement()

RATIO = {"key": "friction.mu", "name": "mu2_over_mu1",
         "values": [[0.3, 0.15], [0.3, 0.3]], "at": [0.5, 1.0]}  # fmt: skip


def force(weights, place, w):
    """Return a force that bends sharply at full slip, which depends on creepages by weights."""
    w = np.asarray(w) * weights(place)
    size = np.linalg.norm(w)
    return -w / size * (1.0 - max(1.0 - 1.2 * size, 0.0) ** 2) if size > 0.0 else np.zeros(3)


def solve(weights, jobs):
    """Solves jobs by that law, slopes by differences."""
    found = []
    for one in jobs:
        w, law = np.array(one.w), partial(force, weights, one.place)
        h = 1e-6 * max(1.0, np.abs(w).max())
        slopes = [(law(w + step) - law(w - step)) / (2.0 * h) for step in h * np.eye(3)]
        found.append(Solved(law(w), np.full(3, 1e-6), np.array(slopes).T))
    yield 0, Batch(found, len(found), 0.0)


def builder(weights, tolerance, seed):
    design = ts.TableDesign(axis=[RATIO], tolerance=tolerance, seed=seed)
    contacts = TableContacts(design, partial(solve, weights), lambda _: None, REFINEMENT)
    return TableBuilder(contacts)


def built(weights, tolerance, seed):
    table = builder(weights, tolerance, seed).build()
    random = np.random.default_rng(5)
    points = np.array([random.uniform(*axis[[0, -1]], 2000) for axis in table.law.axes]).T
    exact = [force(weights, one[:3], creepages_at(1.0, *one[3:])) for one in points]
    return table, np.abs(table.law(list(points.T)).T - exact).max(axis=1)


def orthotropic(place):
    """So that friction is used up at another u of each heading and tilt."""
    return np.array([1.0, 0.3 + 0.4 * place[2], 0.8])


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_nodes_are_added_until_points_anywhere_are_within_the_tolerance(seed):
    table, off = built(orthotropic, 5e-3, seed)
    assert off.max() <= 5e-3
    # 6,600 and 5,500; with each axis divided once more there would be 16 times as many.
    assert table.nodes < 8000


@pytest.mark.slow
def test_a_table_ends_when_points_that_it_has_not_seen_find_nothing():
    """Nodes lie at points that requested them: these alone would say too little about other
    points."""
    one = builder(orthotropic, 5e-3, 0)
    table = one.build()
    assert len(one.check_points) >= 2 * REFINEMENT.anywhere  # the first led to nodes
    unseen = one.check_points[-REFINEMENT.anywhere :]
    assert np.abs(one.errors_at(table, unseen)).max() <= REFINEMENT.miss * 5e-3
    assert len(set(one.check_points)) == len(one.check_points)
    assert table.about["held_out_worst"] <= 5e-3


def test_held_out_points_leave_no_gap():
    """A cell of three axes, of 125, holds eight of a thousand of them."""
    one = builder(orthotropic, 5e-3, 0)
    points = np.array(one.points_at_shares(one.anywhere.random(REFINEMENT.anywhere)))[:, 3:]
    low, high = (np.array([axis[k] for axis in one.axes[3:]]) for k in (0, -1))
    cells = np.floor(5 * (points - low) / (high - low)).astype(int)
    counts = np.unique(cells @ [25, 5, 1], return_counts=True)[1]
    # Of random points the variance would be eight, and some cells would be as good as empty.
    assert len(counts) == 125
    assert counts.var() < 4.0


def test_nodes_are_added_along_the_axis_that_is_to_blame():
    """Equal at all headings and tilts except for cosines: only u requires nodes."""
    table, off = built(lambda _: np.array([1.0, 1.0, 0.5]), 3e-3, 0)
    first = builder(None, 3e-3, 0).axes
    grown = [len(axis) > len(few) for axis, few in zip(table.law.axes, first, strict=True)]
    assert off.max() <= 3e-3
    assert grown == [False, False, False, False, False, True]


def test_intervals_that_stay_are_judged_by_the_same_points():
    """New ones in each round would find ever worse ones, and never end."""
    one = builder(orthotropic, 5e-3, 0)
    table = one.make_table([np.zeros((max(len(axis) - 1, 0), 3)) for axis in one.axes])
    for first, again in zip(one.interval_errors(table), one.interval_errors(table), strict=True):
        np.testing.assert_array_equal(first, again)


def test_tables_are_updated_without_solving_their_nodes_again():
    """Slopes at rest and checks of gradients are solved; the other nodes come from the file."""
    table = builder(orthotropic, 0.05, 0).build()
    requested = []

    def count(jobs):
        requested.extend(jobs)
        return solve(lambda place: 1.1 * orthotropic(place), jobs)

    one = builder(orthotropic, 0.05, 0)
    one.contacts.solver = count
    updated = one.update(table)
    assert all(job.finer or not any(job.w) for job in requested)
    new, old = (each.law.coefficients for each in (updated, table))
    # Rounding: slopes in full slip are computed from the others again.
    np.testing.assert_allclose(new[..., 1:, :4, :][..., [0], :], old[..., 1:, :4, :][..., [0], :])
    np.testing.assert_allclose(new[..., 0, 1, :], 1.1 * old[..., 0, 1, :], atol=1e-6)
    assert updated.about["contacts"] > table.about["contacts"]
    assert updated.gradient_bars.shape == (len(table.law.axes[-1]), 3, 3)
