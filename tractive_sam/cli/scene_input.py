"""The scene that a command is given."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from tractive_sam.cli.output import Status, stop, warnings_told

if TYPE_CHECKING:
    from tractive_sam.scene import Scene

RESULTS = (".h5", ".hdf5")
"""Suffixes that distinguish a results file from a scene."""

STANDARD_INPUT = "-"
"""Name of a scene that another program pipes in."""


def complete_scenes(incomplete: str) -> list[str]:
    """Return built-in scenes, scene files and folders that begin so."""
    from glob import escape

    from tractive_sam.scene import builtin_names

    files = Path().glob(f"{escape(incomplete)}*") if not Path(incomplete).is_absolute() else ()
    found = [f"{one}/" if one.is_dir() else str(one) for one in files]
    named = [one for one in builtin_names() if one.startswith(incomplete)]
    return [*named, *sorted(one for one in found if one.endswith(("/", ".toml")))]


def complete_keys(incomplete: str) -> list[str]:
    """Return keys of a scene that begin so, as ``load.normal=``."""
    from tractive_sam.scene import Scene
    from tractive_sam.schema import key_groups

    keys = (
        f"{name}.{key.name}=".lstrip(".")
        for group in key_groups(Scene)
        for name in group.names
        for key in group.keys
    )
    return [key for key in keys if key.startswith(incomplete)]


SceneName: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="SCENE",
        help="A scene file (TOML), - for the standard input, or a built-in name.",
        autocompletion=complete_scenes,
    ),
]

Settings: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="TABLE.KEY=VALUE",
        help="Change an entry of the scene; may be repeated. One of two alternatives removes the "
        "other.",
        autocompletion=complete_keys,
    ),
]


def read_scene(name: str, settings: list[str] | None) -> "Scene":
    """Read a scene, change its settings, and print a note of each warning about the result.

    Raises
    ------
    SceneError
        With every fault.
    """
    from tractive_sam.scene import Scene
    from tractive_sam.schema import SceneError

    with warnings_told() as notes:
        try:
            scene = _from_standard_input() if name == STANDARD_INPUT else Scene.from_name(name)
        except SceneError:
            _refuse_other_files(name)
            raise
        if settings:
            notes.clear()  # the settings may have cured what was warned of
            scene = scene.with_set(settings)
    return scene


def _from_standard_input(most: int = 2**26) -> "Scene":
    """Read a scene from the standard input, which may have as many bytes as a scene file."""
    from tractive_sam.input_file import read_piped
    from tractive_sam.scene import Scene

    try:
        return Scene.from_toml_text(read_piped(most))
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "no text in UTF-8"
        raise stop(Status.INVALID, f"standard input: {reason}") from None


def _refuse_other_files(name: str) -> None:
    """Report which command takes a file of results, or one with axes."""
    from tractive_sam.studies import is_study

    if Path(name).suffix in RESULTS and Path(name).is_file():
        cure = f"tractive-sam show, plot or report {name}; run SCENE --start {name} begins with it"
        raise stop(Status.INVALID, f"{name} is a results file, and no scene: {cure}")
    if is_study(name):
        cure = f"tractive-sam study {name} -o DIR, or tractive-sam table {name} -o FILE.nc"
        raise stop(Status.INVALID, f"{name} has axes and is no single scene: {cure}")
