"""Derivatives of a solved contact against differences, linear theory, full slip, and scaling."""

import pickle
import sys
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import LinearSolver, Model, equilibrium, jacobian_of
from tractive_sam.reference import Carter, creep_coefficients

xarray = pytest.importorskip("xarray", reason="xarray is of the extra study")

BALL = {"shear": 1.0, "poisson": 0.28, "radius_x": 337.5, "radius_y": 337.5}
STIFF = {"body.B.shear": 4.0}
TURNED = {"friction.mu": (0.5, 0.25), "friction.angle": 30.0}
CREEPING = {
    "creepage.longitudinal": -0.002,
    "creepage.lateral": 0.001,
    "creepage.spin": 7e-4,
}
SPINNING = {"creepage.longitudinal": None, "creepage.spin": 7e-4}
PUSHED = {
    **SPINNING,
    "load.force_x": 0.1,
    "creepage.lateral": None,
    "load.force_y": -0.03,
}
LINE = {
    "body.A": {"shear": 8e4, "poisson": 0.28, "radius_x": 50.0, "radius_y": np.inf},
    "body.B": {"shear": 8e4, "poisson": 0.28, "radius_x": 50.0, "radius_y": np.inf},
    "load.normal": 500.0,
    "creepage.longitudinal": -1e-3,
    "grid": {"half_length": 0.4, "elements": 61},
}
UPWIND = {"solver.slip": "upwind"}
KEYS = {
    "xi_x": "creepage.longitudinal",
    "xi_y": "creepage.lateral",
    "spin": "creepage.spin",
    "P": "load.normal",
    "approach": "load.approach",
    "Qx": "load.force_x",
    "Qy": "load.force_y",
}
TYPICAL = {"xi_x": 3e-3, "xi_y": 3e-3, "spin": 1e-3}
"""Of parameters that are zero."""


def ball(changes=(), elements=21, tolerance=1e-11):
    """Two spheres, with changes by key; None takes a key away."""
    tables = {
        "body": {"A": dict(BALL), "B": dict(BALL)},
        "load": {"normal": 0.4705},
        "creepage": {"longitudinal": -0.0031},
        "friction": {"mu": 0.4013},
        "grid": {"half_length": (4.08, 4.08), "elements": (elements, elements)},
        "solver": {"tolerance": tolerance},
    }
    for key, value in deepcopy(dict(changes)).items():
        *path, name = key.split(".")
        table = tables
        for step in path:
            table = table[step]
        if value is None:
            table.pop(name, None)
        else:
            table[name] = value
    return ts.Scene(**tables)


def value(scene, parameter):
    if parameter in ("mu1", "mu2"):
        return scene.friction.mu[int(parameter[2]) - 1]
    table, key = KEYS[parameter].split(".")
    return getattr(getattr(scene, table), key)


def moved(scene, parameter, step):
    changed = value(scene, parameter) + step
    if parameter in ("mu1", "mu2"):
        friction, axis = scene.friction, int(parameter[2]) - 1
        keys = ("mu",) if friction.static is None else ("static", "kinetic")
        pairs = {f"friction.{k}": list(p) for k in keys if (p := getattr(friction, k)) is not None}
        for pair in pairs.values():  # in the ratio that they have
            pair[axis] *= changed / friction.mu[axis]
        return scene.replace(**pairs)
    return scene.replace(**{KEYS[parameter]: changed})


def compared(scene, laws=None):
    """The Jacobian and central differences, both per typical parameter over each row's largest."""
    contact = ts.solve(scene, jacobian=True, laws=laws)
    jacobian = contact.jacobian
    rows, columns = jacobian.result.values, jacobian.parameter.values
    typical = np.array([abs(value(scene, q)) or TYPICAL[q] for q in columns])
    differences = []
    for q, size in zip(columns, typical, strict=True):
        results = []
        for h in (1e-5 * size, -1e-5 * size):
            model = Model(moved(scene, q, h), grid=contact.grid, laws=laws)
            near = equilibrium(model, start=contact)
            assert near.converged
            # What is compared is smooth: no element changes its state.
            assert np.array_equal(near.sliding, contact.sliding)
            assert np.array_equal(near.touching, contact.touching)
            results.append(np.array([getattr(near, r) for r in rows]))
        differences.append((results[0] - results[1]) / 2e-5)
    differences = np.stack(differences, axis=1)
    size = np.abs(differences).max(axis=1, keepdims=True)
    size[size == 0.0] = 1.0
    return jacobian.values * typical / size, differences / size, columns


