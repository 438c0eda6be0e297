"""A scene names laws of other packages, with their parameters; a file of results imports none."""

import json
import sys
from itertools import cycle
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app
from tractive_sam.schema import NamedLaw, load_law_class, named_law
from tractive_sam.store.layout import set_scene
from tractive_sam.studies.pool import call_with_laws
from tractive_sam.tables.solving import Job, solve_jobs

FILM_LAWS = '''
"""Laws of a package that is installed beside tractive_sam."""

from dataclasses import dataclass

import numpy as np

import tractive_sam as ts


@dataclass(frozen=True)
class Film(ts.Coulomb):
    """Friction of a film, which carries less of a high pressure."""

    scale: float = 1.0  # MPa

    def bound(self, pressure, x, y):
        return ts.Bound(pressure * (1.0 - pressure / self.scale), 1.0 - 2.0 * pressure / self.scale)


@dataclass(frozen=True)
class ByWork(ts.WearLaw):
    per_work: float  # 1/MPa

    def rate(self, pressure, traction, slip):
        return self.per_work * np.abs((traction * slip).sum(axis=0))


@dataclass(frozen=True)
class Winkler(ts.Elasticity):
    depth: float
    A: object

    def coefficients(self, component, offsets, dx, dy):
        table = np.zeros(offsets)
        if component in ("xx", "yy", "zz"):
            table[0, 0] = self.depth / self.A.shear
        return table


@dataclass(frozen=True)
class Sines(ts.Crossland):
    """Crossland's criterion by another name."""


def no_law(**parameters):
    raise AssertionError("called")
'''

HOSTILE = (
    *("coverage.__main__:x", "IPython.__main__:x", "typer.__main__:x", "numba.__main__:x"),
    *("pip.__main__:x", "tractive_sam.__main__:x", "__main__:x", "os:system", "subprocess:Popen"),
    *(
        "builtins:eval",
        "builtins:type",
        "antigravity:x",
        "this:x",
        "idlelib.idle:x",
        "pickle:loads",
    ),
    *("numpy.conftest:x", "scipy.conftest:x", "numpy:testing", "scipy:datasets", "six:moves"),
    *("ctypes:CDLL", "importlib:import_module", "runpy:run_path", "code:interact", "pdb:run"),
    *("pip._vendor.distlib.t64:x", "lib2to3.tests:x", "turtledemo.__main__:x", "webbrowser:open"),
    *("tractive_sam.mechanics.friction:np", "tractive_sam:FallingCoulomb", "received:Film"),
    *("tractive_sam.cli.program:app", "tractive_sam.compute.fftw:pyfftw", "tractive_sam.tests:x"),
    *("received:Drive", "received.__main__:Film", "xml.sax.expatreader:x", "film_laws.other:Film"),
)
"""Names of modules that run a program, of functions, and of a module `received` on the path."""

NAMED = {
    "friction.law": ts.FrictionLaw,
    "wear.law": ts.WearLaw,
    "elasticity.law": ts.Elasticity,
    "fatigue.criterion": ts.CycleCriterion,
    "process.name": ts.Process,
    "observer[0].name": ts.Observer,
}

