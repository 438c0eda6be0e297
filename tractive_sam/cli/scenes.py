"""``tractive-sam scenes``: the built-in scenes."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from tractive_sam.cli.output import bad_input_told, console, tell


def scenes(
    write: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Write this scene into NAME.toml, with a word on every key: a file to start from.",
        ),
    ] = None,
) -> None:
    """List the built-in scenes, or write one as a file to start from."""
    from tractive_sam.scene import Scene, builtin_names

    if write is not None:
        _write(write)
        return
    table = Table.grid(padding=(0, 2))
    for name in builtin_names():
        table.add_row(name, Scene.builtin(name).title)
    console().print(table)


def _write(name: str) -> None:
    from tractive_sam.output_file import write_file
    from tractive_sam.scene import commented_scene

    path = Path(f"{name}.toml")
    with bad_input_told():
        text = commented_scene(name)
        write_file(path, text, exclusive=True)
    tell(path)
