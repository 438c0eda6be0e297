import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tractive_sam.reference import creep_coefficients, linear_creep_forces

COLUMNS = (0.0, 0.25, 0.5)
NAMES = ("C11", "C22", "C23", "C33")
RATIOS = st.floats(0.1, 10)
POISSONS = st.floats(0, 0.5)


def test_published_table(published):
    for row in published["kalker_creep_coefficients"]["table"]:
        for column, poisson in enumerate(COLUMNS):
            coefficients = creep_coefficients(row["a_over_b"], poisson)
            expected = [row[name][column] for name in NAMES]
            # the ratios above 1 are published to six decimals
            assert coefficients == pytest.approx(expected, rel=1e-6)


@given(RATIOS, st.floats(0.98, 1.02), POISSONS)
def test_smooth_between_entries(ratio, factor, poisson):
    near = min(max(ratio * factor, 0.1), 10)
    change = np.divide(creep_coefficients(near, poisson), creep_coefficients(ratio, poisson)) - 1
    # between entries no coefficient varies faster than the power 1.3 of the ratio
    assert np.all(np.abs(change) <= 1.35 * abs(near / ratio - 1) + 1e-12)


@given(RATIOS)
def test_without_poisson_the_two_creepages_are_alike(ratio):
    """At nu = 0 the tangential kernels are isotropic."""
    longitudinal, lateral, *_ = creep_coefficients(ratio, 0.0)
    assert longitudinal == pytest.approx(lateral)


@pytest.mark.parametrize(("ratio", "poisson"), [(0.099, 0.3), (10.1, 0.3), (1, -0.01), (1, 0.51)])
def test_outside_the_table(ratio, poisson):
    with pytest.raises(ValueError, match=r"a/b|ratio"):
        creep_coefficients(ratio, poisson)


def test_driving_creepage_gives_a_positive_force():
    assert linear_creep_forces(1.0, 1.0, 1.0, 0.3, xi_x=-1e-3).Fx > 0
    assert linear_creep_forces(1.0, 1.0, 1.0, 0.3, xi_y=-1e-3).Fy > 0
    assert linear_creep_forces(1.0, 1.0, 1.0, 0.3, spin=-1e-3).Mz > 0


def creep_matrix(a, b, poisson):
    """Minus the forces per unit (xi_x, xi_y, phi)."""
    units = np.eye(3)
    return -np.transpose(
        [
            linear_creep_forces(a, b, 1.0, poisson, xi_x=unit[0], xi_y=unit[1], spin=unit[2])
            for unit in units
        ]
    )


@given(RATIOS, POISSONS)
def test_only_the_gyroscopic_part_is_antisymmetric(ratio, poisson):
    matrix = creep_matrix(ratio, 1.0, poisson)
    assert matrix[1, 2] == -matrix[2, 1] > 0
    assert matrix[0, 1] == matrix[0, 2] == matrix[1, 0] == matrix[2, 0] == 0


@given(RATIOS, POISSONS)
def test_creepage_does_positive_work(ratio, poisson):
    assert np.all(np.diag(creep_matrix(ratio, 1.0, poisson)) > 0)


def test_dimensions():
    small, large = creep_matrix(1.0, 2.0, 0.3), creep_matrix(10.0, 20.0, 0.3)
    assert large / np.where(small, small, 1) == pytest.approx(
        np.array([[1e2, 0, 0], [0, 1e2, 1e3], [0, 1e3, 1e4]])
    )


def test_slope_of_the_computed_creep_force_curve(published):
    """Q = mu P f(xi~) starts with the slope 16/(3 (4 - 3 nu)) f' = C11."""
    first = published["creep_force_curve_spheres"]["rows"][0]
    slope = first["mesh_limit"] / first["xi"] * 16 / (3 * (4 - 3 * 0.28))
    # a chord from the origin lies below its tangent; 2 % at this creepage
    C11 = creep_coefficients(1.0, 0.28).C11
    assert 0.975 * C11 < slope < C11
