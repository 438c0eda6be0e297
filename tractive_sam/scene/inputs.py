"""Files that a scene names, identified by their content, and the [gap] table that reads them."""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, PlainValidator

from tractive_sam.input_file import open_regular, read_text
from tractive_sam.rail import SECTIONS
from tractive_sam.schema import (
    LARGEST,
    SMALLEST,
    Check,
    Fault,
    FilePath,
    Positive,
    PositivePair,
    Row,
    SceneError,
    Table,
    ValidEntries,
    entry,
    optional,
    warn,
)
from tractive_sam.text_table import LENGTHS

if sys.platform == "win32":
    from pathlib import WindowsPath as _Path
else:
    from pathlib import PosixPath as _Path


@dataclass(frozen=True, eq=False)
class FileContent:
    """Content of a file that a scene names.

    Attributes
    ----------
    path : str
        Absolute path of the file.
    hashes : mapping of str to str
        SHA-256 of the file and of the files that it names, by path.
    parsed : dict
        What was read from the file, by the keys that influence the reading (`describe_reading`); a
        function without arguments stands for content that is read from a results file when needed.
    is_fixed : bool
        Whether a computation that has begun uses the content: if the file changes, it is refused.
    is_stored : bool
        Whether the content comes from a results file, so that the file is not needed.
    """

    known: ClassVar[WeakValueDictionary[tuple[str, str], FileContent]] = WeakValueDictionary()
    """Contents in use, by path and hash: equal files are read once."""

    path: str
    hashes: Mapping[str, str]
    parsed: dict[str, Any] = field(default_factory=dict)
    is_fixed: bool = False
    is_stored: bool = False

    @property
    def digest(self) -> str:
        """Hash of the content, wherever the files are; of a single file its SHA-256."""
        first, *more = self.hashes.values()
        return hashlib.sha256("".join((first, *more)).encode()).hexdigest() if more else first

    def changed_files(self) -> list[str]:
        """Return the paths of the files whose content now differs, or that do not exist."""
        try:
            return self.files_differing_from(FileContent(self.path, hash_files(self.path)))
        except OSError:
            return [self.path]

    def files_differing_from(self, other: FileContent) -> list[str]:
        """Return the paths of the files whose content differs in another content."""
        one, two = self.hashes, other.hashes
        return [path for path in {**one, **two} if one.get(path) != two.get(path)]

    def read(self, reading: str, read_file: Callable[[], Any]) -> Any:
        """Return what a function reads from the file, once for equal keys.

        Raises
        ------
        SceneError
            If the file has changed since the scene was made.
        """
        if reading not in self.parsed:
            value = read_file()
            if changed := self.changed_files():
                allowed = "its content when the scene was made; restore it, or make the scene again"
                raise SceneError([Fault(Fault.FILE, f"{changed[0]}, which has changed", allowed)])
            self.parsed[reading] = value
        elif callable(self.parsed[reading]):
            self.parsed[reading] = self.parsed[reading]()
        return self.parsed[reading]

    def get(self, reading: str) -> Any:
        """Return what was read with these keys; None if nothing was."""
        return self.read(reading, lambda: None) if reading in self.parsed else None

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the content of a results file; other files are read again, and must be equal."""
        parsed = self.parsed if self.is_stored else {}
        return FileContent, (self.path, self.hashes, parsed, self.is_fixed, self.is_stored)


class _Bound:
    """Base class of the values of keys that name a file: they carry its content."""

    content: FileContent | None = None

    @classmethod
    def bind(cls, path: str | Path, content: FileContent | None) -> Self:
        """Return a path that carries the content of its file; None if it cannot be read."""
        bound = cls(path)  # type: ignore[call-arg]
        bound.content = content
        return bound

    def __eq__(self, other: object) -> bool:
        """Return whether a path is equal, with equal content if both have one."""
        contents = self.content, getattr(other, "content", None)
        digests = {content.digest for content in contents if content is not None}
        return super().__eq__(other) if len(digests) < 2 else False

    def __hash__(self) -> int:
        return super().__hash__()

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).bind, (str(self), self.content)


class InputPath(_Bound, _Path):
    """Path of a file that a scene names, with its content."""


class InputName(_Bound, str):
    """Text of a path of a file that a scene names, with its content."""


class Input(NamedTuple):
    """File that a scene names: its path, its content, and the keys that influence its reading."""

    file: InputPath | InputName
    content: FileContent
    reading: str


_STORED: ContextVar[tuple[Mapping[str, FileContent], bool]] = ContextVar(
    "content of results files", default=({}, False)
)


@contextmanager
def use_contents(contents: Iterable[FileContent], only_missing: bool = False) -> Iterator[None]:
    """Within the block, let scenes use stored contents instead of the files.

    Parameters
    ----------
    contents : iterable of FileContent
        Contents from a results file.
    only_missing : bool
        Whether to use them only for files that do not exist, with a warning.
    """
    before = _STORED.set(({content.path: content for content in contents}, only_missing))
    try:
        yield
    finally:
        _STORED.reset(before)


def content_of(path: str) -> FileContent | None:
    """Return the content of a file, equal objects for equal content; None if it is unreadable."""
    stored, only_missing = _STORED.get()
    if path in stored and not (only_missing and os.path.lexists(path)):
        if only_missing:
            warn(f"{path} does not exist: its content is taken from the results file")
        return stored[path]
    try:
        content = FileContent(path, hash_files(path))
    except (OSError, ValueError):  # ValueError: a path with a null character
        return None
    return FileContent.known.setdefault((path, content.digest), content)


def hash_files(path: str) -> dict[str, str]:
    """Return the SHA-256 of a file and, for sections of a rail, of their profile files, by path.

    Raises
    ------
    OSError
        If the file is not a regular file that can be read.
    """
    files = [path]
    if path.lower().endswith(SECTIONS):
        with suppress(UnicodeDecodeError):
            names = re.findall(r"'([^']*)'|([^\s,]+)", read_text(path, max_bytes=10**6))
            sections = (os.path.join(os.path.dirname(path), a or b) for a, b in names)
            files += dict.fromkeys(filter(os.path.isfile, sections))
    hashes = {}
    for file in files:
        with open_regular(file) as stream:
            hashes[file] = hashlib.file_digest(stream, "sha256").hexdigest()
    return hashes


def describe_reading(table: Table, without: Iterable[str]) -> str:
    """Return the keys of a table that influence how its file is read, as text.

    Parameters
    ----------
    table : Table
        Table that names a file.
    without : iterable of str
        Its keys without influence.
    """
    fields = type(table).model_fields
    keys = {key: getattr(table, key) for key in fields if key not in without}
    given = {key: value for key, value in keys.items() if value != fields[key].default}
    return f"{type(table).__name__} {json.dumps(given, sort_keys=True, default=str)}"


def hashes_of(scenes: Iterable[Any]) -> dict[str, str]:
    """Return the SHA-256 of all files that scenes name, by path."""
    inputs = (given for scene in scenes for given in scene.inputs.values())
    return {path: sha for given in inputs for path, sha in given.content.hashes.items()}


def describe_changes(before: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Name the files, listed in both mappings of path to hash, whose hashes differ; may be ""."""
    return ", ".join(path for path, sha in before.items() if now.get(path, sha) != sha)


