import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam import plot


@pytest.fixture(scope="module")
def locus():
    return ts.contact_locus(ts.Scene.builtin("wheel-rail"), np.linspace(-4.0, 4.0, 9))


def test_figures_of_a_locus(locus):
    scene = ts.Scene.builtin("wheel-rail")
    assert len(plot.contact_points(scene, locus).axes[0].lines) == 2 + locus.y.size
    assert len(plot.radius_difference(locus).axes[0].lines) == 2
    assert len(plot.conicity(locus, points=5).axes[0].lines) == 2


def test_figure_of_a_check_marks_what_is_beyond_the_tolerance(locus):
    right, wrong = (
        locus.check_conicity(title, "free roll", [2.5, 3.0], [0.19, value], [0.05, 0.05])
        for title, value in (("right", 0.19), ("wrong", 0.9))
    )
    figure = plot.conicity_checks([right, wrong])
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["right", "wrong"]
    assert [axes.lines[1].get_xdata().tolist() for axes in figure.axes] == [[], [3.0]]


def test_figure_of_a_contact_needs_a_wheel():
    scene = ts.Scene.builtin("wheel-rail").with_set(["grid.elements=[15, 15]"])
    assert plot.wheel_on_rail(ts.solve(scene)).axes
    with pytest.raises(ValueError, match="wheel"):
        plot.wheel_on_rail(
            ts.solve(ts.Scene.builtin("spheres").with_set(["grid.elements=[11, 11]"]))
        )
