"""Spreads against closed forms, their intervals, failed samples, and files."""

import json
import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy import stats
from typer.testing import CliRunner

import tractive_sam as ts
from tests.fitting.conftest import creep_data
from tractive_sam.cli.program import app
from tractive_sam.fitting import case, percentiles
from tractive_sam.fitting.distributions import Input, Uncertain
from tractive_sam.fitting.fit_file import write_fit
from tractive_sam.fitting.response import label_of
from tractive_sam.store import ResultsError, write_netcdf
from tractive_sam.studies import SchedulerLostError

KEYS = ("load.normal", "friction.mu", "creepage.spin")


class ClosedForm:
    """Outcomes by formulas, evaluated as a `Response`; messages where they are nan."""

    def __init__(self, *formulas):
        self.formulas = formulas
        self.evaluated = 0

    def evaluate(self, points):
        self.evaluated += len(points)
        values = np.stack([formula(points) for formula in self.formulas], axis=1)
        return values, ["" if ok else "fails" for ok in np.isfinite(values).all(axis=1)]


def make_sampler(fine, rough=None, deviations=(0.2, 0.1), correlation=(), **table):
    """Return a sampler of formulas of log-normal keys with medians of 1."""
    uncertain = [
        {"key": key, "distribution": "lognormal", "median": 1.0, "factor": float(np.exp(s))}
        for key, s in zip(KEYS, deviations, strict=False)
    ]
    design = ts.SpreadDesign(
        spread={"scene": "spheres", "observe": "Qx"} | table,
        uncertain=uncertain,
        correlation=correlation,
    )
    inputs, matrix = design.inputs()
    return percentiles.Sampler(design.spread, inputs, matrix, fine, rough or fine)


def power_law(*exponents):
    return ClosedForm(lambda x: np.prod(x ** np.array(exponents), axis=1))


def exact_indices(exponents, deviations):
    """Return first-order and total indices of a product of powers of log-normal keys."""
    v = (np.array(exponents) * np.array(deviations)) ** 2
    return (np.exp(v) - 1) / np.expm1(v.sum()), (1 - np.exp(-v)) * np.exp(v.sum()) / np.expm1(
        v.sum()
    )


@pytest.mark.parametrize(
    ("exponents", "deviations"),
    [
        ((1, 1), (0.2, 0.1)),  # full slip, Q = mu P
        ((1 / 3, 2 / 3, -2 / 3), (0.2, 0.05, 0.02)),  # p0 of a ball over P, E* and R
        ((-3, -6, 6), (0.2, 0.05, 0.02)),  # its life: heavy tail
    ],
)
def test_indices_are_those_of_the_closed_form(exponents, deviations):
    sampler = make_sampler(power_law(*exponents), deviations=deviations)
    found = percentiles._indices(sampler, 16)[0]
    exact = np.stack(exact_indices(exponents, deviations), axis=1)
    # the model is exact: rounding
    assert found == pytest.approx(np.repeat(exact[..., None], 3, axis=-1), abs=1e-10)


def test_indices_of_a_polynomial_are_exact_although_its_sign_changes():
    """y = x1 + x2 + x1 x2 of normal keys: variances 1, 1 and 1 of its three terms."""
    sampler = make_sampler(
        ClosedForm(lambda x: np.prod(1.0 + np.log(x) / 0.1, axis=1)), deviations=(0.1, 0.1)
    )
    found = percentiles._indices(sampler, 16)[0, :, :, 0]
    assert found == pytest.approx(np.array([[1 / 3, 2 / 3], [1 / 3, 2 / 3]]), abs=1e-10)


FACTORS = (
    lambda z: np.exp(-0.6 * z),
    lambda z: 1.0 + 0.5 * np.tanh(2.0 * z),
    lambda z: np.exp(0.3 * z),
)
"""Factors of an outcome that no quadratic function describes, over the scores of its keys."""