TEXTS = (".csv", ".txt", ".dat", ".tsv", ".xyz", ".asc")
"""Suffixes of gap files that are text."""

ALONG = 1e6
"""Half length, mm, over which a profile is constant in the direction across it."""

_ARRAYS = ("x", "y", "separation")


_MAY_BE_MISSING = ContextVar("gap files may be missing", default=False)


@contextmanager
def allow_missing_files() -> Iterator[None]:
    """Return a context in which scenes may name missing files, for example a gap file."""
    before = _MAY_BE_MISSING.set(True)
    try:
        yield
    finally:
        _MAY_BE_MISSING.reset(before)


def may_be_missing() -> bool:
    """Return whether missing files are accepted here (see `allow_missing_files`)."""
    return _MAY_BE_MISSING.get()


def absolute_path(path: Path, suffixes: tuple[str, ...]) -> Path:
    """Return the absolute path of a file; raise a ValueError for another suffix.

    Raises
    ------
    ValueError
        If the path has none of the suffixes.
    """
    if path.suffix.lower() not in suffixes:
        cure = "; export other formats, such as .x3p, as text with units"
        raise ValueError(f"a file ending in {', '.join(suffixes)}{cure * ('.xyz' in suffixes)}")
    return path.absolute()  # a scene may be written to, and read from, another folder


