"""Wear, revolution by revolution."""

from itertools import pairwise

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model, solve_on_fitted_mesh
from tractive_sam.rolling import steps
from tractive_sam.run import pipeline, recording
from tractive_sam.scene import Scene

COARSE = (
    "grid.half_length=[0.35, 0.7]",
    "grid.elements=[21, 31]",
    "wear.revolutions=4",
    'wear.stepping="every-revolution"',
)


def rolled(*settings):
    scene = Scene.builtin("twin-discs").with_set([*COARSE, *settings])
    return list(steps(Model(scene)))


@pytest.fixture(scope="module")
def roll():
    return rolled("friction.angle=45")


def test_begins_with_the_new_bodies(roll):
    assert [p.revolution for p in roll] == [0, 1, 2, 3, 4]
    assert not roll[0].contact.wear.any()


def test_every_revolution_is_solved(roll):
    for passage in roll:
        assert passage.contact.converged, passage.contact.message
        assert passage.contact.residual <= passage.contact.scene.solver.tolerance
        assert pytest.approx(300.0, rel=1e-9) == passage.contact.P


def test_material_enters_with_the_depth_it_left_with(roll):
    for before, now in pairwise(roll):
        np.testing.assert_array_equal(now.contact.wear[-1], before.leaving)


def test_wear_grows_towards_the_trailing_edge_and_with_every_revolution(roll):
    for before, now in pairwise(roll):
        assert (np.diff(now.contact.wear, axis=0) <= 0).all()
        assert (now.leaving >= before.leaving).all()
        assert now.contact.wear.max() > before.contact.wear.max()


def test_worn_volume_follows_the_energy_law(roll):
    """With i1/mu1 = i2/mu2, d/dN of the worn cross-section = (i1/mu1) |Q . xi| at any angle."""
    for before, now in pairwise(roll):
        c = now.contact
        work = -(c.Qx * c.xi_x + c.Qy * c.xi_y + c.Mz * c.spin)
        worn = (now.leaving - before.leaving).sum() * c.grid.dy
        # Elements with negative work do not wear: none here.
        assert worn == pytest.approx(2e-6 / 0.6 * work, rel=1e-9)


def test_upwind_slip_wears_too_little():
    last = rolled('solver.slip="upwind"')
    c = last[-1].contact
    worn = (last[-1].leaving - last[-2].leaving).sum() * c.grid.dy
    work = -(c.Qx * c.xi_x + c.Qy * c.xi_y)
    assert 0.80 < worn / (2e-6 / 0.6 * work) < 0.97


@pytest.mark.slow
@pytest.mark.parametrize("slip", ["upwind", "auto"])
def test_the_paper_scheme_agrees_with_the_corrected_one(slip):
    """Uzawa updates the wear within its iteration; Newton's contact is corrected around it."""
    newton, uzawa = (
        rolled(f'solver.slip="{slip}"', f'solver.method="{m}"', "wear.revolutions=2")
        for m in ("newton", "uzawa")
    )
    for a, b in zip(newton, uzawa, strict=True):
        assert b.contact.converged, b.contact.message
        np.testing.assert_allclose(b.contact.wear, a.contact.wear, atol=1e-6 * a.contact.wear.max())
        np.testing.assert_allclose(b.contact.pressure, a.contact.pressure, atol=1e-3)


def test_continues_from_any_passage(roll):
    model = Model(roll[0].contact.scene)
    again = list(steps(model, roll[2]))
    assert [p.revolution for p in again] == [3, 4]
    np.testing.assert_allclose(again[-1].contact.wear, roll[-1].contact.wear, rtol=1e-12)


def test_symmetric_discs_stay_symmetric():
    last = rolled("friction.angle=0")[-1].contact
    np.testing.assert_allclose(last.pressure, last.pressure[:, ::-1], atol=1e-6 * last.p_max)
    assert last.Qy == pytest.approx(0.0, abs=1e-5)


def test_hits_the_edge_and_stops():
    narrow = rolled("grid.half_length=[0.35, 0.455]", "wear.intensity=2e-4", "wear.revolutions=200")
    last = narrow[-1]
    assert last.revolution < 200
    assert "grid.half_length" in last.contact.message
    assert all(p.contact.converged for p in narrow[:-1])


def test_wear_too_deep_for_a_pass_is_said():
    last = rolled("wear.intensity=1e-3", "grid.half_length=[0.5, 1.4]")[-1]
    assert not last.contact.converged
    assert "wear.intensity" in last.contact.message


def test_the_time_of_the_new_bodies_is_counted(monkeypatch):
    clock = [0.0]

    def solved(model):
        clock[0] += 100.0
        return solve_on_fitted_mesh(model)

    monkeypatch.setattr("tractive_sam.rolling.revolutions.solve_on_fitted_mesh", solved)
    for module in (pipeline, recording):
        monkeypatch.setattr(module, "perf_counter", lambda: clock[0])
    history = ts.roll(ts.Scene.builtin("spheres").with_set(["grid.elements=[21, 21]"]))
    assert history.totals["wall_seconds"] == 100.0
