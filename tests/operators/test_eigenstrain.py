"""The strain by eigenstrain in a half-space: closed forms, quadrature, and a free surface."""

import numpy as np
import pytest

from tractive_sam.operators import EigenstrainBox, isotropic_stiffness

NU = 0.3
DOUBLED = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
SHAPE, SIDES = (4, 5, 3), (0.1, 0.12, 0.15)


def random_strain(seed, shape=SHAPE):
    return np.random.default_rng(seed).normal(size=(6, *shape))


def kelvin_strain(offset, eigenstrain, nu=NU, h=1e-3):
    """Strain at an offset from a unit volume of eigenstrain, by differences of Kelvin's tensor."""
    stress = isotropic_stiffness(1.0, nu) @ eigenstrain
    s = np.zeros((3, 3))
    for value, (i, j) in zip(stress, EigenstrainBox.axes, strict=True):
        s[i, j] = s[j, i] = value

    def displacement(x):
        r = np.linalg.norm(x)
        # G_ij,k in closed form; u_i = -G_ij,k s_jk.
        first = -(3.0 - 4.0 * nu) * s @ x / r**3
        second = (np.trace(s) * x + s @ x) / r**3 - 3.0 * x * (x @ s @ x) / r**5
        return -(first + second) / (16.0 * np.pi * (1.0 - nu))

    steps = h * np.eye(3)
    slopes = np.array(
        [(displacement(offset + d) - displacement(offset - d)) / (2 * h) for d in steps]
    )
    return np.array([0.5 * (slopes[i, j] + slopes[j, i]) for i, j in EigenstrainBox.axes])


def test_a_cube_far_from_the_surface_agrees_with_quadrature_of_point_sources():
    box = EigenstrainBox((3, 3, 3), (0.2, 0.2, 0.2), 1e4, NU)
    eigenstrain = np.zeros((6, 3, 3, 3))
    eigenstrain[:, 0, 0, 0] = values = random_strain(0, ())
    nodes, weights = np.polynomial.legendre.leggauss(6)
    expected = sum(
        wx
        * wy
        * wz
        / 8
        * 0.008
        * kelvin_strain(np.array([0.2, 0.4, 0.4]) - 0.1 * np.array([x, y, z]), values)
        for x, wx in zip(nodes, weights, strict=True)
        for y, wy in zip(nodes, weights, strict=True)
        for z, wz in zip(nodes, weights, strict=True)
    )
    # The differences of Kelvin's displacement have errors of h^2/r^2.
    np.testing.assert_allclose(box(eigenstrain)[:, 2, 1, 2], expected, rtol=0, atol=3e-5)


def test_a_dilating_cube_has_the_stress_of_a_sphere_at_its_centre():
    box = EigenstrainBox((3, 3, 3), (1.0, 1.0, 1.0), 1e6, NU)
    eigenstrain = np.zeros((6, 3, 3, 3))
    eigenstrain[:3, 1, 1, 1] = 1.0
    stress = isotropic_stiffness(1.0, NU) @ (box(eigenstrain) - eigenstrain)[:, 1, 1, 1]
    np.testing.assert_allclose(
        stress[:3], -2.0 * 2.6 / (3.0 * (1.0 - NU)), rtol=1e-6
    )  # single precision
    np.testing.assert_allclose(stress[3:], 0.0, atol=1e-9)


@pytest.mark.parametrize("top", [0.3, 3.0])
def test_the_strain_energy_of_two_eigenstrains_is_mutual(top):
    box, stiffness = EigenstrainBox(SHAPE, SIDES, top, NU), isotropic_stiffness(1.0, NU)
    one, other = random_strain(1), random_strain(2)
    work = [
        np.einsum(
            "czxy,czxy->", DOUBLED[:, None, None, None] * a, np.tensordot(stiffness, box(b), 1)
        )
        for a, b in ((one, other), (other, one))
    ]
    # Strain at centres is no mean over the cells: equal in the limit of small cells, not exactly.
    # The image is smooth at a distance of many cells.
    assert work[0] == pytest.approx(work[1], rel={0.3: 1e-3, 3.0: 1e-6}[top])


def test_the_surface_is_free():
    column = EigenstrainBox((60, 1, 1), (0.01, 0.01, 0.01), 0.0, NU)
    whole = EigenstrainBox((60, 1, 1), (0.01, 0.01, 0.01), 1e6, NU)
    eigenstrain = np.zeros((6, 60, 1, 1))
    eigenstrain[:, -1, 0, 0] = random_strain(3, ())
    free, full = (
        np.tensordot(isotropic_stiffness(1.0, NU), box(eigenstrain), 1)[[2, 4, 5], :, 0, 0]
        for box in (column, whole)
    )
    # Extrapolated by half a cell; spectra of the image are in single precision.
    at_surface = 1.5 * free[:, 0] - 0.5 * free[:, 1]
    assert np.abs(at_surface).max() < 1e-2 * np.abs(full[:, 0]).max()


def dilating_sphere(cells, radius, depth):
    """Box and eigenstrain 1 along each axis of a sphere, whose volume is exact."""
    side = 2.0 * radius / cells
    fine = side / 6.0 * (np.arange(6 * cells) - 3.0 * cells + 0.5)
    inside = (fine[:, None, None] ** 2 + fine[:, None] ** 2 + fine**2) < radius**2
    share = inside.reshape(cells, 6, cells, 6, cells, 6).mean(axis=(1, 3, 5))
    share *= 4.0 / 3.0 * np.pi * radius**3 / (share.sum() * side**3)
    eigenstrain = np.zeros((6, cells, cells, cells))
    eigenstrain[:3] = share
    return EigenstrainBox((cells,) * 3, (side,) * 3, depth - radius, NU), eigenstrain


@pytest.mark.parametrize(("radius", "error"), [(0.3, 2e-4), (0.9, 2e-2)])
def test_a_dilating_sphere_lifts_the_surface_as_a_point_does_at_any_depth(radius, error):
    x = np.array([0.0, 0.5, 1.0, 2.0])
    errors = []
    for cells in (6, 12):
        box, eigenstrain = dilating_sphere(cells, radius, 1.0)
        lift = box.lift(eigenstrain, x, 0.0 * x)
        exact = 4.0 / 3.0 * (1.0 + NU) * radius**3 / (x * x + 1.0) ** 1.5
        errors.append(np.abs(lift / exact - 1.0).max())
    # Steps of the cells: their quadrupole is left, at a distance of a tenth of the radius or more.
    assert errors[1] < error
    assert errors[1] < 0.5 * errors[0]