def check_exists(path: Path, other_values: str = "") -> None:
    """Raise a ValueError if a file does not exist, unless missing files are accepted."""
    # os.path.isfile, unlike Path.is_file, accepts any text.
    if not may_be_missing() and not os.path.isfile(path):
        # In double quotes, "C:\new" contains an end of line.
        escaped = any(character in str(path) for character in "\a\b\t\n\v\f\r\x1b")
        hint = "; a backslash, perhaps? Write / or single quotes" if escaped else ""
        raise ValueError(
            f"{other_values}an existing file, relative to the folder of the scene's file (without "
            f"one, and in --set, to the working folder){hint}"
        )


def _check_file(path: Path) -> Path:
    """Return the path of a gap file with its content; raise a ValueError if it does not exist."""
    if isinstance(path, InputPath):
        return path
    absolute = absolute_path(path, (".h5", ".nc", ".npy", ".npz", *TEXTS))
    content = content_of(str(absolute))
    if content is None:
        check_exists(absolute)
    return InputPath.bind(absolute, content)


def _read_array(value: Any) -> NDArray[np.float64]:
    """Return a read-only array of finite numbers; raise a ValueError for other values."""
    if np.ma.is_masked(value):
        raise ValueError("an array without masked points")
    try:
        array = np.array(value)
    except ValueError:
        array = np.array(None)
    if array.dtype.kind not in "iuf" or not np.all(np.isfinite(array)):
        raise ValueError("an array of finite numbers")
    array = array.astype(float) + 0.0  # no negative zeros: equal arrays have equal bytes
    if array.size and np.abs(array).max() > LARGEST:
        raise ValueError(f"numbers of at most {LARGEST:g} in magnitude")
    array.flags.writeable = False
    return array


