"""The tables of a fit file: data sets, free parameters and candidate tests, and their checks.

``friction.mu`` of an isotropic law is one number; ``friction.mu[0]`` and ``friction.mu[1]`` are the
numbers of a pair.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self, cast

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.scene import Scene
from tractive_sam.schema import (
    Check,
    Fault,
    Positive,
    Real,
    SceneError,
    Table,
    TomlTable,
    ValidEntries,
    entry,
    optional,
    shorten,
    split_key,
    suggest_name,
)


def base_of(key: str) -> str:
    """Return a dotted key without the index of a pair: "friction.mu" of "friction.mu[0]"."""
    return re.sub(r"\[\d+\]$", "", key)


def value_of(scene: Scene, key: str) -> Any:
    """Return the value of a dotted key in a scene, defaults included; None if it has no value."""
    value: Any = scene.settings()
    for name in split_key(key):
        try:
            value = value[name]
        except (KeyError, IndexError, TypeError):
            return None
    return value


def start_of(scene: Scene, key: str, start: float | None) -> float:
    """Return the first value of a free key: `start`, or that in the scene; SceneError if neither.

    Raises
    ------
    SceneError
        If the scene has no entry of this key, or it is not one number and no start is given.
    """
    Scene.find_field(base_of(key))
    value = value_of(scene, key)
    if isinstance(value, tuple) and len(set(value)) == 1:
        value = value[0]
    if isinstance(value, tuple) and len(value) in (2, 3):
        raise SceneError([Fault(key, shorten(value), f"one of its numbers: {key}[0], {key}[1]")])
    if key != base_of(key) and value is None:
        raise SceneError([Fault(key, "nothing", f"a scene that gives the pair {base_of(key)}")])
    if value is not None and (isinstance(value, bool) or not isinstance(value, int | float)):
        raise SceneError([Fault(key, shorten(value), "the key of a number")])
    first = value if start is None else start
    if first is None:
        raise SceneError([Fault(key, "nothing", "a value in the scene, or a first one")])
    return float(first)


def is_integer(scene: Scene, key: str) -> bool:
    """Return whether the value of a dotted key in a scene is an integer."""
    return type(value_of(scene, key)) is int


def changes_of(scene: Scene, values: Mapping[str, float]) -> dict[str, Any]:
    """Return scene entries that set keys to values: integers rounded, a pair in one entry."""
    changes: dict[str, Any] = {}
    for key, value in values.items():
        base = base_of(key)
        new: Any = round(value) if is_integer(scene, key) else value
        if base != key:
            pair = list(changes.get(base, value_of(scene, base)))
            pair[int(key[len(base) + 1 : -1])] = new
            new = tuple(pair)
        changes[base] = new
    return changes


COORDINATES = ("revolution", "distance")
"""Columns of a record that `vary` may name: the record instead of an entry of the scene."""

DEPTH = "depth"
"""Column of a data file that holds the measured profile."""


def _as_tuple(value: object) -> object:
    """Return a single text or number as a tuple of one; other values unchanged."""
    is_single = isinstance(value, str | int | float) and not isinstance(value, bool)
    return (value,) if is_single else value


def _check_distinct(values: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names; raise a ValueError if one is repeated."""
    if len(set(values)) < len(values):
        raise ValueError("each name once")
    return values


def _flatten(entries: object, before: str = "") -> object:
    """Return nested tables as one table by dotted key; other values unchanged."""
    if not isinstance(entries, Mapping):
        return entries
    flat: dict[str, Any] = {}
    for key, value in entries.items():
        inner = _flatten(value, f"{before}{key}.") if isinstance(value, Mapping) else None
        flat |= inner if isinstance(inner, dict) else {f"{before}{key}": value}
    return flat


def _as_lists(columns: object) -> object:
    """Return columns that are arrays as lists, which the text of a fit file can hold."""
    if not isinstance(columns, Mapping):
        return columns
    return {
        str(name): getattr(column, "tolist", lambda column=column: column)()
        for name, column in columns.items()
    }


