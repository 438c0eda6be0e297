"""Line contacts against Hertz, Carter, Bentall & Johnson, and long ellipses."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.scenes import across_contact, size, steady, steady_line
from tractive_sam.contact import Model, enlarge, equilibrium
from tractive_sam.reference import Carter, bentall_johnson_creepage
from tractive_sam.results.grid import Grid
from tractive_sam.scene import Scene

MU = 0.3


@cache
def by_default(creepage, name):
    """Return the contact that the default method finds."""
    return steady_line(32, creepage, name=name)


def carter(contact, creepage):
    return Carter(contact.scene.hertz, MU, creepage)


def test_hertz():
    """Mean error of the pressure relative to p0; the peak and the approach are right to h²."""
    errors = []
    for n in (64, 128):
        contact = steady_line(n)
        hertz = contact.scene.hertz
        errors.append(np.abs(contact.pressure[:, 0] - hertz.pressure(contact.grid.x)).mean())
        assert pytest.approx(500.0, rel=1e-12) == contact.P
        assert contact.p_max == pytest.approx(hertz.p0, rel=1 / n**2)
        assert contact.approach == pytest.approx(hertz.approach, rel=1 / n**2)
        assert contact.half_width_x == pytest.approx(hertz.a, rel=2 / n**2)
        assert contact.half_width_y == math.inf
    # The edge is wrong by h^1/2 over a few elements: h^3/2 in the mean.
    assert errors[1] < 0.45 * errors[0] < 0.45 * 2e-3 * hertz.p0


@pytest.mark.parametrize("share", [0.02, 0.3, 0.7, 0.95, 1.5])
def test_carter_over_the_whole_range_of_creepage(share):
    """`share` of the creepage of full slip."""
    force, traction, stick = [], [], []
    for n in (64, 128, 256):
        full = MU * 0.3731763 / 25.0
        contact = steady_line(n, f"creepage.longitudinal={-share * full}")
        theory = carter(contact, -share * full)
        force.append(abs(contact.Qx / (MU * contact.P) - theory.force_ratio))
        traction.append(size(contact.traction[0, :, 0] - theory.traction(contact.grid.x)))
        traction[-1] /= size(contact.traction)
        stick.append(abs(contact.stick_fraction - theory.stick_half_width / theory.hertz.a))
        # Of second order: stick ends between elements; of 0.95, 2 elements of 64 stick.
        assert stick[-1] < 30 / n**2
    if share > 1:
        assert max(force) < 1e-9  # all slips, whatever the mesh
        return
    # An upwind difference is of first order; better ones stay below its errors.
    for n, error in zip((64, 128, 256), force, strict=True):
        assert error < 0.5 * math.sqrt(share) / n
    assert traction[2] < 0.75 * traction[1] < 0.75 * 0.75 * traction[0]


def test_slip_of_carter():
    contact = steady_line(256)
    truth = carter(contact, -0.002).slip(contact.grid.x)
    # Away from the ends of the slip zone: the slip starts like a root.
    inner = (contact.grid.x > -0.95 * contact.scene.hertz.a) & (truth < -6e-4)
    np.testing.assert_allclose(contact.slip[0, inner, 0], truth[inner], rtol=0.02)


def test_lateral_creepage_is_antiplane_shear():
    """Its compliance is the one of plane strain over 1 - nu: Carter's solution at xi (1 - nu)."""
    errors = []
    for n in (64, 128):
        contact = steady_line(n, "creepage.longitudinal=0", "creepage.lateral=-0.002")
        theory = carter(contact, -0.002 * (1 - 0.3))
        errors.append(abs(contact.Qy / (MU * contact.P) - theory.force_ratio))
        assert contact.Qx == 0.0
    assert errors[1] < 0.6 * errors[0] < 0.6 * 0.02


@pytest.mark.parametrize("name", ["cylinders", "cylinders-dissimilar"])
def test_energy_law(name):
    """Work of forces on creepages is dissipated, and with K != 0 the work of the pressure."""
    contact = steady_line(
        128,
        "creepage.longitudinal=-0.0008",
        "creepage.lateral=0.001",
        "friction.mu=[0.3, 0.2]",
        "friction.angle=30",
        name=name,
    )
    if name == "cylinders":
        work = -(contact.Qx * contact.xi_x + contact.Qy * contact.xi_y)
        assert contact.dissipation == pytest.approx(work, rel=1e-10)
    # With K != 0 the edges of the contact leave an error of the mesh.
    assert contact.dissipation == pytest.approx(contact.work_supplied, rel=0.02)