def _check_axis(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return two or more increasing coordinates unchanged; raise a ValueError for others."""
    if array.ndim != 1 or array.size < 2 or not np.all(np.diff(array) >= SMALLEST):
        raise ValueError("at least 2 increasing numbers")
    return array


def _check_source(entries: ValidEntries) -> Iterator[Fault]:
    """Report a gap with both a file and arrays, or with incomplete arrays."""
    arrays = [key for key in _ARRAYS if key in entries.given]
    if "file" in entries.given and arrays:
        yield Fault("file", f"with {', '.join(arrays)}", "a file or the arrays, not both")
    elif "file" not in entries.given:
        for key in _ARRAYS:
            if key not in arrays:
                yield Fault(key, "nothing", "a file, or all of x, y and separation")


def _check_shape(entries: ValidEntries) -> Iterator[Fault]:
    """Report a separation with another shape than (len(x), len(y))."""
    if not entries.given.issuperset(_ARRAYS):
        return
    x, y, separation = (entries[key] for key in _ARRAYS)
    if separation.shape != (x.size, y.size):
        shape = f"the shape {separation.shape}"
        yield Fault("separation", shape, f"the shape ({x.size}, {y.size}), a row for each x")


def _check_direction(entries: ValidEntries) -> Iterator[Fault]:
    """Report a direction of positive heights without the body to which they belong."""
    if "positive" in entries.given and "body" not in entries.given:
        cure = "nothing without gap.body: only heights of a body point outward or inward"
        yield Fault("positive", entries["positive"], cure)


def _check_step(entries: ValidEntries) -> Iterator[Fault]:
    """Report a spacing of points, or missing points, together with arrays."""
    if "step" in entries.given and "file" not in entries.given:
        yield Fault("step", entries["step"], "a file; the arrays x and y give the spacing")
    if "missing" in entries.given and "file" not in entries.given:
        yield Fault("missing", entries["missing"], "a file; arrays have all their points")
    if "missing_width" in entries.given and "missing" not in entries.given:
        cure = 'gap.missing = "interpolate" with this width'
        yield Fault("missing_width", entries["missing_width"], cure)


_Unit = Literal["m", "cm", "mm", "um", "nm", "angstrom", "in", "mil", "uin"]

_File = Annotated[FilePath, AfterValidator(_check_file)]
_Array = Annotated[np.ndarray, PlainValidator(_read_array)]
_Axis = Annotated[_Array, AfterValidator(_check_axis)]


class Gap(Table):
    """Measured separation of the surfaces, or heights of a body, from a file or as arrays.

    The shape of `separation` is (len(x), len(y)). Without x, it is a profile of shape (len(y),)
    that is constant along the track; without y, a profile of shape (len(x),) that is constant
    across the track. The arrays are read-only. A relative path starts at the folder of the TOML
    file or, for a scene without a file, at the working folder. Only the existence of the file is
    checked here; for the formats, see `store.read_gap`.

    Examples
    --------
    >>> groove = ts.Gap(y=[-5, 0, 5], separation=[0, 1e-3, 0])
    >>> grooved = ts.solve(scene.replace(gap=groove))
    >>> grooved.converged
    True
    """

    excludes: ClassVar[dict[str, str]] = {
        "load.pressure": "a gap changes the Hertz contact: load.normal or load.approach",
    }
    file: _File | None = optional("file of the measured separation")
    x: _Axis | None = optional("x of the rows of separation, mm", "an array")
    y: _Axis | None = optional("y of the columns of separation, mm", "an array")
    separation: _Array | None = optional(
        "separation that is added to the separation of the radii, mm", "an array"
    )
    body: Literal["A", "B"] | None = optional(
        "body to which the heights belong; by default, the values are a separation"
    )
    positive: Literal["outward", "inward"] = entry(
        "direction of positive heights: out of the body (peaks) or into it (depths)",
        default="outward",
    )
    unit: _Unit | None = optional(
        "unit of the separation or the heights; by default, the unit in the file header, or mm"
    )
    length_unit: _Unit | None = optional(
        "unit of x and y; by default, the unit in the file header, or mm"
    )
    step: PositivePair | None = optional(
        "spacing of a matrix without x and y, in the unit of x and y; the matrix is centred at 0"
    )
    profile: Literal["x", "y"] = entry(
        "direction of a profile with two columns, or of arrays with a single coordinate: across "
        "the track (y) or along it (x); with x, a line contact remains one",
        default="y",
    )
    missing: Literal["interpolate"] | None = optional(
        "treatment of points without a value in the file; by default, they are refused"
    )
    missing_width: Positive | None = optional(
        "largest distance of the points beside interpolated ones, in the unit of x and y; by "
        "default, six sampling intervals"
    )
    datum: Literal["touch", "separation"] = entry(
        "zero of the approach: the first touch of the bodies, or the zero of the separation; in "
        "the second case, a negative separation is an interference at load.approach = 0",
        default="touch",
    )
    checks: ClassVar[tuple[Check, ...]] = (
        _check_source,
        _check_shape,
        _check_direction,
        _check_step,
    )

    @property
    def reading(self) -> str:
        """Keys that influence how the file is read, see `FileContent.read`."""
        return describe_reading(self, ("file", *_ARRAYS, "datum"))

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield a report row with the source of the separation: the file or an array."""
        source = f"[gap], {self.file.name if self.file else 'an array'}"
        if scene.body.has_roller:
            source = "the profiles and the tilt of the rollers"
        yield Row("separation", f"of the radii plus the one of {source}")

    @classmethod
    def unfold(cls, entries: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return the entries, with a profile over x or y alone extended to both directions."""
        profile = entries.get("separation")
        row = isinstance(profile, list | tuple) and not any(map(np.ndim, profile))
        row = row or (isinstance(profile, np.ndarray) and profile.ndim == 1)
        missing = [axis for axis in "xy" if entries.get(axis) is None]
        if not row or len(missing) != 1:
            return entries
        both = np.ma.array([profile, profile])
        if missing == ["y"]:
            return {**entries, "y": [-ALONG, ALONG], "separation": both.T, "profile": "x"}
        return {**entries, "x": [-ALONG, ALONG], "separation": both}

    def in_mm(self, x: Any, y: Any, values: Any, units: tuple[str, str] = ("mm", "mm")) -> Any:
        """Convert coordinates and values to x, y, separation in mm; outward heights are negated.

        Parameters
        ----------
        x, y, values : ndarray
            Coordinates, and separation or heights, in the units of this table.
        units : tuple of str
            Unit of x and y, and unit of the values, if this table has none.

        Returns
        -------
        x, y, separation : ndarray
            Coordinates and separation, mm.
        """
        length = LENGTHS[self.length_unit or units[0]]
        height = LENGTHS[self.unit or units[1]]
        if self.body is not None and self.positive == "outward":
            height = -height  # a peak of body A or B reduces the separation
        return length * x, length * y, height * values + 0.0

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Gap):
            return NotImplemented
        return self._compared() == other._compared()

    def __hash__(self) -> int:
        return hash(self._compared())

    def _compared(self) -> tuple[Any, ...]:
        """Entries in a form that can be compared and hashed, arrays as bytes."""
        values = (getattr(self, key) for key in type(self).model_fields)
        return tuple(a.tobytes() if isinstance(a, np.ndarray) else a for a in values)
