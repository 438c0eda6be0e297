"""``tractive-sam keys``: every key of a scene."""

from typing import Annotated

import typer
from rich import box
from rich.table import Table

from tractive_sam.cli.output import Status, bad_input_told, console, stop


def keys(
    table: Annotated[
        str | None,
        typer.Argument(metavar="TABLE", help="A table, as wear or body.A; by default all."),
    ] = None,
) -> None:
    """Tell every key of a scene: meaning with unit, what is allowed, default."""
    from tractive_sam.scene import Scene
    from tractive_sam.schema import key_groups, shorten, suggest_name

    found = list(key_groups(Scene))
    names = [name for group in found for name in group.names if name]
    asked = None if table is None else table.strip("[]")
    with bad_input_told():
        if asked is not None and asked not in names:
            allowed = suggest_name(asked, names)
            raise stop(Status.INVALID, f"a scene has no table {shorten(table)}; {allowed}")
    out = console()
    for group in found:
        inside = asked is None or any(f"{name}.".startswith(f"{asked}.") for name in group.names)
        if inside and group.keys:
            heading = ", ".join(f"[{name}]" for name in group.names if name) or "Above all tables"
            out.print(f"\n{heading}", style="bold")
            out.print(group.about.split("\n\n")[0].replace("\n", " "))
            rows = Table(box=box.SIMPLE_HEAD, pad_edge=False)
            for head in ("key", "meaning, unit", "allowed", "default"):
                rows.add_column(head, overflow="fold")
            for key in group.keys:
                rows.add_row(key.name, key.meaning, key.allowed, key.default)
            out.print(rows)