CASES = {
    "longitudinal": {},
    "lateral": {"creepage.longitudinal": 0.0, "creepage.lateral": -0.002},
    "spin": {"creepage.longitudinal": 0.0, "creepage.spin": 1e-3},
    "spin, upwind": {"creepage.longitudinal": 0.0, "creepage.spin": 1e-3, **UPWIND},
    "full slip": {key: 5.0 * size for key, size in CREEPING.items()},
    "orthotropic": {**CREEPING, **TURNED},
    "orthotropic, upwind": {**CREEPING, **TURNED, **UPWIND},
    "dissimilar": {**CREEPING, **TURNED, **STIFF},
    "dissimilar, upwind": {**CREEPING, **TURNED, **STIFF, **UPWIND},
    "force": {**SPINNING, "load.force_x": 0.1},
    "forces under an approach": {**PUSHED, **TURNED, "load.normal": None, "load.approach": 0.07},
    "dissimilar, forces": {**PUSHED, **TURNED, **STIFF},
    "line": {**LINE, "creepage.lateral": 3e-4},
    "dissimilar line": {**LINE, "creepage.lateral": 3e-4, "body.B.shear": 3e5},
}


STEEL = {"shear": 82e3, "poisson": 0.28, "radius_x": 920.0, "radius_y": 920.0}
FAST = {
    "body": {"A": STEEL, "B": STEEL},
    "load.normal": 70e3,
    "creepage": {"longitudinal": -0.002, "lateral": 0.001, "spin": 1e-4, "speed": 2e4},
    "grid": {"half_length": (6.95, 6.95), "elements": (21, 21)},
}
FORCED = {
    **FAST,
    "creepage": {"lateral": 0.001, "spin": 1e-4, "speed": 2e4},
    "load.force_x": 12e3,
}
LESS = {"static": 0.3, "kinetic": 0.18, "half_speed": 100.0}
EXPONENTIAL, RATIONAL = ({"law": law, **LESS} for law in ("exponential", "rational"))
STRONG = {
    "mu": (0.3, 0.25),
    "strength": 150.0,
}  # over the larger mu: no derivative if equal
HEAT_FIELDS = {"mu": 0.3, "temperature": [[0.0, 1.0], [400.0, 0.5]]}
GLASS = {"conductivity": 1.0, "density": 2500.0, "heat_capacity": 800.0}
ALL = {**RATIONAL, "memory": 2e-3, "layer": 1e-5, "strength": 150.0, "angle": 30.0}
ALL |= {"static": (0.3, 0.2), "kinetic": (0.18, 0.12)}
EVERY = {**ALL, "temperature": HEAT_FIELDS["temperature"]}
IRON = {"conductivity": 50.0, "density": 7850.0, "heat_capacity": 450.0}
HOT = {
    **FAST,
    "heat": {"bulk": {"A": 20.0, "B": 60.0}},
    "body": {"A": {**STEEL, "thermal": IRON}, "B": {**STEEL, "thermal": GLASS}},
}
CASES |= {
    "exponential": {**FAST, "friction": EXPONENTIAL},
    "rational, upwind": {**FAST, "friction": RATIONAL, **UPWIND},
    "Polach": {**FAST, "friction": {"law": "polach", "static": 0.3, "A": 0.4, "B": 2.0}},
    "memory": {**FAST, "friction": {**EXPONENTIAL, "memory": 1e-3}},
    "strength": {**FAST, "friction": STRONG},
    "strength under a force": {**FORCED, "friction": STRONG},
    "layer": {**FAST, "friction": {"mu": 0.3, "layer": 1e-5}},
    "temperature": {**FAST, "heat": {"bulk": 20.0}, "friction": HEAT_FIELDS},
    "memory of the temperature": {
        **{**FAST, "heat": {"bulk": 20.0}},
        "friction": {**HEAT_FIELDS, "memory": 1e-3},
    },
    "temperature under a force": {**FORCED, "heat": {"bulk": 20.0}, "friction": HEAT_FIELDS},
    "all": {**FAST, "friction": ALL},
    "all, dissimilar, upwind": {**FAST, "friction": ALL, "body.B.shear": 2e5, **UPWIND},
    "all under a force": {**FORCED, "friction": ALL},
    "all and temperature": {**HOT, "friction": EVERY},
    "all and temperature, dissimilar": {**HOT, "friction": EVERY, "body.B.shear": 2e5},
}


