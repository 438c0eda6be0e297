"""How often do the intervals of fits contain the truth?

Page: docs/howto/fit.md

Each row of the table is a kind of noise, a number of points, and settings of the fit. Its data are
random in 400 repeats. A 95 % interval should contain the true value in 92 to 98 % of the repeats:
the standard deviation of the share is 1.1 %.

Contacts would take most of the time. Predictions are those of a closed model: in full slip, Qx/P
is the friction coefficient, and the wear of one revolution is proportional to its coefficient. All
else is the code of `ts.fit`. `check` compares the closed model with solved contacts.

    python benchmarks/fit_coverage.py [REPEATS]        # all rows
"""

import sys
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.fitting.case import Answer, FitCase, compute
from tractive_sam.fitting.data import read_measured
from tractive_sam.fitting.design import Parameters
from tractive_sam.fitting.estimate import Search
from tractive_sam.fitting.problem import FitProblem, Series
from tractive_sam.fitting.run import find_intervals, make_problem, read_design

warnings.simplefilter("ignore", ts.SceneWarning)  # coarse meshes and 2 % of slip are meant

REPEATS = 400
MU, WEAR = 0.3, 1e-4
"""True friction coefficient, and true wear coefficient, mm3/(N m)."""

KEYS = {"friction.mu": MU, "wear.coefficient": WEAR}

SPHERES = (
    ts.Scene.builtin("twin-discs")
    .replace(subsurface=None, friction={"mu": MU}, creepage={"longitudinal": -0.05})
    .replace(
        wear={"coefficient": WEAR, "revolutions": 1, "save": (0, 1), "stepping": "saved",
              "turns": "equal"}
    )
    .replace(**{"grid.elements": (13, 41)})
)  # fmt: skip
"""Discs in full slip; they wear for one revolution."""


@cache
def reference() -> Answer:
    """Return the solved answer at the true values."""
    columns = ("Qx_over_P", "worn_area", "wear_profile_B")
    return compute(FitCase(SPHERES, columns, (0.0, 1.0)))[0]


class ClosedProblem(FitProblem):
    """Problem whose predictions are the reference, scaled by friction and wear coefficients."""

    def predict(self, u: np.ndarray, derivatives: bool = False) -> np.ndarray:
        """See `FitProblem.predict`."""
        return np.concatenate(
            [self._column(series, place, u)[0] for series, place in self._data_sets]
        )

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """See `FitProblem.jacobian`."""
        rows = []
        relative = self.parameters.slopes(u) / self.parameters.values(u)
        for series, place in self._data_sets:
            _, scaled, key = self._column(series, place, u)
            block = np.zeros((series.measured.points, self.size))
            k = self.parameters.keys.index(key)
            block[:, k] = scaled * relative[k]
            if series.measured.data.profile:
                y, depth = _profile(self.parameters.values_by_key(u)[key])
                block[:, place] = series.position.slopes(y, depth, u[place])
            rows.append(block)
        return np.concatenate(rows)

    def align_profiles(self, u: np.ndarray) -> np.ndarray:
        """See `FitProblem.align_profiles`."""
        aligned = np.array(u, float)
        for series, place in self._data_sets:
            if series.measured.data.profile:
                aligned[place] = series.position.align(*_profile(WEAR))
        return aligned

    @property
    def _data_sets(self) -> list[tuple[Series, slice]]:
        return list(zip(self.series, self.positions, strict=True))

    def _column(
        self, series: Series, place: slice, u: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, str]:
        """Return (predictions, their part that is proportional to a parameter, its key)."""
        values = self.parameters.values_by_key(u)
        if series.measured.data.profile:
            y, depth = _profile(values["wear.coefficient"])
            predicted = series.position.predict(y, depth, u[place])
            line = series.position.predict(y, 0.0 * depth, u[place])
            return predicted, predicted - line, "wear.coefficient"
        (name,) = series.columns
        key = "friction.mu" if name == "Qx_over_P" else "wear.coefficient"
        value = reference().numbers[name][-1] * values[key] / KEYS[key]
        predicted = np.full(series.measured.points, value)
        return predicted, predicted, key


def _profile(wear: float) -> tuple[np.ndarray, np.ndarray]:
    """Return y and worn depth of body B for a wear coefficient."""
    numbers = reference().numbers
    return numbers["y"], numbers["wear_profile_B"][1] * wear / WEAR


