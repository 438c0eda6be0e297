"""Examples in docstrings run, and every public name has one.

They begin with the objects of the example in the package's docstring.
"""

import doctest
from importlib import import_module
from pkgutil import iter_modules

import pytest

import tractive_sam
import tractive_sam.solvers
import tractive_sam.studies
from tractive_sam.plot import registry

STUDIES = sorted(one.name for one in iter_modules(tractive_sam.studies.__path__))

ROOMS = ("tractive_sam", "tractive_sam.plot", "tractive_sam.subsurface", "tractive_sam.reference")

SLOW = {
    "tractive_sam.FitResult",
    "tractive_sam.WornProfiles",
    "tractive_sam.build_table",
    "tractive_sam.fit",
    "tractive_sam.open_fit",
    "tractive_sam.OptimumResult",
    "tractive_sam.design",
    "tractive_sam.open_design",
    "tractive_sam.open_spread",
    "tractive_sam.spread",
    "tractive_sam.SpreadResult",
    "tractive_sam.plot.Measurements",
    "tractive_sam.plot.energies",
    "tractive_sam.plot.line_pressures",
    "tractive_sam.plot.measured_column",
    "tractive_sam.plot.save_all",
    "tractive_sam.plot.worn_sections",
    "tractive_sam.plot.worn_track",
    "tractive_sam.plot.worn_wheel_and_rail",
    "tractive_sam.plot.worn_wheel_of_history",
    "tractive_sam.subsurface.course_fatigue",
    "tractive_sam.wear_profiles",
}
"""Names with examples that take seconds."""


def list_names():
    """Yield each public object that is callable once, with the first room that names it."""
    listed = set()
    for room in ROOMS:
        for name in dir(import_module(room)):
            path = f"{room}.{name}"
            marks = [pytest.mark.slow] if path in SLOW else []
            is_of_studies = name in tractive_sam.studies.__all__
            entry = getattr(import_module(room), name)
            if callable(entry) and not is_of_studies and id(entry) not in listed:
                listed.add(id(entry))
                yield pytest.param(room, name, marks=marks, id=path)


@pytest.fixture(scope="module")
def package():
    """Return the names that the package's docstring defines, and numpy."""
    (test,) = (
        found
        for found in doctest.DocTestFinder(recurse=False).find(tractive_sam)
        if found.name == "tractive_sam"
    )
    test.globs |= {"np": import_module("numpy"), "plot": import_module("tractive_sam.plot")}
    runner = doctest.DocTestRunner()
    result = runner.run(test, clear_globs=False)
    assert result.attempted > 0
    assert result.failed == 0
    return test.globs


@pytest.mark.usefixtures("empty_pictures", "few_table_nodes")
@pytest.mark.parametrize(("room", "name"), list(list_names()))
def test_example(room, name, package, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for entries in ("HISTORY_FIGURES", "CONTACT_FIGURES"):  # an example may register a figure
        monkeypatch.setattr(registry, entries, dict(getattr(registry, entries)))
    module = import_module(room)
    known = package | {public: getattr(module, public) for public in dir(module)}
    finder = doctest.DocTestFinder(recurse=False)
    tests = finder.find(getattr(module, name), name, globs=known)
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    attempted = sum(runner.run(test).attempted for test in tests)
    assert attempted > 0, "a public name needs an example"
    assert runner.summarize(verbose=False).failed == 0


def test_example_of_solvers(package):
    finder, runner = doctest.DocTestFinder(recurse=False), doctest.DocTestRunner()
    (test,) = finder.find(tractive_sam.solvers, "solvers", globs=package)
    assert runner.run(test).attempted > 0
    assert runner.summarize(verbose=False).failed == 0


@pytest.mark.parametrize("module", ["", *STUDIES])
def test_examples_of_studies(module, tmp_path, monkeypatch):
    for needed in ("xarray", "h5netcdf"):
        pytest.importorskip(needed, reason=f"{needed} is of the extra study")
    monkeypatch.chdir(tmp_path)
    found = import_module(f"tractive_sam.studies.{module}".rstrip("."))
    assert doctest.testmod(found, optionflags=doctest.ELLIPSIS).failed == 0


def test_every_public_name_of_studies_has_an_example():
    for name in tractive_sam.studies.__all__:
        found = getattr(tractive_sam.studies, name)
        if callable(found):
            assert ">>> " in found.__doc__, name
