"""The public names are what they say, also after everything has been imported."""

import pickle
import re
from dataclasses import fields, is_dataclass
from importlib import import_module
from inspect import signature
from pathlib import Path
from pkgutil import walk_packages
from pydoc import render_doc
from types import SimpleNamespace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.schema import Fault


def test_names_outlive_the_import_of_their_rooms():
    """A room named like a function would take its place once imported."""
    scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 21]"])
    for _ in range(2):
        assert ts.roll(scene).finished
        assert ts.solve(scene).converged


def test_every_public_name_is_there_and_documented():
    for name in dir(ts):
        assert getattr(ts, name).__doc__, name


def test_help_of_the_package_begins_with_its_names_by_topic():
    topics = ts.__doc__.partition("Names by topic")[2].partition("Conventions")[0]
    listed = re.findall(r"\b\w+\b", re.sub(r"\*\*.*?\*\*|-{2,}", "", topics))
    assert sorted(listed) == sorted(dir(ts))


def test_help_is_short():
    """Names of annotations, not what they stand for; of tables their own names, not pydantic's."""
    for name in ("solve", "stress_at", "stress_on_plane", "stress_path"):
        assert len(str(signature(getattr(ts, name)))) < 500, name
    assert not {"construct", "copy", "model_fields", "schema"} & set(dir(ts.Scene))
    assert {"builtin", "from_toml", "replace"} <= set(dir(ts.Scene))
    assert ts.Scene.model_fields  # still there for those who ask
    # The heading of the package and its list of modules, not every class; 123 lines today.
    assert len(render_doc(ts).splitlines()) < 200
    assert not {"__pydantic_fields__", "checks"} & set(dir(ts.Wear))


@pytest.mark.parametrize(
    ("package", "earlier", "name"),
    [
        ("solvers", "Solver", "ProblemSolver"),
        ("studies", "Progress", "StudyProgress"),
        ("studies", "Row", "CaseRow"),
        ("tables", "Progress", "TableProgress"),
    ],
)
def test_earlier_names_of_packages_warn(package, earlier, name):
    module = import_module(f"tractive_sam.{package}")
    with pytest.warns(DeprecationWarning, match=name):
        present = getattr(module, earlier)
    assert present is getattr(module, name)


def test_version():
    assert ts.__version__[0].isdigit()


def test_bad_arrays_are_refused_at_the_door():
    scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 21]"])
    other = ts.solve(scene.with_set(["grid.elements=[23, 23]"]))
    for arrays in (
        {"wear": np.zeros(21)},
        {"wear": np.full((21, 21), np.nan)},
        {"start": other},
    ):
        with pytest.raises(ValueError, match=next(iter(arrays))):
            ts.solve(scene, **arrays)


def test_not_converged_crosses_between_processes():
    scene = ts.Scene.builtin("spheres").with_set(["load.approach=0.036", "load.force_x=0.4"])
    with pytest.raises(ts.NotConverged) as caught:
        ts.solve(scene.with_set(["grid.elements=[15, 15]"]))
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)
    assert not again.contact.converged


def classes_of_the_package():
    """Every class that is defined in it."""
    for module in walk_packages(ts.__path__, "tractive_sam."):
        if module.name != "tractive_sam.__main__":
            for found in vars(import_module(module.name)).values():
                if isinstance(found, type) and found.__module__ == module.name:
                    yield found


GIVEN = {
    "GapError": (Path("a.csv"), "no rows", "some rows"),
    "NotConverged": (SimpleNamespace(message="not converged"),),
    "SceneError": ((Fault("load.normal", "-1", "a number above 0"),),),
    "StudyError": ((Fault("axis", "nothing", "at least one"),),),
    "TextError": ("no rows", "some rows"),
}


def test_every_error_crosses_between_processes():
    kinds = [kind for kind in classes_of_the_package() if issubclass(kind, Exception)]
    errors = [kind(*GIVEN.get(kind.__name__, ("a word",))) for kind in kinds]
    assert {type(error).__name__ for error in errors} > {"ResultsError", *GIVEN}
    for error in errors:
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error)
        assert str(again) == str(error)
        assert vars(again) == vars(error)


def test_what_holds_arrays_is_equal_only_to_itself():
    """Arrays have no single truth value and no hash; arrays in arguments of functions are not
    stored."""
    holding = {
        kind
        for kind in filter(is_dataclass, classes_of_the_package())
        for field in fields(kind)
        if "ndarray" in str(field.type).partition("Callable")[0]
    }
    assert {ts.State, ts.PlaneStress, ts.solvers.Outcome} <= holding
    assert not [kind for kind in holding if kind.__eq__ is not object.__eq__]


def test_a_gap_measured_too_short_is_reported():
    tables = ts.Scene.builtin("spheres").entries()
    tables["gap"] = {"x": [-1.0, 1.0], "y": [-5.0, 5.0], "separation": np.zeros((2, 2))}
    with pytest.warns(ts.SceneWarning, match="grid.*x"):
        ts.solve(ts.Scene(**tables))