Names = Annotated[tuple[str, ...], BeforeValidator(_as_tuple), AfterValidator(_check_distinct)]
Numbers = Annotated[tuple[Real, ...], BeforeValidator(_as_tuple), Field(min_length=1)]
Columns = Annotated[dict[str, Any], BeforeValidator(_as_lists)]
Changes = Annotated[dict[str, Any], BeforeValidator(_flatten)]

_NOISE = (
    "a relative standard deviation, { absolute = ... }, { relative = ... }, { factor = ... } or "
    "{ column = ... }"
)


def _check_noise(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault of a noise table that is empty, or has "column" or "factor" with other keys."""
    if not entries.given:
        yield Fault("noise", "nothing", _NOISE)
    for key in ("column", "factor"):
        if key in entries.given and len(entries.given) > 1:
            yield Fault(key, "together with other keys", f"{key} without other keys")


class Noise(Table):
    """Table of the standard deviation of measured values: absolute, relative, factor or a column.

    Examples
    --------
    >>> from tractive_sam.fitting.design import Noise
    >>> Noise(absolute=0.2).absolute
    0.2
    """

    absolute: Positive | None = optional("in units of the observation")
    relative: Positive | None = optional("over the predicted value")
    factor: Real | None = optional(
        "factor of one standard deviation of the logarithm: 1.2 for a scatter of 20 %; the "
        "residual is one of logarithms",
        "a number above 1",
        gt=1.0,
    )
    column: str | None = optional("column of the file that holds it", "a name")
    checks: ClassVar[tuple[Check, ...]] = (_check_noise,)


def _check_observations(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of observed columns that do not exist or cannot be observed."""
    for name in entries["observe"]:
        yield from observation_faults(name, entries["body"])


def observation_faults(name: str, body: str | None) -> Iterator[Fault]:
    """Yield faults of an observed column: unknown, without body, neither number nor profile."""
    # Dimensions of columns that can be observed: numbers, profiles, and numbers of each body.
    observable = ((), ("y",), ("body",))
    table = index_by_name(COLUMNS)
    if name not in table:
        names = {one.name: one.long_name for one in COLUMNS if one.dims in observable}
        yield Fault("observe", shorten(name), suggest_name(name, names, names))
    elif table[name].dims == ("body",) and body is None:
        yield Fault("body", f"nothing, and observe = {shorten(name)}", '"A" or "B"')
    elif table[name].dims not in observable:
        yield Fault("observe", shorten(name), "a number of a record, or a profile over y")


def column_of(name: str, body: str | None) -> str:
    """Return the history column of an observation, with the body: "name A", or "name_A" over y."""
    quantity = index_by_name(COLUMNS)[name]
    if body is None or f"{name}_{body}" not in index_by_name(COLUMNS) or quantity.dims != ("y",):
        return name if quantity.dims != ("body",) else f"{name} {body}"
    return f"{name}_{body}"


def _check_profile(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of a profile with other columns or `vary`, and of `nuisance` without one."""
    profiles = [name for name in entries["observe"] if is_profile(name)]
    if profiles and len(entries["observe"]) > 1:
        yield Fault("observe", shorten(entries["observe"]), f"{profiles[0]} without other columns")
    if profiles and entries["vary"]:
        cure = "nothing: rows of a profile are its points; at = ... chooses the revolution"
        yield Fault("vary", shorten(entries["vary"]), cure)
    if profiles and isinstance(entries["noise"], Noise) and entries["noise"].factor:
        cure = "absolute = ..., as depths may be zero"
        yield Fault("noise.factor", f"{entries['noise'].factor:g}", cure)
    if not profiles and "nuisance" in entries.given:
        yield Fault("nuisance", "without a profile", "only with a profile over y")


def is_profile(name: str) -> bool:
    """Return whether an observed column is a profile over y."""
    table = index_by_name(COLUMNS)
    return name in table and table[name].dims == ("y",)


def _check_source(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault unless exactly one of file and values is given."""
    if ("file" in entries.given) == ("values" in entries.given):
        yield Fault("file", "both or neither of file and values", "exactly one of file, values")


def _check_place(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults if `at` and `vary` both choose the record, or `vary` by two coordinates."""
    places = [key for key in entries["vary"] if key in COORDINATES]
    if places and entries["at"] is not None:
        yield Fault("at", f"{entries['at']:g}, and {places[0]} varies", "at or vary, not both")
    if len(places) > 1:
        yield Fault("vary", shorten(places), "only one of revolution and distance")


class Observation(Table):
    """Keys that data sets and candidate tests share: columns, body, record, settings, noise."""

    observe: Names = entry(
        "columns of a record that are observed", "a name, or a list of names", min_length=1
    )
    body: Literal["A", "B"] | None = optional("body of a column that both bodies have")
    at: Real | None = optional(
        "revolution or distance of the observed record; the last by default; 0: unworn bodies", ge=0
    )
    set: Changes = entry(
        "entries of the scene for this test", "a table of dotted keys", default_factory=dict
    )
    noise: Positive | Noise = entry("standard deviation of measured values", _NOISE)

    @property
    def uncertainty(self) -> Noise:
        """Noise as a table; a number becomes the relative noise."""
        return self.noise if isinstance(self.noise, Noise) else Noise(relative=self.noise)


class Data(Observation):
    """A [[fit.data]] table: measurements of one test, or of one series of tests.

    Examples
    --------
    >>> from tractive_sam.fitting.design import Data
    >>> Data(file="creep.csv", vary="creepage.longitudinal", observe="Qx", noise=0.05).vary
    ('creepage.longitudinal',)
    """

    file: str | None = optional("file with a header row and columns", "a file name")
    values: Columns | None = optional(
        "the columns themselves, instead of a file", "a table of lists of numbers"
    )
    vary: Names = entry(
        "columns that are set in the scene, row by row; revolution and distance choose the record",
        "a dotted key, or a list of them",
        (),
    )
    nuisance: Annotated[
        tuple[Literal["offset", "tilt", "level"], ...], BeforeValidator(_as_tuple)
    ] = entry(
        "unknown position of a profile: lateral offset, tilt and level of the datum line",
        'a list of "offset", "tilt", "level"',
        ("offset", "tilt", "level"),
    )
    columns: dict[str, str] = entry(
        "names of columns in the file, by the names that this table uses",
        "a table of texts",
        default_factory=dict,
    )
    label: str = entry("name in messages and figures", default="")
    checks: ClassVar[tuple[Check, ...]] = (
        _check_source,
        _check_observations,
        _check_profile,
        _check_place,
    )

    @property
    def name(self) -> str:
        """Label of the data set, or else the name of its file; "" without both."""
        return self.label or (Path(self.file).name if self.file else "")

    @property
    def profile(self) -> bool:
        """Whether the data set observes a profile over y."""
        return is_profile(self.observe[0])


def _check_bounds(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults if the lower bound is not below the upper one, or the start is outside them."""
    lower, upper, start = entries["lower"], entries["upper"], entries["start"]
    if lower is not None and upper is not None and lower >= upper:
        yield Fault("upper", f"{upper:g}", f"above lower, {lower:g}")
    elif start is not None:
        if lower is not None and start < lower:
            yield Fault("start", f"{start:g}", f"at least lower, {lower:g}")
        if upper is not None and start > upper:
            yield Fault("start", f"{start:g}", f"at most upper, {upper:g}")


def _check_scale(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of values without a logarithm if scale = "log"."""
    if entries["scale"] == "log":
        for key in ("start", "lower", "upper"):
            value = entries[key]
            if value is not None and (value < 0.0 or (value == 0.0 and key != "lower")):
                yield Fault(key, f"{value:g}", 'a number above 0, or scale = "linear"')


def _check_prior(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault of a prior without a positive standard deviation."""
    prior = entries["prior"]
    if prior is not None and prior[1] <= 0.0:
        yield Fault("prior", shorten(prior), "a standard deviation above 0")


class Parameter(Table):
    """A [[fit.parameter]] table: start, bounds, prior and scale of a free key.

    Examples
    --------
    >>> from tractive_sam.fitting.design import Parameter
    >>> Parameter(key="friction.mu", lower=0.05, upper=1.0).lower
    0.05
    """

    key: str = entry("the free entry", "one of free")
    start: Real | None = optional("first value; by default the value in the scene")
    lower: Real | None = optional("lower bound")
    upper: Real | None = optional("upper bound")
    prior: tuple[Real, Real] | None = optional(
        "normal distribution known before the data", "[mean, standard deviation]"
    )
    scale: Literal["log", "linear"] | None = optional(
        "in what it is fitted; by default the logarithm of a positive one"
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_bounds, _check_scale, _check_prior)


def _check_test(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of the observations and values of a candidate test."""
    for name in entries["observe"]:
        if is_profile(name):
            yield Fault("observe", shorten(name), "a number of a record")
        else:
            yield from observation_faults(name, entries["body"])
    if (entries["vary"] is None) != (entries["values"] is None):
        yield Fault("values", "only one of vary and values", "both, or neither")


class CandidateTest(Observation):
    """A [[fit.test]] table: tests that could be made next, one for each value of `vary`.

    Examples
    --------
    >>> from tractive_sam.fitting.design import CandidateTest
    >>> creepages = {"vary": "creepage.longitudinal", "values": [-0.001, -0.01]}
    >>> CandidateTest(observe="Qx_over_P", noise=0.05, **creepages).values
    (-0.001, -0.01)
    """

    vary: str | None = optional("the entry that differs", "a dotted key")
    values: Numbers | None = optional("its values", "a list of numbers")
    checks: ClassVar[tuple[Check, ...]] = (_check_test,)


class FitError(SceneError):
    """Error: a fit cannot be made; lists every fault that was found.

    Examples
    --------
    >>> try:
    ...     ts.FitDesign(fit={"scene": "spheres", "free": "friction.mu"})
    ... except ts.FitError as error:
    ...     print(error.faults[0].key)
    fit.data
    """

    subject: ClassVar[str] = "fit"


def _check_parameters(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of [[parameter]] tables with a key that is not free or is given twice."""
    free = entries["free"]
    for k, table in enumerate(entries["parameter"]):
        if table.key not in free:
            yield Fault(f"parameter[{k}].key", shorten(table.key), suggest_name(table.key, free))
    keys = [table.key for table in entries["parameter"]]
    for key in {key for key in keys if keys.count(key) > 1}:
        yield Fault("parameter", f"{key} {keys.count(key)} times", "one table for each key")


def _check_free_keys(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of free keys without a numeric start, or of a pair freed with its numbers."""
    parameters = {table.key: table for table in entries["parameter"]}
    for key in entries["free"]:
        try:
            start_of(entries["scene"], key, parameters[key].start if key in parameters else None)
        except SceneError as error:
            yield from (Fault("free", f"{shorten(key)}: {fault.given}", fault.allowed)
                        for fault in error.faults)  # fmt: skip
    for key in entries["free"]:
        if key != base_of(key) and base_of(key) in entries["free"]:
            yield Fault("free", f"{key} and {base_of(key)}", "the pair or its numbers, not both")


def _check_varied_keys(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of varied or set keys that are free or unknown."""
    bases = {base_of(key) for key in entries["free"]}
    for name in ("data", "test"):
        for k, data in enumerate(entries[name]):
            varied = (data.vary,) if isinstance(data.vary, str) else data.vary or ()
            chosen = [key for key in varied if name == "test" or key not in COORDINATES]
            for source, key in [
                *(("vary", key) for key in chosen),
                *(("set", k) for k in data.set),
            ]:
                if key in bases:
                    yield Fault(f"{name}[{k}].{source}", key, "an entry that is not free")
                elif (fault := _find_unknown_key(key)) is not None:
                    yield Fault(f"{name}[{k}].{source}", shorten(key), fault.allowed)


def _find_unknown_key(key: str) -> Fault | None:
    """Return the fault of a key that scenes do not have, or None if they have it."""
    try:
        Scene.find_field(base_of(key))
    except SceneError as error:
        return error.faults[0]
    return None


def _check_target(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault if the target of the next test is not a free key."""
    target, free = entries["target"], entries["free"]
    if target is not None and target not in free:
        yield Fault("target", shorten(target), suggest_name(target, free))


def _check_mesh(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault if the scene has [accuracy], since fits need a constant mesh."""
    if entries["scene"].accuracy is not None:
        cure = "a [grid] or none: the mesh of a fit is fixed while parameters vary"
        yield Fault("scene.accuracy", "a table", cure)


class Fit(Table):
    """The [fit] table of a fit file: scene, free keys, data sets, and settings of the search.

    Examples
    --------
    >>> from tractive_sam.fitting.design import Fit
    >>> creep = {"values": {"Qx": [80.0]}, "observe": "Qx", "noise": 0.05}
    >>> Fit(scene=ts.Scene.builtin("spheres"), free="friction.mu", data=[creep]).loss
    'linear'
    """

    title: str = entry("title", default="")
    scene: Scene = entry("the scene", "a built-in name, a scene file, or the tables of a scene")
    free: Names = entry(
        "numeric keys of the scene that are fitted", "a list of dotted keys", min_length=1
    )
    data: tuple[Data, ...] = entry("the data sets", "at least one [[fit.data]]", min_length=1)
    parameter: tuple[Parameter, ...] = entry("starts, bounds and priors", "a list of tables", ())
    test: tuple[CandidateTest, ...] = entry("candidates of the next test", "a list of tables", ())
    target: str | None = optional(
        "parameter with the uncertainty that the next test is to reduce; by default all together",
        "one of free",
    )
    loss: Literal["linear", "soft_l1", "huber", "cauchy", "arctan"] = entry(
        "loss of a residual; all but linear give less weight to outliers", default="linear"
    )
    starts: int = entry(
        "starts of the search; those beyond the first are random", default=1, ge=1, le=100
    )
    seed: int = entry("seed of random starts", "an integer from 0", 0, ge=0)
    intervals: Literal["linear", "profile"] = entry(
        "intervals by the linearised model, or by the profile likelihood", default="linear"
    )
    scatter: bool = entry("whether the scatter of the residuals scales the noise", default=False)
    level: float = entry("probability of the intervals", default=0.95, ge=0.5, le=0.999)
    step: float | None = optional(
        "step of differences over the value; by default 1e-4 of contacts and 1e-2 of rolls",
        gt=0,
        le=0.2,
    )
    iterations: int = entry("most iterations", default=50, ge=1, le=1000)
    curve: int = entry(
        "points of the model curve of each creep curve, for figures; 0: at measured points only",
        default=25,
        ge=0,
        le=200,
    )
    mesh_check: bool = entry(
        "whether the solution is computed on a finer mesh as well", default=True
    )
    checks: ClassVar[tuple[Check, ...]] = (
        _check_parameters,
        _check_free_keys,
        _check_varied_keys,
        _check_target,
        _check_mesh,
    )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the data sets in messages, tables and figures, each once."""
        names = [data.name for data in self.data]
        keys = {k: f"fit.data[{k}]" for k in range(len(names))}
        return tuple(f"{n} ({keys[k]})" if n and names.count(n) > 1 else n or keys[k]
                     for k, n in enumerate(names))  # fmt: skip


class QuestionDocument(TomlTable):
    """File of a question to scenes: the table that is named as the question has them."""

    several: ClassVar[bool] = False
    """Whether `scene` may be a list; then the entry ``further`` has all but the first of them."""

    @property
    def scenes(self) -> tuple[Scene, ...]:
        """The scenes of the question."""
        table = getattr(self, self.error_class.subject)
        return (table.scene, *(table.further if self.several else ()))

    @classmethod
    def prepare(cls, entries: dict[str, Any], faults: list[Fault]) -> dict[str, Any]:
        """Read the scenes that the table names; raise the error of the class with its faults."""
        name = cls.error_class.subject
        table = entries.get(name)
        if not isinstance(table, Mapping):
            return entries
        given: Any = table.get("scene")
        is_list = cls.several and isinstance(given, list | tuple) and len(given) > 0
        scenes = [*(given if is_list else [given]), *(table.get("further") or ())]
        for k, scene in enumerate(scenes):
            try:
                if isinstance(scene, str):
                    scenes[k] = Scene.from_name(scene)
                elif isinstance(scene, Mapping):
                    scenes[k] = Scene(**scene)
            except SceneError as error:
                key = f"{name}.scene[{k}]" if len(scenes) > 1 else f"{name}.scene"
                raise cls.error_class([fault.under(key) for fault in error.faults]) from None
        first = {} if scenes[0] is None else {"scene": scenes[0]}
        further = {"further": tuple(scenes[1:])} if len(scenes) > 1 else {}
        return {**entries, name: {**table, **first, **further}}

    @classmethod
    def read(cls, design: Self | Mapping[str, Any] | str | PathLike[str]) -> Self:
        """Return a design from a file, from its tables or its first table, or as it is.

        Raises
        ------
        SceneError
            With every fault.
        """
        if isinstance(design, cls):
            return design
        if isinstance(design, Mapping):
            name = cls.error_class.subject
            return cls(**(design if name in design else {name: design}))
        return cls.from_toml(cast("str", design))

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Put a folder before paths of a scene file and the files of a scene; return the tables."""
        table = tables.get(cls.error_class.subject)
        if isinstance(table, dict):
            scenes = table.get("scene")
            for scene in [*(scenes if isinstance(scenes, list) else [scenes]),
                          *(table.get("further") or ())]:  # fmt: skip
                if isinstance(scene, dict):
                    Scene.resolve_files(folder, scene)

            def place(scene: Any) -> Any:
                is_file = isinstance(scene, str) and (folder / scene).is_file()
                return str(folder / scene) if is_file else scene

            if scenes is not None:
                is_list = isinstance(scenes, list)
                table["scene"] = [place(one) for one in scenes] if is_list else place(scenes)
        return tables

    def fix_files(self) -> Self:
        """Return the design whose scenes have their files as they are now, for all computations."""
        name = self.error_class.subject
        scene, *further = (one.with_current_files(fix=True) for one in self.scenes)
        changes = {"scene": scene} | ({"further": tuple(further)} if further else {})
        fixed = getattr(self, name).model_copy(update=changes)
        return self.model_copy(update={name: fixed})


class FitDesign(QuestionDocument):
    """A fit file: the table [fit] with its data sets, parameters and tests.

    Raises
    ------
    FitError
        With every fault.

    Examples
    --------
    >>> creep = {"values": {"Qx": [80.0]}, "observe": "Qx", "noise": 0.05}
    >>> design = ts.FitDesign(fit={"scene": "spheres", "free": "friction.mu", "data": [creep]})
    >>> design.fit.free
    ('friction.mu',)
    """

    fit: Fit = entry("the fit")
    error_class: ClassVar[type[SceneError]] = FitError

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Put a folder before paths of data files and a scene file there; return the tables."""
        match super().resolve_files(folder, tables):
            case {"fit": {"data": list(data)}}:
                for data_set in data:
                    match data_set:
                        case {"file": str(name)}:
                            data_set["file"] = str(folder / name)
        return tables


def question_of(path: str | PathLike[str]) -> str:
    """Return which question a file of TOML contains: "fit", "spread" or "design", or ""."""
    try:
        tables = FitDesign.read_tables(path)
    except SceneError:
        return ""
    return next(
        (name for name in ("fit", "spread", "design") if isinstance(tables.get(name), dict)), ""
    )


def _keys_at_rest(key: str) -> list[str]:
    """Return the keys of friction at rest that limit friction at high speed; none of other keys."""
    is_kinetic = base_of(key) == "friction.kinetic"
    return [key.replace("kinetic", name) for name in ("static", "mu")] if is_kinetic else []


def _bounds_of(fit: Fit, table: Parameter) -> tuple[float, float]:
    """Return the bounds of a parameter: stated, or implied by its key and the friction law."""
    bounds = {"ge": -math.inf, "le": math.inf}
    for rule in Scene.find_field(base_of(table.key)).metadata:
        bounds |= {name: getattr(rule, name) for name in bounds if hasattr(rule, name)}
    at_rest = _keys_at_rest(table.key)
    if at_rest and not {*at_rest} & {*fit.free}:
        bounds["le"] = float(np.min(value_of(fit.scene, at_rest[-1])))
    lower = bounds["ge"] if table.lower is None else table.lower
    return lower, bounds["le"] if table.upper is None else table.upper


@dataclass(frozen=True, eq=False)
class Parameters:
    """Free parameters: bounds, priors, and the map from values v to fitted coordinates u.

    u = 1 + ln(v / start) of a positive one, and 1 + (v - start) / scale of others: all begin at 1,
    and a change by 1 is one of the size of the parameter.

    Attributes
    ----------
    keys : tuple of str
        Keys of the parameters.
    start, scale, lower, upper : ndarray, shape (n,)
        First values, scales of the linear ones, and bounds of the values.
    logarithmic : ndarray of bool, shape (n,)
        Whether the coordinate is a logarithm.
    integer : ndarray of bool, shape (n,)
        Whether the value is an integer.
    prior : ndarray, shape (n, 2)
        Mean and standard deviation known before; nan if unknown.
    """

    keys: tuple[str, ...]
    start: np.ndarray
    scale: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    logarithmic: np.ndarray
    integer: np.ndarray
    prior: np.ndarray

    @classmethod
    def of(cls, fit: Fit) -> Parameters:
        """Return the free parameters of a fit, with start, scale, bounds and priors."""
        given = {table.key: table for table in fit.parameter}
        tables = [given.get(key) or Parameter(key=key) for key in fit.free]
        start = np.array([start_of(fit.scene, table.key, table.start) for table in tables])
        ends = [_bounds_of(fit, table) for table in tables]
        lower, upper = np.array(ends).T
        start = np.clip(start, lower, upper)
        logarithmic = np.array(
            [
                (t.scale or ("log" if value > 0.0 and (t.lower is None or t.lower >= 0.0) else ""))
                == "log"
                for t, value in zip(tables, start, strict=True)
            ]
        )
        prior = np.array([t.prior or (math.nan, math.nan) for t in tables])
        widths = np.stack([np.abs(start), prior[:, 1], upper - lower])
        usable = np.isfinite(widths) & (widths > 0.0)
        scale = np.where(usable.any(axis=0), widths[usable.argmax(axis=0), range(len(start))], 1.0)
        integer = np.array([is_integer(fit.scene, key) for key in fit.free])
        return cls(fit.free, start, scale, lower, upper, logarithmic, integer, prior)

    def __len__(self) -> int:
        return len(self.keys)

    def values(self, u: np.ndarray) -> np.ndarray:
        """Return the values of the parameters at coordinates."""
        u = np.asarray(u, float)[: len(self)]
        linear = self.start + self.scale * (u - 1.0)
        with np.errstate(over="ignore"):
            powers = np.abs(self.start) * np.exp(np.where(self.logarithmic, u - 1.0, 0.0))
        return np.where(self.logarithmic, powers, linear)

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        """Return the coordinates of values of the parameters; the inverse of `values`."""
        values = np.asarray(values, float)
        ratio = np.divide(values, self.start, out=np.ones(len(self)), where=self.logarithmic)
        with np.errstate(divide="ignore"):
            powers = 1.0 + np.log(ratio)
        return np.where(self.logarithmic, powers, 1.0 + (values - self.start) / self.scale)

    def slopes(self, u: np.ndarray) -> np.ndarray:
        """Return the derivative of each value by its coordinate."""
        return np.where(self.logarithmic, self.values(u), self.scale)

    def limits(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return lower and upper bounds, at least 0 for logarithms, with the others at `values`.

        Friction at high speed is at most friction at rest.
        """
        upper = self.upper.copy()
        for k, key in enumerate(self.keys):
            for at_rest in set(_keys_at_rest(key)) & {*self.keys}:
                upper[k] = min(upper[k], values[self.keys.index(at_rest)])
        return np.where(self.logarithmic, np.maximum(self.lower, 0.0), self.lower), upper

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds, in coordinates."""
        lower = np.where(self.logarithmic & (self.lower <= 0.0), 0.0, self.lower)
        return self.coordinates(lower), self.coordinates(self.upper)

    def values_by_key(self, u: np.ndarray) -> dict[str, float]:
        """Return the values of the parameters at coordinates, by key."""
        return dict(zip(self.keys, self.values(u).tolist(), strict=True))
