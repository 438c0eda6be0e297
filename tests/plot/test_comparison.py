import io

import numpy as np
import pytest

from tests.plot import strip_theory as strips
from tractive_sam import plot


def test_histories_and_a_reference_in_the_same_axes():
    history = strips.history()
    N = history["revolution"]
    figure = plot.compare({"one": history, "two": history}, "wear_max", {"model": (N, N * 1e-6)})
    figure.savefig(io.BytesIO(), dpi=40)
    (axes,) = figure.axes
    assert [line.get_label() for line in axes.lines] == ["one", "two", "model"]
    np.testing.assert_allclose(axes.lines[0].get_ydata(), 1e3 * history["wear_max"])
    np.testing.assert_allclose(axes.lines[2].get_ydata(), 1e-3 * N)
    assert r"\mu m" in axes.get_ylabel()


def test_numbers_without_a_unit_have_none():
    (axes,) = plot.compare({"one": strips.history()}, "Qx_over_P").axes
    assert "(" not in axes.get_ylabel()


@pytest.mark.parametrize(
    ("histories", "name"), [({}, "Qx_over_P"), ({"one": strips.history()}, "pressure")]
)
def test_what_cannot_be_plotted_is_reported(histories, name):
    with pytest.raises(ValueError, match=r"name|history"):
        plot.compare(histories, name)
