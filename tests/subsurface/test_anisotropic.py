"""Stress in anisotropic bodies: direct integrals, closed forms, laws of fields, symmetries."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.mechanics.test_anisotropy import (
    BALL,
    BODIES,
    FIBRES,
    FLAT,
    IRON,
    STEEL,
    isotropic,
    material,
)
from tractive_sam.mechanics import Strips
from tractive_sam.mechanics.criteria import VonMises
from tractive_sam.operators import Lattice, surface_stress
from tractive_sam.results import Grid
from tractive_sam.subsurface.anisotropic import AnisotropicStress
from tractive_sam.subsurface.layered import StressOfEach
from tractive_sam.subsurface.sources import PatchStress, StripStress

GRID = Grid((1.0, 0.8), (12, 8))
RIGID = ts.Material(np.inf, 0.0)
ZINC = {"C11": 165e3, "C12": 31.1e3, "C13": 50e3, "C33": 61.8e3, "C44": 39.6e3}
XX, YY, ZZ, XY, XZ, YZ = range(6)


def tractions(grid=GRID):
    """A smooth pressure with tractions of both directions on the inner elements."""
    pressure = np.clip(1.0 - 2.0 * grid.x[:, None] ** 2 - 3.0 * (grid.y + 0.05) ** 2, 0.0, None)
    return np.stack((0.3 * pressure * (grid.x[:, None] > -0.2), -0.2 * pressure, pressure))


def source(body, grid=GRID, datum=None, sign=1.0, loads=None):
    law = ts.AnisotropicHalfSpaces(body, RIGID, datum)
    return AnisotropicStress((law,), (sign,), grid, tractions(grid) if loads is None else loads)


def integrate_directly(body, x, y, z, count):
    """Stress (18, ...) of elements between corners, by Stroh's eigenvectors and trapezoids.

    The integral of 1/(m.x + p z)² over an element is a difference of logarithms.
    """
    index = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
    c = np.array(body.stiffness)[index][:, :, index]
    n, total = np.array([0.0, 0.0, 1.0]), 0.0
    for angle in 2.0 * np.pi * (np.arange(count) + 0.5) / count:
        m = np.array([np.cos(angle), np.sin(angle), 0.0])
        mm, mn, nn = (np.einsum("ijkl,j,l->ik", c, a, b) for a, b in ((m, m), (m, n), (n, n)))
        inverse = np.linalg.inv(nn)
        N = np.block([[-inverse @ mn.T, inverse], [mn @ inverse @ mn.T - mm, -mn @ inverse]])
        p, vectors = np.linalg.eig(N)
        p, vectors = p[p.imag > 0.0], vectors[:, p.imag > 0.0]
        gradient = np.einsum("ka,la->kla", vectors[:3], m[:, None] + p * n[:, None])
        stress = np.einsum("ijkl,kla->ija", c, gradient)[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        corners = np.log(x[:, None, None] * m[0] + y[:, None] * m[1] + z * p) / (m[0] * m[1])
        element = np.diff(np.diff(corners, axis=0), axis=1)
        total += np.einsum("ca,at,xya->ctxy", -stress, np.linalg.inv(vectors[3:]), element).real
    return total.reshape(18, *total.shape[2:]) / (2.0 * np.pi * count)


@pytest.mark.parametrize("name", ["(111)", "random"])
def test_elements_are_integrals_over_all_directions(name):
    """There is no period: the other side integrates over all waves in closed form."""
    x, y = np.array([-1.2, -0.3, 0.2, 0.8]), np.array([-0.9, -0.1, 0.5])
    found, _ = next(source(BODIES[name]).functions(x, y, np.array([0.3])))
    # Series end at 1e-7; 400 trapezoids have converged to rounding.
    np.testing.assert_allclose(found, integrate_directly(BODIES[name], x, y, 0.3, 400), atol=3e-7)


@pytest.mark.parametrize("line", [False, True])
def test_isotropic_stiffness_has_the_closed_form(line):
    pair, datum = (ts.Material(1.0, 0.3), RIGID), 4.0 if line else None
    grid = Grid((1.0, 0.5), (12, 1)) if line else GRID
    of = source(isotropic(pair[0]), grid, datum, sign=-1.0)
    loads = (-1.0,), grid, tractions(grid)
    plain = (
        StripStress((Strips(*pair, 4.0),), *loads)
        if line
        else PatchStress((ts.HalfSpaces(*pair),), *loads)
    )
    depths = np.array([0.0, 0.001, 0.1, 0.6, 3.0])
    y = 0.0 if line else 0.11
    points = np.array([(x, y, z) for x in (0.1, -0.333) for z in depths])
    pairs = [(of.at(points), plain.at(points))]
    pairs += [
        (each.on_plane(axis, at, depths), other.on_plane(axis, at, depths))
        for each, other in ((of, plain),)
        for axis, at in (("x", 0.11), ("y", y))
    ]
    pairs += zip(of.layers(depths), plain.layers(depths), strict=True)
    for found, expected in pairs:
        np.testing.assert_allclose(found, expected, atol=2e-9)  # the Chebyshev series
    x = np.array([1.6, -2.0])
    # Far away, the other side combines elements.
    np.testing.assert_allclose(
        of.at_columns(x, depths[1:]), plain.at_columns(x, depths[1:]), atol=1e-4
    )


@pytest.mark.parametrize("name", ["(111)", "random"])
def test_stress_is_in_equilibrium(name):
    """Central differences of fourth order at points in the body."""
    of, h = source(BODIES[name]), 5e-3
    steps = h * np.array([-2.0, -1.0, 1.0, 2.0])
    for place in ((0.1, -0.1, 0.2), (-0.5, 0.1, 0.8)):
        in_x, in_y, in_z = (
            of.at(place + np.outer(steps, axis))[0] @ np.array([1, -8, 8, -1]) / (12.0 * h)
            for axis in np.eye(3)
        )
        sums = [
            in_x[XX] + in_y[XY] + in_z[XZ],
            in_x[XY] + in_y[YY] + in_z[YZ],
            in_x[XZ] + in_y[YZ] + in_z[ZZ],
        ]
        # Differences have (h/depth)^4, and the error of the series over h.
        np.testing.assert_allclose(sums, 0.0, atol=5e-5)


@pytest.mark.parametrize("name", ["(110)", "random"])
def test_surface_layers_points_and_columns_agree(name):
    of, depths = source(BODIES[name]), np.array([0.0, 1e-6, 0.1, 1.5])
    layers = np.stack(list(of.layers(depths)), axis=-1)[0]
    loads = tractions()
    for k in (0, 1):
        # Series end at 1e-7; at a depth of 1e-6 elements are some 1e5 depths long.
        np.testing.assert_allclose(layers[[XZ, YZ, ZZ], ..., k], -loads, atol=(1e-6, 1e-5)[k])
    points = np.array([(GRID.x[4], GRID.y[3], z) for z in depths])
    np.testing.assert_allclose(of.at(points)[0], layers[:, 4, 3], atol=1e-11)
    np.testing.assert_allclose(of.on_plane("y", GRID.y[3], depths)[0], layers[:, :, 3], atol=1e-11)
    np.testing.assert_allclose(of.on_plane("x", GRID.x[4], depths)[0], layers[:, 4], atol=1e-11)
    columns = of.at_columns(np.array([1.6, -2.0]), depths)[0][:, :, 3]
    points = np.array([(x, GRID.y[3], z) for x in (1.6, -2.0) for z in depths])
    np.testing.assert_allclose(of.at(points)[0], columns.reshape(6, -1), atol=1e-11)


def test_line_is_the_middle_of_a_long_contact():
    grid, line = Grid((1.0, 2e4), (12, 1)), Grid((1.0, 0.5), (12, 1))
    loads, depths = tractions(line), np.array([0.0, 0.2, 1.0])
    long, infinite = (
        np.stack(list(source(BODIES["random"], g, datum, loads=loads).layers(depths)))
        for g, datum in ((grid, None), (line, 4.0))
    )
    np.testing.assert_allclose(long, infinite, atol=1e-4)  # width over length


@pytest.mark.slow
def test_crystal_turned_by_a_quarter_exchanges_x_and_y():
    turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    body = BODIES["random"]
    turned = ts.AnisotropicMaterial.from_matrix(body.stiffness, turn)
    # x of the turned crystal is y of the other one, y is -x.
    grid, loads = Grid((0.8, 1.0), (8, 12)), tractions()
    again = np.stack((loads[1], -loads[0], loads[2])).swapaxes(1, 2)[:, :, ::-1]
    (found,) = source(turned, grid, loads=again).layers([0.3])
    (expected,) = source(body).layers([0.3])
    expected = expected[0].swapaxes(1, 2)[:, :, ::-1]
    signs = np.array([1, 1, 1, -1, 1, -1])[:, None, None]
    # The series of both end at 1e-7.
    np.testing.assert_allclose(found[0], signs * expected[[YY, XX, ZZ, XY, YZ, XZ]], atol=1e-6)


def test_mirrored_crystal_has_mirrored_stress():
    body = BODIES["random"]
    mirrored = ts.AnisotropicMaterial.from_matrix(body.stiffness, np.diag([1.0, -1.0, 1.0]))
    loads = tractions()[:, :, ::-1] * np.array([1, -1, 1])[:, None, None]
    (found,) = source(mirrored, loads=loads).layers([0.3])
    (expected,) = source(body).layers([0.3])
    signs = np.array([1, 1, 1, -1, 1, -1])[:, None, None]
    np.testing.assert_allclose(found[0], signs * expected[0][..., ::-1], atol=1e-6)  # the series


def test_exchanged_bodies_have_the_stress_of_a_turned_contact():
    """Turned by half a turn about x, body A is B: y and z change their signs."""
    turn = np.diag([1.0, -1.0, -1.0])
    other = ts.Material.from_young(208e3, 0.3)
    body = BODIES["random"]
    below = ts.AnisotropicMaterial.from_matrix(body.stiffness, turn)
    laws = ts.AnisotropicHalfSpaces(body, other), ts.AnisotropicHalfSpaces(other, below)
    A, B = laws[0].single_body("A"), laws[1].single_body("B")
    loads = tractions()
    # Body A feels -p_x and p_y of the turned contact, as the tractions act on body A.
    again = (loads * np.array([-1, 1, 1])[:, None, None])[:, :, ::-1]
    (expected,) = StressOfEach((A,), (1.0,), GRID, loads).layers([0.3])
    (found,) = StressOfEach((B,), (-1.0,), GRID, again).layers([0.3])
    signs = np.array([1, 1, 1, -1, -1, 1])[:, None, None]
    found[:, 4:] *= -1.0  # in the axes of the contact
    np.testing.assert_allclose(found[0], signs * expected[0][..., ::-1], atol=1e-6)  # the series


def hertz_on_axis(stiffness, z):
    """Stress rr and zz below the centre of Hertz's pressure, radius and maximum 1.

    Waves in a plane have Airy's function sum of c exp(-s k z), with the roots s of the equation of
    equilibrium; that of the pressure exp(-k z) is 1 - z atan(1/z) on the axis.
    """
    C11, C12, C13, C33, C44 = (stiffness[k] for k in ("C11", "C12", "C13", "C33", "C44"))
    middle = C11 * C33 - C13**2 - 2.0 * C13 * C44
    s, t = np.sqrt(np.roots([C33 * C44, -middle, C11 * C44]).astype(complex))
    of_s, of_t = (1.0 - r * z * np.arctan(1.0 / (r * z)) for r in (s, t))
    zz = -(t * of_s - s * of_t) / (t - s)
    along = s * t * (s * of_s - t * of_t) / (t - s)
    strain = np.linalg.solve([[C11, C13], [C13, C33]], np.stack((along, zz)))
    across = C12 * strain[0] + C13 * strain[1]
    return 0.5 * (along + across).real, zz.real


def test_transverse_isotropy_below_a_hertz_contact():
    z, errors = np.array([0.1, 0.4, 0.8, 2.0]), []
    for n in (24, 48):
        grid = Grid((1.05, 1.05), (n, n))
        # The mean over each element, by 8 x 8 points.
        at = [
            (c[:, None] + s * (np.arange(8) - 3.5) / 8).ravel()
            for c, s in zip((grid.x, grid.y), (grid.dx, grid.dy), strict=True)
        ]
        pressure = np.sqrt(np.clip(1.0 - at[0][:, None] ** 2 - at[1] ** 2, 0.0, None))
        loads = np.zeros((3, n, n))
        loads[2] = pressure.reshape(n, 8, n, 8).mean(axis=(1, 3))
        law = ts.LinearHalfSpaces(material(**ZINC), RIGID).single_body("A")
        of = AnisotropicStress((law,), (1.0,), grid, loads)
        stress = of.at(np.stack((0.0 * z, 0.0 * z, z), axis=1))[0]
        rr, zz = hertz_on_axis(ZINC, z)
        errors.append(np.abs((stress[XX] - rr, stress[YY] - rr, stress[ZZ] - zz)).max())
    assert errors[1] < 5e-4  # second order in the elements
    assert errors[0] / errors[1] > 3.0


def test_maximum_of_an_isotropic_stiffness():
    scene = ts.Scene.builtin("spheres").replace(
        subsurface={"planes": ["y=0"], "bodies": ["A"]}, grid={"elements": [21, 21]},
        fatigue={"shear_yield": 300.0, "bodies": ["A"], "elements": 8},
    )  # fmt: skip
    law = ts.AnisotropicHalfSpaces(isotropic(scene.materials["A"]), scene.materials["B"])
    laws = ts.Laws.of(scene).replace(elasticity=law)
    plain, contact = ts.solve(scene), ts.solve(scene, laws=laws)
    found, expected = ts.stress_maximum(contact, "A", laws), ts.stress_maximum(plain, "A")
    assert found.surface == pytest.approx(expected.surface, rel=1e-6)  # that of the solution
    assert found.interior == pytest.approx(expected.interior, rel=2e-3)  # parabolas
    found, expected = (ts.fatigue(c)["A"].path_radius for c in (contact, plain))
    # The closed form combines distant elements.
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=3e-4 * expected.max())


@pytest.mark.slow
def test_stress_at_the_surface_is_that_of_displacements():
    """Without friction, the stress a little below a corner tends to that at the surface."""
    scene = ts.Scene(
        body={"A": BALL | {"stiffness": FIBRES | {"phi1": 20.0, "Phi": 40.0}}, "B": FLAT | STEEL},
        load={"normal": 100.0}, grid={"elements": [21, 21]},
    )  # fmt: skip
    contact = ts.solve(scene)
    law = ts.Laws.of(scene).elasticity.single_body("A")
    grid, loads = contact.grid, np.concatenate((contact.traction, contact.pressure[None]))
    (stress,) = surface_stress(Lattice(grid.elements, grid.dx, grid.dy), law, loads)
    corners = [(i, j) for i in (8, 12) for j in (9, 11)]
    for i, j in corners:
        corner = (grid.x[i] + 0.5 * grid.dx, grid.y[j] + 0.5 * grid.dy, 1e-7)
        below = ts.stress_at(contact, [corner], "A")[0]
        # Differences over an element: second order.
        np.testing.assert_allclose(below[:4], stress[:4, i, j], atol=0.02 * contact.p_max)


def test_scene_with_stress_and_fatigue_in_crystal_and_steel():
    iron = {"stiffness": IRON | {"normal": (1.0, 1.0, 1.0), "along": (1.0, -1.0, 0.0)}}
    scene = ts.Scene(
        body={"A": BALL | iron, "B": BALL | STEEL}, load={"normal": 100.0}, friction={"mu": 0.3},
        creepage={"longitudinal": -2e-3}, grid={"elements": [15, 15]},
        subsurface={"planes": ["y=0"], "elements": 9, "bodies": ["A", "B"]},
        fatigue={"shear_yield": 300.0, "elements": 8, "bodies": ["A", "B"]},
    )  # fmt: skip
    contact = ts.solve(scene)
    for body in "AB":
        top = ts.stress_maximum(contact, body)
        x, y, depth = top.interior_at
        near = [(x + i, y + j, depth + k) for i in (0, 0.02) for j in (0, 0.02) for k in (0, 0.02)]
        values = VonMises()(ts.stress_at(contact, near, body).T)
        # The top of parabolas through the mesh, against the exact sum there.
        assert top.interior == pytest.approx(values[0], rel=0.02)
        plane = ts.stress_on_plane(contact, "y=0", body)
        depths = plane.axes["depth"]
        again = ts.stress_at(contact, [(contact.grid.x[5], 0.0, z) for z in depths], body)
        np.testing.assert_allclose(plane.von_mises[5], VonMises()(again.T), rtol=1e-9)
    history = ts.roll(scene)
    assert history["von_mises_max"][0, 0] == ts.stress_maximum(contact, "A").value
    assert all((of.path_radius > 0.0).any() for of in ts.fatigue(contact).values())


def test_stress_that_changes_too_fast_is_refused():
    thin = np.diag([1e8, 1.0, 1.0, 1.0, 1.0, 1.0])
    with pytest.raises(ValueError, match="too fast"):
        next(source(ts.AnisotropicMaterial.from_matrix(thin)).layers([0.1]))
