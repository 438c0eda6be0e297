import pytest

from tractive_sam.scene import Scene

SPHERE = {"shear": 1.0, "poisson": 0.28, "radius_x": 337.5, "radius_y": 337.5}


@pytest.fixture
def tables():
    """Tables of a small valid scene, free to be spoilt."""
    return {
        "body": {"A": SPHERE.copy(), "B": SPHERE.copy()},
        "load": {"normal": 0.5},
        "friction": {"mu": [0.4, 0.2]},
    }


@pytest.fixture
def spheres(tables):
    return Scene(**tables)