def test_intervals_of_indices_contain_them_as_often_as_stated():
    nodes, weights = np.polynomial.hermite_e.hermegauss(150)
    values = [one(nodes) for one in FACTORS]
    means = [weights @ one / weights.sum() for one in values]
    v = np.array([weights @ (f / m - 1.0) ** 2 / weights.sum()
                  for f, m in zip(values, means, strict=True)])  # fmt: skip
    whole = np.prod(1.0 + v)
    exact = np.stack([v, v / (1.0 + v) * whole], axis=1) / (whole - 1.0)
    formula = ClosedForm(
        lambda x: np.prod([one(np.log(x[:, k]) / 0.1) for k, one in enumerate(FACTORS)], axis=0)
    )
    covered, errors = [], []
    for seed in range(25):
        sampler = make_sampler(formula, deviations=(0.1, 0.1, 0.1), seed=seed)
        found = percentiles._indices(sampler, 256)[0]
        covered.append((found[..., 1] <= exact) & (exact <= found[..., 2]))
        errors.append(found[..., 0] - exact)
    # 150 intervals of 25 samples, some of them with the least width: 96 to 99 %
    assert 0.93 <= np.mean(covered) < 1.0
    assert np.sqrt(np.mean(np.square(errors))) < 0.05  # is .034


def test_total_indices_of_ten_keys_and_a_life_need_few_samples():
    """Life over ten log-normal keys, with a bend that no exponential of a quadratic has."""
    s = np.array([0.6, 0.5, 0.4, 0.3, 0.2, 0.2, 0.1, 0.1, 0.05, 0.05])
    keys = [f"wear.coefficient.{one}" for one in "AB"] + ["load.normal"]
    keys += [f"creepage.{one}" for one in ("longitudinal", "lateral", "spin")]
    keys += [f"body.{one}.{name}" for one in "AB" for name in ("radius_x", "young")]
    uncertain = [{"key": key, "distribution": "lognormal", "median": 1.0, "factor": math.exp(0.1)}
                 for key in keys]  # fmt: skip
    table = {"scene": "twin-discs", "observe": "Qx"}
    design = ts.SpreadDesign(spread=table, uncertain=uncertain)
    life = ClosedForm(lambda x: np.exp(np.log(x) / 0.1 @ s + 0.1 * np.abs(np.log(x[:, 0]) / 0.1)))
    inputs, matrix = design.inputs()
    sampler = percentiles.Sampler(design.spread, inputs, matrix, life, life)
    found = percentiles._indices(sampler, 32)[0, :, 1]
    # the factor of the first key in closed form: means of exp(a z + b |z|)
    means = [sum(stats.norm.cdf(b + c) * math.exp(0.5 * (b + c) ** 2) for c in (a, -a))
             for a, b in ((0.6, 0.1), (1.2, 0.2))]  # fmt: skip
    growth = np.append(means[1] / means[0] ** 2, np.exp(s[1:] ** 2))
    exact = (1.0 - 1.0 / growth) * growth.prod() / (growth.prod() - 1.0)
    assert life.evaluated == 12 * 32
    assert found[:, 0] == pytest.approx(exact, abs=0.05)  # the required accuracy; is .02
    assert ((found[:, 1] <= exact) & (exact <= found[:, 2])).sum() >= 8  # of ten; nine are expected


def test_moments_are_those_of_the_closed_form():
    sampler = make_sampler(power_law(1, 1))
    (measure,), *_ = sampler.measures(512)
    (mean, _, _), (sd, low, high) = measure.moments(0.95)
    s2 = 0.2**2 + 0.1**2
    assert mean == pytest.approx(np.exp(0.5 * s2), rel=1e-3)  # error of 8192 points
    assert sd**2 == pytest.approx(np.exp(s2) * np.expm1(s2), rel=0.01)  # the required 1 %
    assert low < sd < high


def count_covered(sampler, repeats, n, levels):
    """Return in what shares of repeats the intervals contain percentiles of a product."""
    normal = stats.norm.ppf(np.array(levels))
    covered = np.zeros(len(levels))
    for seed in range(repeats):
        one = replace(sampler, table=sampler.table.model_copy(update={"seed": seed}))
        (measure,), *_ = one.measures(n)
        for k, p in enumerate(levels):
            _, low, high = measure.percentile(p, 0.95)
            covered[k] += low <= np.exp(np.hypot(0.2, 0.1) * normal[k]) <= high
    return covered / repeats


