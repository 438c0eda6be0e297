"""Symmetries and balances of tractive rolling contact."""

import numpy as np
import pytest

from tests.scenes import steady

GENERAL = (
    "friction.mu=[0.5, 0.2]",
    "friction.angle=35",
    "creepage.longitudinal=-0.002",
    "creepage.lateral=0.001",
    "creepage.spin=0.0004",
)
DISSIMILAR = ("body.B.shear=8.0", "body.B.poisson=0.45")
# Two solves to 1e-8 of different but equivalent problems.
TWO_SOLVES = 1e-6


def general(*settings):
    return steady("spheres", *settings, elements=25)


def close(a, b):
    np.testing.assert_allclose(a, b, atol=TWO_SOLVES * np.abs(b).max())


@pytest.mark.parametrize("bodies", [(), DISSIMILAR])
def test_mirror_in_y(bodies):
    """y -> -y flips beta, xi_y, phi, and with them p_y, Q_y and M_z."""
    one = general(*bodies, *GENERAL)
    two = general(
        *bodies, *GENERAL, "friction.angle=-35", "creepage.lateral=-0.001", "creepage.spin=-0.0004"
    )
    close(two.pressure[:, ::-1], one.pressure)
    close(two.traction[0, :, ::-1], one.traction[0])
    close(-two.traction[1, :, ::-1], one.traction[1])
    assert two.Qx == pytest.approx(one.Qx, rel=TWO_SOLVES)
    assert two.Qy == pytest.approx(-one.Qy, rel=TWO_SOLVES)
    assert two.Mz == pytest.approx(-one.Mz, rel=1e-5)


def test_exchange_of_the_tribological_axes():
    """(mu1, mu2, beta) and (mu2, mu1, beta + 90) are one law."""
    one = general(*GENERAL)
    two = general(*GENERAL, "friction.mu=[0.2, 0.5]", "friction.angle=125")
    close(two.traction, one.traction)


def test_friction_angle_has_a_period_of_half_a_turn():
    close(general(*GENERAL, "friction.angle=215").traction, general(*GENERAL).traction)


def test_swapping_the_bodies_mirrors_the_solution():
    """Seen from the other body, turned about x: xi_x and p_x change sign; y is mirrored.

    xi_x -> -xi_x, xi_y and phi stay, beta -> -beta;
    p_n(x, y) -> p_n(x, -y), p_x -> -p_x(x, -y), p_y -> p_y(x, -y).
    """
    one = general(*DISSIMILAR, *GENERAL)
    two = general(
        "body.A.shear=8.0",
        "body.A.poisson=0.45",
        *GENERAL,
        "friction.angle=-35",
        "creepage.longitudinal=0.002",
    )
    close(two.pressure[:, ::-1], one.pressure)
    close(-two.traction[0, :, ::-1], one.traction[0])
    close(two.traction[1, :, ::-1], one.traction[1])


def test_a_nearly_rigid_body_gives_the_limit():
    rigid, nearly, further = (
        general(*GENERAL, f"body.B.shear={shear}", "body.B.poisson=0.3").traction
        for shear in (1e12, 1e5, 1e3)
    )
    close_by, far_off = np.abs(nearly - rigid).max(), np.abs(further - rigid).max()
    # The deviation is proportional to the compliance of B.
    assert far_off / close_by == pytest.approx(100, rel=0.1)


def test_equal_materials_are_the_limit_of_dissimilar_ones():
    equal = general(*GENERAL)
    nearly = general(*GENERAL, "body.B.poisson=0.2800001")
    np.testing.assert_allclose(nearly.traction, equal.traction, atol=1e-5 * equal.p_max)


@pytest.mark.parametrize("angle", [0, 25, 45, 90, 140])
def test_full_slip_of_orthotropic_friction(angle):
    """|Q_x|/P = mu_eff, Q_y/P = (mu1² - mu2²) sin beta cos beta / mu_eff."""
    contact = general(
        "friction.mu=[0.4, 0.2]", f"friction.angle={angle}", "creepage.longitudinal=-10.0"
    )
    c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
    effective = np.hypot(0.4 * c, 0.2 * s)
    # The elastic slip is 1e-4 of the rigid one here; it turns the traction by as little.
    assert contact.Qx / contact.P == pytest.approx(effective, rel=1e-5)
    lateral = (0.4**2 - 0.2**2) * s * c / effective
    assert contact.Qy / contact.P == pytest.approx(lateral, rel=1e-3, abs=1e-6)
    assert contact.stick_fraction == 0.0


