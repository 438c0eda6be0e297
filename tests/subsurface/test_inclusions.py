"""Inclusions: closed forms of Eshelby, anisotropy, misfit, neighbours, passage of a contact."""

from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.contact import Model
from tractive_sam.mechanics import von_mises
from tractive_sam.operators import isotropic_stiffness
from tractive_sam.run.explain import expected_applications
from tractive_sam.run.memory import scene_bytes
from tractive_sam.studies import cases
from tractive_sam.studies.run import estimate_times
from tractive_sam.subsurface import InclusionGroup, around_inclusions
from tractive_sam.subsurface.inclusion_group import surface_points

SHEAR, NU = 80e3, 0.3
STIFFNESS = isotropic_stiffness(SHEAR, NU)
UNIAXIAL, TORSION = np.array([0.0, 0.0, 1.0, 0, 0, 0]), np.array([0.0, 0, 0, 0, 1.0, 0])
SCENE = ts.Scene.builtin("inclusion")


def sphere(young=None, poisson=0.3, at=(0.0, 0.0, 1e3), cells=9, **keys):
    if "stiffness" not in keys:
        keys |= {"young": young, "poisson": poisson}
    return ts.Inclusion(at=at, radii=1.0, cells=cells, **keys)


def solve(inclusions, stress, **options):
    """Group, strain and eigenstrain of inclusions in a uniform stress of the body."""
    group = InclusionGroup(inclusions, SHEAR, NU)
    strain = np.broadcast_to(
        np.linalg.solve(STIFFNESS, stress).reshape(6, 1, 1, 1), (6, *group.box.shape)
    )
    return group, *group.solve(strain.copy(), **options)


