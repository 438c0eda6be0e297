"""``tractive-sam keys``: list every key of a scene."""

from typing import Annotated

import typer
from rich import box
from rich.table import Table

from tractive_sam.cli.output import console, invalid_exit
from tractive_sam.cli.scene_input import complete_tables

_Table = Annotated[str | None, typer.Argument(metavar="TABLE", autocompletion=complete_tables)]


def keys(table: _Table = None) -> None:
    """List every key of a scene with its meaning, unit, allowed values and default.

    Parameters
    ----------
    table
        A table, for example wear or body.A; by default, all tables.
    """
    from tractive_sam.scene import Scene
    from tractive_sam.schema import key_groups, shorten, suggest_name

    groups = list(key_groups(Scene))
    names = [name for group in groups for name in group.names if name]
    wanted = None if table is None else table.strip("[]")
    if wanted is not None and wanted not in names:
        allowed = suggest_name(wanted, names)
        raise invalid_exit(f"a scene has no table {shorten(table)}; {allowed}")
    out = console()
    for group in groups:
        inside = wanted is None or any(f"{name}.".startswith(f"{wanted}.") for name in group.names)
        if not (inside and group.keys):
            continue
        heading = ", ".join(f"[{name}]" for name in group.names if name) or "Above all tables"
        out.print(f"\n{heading}", style="bold")
        out.print(group.about.split("\n\n")[0].replace("\n", " "))
        rows = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for head in ("key", "meaning, unit", "allowed", "default"):
            rows.add_column(head, overflow="fold")
        for key in group.keys:
            rows.add_row(key.name, key.meaning, key.allowed, key.default)
        out.print(rows)
