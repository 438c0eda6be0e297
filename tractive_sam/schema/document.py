"""Documents: tables with a file, for example a scene or a study."""

from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Self

from . import toml
from .faults import SceneError
from .table import Table


class Document(Table):
    """Base class of tables that are read from TOML files and written to them."""

    internal: ClassVar[frozenset[str]] = frozenset(("read_tables", "resolve_files"))

    @classmethod
    def from_toml(cls, path: str | PathLike[str]) -> Self:
        """Read a TOML file and check it; relative paths in it start from its folder.

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
        """Read TOML text and check it; relative paths in it start from the working folder.

        Raises
        ------
        SceneError
            If the text is not TOML, or contains invalid entries.
        """
        return cls(**toml.parse(text))

    def to_toml(self) -> str:
        """Return the entries that were set as TOML, without defaults, for `from_toml_text`."""
        return toml.emit(self.entries())

    @staticmethod
    def read_tables(path: str | PathLike[str]) -> dict[str, Any]:
        """Return the tables of a TOML file as dictionaries, without checking them.

        Raises
        ------
        SceneError
            If the file cannot be read, or is not TOML.
        """
        return toml.parse_file(Path(path))

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Return tables whose relative paths start from a folder; unchanged unless overridden."""
        return tables
