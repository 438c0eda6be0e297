"""Fits: coefficients of measured twin discs, coverage of intervals, and cost.

Page: docs/howto/fit.md

The eight measured powers are the values in experiment.py. Synthetic tests are repeated with normal
noise; the 95 % interval should contain the true value in 92 to 98 % of them. The script takes about
seven minutes on one process.

    python benchmarks/fit.py            # all
    python benchmarks/fit.py powers     # one of powers, exact, repeats, cost, posterior

The posterior needs emcee, of the extra benchmarks.
"""

import sys
import warnings
from time import process_time

import numpy as np
from scipy.interpolate import RectBivariateSpline
from timing import show, write

import tractive_sam as ts
from tractive_sam.fitting import log_posterior
from tractive_sam.validation.experiment import HEAT, SCENE, SLIP, SPEED, TRACK

warnings.simplefilter("ignore", ts.SceneWarning)  # coarse meshes and 20 % of slip are meant

REPEATS = 200
STEPS = (0, 1, 2, 4, 8, 16, 30, 60, 120, 240, 480, 1000, 2000, 3000)

DISCS = (
    ts.Scene.builtin("twin-discs")
    .replace(
        subsurface=None,
        wear={
            "coefficient": {"A": 1.3e-4, "B": 2.2e-4},
            "revolutions": STEPS[-1],
            "save": STEPS,
            "stepping": "saved",
            "turns": "equal",
        },
    )
    .replace(**{"grid.elements": (13, 27)})
)
LINE = SCENE.replace(**{"grid.half_length": 0.36, "grid.elements": 101})
FRICTION = {"friction.mu": 0.46, "friction.layer": 1.7e-6}
WEAR = {"wear.coefficient.A": 1.3e-4, "wear.coefficient.B": 2.2e-4}


def creep(scene: ts.Scene, power: np.ndarray, **more) -> dict:
    """Return a fit of friction and layer to the frictional work per distance, N/mm."""
    columns = {"creepage.longitudinal": -SLIP, "t_gamma": power}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "t_gamma"}
    start = [{"key": "friction.layer", "start": 1e-6}]
    return {"scene": scene, "free": list(FRICTION), "data": [data | {"noise": 0.05}]} | {
        "parameter": start, **more
    }  # fmt: skip


def power_of(scene: ts.Scene, mu: float, layer: float) -> np.ndarray:
    """Return the frictional work per distance for each slip, N/mm, shape (8,)."""
    scene = scene.replace(**{"friction.mu": mu, "friction.layer": layer})
    scenes = (scene.replace(**{"creepage.longitudinal": -slip}) for slip in SLIP)
    return np.array([ts.solve(scene).t_gamma for scene in scenes])


