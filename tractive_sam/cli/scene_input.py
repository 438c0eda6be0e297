"""The scene that a command is given."""

from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from tractive_sam.cli.output import warnings_told

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
    from tractive_sam.scene import Scene

    with warnings_told() as notes:
        scene = Scene.named(name)
        if settings:
            notes.clear()  # the settings may have cured what was warned of
            scene = scene.with_set(settings)
    return scene
