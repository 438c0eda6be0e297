import h5py
import pytest

import tractive_sam as ts

SMALL = ("--set", "grid.elements=[15, 15]")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A results file of a contact that was computed."""
    path = tmp_path_factory.mktemp("results") / "discs.h5"
    settings = ["grid.elements=[15, 31]", "wear.revolutions=2", "wear.save=[0, 2]"]
    ts.roll(ts.Scene.builtin("twin-discs").with_set(settings), path)
    return path


def test_results(call, results):
    result = call("export", results, "--elements", 3, "--body", "B")
    assert result.exit_code == 0
    assert result.stdout == "discs-B.vtkhdf\n"
    with h5py.File("discs-B.vtkhdf") as file:
        assert (file.attrs["body"], file.attrs["revolution"]) == ("B", 2)
        assert file["VTKHDF"].attrs["WholeExtent"].tolist() == [0, 14, 0, 30, 0, 2]


def test_scene(call):
    arguments = ("export", "spheres", *SMALL, "-o", "v.vtkhdf", "--depth", 0.5, "--elements", 3)
    for _ in range(2):  # the second replaces the first
        assert call(*arguments).exit_code == 0
    with h5py.File("v.vtkhdf") as file:
        spacing = file["VTKHDF"].attrs["Spacing"]
        assert spacing[2] == pytest.approx(0.25 * ts.Scene.builtin("spheres").hertz.a)
        assert "revolution" not in file.attrs


def test_a_distance_of_a_transient(call, folder):
    coarse = ("--set", "grid.elements=[11, 11]", "--set", "transient.save=[0.5]")
    assert call("run", "fretting", *coarse, "-o", "f.h5").exit_code == 0
    arguments = ("export", "f.h5", "-o", "v.vtkhdf", "--elements", 3)
    assert call(*arguments, "--distance", 0.5).exit_code == 0
    with h5py.File(folder / "v.vtkhdf") as file:
        assert file.attrs["distance"] == 0.5
    assert "no fields of distance 99" in call(*arguments, "--distance", 99).stderr


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (("RESULTS", "--revolution", 1), "no fields of revolution 1; the stored ones are 0, 2"),
        (("RESULTS", *SMALL), "--set changes a scene"),
        (("RESULTS", "--depth", -1), "depth: a positive number"),
        (("RESULTS", "--elements", 1), "elements: at least 2"),
        (("RESULTS", "-o", "missing/v.vtkhdf"), "missing is not a folder"),
        (("RESULTS", "-o", "v.vtk"), "v.vtk has another suffix than .vtkhdf"),
        (("missing.h5",), "missing.h5 does not exist"),
        (("nothing",), "nothing"),
        (("spheres", "--revolution", 5), "tractive-sam run spheres"),
        (("RESULTS", "--body", "C"), "'C' is not one of 'A', 'B'"),
    ],
)
def test_bad_input(call, results, arguments, reported, folder):
    result = call("export", *(results if word == "RESULTS" else word for word in arguments))
    assert result.exit_code == 2
    assert reported in result.stderr
    assert not list(folder.iterdir())


def test_a_file_of_another_kind_stays(call, results, folder):
    (folder / "v.vtkhdf").write_text("precious")
    result = call("export", results, "-o", "v.vtkhdf")
    assert result.exit_code == 2
    assert "is not a volume of tractive-sam; choose another name" in result.stderr
    assert (folder / "v.vtkhdf").read_text() == "precious"


def test_a_scene_without_solution_is_not_exported(call, folder):
    unreachable = ("--set", "load.approach=0.036", "--set", "load.force_x=0.4")
    result = call("export", "spheres", *SMALL, *unreachable)
    assert result.exit_code == 3
    assert "not a solution" in result.stderr
    assert not list(folder.iterdir())


def test_interrupt(call, results, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("tractive_sam.run.export_volume", interrupted)
    result = call("export", results)
    assert result.exit_code == 3
    assert "discs-A.vtkhdf was not written" in result.stderr


def test_unfinished_results_are_reported(call, results, monkeypatch):
    monkeypatch.setattr(ts.History, "finished", False)
    result = call("export", results, "--elements", 2)
    assert result.exit_code == 0
    assert "note:" in result.stderr


def test_surface(call, results):
    assert call("export", results, "--surface").stdout == "discs-surface.vtkhdf\n"
    with h5py.File("discs-surface.vtkhdf") as file:
        assert file["VTKHDF/Steps/Values"][:].tolist() == [0.0, 2.0]
    refused = call("export", results, "--surface", "--depth", 1.0)
    assert refused.exit_code == 2
    assert "--surface" in refused.stderr


@pytest.mark.slow
def test_one_block_of_a_duty_cycle(call):
    few = ["grid.half_length=[0.42, 0.9]", "grid.elements=[15, 21]", "wear.revolutions=2"]
    blocks = ({"name": "450", "revolutions": 1, "load": {"normal": 450.0}}, {"revolutions": 1})
    scene = ts.Scene.builtin("twin-discs").with_set(few).replace(duty=blocks, subsurface=None)
    ts.roll(scene, "a.h5")
    assert call("export", "a.h5").exit_code == 2
    for none in ("light", "²"):
        assert call("export", "a.h5", "--block", none).exit_code == 2
    assert call("export", "spheres", "--block", "1").exit_code == 2
    for block in ("450", "1"):
        assert call("export", "a.h5", "--block", block, "--elements", 3).stdout == "a-A.vtkhdf\n"
