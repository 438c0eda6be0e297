"""The design of a study: a scene, the axes that vary in it, its cases, and their log.

1a2b3c4d {"digest": "0123456789abcdef", "size": 0, "version": ..., "message": ..., "row": {...}}

The checksum is the CRC-32 of the text after the space, which detects every error of up to three
bits and every burst of up to 32. A line that does not agree with its checksum does not count: the
case is not complete. Lines of version 0.1 have no checksum; they count only before the first line
that has one.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, get_args
from zlib import crc32

import numpy as np
from pydantic import AfterValidator

from tractive_sam import interrupt
from tractive_sam.description import format_setting
from tractive_sam.output_file import append_to_file, write_file
from tractive_sam.scene import (
    FILE_KEYS,
    Scene,
    builtin_names,
    parse_settings,
    resolve_parametric_files,
)
from tractive_sam.schema import (
    Check,
    Fault,
    LawTable,
    Real,
    SceneError,
    Table,
    TomlTable,
    ValidEntries,
    entry,
    optional,
    required,
    shorten,
    suggest_name,
)
from tractive_sam.store import FORMAT_VERSION, GapError, read_gap, versions

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
    values = entries["values"]
    wanted = entries["number"] if values is None else len(values)
    for k, zipped in enumerate(entries["zip"]):
        if len(zipped.column()) != wanted:
            value = f"{len(zipped.column())} values"
            yield Fault(f"zip[{k}].values", value, f"{wanted}, as many as the axis has")


def _check_variables(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys that a Latin hypercube samples twice."""
    yield from _find_repeated_keys("variable", [], entries["variable"])


def _find_repeated_keys(
    name: str, before: list[str], tables: Iterable[Values | Bounds]
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
        lambda entries: _find_repeated_keys("zip", [entries["key"]], entries["zip"]),
    )

    def dimension(self) -> Dimension:
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

    def dimension(self) -> Dimension:
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
    kind = Scene.find_field(key).annotation
    if kind is int or int in get_args(kind):
        return tuple(round(value) for value in values.tolist())
    return tuple(float(f"{value:.{digits}g}") for value in values.tolist())


class StudyError(SceneError):
    """Error that lists all faults of a study and of its scenes.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> ts.Study(scene="spheres", axis=[{"key": "friction.angel", "values": [0, 90]}])
    Traceback (most recent call last):
        ...
    tractive_sam.studies.design.StudyError: 1 fault in the study:
      axis[0].key: given 'friction.angel'; allowed: a dotted key of a scene: angle, perhaps?
    """

    subject: ClassVar[str] = "study"


def _check_axes(entries: ValidEntries) -> Iterator[Fault]:
    """Report a study in which no entry varies."""
    if not entries["axis"] and entries["latin"] is None:
        yield Fault("axis", "nothing", "at least one [[axis]], or a [latin] hypercube")