@pytest.mark.parametrize("method", ["newton", "anderson", "uzawa"])
@pytest.mark.parametrize("name", ["cylinders", "cylinders-dissimilar"])
def test_methods_agree(name, method):
    creepage = "creepage.longitudinal=-0.0005"
    contact = steady_line(32, creepage, f'solver.method="{method}"', name=name)
    assert contact.converged, contact.message
    close = by_default(creepage, name)
    np.testing.assert_allclose(contact.traction, close.traction, atol=1e-6 * close.p_max)
    assert contact.approach == pytest.approx(close.approach, rel=1e-6)


def test_force_gives_the_creepage_of_carter():
    contact = steady_line(256, "load.force_x=100")
    theory = Carter.from_force_ratio(contact.scene.hertz, MU, 100 / (MU * 500))
    assert contact.Qx == pytest.approx(100, rel=1e-7)
    assert contact.xi_x == pytest.approx(theory.creepage, rel=0.01)


ALUMINIUM = {"shear": 23e3, "poisson": 0.31, "radius_x": 50.0, "radius_y": math.inf}
STEEL = {"shear": 82e3, "poisson": 0.28, "radius_x": 50.0, "radius_y": math.inf}


def freely(mu, n, **changes):
    """Aluminium on steel, free rolling; half width 0.1 mm."""
    load = {"normal": 27.5, "force_x": 0.0}
    body = {"A": ALUMINIUM, "B": STEEL}
    scene = Scene(body=body, load=load, friction={"mu": mu}).replace(**changes)
    return equilibrium(Model(across_contact(scene, n, beside=8)))


def test_free_rolling_of_unlike_cylinders_with_little_friction():
    """Bentall & Johnson's limit mu -> 0: the creepage at which the forces of slip cancel.

    Found between creepages 3 % apart; the force is a share of mu P that vanishes with mu.
    """
    missed = []
    for mu in (3e-3, 1e-3):
        scene = freely(0.1, 16).scene
        limit = bentall_johnson_creepage(scene.material, scene.hertz.a, 25.0)
        assert limit < 0
        below, at, above = (
            freely(mu, 128, **{"creepage.longitudinal": f * limit}).Qx / (mu * 27.5)
            for f in (0.97, 1.0, 1.03)
        )
        assert below < 0 < above
        missed.append(at)
    assert missed[1] < 0.5 * missed[0] < 0.5 * 0.06


@pytest.mark.slow
@pytest.mark.parametrize("n", [64, 256])
def test_the_creepage_of_free_rolling_with_little_friction(n):
    """It tends to Bentall & Johnson's as mu falls, until a jump of one element's traction counts.

    There the force falls with the creepage in stairs, and its root is on a steep one.
    """
    missed = []
    for mu in (1e-2, 3e-3, 1e-3, 1e-4):
        contact = freely(mu, n)
        assert contact.converged, contact.message
        assert abs(contact.Qx) < 1e-5 * mu * contact.P
        limit = bentall_johnson_creepage(contact.scene.material, contact.scene.hertz.a, 25.0)
        missed.append(abs(contact.xi_x / limit - 1.0))
    # To first order in mu; around the reversal of slip, p_n and the slip change by about 1/n from
    # one element to the next.
    assert missed[1] < 0.4 * missed[0]
    assert missed[2] < 0.4 * missed[1] + 0.5 / n
    assert missed[3] < 0.1 * missed[2] + 0.5 / n


@pytest.mark.slow
@pytest.mark.parametrize("share", [1e-9, 0.3, 0.99])
def test_force_given_between_unlike_cylinders_with_little_friction(share):
    force = share * 1e-3 * 27.5
    contact = freely(1e-3, 64, **{"load.force_x": force})
    assert contact.converged, contact.message
    assert contact.Qx == pytest.approx(force, abs=1e-5 * 1e-3 * 27.5)


@pytest.mark.parametrize(
    ("mu", "known", "tolerance"), [(0.05, 4.29e-4, 5e-3), (10.0, 3.59e-4, 0.03)]
)
def test_free_rolling_of_unlike_cylinders(mu, known, tolerance):
    """Against CONTACT; more friction, less creepage.

    CONTACT is of first order; if hardly anything slips, its error is some per cent.
    """
    contact = freely(mu, 256)
    scale = contact.scene.hertz.a / 0.1
    assert contact.converged
    assert abs(contact.Qx) < 1e-6 * contact.P
    assert contact.xi_x == pytest.approx(-scale * known, rel=tolerance)


def test_swapping_the_bodies_mirrors_the_solution():
    one = freely(0.05, 64)
    two = freely(0.05, 64, body={"A": STEEL, "B": ALUMINIUM})
    assert two.xi_x == pytest.approx(-one.xi_x, rel=1e-6)
    np.testing.assert_allclose(two.traction, -one.traction, atol=1e-6 * one.p_max)


