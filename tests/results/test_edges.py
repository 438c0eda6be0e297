"""Edges of a contact between the centres of elements, against those by Hertz."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.results.state import contact_extent, covered_elements

BALL = {"young": 2e5, "poisson": 0.3, "radius_x": 20.0}
PLATE = BALL | {"radius_x": math.inf, "radius_y": math.inf}

# Coarse to fine, in places of the edge within an element that have nothing to do with each other.
ELEMENTS = [13, 17, 22, 27, 34, 41, 53, 66, 81, 104]


def errors(radius_y):
    """Side of an element over a, and relative errors of a, b and the area, of each mesh."""
    scene = ts.Scene(body={"A": BALL | {"radius_y": radius_y}, "B": PLATE}, load={"normal": 100.0})
    a, b, area = scene.hertz.a, scene.hertz.b, scene.hertz.area
    rows = []
    for n in ELEMENTS:
        grid = {"half_length": (1.2 * a, 1.3 * b), "elements": (n, round(1.3 * n))}
        found = ts.solve(scene.replace(grid=grid))
        exact = (found.half_width_x / a, found.half_width_y / b, found.area / area)
        rows.append((found.grid.dx / a, *(abs(one - 1.0) for one in exact)))
    return np.array(rows).T


@pytest.mark.parametrize("radius_y", [20.0, 90.0])
def test_half_widths_and_area_are_of_second_order(radius_y):
    step, *of_each = errors(radius_y)
    # Bounds on every mesh; a staircase would be of first order, h/2. In the area a hundredth of h
    # is left of edges that run oblique to the elements.
    for error, bound in zip(of_each, (0.6, 0.6, 1.0), strict=True):
        assert (error <= bound * step**2).all()
        order = np.polyfit(np.log(step), np.log(np.maximum(error, 1e-6)), 1)[0]
        assert order > 1.5  # it scatters with the place of the edge; a staircase has less than 1


def test_a_line_contact_on_any_elements():
    """The cubic that reports the place of an edge is one for all places."""
    line = BALL | {"radius_y": math.inf}
    scene = ts.Scene(body={"A": line, "B": PLATE}, load={"normal": 100.0})
    a = scene.hertz.a
    for half_length in np.linspace(1.2, 1.2 * (1 + 1 / 300), 12):
        grid = {"half_length": (half_length * a,), "elements": (601,)}
        found = ts.solve(scene.replace(grid=grid))
        # A hundredth of an element: the fit is to 0.0006 of it, the rest of second order.
        assert found.half_width_x == pytest.approx(a, abs=0.01 * found.grid.dx)
        assert found.area == pytest.approx(2 * a, abs=0.02 * found.grid.dx)


def test_an_edge_does_not_jump_as_an_element_comes_into_contact():
    wide = np.array([0.0, 1.0, 1.0, 1e-9, 0.0])[:, None]
    narrow = np.array([0.0, 1.0, 1.0, 0.0, 0.0])[:, None]
    # The square root of the pressure's quotient is what is left: 1e-9, and rounding.
    assert contact_extent(wide) == pytest.approx(contact_extent(narrow), abs=1e-8)
    assert covered_elements(wide) == pytest.approx(covered_elements(narrow), abs=1e-8)


def test_shapes_that_are_known():
    assert contact_extent(np.zeros((5, 5))) == covered_elements(np.zeros((5, 5))) == 0.0
    flat = np.zeros((12, 12))
    flat[3:9, 2:8] = 1.0  # constant to its rim: all edges at one place of their elements
    side = contact_extent(flat)
    assert side == contact_extent(flat.T)
    # A square without its four corners.
    corner = 0.5 * (0.5 * (side - 5.0)) ** 2
    assert covered_elements(flat) == pytest.approx(side**2 - 4 * corner, rel=1e-12)
    two = np.zeros((12, 12))
    two[1:3, 1:3] = two[3:5, 3:5] = 1.0  # that touch at a corner
    assert covered_elements(two) == pytest.approx(
        2 * covered_elements(two * (np.arange(12) < 3)), rel=0.1
    )
    assert covered_elements(two) == pytest.approx(covered_elements(two[::-1]), rel=1e-12)


@pytest.mark.parametrize("n", [31, 47])
def test_what_sticks_of_a_ball_that_is_shifted(n):
    """Mindlin (1949): a circle of the radius c = a (1 - Q/mu P)^(1/3)."""
    shifted = {"start": "shift", "distance": [0, 1], "step": 0.1, "load.force_x": [0.0, 57.0]}
    fretting = ts.Scene.builtin("fretting").replace(transient=shifted, **{"grid.elements": (n, n)})
    history = ts.roll(fretting)
    circle = (1.0 - history["Qx"] / (0.6 * 100.0)) ** (2.0 / 3.0)
    # Counted elements stray by up to 2e-2.
    np.testing.assert_allclose(history["stick_fraction"], circle, atol=2e-3)


def test_stick_is_counted_where_traction_falls_as_it_begins_to_slide():
    """Its place between two elements is unknown then."""
    scene = ts.Scene.builtin("locomotive")
    half_length = (1.3 * scene.hertz.a, 1.3 * scene.hertz.b)
    found = ts.solve(scene.replace(grid={"half_length": half_length, "elements": (31, 31)}))
    counted = np.count_nonzero(found.sticking) / np.count_nonzero(found.touching)
    assert found.stick_fraction == counted > 0.0