def test_intervals_of_percentiles_contain_them_as_often_as_stated():
    sampler = make_sampler(power_law(1, 1))
    shares = count_covered(sampler, 200, 16, (0.05, 0.5, 0.95))
    # of 200 repeats, 95 % are contained within 1.5 % (one standard deviation) each
    assert 0.93 <= shares.mean() <= 0.97
    assert shares.min() >= 0.91


def coarse_and_fine(ripple=0.005, waves=40.0):
    """Return a formula, and the same with the error of a coarse mesh: 5 %, and a ripple."""
    return power_law(1, 1), ClosedForm(
        lambda x: 0.95 * np.prod(x, axis=1) * (1.0 + ripple * np.sin(waves * x[:, 0]))
    )


def test_two_levels_have_the_result_of_the_fine_mesh():
    sampler = make_sampler(*coarse_and_fine(), coarse=0.5)
    (measure,), *_ = sampler.measures(64)
    assert measure.percentile(0.5, 0.95)[0] == pytest.approx(1.0, rel=0.01)  # not 5 % less


def test_intervals_of_two_levels_contain_percentiles_as_often_as_stated():
    errors = ((0.005, 40.0), (0.02, 7.0), (0.1, 40.0))
    shares = np.array([
        count_covered(make_sampler(*coarse_and_fine(*one), coarse=0.5), 60, 16, (0.05, 0.5, 0.95))
        for one in errors
    ])  # fmt: skip
    # 180 repeats of three percentiles: 95 % are contained within 1.2 % (one standard deviation)
    assert 0.93 <= shares.mean() <= 0.975
    assert shares.min() >= 0.90


def test_two_levels_need_fewer_fine_runs_for_the_same_accuracy():
    two, one = make_sampler(*coarse_and_fine(), coarse=0.5), make_sampler(power_law(1, 1))
    exact = np.exp(np.hypot(0.2, 0.1) * stats.norm.ppf(0.95))
    errors, pairs = [], 0
    for seed in range(30):
        for sampler in (two, one):
            table = sampler.table.model_copy(update={"seed": seed})
            (measure,), *_, runs = replace(sampler, table=table).measures(32)
            errors.append(measure.percentile(0.95, 0.95)[0] - exact)
            pairs = max(pairs, runs)
    of_two, of_one = np.sqrt(np.mean(np.square(np.reshape(errors, (-1, 2))), axis=0))
    assert of_two < 1.15 * of_one  # 30 repeats know an error to 13 %
    assert 4 * pairs <= 32  # four times fewer are required


def test_correlated_keys_are_one_cause():
    pair = {"keys": list(KEYS[:2]), "value": 0.6}
    sampler = make_sampler(power_law(1, 1, 1), deviations=(0.2, 0.1, 0.1), correlation=[pair])
    assert sampler.cause_names == ["load.normal & friction.mu", "creepage.spin"]
    x = np.log(sampler.values(sampler.scores(256)[0]).reshape(-1, 3))
    assert np.corrcoef(x.T)[0, 1] == pytest.approx(0.6, abs=0.01)  # 4096 points
    found = percentiles._indices(sampler, 256)[0, :, 0, 0]
    v = np.array([0.2**2 + 0.1**2 + 2 * 0.6 * 0.2 * 0.1, 0.1**2])
    assert found == pytest.approx(np.expm1(v) / np.expm1(v.sum()), abs=0.01)


