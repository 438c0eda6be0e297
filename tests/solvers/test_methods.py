"""All methods find one contact, and report its true residual and cost."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import size, steady
from tractive_sam.contact import Model
from tractive_sam.contact.solution import message
from tractive_sam.results.state import Status
from tractive_sam.solvers import Uzawa
from tractive_sam.solvers.nested import shares

METHODS = ("uzawa", "anderson", "newton", "auto")


@pytest.fixture(scope="module", params=["spheres", "spheres-orthotropic"])
def contacts(request):
    return {m: steady(request.param, f'solver.method="{m}"', elements=21) for m in METHODS}


def test_all_converge(contacts):
    for contact in contacts.values():
        assert contact.converged, contact.message
        assert contact.residual <= 1e-8


def test_all_agree(contacts):
    reference = contacts["newton"]
    for contact in contacts.values():
        # The residual requested is 1e-8; the slip operator amplifies it by its condition number.
        assert size(contact.traction - reference.traction) < 1e-6 * size(reference.traction)
        assert size(contact.pressure - reference.pressure) < 1e-6 * size(reference.pressure)


def test_newton_is_the_cheapest(contacts):
    cost = {m: c.cost.applications for m, c in contacts.items()}
    assert cost["newton"] < 0.5 * cost["anderson"] < 0.5 * cost["uzawa"]


@pytest.mark.slow
def test_a_dissimilar_pair(dissimilar):
    reference = dissimilar["newton"]
    for contact in dissimilar.values():
        assert contact.converged, contact.message
        assert size(contact.traction - reference.traction) < 1e-6 * size(reference.traction)
        assert size(contact.pressure - reference.pressure) < 1e-6 * size(reference.pressure)
        assert pytest.approx(100.0, rel=1e-7) == contact.P


@pytest.fixture(scope="module")
def dissimilar():
    mesh = ("grid.half_length=[0.46, 0.46]", "grid.elements=[15, 15]")
    return {
        m: steady("spheres-dissimilar", *mesh, f'solver.method="{m}"')
        for m in ("uzawa", "anderson", "newton")
    }


@pytest.mark.parametrize("nearby", [300.0, 100.0])
def test_a_contact_nearby_changes_nothing(nearby):
    """Nor does one so much smaller that the contact reaches beyond the rectangle around it."""
    scene = ts.Scene.builtin("twin-discs").with_set(["grid.elements=[31, 91]"])
    start = ts.solve(scene.replace(**{"load.normal": nearby}))
    reference, found = ts.solve(scene), ts.solve(scene, start=start)
    # The tolerance, 1e-6, times the condition number of the normal operator.
    assert size(found.pressure - reference.pressure) < 1e-4 * size(reference.pressure)
    assert found.area == pytest.approx(reference.area, rel=1e-4)
    if nearby == scene.load.normal:
        assert found.cost.applications < 0.1 * reference.cost.applications


def test_shares_of_the_bound_continue_next_to_the_contact():
    bound = np.zeros((5, 6))
    bound[1:3, 2:4] = [[1.0, 2.0], [3.0, 4.0]]
    found = shares(np.multiply.outer((0.6, -0.8), bound), bound)
    beside = np.zeros(bound.shape)
    beside[:4, 1:5] = 1.0
    np.testing.assert_allclose(found, np.multiply.outer((0.6, -0.8), beside), rtol=1e-14)


def test_newton_cost_at_the_paper_mesh():
    """Slip and normal operator together; the slip operator alone is counted in benchmarks/."""
    contact = steady("spheres")
    assert contact.cost.applications <= 120


def test_cost_hardly_grows_with_the_mesh():
    coarse, fine = (steady("spheres", elements=n).cost.applications for n in (31, 181))
    assert fine / coarse < (181 / 31) ** 0.4


def test_out_of_iterations_is_said():
    contact = steady("spheres", elements=21, solver=Uzawa(iterations=5))
    assert contact.status is Status.OUT_OF_ITERATIONS
    assert not contact.converged
    model = Model(contact.scene.with_set(['solver.method="uzawa"']))
    problem = model.problem(model.undeformed_gap / model.units.gap)
    outcome = Uzawa(iterations=5).solve(problem, 1e-8)
    assert 'solver.method = "auto"' in message(outcome.status, outcome, model)


@pytest.mark.parametrize("angle", [0, 30, 45, 90])
@pytest.mark.parametrize("weak", [0.1, 0.05])
def test_friction_much_stronger_along_one_axis(angle, weak):
    """Newton's unit of slip follows the stronger axis: the weaker would make it too bold."""
    settings = (f"friction.mu=[0.4, {weak}]", f"friction.angle={angle}", 'solver.method="newton"')
    contact = steady("spheres-orthotropic", *settings, elements=45)
    assert contact.converged, contact.message


@pytest.mark.parametrize("angle", [0, 30])
@pytest.mark.parametrize(
    ("longitudinal", "lateral", "spin"),
    [(-5e-4, 3e-4, 1e-3), (-2e-4, 1e-4, 5e-4), (1e-5, 0.0, 1e-3)],
)
def test_friction_a_hundred_times_stronger_along_one_axis(angle, longitudinal, lateral, spin):
    """The steepest ratio allowed, at creepages with which some of the contact sticks.

    With the rows of what slips along its tangent, linear systems took all of their 120 iterations;
    and elements at their bound were pushed out along the weak axis for ever: 1,167 to 4,354
    applications, and one contact failed.
    """
    settings = {
        "friction.mu": [0.4, 0.004],
        "friction.angle": angle,
        "creepage.longitudinal": longitudinal,
        "creepage.lateral": lateral,
        "creepage.spin": spin,
        "solver.method": "newton",
    }
    contact = steady("spheres", *(f"{k}={v!r}" for k, v in settings.items()), elements=31)
    assert contact.converged, contact.message
    # 91 to 480 applications now; another order of sums may take another way.
    assert contact.cost.applications < 800
    # The way led over tractions beyond the bound; the last ones are within it. Rounding of the
    # scaled ones counts mu1/mu2 times.
    assert (contact.utilisation <= contact.pressure + 1e-13 * contact.p_max).all()