def powers() -> None:
    """Fit friction and layer to the measured powers, and compare with a grid of chi-square."""
    measured = np.array(HEAT, float) * 1e3 / (SPEED * TRACK)
    result = ts.fit(creep(SCENE, measured, curve=0))
    scattered = ts.fit(creep(SCENE, measured, scatter=True, mesh_check=False, curve=0))
    before = power_of(SCENE, 0.463, 0.0) / measured
    after = result.dataset["predicted"].values / measured
    noise = 0.05 * result.dataset["predicted"].values  # of the prediction, as in the fit
    mu = np.linspace(0.43, 0.50, 15)
    layers = np.linspace(1.0e-6, 2.6e-6, 17)
    chi2 = np.array(
        [[np.square((power_of(SCENE, m, c) - measured) / noise).sum() for c in layers] for m in mu]
    )
    # Between the points of the grid chi-square is a cubic spline; it is rough by the mesh.
    axes = [np.linspace(values[0], values[-1], 401) for values in (mu, layers)]
    dense = RectBivariateSpline(mu, layers, chi2)(*axes)
    best = np.unravel_index(dense.argmin(), dense.shape)
    grid = [axis[k] for axis, k in zip(axes, best, strict=True)]
    # Profiles of chi-square rise by one at one standard deviation.
    inside = dense - dense.min() < 1.0
    deviation = [0.5 * np.ptp(axis[inside.any(axis=1 - k)]) for k, axis in enumerate(axes)]
    weights = np.exp(-0.5 * (dense - dense.min()))
    places = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
    covariance = np.cov(places, aweights=weights.ravel())
    correlation = covariance[0, 1] / np.sqrt(covariance.diagonal().prod())
    rows = []
    for k, key in enumerate(FRICTION):
        rows.append(
            {
                "key": key,
                "fit": result.values[key],
                "sd": result.sd[key],
                "sd by scatter": scattered.sd[key],
                "grid": grid[k],
                "sd of grid": deviation[k],
                "correlation": result.correlation[0, 1],
                "of grid": correlation,
                "contacts": result.solves,
                "contacts of grid": chi2.size * SLIP.size,
            }
        )
    write("fit_powers", rows)
    show("The measured powers: fit and grid of chi-square", rows)
    ratios = [
        {"slip": slip, "without layer": without_layer, "fitted": fitted}
        for slip, without_layer, fitted in zip(SLIP, before, after, strict=True)
    ]
    write("fit_ratios", ratios)
    show("Predicted / measured power", ratios)
    print(f"chi-square {result.chi2:.3g}, of the grid {chi2.min():.3g}")


def worn(masses: np.ndarray, profile: np.ndarray, y: np.ndarray) -> dict:
    """Return a fit of the coefficients to three weighings of A and a profile of B."""
    weighed = {"revolution": [1000, 2000, 3000], "worn_mass": masses}
    sets = [
        {"values": weighed, "vary": "revolution", "observe": "worn_mass", "body": "A",
         "noise": {"absolute": 0.02}},
        {"values": {"y": y, "depth": profile}, "observe": "wear_profile", "body": "B",
         "noise": {"absolute": 1e-4}},
    ]  # fmt: skip
    return {"scene": DISCS, "free": list(WEAR), "data": sets, "mesh_check": False, "curve": 0}


def exact() -> None:
    """Fit data without noise from other initial values, and return relative errors."""
    rows = []
    result = ts.fit(creep(LINE, power_of(LINE, *FRICTION.values()), mesh_check=False, curve=0))
    rows += _errors(result, FRICTION)
    history = ts.roll(DISCS, progress=False)
    masses = history["worn_mass"][[STEPS.index(n) for n in (1000, 2000, 3000)], 0]
    design = worn(masses, history["wear_profile_B"][-1], history.y)
    design["parameter"] = [{"key": key, "start": 0.7 * value} for key, value in WEAR.items()]
    rows += _errors(ts.fit(design), WEAR)
    law = {"law": "exponential", "static": 0.5, "kinetic": 0.25, "half_speed": 20.0}
    falling = LINE.replace(**{"creepage.speed": 1e3, "friction": law})
    forces = [
        ts.solve(falling.replace(**{"creepage.longitudinal": -slip})).Qx / falling.normal_load
        for slip in SLIP
    ]
    columns = {"creepage.longitudinal": -SLIP, "Qx_over_P": forces}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    truth = {f"friction.{name}": law[name] for name in ("static", "kinetic", "half_speed")}
    design = {"scene": falling, "free": list(truth), "data": [data | {"noise": 0.05}], "curve": 0}
    design["parameter"] = [
        {"key": key, "start": factor * value}
        for (key, value), factor in zip(truth.items(), (0.9, 0.9, 1.25), strict=True)
    ]
    rows += _errors(ts.fit(design), truth)
    write("fit_exact", rows)
    show("Data without noise", rows)


def _errors(result: ts.FitResult, truth: dict[str, float]) -> list[dict]:
    return [
        {"key": key, "truth": value, "error": result.values[key] / value - 1.0,
         "contacts": result.solves, "rolls": result.rolls}
        for key, value in truth.items()
    ]  # fmt: skip