@pytest.mark.parametrize(
    ("entries", "law"),
    [
        ({"distribution": "normal", "mean": 2.0, "sd": 0.5}, stats.norm(2.0, 0.5)),
        ({"distribution": "normal", "mean": -2.0, "relative": 0.25}, stats.norm(-2.0, 0.5)),
        ({"distribution": "lognormal", "median": 2.0, "factor": 1.3},
         stats.lognorm(np.log(1.3), scale=2.0)),
        ({"distribution": "uniform", "low": 1.0, "high": 3.0}, stats.uniform(1.0, 2.0)),
        ({"distribution": "triangular", "low": 1.0, "mode": 1.5, "high": 3.0},
         stats.triang(0.25, 1.0, 2.0)),
        ({"distribution": "table", "values": [1.0, 2.0, 4.0]},
         stats.rv_histogram(([1, 1], [1.0, 2.0, 4.0]), density=False)),
        ({"distribution": "normal", "mean": 2.0, "sd": 0.5, "lower": 2.0},
         stats.truncnorm(0.0, np.inf, 2.0, 0.5)),
    ],
)  # fmt: skip
def test_values_have_their_distribution(entries, law):
    table = Uncertain(key="creepage.spin", **entries)
    found = Input.from_table(table, ts.Scene.builtin("spheres"))
    p = np.linspace(0.01, 0.99, 9)
    assert found.values(stats.norm.ppf(p)) == pytest.approx(law.ppf(p), rel=1e-9)  # rounding


def test_failed_samples_are_counted_and_bound_the_percentiles():
    limit = np.exp(0.2 * 1.5)
    fails = ClosedForm(lambda x: np.where(x[:, 0] > limit, np.nan, x[:, 0]))
    sampler = make_sampler(fails, deviations=(0.2,))
    measures, _, messages, _ = sampler.measures(64)
    count, bounds = percentiles._describe_failures(sampler.table, measures, messages)
    share = np.count_nonzero(messages) / messages.size
    assert share == pytest.approx(stats.norm.sf(1.5), abs=0.005)  # 1024 points
    assert f"{np.count_nonzero(messages)} of 1024 samples failed" in count
    low, high = (float(x) for x in bounds.split("50: ")[1].split(";")[0].split(" to "))
    assert low < 0.99
    assert high == pytest.approx(1.0, abs=0.01)  # the median of all: 1024 points
    assert "95: " in bounds
    assert bounds.endswith("inf")


@pytest.fixture(scope="module")
def slipping(spheres):
    """Two spheres in full slip: Q = mu P."""
    changes = {"creepage.longitudinal": -0.05, "grid.elements": (13, 13)}
    return spheres.replace(**changes, grid=None).replace(**{"grid.elements": (13, 13)})


UNCERTAIN = [
    {"key": "load.normal", "distribution": "lognormal", "factor": 1.2},
    {"key": "friction.mu", "distribution": "lognormal", "factor": 1.1},
]


def design_of(scene, **table):
    shared = {"scene": scene, "observe": ["Qx", "p_max"], "samples": 32, "indices": 0}
    return {"spread": shared | table, "uncertain": UNCERTAIN}


@pytest.fixture(scope="module")
def result(slipping, tmp_path_factory):
    path = tmp_path_factory.mktemp("spread") / "spread.nc"
    said = []
    ts.spread(design_of(slipping, indices=16), path, say=said.append)
    assert len(said) == 2
    return ts.open_spread(path), path


def test_full_slip_scatters_as_mu_p(result):
    found, _ = result
    samples = found.numbers("sample")
    # full slip but for the ends of the contact on 13 x 13 elements
    assert found.numbers("sample_outcome")[:, 0] == pytest.approx(samples.prod(axis=1), rel=1e-4)
    s = np.hypot(np.log(1.2), np.log(1.1))
    # differences over 1.645 deviations of a logarithm: the linear estimate is 1.5 % too large
    assert found.numbers("linear_sd")[0] == pytest.approx(s * found.numbers("nominal")[0], rel=0.03)
    low, high = found.interval("Qx", 50)
    assert low < found.numbers("nominal")[0] < high


def test_hertz_pressure_scatters_as_the_cube_root_of_the_load(result):
    found, _ = result
    pressure, load = found.numbers("sample_outcome")[:, 1], found.numbers("sample")[:, 0]
    slope = np.polyfit(np.log(load), np.log(pressure), 1)[0]
    assert slope == pytest.approx(1 / 3, abs=0.003)  # mesh of 13 x 13
    share = found.numbers("linear_share")[1] / found.numbers("linear_sd")[1] ** 2
    assert share == pytest.approx([1.0, 0.0], abs=1e-6)  # friction does not change the pressure


