"""Documents that vary a scene along axes, studies and tables: where their files are sought."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .scene import Scene

FILES = (
    "gap.file",
    "load_history.file",
    "transient.profile.A.file",
    "transient.profile.B.file",
)
"""Keys of files that a scene names."""


def files_of_varied(folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
    """The tables of a varied scene, with relative files in them sought from a folder."""
    match tables:
        case {"scene": str(name)} if (folder / name).is_file():
            tables["scene"] = str(folder / name)
        case {"scene": dict(scene)}:
            Scene.resolve_files(folder, scene)
    for one in _tables_with_values(tables.get("axis")):
        match one:
            case {"key": str(key), "values": list() | tuple() as files} if key in FILES:
                one["values"] = [str(folder / str(file)) for file in files]
    return tables


def _tables_with_values(axes: Any) -> Iterator[Any]:
    """The axes and what is zipped with them, as far as they are tables."""
    for axis in axes if isinstance(axes, list | tuple) else ():
        yield axis
        match axis:
            case {"zip": list() | tuple() as zipped}:
                yield from zipped
