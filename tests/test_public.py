"""The public names are what they say, also after everything has been imported."""

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