def centre_stress(group, strain, eigenstrain):
    stress = np.tensordot(group.stiffness, strain - eigenstrain, 1)
    return stress[(slice(None), *(n // 2 for n in group.box.shape))]


def eshelby(matrix, stress):
    """Uniform stress inside a sphere of any stiffness, by Eshelby's tensor of an isotropic body."""
    alpha, beta = (1 + NU) / (3 * (1 - NU)), 2 * (4 - 5 * NU) / (15 * (1 - NU))
    tensor = beta * np.eye(6)
    tensor[:3, :3] += (alpha - beta) / 3.0
    strain = np.linalg.solve(STIFFNESS, stress)
    change = matrix - STIFFNESS
    own = np.linalg.solve(change @ tensor + STIFFNESS, -change @ strain)
    return STIFFNESS @ (strain + tensor @ own - own)


@pytest.mark.parametrize(
    ("young", "poisson", "inside", "largest", "angle"),
    [
        (389e3, 0.25, (1.27578573, -0.06559358), 1.246481, 40.23),  # alumina
        (380e3, 0.25, (1.26558405, -0.06441595), 1.237240, 40.23),  # TiN
        (138e3, 0.3, (0.80606978, 0.01599345), 1.193164, 90.0),  # MnS
        (0.0, 0.3, (0.0, 0.0), 1.980796, 90.0),  # cavity
        (1e9, 0.3, None, 1.896505, 42.03),  # rigid
    ],
)
def test_a_sphere_in_uniaxial_stress_is_eshelbys(young, poisson, inside, largest, angle):
    group, strain, eigenstrain = solve([sphere(young, poisson)], UNIAXIAL)
    stress = centre_stress(group, strain, eigenstrain)
    if inside is not None:
        # 9 cells across: cells are partly in the sphere; the error falls with their number.
        np.testing.assert_allclose(stress[[2, 0]], inside, atol=3e-3)
    mises = von_mises(group.at_surface(0, strain, eigenstrain))
    assert mises.max() == pytest.approx(largest, rel=7e-3)
    _, normals = surface_points(group.inclusions[0])
    place = np.degrees(np.arccos(np.abs(normals[2, mises.argmax()])))
    assert place == pytest.approx(angle, abs=3.0)  # points are 4 degrees apart


def test_a_cavity_in_shear_has_its_largest_stress_out_of_the_plane_of_shear():
    group, strain, eigenstrain = solve([sphere(0.0)], TORSION)
    stress = group.at_surface(0, strain, eigenstrain)
    _, normals = surface_points(group.inclusions[0])
    mises = von_mises(stress)
    # At the poles across it: sqrt(3) times 15 (1 - nu)/(7 - 5 nu), as Goodier found in 1933.
    assert mises.max() == pytest.approx(3.0**0.5 * 15 * (1 - NU) / (7 - 5 * NU), rel=5e-3)
    assert abs(normals[1, mises.argmax()]) > 0.98


def test_errors_fall_at_least_in_proportion_to_the_cells():
    exact = eshelby(isotropic_stiffness(389e3 / 2.5, 0.25), UNIAXIAL)[2]
    errors = [
        abs(centre_stress(*solve([sphere(389e3, 0.25, cells=cells)], UNIAXIAL))[2] - exact)
        for cells in (7, 15)
    ]
    assert errors[1] < 0.5 * errors[0]


def test_the_stiffness_of_the_body_changes_nothing():
    same = ts.Inclusion(
        at=[0.0, 0.0, 1.5], radii=[1.0, 0.8, 0.7], young=208e3, poisson=0.3, cells=5
    )
    _, strain, eigenstrain = solve([same], UNIAXIAL + TORSION)
    assert np.abs(eigenstrain).max() < 1e-14 / SHEAR  # rounding
    np.testing.assert_allclose(np.tensordot(STIFFNESS, strain, 1)[2], 1.0, rtol=1e-12)


CUBIC = {"C11": 250e3, "C12": 110e3, "C44": 130e3}


def test_an_anisotropic_sphere_is_eshelbys():
    crystal = sphere(stiffness=CUBIC)
    assert crystal.matrix[3, 3] == 2.0 * 130e3  # of the strain of a tensor
    for stress in (UNIAXIAL, TORSION):
        inside = centre_stress(*solve([crystal], stress))
        np.testing.assert_allclose(inside, eshelby(crystal.matrix, stress), atol=4e-3)


def test_named_constants_are_those_of_their_crystal():
    hexagonal = sphere(stiffness=CUBIC | {"C13": 90e3, "C33": 300e3})
    rows = np.array(hexagonal.stiffness)
    assert rows[5, 5] == 70e3
    assert rows[1, 2] == 90e3
    assert rows[4, 4] == 130e3
    isotropic = sphere(stiffness={"C11": 280e3, "C12": 120e3, "C44": 80e3})
    np.testing.assert_allclose(isotropic.matrix, sphere(208e3).matrix, rtol=1e-12)


def test_a_misfit_of_the_same_material_has_the_uniform_stress_of_a_dilating_sphere():
    swollen = sphere(208e3, eigenstrain=1e-3)
    group, strain, eigenstrain = solve([swollen], 0.0 * UNIAXIAL, misfit=True)
    stress = centre_stress(group, strain, eigenstrain)
    np.testing.assert_allclose(stress[:3], -2 * 208e3 * 1e-3 / (3 * (1 - NU)), rtol=6e-3)  # 9 cells
    # Outside, sigma_rr = -2 sigma_tt, so that von Mises is 3/2 of the pressure inside.
    mises = von_mises(group.at_surface(0, strain, eigenstrain))
    np.testing.assert_allclose(mises, 1.5 * 208e3 * 2e-3 / (3 * (1 - NU)), rtol=1e-2)


def test_a_cuboid_is_stiff_in_its_middle_and_its_cells_fit_it():
    block = ts.Inclusion(at=[0, 0, 1e3], size=[2.0, 1.0, 1.0], young=389e3, poisson=0.25, cells=7)
    group, strain, eigenstrain = solve([block], UNIAXIAL)
    assert group.shares.sum() * np.prod(group.box.sides) == pytest.approx(2.0)
    np.testing.assert_allclose(group.shares, 1.0, rtol=1e-12)
    assert 1.0 < centre_stress(group, strain, eigenstrain)[2] < 1.4


def test_neighbours_change_each_other_the_less_the_farther_they_are():
    single = von_mises(stress_near_the_first([sphere(0.0, cells=7)])).max()
    changes = []
    for distance in (2.5, 5.0):
        two = [sphere(0.0, at=(x, 0.0, 1e3), cells=7) for x in (0.0, distance)]
        changes.append(abs(von_mises(stress_near_the_first(two)).max() / single - 1.0))
    assert changes[1] < 0.02 < changes[0]


def stress_near_the_first(inclusions):
    group, strain, eigenstrain = solve(inclusions, np.array([1.0, 0, 0, 0, 0, 0]))
    return group.at_surface(0, strain, eigenstrain)


@pytest.fixture(scope="module")
def contact():
    return ts.solve(SCENE)


def changed(contact, **keys):
    """The contact with other keys of its inclusion: it does not act on the contact."""
    inclusion = {**SCENE.entries()["inclusion"][0], **keys}
    return replace(contact, scene=SCENE.replace(inclusion=[inclusion]))


def test_an_inclusion_of_the_material_of_the_body_sees_the_stress_of_the_contact(contact):
    (same,) = around_inclusions(changed(contact, young=208e3, poisson=0.3))
    direct = von_mises(ts.stress_at(contact, [same.at], "B").T)[0]
    assert same.von_mises == pytest.approx(direct, rel=2e-3)  # splines between the elements
    sound = ts.fatigue(contact)["B"].utilisation_max
    assert same.utilisation < 1.05 * sound


def rolled(body, y=0.05, **inclusion):
    """A contact without friction, and what is around an inclusion in one of two equal bodies."""
    size = {"at": [0.0, y, 0.13], "radii": [0.02, 0.015, 0.01], "cells": 5}
    scene = SCENE.replace(
        inclusion=[{"body": body} | size | inclusion],
        fatigue=None,
        **{"body.B.radius_x": 10.0, "body.B.radius_y": 10.0},
    )
    contact = ts.solve(scene)
    (around,) = around_inclusions(contact)
    return contact, around


def test_both_bodies_have_the_same_stress_around_the_same_inclusion():
    """The depth is one axis of an inclusion, also in the body in which the axis z is opposite."""
    alumina = {"young": 389e3, "poisson": 0.25, "eigenstrain": [0.0, 0.0, 0.0, 0.0, 2e-3, 0.0]}
    (_, A), (_, B) = (rolled(body, **alumina) for body in "AB")
    for name in ("von_mises", "tension", "lift"):
        assert getattr(A, name) == pytest.approx(getattr(B, name), rel=1e-9)
    # Fields are in the axes of the contact.
    for name, sign in (("xx", 1.0), ("xz", -1.0)):
        field = A.plane.components[name]
        np.testing.assert_allclose(sign * B.plane.components[name], field, atol=1e-6 * 2000.0)


def test_mirror_images_have_the_same_values(contact):
    """Cells and points beside an inclusion are symmetric, and so is the contact without friction.

    There are so many cells that a part of them would miss the largest tension.
    """
    stretched = {"radii": [0.02, 0.012, 0.015], "cells": 11}
    first, image = (
        around_inclusions(
            changed(
                contact,
                at=[0.0, 0.06 * y, 0.13],
                eigenstrain=[1e-3, 0.0, 5e-4, 4e-4 * x * y, 3e-4 * x, -6e-4 * y],
                **stretched,
            )
        )[0]
        for x, y in ((1.0, 1.0), (-1.0, -1.0))
    )
    for name in ("von_mises", "utilisation", "tension", "lift"):
        # The solver leaves the contact, and so the image in x, asymmetric by its tolerance.
        assert getattr(image, name) == pytest.approx(getattr(first, name), rel=1e-6)
    assert image.at == pytest.approx(np.multiply(first.at, (-1.0, -1.0, 1.0)), abs=1e-7)


@pytest.mark.parametrize("y", [0.35, 0.8])
def test_an_inclusion_outside_the_mesh_sees_the_stress_there(y):
    """On the edge of the mesh, at 0.34 mm, and far from it."""
    contact, around = rolled("B", y, young=208e3, poisson=0.3)
    here = von_mises(ts.stress_at(contact, [around.at], "B").T)[0]
    # In an ellipsoid the strain is linear: here it bends by 1 %.
    assert around.von_mises == pytest.approx(here, rel=1.5e-2)


def test_places_are_those_in_the_body_where_the_running_band_moves(contact):
    """Fields of a block with shift_y count y from the middle of its band; rows stay in place."""
    shifted = replace(contact, grid=contact.grid.shifted(0.08))
    (there,), (here,) = around_inclusions(shifted), around_inclusions(contact)
    assert there.von_mises == pytest.approx(here.von_mises, rel=1e-9)
    lift = ts.inclusion_lift(contact)
    np.testing.assert_allclose(ts.inclusion_lift(shifted), lift, atol=1e-6 * lift.max())


def test_alumina_raises_the_utilisation_and_a_void_more(contact):
    (alumina,) = around_inclusions(contact)
    (void,) = around_inclusions(changed(contact, young=0.0))
    (same,) = around_inclusions(changed(contact, young=208e3, poisson=0.3))
    assert 1.1 < alumina.utilisation / same.utilisation < void.utilisation / same.utilisation
    assert void.tension == pytest.approx(0.0, abs=0.1)  # MPa; it carries nothing


def test_the_section_shows_the_stress_at_the_moment_of_the_largest(contact):
    (alumina,) = around_inclusions(contact)
    section = alumina.plane
    assert list(section.axes) == ["along", "depth"]
    np.testing.assert_allclose(section.axes["along"], -section.axes["along"][::-1], atol=1e-15)
    middle = section.components["zz"][section.axes["along"].size // 2]
    assert middle[np.abs(section.depth - 0.13).argmin()] == pytest.approx(middle.min(), rel=0.05)
    corner = [alumina.at[0] - alumina.plane.axes["along"][-1], 0.0, float(section.depth[0])]
    assert section.von_mises.max() < 1.3 * alumina.von_mises
    assert von_mises(ts.stress_at(contact, [corner], "B").T)[0] > 0.0


def test_records_are_stored_resumed_and_named(tmp_path):
    path = tmp_path / "inclusion.h5"
    history = ts.roll(SCENE, path)
    stored = ts.open_history(path)
    names = [name for name in stored.columns if name.startswith("inclusion")]
    assert "inclusion_utilisation" in names
    np.testing.assert_array_equal(stored["inclusion_von_mises"], history["inclusion_von_mises"])
    section = stored.stress("B", "inclusion-1")
    np.testing.assert_array_equal(section.von_mises, history.stress("B", "inclusion-1").von_mises)
    assert str(section.plane) == "inclusion-1"


def test_wear_uncovers_an_inclusion(contact):
    rolling = changed(contact, body="A")
    (before,) = around_inclusions(rolling)
    share = rolling.scene.turns.share_of_entering("A")
    worn = np.full((2, rolling.grid.elements[1]), 0.12 / share)
    (gone,) = around_inclusions(replace(rolling, wear=worn))
    assert np.isnan(gone.von_mises)
    assert np.isnan(gone.plane.von_mises).all()
    np.testing.assert_array_equal(gone.plane.depth, before.plane.depth)


def test_the_lift_of_the_surface_is_symmetric_and_moves_with_the_inclusion(contact):
    shallow = {"radii": 0.03, "at": [0.05, 0.0, 0.06]}
    hole = SCENE.replace(inclusion=[{**shallow, "young": 0.0, "body": "B", "cells": 7}])
    lift = ts.inclusion_lift(replace(contact, scene=hole))
    place = np.unravel_index(np.abs(lift).argmax(), lift.shape)
    assert lift[place] < 0.0  # the surface above a void yields
    assert contact.grid.x[place[0]] == pytest.approx(0.05, abs=contact.grid.dx)
    np.testing.assert_allclose(lift, lift[:, ::-1], atol=1e-4 * abs(lift[place]))


def lifting(young, elements=11, **keys):
    """A scene with a shallow inclusion whose lift changes the contact."""
    table = {"body": "B", "at": [0.0, 0.0, 0.1], "radii": 0.05, "young": young, "poisson": 0.3}
    changes = {"grid.elements": [elements, elements], "fatigue": None}
    return SCENE.replace(inclusion=[{**table, "cells": 5, "lifts": True, **keys}], **changes)


@pytest.fixture(scope="module")
def coarse():
    """The contact above which `lifting` inclusions pass."""
    return ts.solve(lifting(208e3))


@pytest.mark.slow
def test_a_void_lowers_the_pressure_above_it_and_a_rigid_inclusion_raises_it(coarse):
    peaks = {}
    for young in (0.0, 1e8):
        scene = lifting(young)
        (around,) = around_inclusions(replace(coarse, scene=scene))
        above, middle = around.above, np.abs(around.above.x).argmin()
        assert above.residual <= above.tolerance
        peaks[young] = above.peaks[middle]
        assert above.peaks[0] == pytest.approx(coarse.p_max, rel=3e-3)  # not yet below the contact
        # The lift in the gap is the lift by the pressure of this contact.
        own = ts.inclusion_lift(replace(above.contacts[middle], scene=scene))
        largest = np.abs(own).max()
        np.testing.assert_allclose(above.lifts[middle], own, atol=1e-3 * largest)  # table of lifts
        np.testing.assert_allclose(above.lifts[middle], own[::-1], atol=1e-3 * largest)
    assert peaks[0.0] < 0.98 * coarse.p_max < 1.02 * coarse.p_max < peaks[1e8]


def test_the_constants_of_the_body_lift_nothing(coarse):
    (around,) = around_inclusions(replace(coarse, scene=lifting(208e3)))
    assert np.abs(around.above.lifts).max() < 1e-15 * coarse.approach  # rounding
    np.testing.assert_allclose(around.above.peaks, coarse.p_max, rtol=1e-6)  # of the solver
    assert around.above.iterations == 1


@pytest.mark.slow
def test_a_loose_tolerance_of_the_contact_does_not_stop_the_iteration_with_the_lift():
    """A start within the tolerance would be its own solution: the lift would not act."""
    peaks = []
    for tolerance in (1e-9, 1e-3):
        scene = lifting(389e3).replace(**{"solver.tolerance": tolerance})
        (around,) = around_inclusions(ts.solve(scene))
        peaks.append(around.above.peaks.max())
    # The lift, by the pressure without it, has the error of the first contact.
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-4)


@pytest.mark.slow
def test_a_small_lift_changes_the_pressure_in_proportion(coarse):
    changes = []
    for factor in (1.0, 2.0):
        swollen = lifting(208e3, eigenstrain=[0.0, 0.0, 1e-5 * factor, 0.0, 0.0, 0.0])
        (around,) = around_inclusions(replace(coarse, scene=swollen))
        changes.append(around.above.peaks[np.abs(around.above.x).argmin()] - coarse.p_max)
    assert changes[0] > 0.1  # MPa
    assert changes[1] == pytest.approx(2.0 * changes[0], rel=0.02)  # edge elements change state


@pytest.mark.slow
def test_the_iterated_contact_is_the_direct_solution_with_the_compliance_of_the_inclusion():
    scene = lifting(0.0, elements=10, at=[0.0, 0.0, 0.17], radii=0.08)
    contact = ts.solve(scene)
    (around,) = around_inclusions(contact)
    found = around.above.contacts[np.abs(around.above.x).argmin()]
    touching, n = found.touching, int(found.touching.sum())
    extra, plain = np.empty((n, n)), np.empty((n, n))
    model = Model(scene, grid=contact.grid)
    for k, place in enumerate(np.argwhere(touching)):
        unit = np.zeros(contact.grid.elements)
        unit[tuple(place)] = 1.0
        loaded = replace(contact, pressure=unit, traction=0.0 * contact.traction)
        extra[:, k] = -ts.inclusion_lift(loaded)[touching]
        plain[:, k] = model.operators.normal(unit[None])[0][touching]
    plain *= model.units.gap / model.units.pressure
    # Work of a pressure on the lift by another one is that of the other on the lift by the first.
    assert np.abs(extra - extra.T).max() < 3e-2 * np.abs(extra).max()  # points, not elements
    assert found.pressure[touching] @ extra @ found.pressure[touching] > 0.0  # a void is soft
    area, gap = contact.grid.element_area, model.undeformed_gap[touching]
    for matrix, solved in ((plain, contact), (plain + extra, found)):
        # The pressure closes the gap at an unknown approach, and carries the load.
        inverse = np.linalg.solve(matrix, np.stack((np.ones(n), gap), axis=1))
        approach = (solved.P / area + inverse[:, 1].sum()) / inverse[:, 0].sum()
        pressure = approach * inverse[:, 0] - inverse[:, 1]
        if solved is found:
            np.testing.assert_allclose(found.pressure[touching], pressure, atol=1e-3 * found.p_max)
            assert found.approach == pytest.approx(approach, rel=1e-5)
        else:
            assert abs(solved.approach - approach) < 1e-2 * approach  # other elements touch


@pytest.mark.slow
def test_a_contact_above_a_dilating_sphere_is_that_with_the_exact_rise_as_its_gap():
    strain, radius, depth = 4e-4, 0.05, 0.1
    x = np.linspace(-0.8, 0.8, 401)
    distance = np.sqrt(x[:, None] ** 2 + x**2 + depth**2)
    rise = 4.0 / 3.0 * (1.0 + NU) * strain * radius**3 * depth / distance**3
    swollen = lifting(208e3, eigenstrain=strain, cells=11)
    rolling = {"friction": {"mu": 0.3}, "creepage": {"longitudinal": 2e-3, "lateral": 1e-3}}
    swollen = swollen.replace(load={"normal": ts.solve(lifting(208e3)).P}, **rolling)
    (around,) = around_inclusions(ts.solve(swollen))
    found = around.above.contacts[np.abs(around.above.x).argmin()]
    gap = ts.Gap(x=x, y=x, separation=-rise)
    with pytest.warns(ts.SceneWarning, match="fixed in space"):  # as it is here
        exact = ts.solve(swollen.replace(inclusion=None, gap=gap))
    plain = ts.solve(swollen.replace(inclusion=None))
    change = exact.p_max - plain.p_max
    assert change > 5.0  # MPa
    # The steps of 11 cells, and the spline between the samples of the gap.
    np.testing.assert_allclose(found.pressure, exact.pressure, atol=2e-2 * change)
    np.testing.assert_allclose(found.traction, exact.traction, atol=2e-2 * change)


def test_elements_longer_than_the_depth_of_a_lifting_inclusion_are_remarked():
    """At 1.3 depths, a quarter of the change of the pressure is missing."""
    shallow = SCENE.replace(inclusion=[GOOD | {"at": [0.0, 0.0, 0.03], "lifts": True}])
    for scene, expected in ((shallow, True), (shallow.replace(**{"inclusion[0].lifts": False}), 0)):
        rows = dict(row for section in ts.explain(scene) for row in section.rows)
        assert ("inclusion 1 is not resolved" in rows["stress around inclusions"]) == expected


def test_a_lift_needs_the_measured_gap(coarse):
    flat = ts.Gap(x=[-1.0, 1.0], y=[-1.0, 1.0], separation=[[0.0, 0.0]] * 2)
    scene = lifting(0.0, elements=11).replace(gap=flat, load={"normal": coarse.P})
    with pytest.raises(ValueError, match="need the separation"):
        around_inclusions(replace(coarse, scene=scene))


def test_the_lift_is_stored_and_remarked(tmp_path):
    path = tmp_path / "lift.h5"
    scene = lifting(0.0)
    history = ts.roll(scene, path)
    stored = ts.open_history(path)
    for name in ("p_max", "p_min", "iterations", "residual"):
        column = f"inclusion_{name}"
        np.testing.assert_array_equal(stored[column], history[column])
    assert stored["inclusion_p_min"][0, 1] < 0.99 * stored["p_max"][0]
    assert stored["inclusion_convolutions"][0] > 10.0 * stored["convolutions"][0]
    without = ts.roll(scene.replace(**{"inclusion[0].lifts": False}))
    assert "inclusion_p_min" not in without.columns
    passage = stored.passage("B", "inclusion-1")
    for name in passage.quantities:
        live = getattr(history.passage("B", "inclusion-1"), name)
        np.testing.assert_array_equal(getattr(passage, name), live)
    assert np.nanmin(passage.p_max) == stored["inclusion_p_min"][0, 1]
    assert passage.von_mises.max() == stored["inclusion_von_mises"][0, 1]
    assert np.abs(passage.lift).max() == pytest.approx(stored["inclusion_lift"][0, 1], rel=1e-12)
    drawings = [drawing for drawing in plot.list_figures(stored) if "passage" in drawing.name]
    assert [drawing.name for drawing in drawings] == ["passage-inclusion-1"]
    pressure, lift, stress = drawings[0].draw().axes
    assert pressure.get_ylabel() == r"$p_\mathrm{max}/p_0$"
    np.testing.assert_allclose(lift.lines[0].get_ydata() * stored["approach"][0], passage.lift)
    with plot.units("si-mm"):
        lift, stress = plot.inclusion_passage(without, "B").axes
    assert (lift.get_ylabel(), stress.get_xlabel()) == (
        r"lift ($\mathrm{\mu m}$)",
        "position of inclusion 1, $x$ (mm)",
    )
    with pytest.raises(LookupError, match="inclusion-1 of B"):
        stored.passage("B", "inclusion-2")


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        ("inclusion", {"body.A.radius_y": np.inf, "body.B.radius_y": np.inf, "grid": None,
                       "load": {"normal": 500.0}}),
        ("wheel-rail", {}),
        ("traction-control", {}),
    ],
)  # fmt: skip
def test_a_lift_that_no_contact_can_have_is_refused(scene, changes):
    with pytest.raises(ts.SceneError) as error:
        ts.Scene.builtin(scene).replace(inclusion=[GOOD | {"lifts": True}], **changes)
    assert "inclusion[0].lifts" in [fault.key for fault in error.value.faults]


GOOD = {"at": [0.0, 0.0, 0.1], "radii": 0.02, "young": 389e3, "poisson": 0.25}


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"body": "C"}, "body"),
        ({"at": [0.0, 0.1]}, "at"),
        ({"at": [0.0, 0.0, -0.1]}, "at"),
        ({"at": [0.0, 0.0, 0.01]}, "at"),
        ({"radii": -1.0}, "radii"),
        ({"radii": [1.0, 2.0]}, "radii"),
        ({"size": 0.02}, "radii"),
        ({"radii": None}, "radii"),
        ({"young": None}, "young"),
        ({"young": -1.0}, "young"),
        ({"poisson": None}, "poisson"),
        ({"poisson": 0.5}, "poisson"),
        ({"stiffness": CUBIC}, "young"),
        ({"young": None, "poisson": None, "stiffness": [[1.0]]}, "stiffness"),
        ({"young": None, "poisson": None, "stiffness": CUBIC | {"C12": 300e3}}, "stiffness"),
        ({"eigenstrain": 0.5}, "eigenstrain"),
        ({"eigenstrain": [1e-3, 0.0]}, "eigenstrain"),
        ({"young": 0.0, "eigenstrain": 1e-3}, "eigenstrain"),
        ({"cells": 3}, "cells"),
        ({"radius": 0.1}, "radius"),
    ],
)
def test_a_fault_of_an_inclusion(changes, key):
    table = {name: value for name, value in (GOOD | changes).items() if value is not None}
    with pytest.raises(ts.SceneError) as error:
        SCENE.replace(inclusion=[table])
    assert f"inclusion[0].{key}" in [fault.key for fault in error.value.faults]