def test_exact_derivatives_need_no_further_run(slipping):
    scene = slipping.replace(**{"creepage.longitudinal": -1e-3})
    table = {"scene": scene, "observe": "Qx", "samples": 16, "indices": 0, "mesh_check": False}
    found = ts.spread({"spread": table, "uncertain": UNCERTAIN})
    assert "18 contacts" in found.summary()["cost"]  # 16 samples, the centre, and its Jacobian
    table |= {"observe": ["Qx", "p_max"]}  # a pressure has no exact derivative
    more = ts.spread({"spread": table, "uncertain": UNCERTAIN})
    # secants over 1.645 deviations and tangents at the medians differ by their squares
    assert found.numbers("linear_sd")[0] == pytest.approx(more.numbers("linear_sd")[0], rel=0.05)


def test_a_second_run_computes_nothing(result, slipping, monkeypatch):
    found, path = result
    monkeypatch.setattr("tractive_sam.fitting.case.compute", None)
    again = ts.spread(design_of(slipping, indices=16), path)
    assert again.numbers("quantile") == pytest.approx(found.numbers("quantile"), rel=0)
    with pytest.raises(ResultsError, match=r"load.normal.*--overwrite"):
        ts.spread(design_of(slipping.replace(**{"load.normal": 1.0})), path)


def test_an_interrupted_spread_resumes(slipping, tmp_path, monkeypatch):
    computed, compute = [], case.compute

    def interrupted(one, start=None):
        computed.append(one)
        if len(computed) == 20:
            raise KeyboardInterrupt
        return compute(one, start)

    monkeypatch.setattr("tractive_sam.fitting.case.compute", interrupted)
    path = tmp_path / "part.nc"
    with pytest.raises(KeyboardInterrupt):
        ts.spread(design_of(slipping), path)
    part = ts.open_spread(path)
    assert part.status == "running"
    assert "resume" in part.message
    assert part.keys == ()
    ts.spread(design_of(slipping), path)
    assert len(computed) == 20 + 32 + 6 - 19  # centre on two meshes, and four differences


def test_samples_are_added_until_the_percentile_is_accurate(slipping):
    accuracy = {"observe": "Qx", "percentile": 50, "relative": 0.02}
    found = ts.spread(design_of(slipping, samples=16, accuracy=accuracy))
    low, high = found.interval("Qx", 50)
    assert 0.5 * (high - low) <= 0.02 * found.percentile("Qx", 50)
    assert len(found.numbers("sample")) > 16
    found = ts.spread(design_of(slipping, samples=16, most=16, accuracy=accuracy))
    assert found.status == "accuracy not reached"
    assert any("spread.most" in note for note in found.notes)


def test_the_life_of_a_steady_contact_scatters(discs):
    fatigue = {"limit": 300.0, "sensitivity": 0.3, "elements": 12, "bodies": ["A"]}
    changes = {"wear": None, "grid": None, "creepage.longitudinal": 0.0}
    scene = discs.replace(fatigue=fatigue, **changes)
    table = {"scene": scene, "observe": "fatigue_life A", "samples": 16, "indices": 0}
    load = {"key": "load.normal", "distribution": "lognormal", "factor": 1.1}
    found = ts.spread({"spread": table | {"mesh_check": False}, "uncertain": [load]})
    life, p = np.log(found.numbers("sample_outcome")[:, 0]), np.log(found.numbers("sample")[:, 0])
    # life ~ p0^-10 ~ P^(-10/3) of a utilisation in proportion to p0
    assert np.polyfit(p, life, 1)[0] == pytest.approx(-10 / 3, rel=0.03)


def test_percentiles_over_revolutions(discs):
    table = {"scene": discs, "observe": ["wear_max", "worn_mass A"], "at": [1, 5]}
    table |= {"samples": 16, "indices": 0, "mesh_check": False}
    k = {"key": "wear.coefficient.A", "distribution": "lognormal", "factor": 1.3}
    found = ts.spread({"spread": table, "uncertain": [k]})
    assert found.texts("outcome") == (
        "wear_max at 1", "wear_max at 5", "worn_mass A at 1", "worn_mass A at 5",
    )  # fmt: skip
    assert (np.diff(found.numbers("quantile")[:2], axis=0) > 0.0).all()
    assert "band-wear_max" in [one.name for one in found.drawings()]


