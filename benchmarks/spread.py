"""How accurate are the percentiles and Sobol indices of a spread, and their intervals?

Page: docs/howto/spread.md

Outcomes are products of powers of log-normal keys, whose percentiles and indices are known exactly:
the force in full slip, the Hertz pressure of a ball, and a life in proportion to its ninth power.
All else is the code of `ts.spread`. A row repeats a spread with other seeds. A 95 % interval
should contain the exact value in 93 to 97 % of the repeats; the standard deviation of the share of
400 repeats is 1.1 %. Two levels of meshes have samples with an error of 5 % and a ripple of .5 %.
The second table has Sobol indices of products of factors that the model does not describe, whose
indices follow from the variance of each. The third table has total indices of the life of a
crowned, tilted roller with ten keys.

    python benchmarks/spread.py [REPEATS]
"""

import math
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.stats import norm, qmc
from timing import show, write

import tractive_sam as ts
from tractive_sam.fitting.estimators import sobol_indices
from tractive_sam.fitting.percentiles import Sampler, _indices

REPEATS = 400
LAWS = {
    "force in full slip, mu P": ((1, 1), (0.2, 0.1)),
    "Hertz pressure of a ball": ((1 / 3, 2 / 3, -2 / 3), (0.2, 0.05, 0.02)),
    "life over pressure^-9": ((-3, -6, 6), (0.2, 0.05, 0.02)),
}
"""Exponents of the keys, and standard deviations of their logarithms."""

PERCENTILES = (0.05, 0.5, 0.95)


