"""Line contacts with a profile along x: a body by its profile, flat and tilted punches."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.store import read_gap

FLAT = {"young": 200e3, "poisson": 0.3, "radius_x": math.inf, "radius_y": math.inf}
X = np.linspace(-2.0, 2.0, 401)
RADIUS, LOAD = 50.0, 1000.0


def scene(separation, x=X, **changes):
    tables = {
        "body": {"A": FLAT, "B": FLAT},
        "load": {"normal": LOAD},
        "gap": {"x": x, "separation": separation},
    }
    return ts.Scene(**tables | changes)


def test_a_profile_can_stand_for_the_radius():
    rolls = {"creepage": {"longitudinal": -2e-4}, "friction": {"mu": 0.3}}
    grid = {"half_length": [0.8], "elements": [201]}
    by_gap = ts.solve(scene(X**2 / (2.0 * RADIUS), grid=grid, **rolls))
    body = {"A": FLAT | {"radius_x": RADIUS}, "B": FLAT}
    by_radius = ts.solve(ts.Scene(body=body, load={"normal": LOAD}, grid=grid, **rolls))
    # The interpolation is exact for parabolas: two solves to 1e-8.
    size = by_radius.p_max
    np.testing.assert_allclose(by_gap.pressure, by_radius.pressure, atol=1e-6 * size)
    np.testing.assert_allclose(by_gap.traction, by_radius.traction, atol=1e-6 * size)
    assert pytest.approx(LOAD) == by_gap.P  # N/mm


@pytest.mark.parametrize("tilt", [0.0, 2e-4])
def test_a_punch_has_the_pressure_of_sneddon(tilt):
    """Johnson 1985, sections 2.8 and 5.5: a rigid tilt of an elastic punch of infinite height.

    As both bodies are half-spaces here, it is the gap that tilts.
    """
    half, wide = 1.0, np.linspace(-1.5, 1.5, 601)
    punch = np.where(np.abs(wide) < half, tilt * wide, 1.0)
    given = scene(punch, wide, grid={"half_length": [1.2], "elements": [481]})
    contact = ts.solve(given)
    x, e_star = contact.grid.x, given.material.plane_strain_modulus
    half = 0.5 * contact.touching.sum() * contact.grid.dx
    inner = np.abs(x) < 0.9 * half
    x, found = x[inner], contact.pressure[inner, 0]
    expected = (LOAD / np.pi - 0.5 * e_star * tilt * x) / np.sqrt(half**2 - x**2)
    # Of the first order in the elements, 400 across, by the infinite pressure at the edges.
    np.testing.assert_allclose(found, expected, rtol=0.01)


def test_files_of_a_profile_along_x(tmp_path):
    path = tmp_path / "profile.csv"
    np.savetxt(path, np.stack([X, X**2 / 100.0], axis=1), delimiter=",")
    table = {"file": str(path), "body": "B", "positive": "inward", "profile": "x"}
    x, y, separation = read_gap(ts.Gap(**table))
    np.testing.assert_allclose(x, X)
    assert separation.shape == (X.size, y.size)
    by_file, by_array = scene(X**2 / 100.0, gap=table), scene(X**2 / 100.0)
    assert by_file.line
    assert ts.solve(by_file).p_max == pytest.approx(ts.solve(by_array).p_max, rel=1e-6)


def test_a_line_contact_with_a_gap_is_stored_and_shown(tmp_path):
    given = scene(X**2 / (2.0 * RADIUS))
    path = tmp_path / "a.h5"
    ts.roll(given, path)
    history = ts.open_history(path)
    assert history.grid.line
    assert "N/mm" in str(ts.explain(given))
    assert ts.plot.list_figures(history)
    figures = ts.plot.save_all(history, tmp_path)
    assert figures
