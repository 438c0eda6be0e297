"""Tables that have a file of their own: a scene, or a study of one."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Self

from . import toml
from .faults import SceneError
from .table import Table


def keywords_alone(init: Callable[..., None]) -> Callable[..., None]:
    """Have what is given without a keyword, as a path may be, told how a file is read."""

    @wraps(init)  # with its signature
    def checked(self: Any, /, *none: Any, **given: Any) -> None:
        if none:
            name = type(self).__name__
            raise TypeError(
                f"{name}.from_toml(path) reads a file; {name}(...) takes keywords alone"
            )
        init(self, **given)

    return checked


class Document(Table):
    """A table that is read from a TOML file, and written as one."""

    invalid: ClassVar[type[SceneError]] = SceneError
    """What is raised of its faults."""
    internal: ClassVar[frozenset[str]] = frozenset(("files_from", "invalid", "tables_of"))

    @keywords_alone
    def __init__(self, /, **given: Any) -> None:
        try:
            super().__init__(**given)
        except SceneError as error:
            raise self.invalid(error.faults) from None

    @classmethod
    def from_toml(cls, path: str | PathLike[str]) -> Self:
        """Read a file; relative files in it are sought from its folder.

        Raises
        ------
        SceneError
            If the file cannot be read, is no TOML, or describes nothing valid; of a study or a
            table it is a `StudyError` or `TableError`.
        """
        path = Path(path).absolute()
        try:
            return cls(**cls.files_from(path.parent, cls.tables_of(path)))
        except SceneError as error:
            raise cls.invalid(error.faults) from None

    @classmethod
    def from_toml_text(cls, text: str) -> Self:
        """Read TOML text; relative files in it are sought from the working folder.

        Raises
        ------
        SceneError
            If the text is no TOML, or describes nothing valid.
        """
        return cls(**toml.parse(text))

    def to_toml(self) -> str:
        """Write what was given, not the defaults, as TOML; `from_toml_text` gives it back."""
        return toml.emit(self.entries())

    @staticmethod
    def tables_of(path: str | PathLike[str]) -> dict[str, Any]:
        """The tables of a TOML file, be they valid or not.

        Raises
        ------
        SceneError
            If the file cannot be read, or is no TOML.
        """
        return toml.parse_file(Path(path))

    @classmethod
    def files_from(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """The tables, with relative files in them sought from a folder."""
        return tables
