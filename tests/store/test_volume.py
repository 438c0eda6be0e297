import re

import h5py
import numpy as np
import pytest

from tests.store.sample_records import SCENE, mesh
from tractive_sam.store import HistoryWriter, Image, ResultsError, check_volume, write_volume

IMAGE = Image(points=(3, 4, 5), origin=(-1.0, -2.0, 0.0), spacing=(1.0, 1.25, 0.5))


def layers(count=5):
    """Yield layers in which every value encodes its place: component, x, y, z."""
    for k in range(count):
        value = 100.0 * np.arange(3)[:, None] + 10.0 * np.arange(4) + k
        stress = value + 1000.0 * np.arange(6)[:, None, None]
        yield {"stress": stress, "von_mises": value, "max_shear": -value}


def failing():
    yield from layers(2)
    raise OSError("no space left")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "volume.vtkhdf"


@pytest.fixture
def written(path):
    write_volume(path, IMAGE, layers(), SCENE, {"body": "A", "revolution": 7})
    return path


def test_points_count_in_the_order_of_vtk(written):
    with h5py.File(written) as file:
        data = file["VTKHDF/PointData"]
        assert data["von_mises"].shape == (5, 4, 3)
        assert data["von_mises"][4, 3, 2] == 234
        assert data["max_shear"][1, 0, 2] == -201
        # xx, yy, zz, xy, yz, xz: the last two the other way round than ours.
        assert data["stress"][4, 3, 2].tolist() == [234, 1234, 2234, 3234, 5234, 4234]
        assert data["stress"].dtype == np.float32
        assert data["stress"].attrs["units"] == "MPa"


def test_file_describes_itself(written):
    with h5py.File(written) as file:
        vtk = dict(file["VTKHDF"].attrs)
        assert vtk["Type"] == b"ImageData"
        assert vtk["Version"].tolist() == [1, 0]
        assert vtk["WholeExtent"].tolist() == [0, 2, 0, 3, 0, 4]
        assert vtk["Origin"].tolist() == list(IMAGE.origin)
        assert vtk["Spacing"].tolist() == list(IMAGE.spacing)
        assert vtk["Direction"].reshape(3, 3).tolist() == np.eye(3).tolist()
        assert (file.attrs["body"], file.attrs["revolution"]) == ("A", 7)
        assert file["scene"][()].decode() == SCENE.to_toml()
        assert "version_numpy" in file.attrs


def test_vtk_reads_it(written):
    vtk = pytest.importorskip("vtk")
    numpy_support = pytest.importorskip("vtk.util.numpy_support")
    reader = vtk.vtkHDFReader()
    assert reader.CanReadFile(str(written))
    reader.SetFileName(str(written))
    reader.Update()
    image = reader.GetOutputDataObject(0)
    assert image.GetPoint(image.GetNumberOfPoints() - 1) == (1.0, 1.75, 2.0)
    point = image.FindPoint((0.0, 0.5, 1.5))  # i, j, k = 1, 2, 3
    data = image.GetPointData()
    assert numpy_support.vtk_to_numpy(data.GetArray("stress"))[point].tolist() == [
        1000 * n + 123 for n in (0, 1, 2, 3, 5, 4)
    ]
    assert data.GetScalars().GetName() == "von_mises"


def test_a_volume_that_fails_leaves_what_was_there(path, written):
    before = written.read_bytes()
    with pytest.raises(ResultsError, match="no space left"):
        write_volume(path, IMAGE, failing(), SCENE, {}, overwrite=True)
    assert path.read_bytes() == before
    assert [file.name for file in path.parent.iterdir()] == [path.name]


class TestCheck:
    def test_suffix(self, tmp_path):
        with pytest.raises(ResultsError, match=r"volume\.h5.*\.vtkhdf"):
            check_volume(tmp_path / "volume.h5")

    def test_folder(self, tmp_path):
        with pytest.raises(ResultsError, match="missing"):
            check_volume(tmp_path / "missing" / "volume.vtkhdf")

    def test_existing(self, written):
        with pytest.raises(ResultsError, match=re.escape(str(written))):
            check_volume(written)
        check_volume(written, overwrite=True)

    @pytest.mark.parametrize("kind", ["text", "history"])
    def test_files_of_another_kind_are_never_replaced(self, path, kind):
        if kind == "text":
            path.write_text("precious")
        else:
            HistoryWriter(path, SCENE, mesh())
        with pytest.raises(ResultsError, match=re.escape(str(path))):
            check_volume(path, overwrite=True)