def test_long_ellipses_tend_to_the_line():
    """Middle of a contact 10 and 147 times as wide as long, with equal half widths in x."""
    line = Scene.builtin("cylinders")
    n, a = 41, line.hertz.a
    truth = equilibrium(Model(across_contact(line, n)))
    pressures, tractions, ratios = [], [], []
    for radius in (1e3, 1e5):
        scene = line.replace(**{"body.A.radius_y": radius, "subsurface": None})
        loaded = lambda P, scene=scene: scene.replace(**{"load.normal": P})  # noqa: E731
        load = brentq(lambda P, f=loaded: f(P).hertz.a - a, 1.0, 1e7)
        scene = loaded(load)
        grid = Grid((a * (n + 4) / n, 1.05 * scene.hertz.b), (n + 4, 61))
        contact = equilibrium(Model(scene, grid=grid))
        p_n, p_x = contact.pressure[:, 30], contact.traction[0, :, 30]
        ratios.append(abs(p_x.sum() / p_n.sum() - truth.Qx / truth.P))
        pressures.append(np.abs(p_n / scene.hertz.p0 - truth.pressure[:, 0] / line.hertz.p0).max())
        tractions.append(
            np.abs(p_x / scene.hertz.p0 - truth.traction[0, :, 0] / line.hertz.p0).max()
        )
    assert max(pressures) < 1e-3  # elements as wide as the ellipse is long by 30 know it no better
    assert tractions[1] < 0.05 * tractions[0] < 0.05 * 0.02
    assert ratios[1] < 0.05 * ratios[0] < 0.05 * 0.002


def test_units_do_not_matter():
    mm = steady_line(32)
    metre = steady_line(
        32,
        *(f"body.{b}.radius_x=0.05" for b in "AB"),
        *(f"body.{b}.young=208e9" for b in "AB"),
        "load.normal=5e5",
    )
    # Rounding decides whether a tolerance is just met: up to two applications more on this mesh,
    # and one on the coarser mesh, which counts half.
    assert metre.cost.applications == pytest.approx(mm.cost.applications, abs=2.5)
    np.testing.assert_allclose(metre.traction, 1e6 * mm.traction, rtol=1e-7, atol=1e-3)


def test_cost_does_not_grow_with_the_mesh():
    costs = [steady_line(n).cost.applications for n in (128, 1024)]
    assert costs[1] < 2 * costs[0] < 2 * 50


def test_chosen_mesh():
    scene = Scene.builtin("cylinders")
    grid = Model(scene).grid
    assert grid.elements[0] % 2 == 1
    assert grid.elements[1] == 1
    assert grid.dy == 1.0  # mm: what is summed is per length
    assert enlarge(grid).elements[1] == 1
    assert enlarge(grid).half_length[0] > 1.2 * grid.half_length[0]


def test_off_the_grid_is_said():
    scene = Scene.builtin("cylinders")
    worn = np.zeros((21, 1))
    worn[10] = 0.05
    half_length = 1.001 * scene.hertz.a
    model = Model(scene.replace(**{"grid.half_length": half_length, "grid.elements": 21}))
    contact = equilibrium(model, worn)
    assert not contact.converged
    assert f"{half_length:g} mm" in contact.message


def test_a_gap_that_does_not_end_the_contact_is_said():
    scene = Scene.builtin("cylinders").replace(
        gap={"x": [-1, 1], "y": [-1, 1], "separation": np.zeros((2, 2))},
        **{"grid.half_length": [0.9, 0.9], "grid.elements": [21, 21]},
    )
    contact = equilibrium(Model(scene, (scene.gap.x, scene.gap.y, scene.gap.separation)))
    assert not contact.converged
    assert "rises towards its sides" in contact.message


@pytest.mark.filterwarnings("ignore::tractive_sam.schema.SceneWarning")
@pytest.mark.parametrize(
    "settings",
    [
        ("load.normal=1.9806281843733092e-25",),
        ("load.normal=1e-18",),
        ("body.B.radius_x=0.016000550541449336",),
        ("body.B.radius_x=0.004753220284576842",),
    ],
)
def test_free_rolling_on_a_single_element(settings):
    """Unlike cylinders on elements far wider than their contact: the squares of their tractions are
    zero, and a pressure without load had a small residual. A solution bears its load.
    """
    mesh = ("grid.half_length=0.4289878114670304", "grid.elements=33")
    contact = steady("cylinders-dissimilar", *mesh, *settings)
    assert contact.status == "not resolved", contact.message
    assert contact.residual <= contact.scene.solver.tolerance
    # The pressure of one element is the load, to the tolerance of the solver; the tractions are
    # rounding compared with it.
    assert pytest.approx(contact.scene.load.normal, rel=1e-8, abs=0.0) == contact.P
    assert abs(contact.Qx) <= 1e-12 * contact.P