class Formula:
    """Product of powers, evaluated as the outcome of a scene, with a relative error."""

    def __init__(self, exponents: tuple[float, ...], ripple: float = 0.0) -> None:
        self.exponents, self.ripple = np.array(exponents), ripple

    def evaluate(self, points: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """Return the outcome at points (n, d), shape (n, 1), and no messages."""
        error = 1.0 + self.ripple * (np.sin(40.0 * points[:, 0]) - 10.0)
        return (np.prod(points**self.exponents, axis=1) * error)[:, None], [""] * len(points)


def sampler_of(name: str, two_levels: bool) -> Sampler:
    """Return the sampler of a law."""
    exponents, deviations = LAWS[name]
    keys = ("load.normal", "friction.mu", "creepage.spin")
    design = ts.SpreadDesign(
        spread={"scene": "spheres", "observe": "Qx"} | ({"coarse": 0.5} if two_levels else {}),
        uncertain=[
            {"key": key, "distribution": "lognormal", "median": 1.0, "factor": float(np.exp(s))}
            for key, s in zip(keys, deviations, strict=False)
        ],
    )
    fine = Formula(exponents)
    inputs, matrix = design.inputs()
    rough = Formula(exponents, 0.005) if two_levels else fine
    return Sampler(design.spread, inputs, matrix, fine, rough)


def row_of(name: str, samples: int, repeats: int, two_levels: bool = False) -> dict[str, object]:
    """Return errors and covered shares of the percentiles and indices of a law."""
    exponents, deviations = LAWS[name]
    v = np.square(np.multiply(exponents, deviations))
    first = np.expm1(v) / np.expm1(v.sum())
    total = -np.expm1(-v) * np.exp(v.sum()) / np.expm1(v.sum())
    exact = np.exp(np.sqrt(v.sum()) * norm.ppf(PERCENTILES))
    sampler, errors, covered, index_errors, indices_covered, pairs = (
        sampler_of(name, two_levels), [], [], [], [], 0,
    )  # fmt: skip
    for seed in range(repeats):
        one = replace(sampler, table=sampler.table.model_copy(update={"seed": seed}))
        (measure,), *_, pairs = one.measures(samples // one.rows)
        values, low, high = np.transpose([measure.percentile(p, 0.95) for p in PERCENTILES])
        errors.append(values / exact - 1.0)
        covered.append((low <= exact) & (exact <= high))
        if seed < repeats // 10:
            found = _indices(one, samples)[0]
            truth = np.stack([first, total], axis=1)
            index_errors.append(np.abs(found[..., 0] - truth).max())
            low, high = found[..., 1] - 1e-9, found[..., 2] + 1e-9  # exact indices: rounding
            indices_covered.append((low <= truth) & (truth <= high))
    return {
        "outcome": name,
        "samples": samples,
        "fine": pairs * sampler.rows if two_levels else samples,
        "error of percentiles %": 100.0 * float(np.sqrt(np.mean(np.square(errors)))),
        "covered %": 100.0 * float(np.mean(covered)),
        "error of indices": float(np.sqrt(np.mean(np.square(index_errors)))),
        "indices covered %": 100.0 * float(np.mean(indices_covered)),
        "repeats": repeats,
    }


Factor = Callable[[np.ndarray], np.ndarray]


def power(exponent: float, bend: float = 0.0) -> Factor:
    """Return the factor exp(exponent z + bend |z|) of a score z."""
    return lambda z: np.exp(exponent * z + bend * np.abs(z))


PRODUCTS: dict[str, list[Factor]] = {
    "two powers and 1 + tanh(2 z)/2": [
        power(-0.6), lambda z: 1.0 + 0.5 * np.tanh(2.0 * z), power(0.3),
    ],
    "ten powers, one with a bend": [
        power(0.6, 0.1), *map(power, (0.5, 0.4, 0.3, 0.2, 0.2, 0.1, 0.1, 0.05, 0.05)),
    ],
}  # fmt: skip
"""Factors of outcomes over independent normal scores."""


def indices_of(name: str, samples: int, repeats: int) -> dict[str, object]:
    """Return errors and covered shares of the indices of a product of factors."""
    z = np.linspace(-9.0, 9.0, 20001)
    shares = norm.pdf(z) / norm.pdf(z).sum()
    v = np.array([shares @ (one(z) / (shares @ one(z)) - 1.0) ** 2 for one in PRODUCTS[name]])
    whole = np.prod(1.0 + v)
    truth = np.stack([v, v / (1.0 + v) * whole], axis=1) / (whole - 1.0)
    d, errors, covered = len(v), [], []
    causes = [np.array([k]) for k in range(d)]
    for seed in range(repeats):
        rng = np.random.SeedSequence(seed).spawn(Sampler.rows)
        points = np.stack([
            qmc.Sobol(2 * d, rng=np.random.default_rng(one)).random(samples // Sampler.rows)
            for one in rng
        ])  # fmt: skip
        first, second = np.split(norm.ppf(np.clip(points, 1e-9, 1.0 - 1e-9)), 2, axis=-1)
        scores = np.stack([first, second, *(first for _ in causes)])
        for k, mixed in enumerate(scores[2:]):
            mixed[..., k] = second[..., k]
        values = np.prod([one(scores[..., k]) for k, one in enumerate(PRODUCTS[name])], axis=0)
        found = sobol_indices(scores, values, causes, 0.95)
        errors.append(np.abs(found[..., 0] - truth).max())
        covered.append((found[..., 1] <= truth) & (truth <= found[..., 2]))
    return {
        "outcome": name,
        "samples": samples,
        "runs": samples * (2 + d),
        "largest error": math.sqrt(np.mean(np.square(errors))),
        "covered %": 100.0 * float(np.mean(covered)),
        "repeats": repeats,
    }


STEEL = {"young": 208e3, "poisson": 0.3, "radius_y": math.inf}
BEARING = {
    "load.normal": {"distribution": "lognormal", "factor": 1.15},
    "friction.mu": {"distribution": "lognormal", "factor": 1.3},
    "body.A.radius_x": {"distribution": "normal", "relative": 0.01},
    "body.B.radius_x": {"distribution": "normal", "relative": 0.01},
    "body.A.profile.drop": {"distribution": "uniform", "low": 0.006, "high": 0.014},
    "load.tilt": {"distribution": "normal", "mean": 0.3, "sd": 0.15},
    "body.A.young": {"distribution": "normal", "relative": 0.02},
    "body.B.young": {"distribution": "normal", "relative": 0.02},
    "fatigue.limit": {"distribution": "lognormal", "factor": 1.05},
    "fatigue.exponent": {"distribution": "triangular", "low": 9.0, "high": 11.0, "mode": 10.0},
}
"""Uncertain keys of a roller in full slip, p0 = 2.45 GPa."""


def bearing(samples: tuple[int, ...]) -> list[dict[str, object]]:
    """Return total indices of the life of a roller with ten uncertain keys."""
    warnings.simplefilter("ignore", ts.SceneWarning)
    profile = {"form": "crowned", "flat": 8.0, "drop": 0.01}
    scene = ts.Scene(
        body={"A": STEEL | {"radius_x": 6.0, "width": 12.0, "profile": profile},
              "B": STEEL | {"radius_x": 40.0}},
        load={"normal": 8e3, "tilt": 0.3}, friction={"mu": 0.05}, creepage={"longitudinal": 0.05},
        grid={"elements": [15, 31]},
        fatigue={"limit": 500.0, "sensitivity": 0.3, "bodies": ["A"], "elements": 12},
    )  # fmt: skip
    table = {"scene": scene, "observe": "fatigue_life A", "mesh_check": False}
    uncertain = [{"key": key} | more for key, more in BEARING.items()]
    rows: list[dict[str, object]] = [{"key": key} for key in (*BEARING, "CPU s")]
    for n in samples:
        began = time.process_time()
        found = ts.spread({"spread": table | {"samples": n, "indices": n}, "uncertain": uncertain})
        total, high = found.numbers("total")[0], found.numbers("total_high")[0]
        for row, value, end in zip(rows, total, high, strict=False):
            row |= {f"{n}": float(value), f"{n} half": float(end - value)}
        rows[-1] |= {f"{n}": time.process_time() - began, f"{n} half": math.nan}
    return rows


if __name__ == "__main__":
    repeats = int(sys.argv[1]) if sys.argv[1:] else REPEATS
    rows = [row_of(name, samples, repeats) for name in LAWS for samples in (256, 1024)]
    rows += [row_of("force in full slip, mu P", n, repeats, True) for n in (256, 1024)]
    write("spread", rows)
    show(f"Spreads, {repeats} repeats", rows)
    sizes = [(name, n) for name in PRODUCTS for n in (32, 128, 512)]
    rows = [indices_of(name, n, repeats // 10) for name, n in sizes]
    write("spread_indices", rows)
    show("Sobol indices of other products", rows)
    rows = bearing((32, 64))
    write("spread_bearing", rows)
    show("Life of a roller", rows)
