"""``tractive-sam scenes``: the built-in scenes."""

from rich.table import Table

from tractive_sam.cli.output import console


def scenes() -> None:
    """List the built-in scenes."""
    from tractive_sam.scene import Scene, builtin_names

    table = Table.grid(padding=(0, 2))
    for name in builtin_names():
        table.add_row(name, Scene.builtin(name).title)
    console().print(table)