def repeats() -> None:
    """Count how often the intervals contain the true values."""
    rng = np.random.default_rng(1)
    power = power_of(LINE, *FRICTION.values())
    history = ts.roll(DISCS, progress=False)
    masses = history["worn_mass"][[STEPS.index(n) for n in (1000, 2000, 3000)], 0]
    depth, y = history["wear_profile_B"][-1], history.y

    def creep_repeat() -> ts.FitResult:
        noisy = power * (1.0 + 0.05 * rng.standard_normal(power.size))
        return ts.fit(creep(LINE, noisy, mesh_check=False, curve=0))

    def worn_repeat() -> ts.FitResult:
        noisy = masses + 0.02 * rng.standard_normal(masses.size)
        return ts.fit(worn(noisy, depth + 1e-4 * rng.standard_normal(depth.size), y))

    rows = []
    for name, repeat, truth in (
        ("creep curve", creep_repeat, FRICTION),
        ("masses and profile", worn_repeat, WEAR),
    ):
        began, inside = process_time(), dict.fromkeys(truth, 0)
        chi2, solves, rolls = [], 0, 0
        for _ in range(REPEATS):
            result = repeat()
            for key, value in truth.items():
                low, high = result.interval(key)
                inside[key] += low <= value <= high
            low, high = result.chi2_range
            chi2.append(low <= result.chi2 <= high)
            solves, rolls = solves + result.solves, rolls + result.rolls
        rows += [
            {"test": name, "key": key, "covered %": 100.0 * count / REPEATS,
             "chi-square expected %": 100.0 * np.mean(chi2), "contacts": solves / REPEATS,
             "rolls": rolls / REPEATS, "s": (process_time() - began) / REPEATS}
            for key, count in inside.items()
        ]  # fmt: skip
    write("fit_repeats", rows)
    show(f"Intervals of 95 % in {REPEATS} repeats", rows)


