"""A measured separation added to that of the radii."""

import numpy as np
import pytest

from tests.conftest import steady
from tractive_sam.contact import Model, equilibrium
from tractive_sam.scene import Scene


def with_gap(x, y, separation, **changes):
    tables = Scene.builtin("spheres").entries()
    tables["grid"]["elements"] = (31, 31)
    tables |= {"gap": {"x": x, "y": y, "separation": separation}, **changes}
    scene = Scene(**tables)
    return equilibrium(Model(scene, (scene.gap.x, scene.gap.y, scene.gap.separation)))


def test_a_flat_gap_changes_nothing():
    plain = steady("spheres", elements=31)
    flat = with_gap([-5.0, 5.0], [-5.0, 5.0], np.full((2, 2), 0.3))
    np.testing.assert_allclose(flat.pressure, plain.pressure, atol=1e-9)
    # The approach counts from the first touch.
    assert flat.approach == pytest.approx(plain.approach, rel=1e-9)


def test_a_gap_can_stand_for_the_radii():
    plain = steady("spheres", elements=31)
    x = np.linspace(-4.5, 4.5, 301)
    tables = Scene.builtin("spheres").entries()["body"]
    flat = {n: b | {"radius_x": float("inf"), "radius_y": float("inf")} for n, b in tables.items()}
    shape = (x[:, None] ** 2 + x[None, :] ** 2) / 337.5
    gap = with_gap(x, x, shape, body=flat)
    # Bilinear interpolation between points 0.03 mm apart: 2e-4 of the approach.
    np.testing.assert_allclose(gap.pressure, plain.pressure, atol=2e-3 * plain.p_max)
    assert gap.Qx == pytest.approx(plain.Qx, rel=2e-3)


def test_two_bumps_make_two_contacts():
    x = np.linspace(-4.5, 4.5, 91)
    valley = 0.05 * np.exp(-(x**2))[None, :] * np.ones((91, 1))
    contact = with_gap(x, x, valley)
    row = contact.touching[15]
    edges = np.flatnonzero(np.diff(row.astype(int)) == 1)
    assert len(edges) == 2
    assert contact.converged