@pytest.mark.slow
@pytest.mark.parametrize("changes", CASES.values(), ids=CASES)
def test_central_differences(changes):
    """To 3e-6, what tolerance and third derivatives leave."""
    found, expected, _ = compared(ball(changes))
    np.testing.assert_allclose(found, expected, atol=3e-6)


@dataclass(frozen=True)
class Capped(ts.Coulomb):
    """A bound that does not follow the pressure everywhere."""

    strength: float = 0.005

    def bound(self, pressure, x, y):
        most = self.strength / max(self.mu)
        return ts.Bound(np.minimum(pressure, most), np.where(pressure < most, 1.0, 0.0))


def test_friction_user_defined():
    scene = ball(CREEPING)
    laws = ts.Laws.of(scene).replace(friction=Capped((0.4013, 0.4013)))
    found, expected, columns = compared(scene, laws)
    assert list(columns) == ["xi_x", "xi_y", "spin", "P"]
    np.testing.assert_allclose(found, expected, atol=3e-6)  # as above


@pytest.mark.slow
def test_linear_theory_at_zero_creepage():
    """Kalker's coefficients to 0.4 %, up to 0.35 % due to his three digits."""
    poisson = {"body.A.poisson": 0.25, "body.B.poisson": 0.25}
    scene = ball({"creepage.longitudinal": 0.0, **poisson}, 141, 1e-8)
    contact = ts.solve(scene, jacobian=True)
    assert not contact.traction.any()
    c, G = scene.hertz.mean_semi_axis, scene.material.shear
    of = contact.jacobian / -G
    C11, C22, C23, C33 = creep_coefficients(1.0, 0.25)
    assert of.loc["Qx", "xi_x"] / c**2 == pytest.approx(C11, rel=4e-3)
    assert of.loc["Qy", "xi_y"] / c**2 == pytest.approx(C22, rel=4e-3)
    assert of.loc["Qy", "spin"] / c**3 == pytest.approx(C23, rel=4e-3)
    assert of.loc["Mz", "xi_y"] / c**3 == pytest.approx(-C23, rel=4e-3)
    assert of.loc["Mz", "spin"] / c**4 == pytest.approx(C33, rel=4e-3)
    for row, column in (("Qx", "xi_y"), ("Qx", "spin"), ("Qy", "xi_x"), ("Mz", "xi_x")):
        assert abs(of.loc[row, column].item()) < 1e-5  # symmetry


@pytest.mark.parametrize("changes", [{}, TURNED])
def test_reciprocity_at_zero_creepage(changes):
    """C23 = -C32: elastic slip is antisymmetric, of the upwind scheme on any mesh."""
    contact = ts.solve(ball({"creepage.longitudinal": 0.0, **changes, **UPWIND}), jacobian=True)
    J = contact.jacobian
    # The tolerance of the linear systems.
    assert J.loc["Qy", "spin"].item() == pytest.approx(-J.loc["Mz", "xi_y"].item(), rel=1e-5)


def test_full_slip():
    """Q = -P F^T d with d = F xi/|F xi|, far beyond the creepage at which stick ends."""
    xi = np.array([-3.0, 1.0])
    far = {"creepage.longitudinal": xi[0], "creepage.lateral": xi[1]}
    contact = ts.solve(ball({**far, **TURNED}), jacobian=True)
    assert contact.stick_fraction == 0.0
    F, J = contact.frame.matrix, contact.jacobian
    d = F @ xi / np.linalg.norm(F @ xi)
    turned = -contact.P * F.T @ (np.eye(2) - np.outer(d, d)) @ F / np.linalg.norm(F @ xi)
    # The elastic slip is a thousandth of the rigid one.
    forces, size = J.loc[["Qx", "Qy"]], np.abs(turned).max()
    np.testing.assert_allclose(forces.loc[:, ["xi_x", "xi_y"]], turned, atol=3e-3 * size)
    share = np.array([contact.Qx, contact.Qy]) / contact.P
    np.testing.assert_allclose(forces.loc[:, "P"], share, rtol=1e-3)


