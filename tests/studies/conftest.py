import pytest

from tractive_sam.studies import Study

MU = {"key": "friction.mu", "values": [0.2, 0.4]}
CREEPAGE = {"key": "creepage.longitudinal", "start": -1e-3, "stop": -3e-3, "number": 3}


def small(*axes, **given):
    """A study of new spheres on a coarse mesh, which takes a moment a case."""
    coarse = {"scene": "spheres", "without": ["subsurface"], "set": ["grid.elements=[21, 21]"]}
    return Study(**coarse | {"axis": axes or (CREEPAGE, MU)} | given)


@pytest.fixture
def written(tmp_path):
    """Write a study file; returns its path."""

    def write(text, name="study.toml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write
