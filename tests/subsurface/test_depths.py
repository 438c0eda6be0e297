import numpy as np
import pytest

from tractive_sam.scene import Subsurface
from tractive_sam.subsurface import depths


@pytest.mark.parametrize("elements", [2, 3, 64])
def test_from_the_surface_to_the_bottom(elements):
    z = depths(Subsurface(planes=("y=0",), depth=1.5, elements=elements), a=2.0)
    assert z.size == elements
    assert z[0] == 0.0
    assert z[-1] == 3.0


def test_graded_towards_the_surface():
    z = depths(Subsurface(planes=("y=0",)), a=1.0)
    steps = np.diff(z)
    assert (np.diff(steps) > 0).all()
    assert steps[0] == pytest.approx(0.003, rel=0.01)
    assert steps[-1] == pytest.approx(0.036, rel=0.02)
