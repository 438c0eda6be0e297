"""Stress in bodies with layers: laws of waves and fields, limits, and agreement of the ways."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.mechanics import Strips
from tractive_sam.mechanics.criteria import VonMises
from tractive_sam.operators import Lattice, surface_stress
from tractive_sam.results import Grid, columns
from tractive_sam.subsurface import with_interfaces
from tractive_sam.subsurface.layered import LayeredStress
from tractive_sam.subsurface.sources import PatchStress, StripStress

LAYERS = (
    ts.Layer(0.2, ts.Material(4.0, 0.25)),
    ts.Layer(0.3, ts.Material(0.5, 0.45)),
    ts.Layer(0.5, ts.Material(2.0, 0.3)),
)
THREE = ts.LayeredBody(LAYERS, ts.Material(1.0, 0.35))
GRADED = ts.LayeredBody((ts.Layer(1.0, ts.Material(4.0, 0.3), "exponential"),), THREE.base)
SPRUNG = ts.LayeredBody(
    (ts.Layer(0.2, ts.Material(4.0, 0.25), compliance=(0.3, 0.1)), *LAYERS[1:]), THREE.base
)
RIGID = ts.Material(np.inf, 0.0)
GRID = Grid((1.0, 0.8), (12, 8))
XX, YY, ZZ, XY, XZ, YZ = range(6)


def tractions(grid=GRID):
    """A smooth pressure with tractions of both directions on the inner elements."""
    pressure = np.clip(1.0 - 2.0 * grid.x[:, None] ** 2 - 3.0 * (grid.y + 0.05) ** 2, 0.0, None)
    return np.stack((0.3 * pressure * (grid.x[:, None] > -0.2), -0.2 * pressure, pressure))


def source(body, grid=GRID, datum=None, sign=1.0):
    law = ts.LinearHalfSpaces(body, RIGID, datum)
    return LayeredStress((law,), (sign,), grid, tractions(grid))


@pytest.mark.parametrize("body", [THREE, GRADED, SPRUNG], ids=["three", "graded", "sprung"])
def test_waves_are_in_equilibrium(body):
    """Central differences over the depth; their error is of the order of h² and of 1e-16/h."""
    k, h = np.array([0.5, 2.0, 10.0]), 1e-5
    depths = np.array([0.1, 0.35, 0.8, 1.4])
    above, here, below = (body.stress(k, depths + s * h) for s in (-1.0, 0.0, 1.0))
    LL, Lz, _, _, along, by_pressure, _, twist = np.moveaxis(here, 1, 0)
    d_LL, d_Lz, d_zL, d_zz, _, _, d_TT, _ = np.moveaxis((below - above) / (2.0 * h), 1, 0)
    residuals = k * along + d_LL, k * by_pressure + d_Lz, k * LL - d_zL, k * Lz - d_zz
    np.testing.assert_allclose(np.abs((*residuals, k * twist + d_TT)).max(), 0.0, atol=2e-7)


@pytest.mark.parametrize("body", [THREE, GRADED, SPRUNG], ids=["three", "graded", "sprung"])
def test_tractions_are_continuous_at_interfaces(body):
    k = np.geomspace(0.01, 30.0, 9)
    faces = body.interfaces
    above, below = (body.stress(k, faces * factor)[:, [0, 1, 2, 3, 6]] for factor in (1, 1 + 1e-13))
    np.testing.assert_allclose(above, below, atol=1e-11)  # the lower side is 1e-13 deeper
    surface = body.stress(k, np.zeros(1))[0, [0, 1, 2, 3, 6]]
    np.testing.assert_allclose(surface, np.outer((1, 0, 0, 1, 1), np.ones(9)), atol=1e-13)


def test_springs_below_a_thin_layer_are_in_series_with_the_body():
    nu, k, springs = 0.3, np.array([0.5, 2.0]), (0.7, 0.4)
    base = ts.Material(1.0, nu)
    thin = ts.LayeredBody((ts.Layer(1e-9, base, compliance=springs),), base)
    zz, LL, TT, Lz = thin.response(k)
    along = np.stack((LL, TT)) - k * springs[0]
    np.testing.assert_allclose(zz, 1.0 - nu + k * springs[1], rtol=1e-7)  # the layer is 1e-9 thick
    np.testing.assert_allclose(along, [[1.0 - nu] * 2, [1.0] * 2], rtol=1e-7)
    np.testing.assert_allclose(Lz, 0.5 - nu, rtol=1e-7)


@pytest.mark.parametrize("body", [THREE, GRADED, SPRUNG], ids=["three", "graded", "sprung"])
def test_stress_is_in_equilibrium(body):
    """Central differences of fourth order of the stress at points in a layer and below."""
    of, h = source(body), 2e-3
    for place in ((0.1, -0.1, 0.1), (0.3, 0.2, 0.36), (-0.5, 0.1, 0.8), (0.1, 0.0, 1.3)):
        steps = h * np.array([-2.0, -1.0, 1.0, 2.0])
        slopes = [
            of.at(place + np.outer(steps, axis))[0] @ np.array([1, -8, 8, -1]) / (12.0 * h)
            for axis in np.eye(3)
        ]
        in_x, in_y, in_z = slopes
        sums = [
            in_x[XX] + in_y[XY] + in_z[XZ],
            in_x[XY] + in_y[YY] + in_z[YZ],
            in_x[XZ] + in_y[YZ] + in_z[ZZ],
        ]
        # The error of the differences is (h/depth)^4; the fit of exponentials has 1e-6.
        np.testing.assert_allclose(sums, 0.0, atol=2e-5 * np.abs(slopes).max())


def test_stress_is_continuous_at_interfaces():
    faces = np.concatenate([(z, z * (1.0 + 1e-9)) for z in THREE.interfaces])
    stress = np.stack(list(source(THREE).layers(faces)))[:, 0]
    above, below = stress[::2], stress[1::2]
    for component in (ZZ, XZ, YZ):
        np.testing.assert_allclose(above[:, component], below[:, component], atol=1e-6)
    strains = [  # of the surface: also continuous
        (s[:, XX] - nu * (s[:, YY] + s[:, ZZ])) / (2.0 * (1.0 + nu) * G)
        for s, materials in ((above, LAYERS), (below, (*LAYERS[1:], None)))
        for G, nu in [
            np.array(
                [(m.material.shear, m.material.poisson) if m else (1.0, 0.35) for m in materials]
            ).T[..., None, None]
        ]
    ]
    np.testing.assert_allclose(strains[0], strains[1], atol=1e-5)  # the fit, over a modulus of 1/2


@pytest.mark.parametrize("line", [False, True])
def test_layers_of_the_same_material_change_nothing(line):
    material = ts.Material(1.0, 0.3)
    body = ts.LayeredBody((ts.Layer(0.2, material), ts.Layer(0.3, material)), material)
    pair, depths = (material, ts.Material(np.inf, 0.3)), np.array([0.0, 0.1, 0.3, 0.9])
    grid = Grid((1.0, 0.5), (12, 1)) if line else GRID
    if line:
        plain = StripStress((Strips(*pair, 4.0),), (1.0,), grid, tractions(grid))
    else:
        plain = PatchStress((ts.HalfSpaces(*pair),), (1.0,), grid, tractions(grid))
    found = source(body, grid, 4.0 if line else None).layers(depths)
    for stress, expected in zip(found, plain.layers(depths), strict=True):
        np.testing.assert_allclose(stress, expected, atol=1e-12)


def test_limits_of_thickness():
    thick = ts.LayeredBody((ts.Layer(1e3, ts.Material(5.0, 0.2)),), ts.Material(1.0, 0.4))
    thin = ts.LayeredBody((ts.Layer(1e-4, ts.Material(5.0, 0.2)),), ts.Material(1.0, 0.4))
    # Errors are those of the thickness: 1e-3 over the layer, and five times 1e-4.
    for body, nu, error in ((thick, 0.2, 4e-3), (thin, 0.4, 2e-3)):
        pair = ts.Material(1.0, nu), ts.Material(np.inf, nu)
        plain = PatchStress((ts.HalfSpaces(*pair),), (1.0,), GRID, tractions())
        found, expected = (next(of.layers([0.4])) for of in (source(body), plain))
        np.testing.assert_allclose(found, expected, atol=error)


@pytest.mark.parametrize("line", [False, True])
def test_layers_planes_columns_and_points_agree(line):
    grid = Grid((1.0, 0.5), (12, 1)) if line else GRID
    of = source(THREE, grid, 4.0 if line else None, sign=-1.0)
    depths = np.array([0.1, 0.2, 0.6, 1.5])
    layers = np.stack(list(of.layers(depths)), axis=-1)[0]
    j = 0 if line else 3
    y = 0.0 if line else grid.y[j]
    points = np.array([(grid.x[4], y, z) for z in depths])
    np.testing.assert_allclose(of.at(points)[0], layers[:, 4, j], atol=1e-11)
    in_plane = of.on_plane("y", y, depths)[0], of.on_plane("x", grid.x[4], depths)[0]
    np.testing.assert_allclose(in_plane[0], layers[:, :, j], atol=1e-10)
    np.testing.assert_allclose(in_plane[1], layers[:, 4], atol=1e-10)
    columns = of.at_columns(np.array([1.6, -2.0]), depths)[0][:, :, j]
    points = np.array([(x, y, z) for x in (1.6, -2.0) for z in depths])
    # The stress without layers is that of point forces at a distance.
    np.testing.assert_allclose(of.at(points)[0], columns.reshape(6, -1), atol=2e-4)


def test_stress_at_the_surface_is_that_of_displacements():
    """Without friction, the stress a little below a corner tends to that at the surface."""
    scene = ts.Scene.builtin("coated-roller").replace(
        friction=None, creepage=None, grid={"elements": [21, 21]}
    )
    contact = ts.solve(scene)
    law = ts.Laws.of(scene).elasticity.single_body("A")
    grid, loads = contact.grid, np.concatenate((contact.traction, contact.pressure[None]))
    (stress,) = surface_stress(Lattice(grid.elements, grid.dx, grid.dy), law, loads)
    i = grid.elements[0] // 2 + 2
    corner = (grid.x[i] + 0.5 * grid.dx, grid.y[i] + 0.5 * grid.dy, 1e-7)
    below = ts.stress_at(contact, [corner], "A")[0]
    # Differences over an element: second order.
    np.testing.assert_allclose(below[:4], stress[:4, i, i], atol=0.01 * contact.p_max)


def test_depths_hold_both_sides_of_interfaces():
    depths = with_interfaces(np.array([0.0, 0.3, 0.7]), [THREE, ts.Material(1.0, 0.3)])
    np.testing.assert_allclose(depths, [0.0, 0.1, 0.2, 0.2, 0.3, 0.5, 0.5, 0.7])
    assert (np.diff(depths) > 0.0).all()


def test_maximum_and_fatigue_of_a_coated_roller():
    scene = ts.Scene.builtin("coated-roller").replace(
        **{"body.A.layer[0].thickness": 0.2},
        grid={"elements": [17, 17]},
        subsurface={"planes": ["y=0"], "elements": 9},
        fatigue={"shear_yield": 60.0, "elements": 8, "bodies": ["A", "B"]},
    )
    contact = ts.solve(scene)
    top = ts.stress_maximum(contact, "A")
    points = np.array([(x, 0.0, z) for x in contact.grid.x for z in np.linspace(0.1, 0.6, 11)])
    among = VonMises()(ts.stress_at(contact, points).T).max()
    assert 0.995 * among < top.value < 1.05 * max(among, top.surface)
    (face,) = top.interfaces
    stress = ts.stress_at(contact, [face.shear_at])[0]
    # The top of parabolas through the mesh, against the exact sum there.
    assert face.shear == pytest.approx(np.hypot(stress[XZ], stress[YZ]), rel=2e-3)
    assert face.tension_at[2] == 0.2
    recorded = ts.roll(scene)
    assert recorded["interface_shear"][0, 0] == pytest.approx(face.shear)
    assert np.isnan(recorded["interface_shear"][0, 1])  # body B is not in [subsurface]
    assert recorded["interface_tension_at"][0, 0, 2] == 0.2
    by_body = ts.fatigue(contact)
    depth = by_body["A"].depth
    assert 0.2 in depth
    assert np.count_nonzero(np.isclose(depth, 0.2)) == 2
    assert all((of.path_radius > 0.0).any() for of in by_body.values())
    worst, parts = by_body["A"].largest("path_radius"), ((0.0, 0.2), (0.2 + 1e-10, np.inf))
    coating, below = (by_body["A"].largest("path_radius", within=part) for part in parts)
    assert worst.value == max(coating.value, below.value)
    # The parabolas do not pass an interface: no value exceeds its neighbours by much.
    assert worst.value < 1.2 * by_body["A"].path_radius.max()
    assert np.isnan(below.surface)
    assert coating.interior_at[2] <= 0.2 < below.interior_at[2]


def test_sections_show_interfaces():
    scene = ts.Scene.builtin("coated-roller").replace(
        **{"body.A.layer[0].thickness": 0.2},
        grid={"elements": [9, 9]},
        subsurface={"planes": ["y=0"], "elements": 5},
    )
    figure = ts.plot.von_mises_section(ts.solve(scene))
    dashed = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    assert len(dashed) == 1


def test_columns_of_interfaces_belong_to_layers():
    plain = ts.Scene.builtin("spheres").replace(subsurface={"planes": ["y=0"]})
    assert "interface_shear" not in columns(plain)
    assert "interface_shear" in columns(
        ts.Scene.builtin("coated-roller").replace(subsurface={"planes": ["y=0"]})
    )
