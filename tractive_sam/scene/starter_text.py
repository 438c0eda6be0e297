"""A scene file to start from: a built-in scene, with a word on every key it has or could have."""

from __future__ import annotations

from tractive_sam.schema import Key, KeyGroup, key_groups

from .catalogue import builtin_text
from .scene import Scene

HEAD = """\
# Units: mm, N, MPa, degrees, revolutions. x is the rolling direction, y lateral; A is above.
# Lines that begin with "#" are not read: take the sign away, and give a value.
# `tractive-sam explain FILE` tells what will be modelled.
"""

WIDTH = 34
"""Column at which the words begin."""


def starter(name: str) -> str:
    """The text of a built-in scene with comments, TOML; it is the same scene.

    Raises
    ------
    SceneError
        If there is none of this name.
    """
    tables = {table: group for group in key_groups(Scene) for table in group.names}
    lines, left = [HEAD], dict(tables)
    for block in f"\n{builtin_text(name).strip()}\n".split("\n["):
        head, *rest = block.strip("\n").split("\n")
        table, entries = (head.rstrip("]"), rest) if head.endswith("]") else ("", [head, *rest])
        lines += _block(left.pop(table, None), table, [line for line in entries if line])
    for table, group in left.items():
        if group.keys and not table.startswith("wear."):  # tables in place of one value
            lines += _block(group, f"# {table}", [])
    return "\n".join(lines).rstrip() + "\n"


def _block(group: KeyGroup | None, table: str, entries: list[str]) -> list[str]:
    """A table with what it gives and what it could."""
    absent, name = table.startswith("# "), table.removeprefix("# ")
    lines = [f"{'# ' if absent else ''}[{name}]"] if name else []
    known = {key.name: key for key in group.keys} if group else {}
    for entry in entries:
        key = known.pop(entry.split("=")[0].strip(), None)
        lines.append(_line(entry, key) if key else entry)
    for key in known.values():
        default = "..." if key.default in ("required", "none", "from the others") else key.default
        lines.append(_line(f"# {key.name} = {default}", key))
    return [*lines, ""]


def _line(entry: str, key: Key) -> str:
    return f"{entry:{WIDTH}}  # {key.meaning}: {key.allowed}"
