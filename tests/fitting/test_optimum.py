"""Designs against closed forms: optima, active limits, multipliers, fronts, and files."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli.program import app
from tractive_sam.fitting import case
from tractive_sam.fitting.optimum import Aim, Bound, Search
from tractive_sam.store import ResultsError, write_netcdf


class ClosedForm:
    """Outcomes by a formula, evaluated as a `Response`; no derivative is exact."""

    def __init__(self, formula, keys):
        self.formula, self.keys = formula, keys

    def evaluate(self, points):
        values = np.stack([self.formula(*point) for point in points])
        return values, ["" if np.isfinite(one).all() else "fails" for one in values]

    def exact_slopes(self, point):
        return np.full((len(self.formula(*point)), len(point)), np.nan)


KEYS = ("load.normal", "friction.mu")


def search_of(formula, limits=((0.1, 10.0), (0.1, 10.0)), **table):
    """Return a search of a formula of two keys between limits."""
    free = [{"key": key, "lower": low, "upper": high, "start": (low * high) ** 0.5}
            for key, (low, high) in zip(KEYS, limits, strict=False)]  # fmt: skip
    entries = {"scene": "spheres", "minimise": "p_max", "free": free, "tolerance": 1e-10}
    design = ts.OptimumDesign(design=entries | {"step": 1e-4} | table)
    return Search(design.design, ClosedForm(formula, KEYS))


def test_the_optimum_of_a_closed_form_with_its_multiplier():
    """Least x + y with x y >= 4: both are 2, and 1 % more of the limit costs half a per cent."""
    search = search_of(lambda x, y: np.array([x + y, x * y]))
    aim, bounds = Aim(np.array([1.0, 0.0])), [Bound(np.array([0.0, 1.0]), -1.0, 4.0)]
    best, converged = search.minimise(aim, bounds, np.array([0.3, 0.8]))
    assert converged
    assert search.point(best) == pytest.approx([2.0, 2.0], rel=1e-3)  # differences over 1e-4
    of_limits, of_keys = search.multipliers(aim, bounds, best)
    assert of_limits == pytest.approx([0.5], rel=1e-2)
    assert not of_keys.any()


def test_a_bound_of_a_key_has_the_multiplier_of_its_power():
    search = search_of(lambda x, y: np.array([x**-2 * y]))
    best, _ = search.minimise(Aim(np.ones(1)), [], np.array([0.5, 0.5]))
    assert search.point(best) == pytest.approx([10.0, 0.1])
    _, of_keys = search.multipliers(Aim(np.ones(1)), [], best)
    assert of_keys == pytest.approx([2.0, 1.0], rel=1e-2)


def test_a_point_that_fails_is_avoided():
    search = search_of(lambda x, y: np.array([x + y if x > 0.5 else np.nan]))
    best, _ = search.minimise(Aim(np.ones(1)), [], np.array([0.6, 0.5]))
    x, y = search.point(best)
    assert x > 0.5
    assert x + y < 0.6 * search.point(np.array([0.6, 0.5])).sum()
    assert search.failures


def test_differential_evolution_finds_the_deeper_of_two_valleys():
    search = search_of(lambda x, y: np.array([2.0 + np.sin(3.0 * x) + 0.05 * x + y]))
    start = np.array([0.9, 0.5])
    local, _ = search.minimise(Aim(np.ones(1)), [], start)
    best, _ = search.minimise(Aim(np.ones(1)), [], search.explore(Aim(np.ones(1)), [], 1.0))
    assert search.at(best)[0] < search.at(local)[0] - 0.05
    assert search.point(best)[0] == pytest.approx(1.566, abs=0.01)  # 3 cos 3x = -.05


@pytest.fixture(scope="module")
def scene():
    """Two spheres in full slip on a coarse mesh: Q = mu P, and p0 ~ P^(1/3) R^(-2/3)."""
    spheres = ts.Scene.builtin("spheres").replace(subsurface=None, grid=None)
    return spheres.replace(**{"creepage.longitudinal": -0.05, "grid.elements": (13, 13)})


LOAD = {"key": "load.normal", "lower": 0.2, "upper": 1.0}
RADIUS = {"key": "body.A.radius_x", "lower": 200.0, "upper": 500.0}


def design_of(scene, **table):
    shared = {"scene": scene, "maximise": "Qx", "free": [LOAD], "mesh_check": False}
    return shared | table


@pytest.fixture(scope="module")
def limited(scene, tmp_path_factory):
    """The largest force below a peak pressure, and its file."""
    path = tmp_path_factory.mktemp("design") / "design.nc"
    limits = [{"observe": "p_max", "at_most": 0.02}]
    ts.design(design_of(scene, limit=limits, mesh_check=True, tolerance=1e-7), path)
    return ts.open_design(path), path


def test_the_load_for_a_stated_pressure(limited, scene):
    found, _ = limited
    assert found.status == "done"
    reached = ts.solve(found.scene)
    assert reached.p_max == pytest.approx(0.02, rel=1e-3)  # tolerance of the search
    at_start = ts.solve(scene)
    load = scene.normal_load * (0.02 / at_start.p_max) ** 3
    assert found.values["load.normal"] == pytest.approx(load, rel=0.01)  # mesh of 13 x 13
    # Q ~ P ~ p0^3: 1 % more pressure gives 3 % more force
    assert found.numbers("multiplier") == pytest.approx([3.0], rel=0.05)  # differences on the mesh
    text = " ".join(found.notes)
    assert "p_max at most 0.02 is active" in text
    assert "larger than the error of the mesh" in text


def test_the_least_pressure_is_at_the_bounds(scene):
    found = ts.design(design_of(scene, maximise=[], minimise="p_max", free=[LOAD, RADIUS]))
    assert found.values == {"load.normal": 0.2, "body.A.radius_x": 500.0}
    assert found.numbers("key_multiplier")[0] == pytest.approx(1 / 3, rel=0.03)  # 13 x 13
    assert sum("bound" in note for note in found.notes) == 2
    assert "1 % more of it would change p_max by +0.3" in " ".join(found.notes)


def test_a_target_is_met(scene):
    target = {"observe": "Qx", "value": 0.2}
    found = ts.design(design_of(scene, maximise=[], target=target, tolerance=1e-8))
    # full slip: P = Q / mu
    mu = 0.4013
    assert found.values["load.normal"] == pytest.approx(0.2 / mu, rel=2e-3)


def test_wear_in_full_slip_gives_the_number_of_revolutions(discs):
    """The worn mass is in proportion to k and N."""
    changes = {"creepage.longitudinal": -0.05, "wear.save": (0, 1), "wear.revolutions": 1}
    scene = discs.replace(**changes)
    once = ts.roll(scene)["worn_mass"][-1, 0]
    key = {"key": "wear.coefficient.A", "lower": 1e-5, "upper": 1e-3}
    target = {"observe": "worn_mass A", "value": 2.5 * once}
    table = {"scene": scene, "target": target, "free": [key], "mesh_check": False}
    found = ts.design(table | {"tolerance": 1e-8})
    k = scene.wear.coefficient.A
    assert found.values["wear.coefficient.A"] == pytest.approx(2.5 * k, rel=2e-3)
    more = {"wear.save": (0, 1, 5, 20), "wear.revolutions": 20}
    key = {"key": "wear.revolutions", "lower": 5, "upper": 200}
    found = ts.design(table | {"scene": discs.replace(**changes | more), "free": [key],
                               "target": target | {"value": 50.0 * once}})  # fmt: skip
    assert found.values["wear.revolutions"] == pytest.approx(50.0, rel=0.01)  # whole revolutions


def test_limits_that_cannot_be_met_are_named(scene):
    limits = [{"observe": "p_max", "at_most": 0.01}]
    found = ts.design(design_of(scene, limit=limits))
    assert found.status == "limits not met"
    assert any("p_max at most 0.01 is not met" in note for note in found.notes)


def test_the_front_of_two_aims(scene):
    """Most force and least pressure: p0 ~ Q^(1/3) along the front."""
    found = ts.design(design_of(scene, minimise="p_max", front=4))
    pressure, force = found.numbers("front_outcome").T
    assert len(force) == 4
    assert (np.diff(pressure) > 0.0).all()
    slope = np.polyfit(np.log(force), np.log(pressure), 1)[0]
    assert slope == pytest.approx(1 / 3, abs=0.01)  # mesh of 13 x 13
    assert [one.name for one in found.drawings()] == ["search", "front"]


def test_exact_derivatives_need_no_further_run(scene, monkeypatch):
    solved, compute = [], case.compute
    monkeypatch.setattr(case, "compute", lambda *a: solved.append(1) or compute(*a))
    keys = [{"key": "creepage.longitudinal", "lower": -4e-3, "upper": -1e-3, "start": -2e-3},
            {"key": "friction.mu", "lower": 0.2, "upper": 0.5}]  # fmt: skip
    found = ts.design(design_of(scene, free=keys))
    assert found.values == {"creepage.longitudinal": -4e-3, "friction.mu": 0.5}
    assert len(solved) <= 2 * len(found.numbers("search"))  # the point, and its Jacobian


def test_a_second_run_computes_nothing(limited, scene, monkeypatch):
    found, path = limited
    monkeypatch.setattr("tractive_sam.fitting.case.compute", None)
    limits = [{"observe": "p_max", "at_most": 0.02}]
    table = design_of(scene, limit=limits, mesh_check=True, tolerance=1e-7)
    assert ts.design(table, path).values == found.values
    with pytest.raises(ResultsError, match=r"friction.*--overwrite"):
        ts.design(table | {"scene": scene.replace(**{"friction.mu": 0.3})}, path)


BAD = {
    "no free key": ({"free": []}, "design.free"),
    "an unknown key": ({"free": [LOAD | {"key": "load.nrmal"}]}, "design.free[0].key"),
    "a key with a text": ({"free": [LOAD | {"key": "solver.method"}]}, "design.free[0].key"),
    "a key twice": ({"free": [LOAD, LOAD]}, "design.free[0].key"),
    "no bounds": ({"free": [{"key": "load.normal"}]}, "design.free[0].lower"),
    "bounds the wrong way round": ({"free": [LOAD | {"upper": 0.1}]}, "design.free[0].upper"),
    "a start outside": ({"free": [LOAD | {"start": 2.0}]}, "design.free[0].start"),
    "a scene outside": ({"free": [LOAD | {"lower": 0.6}]}, "design.free[0].start"),
    "no aim": ({"minimise": []}, "design.minimise"),
    "three aims": ({"minimise": ["Qx", "Qy", "p_max"]}, "design.minimise"),
    "a target and an aim": ({"target": {"observe": "Qx", "value": 1.0}}, "design.minimise"),
    "an unknown aim": ({"minimise": "Qz"}, "design.minimise"),
    "an aim of no body": ({"minimise": "worn_mass"}, "design.minimise"),
    "a target without a value": ({"minimise": [], "target": {"observe": "Qx"}}, "design.target"),
    "a limit of nothing": ({"limit": [{"at_most": 1.0}]}, "design.limit[0].observe"),
    "a limit without a bound": ({"limit": [{"observe": "Qx"}]}, "design.limit[0].at_most"),
    "a limit with both": (
        {"limit": [{"observe": "Qx", "at_most": 1.0, "at_least": 0.0}]}, "design.limit[0].at_most"),
    "an unknown limit": ({"limit": [{"observe": "Qz", "at_most": 1.0}]}, "design.limit[0].observe"),
    "an unknown search": ({"search": "genetic"}, "design.search"),
    "no start": ({"starts": 0}, "design.starts"),
    "a step of zero": ({"step": 0.0}, "design.step"),
    "a front of two points": ({"front": 2}, "design.front"),
    "no scene": ({"scene": "sphere"}, "design.scene"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_fault_of_the_file_is_reported_by_its_key(name):
    table, key = BAD[name]
    with pytest.raises(ts.DesignError) as caught:
        ts.OptimumDesign(design={"scene": "spheres", "minimise": "p_max", "free": [LOAD]} | table)
    keys = [fault.key for fault in caught.value.faults]
    assert any(one.startswith(key) for one in keys), keys
    assert all(fault.allowed for fault in caught.value.faults)


@pytest.mark.parametrize(
    "change", [{"at": 3.0}, {"maximise": "worn_mass A"}, {"limit": [
        {"observe": "utilisation A", "at_most": 1.0}]}]
)  # fmt: skip
def test_outcomes_that_the_scene_lacks_are_refused_before_a_run(scene, change, monkeypatch):
    monkeypatch.setattr("tractive_sam.fitting.case.compute", None)
    with pytest.raises(ts.DesignError, match="design"):
        ts.design(design_of(scene, **change))


@pytest.mark.parametrize("name", ["value", "search", "front", "multiplier", "notes"])
def test_a_file_without_its_numbers_is_damaged(limited, name, tmp_path):
    found, _ = limited
    write_netcdf(tmp_path / "design.nc", found.dataset.drop_vars(name))
    with pytest.raises(ResultsError, match=name):
        ts.open_design(tmp_path / "design.nc")


def test_commands_compute_explain_show_draw_and_report(scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    (tmp_path / "scene.toml").write_text(scene.to_toml())
    (tmp_path / "d.toml").write_text(
        '[design]\nscene = "scene.toml"\nminimise = "p_max"\nmesh_check = false\n'
        '[[design.free]]\nkey = "load.normal"\nlower = 0.3\nupper = 1.0\n'
        '[[design.limit]]\nobserve = "Qx"\nat_least = 0.15\n'
    )
    explained = runner.invoke(app, ["explain", "d.toml"]).stdout
    assert "Qx at least 0.15" in explained
    done = runner.invoke(app, ["design", "d.toml", "-o", "d.nc", "--scene", "best.toml"])
    assert done.exit_code == 0, done.output
    assert "is active" in done.output
    best = ts.Scene.from_toml("best.toml").load.normal
    assert best == pytest.approx(0.15 / 0.4013, rel=5e-3)  # full slip, to 1e-4 of the aim
    shown = json.loads(runner.invoke(app, ["show", "d.nc", "--json"]).stdout)
    assert shown["value"] == pytest.approx([best], rel=1e-5)  # six digits in the scene
    assert runner.invoke(app, ["plot", "d.nc", "-o", "figures"]).exit_code == 0
    assert [one.name for one in (tmp_path / "figures").iterdir()] == ["search.png"]
    assert runner.invoke(app, ["report", "d.nc", "-o", "page.html"]).exit_code == 0
    assert "Qx at least 0.15" in (tmp_path / "page.html").read_text("utf-8")
    assert runner.invoke(app, ["design", "d.toml", "-o", "d.h5"]).exit_code == 2


def test_the_coefficient_of_a_free_profile_is_that_of_lundberg():
    """The most even pressure along a roller: A = Q / (pi L E*) of A ln 1/(1 - (2 y / L)^2).

    The aim is the pressure above which 5 % of the load is carried, as bodies that are half-spaces
    beyond the ends of the roller have a peak there.
    """
    load, width, modulus = 8e3, 12.0, 208e3 / 2.0 / (1.0 - 0.3**2)
    exact = load / (np.pi * width * modulus)
    steel = {"young": 208e3, "poisson": 0.3, "radius_y": float("inf")}
    profile = {"form": "series", "coefficients": [1.3 * exact]}
    scene = ts.Scene(
        body={"A": steel | {"radius_x": 6.0, "width": width, "profile": profile},
              "B": steel | {"radius_x": 40.0}},
        load={"normal": load}, grid={"elements": [31, 201]},
    )  # fmt: skip
    key = {"key": "body.A.profile.coefficients[0]", "lower": 0.5 * exact, "upper": 2.0 * exact}
    table = {"scene": scene, "minimise": "p_95", "free": [key], "mesh_check": False}
    found = ts.design(table | {"tolerance": 1e-6})
    # Lundberg's coefficient is for a vanishing width of the contact; differences on the mesh
    assert found.values[key["key"]] == pytest.approx(exact, rel=0.02)


def test_the_load_of_a_line_contact_has_the_width_of_its_pressure():
    """p0 = E* a / (2 R): the half width of a line contact with a stated peak pressure."""
    scene = ts.Scene.builtin("cylinders").replace(subsurface=None)
    key = {"key": "load.normal", "lower": 100.0, "upper": 2000.0}
    target = {"observe": "p_max", "value": 800.0}
    found = ts.design({"scene": scene, "target": target, "free": [key], "tolerance": 1e-8})
    modulus, radius = 208e3 / 2.0 / (1.0 - 0.3**2), 25.0
    width = 2.0 * radius * 800.0 / modulus
    assert found.values["load.normal"] == pytest.approx(0.5 * np.pi * width * 800.0, rel=0.01)
    assert ts.solve(found.scene).half_width_x == pytest.approx(width, rel=0.03)  # an element


def test_the_creepage_of_the_largest_traction_has_no_slope():
    """Under a falling law, traction rises with creepage before it falls."""
    law = {"law": "exponential", "static": 0.33, "kinetic": 0.14, "half_speed": 100.0}
    scene = ts.Scene.builtin("cylinders").replace(subsurface=None, friction=law,
                                                  **{"creepage.speed": 20e3})  # fmt: skip
    key = {"key": "creepage.longitudinal", "lower": -0.02, "upper": -3e-4}
    found = ts.design({"scene": scene, "maximise": "Qx", "free": [key], "mesh_check": False,
                       "tolerance": 1e-6})  # fmt: skip
    best = found.values["creepage.longitudinal"]
    assert -0.019 < best < -1e-3
    steps = np.array([0.9, 1.0, 1.1])
    forces = [ts.solve(scene.replace(**{"creepage.longitudinal": best * one})).Qx for one in steps]
    change = (forces[2] - forces[0]) / (forces[1] * 0.2)
    assert abs(change) < 0.01  # d ln Q / d ln xi, differences


@pytest.fixture(scope="module")
def duty(scene):
    """A lighter and a heavier load on the same spheres in full slip."""
    return [scene.replace(**{"load.normal": load}) for load in (0.3, 0.8)]


def test_several_scenes_have_a_weighted_aim_and_limits_of_each(duty):
    """Q = mu P: most mean force below a limit of the heavier scene, mu = Q2 / P2."""
    key = {"key": "friction.mu", "lower": 0.1, "upper": 0.6}
    limits = [{"observe": "Qx", "at_most": 0.24}]
    table = design_of(duty, free=[key], limit=limits, weights=[0.25, 0.75], tolerance=1e-8)
    found = ts.design(table)
    assert found.values["friction.mu"] == pytest.approx(0.3, rel=1e-3)  # full slip but for ends
    assert found.texts("outcome") == ("Qx, scene 1", "Qx, scene 2")
    assert found.texts("aim") == ("Qx, weighted",)
    assert [one.load.normal for one in found.scenes] == [0.3, 0.8]
    text = " ".join(found.notes)
    assert "Qx at most 0.24 in scene 2 is active" in text
    assert "scene 1 is active" not in text
    target = {"observe": "Qx", "value": 0.2}
    found = ts.design(table | {"maximise": [], "limit": [], "target": target})
    assert found.values["friction.mu"] == pytest.approx(0.2 / (0.25 * 0.3 + 0.75 * 0.8), rel=2e-3)


def test_files_hold_several_scenes(duty, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number, one in enumerate(duty):
        (tmp_path / f"s{number}.toml").write_text(one.to_toml())
    (tmp_path / "d.toml").write_text(
        '[design]\nscene = ["s0.toml", "s1.toml"]\nminimise = "p_max"\nmesh_check = false\n'
        '[[design.free]]\nkey = "body.A.radius_x"\nlower = 200.0\nupper = 500.0\n'
    )
    runner = CliRunner()
    done = runner.invoke(app, ["design", "d.toml", "-o", "d.nc", "--scene", "best.toml"])
    assert done.exit_code == 0, done.output
    assert ts.Scene.from_toml("best-2.toml").load.normal == 0.8
    found = ts.open_design("d.nc")
    assert found.values == {"body.A.radius_x": 500.0}
    again = ts.OptimumDesign.from_toml_text(found.design.to_toml())
    assert again == found.design
    assert [one.load.normal for one in again.scenes] == [0.3, 0.8]
    assert runner.invoke(app, ["explain", "d.toml"]).exit_code == 0
    assert [one.name for one in found.drawings()] == ["search"]


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"weights": [1.0]}, "design.weights"),
        ({"weights": [1.0, -1.0]}, "design.weights"),
        ({"scene": ["spheres", "sphere"]}, "design.scene[1]"),
        ({"scene": []}, "design.scene"),
        ({"free": [{"key": "friction.mu", "lower": 0.1, "upper": 0.6, "start": 0.3}]},
         "design.free[0].key"),
    ],
)  # fmt: skip
def test_a_fault_of_several_scenes_is_reported_by_its_key(change, key):
    table = {"scene": ["spheres", "twin-discs"], "minimise": "p_max", "free": [LOAD]}
    with pytest.raises(ts.DesignError) as caught:
        ts.OptimumDesign(design=table | change)
    assert any(fault.key.startswith(key) for fault in caught.value.faults), caught.value.faults
