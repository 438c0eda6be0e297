"""How accurate are the percentiles and Sobol indices of a spread, and their intervals?

Page: docs/howto/spread.md

Outcomes are products of powers of log-normal keys, whose percentiles and indices are known exactly:
the force in full slip, the Hertz pressure of a ball, and a life in proportion to its ninth power.
All else is the code of `ts.spread`. A row repeats a spread with other seeds. A 95 % interval
should contain the exact value in 93 to 97 % of the repeats; the standard deviation of the share of
400 repeats is 1.1 %. Two levels of meshes have samples with an error of 5 % and a ripple of .5 %.

    python benchmarks/spread.py [REPEATS]
"""

import sys
from dataclasses import replace

import numpy as np
from scipy.stats import norm
from timing import show, write

import tractive_sam as ts
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
            indices_covered.append((found[..., 1] <= truth) & (truth <= found[..., 2]))
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


if __name__ == "__main__":
    repeats = int(sys.argv[1]) if sys.argv[1:] else REPEATS
    rows = [row_of(name, samples, repeats) for name in LAWS for samples in (256, 1024)]
    rows += [row_of("force in full slip, mu P", n, repeats, True) for n in (256, 1024)]
    write("spread", rows)
    show(f"Spreads, {repeats} repeats", rows)
