"""The contact conditions, recomputed from dense matrices, hold to the residual reported."""

from functools import cache

import numpy as np
import pytest

from tests.operators.test_elastic import dense as make_dense
from tests.scenes import steady
from tests.test_hard_scenes import residual
from tractive_sam.contact import Model
from tractive_sam.contact.steady import dimensionless_start
from tractive_sam.operators import STAGGERED, Lattice
from tractive_sam.operators.stencil import edge_angles
from tractive_sam.solvers.newton import Iterate

dense = cache(make_dense)
"""Both schemes have equal matrices, and those of some scenes are."""

SCENES = [
    ("spheres", "creepage.spin=0.0005"),
    ("spheres-orthotropic", "creepage.lateral=0.001"),
    ("spheres-orthotropic", "load.approach=0.03"),
    ("spheres", "body.B.shear=10.0", "body.B.poisson=0.45", "creepage.lateral=0.001"),
    ("spheres", "load.force_x=0.1", "load.force_y=0.03"),
]


@pytest.mark.parametrize("scheme", ["auto", "upwind"])
@pytest.mark.parametrize("settings", SCENES)
def test_contact_conditions(settings, scheme):
    name, *changes = settings
    contact = steady(
        name, f'solver.slip="{scheme}"', "solver.tolerance=1e-10", *changes, elements=15
    )
    assert contact.converged
    scene, grid, p = contact.scene, contact.grid, contact.pressure
    mesh = Lattice(grid.elements, grid.dx, grid.dy)
    here, ahead = dense(mesh, scene.material), dense(mesh, scene.material, ahead=1)
    loads = np.concatenate((contact.traction, p[None])).reshape(3, -1)
    u, u_ahead = (np.einsum("injm,jm->in", A, loads) for A in (here, ahead))
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")

    # Signorini.
    radius = scene.body.radii[0]
    gap = ((x**2 + y**2) / (2 * radius)).ravel() + u[2]
    gap -= gap[p.ravel() > 0].mean()
    touching = p.ravel() > 0
    assert (p >= 0).all()
    assert np.abs(gap[touching]).max() < 1e-8 * np.abs(u[2]).max()
    assert gap[~touching].min() > -1e-8 * np.abs(u[2]).max()

    # Slip of the leading faces.
    if scheme == "auto":
        x = x + 0.5 * grid.dx
    slip = np.stack((contact.xi_x - contact.spin * y, contact.xi_y + contact.spin * x))
    slip = slip.reshape(2, -1) - (u_ahead - u)[:2] / grid.dx
    unit = np.abs(slip[:, touching]).max()
    reported, requested, opposed = slip, slip, slip
    if scheme == "auto":
        gap = np.where(p > 0.0, 0.0, gap.reshape(p.shape))
        reported, requested, opposed = (
            field.reshape(2, -1) for field in staggered(contact, slip.reshape(2, *p.shape), gap)
        )

    # Coulomb: |p~| <= p_n; zero slip in stick, p~ = -p_n s~/|s~| in slip.
    frame = Model(scene).frame
    scaled = frame.to_scaled(contact.traction.reshape(2, -1))
    slip_scaled = frame.slip_to_scaled(opposed)
    bound = p.ravel()
    sliding = contact.sliding.ravel()
    sticking = touching & ~sliding
    assert (np.hypot(*scaled) <= bound * (1 + 1e-12)).all()
    assert np.abs(requested[:, sticking]).max(initial=0) < 1e-6 * unit
    aligned = scaled + bound * slip_scaled / np.maximum(np.hypot(*slip_scaled), 1e-300)
    # Without the solver this is known only for slip taken entirely at the centre.
    known = sliding & np.isfinite(opposed).all(axis=0)
    assert np.count_nonzero(known) > 0.5 * np.count_nonzero(sliding)
    assert np.abs(aligned[:, known]).max() < 1e-5 * bound.max()

    # Resultants and the fields reported.
    if scene.load.normal:
        assert pytest.approx(scene.load.normal, rel=1e-9) == contact.P
    if scene.load.force_x:
        assert contact.Qx == pytest.approx(scene.load.force_x, rel=1e-8)
        assert contact.Qy == pytest.approx(scene.load.force_y, rel=1e-8)
    np.testing.assert_allclose(
        contact.slip.reshape(2, -1)[:, touching], reported[:, touching], atol=1e-8 * unit
    )


