"""The approach counts from the first touch of the unworn bodies, wherever the elements are."""

import h5py
import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.contact.measured import lowest_separation, resample, sample_gap
from tractive_sam.results import Grid

STEEL = {"young": 2e5, "poisson": 0.3}
SPHERE = STEEL | {"radius_x": 20.0, "radius_y": 20.0}
CYLINDER = STEEL | {"radius_x": 20.0, "radius_y": np.inf}

pytestmark = pytest.mark.filterwarnings("ignore::tractive_sam.schema.SceneWarning")  # few elements


def scene_of(elements, body=SPHERE, half_length=(0.45, 0.45), **load):
    elements = [elements] * len(half_length)
    grid = {"half_length": half_length, "elements": elements}
    return ts.Scene(body={"A": body, "B": body}, load=load, grid=grid)


@pytest.mark.parametrize("elements", [9, 10, 15, 16, 21, 22, 40])
def test_load_and_approach_follow_hertz_to_second_order_on_meshes_of_either_parity(elements):
    hertz = scene_of(9, normal=300.0).hertz
    pressed = ts.solve(scene_of(elements, normal=300.0))
    approached = ts.solve(scene_of(elements, approach=hertz.approach))
    # 120 % over the squared number of elements bounds the error of odd meshes from 9 to 41.
    bound = 1.2 / elements**2
    assert pressed.approach == pytest.approx(hertz.approach, rel=bound)
    assert pytest.approx(300.0, rel=bound) == approached.P


def test_load_and_approach_of_a_line_do_not_depend_on_parity():
    odd, even = (ts.solve(scene_of(n, CYLINDER, (0.3,), normal=300.0)).approach for n in (101, 102))
    # Between neighbouring meshes: ten times the squared element over the squared contact.
    assert even == pytest.approx(odd, rel=10.0 / 101**2)


@pytest.mark.parametrize("elements", [10, 11])
def test_the_gap_of_radii_is_their_parabola(elements):
    model = Model(scene_of(elements, normal=300.0))
    x, y = model.grid.x[:, None], model.grid.y[None, :]
    np.testing.assert_array_equal(model.undeformed_gap, 0.5 * (x**2 / 10.0 + y**2 / 10.0))
    wider = model.on(Grid((0.9, 0.9), (2 * elements, 2 * elements)))
    assert wider.undeformed_gap.min() == pytest.approx(model.undeformed_gap.min(), abs=1e-3)


def paraboloid(x, y, at=(0.013, -0.021)):
    """Return a gap with a vertex between elements and samples, and a distance that all share."""
    return x, y, 5.0 + ((x[:, None] - at[0]) ** 2 + (y[None, :] - at[1]) ** 2) / 20.0


@pytest.mark.parametrize("elements", [10, 11, 14])
@pytest.mark.parametrize("samples", [7, 40, 121])
def test_the_datum_of_a_gap_is_the_least_value_of_its_interpolant(elements, samples):
    x = np.linspace(-0.6, 0.6, samples)
    gap = paraboloid(x, x)
    flat = STEEL | {"radius_x": np.inf, "radius_y": np.inf}
    grid = {"half_length": [0.45, 0.45], "elements": [elements, elements]}
    measured = {"x": x, "y": x, "separation": gap[2]}
    scene = ts.Scene(body={"A": flat, "B": flat}, load={"normal": 300.0}, grid=grid, gap=measured)
    model = Model(scene, gap)
    # Akima's interpolation is exact for parabolas but near the edge of the samples.
    exact = paraboloid(model.grid.x, model.grid.y)[2] - 5.0
    np.testing.assert_allclose(model.undeformed_gap[2:-2, 2:-2], exact[2:-2, 2:-2], atol=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.07])
def test_no_point_of_a_rough_profile_lies_below_the_datum(shift):
    rng = np.random.default_rng(3)
    y = np.linspace(-0.5, 0.5, 38)
    profile = np.array([-1e9, 1e9]), y, np.tile(1e-3 * rng.normal(size=38), (2, 1))
    grid, radii = Grid((0.4, 0.4), (12, 12), shift), (10.0, 15.0)
    least = lowest_separation(profile, grid, resample(profile, grid), radii)
    x, places = np.linspace(grid.x[0], grid.x[-1], 21), np.linspace(grid.y[0], grid.y[-1], 20_001)
    dense = sample_gap(profile, x, places)
    dense += 0.5 * (x[:, None] ** 2 / radii[0] + places[None, :] ** 2 / radii[1])
    # The squared distance of 4e-5 mm between the points times the curvature of the roughness.
    assert least == pytest.approx(dense.min(), abs=1e-8)


ROLL = {
    "body": {body: SPHERE | {"hardness": 2e3} for body in "AB"},
    "load": {"approach": 0.008},
    "creepage": {"longitudinal": -0.002},
    "friction": {"mu": 0.3},
    "wear": {"coefficient": 1e-4, "revolutions": 4, "stepping": "every-revolution"},
    "grid": {"half_length": [0.45, 0.45], "elements": [10, 10]},
}


def test_a_file_that_counts_from_the_nearest_element_resumes_so(tmp_path, monkeypatch):
    scene = ts.Scene(**ROLL)
    path = tmp_path / "before.h5"
    with monkeypatch.context() as before:
        made = Model.__init__

        def from_node(self, *args, **more):
            made(self, *args, **more | {"datum": "node"})

        before.setattr(Model, "__init__", from_node)
        whole = ts.roll(scene, progress=False)
        ts.roll(scene.replace(**{"wear.revolutions": 2}), path, progress=False)
    with h5py.File(path, "r+") as file:
        del file["scene"].attrs["datum"]
    resumed = ts.roll(scene, path, resume=True, progress=False)
    assert resumed.datum == "node"
    np.testing.assert_allclose(resumed["P"], whole["P"], rtol=1e-9)  # rounding of the restart
    now = ts.roll(scene, tmp_path / "now.h5", progress=False)
    assert now.datum == "vertex"
    assert now["P"][0] < 0.97 * whole["P"][0]
