"""The spread of results of a scene with uncertain keys: percentiles, and the causes of the scatter.

Scores z are normal with mean 0 and standard deviation 1, correlated as stated (a Gaussian copula);
the value of a key is the quantile of its distribution at the probability of its score. Samples are
16 independently scrambled Sobol sequences, as points of one sequence are not independent: the
error of a statistic follows from the differences between the sequences (A. B. Owen, SIAM J. Numer.
Anal. 34 (1997) 1884-1910).
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from os import PathLike
from typing import Any, ClassVar

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.special import ndtri

from tractive_sam.fitting.case import Evaluations, on_finer_mesh
from tractive_sam.fitting.design import base_of
from tractive_sam.fitting.distributions import Input, Spread, SpreadDesign, SpreadError
from tractive_sam.fitting.estimators import Measure, sobol_indices
from tractive_sam.fitting.response import (
    Progress,
    QuestionResult,
    Response,
    label_of,
    name_with_unit,
    open_question,
    run_question,
)
from tractive_sam.plot import (
    Drawing,
    Variable,
    percentile_band,
    sample_distribution,
    scatter_causes,
    study_samples,
)
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError


@dataclass(frozen=True, eq=False)
class Sampler:
    """Samples of a spread, and their outcomes on one or two meshes.

    Attributes
    ----------
    table : Spread
        The [spread] table.
    inputs : list of Input
        The d uncertain keys.
    matrix : ndarray, shape (d, d)
        Correlation of their scores.
    fine, coarse : Response
        Outcomes on the mesh of the scene, and on that of the samples; the same without two levels.
    """

    rows: ClassVar[int] = 16
    """Independent sequences R: Student's t is near its limit, and each has several samples."""

    table: Spread
    inputs: list[Input]
    matrix: np.ndarray
    fine: Response
    coarse: Response

    @property
    def two_levels(self) -> bool:
        """Whether samples have a coarser mesh than the centre."""
        return self.coarse is not self.fine

    @cached_property
    def causes(self) -> list[np.ndarray]:
        """Keys, by index, of each independent cause: correlated keys are one cause."""
        number, labels = connected_components(self.matrix != 0.0, directed=False)
        return [np.flatnonzero(labels == k) for k in range(number)]

    @property
    def cause_names(self) -> list[str]:
        """Keys of each cause as text."""
        return [" & ".join(self.inputs[k].key for k in cause) for cause in self.causes]

    def values(self, scores: np.ndarray) -> np.ndarray:
        """Return the values of the keys at independent scores, both of shape (..., d)."""
        z = scores @ np.linalg.cholesky(self.matrix).T
        return np.stack([one.values(z[..., k]) for k, one in enumerate(self.inputs)], axis=-1)

    def scores(self, n: int) -> np.ndarray:
        """Return the independent scores of two samples of n in each row, shape (2, R, n, d).

        The first of 2 n are those of n: a larger sample continues a smaller one.
        """
        from scipy.stats import qmc  # noqa: PLC0415 - half a second, which reading need not wait for

        seeds = np.random.SeedSequence(self.table.seed).spawn(self.rows)
        d = len(self.inputs)
        points = np.stack([
            qmc.Sobol(2 * d, rng=np.random.default_rng(seed)).random_base2(n.bit_length() - 1)
            for seed in seeds
        ])  # fmt: skip
        smallest = 2.0**-31  # half of the steps of the sequence, whose first value may be 0
        scores = ndtri(np.clip(points, smallest, 1.0 - smallest))
        return np.moveaxis(scores.reshape(self.rows, n, 2, d), 2, 0)

    def evaluate(self, response: Response, scores: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return outcomes (R, n, m) and messages (R, n) at scores of shape (R, n, d)."""
        points = self.values(scores)
        shape = points.shape[:-1]
        values, messages = response.evaluate(points.reshape(-1, points.shape[-1]))
        return values.reshape(*shape, -1), np.array(messages, dtype=object).reshape(shape)

    def slopes(self, step: float = 1.6448536269514722) -> tuple[np.ndarray, np.ndarray]:
        """Return derivatives of the outcomes by the scores, (m, d), and outcomes at their ends.

        Exact derivatives need no further run; others are differences between the 5 and 95 %
        quantiles of a key, with all others at their medians, on the mesh of the samples.

        Returns
        -------
        slopes : ndarray, shape (m, d)
            Derivatives by correlated scores.
        ends : ndarray, shape (2, m, d)
            Outcomes at both quantiles of each key; of exact derivatives the linear ones.
        """
        d = len(self.inputs)
        centre = self.values(np.zeros(d))
        middle = self.coarse.evaluate(centre[None])[0][0]
        small = np.array([1e-3, -1e-3])
        ends = np.stack([one.values(step * np.array([-1.0, 1.0])) for one in self.inputs])
        rates = np.array([np.subtract(*one.values(small)) / 2e-3 for one in self.inputs])
        slopes = self.coarse.exact_slopes(centre) * rates
        values = middle[:, None] + step * slopes * np.array([-1.0, 1.0])[:, None, None]
        for k in np.flatnonzero(~np.isfinite(slopes).all(axis=0)):
            points = np.repeat(centre[None], 2, axis=0)
            points[:, k] = ends[k]
            values[:, :, k] = self.coarse.evaluate(points)[0]
            slopes[:, k] = (values[1, :, k] - values[0, :, k]) / (2.0 * step)
        return slopes, values

    def measures(self, n: int) -> tuple[list[Measure], np.ndarray, np.ndarray, int]:
        """Return the measure of each outcome from n samples in each row, and the samples.

        Returns
        -------
        measures : list of Measure
            One for each outcome.
        values : ndarray, shape (R, n, m)
            Outcomes on the mesh of the samples.
        messages : ndarray, shape (R, n)
            Why samples failed.
        fine : int
            Runs on the fine mesh of each row; 0 without two levels.
        """
        scores = self.scores(n)[0]
        values, messages = self.evaluate(self.coarse, scores)
        if not self.two_levels:
            return [Measure.of(one) for one in np.moveaxis(values, -1, 0)], values, messages, 0
        pairs = min(n, max(2, n // 16))
        while True:
            fine, _ = self.evaluate(self.fine, scores[:, :pairs])
            wanted = max(self._pairs(n, values[:, :pairs, k], fine[..., k])
                         for k in range(values.shape[-1]))  # fmt: skip
            if wanted <= pairs:
                break
            pairs = min(2 * pairs, n)
        levels = zip(np.moveaxis(values, -1, 0), np.moveaxis(fine, -1, 0), strict=True)
        return [Measure.of_levels(c, f) for c, f in levels], values, messages, pairs

    def sample_until_accurate(self) -> tuple[list[Measure], np.ndarray, np.ndarray, int, str]:
        """Return `measures` of enough samples, and what is not accurate enough yet, as text.

        Raises
        ------
        SpreadError
            If all samples of a row fail.
        """
        n = 2 ** max(math.ceil(math.log2(self.table.samples / self.rows)), 0)
        while True:
            measures, values, messages, pairs = self.measures(n)
            failed = not all(one.weights.any(axis=1).all() for one in measures)
            missing = "" if failed else _missing_accuracy(self.table, measures)
            if not (failed or missing) or 2 * n * self.rows > self.table.most:
                break
            n *= 2
        if failed:
            reason = next(filter(None, messages.ravel()), "on the mesh of the scene")
            cure = "distributions with values that scenes allow"
            raise SpreadError([Fault("uncertain", f"samples fail: {reason}", cure)])
        return measures, values, messages, pairs, missing

    def _pairs(self, n: int, coarse: np.ndarray, fine: np.ndarray) -> int:
        """Return the best number of fine runs in a row: n sqrt(V1 C0 / V0 C1), from first pairs."""
        both = np.isfinite(coarse) & np.isfinite(fine)
        if both.sum() < 3 or not np.ptp(coarse[both]):
            return 2
        share = 1.0 - float(np.corrcoef(coarse[both], fine[both])[0, 1]) ** 2
        cost = float(self.table.coarse or 1.0) ** 2  # of elements, in two directions
        return min(n, math.ceil(n * math.sqrt(share * cost)))


def spread(
    design: SpreadDesign | Mapping[str, Any] | str | PathLike[str],
    path: str | PathLike[str] | None = None,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    say: Callable[[str], None] | None = None,
) -> SpreadResult:
    """Compute how far results of a scene scatter with uncertain keys, and which keys cause it.

    Parameters
    ----------
    design : SpreadDesign, mapping or path-like
        A spread file, or its tables.
    path : path-like, optional
        The result (netCDF), to which computations are streamed: an interrupted spread resumes from
        those in the file.
    workers : int
        Processes on this machine; 0: this one.
    scheduler : str, optional
        Address of a scheduler of dask.distributed, whose workers compute instead.
    overwrite : bool
        Whether to replace a file that holds the spread of another scene.
    progress : callable, optional
        Called after each computation.
    say : callable, optional
        Called with the linear estimate, before any sample is computed.

    Returns
    -------
    SpreadResult
        Percentiles with intervals, Sobol indices, linear estimate, samples, failed cases.

    Raises
    ------
    SpreadError
        With every fault of the design, or if no sample can be computed.
    ResultsError
        If the file is no spread, or one of another scene.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> load = {"key": "load.normal", "distribution": "lognormal", "factor": 1.1}
    >>> table = {"scene": coarse, "observe": "p_max", "samples": 16, "indices": 0}
    >>> found = ts.spread({"spread": table, "uncertain": [load]})
    >>> low, high = found.interval("p_max", 50)
    >>> low < found.percentile("p_max", 50) < high
    True
    """
    answer = partial(_answer, say=say or (lambda text: None))
    return run_question(
        SpreadResult, SpreadDesign.read(design), path, answer,
        workers=workers, scheduler=scheduler, overwrite=overwrite, progress=progress,
    )  # fmt: skip


def _sampler(document: SpreadDesign, done: Evaluations) -> Sampler:
    """Return the samples of a design, with meshes and steps chosen at the medians."""
    table = document.spread
    inputs, matrix = document.inputs()
    centre = np.array([float(one.values(np.zeros(1))[0]) for one in inputs])
    keys = [one.key for one in inputs]
    try:
        fine = Response.prepare([table.scene], keys, centre, table.outcomes, done)
        coarse = fine
        if table.coarse:
            coarse = fine.on_mesh(partial(on_finer_mesh, refinement=table.coarse), centre)
    except SceneError as error:
        raise SpreadError(fault.under("spread") for fault in error.faults) from None
    return Sampler(table, inputs, matrix, fine, coarse)


def _answer(
    document: SpreadDesign, done: Evaluations, say: Callable[[str], None]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return variables and attributes of the result of a spread."""
    table, sampler = document.spread, _sampler(document, done)
    centre = sampler.values(np.zeros((1, len(sampler.inputs))))
    (nominal,), (message,) = sampler.fine.evaluate(centre)
    if message:
        cure = "uncertain keys at whose medians the scene can be computed"
        raise SpreadError([Fault("uncertain", f"the medians: {message}", cure)])
    finer = np.full(nominal.shape, math.nan)
    if table.mesh_check:
        finer = sampler.fine.on_mesh(on_finer_mesh, centre[0]).evaluate(centre)[0][0]
    slopes, ends = sampler.slopes()
    shares = np.array([
        [b[c] @ sampler.matrix[np.ix_(c, c)] @ b[c] for c in sampler.causes] for b in slopes
    ])  # fmt: skip
    linear_sd = np.sqrt(shares.sum(axis=1))
    notes = _describe_linear(sampler, nominal, linear_sd, shares)
    for note in notes:
        say(note)
    measures, values, messages, pairs, missing = sampler.sample_until_accurate()
    percentiles = np.array([[one.percentile(p / 100.0, table.level) for p in table.percentiles]
                            for one in measures])  # fmt: skip
    moments = np.array([one.moments(table.level) for one in measures])
    wanted = table.samples if table.indices is None else table.indices
    indices = _indices(sampler, wanted)
    failures, scores = int(np.count_nonzero(messages)), sampler.scores(messages.shape[1])[0]
    notes += [missing] if missing else []
    notes += _describe_failures(table, measures, messages)
    notes += _describe_causes(sampler, moments, linear_sd, indices)
    notes += _describe_meshes(sampler, nominal, finer, moments, pairs * sampler.rows)
    points = sampler.values(scores).reshape(messages.size, -1)
    estimates = {"quantile": percentiles, "mean": moments[:, 0], "sd": moments[:, 1],
                 "first": indices[:, :, 0], "total": indices[:, :, 1]}  # fmt: skip
    variables: dict[str, Any] = {f"{name}{end}": array[..., k] for name, array in estimates.items()
                 for k, end in enumerate(SpreadResult.ends)}  # fmt: skip
    variables |= {
        "input": [one.key for one in sampler.inputs],
        "distribution": [one.text for one in sampler.inputs],
        "cause": sampler.cause_names,
        "outcome": [str(one) for one in table.outcomes],
        "percentile": np.array(table.percentiles),
        "nominal": nominal,
        "finer": finer,
        "linear_sd": linear_sd,
        "linear_share": shares,
        "ends": ends,
        "sample": points,
        "sample_outcome": values.reshape(messages.size, -1),
        "sample_message": messages.ravel().tolist(),
        "notes": notes,
    }
    text, status = f"{messages.size} samples, {failures} failed", "accuracy not reached"
    return variables, {"status": status if missing else "done", "message": text}


def _indices(sampler: Sampler, wanted: int) -> np.ndarray:
    """Return Sobol indices with intervals, shape (m, causes, 2, 3); nan if none are wanted."""
    m, causes = len(sampler.table.outcomes), sampler.causes
    if not wanted:
        return np.full((m, len(causes), 2, 3), math.nan)
    first, second = sampler.scores(2 ** max(math.ceil(math.log2(wanted / sampler.rows)), 0))
    scores = np.stack([first, second, *(first for _ in causes)])
    for mixed, cause in zip(scores[2:], causes, strict=True):
        mixed[..., cause] = second[..., cause]
    values = np.moveaxis(sampler.evaluate(sampler.coarse, scores)[0], -1, 0)
    return np.stack([sobol_indices(scores, one, causes, sampler.table.level) for one in values])


def _describe_linear(
    sampler: Sampler, nominal: np.ndarray, sd: np.ndarray, shares: np.ndarray
) -> list[str]:
    """Return a sentence with the linear estimate of each outcome."""
    notes = []
    for one, value, deviation, parts in zip(
        sampler.table.outcomes, nominal, sd, shares, strict=True
    ):
        order = np.argsort(-parts)[:3].tolist() if deviation else []
        share = ", ".join(f"{sampler.cause_names[k]} {parts[k] / deviation**2:.0%}" for k in order)
        wide = f" ({100.0 * deviation / abs(value):.2g} %)" if value else ""
        text = f"linear estimate of {one}: {value:.4g} ± {deviation:.3g}{wide}"
        notes.append(text + (f", of whose variance {share}" if share else ""))
    return notes


def _missing_accuracy(table: Spread, measures: Sequence[Measure]) -> str:
    """Return what is not accurate enough, as text; empty if nothing is."""
    if table.accuracy is None:
        return ""
    wanted = table.accuracy
    name = wanted.observe or table.observe[0]
    for one, measure in zip(table.outcomes, measures, strict=True):
        value, low, high = measure.percentile(wanted.percentile / 100.0, table.level)
        if one.column == name and not 0.5 * (high - low) <= wanted.relative * abs(value):
            return (
                f"percentile {wanted.percentile:g} of {one} is {value:.4g} ± "
                f"{0.5 * (high - low):.2g}, not within {wanted.relative:g} of it; raise spread.most"
            )
    return ""


def _describe_failures(
    table: Spread, measures: Sequence[Measure], messages: np.ndarray
) -> Iterator[str]:
    """Yield why samples failed, and ranges of the percentiles whatever these samples give."""
    reasons = Counter[str]()
    examples: dict[str, str] = {}  # texts that differ only by their numbers are one reason
    for text in filter(None, messages.ravel()):
        reasons[examples.setdefault(re.sub(r"[-+.\d]+", "0", text), text)] += 1
    if not reasons:
        return
    share = sum(reasons.values()) / messages.size
    texts = [f"{count}: {text}" for text, count in reasons.most_common(3)]
    texts += [f"{len(reasons) - 3} further reasons"] * (len(reasons) > 3)
    yield f"{sum(reasons.values())} of {messages.size} samples failed; {'; '.join(texts)}"
    for one, measure in zip(table.outcomes, measures, strict=True):
        ranges = []
        for percent in table.percentiles:
            low, high = (measure.quantile((0.01 * percent - below) / (1.0 - share))
                         for below in (share, 0.0))  # fmt: skip
            ranges.append(f"{percent:g}: {low:.4g} to {high:.4g}")
        yield f"percentiles of {one} whatever the failed samples give: {'; '.join(ranges)}"


def _describe_causes(
    sampler: Sampler, moments: np.ndarray, linear_sd: np.ndarray, indices: np.ndarray
) -> Iterator[str]:
    """Yield what is not linear, which indices are not defined, and what to measure next."""
    for cause, name in zip(sampler.causes, sampler.cause_names, strict=True):
        if len(cause) > 1:
            yield (
                f"{name} are correlated: the variance has no unique share of each, so that they "
                "have common Sobol indices as one cause"
            )
    for k, one in enumerate(sampler.table.outcomes):
        sd, first = moments[k, 1, 0], indices[k, :, 0, 0]
        if sd and abs(linear_sd[k] - sd) > 0.2 * sd:
            estimate = f"the linear estimate of its deviation is {linear_sd[k]:.3g}, not {sd:.3g}"
            yield f"{one} is not linear: {estimate}"
        if np.isfinite(first).all() and first.max() > 0.0:
            best = int(first.argmax())
            yield (
                f"to know {sampler.cause_names[best]} exactly would reduce the variance of {one} "
                f"by {min(first[best], 1.0):.0%} on average; tractive-sam fit --design ranks tests "
                "that measure it"
            )


def _describe_meshes(
    sampler: Sampler, nominal: np.ndarray, finer: np.ndarray, moments: np.ndarray, runs: int
) -> Iterator[str]:
    """Yield the error of the mesh beside the scatter, and the runs of two levels."""
    for k, one in enumerate(sampler.table.outcomes):
        shift, sd = abs(finer[k] - nominal[k]), moments[k, 1, 0]
        if math.isfinite(shift) and shift > 0.05 * sd:
            yield f"a finer mesh changes {one} by {shift:.2g}; it scatters by {sd:.2g}: refine it"
    if sampler.two_levels:
        elements = sampler.coarse.scenes[0].settings()["grid"]["elements"]
        size = " x ".join(map(str, np.atleast_1d(elements)))
        yield f"two levels: samples on {size} elements, and {runs} of them on the mesh of the scene"


@dataclass(frozen=True, eq=False, repr=False)
class SpreadResult(QuestionResult):
    """Result of a spread: percentiles with intervals, Sobol indices, and samples.

    Attributes
    ----------
    dataset : "xarray.Dataset"
        All numbers: percentiles over ``outcome`` and ``percentile``, indices over ``outcome`` and
        ``cause``, samples over ``run``; the answers of all computations.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> load = {"key": "load.normal", "distribution": "uniform", "low": 0.3, "high": 0.5}
    >>> table = {"scene": coarse, "observe": "p_max", "samples": 16, "indices": 16}
    >>> found = ts.spread({"spread": table, "uncertain": [load]})
    >>> found.status, found.keys, round(float(found.numbers("first")[0, 0]), 1)
    ('done', ('load.normal',), 1.0)
    """

    document = SpreadDesign
    ends: ClassVar[tuple[str, ...]] = ("", "_low", "_high")
    """Ends of the names of an estimate, and of the low and high end of its interval."""
    variables: ClassVar[Mapping[str, tuple[str, str, str]]] = {
        "input": ("input", "", "uncertain keys"),
        "distribution": ("input", "", "their distributions"),
        "cause": ("cause", "", "independent causes"),
        "outcome": ("outcome", "", "outcomes"),
        "percentile": ("percentile", "1", "percentiles"),
        "nominal": ("outcome", "1", "outcome at the medians"),
        "finer": ("outcome", "1", "outcome at the medians on a finer mesh"),
        "linear_sd": ("outcome", "1", "standard deviation of the linear estimate"),
        "linear_share": ("outcome cause", "1", "variance by cause, linear"),
        "ends": ("end outcome input", "1", "outcome at 5 and 95 % of each key"),
        "sample": ("run input", "1", "values of the keys"),
        "sample_outcome": ("run outcome", "1", "outcomes of the samples; nan: failed"),
        "sample_message": ("run", "", "why a sample failed"),
        "notes": ("note", "", "notes"),
        **{f"{name}{end}": (dims, "1", f"{meaning}{end.replace('_', ', ')}")
           for end in ends
           for name, dims, meaning in (
               ("quantile", "outcome percentile", "percentile of an outcome"),
               ("mean", "outcome", "mean"),
               ("sd", "outcome", "standard deviation"),
               ("first", "outcome cause", "first-order Sobol index"),
               ("total", "outcome cause", "total Sobol index"),
           )},
    }  # fmt: skip

    def _place(self, outcome: str, percentile: float) -> tuple[int, int]:
        """Return the indices of an outcome and a percentile; LookupError if there is none."""
        outcomes, numbers = self.texts("outcome"), self.numbers("percentile").tolist()
        if outcome not in outcomes or percentile not in numbers:
            allowed = f"outcomes {', '.join(outcomes)}; percentiles {', '.join(map(str, numbers))}"
            raise LookupError(f"no percentile {percentile:g} of {outcome}: {allowed}")
        return outcomes.index(outcome), numbers.index(percentile)

    def percentile(self, outcome: str, percentile: float) -> float:
        """Return a percentile of an outcome; LookupError if the file does not have it."""
        return float(self.numbers("quantile")[self._place(outcome, percentile)])

    def interval(self, outcome: str, percentile: float) -> tuple[float, float]:
        """Return (low, high) of the interval of a percentile; infinite beyond the samples."""
        place = self._place(outcome, percentile)
        low, high = (float(self.numbers(f"quantile_{end}")[place]) for end in ("low", "high"))
        return low, high

    def tables(self) -> dict[str, list[dict[str, str]]]:
        """Return tables of percentiles and causes as rows of text."""
        columns = {name: self.numbers(name) for name in self.variables}
        rows, causes = [], []
        for k, name in enumerate(self.texts("outcome")):
            named = name_with_unit(name, self.design.spread.scene)
            row = {"outcome": named, "at medians": f"{columns['nominal'][k]:.4g}"}
            row |= {"mean": f"{columns['mean'][k]:.4g}", "sd": f"{columns['sd'][k]:.3g}"}
            for j, p in enumerate(columns["percentile"]):
                low, high = columns["quantile_low"][k, j], columns["quantile_high"][k, j]
                row[f"{p:g} %"] = f"{columns['quantile'][k, j]:.4g} ({low:.4g} to {high:.4g})"
            rows.append(row)
            parts = columns["linear_share"][k] / max(columns["linear_share"][k].sum(), 1e-300)
            for j, cause in enumerate(self.texts("cause")):
                share = {"linear": f"{parts[j]:.2f}"}
                for index in ("first", "total"):
                    value, high = columns[index][k, j], columns[f"{index}_high"][k, j]
                    known = math.isfinite(value)
                    share[index] = f"{value:.3f} ± {high - value:.3f}" if known else ""
                causes.append({"outcome": name, "cause": cause} | share)
        inputs = zip(self.keys, self.texts("distribution"), strict=True)
        return {
            "Percentiles": rows,
            "Shares of the variance (Sobol indices)": causes,
            "Uncertain keys": [{"key": key, "distribution": text} for key, text in inputs],
        }

    def drawings(self) -> Iterator[Drawing]:
        """Yield causes, samples, and percentiles over revolutions, to be drawn."""
        columns, keys = {name: self.numbers(name) for name in self.variables}, self.keys
        scene, outcomes = self.design.spread.scene, self.design.spread.outcomes
        draw = partial(partial, title=self.title)
        for k, one in enumerate(outcomes):
            label, name = label_of(str(one), scene), str(one).replace(" ", "-")
            bars = {i: np.stack([columns[f"{i}{end}"][k] for end in self.ends])
                    for i in ("first", "total")}  # fmt: skip
            if not np.isfinite(bars["first"]).all():
                parts = columns["linear_share"][k]
                bars = {"linear": parts / max(parts.sum(), 1e-300)}
            text = "between the 5 and 95 % quantiles of each key, and shares of the variance"
            ends, middle = columns["ends"][:, k], float(columns["nominal"][k])
            arguments = keys, ends, middle, self.texts("cause"), bars, label
            yield Drawing(f"causes-{name}", f"{one}: {text}.", draw(scatter_causes, *arguments))
            swing = np.nan_to_num(np.abs(ends - middle)).max(axis=0)
            units = [
                re.search(
                    r", ((k?N|M?Pa|mm|m/s|mrad|degrees|K|W|1/mm|micrometres|HV)[^,;:]*)",
                    Scene.find_field(base_of(key)).title or "",
                )
                for key in keys
            ]
            x = {keys[j]: Variable(keys[j], columns["sample"][:, j], unit=unit[1] if unit else "")
                 for j in np.argsort(-swing)[:2] for unit in [units[j]]}  # fmt: skip
            y = Variable("", columns["sample_outcome"][:, k], label)
            caption = f"{one} of the samples over the keys with the largest effect."
            yield Drawing(f"samples-{name}", caption, draw(study_samples, x, y))
            if np.isfinite(y.values).any():
                quantiles = np.stack([columns[f"quantile{end}"][k] for end in self.ends])
                caption = f"Share of the samples below each value of {one}, and its percentiles."
                about = y.values, columns["percentile"], quantiles, label
                yield Drawing(f"distribution-{name}", caption, draw(sample_distribution, *about))
        for name in dict.fromkeys(one.column for one in outcomes):
            rows = [k for k, one in enumerate(outcomes) if one.column == name]
            places = np.array([outcomes[k].place for k in rows])
            if places.size > 1:
                curves = columns["percentile"], columns["quantile"][rows]
                of_wear = scene.wear is not None
                along = "revolution" if of_wear else "distance (mm)"
                figure = draw(percentile_band, places, *curves, label_of(name, scene), along=along)
                yield Drawing(f"band-{name.replace(' ', '-')}", f"Percentiles of {name}.", figure)


def open_spread(path: str | PathLike[str]) -> SpreadResult:
    """Return the result of a spread from its file, also of an interrupted one.

    Raises
    ------
    ResultsError
        If the file does not exist, is damaged, or no spread.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> load = {"key": "load.normal", "distribution": "uniform", "low": 0.3, "high": 0.5}
    >>> table = {"scene": coarse, "observe": "p_max", "samples": 16, "indices": 0}
    >>> found = ts.spread({"spread": table, "uncertain": [load]}, "load.nc")
    >>> ts.open_spread("load.nc").percentile("p_max", 50) == found.percentile("p_max", 50)
    True
    """
    return open_question(path, SpreadResult)
