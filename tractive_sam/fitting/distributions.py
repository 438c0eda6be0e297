"""The file of a spread: uncertain keys with their distributions, and their correlations."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from scipy.special import ndtr

from tractive_sam.fitting.design import Names, Numbers, Parameters, QuestionDocument, start_of
from tractive_sam.fitting.fit_file import open_fit
from tractive_sam.fitting.response import Outcome, check_observed, read_outcome
from tractive_sam.scene import Scene
from tractive_sam.schema import (
    Check,
    Fault,
    Positive,
    Real,
    SceneError,
    Table,
    ValidEntries,
    entry,
    optional,
    shorten,
)


class SpreadError(SceneError):
    """Error of a spread that cannot be computed; lists every fault that was found.

    Examples
    --------
    >>> try:
    ...     ts.SpreadDesign(spread={"scene": "spheres", "observe": "Qx"})
    ... except ts.SpreadError as error:
    ...     print(error.faults[0].key)
    uncertain
    """

    subject: ClassVar[str] = "spread"


def _check_distribution(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of the parameters of a distribution: missing, of another one, out of order."""
    if "fit" in entries.given:
        if more := entries.given - {"fit"}:
            yield Fault(
                "fit", f"together with {', '.join(sorted(more))}", "from without other keys"
            )
        return
    kind = entries["distribution"]
    if entries["key"] is None:
        yield Fault("key", "nothing", 'a dotted key of the scene, or from = "FIT.nc"')
    if kind is None:
        allowed = ", ".join(Uncertain.parameters)
        yield Fault("distribution", "nothing", allowed)
        return
    needed, further = Uncertain.parameters[kind]
    for name in sorted(entries.given - {"key", "distribution"}):
        if name not in (*" ".join(needed).split(), *further):
            allowed = f"not with {kind}, which has {', '.join((*needed, *further))}"
            yield Fault(name, shorten(entries[name]), allowed)
    for names in needed:
        if len(entries.given & {*names.split()}) != 1:
            text = " and ".join(sorted(entries.given & {*names.split()}))
            yield Fault(names.split()[0], text or "nothing", f"one of {names.replace(' ', ', ')}")
    rising = [(name, entries[name]) for name in ("low", "lower", "mode", "high", "upper")]
    rising = [(name, value) for name, value in rising if value is not None]
    for (before, low), (name, high) in pairwise(rising):
        if high < low or (high == low and "mode" not in (before, name)):
            yield Fault(name, f"{high:g}", f"above {before}, {low:g}")
    yield from _table_faults(entries["values"], entries["probability"])


def _table_faults(
    values: tuple[float, ...] | None, probability: tuple[float, ...] | None
) -> Iterator[Fault]:
    """Yield faults of a table of values with their cumulative probabilities."""
    if values is None:
        return
    if len(values) < 2 or (np.diff(values) <= 0.0).any():
        yield Fault("values", shorten(values), "at least two numbers in rising order")
    if probability is None:
        return
    rises = len(probability) > 1 and (np.diff(probability) > 0.0).all()
    if not rises or probability[0] != 0.0 or probability[-1] != 1.0:
        yield Fault("probability", shorten(probability), "numbers that rise from 0 to 1")
    elif len(probability) != len(values):
        yield Fault(
            "probability", f"{len(probability)} numbers", f"{len(values)}, one for each value"
        )


