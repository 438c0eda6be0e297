"""The public names are what they say, also after everything has been imported."""

import pickle

import numpy as np
import pytest

import tractive_sam as ts


def test_names_outlive_the_import_of_their_rooms():
    """A room named like a function would take its place once imported."""
    scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 21]"])
    for _ in range(2):
        assert ts.roll(scene).finished
        assert ts.solve(scene).converged


def test_every_public_name_is_there_and_documented():
    for name in ts.__all__:
        assert getattr(ts, name).__doc__, name


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
    scene = ts.Scene.builtin("spheres").with_set(["load.approach=0.036", "load.traction_x=0.4"])
    with pytest.raises(ts.NotConverged) as caught:
        ts.solve(scene.with_set(["grid.elements=[15, 15]"]))
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)
    assert not again.contact.converged


def test_a_gap_measured_too_short_is_told():
    tables = ts.Scene.builtin("spheres").entries()
    tables["gap"] = {"x": [-1.0, 1.0], "y": [-5.0, 5.0], "separation": np.zeros((2, 2))}
    with pytest.warns(ts.SceneWarning, match="covers less than the grid in x"):
        ts.solve(ts.Scene(**tables))
