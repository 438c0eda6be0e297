"""Files of documents that vary a scene along axes: studies and tables of creep forces."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .scene import Scene

FILE_KEYS = (
    "gap.file",
    "load_history.file",
    "transient.profile.A.file",
    "transient.profile.B.file",
)
"""Keys of a scene that name a file."""


def resolve_parametric_files(folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
    """Let relative file paths in a study's tables start from a folder, in place; return them."""
    match tables:
        case {"scene": str(name)} if (folder / name).is_file():
            tables["scene"] = str(folder / name)
        case {"scene": dict(scene)}:
            Scene.resolve_files(folder, scene)
    for axis in _axes_with_zipped(tables.get("axis")):
        match axis:
            case {"key": str(key), "values": list() | tuple() as files} if key in FILE_KEYS:
                axis["values"] = [str(folder / str(file)) for file in files]
    return tables


def _axes_with_zipped(axes: Any) -> Iterator[Any]:
    """Yield each axis of a study, followed by the axes zipped with it."""
    for axis in axes if isinstance(axes, list | tuple) else ():
        yield axis
        match axis:
            case {"zip": list() | tuple() as zipped}:
                yield from zipped
