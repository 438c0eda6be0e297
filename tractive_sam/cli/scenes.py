"""``tractive-sam scenes``: list or write the built-in scenes."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from tractive_sam.cli.output import console, print_line
from tractive_sam.cli.scene_input import complete_builtin

_Name = Annotated[str | None, typer.Option(metavar="NAME", autocompletion=complete_builtin)]


def scenes(write: _Name = None) -> None:
    """List the built-in scenes, or write one to a file that you can edit.

    Parameters
    ----------
    write
        Write this scene to NAME.toml, with a comment on every key.
    """
    from tractive_sam.output_file import write_file
    from tractive_sam.scene import Scene, builtin_names, commented_scene

    if write is not None:
        path = Path(f"{write}.toml")
        write_file(path, commented_scene(write), exclusive=True)
        print_line(path)
        return
    table = Table.grid(padding=(0, 2))
    for name in builtin_names():
        table.add_row(name, Scene.builtin(name).title)
    console().print(table)
