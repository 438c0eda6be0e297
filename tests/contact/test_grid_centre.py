"""A mesh with a centre other than the origin, grid.centre."""

import numpy as np
import pytest

import tractive_sam as ts

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None)
AWAY = {"half_length": [4.8, 4.4], "elements": [48, 44], "centre": [0.8, -0.4]}
CENTRED = {"half_length": [5.6, 4.8], "elements": [56, 48]}
"""It has the elements of AWAY and eight more at the left, four more at the top."""


def on_both(**changes):
    scene = SPHERES.replace(**{"creepage.spin": 1e-4} | changes)
    return scene.replace(grid=AWAY), scene.replace(grid=CENTRED)


def inner(values):
    return values[..., 8:, :-4]


def test_the_solution_does_not_depend_on_the_centre():
    away, centred = map(ts.solve, on_both())
    np.testing.assert_allclose(away.grid.x, centred.grid.x[8:], atol=1e-14)
    np.testing.assert_allclose(away.grid.y, centred.grid.y[:-4], atol=1e-14)
    size = centred.p_max  # two solutions to 1e-8
    np.testing.assert_allclose(away.pressure, inner(centred.pressure), atol=1e-6 * size)
    np.testing.assert_allclose(away.traction, inner(centred.traction), atol=1e-6 * size)
    assert (away.Mz, away.approach) == pytest.approx((centred.Mz, centred.approach), rel=1e-6)


def test_wear_and_its_file_do_not_depend_on_the_centre(tmp_path):
    wear = {"coefficient": 1e-2, "revolutions": 4, "stepping": "every-revolution"}
    away, centred = on_both(wear=wear)
    path, expected = tmp_path / "a.h5", ts.roll(centred)["wear_profile"][-1]

    def stop(record):
        if record.at >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ts.roll(away, path, progress=stop)
    ts.roll(away, path, resume=True)
    history = ts.open_history(path)
    assert history.grid.centre == (0.8, -0.4)
    atol = 1e-6 * expected.max()
    np.testing.assert_allclose(history["wear_profile"][-1], expected[:-4], atol=atol)


def test_stress_and_fatigue_do_not_depend_on_the_centre():
    """Up to the ends of the paths, which are at other places."""
    steel = {"sensitivity": 0.3, "limit": 1.0, "elements": 8, "bodies": ["A"]}
    away, centred = map(ts.solve, on_both(fatigue=steel))
    path, expected = (ts.stress_path(one, y=0.3, depth=1.0) for one in (away, centred))
    np.testing.assert_allclose(
        np.interp(0.5, path["x"], path["xz"]),
        np.interp(0.5, expected["x"], expected["xz"]),
        rtol=1e-3,
    )
    found, whole = (ts.fatigue(one)["A"].utilisation for one in (away, centred))
    # Points of paths outside the meshes: 3e-3 of the largest (`subsurface.fatigue_cycles`).
    np.testing.assert_allclose(found[4:-4], whole[4:-8], atol=3e-3 * whole.max())


def test_a_measured_map_is_read_where_the_mesh_is():
    x, y = np.linspace(-5.6, 5.6, 57), np.linspace(-4.8, 4.8, 49)
    bump = 1e-5 * x[:, None] ** 3 + 1e-4 * np.cos(y)[None, :]
    gap = {"x": x, "y": y, "separation": bump}
    away, centred = map(ts.solve, on_both(gap=gap))
    np.testing.assert_allclose(away.pressure, inner(centred.pressure), atol=1e-6 * centred.p_max)


def test_a_line_contact_has_one_number():
    tables = {"body.A.radius_y": np.inf, "body.B.radius_y": np.inf}
    grid = {"half_length": 12.0, "elements": 201, "centre": 0.1}
    scene = SPHERES.replace(**tables, grid=grid)
    assert ts.solve(scene).converged
    assert scene.grid.place == (0.1, 0.0)


@pytest.mark.parametrize(
    ("grid", "key"),
    [
        ({"elements": [41, 41], "centre": [0.1, 0.0]}, "grid.centre"),
        (AWAY | {"centre": [0.1]}, "grid.centre"),
        (AWAY | {"centre": [3.0, 0.0]}, "grid.half_length"),
    ],
)
def test_faults(grid, key):
    with pytest.raises(ts.SceneError) as raised:
        SPHERES.replace(grid=grid)
    assert raised.value.faults[0].key == key