def test_inclusions_need_a_uniform_body_and_their_own_place():
    twice = [GOOD, GOOD | {"at": [0.01, 0.0, 0.1]}]
    with pytest.raises(ts.SceneError) as error:
        SCENE.replace(inclusion=twice)
    assert [fault.key for fault in error.value.faults] == ["inclusion[1].at"]
    with pytest.raises(ts.SceneError) as error:
        ts.Scene.builtin("fretting").replace(inclusion=[GOOD])
    assert "inclusion" in [fault.key for fault in error.value.faults]
    with pytest.raises(ts.SceneError, match="3 mm wide"):
        SCENE.replace(inclusion=[GOOD | {"at": [0.0, 1.49, 0.1]}], **{"body.A.width": 3.0})
    coated = {"body.A.layer": [{"thickness": 0.1, "young": 300e3, "poisson": 0.2}]}
    with pytest.raises(ts.SceneError) as error:
        SCENE.replace(inclusion=[GOOD | {"body": "A"}], **coated)
    assert "inclusion[0].body" in [fault.key for fault in error.value.faults]


def test_the_memory_of_large_boxes_is_known_before_they_are_computed():
    near = [GOOD, GOOD | {"at": [0.0, 0.0, 0.125], "radii": 0.001, "cells": 31}]
    rows = dict(
        row for section in ts.explain(SCENE.replace(inclusion=near)) for row in section.rows
    )
    assert "more than" in rows["memory"]


