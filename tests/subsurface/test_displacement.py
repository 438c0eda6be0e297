"""Displacement inside the bodies and elastic energy, against stress, Hertz and the contact."""

import math

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.rolling import ElasticFields
from tractive_sam.subsurface import displacement, elastic_energy

SCENE = ts.Scene.builtin("spheres").with_set(["grid.elements=[25, 25]"])
DISSIMILAR = SCENE.replace(**{"body.A.poisson": 0.2, "creepage.lateral": 1e-3})

RECORDS = {"name": "tractive_sam.rolling:ElasticFields"}


def steady(**changes):
    return ts.solve(DISSIMILAR.replace(**changes))


@pytest.mark.parametrize("body", "AB")
def test_strain_and_stress_follow_hookes_law(body):
    contact, depth, step = steady(), 2.0, 1e-3
    nu, G = getattr(contact.scene.body, body).material.poisson, contact.scene.materials[body].shear
    dx, dy, sign = contact.grid.dx, contact.grid.dy, {"A": 1.0, "B": -1.0}[body]
    u = displacement(contact, body, depth)
    below, above = (displacement(contact, body, depth + d) for d in (step, -step))
    by_x, by_y = (np.gradient(u, side, axis=k, edge_order=2) for k, side in ((1, dx), (2, dy)))
    by_z = sign * (below - above) / (2.0 * step)
    trace = by_x[0] + by_y[1] + by_z[2]
    found = np.stack(
        [
            *(
                2.0 * G * (own + nu / (1.0 - 2.0 * nu) * trace)
                for own in (by_x[0], by_y[1], by_z[2])
            ),
            G * (by_x[1] + by_y[0]),
            G * (by_x[2] + by_z[0]),
            G * (by_y[2] + by_z[1]),
        ]
    )
    ((_, stress),) = ts.stress_volume(contact, [depth], body)
    inner = (slice(None), slice(1, -1), slice(1, -1))
    # Differences over two elements in x and y: of second order, 7 elements to the depth.
    error = np.abs(found - stress)[inner].max()
    assert error < 0.03 * np.abs(stress).max()


def test_surfaces_fit_in_the_contact():
    """The displacements together are the approach less the gap of the undeformed bodies."""
    contact = steady()
    closing = displacement(contact, "A")[2] - displacement(contact, "B")[2]
    x, y = contact.grid.x[:, None], contact.grid.y[None, :]
    R_x, R_y = contact.scene.body.radii
    gap = closing - contact.approach + 0.5 * (x**2 / R_x + y**2 / R_y)
    # To the tolerance of the contact conditions, as everywhere outside the contact.
    np.testing.assert_allclose(gap, contact.gap, atol=1e-6 * contact.approach)


def test_slip_follows_from_the_displacements():
    """Behind the leading edge, by differences: the sum of rigid slip and elastic slip."""
    contact = steady(solver={"slip": "upwind"})
    moved = displacement(contact, "A")[:2] - displacement(contact, "B")[:2]
    elastic = -(np.diff(moved, axis=1)) / contact.grid.dx
    rigid = np.array([contact.xi_x, contact.xi_y])[:, None, None]
    inside = contact.touching[:-1]
    np.testing.assert_allclose(
        contact.slip[:, :-1][:, inside], (rigid + elastic)[:, inside], atol=1e-6 * abs(contact.xi_x)
    )


def test_deep_displacement_is_that_of_a_point_load():
    contact, depth = steady(), 400.0
    G, nu = contact.scene.materials["A"].shear, contact.scene.body.A.material.poisson
    middle = tuple(n // 2 for n in contact.grid.elements)
    axial = contact.P / (4.0 * math.pi * G * depth) * (3.0 - 2.0 * nu)
    # The contact is 1 % of the depth wide, and the tractions tilt by as much.
    assert displacement(contact, "A", depth)[2][middle] == pytest.approx(axial, rel=1e-2)


def test_energy_is_the_work_of_the_load():
    """Without friction P = dE/d(approach), by central differences."""
    scene = SCENE.replace(friction=None, creepage=None)
    loads = scene.load.normal * np.array([0.99, 1.0, 1.01])
    low, _, high = (ts.solve(scene.replace(**{"load.normal": load})) for load in loads)
    work = (elastic_energy(high) - elastic_energy(low)) / (high.approach - low.approach)
    assert work == pytest.approx(loads[1], rel=1e-3)  # the mesh changes at the edge


def test_energy_is_half_the_work_of_tractions_on_dense_displacements():
    contact = steady(**{"grid.elements": (11, 11)})
    bodies, grid = ts.Laws.of(contact.scene).elasticity, contact.grid
    offsets = [np.subtract.outer(k.ravel(), k.ravel()) for k in np.indices(grid.elements)]
    i, j = map(np.abs, offsets)
    odd = {"xy": (0, 1), "xz": (0,), "yz": (1,)}

    def matrix(component):
        values = bodies.coefficients(component, grid.elements, grid.dx, grid.dy)[i, j]
        return values * np.prod([np.sign(offsets[k]) for k in odd.get(component, ())], axis=0)

    xx, xy, yy, zz, xz, yz = map(matrix, ("xx", "xy", "yy", "zz", "xz", "yz"))
    dense = np.block([[xx, xy, xz], [xy.T, yy, yz], [xz.T, yz.T, zz]])
    fields = np.concatenate([*map(np.ravel, contact.traction), contact.pressure.ravel()])
    energy = 0.5 * grid.element_area * fields @ dense @ fields
    assert elastic_energy(contact) == pytest.approx(energy, rel=1e-9)  # rounding, by transforms


def test_line_contacts_have_none():
    flat = SCENE.replace(**{"body.A.radius_y": math.inf, "body.B.radius_y": math.inf, "grid": None})
    with pytest.raises(ValueError, match="radius_y"):
        displacement(ts.solve(flat))
    with pytest.raises(ts.SceneError, match=r"observer.*radius_y"):
        ts.roll(flat, observers=[ElasticFields()])


@pytest.mark.parametrize(("body", "depth"), [("C", 0.0), ("A", -1.0), ("A", math.nan)])
def test_wrong_arguments_are_refused(body, depth):
    with pytest.raises(ValueError, match=r"body|depth"):
        displacement(steady(), body, depth)
    if body == "A":
        with pytest.raises(ts.SceneError, match=r"observer\[0\]\.name"):
            ts.roll(DISSIMILAR.replace(observer=[RECORDS | {"depth": depth}]))


@pytest.mark.slow
def test_a_scene_records_them(tmp_path):
    named = [RECORDS | {"depth": 0.5}]
    wear = {"coefficient": 1e-2, "revolutions": 2, "stepping": "every-revolution"}
    scene = DISSIMILAR.replace(observer=named, wear=wear)
    ts.roll(scene, tmp_path / "a.h5")
    history = ts.open_history(tmp_path / "a.h5")
    contact = history.state(2)
    assert history["stored_energy"][-1] == pytest.approx(elastic_energy(contact), rel=1e-6)
    stored = history.field("displacement_z_B")
    np.testing.assert_allclose(stored, displacement(contact, "B", 0.5)[2], rtol=1e-6)
    assert ts.roll(DISSIMILAR, observers=[ElasticFields()])["stored_energy"][0] > 0.0
    figures = [figure for figure in plot.list_figures(history) if "displacement" in figure.name]
    assert len(figures) == 12  # of two records
    assert figures[-1].draw().axes