@pytest.mark.parametrize("changes", [CREEPING, CREEPING | TURNED, CREEPING | TURNED | UPWIND])
def test_friction_and_creepages_scale_the_tractions(changes):
    """Euler: Q(k mu, k xi) = k Q(mu, xi), for alike bodies on any mesh."""
    scene = ball(changes)
    contact = ts.solve(scene, jacobian=True)
    J = contact.jacobian.drop_sel(parameter="P")
    parameters = np.array([value(scene, q) for q in J.parameter.values])
    expected = [contact.Qx, contact.Qy, contact.Mz, 0.0]
    # The tolerance of the linear systems, on sums some ten times larger than the forces.
    np.testing.assert_allclose(J.values @ parameters, expected, rtol=1e-5)


def test_the_slope_of_carters_curve():
    """Elements at the stick-slip boundary change their state, but the force hardly depends on their
    place."""
    errors = []
    for n in (64, 256):
        scene = ball(LINE, tolerance=1e-9)
        a = scene.hertz.a
        scene = scene.replace(**{"grid.half_length": a * (n + 4) / n, "grid.elements": n + 4})
        slope = ts.solve(scene, jacobian=True).jacobian.loc["Qx", "xi_x"].item()
        xi, h = scene.creepage.longitudinal, 1e-9
        mu, P = scene.friction.mu[0], scene.load.normal
        ahead, behind = (Carter(scene.hertz, mu, xi + s * h).force_ratio for s in (1, -1))
        errors.append(abs(slope / (-mu * P * abs(ahead - behind) / (2 * h)) - 1.0))
    assert errors[1] < 0.5 * errors[0] < 0.01  # of first order, or nearly


def test_nothing_else_has_it(tmp_path):
    scene = ball(tolerance=1e-6)
    assert ts.solve(scene).jacobian is None
    contact = ts.solve(scene, jacobian=True)
    assert contact.jacobian.attrs["operator_applications"] > 0
    assert contact.jacobian.attrs["units"]["Mz"] == "N mm"
    assert contact.jacobian.attrs["units"].startswith("Qx: N; ")
    contact.jacobian.to_netcdf(tmp_path / "jacobian.nc")
    again = xarray.load_dataarray(tmp_path / "jacobian.nc")
    xarray.testing.assert_equal(again, contact.jacobian)
    assert again.attrs["units"] == str(contact.jacobian.attrs["units"])
    assert pickle.loads(pickle.dumps(contact)).jacobian is None


def test_units_of_a_line_contact_are_per_length():
    contact = ts.solve(ball(LINE, tolerance=1e-6), jacobian=True)
    assert contact.jacobian.attrs["units"]["Qx"] == "N/mm"
    assert "spin" not in contact.jacobian.parameter


def test_what_has_none(monkeypatch):
    with pytest.raises(ValueError, match="friction"):
        ts.solve(ball({"friction": None, "creepage": None}), jacobian=True)
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match="study"):
        ts.solve(ball(), jacobian=True)


def test_what_is_not_solved_is_nan():
    model = Model(ball(CREEPING, tolerance=1e-6))
    solver = LinearSolver(krylov=2, rounds=1)
    with pytest.warns(ts.SceneWarning, match="spin"):
        jacobian = jacobian_of(model, equilibrium(model), solver=solver)
    assert np.isnan(jacobian.loc["Qx":"Mz", "spin"]).all()


@pytest.mark.parametrize("changes", [{}, STIFF, UPWIND])
def test_one_system_gives_the_derivative_by_both_coefficients(changes):
    """The derivative along a common change is the sum of both, and takes fewer applications."""
    model = Model(ball(CREEPING | changes, elements=15))
    contact = equilibrium(model)
    both = jacobian_of(model, contact, ["mu"])
    each = jacobian_of(model, contact, ["mu1", "mu2"])
    found = both.loc[:, "mu"].values
    size = np.abs(found).max()
    # each linear system is solved to 1e-7 of its right-hand side
    np.testing.assert_allclose(found, each.values.sum(axis=1), atol=1e-5 * size)
    assert both.attrs["operator_applications"] < each.attrs["operator_applications"]
