"""Wear of line contacts: one profile, which nothing changes."""

import math

import numpy as np
import pytest

from tractive_sam.contact import Model, equilibrium
from tractive_sam.rolling.passage import wear_response
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene

REVOLUTIONS = 40
WEAR = {"intensity": 1e-6, "revolutions": REVOLUTIONS}


def worn(stepping):
    tables = {"wear": WEAR | {"stepping": stepping}, "subsurface": None}
    scene = Scene.builtin("cylinders").replace(**tables)
    grid = {"grid.half_length": 1.1 * scene.hertz.a, "grid.elements": 65}
    return scene.replace(**grid)


def test_every_revolution_and_jumps_agree():
    """Depth grows by i |Q_x xi_x| / mu a revolution, and everything else stays."""
    one_by_one, jumps = (roll(worn(stepping)) for stepping in ("every-revolution", "adaptive"))
    assert one_by_one.finished
    assert jumps.finished
    assert len(jumps) < len(one_by_one) == REVOLUTIONS + 1
    depth = one_by_one["wear_profile"][-1, 0]
    assert jumps["wear_profile"][-1, 0] == pytest.approx(depth, rel=1e-6)
    # From the second contact on: the first has no wear within the pass.
    Q_x = one_by_one["Qx"]
    assert depth == pytest.approx(REVOLUTIONS * 1e-6 * Q_x[1] * 0.002 / 0.3, rel=1e-6)
    assert Q_x[-1] == pytest.approx(Q_x[1], rel=1e-6)
    assert one_by_one["half_width_y"][-1] == math.inf
    assert jumps.to_dict()["half_width_y"][-1] is None


@pytest.mark.slow
@pytest.mark.parametrize("grid", [{}, {"grid": None}])
def test_resumed(tmp_path, grid):
    """A roll that continues from the file of a shorter one equals an uninterrupted roll."""
    path, whole = tmp_path / "line.h5", worn("every-revolution").replace(**grid)
    roll(whole.replace(**{"wear.revolutions": 7}), path)
    resumed, truth = roll(whole, path, resume=True), roll(whole)
    np.testing.assert_array_equal(resumed["wear_profile"], truth["wear_profile"])
    np.testing.assert_array_equal(resumed["Qx"], truth["Qx"])


def test_wear_of_one_row_does_not_answer_itself():
    """At constant load a uniform depth only moves the bodies closer."""
    model = Model(worn("adaptive"))
    response = wear_response(model, equilibrium(model))
    assert response.shape == (1, 1)
    assert abs(response[0, 0]) < 1e-12
