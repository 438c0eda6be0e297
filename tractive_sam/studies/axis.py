"""The axes of a study: keys of the scene and their values."""

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, get_args

import numpy as np
from pydantic import AfterValidator

from tractive_sam.scene import Scene
from tractive_sam.schema import (
    Check,
    Fault,
    Real,
    SceneError,
    Table,
    ValidEntries,
    entry,
    optional,
    required,
    shorten,
)

MAX_CASES = 1_000_000
"""Cases of a study, and values of an axis."""

SAMPLE = "sample"
"""Name of the dimension of a Latin hypercube."""


def _check_key(key: str) -> str:
    """Return a key unchanged; raise a ValueError unless scenes have it."""
    try:
        Scene.find_field(key)
    except SceneError as error:
        raise ValueError(f"a dotted key of a scene: {error.faults[0].allowed}") from None
    return key


Key = Annotated[str, AfterValidator(_check_key)]
Spacing = Literal["linear", "logarithmic"]

_KEY = "a dotted key of a scene, like friction.angle"
_SPACING = '"linear" or "logarithmic"'


def _check_values(entries: ValidEntries) -> Iterator[Fault]:
    """Report an axis without values and complete range, or with both."""
    ends = [name for name in ("start", "stop", "number") if name in entries.given]
    allowed = "values, or start, stop and number; not both"
    if "values" in entries.given:
        if ends:
            yield Fault("values", f"together with {', '.join(ends)}", allowed)
    elif len(ends) < 3:
        yield Fault("values", f"only {', '.join(ends)}" if ends else "nothing", allowed)


def _check_distinct(entries: ValidEntries) -> Iterator[Fault]:
    """Report a value that is repeated in an axis."""
    values = entries["values"] or ()
    if len({_make_hashable(value) for value in values}) < len(values):
        yield Fault("values", shorten(values), "each value once")


def _make_hashable(value: Any) -> Any:
    """Return a hashable copy of a value of a scene."""
    match value:
        case Mapping():
            return frozenset((key, _make_hashable(item)) for key, item in value.items())
        case list() | tuple():
            return tuple(map(_make_hashable, value))
        case np.ndarray():
            return _make_hashable(value.tolist())
        case Hashable():
            return value
    return repr(value)


def _check_spacing(entries: ValidEntries) -> Iterator[Fault]:
    """Report a logarithmic range unless both ends have the same sign."""
    start, stop = entries["start"], entries["stop"]
    if entries["spacing"] == "logarithmic" and start is not None and stop is not None:
        if start * stop > 0.0:
            return
        yield Fault("spacing", f"logarithmic from {start:g} to {stop:g}", "two numbers of one sign")


def _check_range(entries: ValidEntries) -> Iterator[Fault]:
    """Report a range with equal start and stop."""
    if entries["start"] is not None and entries["start"] == entries["stop"]:
        yield Fault("stop", f"{entries['stop']:g}", "another number than start")


class Values(Table):
    """Key of the scene with its values: a list, or a range from start to stop.

    Examples
    --------
    >>> from tractive_sam.studies import Values
    >>> Values(key="load.normal", start=1, stop=100, number=3, spacing="logarithmic").column()
    (1.0, 10.0, 100.0)
    """

    key: Key = entry("the entry that varies", _KEY)
    values: tuple[Any, ...] | None = optional(
        "the values, one by one", "a list of at least one value", min_length=1
    )
    start: Real | None = optional("first value of a range")
    stop: Real | None = optional("last value of a range")
    number: int | None = optional("number of values of a range", ge=2, le=MAX_CASES)
    spacing: Spacing = entry("spacing of a range", default="linear")
    checks: ClassVar[tuple[Check, ...]] = (_check_values, _check_spacing, _check_range)

    def column(self) -> tuple[Any, ...]:
        """Return the values of the key, listed or computed from the range."""
        if self.values is not None:
            return self.values
        number, start, stop = (
            required(getattr(self, name), name) for name in ("number", "start", "stop")
        )
        return _spread_values(self.key, start, stop, self.spacing, np.linspace(0.0, 1.0, number))


def _check_lengths(entries: ValidEntries) -> Iterator[Fault]:
    """Report zipped keys with another number of values than the axis."""
    wanted = _length(entries["values"], entries["number"])
    for k, zipped in enumerate(entries["zip"]):
        if len(zipped.column()) != wanted:
            value = f"{len(zipped.column())} values"
            yield Fault(f"zip[{k}].values", value, f"{wanted}, as many as the axis has")


def _length(values: tuple | None, number: int | None) -> int | None:
    """Return the number of values in a list; if there is no list, the number of a range."""
    return number if values is None else len(values)


