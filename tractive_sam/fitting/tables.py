"""Tables of a fit file: data sets, parameters and candidate tests."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.schema import (
    Check,
    Fault,
    Positive,
    Real,
    Table,
    ValidEntries,
    entry,
    optional,
    shorten,
    suggest_name,
)

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
        names = dict.fromkeys(quantity.name for quantity in COLUMNS if quantity.dims in observable)
        yield Fault("observe", shorten(name), suggest_name(name, [*names]))
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
    """Keys that data sets and candidate tests share: observed columns, body, record, settings."""

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
    noise: Positive | Noise = entry("standard deviation of measured values", _NOISE)
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

    @property
    def uncertainty(self) -> Noise:
        """Noise as a table; a number becomes the relative noise."""
        return self.noise if isinstance(self.noise, Noise) else Noise(relative=self.noise)


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
    noise: Positive | Noise = entry("standard deviation of the measurement", _NOISE)
    checks: ClassVar[tuple[Check, ...]] = (_check_test,)

    @property
    def uncertainty(self) -> Noise:
        """Noise as a table; a number becomes the relative noise."""
        return self.noise if isinstance(self.noise, Noise) else Noise(relative=self.noise)
