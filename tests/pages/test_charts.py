"""Charts of a report leave out positions that jump between neighbouring peaks."""

import numpy as np
import pytest

from tractive_sam.pages.data import jumps

COURSE = np.linspace(0.0, 1.0, 40)


@pytest.mark.parametrize(
    ("position", "jumping"),
    [
        (COURSE, False),
        (np.abs(COURSE - 0.5), False),  # there and back
        (np.where(np.arange(40) % 2, 1.0, -1.0), True),
        (np.append(COURSE[:20] * 0.0, COURSE[20:] * 0.0 + 1.0), False),  # once
        (np.zeros(40), False),
    ],
)
def test_positions_that_jump(position, jumping):
    assert jumps(position) == jumping
    assert jumps(-3.0 * position + 1.0) == jumping  # on any scale
