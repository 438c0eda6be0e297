"""Volumes hold the stress of the contact, wherever it comes from."""

from dataclasses import replace

import h5py
import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import steady
from tractive_sam.results.record import Record


@pytest.fixture(scope="module")
def contact():
    return steady("spheres-orthotropic", elements=15)


def history(contact):
    """Three records of the contact, the second without fields."""
    records = [
        Record.from_contact(contact, {"revolution": N}, with_fields=N != 10) for N in (0, 10, 20)
    ]
    return ts.History.of_records(records, contact.scene, contact.grid)


def read(path):
    """Stress (6, n_x, n_y, n_z), von Mises (n_x, n_y, n_z), and z of the layers."""
    with h5py.File(path) as file:
        vtk = file["VTKHDF"]
        stress = vtk["PointData/stress"][:].T[[0, 1, 2, 3, 5, 4]]
        von_mises = vtk["PointData/von_mises"][:].T
        z = vtk.attrs["Origin"][2] + vtk.attrs["Spacing"][2] * np.arange(stress.shape[-1])
        return stress, von_mises, z


@pytest.mark.parametrize(("body", "side"), [("A", 1.0), ("B", -1.0)])
def test_points_hold_the_stress_there(contact, tmp_path, body, side):
    path = ts.export_volume(contact, tmp_path / "v.vtkhdf", body=body, depth=2.0, elements=5)
    stress, von_mises, z = read(path)
    grid, a = contact.grid, contact.scene.hertz.a
    assert np.sort(side * z) == pytest.approx(np.linspace(0.0, 2.0 * a, 5))
    assert (np.diff(z) > 0.0).all()
    chosen = np.random.default_rng(1).integers((15, 15, 5), size=(40, 3))
    points = [(grid.x[i], grid.y[j], abs(z[k])) for i, j, k in chosen]
    i, j, k = chosen.T
    # Single precision: 6e-8 of the largest stress, about p0.
    tolerance = 1e-7 * np.abs(stress).max()
    exact = ts.stress_at(contact, points, body).T
    np.testing.assert_allclose(stress[:, i, j, k], exact, rtol=0.0, atol=tolerance)
    xx, yy, zz, xy, xz, yz = exact
    square = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
    square += 3.0 * (xy**2 + xz**2 + yz**2)
    np.testing.assert_allclose(von_mises[i, j, k] ** 2, square, rtol=0.0, atol=tolerance)


def test_depth_and_points_are_those_of_the_scene_by_default(contact, tmp_path):
    scene = contact.scene
    _, _, z = read(ts.export_volume(contact, tmp_path / "v.vtkhdf"))
    assert z.size == scene.subsurface.elements
    assert z[-1] == pytest.approx(scene.subsurface.depth * scene.hertz.a)


def test_a_stored_revolution_gives_the_same_as_its_contact(contact, tmp_path):
    options = {"body": "B", "elements": 3}
    direct = ts.export_volume(contact, tmp_path / "direct.vtkhdf", **options)
    stored = ts.export_volume(history(contact), tmp_path / "stored.vtkhdf", revolution=0, **options)
    for one, other in zip(read(direct), read(stored), strict=True):
        np.testing.assert_array_equal(one, other)
    with h5py.File(ts.export_volume(history(contact), tmp_path / "last.vtkhdf")) as file:
        assert file.attrs["revolution"] == 20


def test_what_cannot_be_exported_is_reported(contact, tmp_path):
    path = tmp_path / "v.vtkhdf"
    with pytest.raises(LookupError, match=r"10.*0, 20"):
        ts.export_volume(history(contact), path, revolution=10)
    with pytest.raises(ValueError, match="revolution"):
        ts.export_volume(contact, path, revolution=0)
    with pytest.raises(ValueError, match='"A" or "B"'):
        ts.export_volume(contact, path, body="C")
    for depth in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="depth"):
            ts.export_volume(contact, path, depth=depth)
    with pytest.raises(ValueError, match="elements"):
        ts.export_volume(contact, path, elements=1)
    apart = replace(contact, pressure=0.0 * contact.pressure)
    with pytest.raises(ValueError, match="touch"):
        ts.export_volume(apart, path)
    with pytest.raises(ts.ResultsError, match="suffix"):
        ts.export_volume(contact, tmp_path / "v.h5")
    assert not list(tmp_path.iterdir())


def test_the_surface_has_a_step_for_each_stored_record(contact, tmp_path):
    path = ts.export_surface(history(contact), tmp_path / "s.vtkhdf")
    with h5py.File(path) as file:
        vtk = file["VTKHDF"]
        assert vtk.attrs["Version"].tolist() == [2, 0]
        assert vtk.attrs["WholeExtent"].tolist() == [0, 14, 0, 14, 0, 0]
        assert (vtk["Steps"].attrs["NSteps"], vtk["Steps/Values"][:].tolist()) == (2, [0.0, 20.0])
        arrays = vtk["PointData"]
        assert {name: one.shape for name, one in arrays.items()} == {
            **dict.fromkeys(("pressure", "wear", "gap"), (2, 15, 15)),
            **dict.fromkeys(("traction", "slip"), (2, 15, 15, 3)),
        }
        single = np.float32  # of what the file holds
        np.testing.assert_array_equal(arrays["pressure"][1].T, contact.pressure.astype(single))
        x, y, z = np.moveaxis(arrays["traction"][0], -1, 0)
        np.testing.assert_array_equal([x.T, y.T], contact.traction.astype(single))
        assert not z.any()


def test_what_has_no_surface_to_export(tmp_path):
    line = ts.solve(ts.Scene.builtin("cylinders"))
    with pytest.raises(ValueError, match="line"):
        ts.export_surface(line, tmp_path / "s.vtkhdf")
    assert not list(tmp_path.iterdir())
