"""Bodies that conform get a note with the error of a half-space, checked by a plane solution."""

import re
import warnings

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.scene.plausibility import Pair, read_conformity
from tractive_sam.schema import PlausibilityWarning

STEEL = {"young": 208e3, "poisson": 0.3}


def disc_in_hole(half_angle, elements=300):
    """Load and peak pressure of a disc in a hole over those of Hertz for its half width.

    With R = E* = clearance = 1: cos(t) d - 1 = integral of K(t - s) q(s) ds, with
    K = -(2/pi) cos t ln(2 sin(|t|/2)) - 1/(2 pi). The approach d makes the pressure end at zero.
    """
    s = np.linspace(-0.5 * np.pi, 0.5 * np.pi, elements + 1)
    edges = half_angle * np.sin(s)
    middle, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)

    def integrated(t):  # of ln |t|
        return t * np.log(np.abs(t)) - t

    difference = middle[:, None] - middle
    regular = np.where(difference == 0.0, 1.0, np.abs(difference))
    smooth = np.cos(difference) * np.log(2.0 * np.sin(0.5 * regular))
    smooth -= np.log(regular)
    np.fill_diagonal(smooth, 0.0)
    start, end = middle[:, None] - edges[:-1], middle[:, None] - edges[1:]
    kernel = -(2.0 / np.pi) * (smooth * width + integrated(start) - integrated(end))
    kernel -= width / (2.0 * np.pi)
    one, cosine = np.linalg.solve(kernel, np.stack((-np.ones(elements), np.cos(middle)), axis=1)).T
    # Both are infinite at the edge; their sum is to be zero there.
    root = np.sqrt(half_angle**2 - middle[:4] ** 2)
    depth = middle[:4] + half_angle
    singular = [np.polyfit(depth, q[:4] * root, 1)[1] for q in (one, cosine)]
    q = one - singular[0] / singular[1] * cosine
    load = float((q * np.cos(middle) * width).sum())
    return load / (np.pi * half_angle**2 / 4.0), float(q.max()) / (half_angle / 2.0)


def groove(half_angle):
    """A ball in a long groove whose contact has this half angle across the track, roughly."""
    body = {
        "A": STEEL | {"radius_x": 10.0, "radius_y": 10.0},
        "B": STEEL | {"radius_x": 1000.0, "radius_y": -10.2},
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = ts.Scene(body=body, load={"normal": 1.0})
        b = scene.hertz.b
        return body, (10.0 * np.sin(half_angle) / b) ** 3


@pytest.mark.parametrize("degrees", [10.0, 20.0, 30.0])
def test_the_note_has_the_error_of_the_half_space(degrees):
    body, load = groove(np.radians(degrees))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = ts.Scene(body=body, load={"normal": load})
    (reading,) = read_conformity(Pair.from_scene(scene))
    assert reading.value == pytest.approx(degrees, rel=1e-6)
    exact = [100.0 * (ratio - 1.0) for ratio in disc_in_hole(np.radians(degrees))]
    # Elements of constant pressure: a thousandth of the ratio.
    assert [reading.details["load"], reading.details["peak"]] == pytest.approx(exact, abs=0.3)


def test_a_flat_contact_has_no_note_and_a_conformal_one_has():
    body, load = groove(np.radians(5.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error", PlausibilityWarning)
        ts.Scene(body=body, load={"normal": load})
    body, load = groove(np.radians(15.0))
    with pytest.warns(PlausibilityWarning, match=re.escape("conform in y")) as caught:
        ts.Scene(body=body, load={"normal": load})
    (note,) = [str(w.message) for w in caught if "conform" in str(w.message)]
    # Between 10 and 20 degrees, in proportion to the square of the angle.
    assert "3.9 % less load" in note
    assert "4.8 % less peak pressure" in note


def test_convex_and_flat_bodies_have_none():
    for name in ("spheres", "twin-discs", "cylinders"):
        assert not list(read_conformity(Pair.from_scene(ts.Scene.builtin(name))))
