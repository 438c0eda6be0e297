import numpy as np
import pytest

from tractive_sam.reference import giwm
from tractive_sam.scene import Scene


def discs(creepage=-0.005, intensity=2e-6, revolutions=100):
    scene = Scene.builtin("twin-discs-isotropic")
    hertz, E_star = scene.hertz, scene.material.E_star
    radii = (scene.body.A.radius_x, scene.body.B.radius_x)
    across = scene.body.radii[1]
    return giwm(
        scene.load.normal,
        E_star,
        radii,
        across,
        (hertz.a, hertz.b),
        creepage,
        intensity,
        revolutions,
    )


def test_published_course(published):
    course = discs(revolutions=15000)
    for revolution, (depth, b) in published["GIWM"]["twin-discs-isotropic"].items():
        # Four digits are given.
        assert course.depth[int(revolution)] == pytest.approx(depth, rel=3e-4)
        assert course.b[int(revolution)] == pytest.approx(b, rel=3e-4)


def test_first_revolution_wears_a_mean_pressure_over_the_contact():
    course = discs(revolutions=1)
    slid = 2.0 * course.a[0] * 0.005 / (1 - 0.0025)
    assert course.depth[1] == pytest.approx(2e-6 * course.pressure[0] * slid, rel=1e-12)


def test_contact_widens_and_pressure_falls():
    course = discs()
    assert (np.diff(course.depth) > 0).all()
    # Its first revolutions turn the Hertz contact into the model's own.
    assert (np.diff(course.b[10:]) > 0).all()
    assert (np.diff(course.pressure[10:]) < 0).all()


def test_creepage_and_intensity_are_one_factor():
    """To the first order in the creepage: the mean speed is half of it below the speed of disc
    A."""
    np.testing.assert_allclose(
        discs(creepage=-0.002, intensity=5e-6).depth[1:], discs().depth[1:], rtol=2e-3
    )


def test_sizes_must_be_positive():
    with pytest.raises(ValueError, match="intensity"):
        discs(intensity=0.0)