def test_the_time_of_a_scene_includes_that_of_its_inclusions():
    def seconds(cells):
        table = {**SCENE.entries()["inclusion"][0], "cells": cells}
        scene = SCENE.replace(inclusion=[table])
        rows = dict(row for section in ts.explain(scene) for row in section.rows)
        return rows["time"]

    assert "a second or less" in seconds(7)
    assert "a second or less" not in seconds(31)


def test_the_time_of_a_study_includes_that_of_inclusions():
    scenes = [SCENE.replace(inclusion=inclusion) for inclusion in (None, [GOOD | {"cells": 21}])]
    without, with_inclusion = estimate_times(scenes, with_files=False)
    assert with_inclusion > without + 1.0  # s


def test_explain_counts_the_contacts_that_inclusions_lift():
    works = []
    for inclusion in (None, [GOOD], [GOOD | {"lifts": True}]):
        model = Model(SCENE.replace(inclusion=inclusion))
        works.append((expected_applications(model), scene_bytes(model)))
    assert works == sorted(works)
    assert works[2][0] > 3 * works[1][0]


def test_a_study_varies_the_keys_of_an_inclusion():
    radii = {"key": "inclusion[0].radii", "start": 0.005, "stop": 0.02, "number": 2}
    depth = {"key": "inclusion[0].at[2]", "values": [0.1, 0.2]}
    scenes = [case.scene for case in cases(ts.Study(scene="inclusion", axis=[radii, depth]))]
    assert [scene.inclusion[0].radii[0] for scene in scenes] == [0.005, 0.005, 0.02, 0.02]
    assert [scene.inclusion[0].at[2] for scene in scenes] == [0.1, 0.2, 0.1, 0.2]


def test_a_spread_observes_inclusions_and_varies_them():
    uncertain = [
        {"key": "inclusion[0].radii", "distribution": "lognormal", "median": 0.01, "factor": 1.5},
        {"key": "inclusion[0].at[2]", "distribution": "uniform", "low": 0.05, "high": 0.3},
    ]
    spread = {"scene": "inclusion", "observe": ["inclusion_utilisation B"], "percentiles": [90]}
    design = ts.SpreadDesign(spread=spread, uncertain=uncertain)
    assert design.spread.observe == ("inclusion_utilisation B",)