def test_a_fit_gives_its_covariance(spheres, tmp_path):
    truth = {"friction.mu": 0.35}
    free = ["friction.mu", "load.normal"]
    data = [creep_data(spheres, truth), creep_data(spheres, truth) | {"observe": "p_max"}]
    data[1]["values"] = {"creepage.longitudinal": [-1e-3], "p_max": [0.018]}
    found = ts.fit({"scene": spheres, "free": free, "data": data}, tmp_path / "fit.nc")
    (tmp_path / "s.toml").write_text(
        '[spread]\nscene = "spheres"\nobserve = "Qx"\n[[uncertain]]\nfrom = "fit.nc"\n'
    )
    inputs, matrix = ts.SpreadDesign.from_toml(tmp_path / "s.toml").inputs()
    assert [one.key for one in inputs] == free
    assert matrix == pytest.approx(found.correlation, abs=1e-12)
    x = inputs[0].values(np.array([-1.0, 0.0, 1.0]))
    assert x[1] == pytest.approx(found.values["friction.mu"])
    assert np.log(x[2] / x[0]) == pytest.approx(2 * found.sd["friction.mu"] / x[1])
    part = found.dataset.drop_vars("value").assign_attrs(status="running")
    write_fit(tmp_path / "fit.nc", type(found)(part))
    with pytest.raises(ts.SpreadError, match="complete fit"):
        ts.SpreadDesign.from_toml(tmp_path / "s.toml").inputs()


def uncertain(**entries):
    return {"uncertain": [{"key": "friction.mu", "distribution": "normal"} | entries]}