class Uncertain(Table):
    """An [[uncertain]] table: a key with its distribution, or ``from``, the file of a fit.

    Examples
    --------
    >>> from tractive_sam.fitting.distributions import Uncertain
    >>> Uncertain(key="friction.mu", distribution="lognormal", factor=1.2).factor
    1.2
    """

    parameters: ClassVar[dict[str, tuple[tuple[str, ...], tuple[str, ...]]]] = {
        "normal": (("sd relative",), ("mean", "lower", "upper")),
        "lognormal": (("factor relative",), ("median", "lower", "upper")),
        "uniform": (("low", "high"), ()),
        "triangular": (("low", "high"), ("mode",)),
        "table": (("values",), ("probability",)),
    }
    """Parameters of each distribution: groups with one of each, and optional ones."""

    key: str | None = optional("the uncertain entry of the scene", "a dotted key")
    fit: str | None = optional(
        "from: file of a fit, whose parameters have its estimates and covariance", "a file name"
    )
    distribution: Literal["normal", "lognormal", "uniform", "triangular", "table"] | None = (
        optional("distribution of its values")
    )
    mean: Real | None = optional("mean of a normal one; by default the value in the scene")
    sd: Positive | None = optional("standard deviation of a normal one")
    relative: Positive | None = optional("standard deviation over the mean")
    median: Positive | None = optional("median of a log-normal one; by default as in the scene")
    factor: Real | None = optional(
        "factor of one standard deviation of the logarithm: 1.2 for a scatter of 20 %",
        "a number above 1",
        gt=1.0,
    )
    low: Real | None = optional("smallest value of a uniform or triangular one")
    mode: Real | None = optional("most probable value; by default the value in the scene")
    high: Real | None = optional("largest value of a uniform or triangular one")
    lower: Real | None = optional("values below it do not occur: the distribution is cut off")
    upper: Real | None = optional("values above it do not occur: the distribution is cut off")
    values: Numbers | None = optional("values of a table in rising order", "a list of numbers")
    probability: Numbers | None = optional(
        "probability of smaller values, from 0 to 1; by default in equal steps",
        "a list of numbers",
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_distribution,)

    @classmethod
    def unfold(cls, entries: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return entries with the key ``from`` under its name in Python, ``fit``."""
        return {"fit" if key == "from" else key: value for key, value in entries.items()}


@dataclass(frozen=True, eq=False)
class Input:
    """Uncertain key with its distribution.

    Attributes
    ----------
    key, text : str
        Dotted key, and the distribution in words.
    distribution : object
        A frozen distribution of `scipy.stats`.
    lower, upper : float
        Values at which it is cut off.
    """

    key: str
    text: str
    distribution: Any
    lower: float = -math.inf
    upper: float = math.inf

    def values(self, scores: np.ndarray) -> np.ndarray:
        """Return the values of the key at normal scores."""
        low, high = self.distribution.cdf([self.lower, self.upper])
        return self.distribution.ppf(low + ndtr(scores) * (high - low))

    @classmethod
    def from_table(cls, table: Uncertain, scene: Scene) -> Input:
        """Return the input that a table describes; the scene has a mean that it leaves out.

        Raises
        ------
        SceneError
            If the scene has no number of this key, or its value is outside the distribution.
        """
        from scipy import stats  # noqa: PLC0415 - half a second, which other files need not wait for

        further = table.values[:1] if table.values else ()
        stated = (table.mean, table.median, table.mode, table.low, *further)
        first = next((x for x in stated if x is not None), None)
        key, centre = str(table.key), start_of(scene, str(table.key), first)
        lower = -math.inf if table.lower is None else table.lower
        upper = math.inf if table.upper is None else table.upper
        relative, low, high = table.relative or 0.0, table.low or 0.0, table.high or 0.0
        match table.distribution:
            case "normal":
                sd = table.sd or relative * abs(centre)
                text, distribution = f"normal, {centre:.4g} ± {sd:.3g}", stats.norm(centre, sd)
            case "lognormal":
                if centre <= 0.0:
                    raise SceneError([Fault(key, f"{centre:g}", "a median above 0")])
                s = math.log(table.factor) if table.factor else math.sqrt(math.log1p(relative**2))
                text = f"log-normal, {centre:.4g} times or over {math.exp(s):.4g}"
                distribution = stats.lognorm(s, scale=centre)
            case "uniform":
                text, distribution = f"{low:g} to {high:g}", stats.uniform(low, high - low)
            case "triangular":
                mode = start_of(scene, key, table.mode)
                if not low <= mode <= high:
                    raise SceneError([Fault(key, f"mode {mode:g}", f"from {low:g} to {high:g}")])
                text = f"triangular, {low:g} to {high:g}, mode {mode:g}"
                distribution = stats.triang((mode - low) / (high - low), low, high - low)
            case _:
                x = np.array(table.values)
                text = f"table of {x.size} values, {x[0]:g} to {x[-1]:g}"
                shares = np.diff(table.probability or np.linspace(0.0, 1.0, x.size))
                distribution = stats.rv_histogram((shares, x), density=False)
        if not lower < upper or not np.diff(distribution.cdf([lower, upper])) > 0.0:
            raise SceneError([Fault(key, f"{lower:g} to {upper:g}", "bounds around values it has")])
        return cls(key, text, distribution, lower, upper)

    @classmethod
    def from_fit(cls, path: str, fault_key: str) -> tuple[list[Input], np.ndarray]:
        """Return the parameters of a fit as inputs, and their correlation matrix.

        Raises
        ------
        SpreadError
            If the fit is not complete, or does not determine a parameter.
        """
        from scipy import stats  # noqa: PLC0415 - as above

        result = open_fit(path)
        if not result.finished:
            raise SpreadError([Fault(fault_key, f"{path}, without estimates", "a complete fit")])
        free = [key for key, sd in result.sd.items() if not math.isfinite(sd)]
        if free:
            cure = "a fit that determines all its parameters, or their keys with a distribution"
            raise SpreadError([Fault(fault_key, f"{path}: no {', '.join(free)}", cure)])
        inputs = []
        logarithmic = Parameters.of(result.design.fit).logarithmic
        for (key, value), is_log in zip(result.values.items(), logarithmic, strict=True):
            sd = result.sd[key]
            kind = stats.lognorm(sd / value, scale=value) if is_log else stats.norm(value, sd)
            inputs.append(cls(key, f"fit, {value:.4g} ± {sd:.3g}", kind))
        return inputs, result.correlation


class Correlation(Table):
    """A [[correlation]] table: the correlation of the scores of two uncertain keys."""

    keys: Names = entry("two uncertain keys", "a list of two keys", min_length=2, max_length=2)
    value: Real = entry("correlation of their normal scores", "a number from -1 to 1", ge=-1, le=1)


class Precision(Table):
    """The table ``accuracy``: samples are added until a percentile is known so well."""

    observe: str | None = optional("its outcome; by default the first", "one of observe")
    percentile: float = entry("the percentile", default=50.0, gt=0.0, lt=100.0)
    relative: Positive = entry("half width of its interval over its value")


def _check_outcomes(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of the observed columns, and of a scene whose mesh is not fixed."""
    yield from check_observed(entries)
    precision = entries["accuracy"]
    if precision is not None and precision.observe not in (None, *entries["observe"]):
        yield Fault("accuracy.observe", shorten(precision.observe), "one of observe")
    if entries["scene"].accuracy is not None:
        cure = "a [grid] or none: all samples have the same number of elements"
        yield Fault("scene.accuracy", "a table", cure)
    if entries["most"] < entries["samples"]:
        yield Fault("most", str(entries["most"]), f"at least samples, {entries['samples']}")


class Spread(Table):
    """The [spread] table: scene, observed columns, percentiles, and the number of samples.

    Examples
    --------
    >>> from tractive_sam.fitting.distributions import Spread
    >>> Spread(scene=ts.Scene.builtin("spheres"), observe="Qx").percentiles
    (5.0, 50.0, 95.0)
    """

    title: str = entry("title", default="")
    scene: Scene = entry("the scene", "a built-in name, a scene file, or the tables of a scene")
    observe: Names = entry(
        'columns of a record, those of a body as "worn_mass A"', "a list of names", min_length=1
    )
    at: Numbers = entry(
        "revolutions or distances of the records; by default the last one", "a list of numbers", ()
    )
    percentiles: Numbers = entry("percentiles", "numbers between 0 and 100", (5.0, 50.0, 95.0))
    level: float = entry("probability of the intervals", default=0.95, ge=0.5, le=0.999)
    samples: int = entry("first number of samples, rounded up to 16, 32, 64, ... 16 * 2^n",
                         default=256, ge=16, le=2**20)  # fmt: skip
    most: int = entry("most samples", default=16384, ge=16, le=2**20)
    accuracy: Precision | None = optional("samples are doubled until a percentile is as accurate")
    indices: int | None = optional(
        "samples for Sobol indices, with one run more for each cause; by default samples; 0: none",
        ge=0,
        le=2**20,
    )
    coarse: float | None = optional(
        "elements along each axis of the mesh of the samples, over those of the scene: two levels",
        ge=0.1,
        le=0.9,
    )
    mesh_check: bool = entry("whether the centre is computed on a finer mesh too", default=True)
    seed: int = entry("seed of the samples", "an integer from 0", 0, ge=0)
    checks: ClassVar[tuple[Check, ...]] = (_check_outcomes,)

    @property
    def outcomes(self) -> tuple[Outcome, ...]:
        """Observed numbers: every column at every place."""
        return tuple(read_outcome(name, at) for name in self.observe for at in self.at or (None,))


def _check_keys(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of uncertain keys that the scene does not have, or that are given twice."""
    scene, keys = entries["spread"].scene, list[str]()
    if not all(0.0 < p < 100.0 for p in entries["spread"].percentiles):
        allowed = "numbers between 0 and 100"
        yield Fault("spread.percentiles", shorten(entries["spread"].percentiles), allowed)
    for k, table in enumerate(entries["uncertain"]):
        if table.fit is not None:
            continue
        try:
            Input.from_table(table, scene)
        except SceneError as error:
            faults = error.faults
            yield from (Fault(f"uncertain[{k}].key", f"{table.key}: {f.given}", f.allowed)
                        for f in faults)  # fmt: skip
        if table.key in keys:
            yield Fault(f"uncertain[{k}].key", f"{table.key} again", "each key once")
        keys.append(table.key)
    from_fits = any(table.fit for table in entries["uncertain"])
    for k, pair in enumerate(entries["correlation"]):
        for key in {*pair.keys} - {*keys} if not from_fits else ():
            yield Fault(f"correlation[{k}].keys", shorten(key), f"of {', '.join(keys)}")


class SpreadDesign(QuestionDocument):
    """A spread file: the table [spread], and the uncertain keys with their correlations.

    Raises
    ------
    SpreadError
        With every fault.

    Examples
    --------
    >>> mu = {"key": "friction.mu", "distribution": "normal", "relative": 0.1}
    >>> design = ts.SpreadDesign(spread={"scene": "spheres", "observe": "Qx"}, uncertain=[mu])
    >>> [one.text for one in design.inputs()[0]]
    ['normal, 0.4013 ± 0.0401']
    """

    spread: Spread = entry("the spread")
    uncertain: tuple[Uncertain, ...] = entry(
        "uncertain keys", "at least one [[uncertain]]", min_length=1
    )
    correlation: tuple[Correlation, ...] = entry("correlations", "a list of tables", ())
    error_class: ClassVar[type[SceneError]] = SpreadError
    checks: ClassVar[tuple[Check, ...]] = (_check_keys,)

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Put a folder before paths of fits and of the scene; return the tables."""
        match super().resolve_files(folder, tables):
            case {"uncertain": list(items)}:
                for item in items:
                    for name in ("from", "fit"):
                        if isinstance(item, dict) and isinstance(item.get(name), str):
                            item[name] = str(folder / item[name])
        return tables

    def inputs(self) -> tuple[list[Input], np.ndarray]:
        """Return the uncertain keys, and the correlation matrix of their scores.

        Raises
        ------
        SpreadError
            If a fit determines no value, a key is given twice, or no such correlations exist.
        ResultsError
            If a fit cannot be read.
        """
        inputs, blocks = list[Input](), list[np.ndarray]()
        for k, table in enumerate(self.uncertain):
            if table.fit is None:
                inputs.append(Input.from_table(table, self.spread.scene))
                blocks.append(np.eye(1))
                continue
            more, block = Input.from_fit(table.fit, f"uncertain[{k}].from")
            inputs += more
            blocks.append(block)
        keys = [one.key for one in inputs]
        faults = [Fault("uncertain", f"{key} {n} times", "each key once")
                  for key, n in Counter(keys).items() if n > 1]  # fmt: skip
        matrix, first = np.eye(len(keys)), 0
        for block in blocks:
            rows = slice(first, first + len(block))
            matrix[rows, rows], first = block, rows.stop
        for k, pair in enumerate(self.correlation):
            unknown = [key for key in pair.keys if key not in keys]
            faults += [Fault(f"correlation[{k}].keys", key, f"one of {', '.join(keys)}")
                       for key in unknown]  # fmt: skip
            if not unknown:
                i, j = map(keys.index, pair.keys)
                matrix[i, j] = matrix[j, i] = pair.value
        if not faults and np.linalg.eigvalsh(matrix)[0] < 1e-10:
            cure = "correlations that can occur together: a positive definite matrix"
            faults.append(Fault("correlation", "a matrix that is not positive definite", cure))
        if faults:
            raise SpreadError(faults)
        return inputs, matrix