@dataclass(frozen=True)
class Case:
    """Row of the table: data sets, settings of the fit, and the parameters that it fits.

    Attributes
    ----------
    noise : str
        The noise, in words.
    s : float
        Its standard deviation over the true value.
    n : int
        Number of points.
    sets : tuple of (str, str, int, float)
        Kind of noise, column, number of points, and relative standard deviation of each data set.
    more : mapping
        Entries of the fit.
    note : str
        What is special.
    """

    sets: tuple[tuple[str, str, int, float], ...]
    more: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""
    outliers: float = 0.0
    prior: float = 0.0

    @property
    def keys(self) -> list[str]:
        """Return the keys that the columns of the data sets determine."""
        columns = {column for _, column, _, _ in self.sets}
        keys = ["friction.mu"] if "Qx_over_P" in columns else []
        return keys + (["wear.coefficient"] if columns - {"Qx_over_P"} else [])

    def design(self, rng: np.random.Generator) -> dict[str, Any]:
        """Return a fit of newly randomised data."""
        data = [self._draw(rng, *entries) for entries in self.sets]
        table = {"scene": SPHERES, "free": self.keys, "data": data, "curve": 0}
        if self.prior:
            mean = MU * (1.0 + self.prior * rng.standard_normal())
            table["parameter"] = [{"key": "friction.mu", "prior": [mean, self.prior * MU]}]
        return table | {"mesh_check": False} | dict(self.more)

    def _draw(
        self, rng: np.random.Generator, kind: str, column: str, n: int, s: float
    ) -> dict[str, Any]:
        """Return a data set of n noisy values of a column."""
        values: dict[str, Any] = {}
        answer = reference()
        if column == "wear_profile":
            y, depth = answer.numbers["y"], answer.numbers["wear_profile_B"][1]
            place = np.linspace(0.8 * y[0], 0.8 * y[-1], n)
            truth = np.interp(place - 0.1, y, depth) + depth.max() * (0.2 + 0.1 * place)
            size, values["y"], column_of_data = depth.max(), place, "depth"
        else:
            truth = np.full(n, answer.numbers[column][-1])
            size, column_of_data = abs(truth[0]), column
        normal = rng.standard_normal(n)
        normal = normal * np.where(rng.random(n) < self.outliers, 10.0, 1.0)
        true_noise = 3.0 * s if self.more.get("scatter") else s  # the stated one is wrong
        noise: Any = s if kind == "relative" else {kind: size * s}
        if kind == "factor":
            noise, noisy = {"factor": np.exp(s)}, truth * np.exp(true_noise * normal)
        elif kind == "column":
            sd = size * s * rng.uniform(0.3, 2.0, n)
            values["sd"], noise, noisy = sd, {"column": "sd"}, truth + sd * normal
        elif kind == "both":
            noise = {"absolute": 0.5 * size * s, "relative": s}
            noisy = truth + size * true_noise * np.hypot(0.5, 1.0) * normal
        else:
            noisy = truth + size * true_noise * normal
        values[column_of_data] = noisy
        data = {"values": values, "observe": column, "noise": noise}
        data |= {"body": "B"} if column == "wear_profile" else {}
        return data | ({"at": 0} if column == "Qx_over_P" else {"at": 1})


