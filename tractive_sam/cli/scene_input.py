"""The scene that a command is given."""

from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from tractive_sam.cli.output import Status, stop, warnings_told

if TYPE_CHECKING:
    from tractive_sam.scene import Scene

SceneName: TypeAlias = Annotated[
    str, typer.Argument(metavar="SCENE", help="A scene file (TOML), or a built-in name.")
]

Settings: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="TABLE.KEY=VALUE",
        help="Change an entry of the scene; may be repeated. One of two alternatives removes the "
        "other.",
    ),
]


def read_scene(name: str, settings: list[str] | None) -> "Scene":
    """Read a scene, change its settings, and print a note of each warning about the result.

    Raises
    ------
    SceneError
        With every fault.
    """
    from tractive_sam.scene import Scene, SceneError

    with warnings_told() as notes:
        try:
            scene = Scene.named(name)
        except SceneError:
            _refuse_study(name)
            raise
        if settings:
            notes.clear()  # the settings may have cured what was warned of
            scene = scene.with_set(settings)
    return scene


def _refuse_study(name: str) -> None:
    """Say of a file with axes which command takes it."""
    from tractive_sam.studies import is_study

    if is_study(name):
        cure = f"tractive-sam study {name} -o DIR, or tractive-sam table {name} -o FILE.nc"
        raise stop(Status.INVALID, f"{name} has axes and is no single scene: {cure}")
