"""Read the scene of a command, and complete names of scenes and keys."""

from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

import tractive_sam as ts
from tractive_sam.cli.output import invalid_exit, refuse, report_warnings

RESULTS = (".h5", ".hdf5")
"""Suffixes that distinguish a results file from a scene."""

STANDARD_INPUT = "-"
"""Name of a scene from the standard input."""


def complete_scenes(incomplete: str) -> list[str]:
    """Return the completions of a scene argument: built-in names, scene files and folders."""
    return [*complete_builtin(incomplete), *_complete_files(incomplete, ".toml")]


def complete_creep_tables(incomplete: str) -> list[str]:
    """Return the completions of a table argument: the built-in table, designs, tables, folders."""
    from tractive_sam.tables import builtin_tables

    names = [name for name in builtin_tables() if name.startswith(incomplete)]
    return [*names, *_complete_files(incomplete, ".toml", ".nc")]


def _complete_files(incomplete: str, *suffixes: str) -> list[str]:
    """Return files with one of the suffixes, and folders, whose names begin with a text."""
    from glob import escape

    files = Path().glob(f"{escape(incomplete)}*") if not Path(incomplete).is_absolute() else ()
    paths = [f"{file}/" if file.is_dir() else str(file) for file in files]
    return sorted(path for path in paths if path.endswith(("/", *suffixes)))


def complete_keys(incomplete: str) -> list[str]:
    """Return the completions of a `--set` argument: keys as ``load.normal=``."""
    from tractive_sam.scene import Scene
    from tractive_sam.schema import key_groups

    keys = (
        f"{name}.{key.name}=".lstrip(".")
        for group in key_groups(Scene)
        for name in group.names
        for key in group.keys
    )
    return [key for key in keys if key.startswith(incomplete)]


def complete_builtin(incomplete: str) -> list[str]:
    """Return the completions of the name of a built-in scene."""
    from tractive_sam.scene import builtin_names

    return [name for name in builtin_names() if name.startswith(incomplete)]


def complete_tables(incomplete: str) -> list[str]:
    """Return the completions of a table of a scene, as ``body.A``."""
    from tractive_sam.scene import Scene
    from tractive_sam.schema import key_groups

    names = {name for group in key_groups(Scene) for name in group.names if group.keys}
    return sorted(name for name in names if name and name.startswith(incomplete))


SceneName: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="SCENE",
        help="A scene file (TOML), the name of a built-in scene, or - for standard input.",
        autocompletion=complete_scenes,
    ),
]

Settings: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="TABLE.KEY=VALUE",
        help="Change a key of the scene; a key removes its alternatives. May be repeated.",
        autocompletion=complete_keys,
    ),
]


def _allow(names: list[str] | None) -> list[str] | None:
    """Allow classes that scenes may name, and return their names (callback of --allow)."""
    if names:
        from tractive_sam.schema import allow_laws

        with refuse(ValueError):
            allow_laws(*names)
    return names


Allow: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--allow",
        metavar="MODULE[:NAME]",
        help="Let a scene use this class of your own, or all classes of a module, which is then "
        "imported and can run any code. May be repeated.",
        callback=_allow,
        is_eager=True,
    ),
]


def read_scene(name: str, settings: list[str] | None) -> "ts.Scene":
    """Return the scene of a name, file or standard input, changed by settings; print its warnings.

    Parameters
    ----------
    name : str
        A scene file, a built-in scene, or `STANDARD_INPUT`.
    settings : list of str or None
        Settings, for example ``load.normal=300``.

    Raises
    ------
    SceneError
        With every fault.
    """
    from tractive_sam.scene import Scene
    from tractive_sam.schema import SceneError

    with report_warnings():
        try:
            piped = name == STANDARD_INPUT
            tables = _read_standard_input() if piped else Scene.tables_from_name(name)
            return Scene.from_tables(tables, settings or ())
        except SceneError:
            _refuse_results_and_studies(name)
            raise


def _read_standard_input(max_bytes: int = 2**26) -> dict[str, Any]:
    """Return the tables read from the standard input; end with an error beyond `max_bytes`."""
    from tractive_sam.input_file import read_piped
    from tractive_sam.schema import toml

    try:
        return toml.parse(read_piped(max_bytes))
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not a text in UTF-8 or UTF-16"
        raise invalid_exit(f"standard input cannot be read: {reason}") from None


def _refuse_results_and_studies(name: str) -> None:
    """End with an error if the file is a results file or a study, naming the right commands."""
    from tractive_sam.studies import is_study

    if Path(name).suffix in RESULTS and Path(name).is_file():
        cure = f"tractive-sam show, plot or report {name}; run SCENE --start {name} starts from it"
        raise invalid_exit(f"{name} is a results file, not a scene: {cure}")
    if is_study(name):
        cure = f"tractive-sam study {name} -o DIR, or tractive-sam table {name} -o FILE.nc"
        raise invalid_exit(f"{name} has axes and is not a single scene: {cure}")
