import numpy as np
import pytest

from tractive_sam.mechanics.criteria import max_shear, principal_stresses, von_mises

UNIAXIAL = [0.0, -3.0, 0.0, 0.0, 0.0, 0.0]
SHEAR = [0.0, 0.0, 0.0, 0.0, 0.0, 2.0]
HYDROSTATIC = [-5.0, -5.0, -5.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("stress", "equivalent", "shear", "principal"),
    [
        (UNIAXIAL, 3.0, 1.5, (0.0, 0.0, -3.0)),
        (SHEAR, 2.0 * np.sqrt(3.0), 2.0, (2.0, 0.0, -2.0)),
        (HYDROSTATIC, 0.0, 0.0, (-5.0, -5.0, -5.0)),
    ],
)
def test_simple_states(stress, equivalent, shear, principal):
    assert von_mises(stress) == pytest.approx(equivalent)
    assert max_shear(stress) == pytest.approx(shear)
    np.testing.assert_allclose(principal_stresses(stress), principal, atol=1e-15)


def test_von_mises_from_principal_stresses():
    stress = np.random.default_rng(0).normal(size=(6, 4, 5))
    one, two, three = principal_stresses(stress)
    by_principal = np.sqrt(((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2) / 2)
    np.testing.assert_allclose(von_mises(stress), by_principal, rtol=1e-13)
    np.testing.assert_allclose(one + two + three, stress[:3].sum(axis=0), atol=1e-13)
    assert (one >= two).all()
    assert (two >= three).all()
