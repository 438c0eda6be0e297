"""Fits return the truth, and report what data do not determine."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.fitting import laws
from tests.fitting.conftest import CREEPAGES, creep_data, starts, worn_data
from tractive_sam.fitting import log_posterior
from tractive_sam.fitting.estimate import ProfileLikelihood, Search
from tractive_sam.fitting.problem import LOSSES
from tractive_sam.fitting.run import make_problem, read_design
from tractive_sam.validation import experiment

EXACT = 1e-6
"""Relative error of estimates from data without noise; the search ends at changes of 1e-7."""


def errors(found, truth):
    return [found.values[key] / value - 1.0 for key, value in truth.items()]


def layer_of(scene):
    """Return a layer that is about as compliant as the bodies."""
    return 0.3 * float(scene.hertz.a) / scene.material.shear


def test_friction_and_layer_return_from_data_without_noise(spheres):
    truth = {"friction.mu": 0.35, "friction.layer": layer_of(spheres)}
    start = starts(friction__layer=0.7 * layer_of(spheres))
    found = ts.fit(
        {"scene": spheres, "free": [*truth], "parameter": start,
         "data": [creep_data(spheres, truth)], "mesh_check": False, "curve": 0}
    )  # fmt: skip
    assert np.abs(errors(found, truth)).max() < EXACT
    assert found.points == len(CREEPAGES)
    low, high = found.interval("friction.mu")
    assert low < 0.35 < high
    assert not found.undetermined
    assert found.scene.friction.mu == pytest.approx((0.35, 0.35), rel=EXACT)


def test_the_progress_and_the_result_have_one_chi_square(spheres):
    """It is the one of the data, without the prior, for the noise at the prediction."""
    factors = np.array([1.05, 0.96, 1.03, 0.98])
    data = creep_data(spheres, {"friction.mu": 0.35}, factors=factors)
    prior = {"key": "friction.mu", "start": 0.35, "prior": [0.5, 0.05]}
    design = {"scene": spheres, "free": ["friction.mu"], "parameter": [prior], "data": [data]}
    progress = []
    found = ts.fit(
        design | {"mesh_check": False, "curve": 0},
        progress=lambda done: progress.extend(chi2 for _, chi2 in done.searched[-1:]),
    )
    # The search ends at changes by 3 % of a standard deviation.
    assert progress[-1] == pytest.approx(found.chi2, rel=0.01)


@pytest.mark.slow
def test_falling_friction_law_returns_from_data_without_noise(spheres):
    truth = {"friction.static": 0.5, "friction.kinetic": 0.25, "friction.half_speed": 20.0}
    law = {"law": "exponential"} | {key.split(".")[1]: one for key, one in truth.items()}
    scene = spheres.replace(**{"creepage.speed": 1e4, "friction": law})
    data = creep_data(scene, {}, noise=0.02)
    start = starts(friction__static=0.45, friction__kinetic=0.22, friction__half_speed=25.0)
    design = {"scene": scene, "free": [*truth], "parameter": start, "data": [data]}
    found = ts.fit(design | {"mesh_check": False, "curve": 0})
    assert np.abs(errors(found, truth)).max() < EXACT


def test_contacts_without_a_unique_solution_are_counted_and_named(spheres):
    law = {"law": "exponential", "static": 0.5, "kinetic": 0.3, "half_speed": 10.0}
    scene = spheres.replace(**{"creepage.speed": 1e4, "friction": law, "solver.slip": "upwind"})
    with pytest.warns(ts.SceneWarning, match=r"friction\.start"):
        data = creep_data(scene, {}, noise=0.02)
    start = starts(friction__static=0.49)
    design = {"scene": scene, "free": ["friction.static"], "parameter": start, "data": [data]}
    found = ts.fit(design | {"mesh_check": False, "curve": 0})
    (note,) = [note for note in found.notes if "no unique solution" in note]
    assert "creepage.longitudinal = -0.00" in note


def test_masses_in_another_unit_are_noted(discs):
    wear = {"coefficient": 1.3e-4, "revolutions": 1, "save": (0, 1), "stepping": "saved"}
    scene = discs.replace(wear=wear)
    data = worn_data(ts.roll(scene, progress=False), "A", [1])
    data["values"]["worn_mass"] = 1e-3 * data["values"]["worn_mass"]  # g where mg are read
    design = {"scene": scene, "free": ["wear.coefficient"], "data": [data]}
    found = ts.fit(design | {"mesh_check": False, "curve": 0})
    (note,) = [note for note in found.notes if "worn_mass is in mg" in note]
    assert "0.001 times its first value, 0.00013" in note


@pytest.mark.slow
def test_wear_of_both_bodies_returns_from_masses_and_a_profile(discs):
    truth = {"wear.coefficient.A": 1.3e-4, "wear.coefficient.B": 2.2e-4}
    history = ts.roll(discs, progress=False)
    depth = history["wear_profile_B"][-1]
    profile = {"y": history.y + 0.05, "depth": depth + 2e-5 + 1e-4 * history.y}
    sets = [
        worn_data(history, "A", (1000, 2000, 3000)),
        {"values": profile, "observe": "wear_profile", "body": "B", "noise": {"absolute": 1e-5}},
    ]
    start = starts(wear__coefficient__A=1e-4, wear__coefficient__B=1.5e-4)
    design = {"scene": discs, "free": [*truth], "parameter": start, "data": sets}
    found = ts.fit(design | {"mesh_check": False, "curve": 0})
    assert np.abs(errors(found, truth)).max() < EXACT
    assert found.positions["fit.data[1] offset"] == pytest.approx(0.05, abs=1e-6)
    assert found.rolls <= 40  # both sets share each roll


@pytest.mark.slow
def test_exponent_of_a_wear_law_returns_from_data_without_noise(discs):
    scene = discs.replace(
        wear={"law": f"{laws.__name__}:PowerLaw", "factor": 1e-9, "exponent": 1.2,
              "revolutions": 100, "save": (0, 1, 3, 10, 30, 60, 100), "stepping": "saved"}
    )  # fmt: skip
    truth = {"wear.factor": 1e-9, "wear.exponent": 1.2}
    sets = []
    for creepage in (-0.003, -0.008):
        entry = {"creepage.longitudinal": creepage}
        history = ts.roll(scene.replace(**entry), progress=False)
        sets.append(worn_data(history, "A", (60, 100)) | {"set": entry})
    start = starts(wear__factor=2e-9, wear__exponent=1.1)
    design = {"scene": scene, "free": [*truth], "parameter": start, "data": sets}
    found = ts.fit(design | {"mesh_check": False, "curve": 0})
    assert np.abs(errors(found, truth)).max() < EXACT


@pytest.mark.slow
def test_exact_derivatives_are_those_of_differences(spheres):
    """Of mu and the load, on the mesh that is fixed while the load varies."""
    coarse = spheres.replace(grid=None).replace(**{"grid.elements": (17, 17)})
    data = creep_data(coarse, {"friction.mu": 0.35})
    design = {"scene": coarse, "free": ["friction.mu", "load.normal"], "data": [data], "curve": 0}
    prior = {"key": "load.normal", "prior": [coarse.normal_load, 0.1 * coarse.normal_load]}
    found = ts.fit(design | {"parameter": [prior], "mesh_check": False, "curve": 0})
    slopes = found.dataset["jacobian"].values
    mu, load = found.values["friction.mu"], found.values["load.normal"]
    grid = found.design.fit.scene.grid
    assert grid == coarse.grid
    step = 1e-3
    for k, (key, value) in enumerate({"friction.mu": mu, "load.normal": load}.items()):
        for row, creepage in enumerate(CREEPAGES):
            ratios = []
            for factor in (1.0 - step, 1.0 + step):
                entries = {"friction.mu": mu, "load.normal": load, key: value * factor}
                entries |= {"creepage.longitudinal": creepage} | _mesh(coarse)
                contact = ts.solve(coarse.replace(**entries))
                ratios.append(contact.Qx / contact.P)
            # 2e-3 of the largest slope: elements begin to slip within the step
            tolerance = 2e-3 * np.abs(slopes).max()
            assert slopes[row, k] == pytest.approx((ratios[1] - ratios[0]) / (2.0 * step),
                                                   abs=tolerance)  # fmt: skip


def _mesh(scene):
    """Return the mesh of the fit: the mesh of the first contact, a quarter wider."""
    grid = ts.solve(scene).grid
    more = [int(np.ceil(0.5 * n * 0.25 - 1e-9)) for n in grid.elements]
    elements = tuple(n + 2 * m for n, m in zip(grid.elements, more, strict=True))
    half = (0.5 * elements[0] * grid.dx, 0.5 * elements[1] * grid.dy)
    return {"grid.half_length": half, "grid.elements": elements}


def test_friction_across_straight_rolling_is_not_determined(spheres):
    scene = spheres.replace(**{"friction.mu": (0.35, 0.3)})
    data = creep_data(scene, {})
    free = ["friction.mu[0]", "friction.mu[1]"]
    found = ts.fit({"scene": scene, "free": free, "data": [data], "curve": 0})
    assert len(found.undetermined) == 1
    assert "friction.mu[1]" in found.undetermined[0]
    assert found.values["friction.mu[0]"] == pytest.approx(0.35, rel=EXACT)
    assert found.to_dict()["parameters"]["friction.mu[1]"]["low"] is None
    assert np.isfinite(found.interval("friction.mu[0]")).all()


@pytest.mark.slow
def test_only_coefficient_times_force_is_determined_in_full_slip(spheres):
    force = 0.35 * spheres.normal_load
    columns = {"creepage.longitudinal": [-0.05, -0.1], "Qx": [force, force]}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx", "noise": 0.05}
    found = ts.fit(
        {"scene": spheres, "free": ["friction.mu", "load.normal"], "data": [data], "curve": 0}
    )
    assert found.undetermined == ["only friction.mu * load.normal is determined"]
    product = found.values["friction.mu"] * found.values["load.normal"]
    assert product == pytest.approx(force, rel=1e-4)  # the mesh carries the load to this


@pytest.mark.slow
def test_only_coefficient_times_revolutions_is_determined(discs):
    history = ts.roll(discs, progress=False)
    mass = history["worn_mass"][-1, 0]
    data = {"values": {"worn_mass": [mass]}, "observe": "worn_mass", "body": "A", "noise": 0.03}
    together = discs.replace(**{"wear.coefficient": 3.5e-4})
    found = ts.fit(
        {"scene": together, "free": ["wear.coefficient", "wear.revolutions"],
         "data": [data, data], "mesh_check": False, "curve": 0}
    )  # fmt: skip
    assert found.undetermined == ["only wear.coefficient * wear.revolutions is determined"]


@pytest.mark.slow
def test_a_prior_decides_what_data_do_not(spheres):
    force = 0.35 * spheres.normal_load
    columns = {"creepage.longitudinal": [-0.05, -0.1], "Qx": [force, force]}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx", "noise": 0.05}
    prior = {"key": "load.normal", "prior": [0.4, 0.01]}
    found = ts.fit(
        {"scene": spheres, "free": ["friction.mu", "load.normal"], "data": [data],
         "parameter": [prior], "mesh_check": False, "curve": 0}
    )  # fmt: skip
    assert found.values["load.normal"] == pytest.approx(0.4, rel=1e-3)
    assert found.sd["load.normal"] == pytest.approx(0.01, rel=0.01)
    assert "priors decide" in found.undetermined[0]


@pytest.mark.slow
def test_profile_likelihood_of_a_nearly_linear_problem_is_the_linear_interval(spheres):
    data = creep_data(spheres, {"friction.mu": 0.35}, noise=0.02)
    design = {
        "scene": spheres,
        "free": ["friction.mu"],
        "data": [data],
        "mesh_check": False,
        "curve": 0,
    }
    linear, profile = (ts.fit(design | {"intervals": one}) for one in ("linear", "profile"))
    for one, other in zip(linear.interval("friction.mu"), profile.interval("friction.mu"),
                          strict=True):  # fmt: skip
        assert one == pytest.approx(other, rel=0.01)
    assert (profile.dataset["likelihood"].values[:, 2] >= 0.0).all()
    # no derivatives: with one parameter each point of the curve is one prediction
    points = profile.dataset["likelihood"].shape[0] - 1
    assert profile.solves - linear.solves == points * len(CREEPAGES)


@pytest.mark.slow
def test_an_outlier_counts_less_by_a_robust_loss(spheres):
    factors = np.array([1.0, 1.0, 1.0, 1.6])
    data = creep_data(spheres, {"friction.mu": 0.35}, noise={"absolute": 0.005}, factors=factors)
    design = {
        "scene": spheres,
        "free": ["friction.mu"],
        "data": [data],
        "mesh_check": False,
        "curve": 0,
    }
    linear, robust = (ts.fit(design | {"loss": one}) for one in ("linear", "cauchy"))
    assert abs(robust.values["friction.mu"] - 0.35) < abs(linear.values["friction.mu"] - 0.35) / 5
    assert any("chi-square" in note for note in linear.notes)


@pytest.mark.slow
def test_random_starts_find_the_same_minimum(spheres):
    data = creep_data(spheres, {"friction.mu": 0.35})
    bounds = {"key": "friction.mu", "start": 0.1, "lower": 0.05, "upper": 0.9}
    design = {
        "scene": spheres,
        "free": ["friction.mu"],
        "data": [data],
        "parameter": [bounds],
        "mesh_check": False,
        "curve": 0,
    }
    found = ts.fit(design | {"starts": 2, "mesh_check": False, "curve": 0})
    assert found.values["friction.mu"] == pytest.approx(0.35, rel=EXACT)


def test_an_estimate_at_its_bound_has_a_note(spheres):
    data = creep_data(spheres, {"friction.mu": 0.35})
    bounds = {"key": "friction.mu", "start": 0.25, "upper": 0.3}
    found = ts.fit(
        {"scene": spheres, "free": ["friction.mu"], "data": [data], "parameter": [bounds],
         "mesh_check": False, "curve": 0}
    )  # fmt: skip
    assert found.values["friction.mu"] == pytest.approx(0.3)
    assert any("friction.mu is at its upper bound" in note for note in found.notes)


@pytest.mark.slow
def test_scatter_widens_intervals(spheres):
    factors = np.array([1.1, 0.9, 1.1, 0.9])
    data = creep_data(spheres, {"friction.mu": 0.35}, noise=0.01, factors=factors)
    design = {
        "scene": spheres,
        "free": ["friction.mu"],
        "data": [data],
        "mesh_check": False,
        "curve": 0,
    }
    stated, scattered = ts.fit(design), ts.fit(design | {"scatter": True})
    ratio = scattered.sd["friction.mu"] / stated.sd["friction.mu"]
    # each search ends within 0.03 of its standard deviation
    assert ratio == pytest.approx((stated.chi2 / 3) ** 0.5, rel=5e-3)


def test_the_next_test_is_where_a_parameter_matters(spheres):
    """Friction is measured best in full slip; by the least slip hardly at all."""
    data = creep_data(spheres, {"friction.mu": 0.35})
    test = {"vary": "creepage.longitudinal", "values": [-1e-4, -0.02], "observe": "Qx_over_P",
            "noise": 0.05}  # fmt: skip
    found = ts.fit(
        {
            "scene": spheres,
            "free": ["friction.mu"],
            "data": [data],
            "test": [test],
            "mesh_check": False,
            "curve": 0,
        },
        next_test=True,
    )
    best, worst = found.next_tests()
    assert "-0.02" in best["test"]
    assert worst["gain"] < 0.01 < best["gain"]
    assert best["sd"]["friction.mu"] < found.sd["friction.mu"]


@pytest.mark.slow
def test_derivatives_of_the_estimate_serve_the_profile_likelihood(spheres):
    """Its ends are those of searches with derivatives at every point, for fewer contacts."""
    truth = {"friction.mu": 0.35, "friction.layer": layer_of(spheres)}
    design = {"scene": spheres, "free": [*truth], "data": [creep_data(spheres, truth)]}
    fit = read_design(design | {"parameter": starts(friction__layer=layer_of(spheres))}).fit
    ends, contacts = [], []
    for steps in (4, 0):
        found = Search(make_problem(fit), fit).run()
        before = found.problem.evaluations.cost[0]
        ends.append(ProfileLikelihood(found, fit, 1, steps=steps).interval()[:2])
        contacts.append(found.problem.evaluations.cost[0] - before)
    assert ends[0] == pytest.approx(ends[1], rel=0.02)  # found to 2 % of the root of the rise
    assert contacts[0] < 0.5 * contacts[1]


def test_posterior_is_largest_at_the_truth(spheres):
    data = creep_data(spheres, {"friction.mu": 0.35})
    density, start = log_posterior({"scene": spheres, "free": ["friction.mu"], "data": [data]})
    assert start.shape == (1,)
    assert density([0.35]) > max(density([0.33]), density([0.37]))
    assert density([-1.0]) == -np.inf


@pytest.mark.slow
def test_posterior_samples_agree_with_the_linearised_interval(spheres):
    emcee = pytest.importorskip("emcee", reason="emcee is of the extra benchmarks")
    data = creep_data(spheres, {"friction.mu": 0.35})
    design = {"scene": spheres, "free": ["friction.mu"], "data": [data], "curve": 0}
    found, (density, start) = ts.fit(design), log_posterior(design)
    sampler = emcee.EnsembleSampler(4, 1, density)
    sampler.random_state = np.random.RandomState(1).get_state()
    sampler.run_mcmc(start * np.array([[0.95], [0.98], [1.01], [1.04]]), 150)
    samples = sampler.get_chain(discard=30, flat=True)
    # 480 samples, about 8 for each independent one: the mean has an error of 0.13 deviations
    deviation = found.sd["friction.mu"]
    assert abs(samples.mean() - found.values["friction.mu"]) < 0.5 * deviation
    assert samples.std() == pytest.approx(deviation, rel=0.4)


@pytest.mark.parametrize("name", LOSSES)
def test_the_weight_of_a_residual_is_the_derivative_of_its_loss(name):
    loss, squares, h = LOSSES[name], np.array([0.1, 0.7, 1.5, 30.0]), 1e-5
    expected = (loss(squares + h)[0] - loss(squares - h)[0]) / (2.0 * h)
    np.testing.assert_allclose(loss(squares)[1], expected, rtol=1e-8)  # h squared


def test_the_cost_is_half_the_sum_of_squares_of_residuals_and_priors(spheres):
    data = creep_data(spheres, {"friction.mu": 0.35}, noise=0.02)
    prior = {"key": "friction.mu", "prior": [0.5, 0.01]}
    design = {"scene": spheres, "free": ["friction.mu"], "data": [data], "parameter": [prior]}
    fit = read_design(design).fit
    found = Search(make_problem(fit), fit).run()
    residuals = found.problem.residuals(found.u, found.predicted)
    assert found.cost() == pytest.approx(0.5 * np.square(residuals).sum(), rel=1e-12)
    assert abs(found.problem.prior_residuals(found.u)[0]) > 1.0


def test_a_creep_curve_with_relative_noise_needs_few_contacts():
    """Twin discs of Lewis and Dwyer-Joyce: elements that begin to slip leave kinks in the cost."""
    power = np.array(experiment.HEAT, float) * 1e3 / (experiment.SPEED * experiment.TRACK)
    columns = {"creepage.longitudinal": -experiment.SLIP, "t_gamma": power}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "t_gamma"}
    table = {
        "scene": experiment.SCENE,
        "free": ["friction.mu", "friction.layer"],
        "data": [data | {"noise": 0.05}],
        "parameter": [{"key": "friction.layer", "start": 1e-6}],
        "mesh_check": False,
        "curve": 0,
    }
    found = ts.fit(table)
    assert found.solves <= 110  # 96; the searches of each weight took 176 up to their last digits
    # Both are the values of those searches, within a twentieth of a standard deviation.
    assert found.values["friction.mu"] == pytest.approx(0.4643, abs=0.05 * found.sd["friction.mu"])
    layer, deviation = found.values["friction.layer"], found.sd["friction.layer"]
    assert layer == pytest.approx(1.622e-6, abs=0.05 * deviation)
