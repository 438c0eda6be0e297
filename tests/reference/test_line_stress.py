import numpy as np
import pytest
from scipy.integrate import quad

from tractive_sam.mechanics.criteria import von_mises
from tractive_sam.reference import line_pressure_stress, line_shear_stress

XX, YY, ZZ, XY, XZ, YZ = range(6)
NU = 0.3


def flamant(x, z, shear):
    """Line force along +x (shear) or +z: xx, zz, xz; Johnson (1985), section 2.2 and 2.3."""
    f = -2 / (np.pi * (x * x + z * z) ** 2)
    return f * np.array([x**3, x * z * z, x * x * z] if shear else [x * x * z, z**3, x * z * z])


@pytest.mark.parametrize(("x", "z"), [(0.3, 0.4), (-0.3, 0.4), (1.5, 0.2), (-2, 0.7), (0, 3)])
@pytest.mark.parametrize(
    ("closed_form", "shear"), [(line_pressure_stress, False), (line_shear_stress, True)]
)
def test_line_equals_quadrature(x, z, closed_form, shear):
    stress = closed_form(x, z, 1.0, 1.0, NU)
    for i, component in enumerate((XX, ZZ, XZ)):
        expected, _ = quad(
            lambda t, i=i: flamant(x - np.sin(t), z, shear)[i] * np.cos(t) ** 2,
            -np.pi / 2,
            np.pi / 2,
            epsabs=1e-13,
        )
        np.testing.assert_allclose(stress[component], expected, atol=1e-12)
    np.testing.assert_allclose(stress[YY], NU * (stress[XX] + stress[ZZ]))


def test_line_at_the_surface_and_its_edges():
    x = np.array([-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5])
    pressure = np.sqrt(np.maximum(1 - x * x, 0))
    np.testing.assert_allclose(
        line_pressure_stress(x, 0.0, 1.0, 1.0, NU)[ZZ], -pressure, atol=1e-15
    )
    sheared = line_shear_stress(x, 0.0, 1.0, 1.0, NU)
    np.testing.assert_allclose(sheared[XZ], -pressure, atol=1e-15)
    inside = np.abs(x) <= 1
    np.testing.assert_allclose(sheared[XX][inside], -2 * x[inside], atol=1e-15)  # Johnson (7.8)


def test_largest_von_mises_stress_of_the_line():
    z = np.linspace(0, 2, 20001)
    equivalent = von_mises(line_pressure_stress(0.0, z, 1.0, 1.0, 0.3))
    found = equivalent.max(), z[equivalent.argmax()]
    np.testing.assert_allclose(found, (0.5575, 0.704), atol=4e-4)  # printed digits