def cost() -> None:
    """Count contacts of a creep curve with and without exact derivatives, and runs of a test."""
    measured = np.array(HEAT, float) * 1e3 / (SPEED * TRACK)
    design = creep(SCENE, measured, mesh_check=False, curve=0)
    rows = [_cost("creep curve, mu exact", ts.fit(design))]
    # A strength that is never reached has no exact derivative.
    alike = SCENE.replace(**{"friction.strength": 1e6})
    rows.append(_cost("creep curve, differences", ts.fit({**design, "scene": alike})))
    profile = ts.fit({**design, "intervals": "profile"})
    rows.append(_cost("creep curve, profile likelihood", profile))
    truth = {"wear.coefficient.A": 1.3e-4, "wear.coefficient.B": 2.2e-4,
             "friction.mu": 0.45, "friction.layer": 2e-6}  # fmt: skip
    adaptive = DISCS.replace(**{"wear.stepping": "adaptive", "wear.save": (0, 3000)})
    scene = adaptive.replace(
        friction={"mu": 0.45, "layer": 2e-6}, creepage={"longitudinal": -0.002}
    )
    history = ts.roll(scene.replace(**{"wear.save": (0, 1000, 2000, 3000)}), progress=False)
    rows_of = [history["revolution"].tolist().index(n) for n in (1000, 2000, 3000)]
    rng = np.random.default_rng(2)
    sets = []
    for body in "AB":
        masses = history["worn_mass"][rows_of, "AB".index(body)]
        masses = masses * (1.0 + 0.02 * rng.standard_normal(3))
        columns = {"revolution": [1000, 2000, 3000], "worn_mass": masses}
        sets.append(
            {"values": columns, "vary": "revolution", "observe": "worn_mass", "body": body}
            | {"noise": 0.02}
        )
    slips = -np.array([0.001, 0.002, 0.005, 0.02])
    forces = [ts.solve(scene.replace(**{"creepage.longitudinal": slip})).Qx for slip in slips]
    ratios = np.array(forces) / 300.0 * (1.0 + 0.02 * rng.standard_normal(4))
    columns = {"creepage.longitudinal": slips, "Qx_over_P": ratios}
    sets.append(
        {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx_over_P", "at": 0}
        | {"noise": 0.02}
    )
    start = [{"key": key, "start": 0.7 * value} for key, value in truth.items()]
    design = {"scene": scene, "free": [*truth], "data": sets, "parameter": start}
    result = ts.fit(design)
    rows.append(_cost("twin discs, four parameters", result))
    profile = ts.fit({**design, "intervals": "profile"})
    rows.append(_cost("twin discs, profile likelihood", profile))
    write("fit_cost", rows)
    show("Cost of a fit", rows)
    for key, value in truth.items():
        low, high = result.interval(key)
        print(
            f"{key}: {result.values[key]:.4g}, from {low:.4g} to {high:.4g}, true value {value:.4g}"
        )


def _cost(name: str, result: ts.FitResult) -> dict:
    attributes = result.dataset.attrs
    return {
        "fit": name,
        "iterations": int(attributes["iterations"]),
        "contacts": result.solves,
        "rolls": result.rolls,
        "convolutions": float(attributes["convolutions"]),
    }


def posterior(walkers: int = 8, steps: int = 1000) -> None:
    """Sample the posterior of a creep curve of two spheres by emcee, beside the linearised fit."""
    import emcee  # noqa: PLC0415 - of the extra benchmarks

    scene = ts.Scene.builtin("spheres").replace(subsurface=None)
    scene = scene.replace(**{"grid.elements": (17, 17)})
    truth = {"friction.mu": 0.35, "friction.layer": 0.3 * scene.hertz.a / scene.material.shear}
    slips, rng = -np.array([1e-3, 2e-3, 4e-3, 0.03]), np.random.default_rng(5)
    true = scene.replace(**truth)
    forces = [ts.solve(true.replace(**{"creepage.longitudinal": slip})).Qx for slip in slips]
    ratios = np.array(forces) / scene.normal_load * (1.0 + 0.05 * rng.standard_normal(4))
    columns = {"creepage.longitudinal": slips, "Qx_over_P": ratios}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    # Without bounds the density of a parameter that the data bound on one side only is improper.
    starts = [
        {"key": key, "start": value, "lower": 0.1 * value, "upper": 3.0 * value}
        for key, value in truth.items()
    ]
    design = {"scene": scene, "free": [*truth], "data": [data | {"noise": 0.05}]}
    design |= {"parameter": starts, "mesh_check": False, "curve": 0}
    best = ts.fit(design)
    density, start = log_posterior(design)
    sampler = emcee.EnsembleSampler(walkers, start.size, density)
    sampler.random_state = np.random.RandomState(5).get_state()
    sampler.run_mcmc(start * (1.0 + 0.05 * rng.standard_normal((walkers, start.size))), steps)
    times = sampler.get_autocorr_time(tol=0)
    warm_up = int(5 * times.max())
    samples = sampler.get_chain(discard=warm_up, flat=True)
    halves = [half.mean(axis=0) for half in np.array_split(samples, 2)]
    rows = [
        {
            "key": key,
            "truth": value,
            "fit": best.values[key],
            "sd": best.sd[key],
            "low": best.interval(key)[0],
            "high": best.interval(key)[1],
            "mean": samples[:, k].mean(),
            "sd of samples": samples[:, k].std(),
            "error of mean": samples[:, k].std() * np.sqrt(times[k] / len(samples)),
            "difference of halves": halves[1][k] - halves[0][k],
            "quantile low": np.quantile(samples[:, k], 0.025),
            "quantile high": np.quantile(samples[:, k], 0.975),
            "autocorrelation": times[k],
            "walkers": walkers,
            "steps": steps,
            "accepted": sampler.acceptance_fraction.mean(),
        }
        for k, (key, value) in enumerate(truth.items())
    ]
    write("fit_posterior", rows)
    show("Posterior samples, beside the linearised fit", rows)


PARTS = {
    "powers": powers,
    "exact": exact,
    "repeats": repeats,
    "cost": cost,
    "posterior": posterior,
}

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        PARTS[part]()
