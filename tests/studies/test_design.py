import pytest

from tests.studies.conftest import CREEPAGE, MU, small
from tractive_sam.scene import Scene
from tractive_sam.schema import toml
from tractive_sam.studies import Study, StudyError, cases, is_study

WHOLE = """
title = "Creep forces"
scene = "spheres-orthotropic"
without = ["subsurface"]
set = ["solver.tolerance=1e-9"]

[[axis]]
key = "friction.angle"
values = [0, 45, 90]

[[axis]]
key = "load.normal"
start = 0.1
stop = 0.6
number = 4
spacing = "logarithmic"

[[axis.zip]]
key = "creepage.lateral"
values = [0.0, 0.0, 1e-4, 2e-4]

[latin]
number = 5
seed = 1

[[latin.variable]]
key = "creepage.longitudinal"
start = -0.001
stop = -0.005
"""


ONE_AXIS = '[[axis]]\nkey = "friction.mu"\nvalues = [0.2, 0.4]\n'


def test_file_of_a_study(written):
    study = Study.from_toml(written(WHOLE))
    assert is_study(written(WHOLE))
    assert study.scene.subsurface is None
    assert study.scene.solver.tolerance == 1e-9
    assert study.shape == (3, 4, 5)
    assert len(cases(study)) == len(study) == 60


def test_what_is_written_is_read_back(written):
    study = Study.from_toml(written(WHOLE))
    assert Study.from_toml(written(study.to_toml(), "again.toml")) == study


def test_last_axis_is_the_fastest():
    found = [tuple(case.changes.values()) for case in cases(small(MU, CREEPAGE))]
    assert found == [(mu, xi) for mu in (0.2, 0.4) for xi in (-1e-3, -2e-3, -3e-3)]


def test_scenes_of_the_cases():
    for case in cases(small()):
        wanted = small().scene.replace(**case.changes)
        assert case.scene == wanted


def test_digest_is_that_of_the_scene_only():
    before = {case.digest: case.scene for case in cases(small(MU, CREEPAGE))}
    after = {case.digest: case.scene for case in cases(small(CREEPAGE, MU, title="Other"))}
    assert before == after
    assert len(before) == 6


def test_scene_file_next_to_the_study(written):
    written(Scene.builtin("spheres").to_toml(), "mine.toml")
    assert len(Study.from_toml(written(f'scene = "mine.toml"\n{ONE_AXIS}'))) == 2


def test_gap_files_next_to_the_study(written, tmp_path):
    """They are part of the scene: another content is another case, and an equal one is not."""
    gap = "x,y,separation\n" + "".join(f"{x},{y},0.001\n" for x in (-9.0, 9.0) for y in (-9.0, 9.0))
    written(gap, "one.csv")
    written(gap.replace("0.001", "0.003"), "two.csv")
    axis = '[[axis]]\nkey = "gap.file"\nvalues = ["one.csv", "two.csv"]\n'
    scene = 'scene = "spheres"\n'
    path = written(scene + axis)
    before = cases(Study.from_toml(path))
    assert before[0].scene.gap.file == tmp_path / "one.csv"
    written(gap.replace("0.001", "0.002"), "one.csv")
    after = cases(Study.from_toml(path))
    assert before[0].digest != after[0].digest
    assert before[1].digest == after[1].digest
    written(gap.replace("0.001", "0.003"), "one.csv")
    with pytest.raises(StudyError, match="twice"):
        cases(Study.from_toml(path))
    friction = {"key": "friction.mu", "values": [0.1, 0.2]}
    zipped = f"[[axis]]\n{toml.emit(friction)}{axis.replace('[[axis]]', '[[axis.zip]]')}"
    assert [case.scene.gap.file for case in cases(Study.from_toml(written(scene + zipped)))] == [
        tmp_path / "one.csv",
        tmp_path / "two.csv",
    ]


def test_profiles_that_travel_are_read_next_to_the_study_and_count(written, tmp_path, monkeypatch):
    bump = "x,y,separation\n" + "".join(f"{x},{y},0.001\n" for x in (0, 9) for y in (-9, 9))
    written(bump, "one.csv")
    text = (
        'scene = "traction-control"\n[[axis]]\nkey = "transient.profile.B.file"\n'
        'values = ["one.csv", "two.csv"]\n'
    )
    file = written(text)
    monkeypatch.chdir("/")
    written(bump.replace("0.001", "0.003"), "two.csv")
    before = cases(Study.from_toml(file))
    written(bump.replace("0.001", "0.002"), "two.csv")
    after = cases(Study.from_toml(file))
    assert before[0].digest == after[0].digest
    assert before[1].digest != after[1].digest
    written("9,9", "two.csv")
    with pytest.raises(StudyError) as raised:
        cases(Study.from_toml(file))
    assert raised.value.faults[0].key == "transient.profile.B.file"