def _check_entries(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys that vary more than once, and tables that vary together with keys in them."""
    keys = Counter(
        key for dim in _dimensions(entries["axis"], entries["latin"]) for key in dim.columns
    )
    for key, count in keys.items():
        if count > 1:
            yield Fault("axis", f"{key} varies {count} times", "each entry of the scene once")
        within = [entry_key for entry_key in keys if entry_key.startswith(f"{key}.")]
        if within:
            yield Fault("axis", f"{key} and {', '.join(within)}", "a table, or entries within it")


def _parameters_have_a_law(entries: ValidEntries) -> Iterator[Fault]:
    """Report unknown keys in a law's table, unless a user-defined law may have them."""
    keys = [key for dim in _dimensions(entries["axis"], entries["latin"]) for key in dim.columns]
    for key in keys:
        name, _, inner = key.partition(".")
        entry_name = inner.partition(".")[0].partition("[")[0]
        kind = Scene.table_class(Scene.model_fields[name]) if name in Scene.model_fields else None
        if kind is None or not issubclass(kind, LawTable) or entry_name in kind.model_fields:
            continue
        table = getattr(entries["scene"], name)
        has_law = table is not None and table.named_law is not None
        if entry_name and not has_law and f"{name}.{kind.law_key}" not in keys:
            yield Fault("axis", key, suggest_name(entry_name, kind.model_fields))


def _check_count(entries: ValidEntries) -> Iterator[Fault]:
    """Report a study with too many cases."""
    count = math.prod(map(len, _dimensions(entries["axis"], entries["latin"])))
    if count > MAX_CASES:
        yield Fault("axis", f"{count} cases", f"at most {MAX_CASES:.0e}")


class Study(TomlTable):
    """Study: a scene, and entries of it that vary; every combination of the axes is a case.

    Parameters
    ----------
    scene : Scene, str or mapping
        The scene: a scene, the name of a built-in one, a scene file, or the tables of one.
    axis : iterable of Axis or mapping
        See `Axis`; the last one varies fastest.
    latin : Latin or mapping, optional
        Entries that vary together at random, see `Latin`.
    set : iterable of str
        Settings of the scene, as ``solver.tolerance=1e-9``.
    without : iterable of str
        Entries and tables of the scene to leave out, as ``subsurface``.
    keep : str
        "all", a results file for each case, or "scalars", the numbers of its last record alone: all
        cases in one file.
    title : str
        Title.

    Raises
    ------
    StudyError
        With every fault of the study.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> study = ts.Study(
    ...     scene="twin-discs",
    ...     set=["wear.revolutions=1000"],
    ...     axis=[
    ...         {"key": "friction.angle", "values": [0, 45, 90]},
    ...         {"key": "load.normal", "start": 100, "stop": 400, "number": 4},
    ...     ],
    ... )
    >>> study.shape, len(study)
    ((3, 4), 12)
    """

    title: str = entry("title", default="")
    scene: Scene = entry("the scene", "a built-in name, a scene file, or the tables of a scene")
    axis: tuple[Axis, ...] = entry("the axes", "a list of tables", ())
    latin: Latin | None = optional("the Latin hypercube")
    keep: Literal["all", "scalars"] = entry(
        "what is stored of each case: a results file, or the numbers of its last record",
        default="all",
    )
    checks: ClassVar[tuple[Check, ...]] = (
        _check_axes,
        _check_entries,
        _parameters_have_a_law,
        _check_count,
    )
    error_class: ClassVar[type[SceneError]] = StudyError

    @classmethod
    def prepare(cls, entries: dict[str, Any], faults: list[Fault]) -> dict[str, Any]:
        """Apply the entries `set` and `without` to the scene."""
        settings, without = entries.pop("set", ()), entries.pop("without", ())
        allowed = (*cls.model_fields, "set", "without")
        faults += (
            Fault(key, shorten(entries.pop(key)), suggest_name(key, allowed))
            for key in [*entries]
            if key not in allowed
        )
        try:
            scene = _apply_settings(entries.get("scene"), settings, without)
        except SceneError as error:
            faults += error.faults
            scene = Scene.builtin(builtin_names()[0])  # so that the rest is checked as well
        return entries | {"scene": scene}

    def entries(self) -> dict[str, Any]:
        """Return the given entries, with the scene written out and its settings applied.

        Relative files in it, which are sought from the working folder, become absolute.
        """
        return self.resolve_files(Path.cwd(), super().entries())

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Make relative paths in a study's tables start from a folder; SceneError for a scene."""
        if "body" in tables:
            cure = 'scene = "FILE.toml", or them in [scene]; tractive-sam run computes a scene'
            raise SceneError([Fault(Fault.FILE, "the tables of a scene", cure)])
        match tables:
            case {"set": list(settings)}:
                tables["set"] = [_setting_from(folder, setting) for setting in settings]
        return resolve_parametric_files(folder, tables)

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Dimensions in which cases are counted (axes, samples), the last one fastest."""
        return _dimensions(self.axis, self.latin)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each dimension of the study."""
        return tuple(map(len, self.dimensions))

    def __len__(self) -> int:
        return math.prod(self.shape)


def is_study(path: str | PathLike[str]) -> bool:
    """Return whether a file is TOML with axes or a Latin hypercube of a study.

    Examples
    --------
    >>> from tractive_sam.studies import is_study
    >>> is_study("twin-discs")  # a scene, and no file
    False
    """
    try:
        return bool({"axis", "latin"} & Study.read_tables(path).keys())
    except SceneError:
        return False


def _setting_from(folder: Path, setting: Any) -> Any:
    """Return a setting ("key=value") with its relative file path starting from a folder."""
    if not isinstance(setting, str) or setting.partition("=")[0].strip() not in FILE_KEYS:
        return setting
    ((key, file),) = parse_settings([setting]).items()
    return f"{key}={folder / str(file)}"


def _dimensions(axes: Iterable[Axis], latin: Latin | None) -> tuple[Dimension, ...]:
    """Return the dimensions of axes, followed by the one of a Latin hypercube."""
    of_axes = tuple(axis.dimension() for axis in axes)
    return of_axes if latin is None else (*of_axes, latin.dimension())


def _apply_settings(scene: Any, settings: Any, without: Any) -> Scene:
    """Return the scene of a study without some tables, and with its settings applied."""
    faults = [
        Fault(name, shorten(value), f"a list of {kind}")
        for name, value, kind in (
            ("set", settings, "settings like solver.tolerance=1e-9"),
            ("without", without, "keys like subsurface"),
        )
        if not isinstance(value, list | tuple) or not all(isinstance(text, str) for text in value)
    ]
    if faults:
        raise SceneError(faults)
    if not isinstance(scene, Scene | Mapping | str):
        value = "nothing" if scene is None else shorten(scene)
        allowed = Study.model_fields["scene"].description or "a scene"
        raise SceneError([Fault("scene", value, allowed)])
    _check_keys(without)
    try:
        if isinstance(scene, Scene):
            scene = scene.replace(**dict.fromkeys(without)) if without else scene
            return scene.with_set(settings) if settings else scene
        tables = Scene.tables_from_name(scene) if isinstance(scene, str) else scene
        return Scene.from_tables(tables, settings, without)
    except SceneError as error:
        raise SceneError(fault.under("scene") for fault in error.faults) from None


def _check_keys(without: Iterable[str]) -> None:
    """Raise a SceneError unless scenes have all of these keys."""
    for key in without:
        try:
            Scene.find_field(key)
        except SceneError as error:
            raise SceneError(replace(fault, key="without") for fault in error.faults) from None


DIGEST = 16
"""Hexadecimal digits of the hash of a scene."""


@dataclass(frozen=True)
class Case:
    """One case of a study: its number, the values that vary, and its scene.

    Attributes
    ----------
    number : int
        Index among all cases; the last dimension varies fastest.
    changes : mapping of str to object
        Values that vary, by dotted key.
    scene : Scene
        The scene.
    digest : str
        Hash of the scene without its title.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import cases
    >>> study = ts.Study(scene="spheres", axis=[{"key": "friction.mu", "values": [0.2, 0.4]}])
    >>> case = cases(study)[1]
    >>> print(case)
    case 1 (friction.mu = 0.4)
    >>> case.scene.friction.mu
    (0.4, 0.4)
    """

    number: int
    changes: dict[str, Any]
    scene: Scene
    digest: str

    @property
    def name(self) -> str:
        """File name of the case without suffix: its number and the hash of its scene."""
        return f"{self.number:05d}-{self.digest}"

    def __str__(self) -> str:
        values = ", ".join(f"{k} = {format_setting(value)}" for k, value in self.changes.items())
        return f"case {self.number} ({values})"


def cases(study: Study) -> list[Case]:
    """Return all cases of a study; StudyError with the faults of all their scenes.

    Raises
    ------
    StudyError
        With the faults of all scenes that are not valid, each once.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import cases
    >>> angles = {"key": "friction.angle", "values": [0, 45, 90]}
    >>> loads = {"key": "load.normal", "values": [100.0, 300.0]}
    >>> len(cases(ts.Study(scene="twin-discs", axis=[angles, loads])))
    6
    """
    listed: list[Case] = []
    faults: dict[tuple[str, str], list[tuple[Fault, Case]]] = {}
    seen: dict[str, Case] = {}
    base = study.scene.with_current_files(fix=True)
    for number, changes in enumerate(_changes(study)):
        interrupt.raise_if_interrupted()
        try:
            scene = base.replace(**changes).with_current_files(fix=True)
            for key, table in {"gap": scene.gap, **scene.schedule.profiles}.items():
                if table is not None and table.file is not None:
                    read_gap(table, key)
            case = Case(number, changes, scene, _digest(scene))
        except SceneError as error:
            case, new = Case(number, changes, study.scene, ""), list(error.faults)
        except GapError as error:
            case = Case(number, changes, study.scene, "")
            new = [Fault(error.key, error.given, error.allowed)]
        else:
            twin = seen.setdefault(case.digest, case)
            allowed = f"scenes that differ; {twin} is equal"
            new = [] if twin is case else [Fault("axis", "a scene twice", allowed)]
            listed.append(case)
        for fault in new:
            faults.setdefault((fault.key, fault.given), []).append((fault, case))
    if faults:  # many cases share a fault: it is reported once, with their number
        wheres = [
            f"{same[0][1]}" if len(same) == 1 else f"{same[0][1]} and {len(same) - 1} more"
            for same in faults.values()
        ]
        raise StudyError(
            replace(same[0][0], given=f"{same[0][0].given} in {where}")
            for same, where in zip(faults.values(), wheres, strict=True)
        )
    return listed


def _changes(study: Study) -> Iterator[dict[str, Any]]:
    """Yield the values by key of every case."""
    dimensions = study.dimensions
    for index in np.ndindex(study.shape):
        places = zip(dimensions, index, strict=True)
        yield {key: value for dimension, k in places for key, value in dimension.at(k).items()}


def _digest(scene: Scene) -> str:
    """Return a hash of a scene, of the files it names, and of the methods' version.

    Results of versions with different methods or files are never mixed.
    """
    return hashlib.sha256(f"{scene.fingerprint()} {_generation()}".encode()).hexdigest()[:DIGEST]


@cache
def _generation() -> str:
    """Return the text "major.minor format" of the package's methods and its results format."""
    first, second, *_ = (*versions()["tractive-sam"].split("."), "")
    return f"{first}.{second} {FORMAT_VERSION}"


def title_of(key: str) -> str:
    """Return the meaning and unit of a key of the scene, for titles."""
    title = Scene.find_field(key).title or key
    within, bracket, _ = key.rpartition("].")
    return f"{within}]: {title}" if bracket else title


@dataclass(frozen=True)
class LoggedCases:
    """Entries of the log of complete cases, and the number of damaged lines.

    Attributes
    ----------
    entries : mapping of str to mapping
        The last entry of each case, by the hash of its scene.
    damaged : int
        Number of lines that are damaged, or cut as a killed client leaves them.
    """

    entries: Mapping[str, Mapping[str, Any]]
    damaged: int

    @property
    def damage_note(self) -> str:
        """Note on damaged lines of the log; empty if there are none."""
        if not self.damaged:
            return ""
        lines = "1 line is" if self.damaged == 1 else f"{self.damaged} lines are"
        cure = "the cases that have no results file are computed again by tractive-sam study"
        return f"complete.jsonl: {lines} damaged or cut and not used; {cure}"


class CaseLog:
    """File that logs the complete cases of a study, line by line with checksums.

    Parameters
    ----------
    path : Path
        The file; it need not exist.
    """

    checked = re.compile(rb"([0-9a-f]{8}) (.*)", re.DOTALL)

    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self) -> LoggedCases:
        """Return the last undamaged entry of each case, and the number of damaged lines."""
        lines = self._lines()
        entries = [entry for _, entry in lines if entry is not None]
        by_case = {entry["digest"]: entry for entry in entries}
        return LoggedCases(by_case, len(lines) - len(entries))

    def append(self, entry: Mapping[str, Any]) -> None:
        """Append an entry as a line with a checksum.

        Raises
        ------
        OutputError
            If the disk does not take it; the entries before remain.
        """
        text = json.dumps(entry).encode()
        # The end of line closes what a killed client may have left of its last line.
        append_to_file(self.path, b"\n%08x %b" % (crc32(text), text))

    def drop_damaged(self) -> None:
        """Rewrite the log without lines that are damaged or cut.

        Raises
        ------
        OutputError
            If the disk does not take the rest; nothing has changed then.
        """
        undamaged = [line for line, entry in self._lines() if entry is not None]
        write_file(self.path, b"".join(b"\n%b" % line for line in undamaged))

    def _lines(self) -> list[tuple[bytes, dict[str, Any] | None]]:
        """Return (line, entry) of each line of the log; the entry of a damaged line is None."""
        if not self.path.is_file():
            return []
        lines, checked_before = [], False
        for line in filter(None, self.path.read_bytes().split(b"\n")):
            checked = self.checked.fullmatch(line)
            entry = None
            if checked and int(checked[1], 16) == crc32(checked[2]):
                entry, checked_before = _entry(checked[2]), True
            elif not checked_before:
                entry = _entry(line)
            lines.append((line, entry))
        return lines


def _entry(text: bytes) -> dict[str, Any] | None:
    """Return the entry that a line contains; None if the line is damaged or cut."""
    try:
        entry = json.loads(text)
    except ValueError:
        return None
    match entry:
        case {
            "digest": str(),
            "size": int(),
            "version": str(),
            "message": str(),
            "row": dict(row),
        } if all(isinstance(value, int | float) for value in row.values()):
            return entry
    return None
