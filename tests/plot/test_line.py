"""Figures of line contacts: functions of x."""

import pytest

from tests.plot import strip_theory as strips
from tests.plot.rendering import render
from tests.plot.test_figures import labels
from tractive_sam import plot
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene

OF_A_STATE = (plot.line_pressure, plot.line_traction, plot.line_slip)


@pytest.fixture(scope="module")
def history():
    scene = Scene.builtin("cylinders").replace(
        **{
            "grid.half_length": 0.42,
            "grid.elements": 65,
            "creepage.lateral": 0.001,
            "wear": {"intensity": 1e-6, "revolutions": 10},
        }
    )
    return roll(scene)


@pytest.mark.parametrize("draw", OF_A_STATE)
def test_figures_of_a_state(draw, history):
    figure = render(draw(history, 10))
    assert "$x/a_0$, leading edge right" in labels(figure)
    assert history.title in figure.get_suptitle()


def test_slip_is_plotted_in_both_directions(history):
    names = {text.get_text() for text in render(plot.line_slip(history)).legends[0].get_texts()}
    assert names == {"$s_x/V$", "$s_y/V$"}


def test_pressures_of_the_stored_revolutions(history):
    figure = render(plot.line_pressures(history))
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["0", "10"]


def test_numbers_are_labelled_per_length(history):
    (axes,) = plot.compare({"one": history}, "Qx").axes
    assert axes.get_ylabel().endswith("per length (N/mm)")
    both = {"line": history, "other": strips.history()}
    assert plot.compare(both, "Qx_over_P").axes
    with pytest.raises(ValueError, match="Qx"):
        plot.compare(both, "Qx")


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_save_all_draws_no_maps(history, tmp_path):
    names = {path.stem for path in plot.save_all(history, tmp_path)}
    render = ("pressure", "traction", "slip", "von-mises-y0")
    of_states = {f"{name}-{N}" for name in render for N in (0, 10)}
    assert names == of_states | {
        "forces",
        "widths",
        "wear-depth",
        "worn-mass",
        "von-mises-max",
        "pressure-profiles",
    }