def _check_zipped_entries(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys that are zipped twice, or with themselves."""
    yield from _find_repeated_keys("zip", [entries["key"]], entries["zip"])


def _check_variables(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys that a Latin hypercube samples twice."""
    yield from _find_repeated_keys("variable", [], entries["variable"])


def _find_repeated_keys(
    name: str, before: list[str], tables: Iterable["Values | Bounds"]
) -> Iterator[Fault]:
    """Yield a fault for each table with a key that is already among those before it."""
    for k, table in enumerate(tables):
        if table.key in before:
            yield Fault(f"{name}[{k}].key", f"{table.key} again", "each entry of the scene once")
        before = [*before, table.key]


class Axis(Values):
    """Axis of a study: a key with values; keys zipped with it vary together with it.

    Examples
    --------
    >>> from tractive_sam.studies import Axis
    >>> friction = {"key": "friction.mu", "values": [0.2, 0.4]}
    >>> axis = Axis(key="load.normal", values=[100.0, 300.0], zip=[friction])
    >>> axis.dimension().at(1)
    {'load.normal': 300.0, 'friction.mu': 0.4}
    """

    zip: tuple[Values, ...] = entry("entries that vary together with this one", default=())
    checks: ClassVar[tuple[Check, ...]] = (
        *Values.checks,
        _check_distinct,
        _check_lengths,
        _check_zipped_entries,
    )

    def dimension(self) -> "Dimension":
        """Return the values of the axis and its zipped keys as one dimension of the cases."""
        columns = {axis.key: axis.column() for axis in (self, *self.zip)}
        return Dimension(self.key, columns)


class Bounds(Table):
    """Key of the scene and the interval in which a Latin hypercube samples it.

    Examples
    --------
    >>> from tractive_sam.studies import Bounds
    >>> Bounds(key="friction.mu", start=0.1, stop=0.6).spacing
    'linear'
    """

    key: Key = entry("the entry that varies", _KEY)
    start: Real = entry("one end of the interval")
    stop: Real = entry("the other end of the interval")
    spacing: Spacing = entry("in what it is uniform", default="linear")
    checks: ClassVar[tuple[Check, ...]] = (_check_spacing, _check_range)


class Latin(Table):
    """Latin hypercube: random samples that divide the interval of every key evenly.

    Examples
    --------
    >>> from tractive_sam.studies import Latin
    >>> latin = Latin(number=2, variable=[{"key": "friction.mu", "start": 0.0, "stop": 1.0}])
    >>> low, high = sorted(latin.dimension().columns["friction.mu"])
    >>> low < 0.5 < high
    True
    """

    number: int = entry("number of samples", ge=1, le=MAX_CASES)
    variable: tuple[Bounds, ...] = entry(
        "entries and intervals", "a list of at least one table", min_length=1
    )
    seed: int = entry("seed of the samples", default=0, ge=0)
    checks: ClassVar[tuple[Check, ...]] = (_check_variables,)

    def dimension(self) -> "Dimension":
        """Return the samples as a dimension of the cases: values of all keys."""
        from scipy.stats import qmc  # half a second, which other studies need not wait for

        hypercube = qmc.LatinHypercube(len(self.variable), rng=np.random.default_rng(self.seed))
        shares = hypercube.random(self.number).T
        columns = {
            variable.key: _spread_values(
                variable.key, variable.start, variable.stop, variable.spacing, share
            )
            for variable, share in zip(self.variable, shares, strict=True)
        }
        return Dimension(SAMPLE, columns)


@dataclass(frozen=True)
class Dimension:
    """Axis or Latin hypercube of a study: a name, and equally long columns of values by key.

    Attributes
    ----------
    name : str
        Key of the axis, or `SAMPLE`.
    columns : mapping of str to tuple
        Values by dotted key, all of one length.

    Examples
    --------
    >>> from tractive_sam.studies import Dimension
    >>> dimension = Dimension("friction.angle", {"friction.angle": (0, 45, 90)})
    >>> len(dimension), dimension.at(1)
    (3, {'friction.angle': 45})
    """

    name: str
    columns: dict[str, tuple[Any, ...]]

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    def at(self, place: int) -> dict[str, Any]:
        """Return the values of the keys at an index along the dimension."""
        return {key: column[place] for key, column in self.columns.items()}


def _spread_values(
    key: str, start: float, stop: float, spacing: Spacing, shares: np.ndarray
) -> tuple[float | int, ...]:
    """Return values at shares 0 to 1 of a linear or logarithmic range; integers for such keys."""
    # Decimal digits of the values of a range: further digits are rounding.
    digits = 12
    if spacing == "logarithmic":
        values = start * (stop / start) ** shares
    else:
        values = start + (stop - start) * shares
    if _is_integer(key):
        return tuple(round(value) for value in values.tolist())
    return tuple(float(f"{value:.{digits}g}") for value in values.tolist())


def _is_integer(key: str) -> bool:
    """Return whether the values of a key of the scene are integers."""
    kind = Scene.find_field(key).annotation
    return kind is int or int in get_args(kind)
