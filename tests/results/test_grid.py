"""The mesh: a line contact has elements along x only."""

import pytest

from tractive_sam.results import Grid


@pytest.mark.parametrize(
    ("half_length", "elements", "text"),
    [((2.0,), (40,), "40 elements"), ((2.0, 3.0), (40, 30), "40 x 30 elements")],
)
def test_directions_sides_and_size(half_length, elements, text):
    grid = Grid.from_half_lengths(half_length, elements)
    assert grid.directions == len(elements)
    assert grid.line == (len(elements) == 1)
    expected = [2.0 * half / count for half, count in zip(half_length, elements, strict=True)]
    assert grid.sides == pytest.approx(expected, rel=1e-15)  # one formula, except for rounding
    assert grid.describe_size() == text
