"""``tractive-sam scenes``: the built-in scenes."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from tractive_sam.cli.output import Status, bad_input_told, console, stop, tell


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
    from tractive_sam.scene import starter

    path = Path(f"{name}.toml")
    with bad_input_told():
        text = starter(name)
        try:
            with path.open("x", encoding="utf-8") as file:
                file.write(text)
        except FileExistsError:
            told = f"{path} exists already; rename or remove it, or work in another folder"
            raise stop(Status.INVALID, told) from None
    tell(path)
