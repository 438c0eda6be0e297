"""Whatever is given, the answer is a result or a fault: no traceback, no hang, nothing silent."""

import warnings
from dataclasses import replace

import h5py
import hypothesis.extra.numpy as arrays
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from typer.testing import CliRunner

import tractive_sam as ts
from tests.store.sample_records import SCENE, make_record, mesh
from tractive_sam.cli import app
from tractive_sam.scene.scene import builtin_text
from tractive_sam.store import HistoryWriter, open_history

pytestmark = pytest.mark.slow  # many scenes

SMALL = (
    "grid.elements=[9, 9]",
    "wear.revolutions=2",
    "wear.save=[0]",
    "solver.tolerance=1e-6",
)
TEXT = builtin_text("twin-discs-isotropic")
ENTRIES = [n for n, line in enumerate(TEXT.splitlines()) if " = " in line]

ANYTHING = st.one_of(
    st.sampled_from(["nan", "-inf", "inf", "1e400", "true", "[]", "[[1]]", "{}", "''", "9" * 400]),
    st.floats().map(repr),
    st.integers().map(str),
    # Numbers that a scene may well hold, and far beyond: what they mean together is checked, too.
    st.floats(-30.0, 30.0).map(lambda power: f"{10.0**power!r}"),
    st.floats(-4.0, 4.0).map(lambda power: f"{10.0**power!r}"),
)
CHANGES = st.dictionaries(st.sampled_from(ENTRIES), ANYTHING, min_size=1, max_size=3)
quick = settings(
    max_examples=20,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def outcome(*arguments):
    """Exit status of a command; nothing but an exit may leave it."""
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), arguments
    assert result.exit_code in (0, 2, 3)
    assert result.exit_code == 0 or result.stderr  # it says why
    return result.exit_code


@quick
@example(changes={4: "0.0"})  # a row that only just touches, at the second revolution
@given(changes=CHANGES)
def test_numbers_of_a_scene(changes, tmp_path):
    lines = TEXT.splitlines()
    for n, value in changes.items():
        lines[n] = f"{lines[n].split('=')[0]}= {value}"
    scene = tmp_path / "scene.toml"
    scene.write_text("\n".join(lines))
    fitting = [s for s in SMALL if f"[{s.split('.')[0]}]" in lines or s.startswith("solver")]
    reported = [f"--set={setting}" for setting in fitting]
    if outcome("run", scene, "-o", "scene.h5", "--overwrite", *reported) == 0:
        history = open_history("scene.h5")
        for name in ("P", "Qx", "p_max", "wear_max"):
            assert np.isfinite(history[name]).all()
        if (load := history.scene.load.normal) is not None:
            np.testing.assert_allclose(history["P"], load, rtol=1e-5)  # of the tolerance 1e-6


@quick
@given(junk=st.binary(max_size=12), at=st.integers(0, len(TEXT)))
def test_text_of_a_scene(junk, at, tmp_path):
    scene = tmp_path / "scene.toml"
    text = TEXT.encode()
    scene.write_bytes(text[:at] + junk + text[at + len(junk) :])
    outcome("explain", scene, "--set=grid.elements=[9, 9]")


@pytest.fixture(scope="module")
def content(tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "results.h5"
    with HistoryWriter(path, SCENE, mesh()) as writer:
        for number in range(3):
            writer.append(make_record(number))
        writer.finish("done", "as asked")
    names = []
    with h5py.File(path) as file:
        file.visititems(lambda name, item: names.append(name))
    return path, names  # a failure reports its arguments: not a file's content


def readable_or_reported(path):
    for command in (("show", path), ("show", path, "--json")):
        outcome(*command)
    outcome("run", "twin-discs", "--resume", "-o", path, "--set=wear.revolutions=1")


@quick
@given(data=st.data())
def test_damaged_results(content, data, tmp_path):
    damaged = bytearray(content[0].read_bytes())
    whole = len(damaged)
    if data.draw(st.booleans(), "truncated"):
        del damaged[data.draw(st.integers(0, len(damaged) - 1)) :]
    for at in data.draw(st.lists(st.integers(0, whole - 1), max_size=20), "changed"):
        damaged[at : at + 1] = b"\x55"
    path = tmp_path / "damaged.h5"
    path.write_bytes(damaged)
    readable_or_reported(path)


FOREIGN = st.sampled_from([np.float64(1.0), b"text", "text", np.zeros(0), np.zeros((2, 3, 4))])


@quick
@given(number=st.integers(0, 999), replaced=st.booleans(), value=FOREIGN)
def test_foreign_results(content, number, replaced, value, tmp_path):
    """Another program has put something else in place of a group or a dataset."""
    path = tmp_path / "foreign.h5"
    path.write_bytes(content[0].read_bytes())
    with h5py.File(path, "r+") as file:
        name = content[1][number % len(content[1])]
        del file[name]
        if replaced:
            file[name] = value
    readable_or_reported(path)


NUMBERS = st.floats(width=64) | st.floats(-2.0, 2.0)


@quick
@given(data=st.data())
def test_arrays_of_a_gap(data):
    def axis(name):
        return data.draw(arrays.arrays(float, st.integers(0, 5), elements=NUMBERS), name)

    x, y = np.sort(axis("x")), np.sort(axis("y"))
    shape = data.draw(st.sampled_from([(x.size, y.size), (y.size, x.size), (x.size,)]))
    separation = data.draw(arrays.arrays(float, shape, elements=NUMBERS), "separation")
    tables = ts.Scene.builtin("spheres").entries()
    tables["grid"]["elements"] = (9, 9)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)  # gaps smaller than the grid
        try:
            scene = ts.Scene(**tables, gap={"x": x, "y": y, "separation": separation})
        except ts.SceneError:
            return
        contact = ts.solve(scene, throw=False)
    assert contact.message
    assert not contact.converged or np.isfinite(contact.traction).all()


