"""A commented scene file: a built-in scene with a comment on every key, given or not."""

from tractive_sam.schema import Key, KeyGroup, key_groups

from .catalogue import builtin_text
from .scene import Scene

_HEAD = """\
# Units: mm, N, MPa, degrees, revolutions. x is the rolling direction, y lateral; A is above.
# For another contact, change the values of the lines without "#", and remove [grid] and [solver] if
# the file has them: mesh and method then follow from the contact.
# Lines that begin with "#" are not read: remove the sign, and give a value.
# `tractive-sam explain FILE` describes what will be modelled.
"""


def commented_scene(name: str) -> str:
    """Return a built-in scene as TOML text: each key has a comment, absent keys are comments.

    Raises
    ------
    SceneError
        If no built-in scene has this name.
    """
    groups = {table: group for group in key_groups(Scene) for table in group.names}
    lines = [_HEAD]
    for block in f"\n{builtin_text(name).strip()}\n".split("\n["):
        head, *rest = block.strip("\n").split("\n")
        if head.startswith("["):  # a table of an array
            lines += [f"[{head}", *rest, ""]
            continue
        table, entries = (head.rstrip("]"), rest) if head.endswith("]") else ("", [head, *rest])
        lines += _comment_table(groups.pop(table, None), table, [line for line in entries if line])
    for table, group in groups.items():
        if group.keys and not table.startswith("wear."):  # tables in place of one value
            lines += _comment_table(group, f"# {table}", [])
    return "\n".join(lines).rstrip() + "\n"


def _comment_table(group: KeyGroup | None, table: str, entries: list[str]) -> list[str]:
    """Return the lines of a table: its entries, and its other keys as comments."""
    absent, name = table.startswith("# "), table.removeprefix("# ")
    lines = [f"{'# ' if absent else ''}[{name}]"] if name else []
    # Keys above all tables that are arrays of tables follow as tables.
    keys = {key.name: key for key in group.keys if name or key.default != "[]"} if group else {}
    for entry in entries:
        key = keys.pop(entry.split("=")[0].strip(), None)
        lines.append(_comment_line(entry, key) if key else entry)
    for key in keys.values():
        default = "..." if key.default in ("required", "none", "from other keys") else key.default
        lines.append(_comment_line(f"# {key.name} = {default}", key))
    return [*lines, ""]


def _comment_line(entry: str, key: Key, width: int = 34) -> str:
    """Return a line of TOML with the meaning of its key as a comment behind it."""
    return f"{entry:{width}}  # {key.meaning}: {key.allowed}"
