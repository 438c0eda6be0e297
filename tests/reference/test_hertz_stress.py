import numpy as np
import pytest
from scipy.integrate import quad

from tests.kernels.test_stress import force_normal, force_shear_x
from tractive_sam.mechanics.criteria import von_mises
from tractive_sam.reference import circle_pressure_stress, circle_shear_stress, hertz_axis_stress

XX, YY, ZZ, XY, XZ, YZ = range(6)
NU = 0.3
POINTS = [
    (0.3, 0.4, 0.5),
    (-0.3, 0.8, 0.4),
    (1.5, 0.2, 0.3),
    (-2, 0.7, 1),
    (0.1, 3, 2),
    (1, 0, 0.3),
]


def over_circle(force, x, y, z):
    """Integral of a point force's stresses times sqrt(1 - r^2): r = sin(t), nested quadrature."""
    angles = 2 * np.pi * np.arange(256) / 256  # periodic: converges geometrically

    def ring(t, component):
        r = np.sin(t)
        stress = force(x - r * np.cos(angles), y - r * np.sin(angles), z, NU)[component]
        return stress.mean() * 2 * np.pi * r * np.cos(t) ** 2

    return [quad(ring, 0, np.pi / 2, args=(c,), epsabs=1e-12, epsrel=0)[0] for c in range(6)]


@pytest.mark.parametrize("point", POINTS)
def test_circle_equals_quadrature(point):
    # 1e-10: the quadrature's own error with 256 angles at depth 0.3
    pressed, sheared = (
        circle_pressure_stress(*point, 1.0, 1.0, NU),
        circle_shear_stress(*point, 1.0, 1.0, NU),
    )
    np.testing.assert_allclose(pressed, over_circle(force_normal, *point), atol=1e-10)
    np.testing.assert_allclose(sheared, over_circle(force_shear_x, *point), atol=1e-10)


def test_circle_is_hertz_on_its_axis():
    z = np.array([0.0, 1e-6, 0.1, 0.5, 1.0, 3.0])
    on_axis = hertz_axis_stress(z, 2.0, 3.0, NU)
    np.testing.assert_allclose(circle_pressure_stress(0, 0, z, 2.0, 3.0, NU), on_axis, atol=1e-13)


def test_circle_at_the_surface():
    x = np.array([0.0, 0.5, 0.9, 1.5])
    pressure = np.sqrt(np.maximum(1 - x * x, 0))
    pressed, sheared = (
        circle_pressure_stress(x, 0, 0, 1, 1, NU),
        circle_shear_stress(x, 0, 0, 1, 1, NU),
    )
    np.testing.assert_allclose(pressed[[ZZ, XZ, YZ]], [-pressure, 0 * x, 0 * x], atol=1e-14)
    np.testing.assert_allclose(sheared[[XZ, ZZ, YZ]], [-pressure, 0 * x, 0 * x], atol=1e-14)


def test_tension_behind_a_sliding_sphere():
    # Hamilton and Goodman (1966): at the edge that the traction pulls away from
    behind = circle_pressure_stress(-1, 0, 0, 1, 1, NU) + 0.5 * circle_shear_stress(
        -1, 0, 0, 1, 1, NU
    )
    expected = (1 - 2 * NU) / 3 + 0.5 * (4 + NU) * np.pi / 8
    np.testing.assert_allclose(behind[XX], expected, rtol=1e-14)


# Largest von Mises stress below the centre, and its depth: (max / p0, z / a)
LARGEST = {0.25: (0.6434, 0.4643), 0.28: (0.6293, 0.4742), 0.30: (0.62, 0.4809)}
LARGEST |= {0.40: (0.5752, 0.5142), 0.50: (0.5327, 0.5479)}


@pytest.mark.parametrize("nu", LARGEST)
def test_largest_von_mises_stress_of_the_circle(nu):
    z = np.linspace(0, 1, 10001)
    equivalent = von_mises(hertz_axis_stress(z, 1.0, 1.0, nu))
    found = equivalent.max(), z[equivalent.argmax()]
    np.testing.assert_allclose(found, LARGEST[nu], atol=1.1e-4)  # four printed digits, dz
