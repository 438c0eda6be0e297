"""Documents: tables with a file, such as a scene or a study."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Self

from . import toml
from .faults import SceneError
from .table import Table


def keywords_only(init: Callable[..., None]) -> Callable[..., None]:
    """Return an `__init__` that refuses arguments without a keyword, such as a path.

    The error message names the method that reads a file.
    """

    @wraps(init)  # with its signature
    def check_arguments(self: Any, /, *unnamed: Any, **given: Any) -> None:
        if unnamed:
            name = type(self).__name__
            raise TypeError(f"{name}(...) takes keywords only; {name}.from_toml(path) reads a file")
        init(self, **given)

    return check_arguments


class Document(Table):
    """A table that is read from a TOML file, and written to one."""

    error_class: ClassVar[type[SceneError]] = SceneError
    """Class of the errors that report its faults."""
    internal: ClassVar[frozenset[str]] = frozenset(("error_class", "read_tables", "resolve_files"))

    @keywords_only
    def __init__(self, /, **given: Any) -> None:
        try:
            super().__init__(**given)
        except SceneError as error:
            raise self.error_class(error.faults) from None

    @classmethod
    def from_toml(cls, path: str | PathLike[str]) -> Self:
        """Read a file; relative paths in it start from its folder.

        Raises
        ------
        SceneError
            If the file cannot be read, is not TOML, or contains invalid entries; `StudyError` for
            a study, `TableError` for a table of creep forces.
        """
        path = Path(path).absolute()
        try:
            return cls(**cls.resolve_files(path.parent, cls.read_tables(path)))
        except SceneError as error:
            raise cls.error_class(error.faults) from None

    @classmethod
    def from_toml_text(cls, text: str) -> Self:
        """Read TOML text; relative paths in it start from the working folder.

        Raises
        ------
        SceneError
            If the text is not TOML, or contains invalid entries.
        """
        return cls(**toml.parse(text))

    def to_toml(self) -> str:
        """Return the given entries as TOML, without defaults; `from_toml_text` reads them."""
        return toml.emit(self.entries())

    @staticmethod
    def read_tables(path: str | PathLike[str]) -> dict[str, Any]:
        """Return the tables of a TOML file, valid or not.

        Raises
        ------
        SceneError
            If the file cannot be read, or is not TOML.
        """
        return toml.parse_file(Path(path))

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the tables with relative paths in them starting from a folder."""
        return tables
