"""Estimates and intervals have their closed forms: in full slip, Qx/P is the coefficient."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import chi2, norm, t

import tractive_sam as ts
from tractive_sam.fitting import Evaluations, explain_fit, log_posterior
from tractive_sam.fitting.case import InProcess
from tractive_sam.fitting.design import Fit, Parameters
from tractive_sam.fitting.problem import LOSSES, Loss

VALUES = np.array([0.21, 0.34, 0.42, 0.25, 0.31])
N, Z = VALUES.size, norm.ppf(0.975)
TINY = 1e-6
"""Relative error: the friction of a contact in full slip, and the ends of intervals."""


@pytest.fixture(scope="module")
def line():
    """A line contact in full slip."""
    scene = ts.Scene.builtin("cylinders").replace(subsurface=None)
    grid = {"grid.elements": 21, "grid.half_length": 1.15 * scene.hertz.a}
    return scene.replace(**grid, **{"creepage.longitudinal": -0.05})


def fit_mu(line, noise, values=VALUES, prior=None, **more):
    data = {"values": {"Qx_over_P": values}, "observe": "Qx_over_P", "noise": noise}
    entries = {"scene": line, "free": ["friction.mu"], "data": [data], "mesh_check": False}
    if prior:
        entries["parameter"] = [{"key": "friction.mu", "prior": prior}]
    return ts.fit(entries | {"curve": 0} | more)


@pytest.mark.parametrize("s", [0.05, 0.5])
def test_relative_noise_follows_the_prediction(line, s):
    """The estimate is the mean, and the interval that of (mean - mu) sqrt(n) = z s mu."""
    found = fit_mu(line, s)
    mean, reach = VALUES.mean(), Z * s / N**0.5
    assert found.values["friction.mu"] == pytest.approx(mean, rel=TINY)
    ends = (mean / (1.0 + reach), mean / (1.0 - reach))
    assert found.interval("friction.mu") == pytest.approx(ends, rel=TINY)
    assert found.sd["friction.mu"] == pytest.approx(s * mean / N**0.5, rel=TINY)
    assert found.chi2 == pytest.approx(np.square(VALUES / mean - 1.0).sum() / s**2, rel=10.0 * TINY)


def test_a_factor_is_the_noise_of_logarithms(line):
    found = fit_mu(line, {"factor": 1.5})
    mean, reach = np.log(VALUES).mean(), Z * np.log(1.5) / N**0.5
    assert found.values["friction.mu"] == pytest.approx(np.exp(mean), rel=TINY)
    ends = (np.exp(mean - reach), np.exp(mean + reach))
    assert found.interval("friction.mu") == pytest.approx(ends, rel=TINY)
    rows = np.log(VALUES / np.exp(mean)) / np.log(1.5)
    assert found.dataset["residual"].values == pytest.approx(rows, abs=1e-5)


def test_an_absolute_noise_gives_the_mean_and_its_deviation(line):
    found = fit_mu(line, {"absolute": 0.1})
    reach = Z * 0.1 / N**0.5
    ends = (VALUES.mean() - reach, VALUES.mean() + reach)
    assert found.interval("friction.mu") == pytest.approx(ends, rel=TINY)


@pytest.mark.parametrize("n", [2, 3, 5])
def test_intervals_by_scatter_are_those_of_student(line, n):
    values = VALUES[:n]
    reach = t.ppf(0.975, n - 1) * values.std(ddof=1) / n**0.5
    ends = np.array([max(values.mean() - reach, 0.0), values.mean() + reach])
    found = fit_mu(line, {"absolute": 1e-3}, values, scatter=True)
    assert found.interval("friction.mu") == pytest.approx(ends, rel=TINY)


def test_the_profile_likelihood_by_scatter_is_that_of_f(line):
    values = 0.3 + 0.01 * (VALUES[:4] - 0.3)
    reach = t.ppf(0.975, 3) * values.std(ddof=1) / 4**0.5
    found = fit_mu(line, {"absolute": 1e-3}, values, scatter=True, intervals="profile")
    ends = (values.mean() - reach, values.mean() + reach)
    # the root of the rise is found to 2 % of the half width
    assert found.interval("friction.mu") == pytest.approx(ends, abs=0.02 * reach)
    assert found.dataset.attrs["likelihood_limit"] == pytest.approx(t.ppf(0.975, 3) ** 2)


@pytest.mark.parametrize(("width", "shares"), [(1e2, 1.0), (1e-4, 0.0), (0.1 / N**0.5, 0.5)])
def test_a_prior_is_no_point_of_data(line, width, shares):
    """The degrees of freedom are the points less the share of the data in the information."""
    found = fit_mu(line, {"absolute": 0.1}, prior=[0.3, width])
    assert found.chi2_range == pytest.approx(chi2.interval(0.95, N - shares), rel=1e-3)


def test_the_scatter_of_the_data_does_not_widen_a_prior(line):
    found = fit_mu(line, {"absolute": 1e-3}, prior=[0.3, 0.01], scatter=True)
    scatter = found.dataset.attrs["scatter"]
    information = N / (scatter * 1e-3) ** 2
    assert found.sd["friction.mu"] == pytest.approx((information + 1e4) ** -0.5, rel=1e-4)
    mean = (information * VALUES.mean() + 1e4 * 0.3) / (information + 1e4)
    # the search ends within 0.03 of the standard deviation
    assert found.values["friction.mu"] == pytest.approx(mean, abs=0.03 * found.sd["friction.mu"])


@pytest.mark.parametrize("loss", LOSSES)
def test_a_robust_loss_is_one_of_the_data_and_priors_stay_quadratic(line, loss):
    """Estimate and posterior are those of the loss of data, per its information, and a square."""
    values, mean, sd, s = np.array([0.300, 0.301, 0.310, 0.328]), 0.33, 0.01, 0.01
    found = fit_mu(line, {"absolute": s}, values, [mean, sd], loss=loss)

    def cost(mu):
        of_data = LOSSES[loss](np.square((values - mu) / s))[0].sum() / Loss(loss).rise
        return 0.5 * of_data + 0.5 * ((mu - mean) / sd) ** 2

    least = minimize_scalar(cost, (0.30, 0.32), tol=1e-10).x
    # the search ends within 0.03 of the standard deviation
    assert found.values["friction.mu"] == pytest.approx(least, abs=0.03 * found.sd["friction.mu"])
    data = {"values": {"Qx_over_P": values}, "observe": "Qx_over_P", "noise": {"absolute": s}}
    prior = [{"key": "friction.mu", "prior": [mean, sd]}]
    design = {"scene": line, "free": ["friction.mu"], "data": [data], "parameter": prior}
    density, _ = log_posterior(design | {"loss": loss})
    fall = density([0.305]) - density([0.33])
    # predictions are accurate to 1e-6 of 30 standard deviations
    assert fall == pytest.approx(cost(0.33) - cost(0.305), abs=1e-3)


@pytest.mark.parametrize("intervals", ["linear", "profile"])
@pytest.mark.parametrize("loss", LOSSES)
def test_a_precise_prior_has_its_own_interval_with_any_loss(line, loss, intervals):
    mean, sd = 0.34, 1e-4
    found = fit_mu(line, {"absolute": 0.1}, prior=[mean, sd], loss=loss, intervals=intervals)
    ends = (mean - Z * sd, mean + Z * sd)
    # five values of 0.1 move the mean and the width by 1e-5; a profile ends within 2 % of the root
    assert found.interval("friction.mu") == pytest.approx(ends, abs=0.03 * Z * sd)


@pytest.mark.parametrize("loss", LOSSES)
def test_intervals_of_an_absolute_noise_are_symmetric_with_loss_and_prior(line, loss):
    found = fit_mu(line, {"absolute": 0.01}, VALUES, [0.33, 0.02], loss=loss)
    reach = np.abs(np.subtract(found.interval("friction.mu"), found.values["friction.mu"]))
    # the search ends within 0.03 of the standard deviation, where the slope is not quite zero
    assert reach == pytest.approx(Z * found.sd["friction.mu"], rel=0.05)


@pytest.mark.parametrize("outliers", [0.0, 0.1])
@pytest.mark.parametrize("loss", [name for name in LOSSES if name != "linear"])
def test_intervals_of_a_robust_mean_of_ten_values_hold_in_95_per_cent(loss, outliers):
    """The mean minimises the losses of standard normal values, some of them ten times as large."""
    rng, repeats = np.random.default_rng(1), 2000
    values = rng.standard_normal((repeats, 10))
    values *= np.where(rng.random(values.shape) < outliers, 10.0, 1.0)
    mean = np.median(values, axis=1, keepdims=True)
    for _ in range(60):  # weighted least squares
        weights = LOSSES[loss](np.square(values - mean))[1]
        mean = np.average(values, axis=1, weights=weights, keepdims=True)
    inflation = np.array([Loss(loss).inflation(row, 1) for row in values - mean])
    inside = np.abs(mean[:, 0]) < Z * np.sqrt(inflation / weights.sum(axis=1))
    # chance 0.5 %; the larger of two variances, by the data and of normal noise, is 1 % too safe
    assert inside.mean() == pytest.approx(0.955, abs=0.015)


@pytest.mark.parametrize("loss", [name for name in LOSSES if name != "linear"])
def test_an_outlier_does_not_change_a_robust_scatter_without_limit(line, loss):
    """However far it is, it counts as one beyond its standard deviation."""
    values = 0.3 + 0.01 * norm.ppf((np.arange(20) + 0.5) / 20)
    found = [
        fit_mu(line, {"absolute": 0.01}, np.append(values[1:], far), loss=loss, scatter=True)
        for far in (0.5, 30.0)
    ]
    near, far = (one.dataset.attrs["scatter"] for one in found)
    assert far == pytest.approx(near, rel=0.1)  # the estimate moves by part of its deviation
    assert far == pytest.approx(1.0, abs=0.3)  # one of twenty is beyond all others
    low, high = found[1].interval("friction.mu")
    assert low < 0.3 < high < 0.32


@pytest.mark.parametrize("loss", LOSSES)
def test_scatter_is_in_proportion_to_the_data(line, loss):
    """The stated noise is a first guess alone, however wrong it is."""
    found = [
        fit_mu(line, {"absolute": s}, 0.3 + 0.1 * (VALUES - 0.3), loss=loss, scatter=True)
        for s in (1e-5, 1e-2, 1.0)
    ]
    noise = np.array([1e-5, 1e-2, 1.0]) * [one.dataset.attrs["scatter"] for one in found]
    assert noise == pytest.approx(noise[0], rel=0.02)  # the search ends within 0.03 deviations


def test_precise_data_of_one_parameter_leave_others_determined(line):
    worn = line.replace(
        wear={"coefficient": 1e-4, "revolutions": 2, "save": [0, 2], "stepping": "saved"}
    )
    area = float(ts.roll(worn, progress=False)["worn_area"][-1])
    sets = [
        {"values": {"Qx_over_P": [0.3]}, "observe": "Qx_over_P", "noise": {"absolute": 1e-6},
         "at": 0},
        {"values": {"worn_area": [area]}, "observe": "worn_area", "noise": 0.1},
    ]  # fmt: skip
    free = ["friction.mu", "wear.coefficient"]
    found = ts.fit({"scene": worn, "free": free, "data": sets, "mesh_check": False, "curve": 0})
    assert not found.undetermined
    # derivatives of rolls are accurate to 1e-2
    assert found.sd["wear.coefficient"] == pytest.approx(1e-5, rel=1e-2)
    assert [points for _, points in found.data_chi2] == [1, 1]
    assert sum(value for value, _ in found.data_chi2) == pytest.approx(found.chi2)


def test_a_layer_that_is_too_thin_to_matter_is_bounded_above(line):
    """In full slip any layer agrees with the data up to one that lets the contact stick."""
    scene = line.replace(**{"creepage.longitudinal": -0.0015})
    data = {"values": {"Qx_over_P": [ts.solve(scene).Qx / scene.normal_load]}}
    data |= {"observe": "Qx_over_P", "noise": 0.05}
    start = [{"key": "friction.layer", "start": 1e-6, "lower": 0.0}]
    design = {"scene": scene, "free": ["friction.layer"], "data": [data], "parameter": start}
    found = ts.fit(design | {"mesh_check": False, "curve": 0})
    low, high = found.interval("friction.layer")
    assert not found.undetermined
    assert low == 0.0
    assert any("friction.layer is bounded above by" in note for note in found.notes)
    at_bound = ts.solve(scene.replace(**{"friction.layer": high})).Qx / scene.normal_load
    measured = data["values"]["Qx_over_P"][0]
    # the noise follows the prediction at the bound, which is found to 2 %
    assert abs(at_bound - measured) / (0.05 * abs(at_bound)) == pytest.approx(Z, rel=0.05)


@pytest.mark.slow
def test_intervals_hold_as_often_as_they_say(monkeypatch):
    """See the benchmark: few repeats of some rows, one of each kind of noise and setting."""
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "benchmarks")
    benchmark = import_module("fit_coverage")
    repeats, cases = 25, benchmark.cases()
    shares = [
        row["covered %"] / 100.0
        for seed, case in enumerate((*cases[8:12], *cases[12::4]))
        for row in benchmark.coverage(case, repeats, seed)
    ]
    # four standard deviations of one row, and three of the mean of all rows and 1 % of robust ones
    assert min(shares) > 0.95 - 4.0 * (0.05 * 0.95 / repeats) ** 0.5
    deviation = (0.05 * 0.95 / (repeats * len(shares))) ** 0.5
    assert np.mean(shares) == pytest.approx(0.95, abs=0.01 + 3.0 * deviation)


@pytest.mark.slow
def test_the_closed_model_of_the_coverage_is_that_of_contacts(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "benchmarks")
    benchmark = import_module("fit_coverage")
    case = next(one for one in benchmark.cases() if one.note == "two data sets")
    # one revolution changes the contact by 1e-4 of its wear
    assert benchmark.check(case) < 1e-3


def test_a_key_or_a_law_implies_bounds(line):
    data = {"values": {"Qx_over_P": VALUES}, "observe": "Qx_over_P", "noise": 0.1}

    def parameters(*keys, **law):
        friction = {"static": 0.4} | law
        scene = line.replace(**{"friction": friction, "creepage.speed": 1e3})
        return Parameters.of(Fit(scene=scene, free=keys, data=[data]))

    falling = {"law": "exponential", "kinetic": 0.1, "half_speed": 300.0}
    assert parameters("friction.kinetic", **falling).upper.tolist() == [0.4]
    both = parameters("friction.static", "friction.kinetic", **falling)
    assert both.limits(np.array([0.35, 0.1]))[1].tolist() == [np.inf, 0.35]
    ratio = parameters("friction.A", law="polach", A=0.4, B=0.6)
    assert (ratio.lower.tolist(), ratio.upper.tolist()) == ([0.0], [1.0])


def test_a_wide_interval_is_named_with_what_would_reduce_it(line):
    notes = fit_mu(line, {"factor": 10.0}, VALUES[:1]).notes
    (note,) = [note for note in notes if "hardly determined" in note]
    assert "spans a factor of" in note
    assert "[[fit.test]]" in note


def test_the_search_reports_each_iteration(line):
    counts = []
    data = {"values": {"Qx_over_P": VALUES}, "observe": "Qx_over_P", "noise": 0.1}
    design = {"scene": line, "free": ["friction.mu"], "data": [data], "mesh_check": False}
    ts.fit(design, progress=lambda done: counts.append(len(done.searched)))
    assert counts[0] == 0
    assert sorted({*counts}) == [*range(counts[-1] + 1)]


def test_time_left_follows_the_fall_of_chi_square():
    done = Evaluations(InProcess())
    assert np.isnan(done.seconds_left())
    done.searched = [(0.0, 11.1), (2.0, 1.1), (4.0, 0.1)]  # falls by 10, then by 1
    assert done.seconds_left(0.01) == pytest.approx(4.0)  # two further iterations of 2 s
    done.searched = [*enumerate((4850.0, 666.0, 50.4, 37.9, 6.6))]  # a fall larger than the last
    assert done.seconds_left() < 10.0


def test_explain_counts_contacts_and_changed_parameters(line):
    columns = {"creepage.longitudinal": [-0.01, -0.02], "Qx_over_P": VALUES[:2]}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    free = ["friction.mu", "friction.layer"]
    design = ts.FitDesign(fit={"scene": line, "free": free, "data": [data | {"noise": 0.1}]})
    parameters, data_sets, work = explain_fit(design)
    assert parameters.rows[1] == ("friction.layer", "from 0, at least 0")
    values = "2 values of Qx_over_P from 0.21 to 0.34"
    assert data_sets.rows[0][1] == f"{values} over creepage.longitudinal, from contacts"
    # friction has exact derivatives, the layer has none
    counts = "2 contacts and 0 runs, and 2 with a changed parameter; about"
    assert work.rows[0][1].startswith(counts)