NORMAL = uncertain(sd=0.01)["uncertain"][0]
BAD = {
    "nothing uncertain": ({}, {"uncertain": []}, "uncertain"),
    "no scene": ({"scene": "sphere"}, {}, "spread.scene"),
    "an unknown column": ({"observe": "Qz"}, {}, "spread.observe"),
    "a column without its body": ({"observe": "worn_mass"}, {}, "spread.observe"),
    "a body that a column has not": ({"observe": "Qx A"}, {}, "spread.observe"),
    "a profile": ({"observe": "wear_profile_A"}, {}, "spread.observe"),
    "a percentile of 100": ({"percentiles": [100.0]}, {}, "spread.percentiles"),
    "too few samples": ({"samples": 8}, {}, "spread.samples"),
    "fewer samples than the first": ({"samples": 64, "most": 32}, {}, "spread.most"),
    "an accuracy of another outcome": (
        {"accuracy": {"observe": "Qy", "relative": 0.1}}, {}, "spread.accuracy.observe"),
    "an accuracy of nothing": ({"accuracy": {"relative": 0.0}}, {}, "spread.accuracy.relative"),
    "a mesh that is no coarser": ({"coarse": 1.5}, {}, "spread.coarse"),
    "an unknown key": ({}, uncertain(key="friction.mew", sd=0.1), "uncertain[0].key"),
    "a key with a text": ({}, uncertain(key="solver.method", sd=0.1), "uncertain[0].key"),
    "a key twice": ({}, {"uncertain": [NORMAL, NORMAL]}, "uncertain[1].key"),
    "no distribution": ({}, {"uncertain": [{"key": "friction.mu"}]}, "uncertain[0].distribution"),
    "an unknown distribution": ({}, uncertain(distribution="beta"), "uncertain[0].distribution"),
    "no deviation": ({}, uncertain(), "uncertain[0].sd"),
    "two deviations": ({}, uncertain(sd=0.1, relative=0.1), "uncertain[0].sd"),
    "a parameter of another distribution": ({}, uncertain(sd=0.1, low=0.1), "uncertain[0].low"),
    "bounds the wrong way round": (
        {}, uncertain(distribution="uniform", low=0.4, high=0.3), "uncertain[0].high"),
    "a mode outside": (
        {}, uncertain(distribution="triangular", low=0.5, high=0.6), "uncertain[0].key"),
    "a median below 0": ({}, uncertain(key="creepage.longitudinal", distribution="lognormal",
                                       factor=1.2), "uncertain[0].key"),
    "a factor of 1": ({}, uncertain(distribution="lognormal", factor=1.0), "uncertain[0].factor"),
    "a cut that leaves nothing": ({}, uncertain(sd=0.01, lower=9.0), "uncertain[0].key"),
    "a table that falls": (
        {}, uncertain(distribution="table", values=[0.3, 0.2]), "uncertain[0].values"),
    "probabilities that do not reach 1": (
        {}, uncertain(distribution="table", values=[0.2, 0.3], probability=[0.0, 0.9]),
        "uncertain[0].probability"),
    "a key and a fit": ({}, {"uncertain": [{"key": "friction.mu", "from": "fit.nc"}]},
                        "uncertain[0].fit"),
    "a correlation of a certain key": (
        {}, {"correlation": [{"keys": ["friction.mu", "load.normal"], "value": 0.5}]},
        "correlation[0].keys"),
    "a correlation above 1": (
        {}, {"correlation": [{"keys": ["friction.mu", "load.normal"], "value": 1.5}]},
        "correlation[0].value"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_a_fault_of_the_file_is_reported_by_its_key(case):
    table, tables, key = BAD[case]
    entries = {"spread": {"scene": "spheres", "observe": "Qx"} | table, "uncertain": [NORMAL]}
    with pytest.raises(ts.SpreadError) as caught:
        ts.SpreadDesign(**entries | tables)
    keys = [fault.key for fault in caught.value.faults]
    assert any(one.startswith(key) for one in keys), keys
    assert all(fault.allowed for fault in caught.value.faults)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"at": [1.0]}, "at"),  # a single contact has no revolutions
        ({"observe": "worn_mass A"}, "spread.observe"),
        ({"observe": "utilisation A"}, "spread.observe"),
    ],
)
def test_a_fault_of_the_outcomes_is_reported_before_anything_is_computed(
    slipping, change, key, monkeypatch
):
    monkeypatch.setattr("tractive_sam.fitting.case.compute", None)
    with pytest.raises(ts.SpreadError) as caught:
        ts.spread(design_of(slipping, **change))
    assert any(key in fault.key for fault in caught.value.faults)