def work_of_forces(contact):
    return -(contact.Qx * contact.xi_x + contact.Qy * contact.xi_y + contact.Mz * contact.spin)


@pytest.mark.parametrize("settings", [GENERAL, ("creepage.spin=0.003",)])
def test_energy_law_of_equal_materials(settings):
    """Frictional work is the work of forces on creepages, to rounding and at any residual."""
    contact = general(*settings)
    assert contact.rolling_resistance == 0.0
    assert contact.work_supplied == pytest.approx(work_of_forces(contact), rel=1e-12)
    assert contact.dissipation == pytest.approx(work_of_forces(contact), rel=1e-10)


COMBINED = ("creepage.longitudinal=-0.0015", "creepage.lateral=0.0007", "creepage.spin=0.0005")


@pytest.mark.parametrize("tolerance", [1e-8, 1e-3])
@pytest.mark.parametrize("settings", [GENERAL, COMBINED, ("creepage.longitudinal=0.0",)])
def test_energy_law_of_dissimilar_bodies(settings, tolerance):
    """With the rolling resistance, to rounding on any mesh and at any residual."""
    for elements in (15, 40):
        contact = steady(
            "spheres", *DISSIMILAR, f"solver.tolerance={tolerance}", *settings, elements=elements
        )
        assert abs(contact.rolling_resistance) > 0.01 * contact.dissipation
        assert contact.dissipation == pytest.approx(contact.work_supplied, rel=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("settings", [GENERAL, ("creepage.longitudinal=-0.0031",)])
def test_rolling_resistance_is_the_moment_of_the_pressure(settings):
    """p_n off the middle resists rolling by the integral of p_n dh/dx.

    The elastic energy does no net work, integral of p_t . du_t/dx + p_n du_n/dx = 0, and in contact
    du_n/dx = -dh/dx. At the edge of contact they differ, by an amount that depends on its place
    within the elements.
    """

    def missed(meshes):
        errors = []
        for elements in meshes:
            contact = steady("spheres", *DISSIMILAR, *settings, elements=int(elements))
            slope = contact.grid.x[:, None] / contact.scene.body.radii[0]
            moment = (contact.pressure * slope).sum() * contact.grid.element_area
            errors.append(contact.rolling_resistance / moment - 1.0)
        return np.sqrt(np.mean(np.square(errors)))

    coarse, fine = missed(np.arange(15, 28, 2)), missed(np.arange(45, 82, 6))
    # Orders 1.6 and 1.8, on meshes three times as fine.
    assert fine < 3**-1.4 * coarse
    assert fine < 1e-2


def test_friction_opposes_slip():
    contact = general(*GENERAL)
    assert ((contact.traction * contact.slip).sum(axis=0)[contact.sliding] < 0).all()
    driving = general("creepage.longitudinal=-0.002")
    assert driving.Qx > 0


def test_without_cause_there_is_no_traction():
    for settings in (
        ("creepage.longitudinal=0.0",),  # equal materials roll freely
        ("creepage.longitudinal=-1e-30",),
    ):
        assert np.abs(general(*settings).traction).max() < 1e-20


@pytest.mark.parametrize("method", ["auto", "newton", "anderson", "uzawa"])
def test_frictionless_scene(method):
    from tractive_sam.contact import Model, equilibrium  # noqa: PLC0415
    from tractive_sam.scene import Scene  # noqa: PLC0415

    for name in ("spheres", "spheres-dissimilar"):
        scene = Scene.builtin(name).replace(
            **{"friction": None, "solver.method": method, "grid": None, "subsurface": None}
        )
        contact = equilibrium(Model(scene))
        assert contact.converged
        assert not contact.traction.any()
        assert contact.stick_fraction == 0.0
        if name == "spheres":  # the pressure of dissimilar bodies slips as well
            np.testing.assert_allclose(contact.slip[0][contact.touching], -0.0031)