@pytest.mark.parametrize("setting", ["gap.file=one.csv", "gap.file = 'one.csv'"])
def test_gap_file_that_is_set_is_next_to_the_study(written, tmp_path, setting):
    written("x,y,separation\n", "one.csv")
    study = Study.from_toml(written(toml.emit({"scene": "spheres", "set": [setting]}) + ONE_AXIS))
    assert study.scene.gap.file == tmp_path / "one.csv"


def test_gap_files_of_an_axis_are_the_same_from_another_folder(written, tmp_path, monkeypatch):
    for name, depth in (("one.csv", 0.001), ("two.csv", 0.002)):
        written(f"x/y,-9.0,9.0\n-9.0,{depth},{depth}\n9.0,{depth},{depth}\n", name)
    monkeypatch.chdir(tmp_path)
    files = {"key": "gap.file", "values": ["one.csv", "two.csv"]}
    for axis in (files, {**MU, "zip": [files]}):
        study = small(axis)
        (tmp_path / "other").mkdir(exist_ok=True)
        again = Study.from_toml(written(study.to_toml(), "other/study.toml"))
        assert [one.digest for one in cases(again)] == [one.digest for one in cases(study)]


def test_fault_of_many_scenes_is_reported_once():
    with pytest.raises(StudyError) as caught:
        cases(small(CREEPAGE, {"key": "load.normal", "values": [0.4, -1]}))
    (fault,) = caught.value.faults
    assert fault.key == "load.normal"
    assert "in case 1 (creepage.longitudinal = -0.001, load.normal = -1) and 2 more" in fault.given


def test_scenes_that_are_the_same_are_refused():
    with pytest.raises(StudyError, match=r"axis.*case 1 "):
        cases(small({"key": "title", "values": ["a", "b"]}))


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("scene = 3", "scene: given 3"),
        ('scene = "spheers"', "scene: given 'spheers'.*spheres"),
        ('scene = "no.toml"', "scene: given '.*no.toml'"),
        ("", "scene: given nothing"),
        ('scene = "spheres"', r"axis: given nothing.*\[\[axis\]\]"),
        ('scene = "spheres"\naxis = 3', "axis: given 3"),
        ('scene = "spheres"\naxis = [3]', r"axis\[0\]: given 3"),
        ('scene = "spheres"\nlatin = 3', "latin: given 3"),
        ('scene = "spheres"\nset = "a"', "set: given 'a'"),
        ('scene = "spheres"\nset = ["load.normal=-1"]', "scene.load.normal: given -1"),
        ('scene = "spheres"\nwithout = ["subsurfac"]', "without: .*subsurface"),
        ('scene = "spheres"\nwithot = []', "withot: .*without"),
        ("scene = {}\nscene = {}", r"\(file\): .*TOML"),
        (
            'scene = "spheres"\naxis = [{key = "friction.mu", values = [0.1]}]\n'
            '[latin]\nnumber = 2\nvariable = [{key = "friction.mu", start = 0, stop = 1}]',
            "axis: given friction.mu",
        ),
        (
            'scene = "spheres"\n'
            '[[axis]]\nkey = "friction.mu"\nstart = 0.1\nstop = 0.2\nnumber = 2000\n'
            '[[axis]]\nkey = "load.normal"\nstart = 0.1\nstop = 0.2\nnumber = 2000\n',
            "axis: given 4000000 cases",
        ),
    ],
)
def test_bad_files(written, text, reported):
    with pytest.raises(StudyError, match=reported):
        Study.from_toml(written(text))


def test_faults_are_reported_together():
    with pytest.raises(StudyError) as caught:
        Study(scene="nothing", oops=1, axis=[{"key": "friction.mu"}], latin={"number": 0})
    assert [fault.key for fault in caught.value.faults] == [
        "oops",
        "scene",
        "axis[0].values",
        "latin.number",
        "latin.variable",
    ]


def test_a_scene_is_no_study(written):
    assert not is_study(written(Scene.builtin("spheres").to_toml()))
    assert not is_study("spheres")


def test_a_table_and_an_entry_of_it_do_not_vary_together():
    """The second would undo the first."""
    tables = {"key": "friction", "values": [{"mu": 0.2}, {"mu": 0.3, "angle": 30.0}]}
    entries = {"key": "friction.mu", "values": [0.4, 0.5]}
    with pytest.raises(StudyError, match=r"friction.*friction\.mu"):
        Study(scene="spheres", axis=[tables, entries])
