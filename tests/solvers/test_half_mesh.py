"""Symmetric problems are solved on half of their mesh, with the solution of the whole mesh."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium
from tractive_sam.solvers import OnHalfMesh

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None)
LATERAL = {"creepage.longitudinal": 0.0, "creepage.lateral": -0.0031}
SPIN = {"creepage.longitudinal": 0.0, "creepage.spin": 1e-3}


def scene(elements=(31, 31), **keys):
    tolerance = {"solver.tolerance": 1e-8, "grid.elements": elements}
    return SPHERES.replace(**tolerance, **keys)


def mirror_of(model):
    return model.problem(model.undeformed_gap / model.units.gap).mirror


def on_whole_mesh(monkeypatch):
    monkeypatch.setattr(OnHalfMesh, "solve", lambda self, *given: self.solver.solve(*given))


@pytest.mark.parametrize("elements", [(31, 31), (26, 32)])
@pytest.mark.parametrize("keys", [{}, LATERAL, SPIN])
def test_solution_on_half_of_a_mesh(elements, keys, monkeypatch):
    model = Model(scene(elements, **keys))
    assert mirror_of(model) is not None
    half = equilibrium(model)
    on_whole_mesh(monkeypatch)
    whole = equilibrium(Model(model.scene))
    assert half.converged
    assert whole.converged
    for name in ("pressure", "traction", "slip", "gap"):
        one, other = getattr(half, name), getattr(whole, name)
        # Both residuals are 1e-8; the conditioning of both problems is below 100.
        assert np.allclose(one, other, rtol=0.0, atol=1e-6 * np.abs(other).max()), name
    assert (half.sticking == whole.sticking).all()
    np.testing.assert_array_equal(half.pressure, half.pressure[:, ::-1])
    # Half of the transforms of tangential problems; those of the normal problem are whole.
    assert half.cost.convolutions < 0.75 * whole.cost.convolutions


@pytest.mark.parametrize(
    "keys",
    [
        {"creepage.lateral": 1e-4},
        {"creepage.spin": 1e-4},
        {"friction.mu": (0.4, 0.2), "friction.angle": 30.0},
        {"body.B.shear": 3.0},
        {"creepage": None, "load.force_x": 0.05},
        {"grid.centre": (0.0, 0.1)},
    ],
)
def test_problems_without_symmetry_have_no_mirror(keys):
    assert mirror_of(Model(scene(**keys))) is None


def test_course_on_half_of_a_mesh(monkeypatch):
    course = {"start": "rest", "distance": [0.0, 1.5], "creepage.longitudinal": [-2e-3, -4e-3]}
    steps = scene((23, 23), creepage=None).replace(transient=course, **{"solver.tolerance": 1e-8})
    half = ts.roll(steps)
    on_whole_mesh(monkeypatch)
    whole = ts.roll(steps)
    # The residual of a step is 1e-8, and steps forget those before them.
    np.testing.assert_allclose(half["Qx"], whole["Qx"], atol=1e-6 * np.abs(whole["Qx"]).max())
    assert half["convolutions"].sum() < 0.75 * whole["convolutions"].sum()
