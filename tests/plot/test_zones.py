from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from tests.plot import strip_theory as strips
from tractive_sam.plot import ContactView
from tractive_sam.plot.contact_map import (
    draw_contact_edge,
    draw_stick_edge,
    extend_outwards,
    stick_level,
)


@pytest.fixture
def axes():
    return Figure().add_subplot()


def test_edge_of_a_hertz_contact_is_smooth(axes):
    """Within a sixth of an element, though elements are in contact entirely or not."""
    state = ContactView.from_source(strips.contact())
    x, y = draw_contact_edge(axes, state).vertices.T
    distance = np.hypot(x, y * strips.HERTZ.a / strips.HERTZ.b) - 1
    assert len(x) > 40
    assert np.abs(distance).max() < 0.17 * (strips.X[1] - strips.X[0]) / strips.HERTZ.a


def test_edge_of_a_contact_as_wide_as_the_mesh_is_closed(axes):
    state = ContactView.from_source(strips.contact(pressure=np.full((31, 33), 5.0)))
    path = draw_contact_edge(axes, state)
    dx = strips.X[1] - strips.X[0]
    np.testing.assert_allclose(path.vertices[0], path.vertices[-1])
    # a constant pressure ends midway between the elements
    assert path.vertices[:, 0].max() == pytest.approx((0.6 + dx / 2) / strips.HERTZ.a)


def test_what_sticks_at_its_very_bound_has_no_reserve():
    pressure = np.array([[0.0, 2.0, 2.0]])
    slip = np.array([[[0.0, 0.0, 1e-3]], np.zeros((1, 3))])
    fields = {"touching": pressure > 0.0, "bound": pressure, "utilisation": pressure}
    state = SimpleNamespace(contact=SimpleNamespace(**fields, slip=slip))
    level = stick_level(state, np.array([[False, True, False]]))
    np.testing.assert_array_equal(level, [[0.0, 0.0, -1.0]])


def test_edge_of_stick(axes):
    state = ContactView.from_source(strips.contact())
    draw_stick_edge(axes, state, draw_contact_edge(axes, state))
    x, y = np.concatenate([path.vertices for path in axes.collections[-1].get_paths()]).T
    inside = np.abs(y) < 1.0
    expected = 2 * strips.SLIPPING / strips.HERTZ.a - np.sqrt(1 - (y[inside] / 1.6) ** 2)
    error = np.abs(x[inside] - expected)
    assert error.max() < 0.7 * (strips.X[1] - strips.X[0]) / strips.HERTZ.a


def test_no_edge_of_stick_where_all_slips(axes):
    state = ContactView.from_source(
        strips.contact(traction=0.3 * np.stack((strips.pressure(), 0 * strips.pressure())))
    )
    contact = draw_contact_edge(axes, state)
    draw_stick_edge(axes, state, contact)
    assert len(axes.collections) == 1


def test_continued():
    values = np.array([[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]])
    np.testing.assert_array_equal(extend_outwards(values, values > 0)[:, 2], [2.0, 4.0])
