"""Files that a scene names: each is read once, and its content is identified by its hash."""

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
from typing import Any, ClassVar, NamedTuple, Self
from weakref import WeakValueDictionary

from tractive_sam.input_file import open_regular, read_text
from tractive_sam.rail import SECTIONS
from tractive_sam.schema import Fault, SceneError, Table, warn

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

    @property
    def is_current(self) -> bool:
        """Whether the content counts: it is fixed or stored, or the files still have it."""
        return self.is_fixed or self.is_stored or not self.changed_files()

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