def test_correlations_that_cannot_be_are_refused():
    three = [{"key": key, "distribution": "normal", "mean": 0.3, "sd": 0.1} for key in KEYS]
    pairs = [(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]
    correlation = [{"keys": [KEYS[i], KEYS[j]], "value": c} for i, j, c in pairs]
    table = {"scene": "spheres", "observe": "Qx"}
    design = ts.SpreadDesign(spread=table, uncertain=three, correlation=correlation)
    with pytest.raises(ts.SpreadError, match="positive definite"):
        design.inputs()


def test_medians_that_fail_are_an_error(slipping):
    load = {"key": "load.normal", "distribution": "normal", "mean": -1.0, "sd": 1e-6}
    with pytest.raises(ts.SpreadError, match=r"load\.normal"):
        ts.spread({"spread": {"scene": slipping, "observe": "Qx"}, "uncertain": [load]})


@pytest.mark.parametrize("name", ["quantile", "first", "sample", "input", "notes"])
def test_a_file_without_its_numbers_is_damaged(result, name, tmp_path):
    found, _ = result
    path = tmp_path / "spread.nc"
    write_netcdf(path, found.dataset.drop_vars(name))
    with pytest.raises(ResultsError, match=name):
        ts.open_spread(path)


def test_other_files_are_refused(result, tmp_path):
    found, path = result
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    (tmp_path / "flipped.nc").write_bytes(content)
    with pytest.raises(ResultsError, match="damaged"):
        ts.open_spread(tmp_path / "flipped.nc")
    write_netcdf(tmp_path / "next.nc", found.dataset.assign_attrs(format="spread 9"))
    with pytest.raises(ResultsError, match="spread 9"):
        ts.open_spread(tmp_path / "next.nc")
    with pytest.raises(ResultsError, match="does not exist"):
        ts.open_spread(tmp_path / "none.nc")


def test_commands_show_draw_and_report(result, tmp_path, monkeypatch):
    _, path = result
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    shown = json.loads(runner.invoke(app, ["show", str(path), "--json"]).stdout)
    assert shown["input"] == ["load.normal", "friction.mu"]
    text = runner.invoke(app, ["show", str(path)]).stdout
    assert "load.normal" in text
    plotted = runner.invoke(app, ["plot", str(path), "-o", "figures"])
    assert sorted(one.name for one in (tmp_path / "figures").iterdir()) == sorted(
        line.rpartition("/")[2] for line in plotted.stdout.split()
    )
    assert runner.invoke(app, ["report", str(path), "-o", "page.html"]).exit_code == 0
    assert "log-normal" in (tmp_path / "page.html").read_text("utf-8")
    assert runner.invoke(app, ["show", str(path), "--csv"]).exit_code == 2


def test_the_command_computes_and_explains(slipping, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    (tmp_path / "scene.toml").write_text(slipping.to_toml())
    (tmp_path / "s.toml").write_text(
        '[spread]\nscene = "scene.toml"\nobserve = "Qx"\nsamples = 16\nindices = 0\n'
        '[[uncertain]]\nkey = "friction.mu"\ndistribution = "normal"\nrelative = 0.1\n'
    )
    explained = runner.invoke(app, ["explain", "s.toml"])
    assert "normal, 0.4013" in explained.stdout
    assert runner.invoke(app, ["spread", "s.toml", "-o", "s.h5"]).exit_code == 2
    done = runner.invoke(app, ["spread", "s.toml", "-o", "s.nc"])
    assert done.exit_code == 0, done.output
    assert "linear estimate" in done.output
    assert ts.open_spread("s.nc").finished


@pytest.mark.slow
def test_workers_of_a_scheduler_compute_the_same(slipping, tmp_path, monkeypatch):
    """A spread and a design, on a scheduler with one worker on this machine."""
    distributed = pytest.importorskip("distributed", reason="it is of the extra study")
    monkeypatch.setattr(case, "InWorkers", partial(case.InWorkers, worthwhile=0.0))
    free = [{"key": "load.normal", "lower": 0.3, "upper": 1.0}]
    table = {"scene": slipping, "minimise": "p_max", "free": free, "mesh_check": False}
    options = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster:
        address = cluster.scheduler_address
        found = ts.spread(design_of(slipping), tmp_path / "s.nc", scheduler=address)
        best = ts.design(table, tmp_path / "d.nc", scheduler=address)
        spread_file = tmp_path / "s.toml"
        spread_file.write_text(found.design.to_toml())
        options = ["-o", str(tmp_path / "c.nc"), "--scheduler", address]
        outcome = CliRunner().invoke(app, ["spread", str(spread_file), *options])
    assert outcome.exit_code == 0, outcome.output
    serial = ts.spread(design_of(slipping))
    # contacts of one group start from each other, whose order the processes change: tolerance
    assert found.numbers("sample_outcome") == pytest.approx(
        serial.numbers("sample_outcome"), rel=1e-6
    )
    assert best.values == ts.design(table).values == {"load.normal": 0.3}
    assert ts.open_spread(tmp_path / "c.nc").numbers("quantile") == pytest.approx(
        serial.numbers("quantile"), rel=1e-6
    )
    with pytest.raises(SchedulerLostError, match=r"127\.0\.0\.1:9"):
        ts.spread(design_of(slipping, seed=1), scheduler="tcp://127.0.0.1:9")


def test_labels_of_outcomes_have_symbols_bodies_and_units_of_the_scene():
    scene = ts.Scene.builtin("cylinders")
    labels = [label_of(name, scene) for name in ("Qx", "worn_mass A at 5", "p_max, scene 2")]
    assert labels == [
        "$Q_x$ (N/mm)",
        "worn mass of body A at 5 (mg/mm)",
        r"$p_\mathrm{max}$, scene 2 (MPa)",
    ]
