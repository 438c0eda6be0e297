"""The contact conditions, recomputed from dense matrices, hold to the residual reported."""

import numpy as np
import pytest

from tests.conftest import steady
from tests.operators.test_half_space import dense
from tractive_sam.contact import Model
from tractive_sam.operators import Mesh


@pytest.mark.parametrize(
    "settings",
    [
        ("spheres", "creepage.spin=0.0005"),
        ("spheres-orthotropic", "creepage.lateral=0.001"),
        ("spheres-orthotropic", "load.approach=0.03"),
        ("spheres", "body.B.shear=10.0", "body.B.poisson=0.45", "creepage.lateral=0.001"),
        ("spheres", "load.traction_x=0.1", "load.traction_y=0.03"),
    ],
)
def test_contact_conditions(settings):
    name, *changes = settings
    # The upwind slip is what is solved for; the default reports it at the elements' centres.
    contact = steady(name, 'solver.slip="upwind"', "solver.tolerance=1e-10", *changes, elements=15)
    assert contact.converged
    scene, grid, p = contact.scene, contact.grid, contact.pressure
    mesh = Mesh(grid.elements, grid.dx, grid.dy)
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

    # Coulomb: |p~| <= p_n, and p~ = -p_n s~/|s~| where it slips.
    slip = np.stack((contact.xi_x - contact.spin * y, contact.xi_y + contact.spin * x))
    slip = slip.reshape(2, -1) - (u_ahead - u)[:2] / grid.dx
    frame = Model(scene).frame
    scaled = frame.to_scaled(contact.traction.reshape(2, -1))
    slip_scaled = frame.slip_to_scaled(slip)
    bound = p.ravel()
    sliding = contact.sliding.ravel()
    sticking = touching & ~sliding
    unit = np.abs(slip[:, touching]).max()
    assert (np.hypot(*scaled) <= bound * (1 + 1e-12)).all()
    assert np.abs(slip[:, sticking]).max(initial=0) < 1e-6 * unit
    aligned = scaled + bound * slip_scaled / np.maximum(np.hypot(*slip_scaled), 1e-300)
    assert np.abs(aligned[:, sliding]).max() < 1e-5 * bound.max()

    # Resultants and the fields reported.
    if scene.load.normal:
        assert pytest.approx(scene.load.normal, rel=1e-9) == contact.P
    if scene.load.traction_x:
        assert contact.Qx == pytest.approx(scene.load.traction_x, rel=1e-8)
        assert contact.Qy == pytest.approx(scene.load.traction_y, rel=1e-8)
    np.testing.assert_allclose(
        contact.slip.reshape(2, -1)[:, touching], slip[:, touching], atol=1e-8 * unit
    )
