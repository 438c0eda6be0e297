"""The built-in scenes."""

from __future__ import annotations

from importlib import resources
from os import PathLike
from pathlib import Path

from tractive_sam.schema import Fault, SceneError, shorten, suggest_name


def builtin_names() -> tuple[str, ...]:
    """Return the names of the built-in scenes, in alphabetical order.

    Examples
    --------
    >>> "twin-discs" in ts.builtin_names()
    True
    """
    files = (resources.files(__package__) / "builtin").iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def is_path(name: str | PathLike[str]) -> bool:
    """Return whether a text is the path of a scene file (existing or not), rather than a name."""
    path = Path(name)
    return path.suffix == ".toml" or len(path.parts) > 1 or path.exists()


def builtin_text(name: str) -> str:
    """Return the TOML text of a built-in scene.

    Raises
    ------
    SceneError
        If no built-in scene has this name.
    """
    names = builtin_names()
    if name not in names:
        raise SceneError([Fault(Fault.SCENE, shorten(name), suggest_name(name, names))])
    return (resources.files(__package__) / "builtin" / f"{name}.toml").read_text(encoding="utf-8")