def staggered(contact, face, gap):
    """Slip reported, slip that must vanish in stick, and slip opposed, of the default scheme.

    The last is nan if it is not taken at the centre: at the ends of slip, and at the edge.
    """
    p = contact.pressure
    behind, ahead = (np.roll(face, k, axis=1) for k in (1, -1))
    requested = face.copy()
    i, j = STAGGERED.leading(p, gap)
    angle = edge_angles(p, i, j, contact.grid.dx / contact.grid.dy)
    normal = np.stack((np.cos(angle), np.sin(angle)))
    nu = contact.scene.material.poisson
    share = contact.traction[:, i, j] / p[i, j]
    share = (share - nu * normal * (normal * share).sum(axis=0)) / (1 - nu)
    requested[:, i, j] += share * gap[i + 1, j] / contact.grid.dx
    centre = 0.375 * behind + 0.75 * face - 0.125 * ahead
    frame = Model(contact.scene).frame
    a, m = frame.slip_to_scaled(face), frame.slip_to_scaled(centre)
    agreement = 2 * (a * m).sum(axis=0) / (a**2 + m**2).sum(axis=0)
    inside = (np.roll(p, -1, axis=0) > 0) & (np.roll(p, -2, axis=0) > 0)
    opposed = np.where(inside & (agreement >= 0.75), centre, np.nan)
    return 0.5 * (face + behind), requested, opposed


NEARLY_ALIKE = ("body.B.shear=1.000001", "creepage.longitudinal=-1e-7")
"""Spheres with tractions of some 1e-5 of the pressure."""


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("bodies", [(), NEARLY_ALIKE, ("body.B.shear=8.0", "body.B.poisson=0.45")])
def test_the_residual_is_the_larger_of_both_problems_own(bodies, tolerance):
    """However small the tractions are beside the pressure."""
    contact = steady("spheres", *bodies, f"solver.tolerance={tolerance}", elements=13)
    assert contact.converged
    # Sizes differ by what is missed: at most the tolerance.
    assert residual(contact) == pytest.approx(contact.residual, rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_tractions_that_are_tiny_against_the_pressure_are_solved_for(tolerance):
    rough = steady("spheres", *NEARLY_ALIKE, f"solver.tolerance={tolerance}", elements=41)
    close = steady("spheres", *NEARLY_ALIKE, "solver.tolerance=1e-10", elements=41)
    assert np.abs(close.traction).max() < 1e-4 * close.p_max
    # Smooth parts of the slip are small compared with parts of one element: a few times the
    # residual.
    assert rough.Qx == pytest.approx(close.Qx, rel=10 * tolerance)


@pytest.mark.filterwarnings("ignore:grid.elements")
@pytest.mark.parametrize("change", [-1.0, 1.0])
def test_tractions_of_the_rounding_of_their_slip_miss_nothing(change):
    """One element that rolls freely has none; its slip is what adding up its parts leaves."""
    mesh = ("grid.half_length=0.43", "grid.elements=33")  # far wider than the contact
    contact = steady("cylinders-dissimilar", *mesh, "load.normal=1e-3")
    model = Model(contact.scene)
    problem = model.problem(model.undeformed_gap / model.units.gap, None)
    start = dimensionless_start(model, contact)
    found = Iterate(problem, start.pressure, start.traction, start.approach, start.creepage)
    response = found.response * (1.0 + change * np.finfo(float).eps)
    fields = start.pressure, start.traction, start.approach, start.creepage
    assert Iterate(problem, *fields, response=response).residual <= 1e-8
    # More than that is reported: half of a thousandth of the creepage.
    response[-2:] += 5e-4 * np.abs(start.creepage).max() * problem.forces.vectors[0][:, None, None]
    assert Iterate(problem, *fields, response=response).residual > 0.5