def cases() -> list[Case]:
    """Return the rows of the table."""
    force = "Qx_over_P"
    single = [Case((("relative", force, n, s),)) for s in (0.05, 0.2, 0.5) for n in (2, 5, 10, 50)]
    single += [
        Case(((kind, force, n, s),))
        for kind in ("absolute", "factor")
        for s in (0.05, 0.5)
        for n in (2, 10, 50)
    ]
    tail = [Case(((kind, force, 10, 0.2),)) for kind in ("column", "both")]
    tail += [Case(((kind, "worn_area", 5, 0.5),), note="wear") for kind in ("relative", "factor")]
    tail += [
        Case((("relative", force, n, 0.2),), prior=prior, note=f"prior {prior:g}")
        for n in (2, 10)
        for prior in (0.05, 0.2, 10.0)
    ]
    tail += [
        Case((("absolute", force, 10, 0.1),), {"loss": loss}, loss, outliers)
        for loss in ("soft_l1", "huber", "cauchy", "arctan")
        for outliers in (0.0, 0.1)
    ]
    tail += [
        Case(
            (("absolute", force, n, 0.02),),
            {"loss": loss, "scatter": True},
            f"{loss}, scatter",
            outliers,
        )
        for loss in ("soft_l1", "huber", "cauchy", "arctan")
        for n in (10, 50)
        for outliers in (0.0, 0.1)
    ]  # fmt: skip
    tail += [
        Case((("absolute", "wear_profile", n, 0.05),), note="offset, tilt, level") for n in (12, 50)
    ]
    tail += [
        Case((("absolute", force, 50, 0.05), (kind, "worn_area", n, 0.3)), note="two data sets")
        for kind in ("relative", "factor")
        for n in (3, 10)
    ]
    tail += [
        Case(((kind, force, n, 0.05),), {"scatter": True, "intervals": intervals},
             f"scatter, {intervals}")
        for intervals in ("linear", "profile")
        for kind in ("absolute", "relative", "factor")
        for n in (2, 3, 10)
    ]  # fmt: skip
    tail += [
        Case(((kind, force, n, 0.5),), {"intervals": "profile"}, "profile")
        for kind in ("absolute", "relative", "factor")
        for n in (2, 10)
    ]
    tail += [
        Case((("absolute", "wear_profile", 12, 0.05),), {"intervals": "profile"},
             "offset, tilt, level, profile")
    ]  # fmt: skip
    return single + tail


def coverage(case: Case, repeats: int, seed: int = 1) -> list[dict[str, Any]]:
    """Return how often the intervals of a case contain the true values, for each parameter."""
    rng = np.random.default_rng(seed)
    inside, expected = dict.fromkeys(case.keys, 0), 0
    estimates: dict[str, list[float]] = {key: [] for key in case.keys}
    solved = make_problem(read_design(case.design(rng)).fit)
    for _ in range(repeats):
        table = read_design(case.design(rng)).fit
        data = [read_measured(one, "fit.data") for one in table.data]
        series = tuple(
            replace(one, measured=measured)
            for one, measured in zip(solved.series, data, strict=True)
        )
        problem = ClosedProblem(Parameters.of(table), series, solved.evaluations)
        best = Search(problem, table).run()
        intervals = find_intervals(best, table)
        low, high = best.chi2_range(table.level)
        expected += low <= best.chi2 <= high
        values = problem.parameters.values(best.u)
        for key, value, low, high in zip(
            case.keys, values, intervals.low, intervals.high, strict=True
        ):
            # An end that the data do not set is open.
            inside[key] += not (low > KEYS[key] or high < KEYS[key])
            estimates[key].append(value / KEYS[key])
    return [
        {
            "noise": ", ".join(kind for kind, *_ in case.sets),
            "s": ", ".join(f"{s:g}" for *_, s in case.sets),
            "n": ", ".join(f"{n}" for _, _, n, _ in case.sets),
            "settings": case.note + (", 10 % outliers" if case.outliers else ""),
            "key": key,
            "mean": np.mean(estimates[key]),
            "median": np.median(estimates[key]),
            "covered %": 100.0 * inside[key] / repeats,
            "chi-square expected %": 100.0 * expected / repeats,
            "repeats": repeats,
        }
        for key in case.keys
    ]


def check(case: Case, seed: int = 1) -> float:
    """Return the largest relative difference of closed and solved predictions of a case."""
    table = read_design(case.design(np.random.default_rng(seed))).fit
    solved = make_problem(table)
    closed = ClosedProblem(solved.parameters, solved.series, solved.evaluations)
    u = closed.align_profiles(np.r_[np.full(len(case.keys), 1.2), np.zeros(solved.size)])
    predicted = solved.predict(u[: solved.size])
    return float(np.abs(closed.predict(u[: solved.size]) / predicted - 1.0).max())


if __name__ == "__main__":
    repeats = int(sys.argv[1]) if sys.argv[1:] else REPEATS
    rows = []
    for one in cases():
        rows += coverage(one, repeats)
        print(*rows[-1].values(), flush=True)
    differences = [check(one) for one in cases() if one.note in ("", "wear", "two data sets")][-6:]
    print(f"closed model against solved contacts: {max(differences):.1e}")
    write("fit_coverage", rows)
    show(f"Intervals of 95 % in {repeats} repeats", rows)