SPHERES = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"]).replace(subsurface=None)
DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None)
DISCS = DISCS.with_set(["wear.revolutions=2", "wear.save=[0, 2]", "grid.elements=[15, 31]"])
FILM = ["friction.law=film_laws:Film", "friction.scale=5000"]
STRONG_FILM = ["friction.law=film_laws:Film", "friction.scale=0.05"]  # p_max is .017 MPa
WORN = {"law": "film_laws:ByWork", "per_work": 5e-6, "revolutions": 2, "save": [0, 2]}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Install a package of laws, and remove it from the process afterwards."""
    folder = tmp_path / "installed"
    about = folder / "film_laws-1.0.dist-info"
    about.mkdir(parents=True)
    (folder / "film_laws.py").write_text(FILM_LAWS)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: film-laws\nVersion: 1.0\n")
    names = {"film": "Film", "work": "ByWork", "winkler": "Winkler", "sines": "Sines"}
    entries = "".join(f"{name} = film_laws:{law}\n" for name, law in names.items())
    (about / "entry_points.txt").write_text(f"[tractive_sam.laws]\n{entries}")
    monkeypatch.syspath_prepend(folder)
    yield folder
    sys.modules.pop("film_laws", None)


def faults(scene):
    with pytest.raises(ts.SceneError) as caught:
        ts.Laws.of(scene)
    return {fault.key: fault.allowed for fault in caught.value.faults}


@pytest.mark.usefixtures("package")
class TestNamedLaw:
    def test_is_the_law_that_laws_would_replace(self):
        named = ts.solve(DISCS.with_set(FILM))
        from film_laws import Film  # noqa: PLC0415

        scene = DISCS.friction
        law = Film(scene.mu, np.deg2rad(scene.angle), 5000.0)
        given = ts.solve(DISCS, laws=ts.Laws.of(DISCS).replace(friction=law))
        np.testing.assert_array_equal(named.traction, given.traction)
        np.testing.assert_array_equal(named.bound, given.bound)

    def test_entry_point_is_a_name_of_it(self):
        by_entry_point = SPHERES.with_set(["friction.law=film", "friction.scale=5000"])
        assert by_entry_point == SPHERES.with_set(FILM)
        assert "film_laws:Film" in by_entry_point.to_toml()

    def test_scene_is_read_again_from_its_text(self):
        scene = DISCS.with_set(FILM).replace(wear=WORN)
        assert ts.Scene.from_toml_text(scene.to_toml()) == scene
        assert scene.fingerprint() != scene.with_set(["friction.scale=4000"]).fingerprint()

    def test_wear(self):
        history = ts.roll(DISCS.replace(wear=WORN))
        expected = 5e-6 * history["dissipation"][-1]  # depth rate 5e-6 /MPa of the work
        assert history["worn_area"][-1] == pytest.approx(expected, rel=1e-6)
        assert "ByWork" in history.laws

    def test_elasticity_takes_the_materials_of_the_scene(self):
        soft = SPHERES.replace(elasticity={"law": "film_laws:Winkler", "depth": 2.0})
        contact = ts.solve(soft)
        deepest = 2.0 * contact.p_max  # G = 1
        assert contact.approach == pytest.approx(deepest, rel=1e-6)  # solver tolerance 1e-8
        laws = next(one for one in ts.explain(soft) if one.title == "Laws of other packages")
        assert dict(laws.rows) == {"elasticity": ts.Laws.of(soft).elasticity.describe()}

    def test_with_named_elasticity_the_grid_is_not_compared_with_hertz(self):
        """The same load on a stiff foundation has a contact smaller than the grid."""
        grid = {"elements": [21, 21], "half_length": [0.5 * SPHERES.hertz.a] * 2}
        stiff = {"law": "film_laws:Winkler", "depth": 0.01}
        scene = SPHERES.replace(elasticity=stiff, grid=grid)
        assert 0.0 < ts.solve(scene).half_width_x < grid["half_length"][0]
        with pytest.raises(ts.SceneError, match=r"grid\.half_length"):
            SPHERES.replace(grid=grid)

    def test_fatigue_criterion(self):
        plain = {"criterion": "crossland", "sensitivity": 0.3, "limit": 1.0, "bodies": ["A"]}
        scene = SPHERES.replace(fatigue=plain)
        named = SPHERES.replace(fatigue=plain | {"criterion": "film_laws:Sines"})
        of_both = (ts.fatigue(ts.solve(one))["A"].largest().value for one in (scene, named))
        assert len({float(one) for one in of_both}) == 1

    def test_every_wrong_parameter_is_a_fault(self):
        assert faults(DISCS.with_set([*FILM, "friction.scole=1"])).keys() == {"friction.scole"}
        assert faults(DISCS.with_set([*FILM, "friction.scale=high"])).keys() == {"friction.scale"}
        missing = {"law": "film_laws:ByWork", "per_works": 1.0, "revolutions": 2}
        found = faults(DISCS.replace(wear=missing))
        assert found.keys() == {"wear.per_work", "wear.per_works"}
        assert "per_work" in found["wear.per_works"]

    def test_only_laws_for_the_key_are_called(self):
        for name in ("film_laws:ByWork", "film_laws:no_law", "film_laws:absent", "absent:Law"):
            assert faults(DISCS.with_set([f"friction.law={name}"])).keys() == {"friction.law"}

    def test_mu_of_the_table_is_that_of_the_frame(self):
        class Own(ts.Coulomb):
            def __init__(self):
                super().__init__((0.2, 0.2))

        sys.modules["film_laws"] = SimpleNamespace(Own=Own)  # as a module that is imported
        scene = SPHERES.with_set(["friction.law=film_laws:Own"])
        assert "friction.mu" in "".join(faults(scene))
        assert ts.Laws.of(scene.with_set(["friction.mu=0.2"])).friction == Own()

    def test_blocks_and_cases_have_their_own(self):
        scales = [4000.0, 6000.0]
        cases = ts.solve_many(DISCS.with_set(FILM), {"friction.scale": scales})
        single = [ts.solve(DISCS.with_set([*FILM, f"friction.scale={one}"])).Qx for one in scales]
        np.testing.assert_allclose(cases["Qx"], single, rtol=1e-6)  # the solver starts elsewhere
        block = {"revolutions": 1, "friction": {"mu": 0.2}}
        duty = DISCS.with_set(FILM).replace(duty=[{"revolutions": 1}, block])
        assert [one.state(0).frame.mu for one in map(ts.roll(duty).block, (0, 1))] == [
            DISCS.friction.mu,
            (0.2, 0.2),
        ]

    def test_parameters_are_keys_of_studies(self):
        axis = {"key": "friction.scale", "values": [4000.0, 6000.0]}
        study = ts.Study(scene=DISCS.with_set(FILM), axis=[axis])
        assert [
            case.scene.friction.law.parameters["scale"] for case in ts.studies.cases(study)
        ] == axis["values"]

    def test_a_study_solves_with_it(self, tmp_path):
        scene, steps = SPHERES.with_set(STRONG_FILM), [-1e-3, -4e-3]
        axis = {"key": "creepage.longitudinal", "values": steps}
        cases = ts.Study(scene=scene, axis=[axis], keep="scalars")
        found = ts.study(cases, tmp_path / "a", workers=0).column("Qx")
        of_film, of_coulomb = (
            [ts.solve(one.replace(**{axis["key"]: step})).Qx for step in steps]
            for one in (scene, SPHERES)
        )
        # Each case starts from the one before: equal to the tolerance of the solver, 1e-8.
        np.testing.assert_allclose(found, of_film, rtol=1e-6)
        assert (np.array(of_film) < of_coulomb).all()

    def test_contacts_of_a_table_have_it(self):
        """Solved as they are on workers: from the text of the design, at scaled creepages."""
        creepages = -0.3, 0.1, 0.0
        film, coulomb = (
            abs(solve_jobs(design.to_toml(), [Job((), creepages)]).solutions[0].force[0])
            for design in (
                ts.TableDesign(scene=scene, elements=15, tolerance=0.2)
                for scene in (SPHERES.with_set(STRONG_FILM), SPHERES)
            )
        )
        assert film < 0.95 * coulomb

    def test_run_resumes_with_the_same_law(self, tmp_path):
        longer = ["wear.revolutions=4", "wear.save=[0, 2, 4]"]
        scene = DISCS.with_set(FILM)
        ts.roll(scene, tmp_path / "film.h5")
        resumed = ts.roll(scene.with_set(longer), tmp_path / "film.h5", resume=True)
        whole = ts.roll(scene.with_set(longer))
        np.testing.assert_allclose(resumed["Qx"], whole["Qx"], rtol=1e-7)  # solver tolerance 1e-8
        with pytest.raises(ts.ResultsError):
            ts.roll(DISCS.with_set(longer), tmp_path / "film.h5", resume=True)

    def test_tables_of_creep_forces_assume_no_symmetry(self):
        design = ts.TableDesign(scene=DISCS.with_set(FILM).replace(wear=None))
        assert design.symmetries == (False, False)


@pytest.fixture
def received(tmp_path, monkeypatch):
    """Put modules on the path that no package registers; return the file that they would write."""
    mark = tmp_path / "imported"
    source = f"open({str(mark)!r}, 'w').close()\n{FILM_LAWS}\nDrive = Film\n"
    folder = tmp_path / "on-the-path"
    (folder / "received").mkdir(parents=True)
    for name in ("__init__", "__main__"):
        (folder / "received" / f"{name}.py").write_text(source)
    monkeypatch.syspath_prepend(folder)
    yield mark
    sys.modules.pop("received", None)


class TestImports:
    """What a name in a scene may import."""

    @pytest.mark.usefixtures("package")
    def test_no_name_imports_what_is_neither_registered_nor_allowed(self, received):
        before = set(sys.modules)
        for (key, base), name in zip(cycle(NAMED.items()), HOSTILE):
            with pytest.raises(ts.SceneError) as caught:
                load_law_class(key, NamedLaw(name, {}), base)
            assert [fault.key for fault in caught.value.faults] == [key], name
        assert set(sys.modules) == before
        assert not received.exists()

    @pytest.mark.parametrize("allowed", ["received:Film", "received"])
    def test_an_allowed_name_is_imported(self, received, allowed):
        scene = SPHERES.with_set(["friction.law=received:Film"])
        assert "--allow received:Film" in faults(scene)["friction.law"]
        ts.allow_laws(allowed)
        assert type(ts.Laws.of(scene).friction).__name__ == "Film"
        assert received.exists()
        no_law = faults(SPHERES.with_set(["friction.law=received:no_law"]))
        assert ("--allow" in no_law["friction.law"]) is (":" in allowed)

    def test_commands_and_workers_import_what_the_command_allows(self, received, tmp_path):
        scene = tmp_path / "scene.toml"
        scene.write_text(SPHERES.with_set(["friction.law=received:Film"]).to_toml())
        command = ["explain", str(scene), "--allow", "received:Film"]
        assert CliRunner().invoke(app, command[:2]).exit_code == 2
        assert CliRunner().invoke(app, [*command[:2], "--allow", "no name"]).exit_code == 2
        assert not received.exists()
        assert CliRunner().invoke(app, command).exit_code == 0
        allowed_there = call_with_laws(("other:Law",), (ts.allow_laws,))
        assert allowed_there == ("other:Law", "received:Film")

    @pytest.mark.usefixtures("received")
    @pytest.mark.parametrize("name", ["a b", "a:b:c", "x.__main__:y", "__main__", ""])
    def test_a_program_cannot_be_allowed(self, name):
        with pytest.raises(ValueError, match="allowed"):
            ts.allow_laws(name)

    @pytest.mark.usefixtures("received")
    def test_a_class_of_the_program_needs_no_permission(self, monkeypatch):
        class Mine(ts.Coulomb):
            pass

        monkeypatch.setitem(sys.modules, "my_program", SimpleNamespace(Mine=Mine))
        scene = SPHERES.with_set(["friction.law=my_program:Mine"])
        assert type(ts.Laws.of(scene).friction) is Mine

    def test_metadata_of_an_editable_source_folder_register_nothing(self, tmp_path, monkeypatch):
        """The interpreter searches this folder, and received files may be in it."""
        clone, site = tmp_path / "clone", tmp_path / "clone/.venv/site-packages"
        for folder, name in ((clone, "received"), (site, "mine")):
            about = folder / f"{name}-1.0.dist-info"
            about.mkdir(parents=True)
            (about / "METADATA").write_text(f"Name: {name}\nVersion: 1.0\n")
            (about / "entry_points.txt").write_text(f"[tractive_sam.laws]\n{name} = {name}:Law\n")
            origin = {"url": clone.as_uri(), "dir_info": {"editable": True}}
            (about / "direct_url.json").write_text(json.dumps(origin))
            monkeypatch.syspath_prepend(folder)
        names = {point.name for point in named_law.installed_entry_points("tractive_sam.laws")}
        assert "mine" in names
        assert "received" not in names

    def test_reading_and_opening_import_nothing(self, package, tmp_path):
        scene = DISCS.with_set(FILM).replace(wear=WORN)
        written = tmp_path / "scene.toml"
        written.write_text(scene.to_toml())
        assert ts.Scene.from_toml(written) == scene
        assert "film_laws" not in sys.modules
        ts.roll(scene, tmp_path / "film.h5")
        del sys.modules["film_laws"]

        history = ts.open_history(tmp_path / "film.h5")
        contact = history.state(2)
        assert contact.bound.max() < contact.p_max
        assert contact.frame == scene.friction.frame
        assert np.isnan(history.wear_balance).all()
        assert np.isfinite(ts.stress_at(contact, [(0.0, 0.0, 0.1)])).all()
        ts.plot.traction(contact)
        ts.report(history, tmp_path / "film.html")
        assert "film_laws" not in sys.modules

    def test_commands_read_results_without_the_package(self, package, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        Path("scene.toml").write_text(DISCS.with_set(FILM).to_toml())
        ran = CliRunner().invoke(app, ["run", "scene.toml", "-o", "film.h5"])
        assert ran.exit_code == 0, ran.output
        sys.path.remove(str(package))
        del sys.modules["film_laws"]
        shown = CliRunner().invoke(app, ["show", "film.h5"])
        assert shown.exit_code == 0, shown.output
        assert "Film" in shown.stdout
        again = CliRunner().invoke(app, ["run", "scene.toml", "-o", "again.h5"])
        assert again.exit_code == 2
        assert "friction.law" in again.stderr

    @pytest.mark.parametrize("metadata", [False, True])
    def test_files_next_to_a_scene_are_not_imported(self, tmp_path, monkeypatch, metadata):
        """`python -m` searches the current folder, which may have been received with a scene."""
        monkeypatch.chdir(tmp_path)
        monkeypatch.syspath_prepend(tmp_path)
        (tmp_path / "film_laws.py").write_text("open('imported', 'w')\n" + FILM_LAWS)
        (tmp_path / "scene.toml").write_text(SPHERES.with_set(FILM).to_toml())
        if metadata:
            about = tmp_path / "film_laws-1.0.dist-info"
            about.mkdir()
            (about / "METADATA").write_text("Name: film-laws\nVersion: 1.0\n")
            (about / "entry_points.txt").write_text("[tractive_sam.laws]\nfilm = film_laws:Film\n")
        ran = CliRunner().invoke(app, ["explain", "scene.toml"])
        assert ran.exit_code == 2
        assert "friction.law" in ran.stderr
        assert not (tmp_path / "imported").exists()

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("number", "table"),
        [*enumerate(("friction", "wear", "elasticity", "fatigue", "process", "observer"))],
    )
    def test_no_command_imports_what_a_file_names(
        self, received, tmp_path, monkeypatch, number, table
    ):
        """Names in scenes, studies, fits and results files: other names in each table."""
        monkeypatch.chdir(tmp_path)
        tired = {"criterion": "crossland", "sensitivity": 0.3, "limit": 1.0, "bodies": ["A"]}
        tables = {
            "friction": lambda name: DISCS.friction.entries() | {"law": name},
            "wear": lambda name: {"law": name, "revolutions": 2, "save": [0, 2]},
            "elasticity": lambda name: {"law": name},
            "fatigue": lambda name: tired | {"criterion": name},
            "process": lambda name: {"name": name, "end": 3},
            "observer": lambda name: [{"name": name}],
        }
        base = DISCS.replace(wear=None) if table == "process" else DISCS
        ts.roll(base, "right.h5")
        axis = '[[axis]]\nkey = "load.normal"\nvalues = [100.0, 200.0]\n'
        data = '[[fit.data]]\nobserve = "Qx"\nnoise = 0.1\nvalues = { Qx = [1.0] }\n'
        Path("fit.toml").write_text(f'[fit]\nscene = "s.toml"\nfree = "load.normal"\n{data}')
        Path("study.toml").write_text(f'scene = "s.toml"\n{axis}')
        commands = (
            *("run s.toml -o a.h5 --overwrite", "explain s.toml", "export s.toml -o a.vtkhdf"),
            *("explain study.toml", "fit fit.toml -o a.nc", "show right.h5"),
            "run s.toml -o right.h5 --resume",
        )
        before = set(sys.modules)
        for name in HOSTILE[number::12]:
            scene = base.replace(**{table: tables[table](name)})
            Path("s.toml").write_text(scene.to_toml())
            with h5py.File("right.h5", "r+") as file:
                set_scene(file, scene)
            for command in commands:
                found = CliRunner().invoke(app, command.split())
                assert found.exit_code in (0, 2), (name, command, found.exception)
                assert found.exit_code == 2 or command.startswith(("show", "fit")), (name, command)
        modules = {name.partition(":")[0] for name in HOSTILE}
        assert not modules & (set(sys.modules) - before)
        assert not received.exists()


def test_laws_of_the_package_need_no_permission():
    key, wear = "tractive_sam.mechanics.wear:Energy", {"revolutions": 1, "per_work": [5e-6, 2e-6]}
    named = DISCS.replace(wear={"law": key, **wear})
    assert ts.Laws.of(named).wear == ts.Energy((5e-6, 2e-6), named.friction.frame.angle)
    with pytest.raises(ts.SceneError, match=r"friction\.law.*FrictionLaw"):
        ts.Laws.of(DISCS.replace(friction={"mu": 0.3, "law": key}))