@pytest.fixture(scope="module")
def solved():
    return ts.solve(ts.Scene.builtin("spheres").with_set(["grid.elements=[11, 11]"]))


@quick
@example(wear=np.full((11, 11), 1e6))  # the gap still has ten digits beside it
@given(wear=arrays.arrays(float, st.sampled_from([(11, 11), (11,), (9, 11)]), elements=NUMBERS))
def test_wear_from_outside(solved, wear):
    if wear.shape != (11, 11) or not (np.abs(wear) <= 1e6).all():
        with pytest.raises(ValueError, match=r"wear.*\(11, 11\)"):
            ts.solve(solved.scene, wear=wear, throw=False)
        return
    contact = ts.solve(solved.scene, wear=wear, throw=False)
    assert contact.message
    assert pytest.approx(0.4705) == contact.P or not contact.converged


@pytest.mark.parametrize("wear", ["deep", [[1.0], [1.0, 2.0]], np.full((11, 11), 1j), [None] * 11])
def test_wear_that_is_no_array_of_numbers(solved, wear):
    with pytest.raises(ValueError, match=r"wear.*\(11, 11\)"):
        ts.solve(solved.scene, wear=wear)


def test_masked_arrays_have_no_numbers_where_they_are_masked(solved):
    masked = np.ma.masked_all((11, 11))
    with pytest.raises(ValueError, match="wear"):
        ts.solve(solved.scene, wear=masked)
    with pytest.raises(ts.SceneError, match="separation"):
        ts.Gap(x=range(11), y=range(11), separation=masked)


@pytest.mark.parametrize(
    "change",
    [
        {"pressure": np.full((11, 11), np.nan)},
        {"pressure": np.ones((3, 11))},
        {"traction": np.full((2, 11, 11), np.inf)},
        {"approach": np.nan},
        {"xi_x": np.inf},
    ],
)
def test_start_that_is_no_contact(solved, change):
    with pytest.raises(ValueError, match="start"):
        ts.solve(solved.scene, start=replace(solved, **change))


def test_other_things_than_scenes_and_contacts(solved):
    with pytest.raises(TypeError, match=r"Scene\.builtin"):
        ts.solve("spheres")
    with pytest.raises(TypeError, match=r"Scene\.builtin"):
        ts.roll("spheres")
    with pytest.raises(TypeError, match="State"):
        ts.solve(solved.scene, start=solved.pressure)


@pytest.mark.parametrize("method", ["auto", "newton", "anderson", "uzawa"])
@pytest.mark.parametrize("name", ["spheres", "spheres-dissimilar"])
def test_worn_until_the_bodies_do_not_touch(name, method):
    scene = ts.Scene.builtin(name).with_set(["load.approach=1e-3"])
    half = 1.2 * scene.hertz.a
    mesh_of_it = [f"grid.half_length=[{half}, {half}]", "grid.elements=[11, 11]"]
    scene = scene.with_set([*mesh_of_it, f"solver.method={method}"])
    contact = ts.solve(scene, wear=np.full((11, 11), 2e-3))
    assert contact.P == 0.0
    assert "do not touch" in contact.message
    assert np.isnan(contact.p_max_at).all()
