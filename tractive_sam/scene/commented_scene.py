"""A commented scene file: a built-in scene with the meaning of its keys, and its other tables."""

import textwrap

from tractive_sam.schema import key_groups

from .catalogue import builtin_text
from .scene import Scene

_HEAD = """\
# Units: mm, N, MPa, degrees, revolutions. x is the rolling direction, y lateral; A is above.
# For another contact, change the values, and remove [grid] and [solver] if the file has them: mesh
# and method then follow from the contact. `tractive-sam explain FILE` describes what is modelled.
"""


def commented_scene(name: str) -> str:
    """Return a built-in scene as TOML text with a comment on every key, and a list of all tables.

    Raises
    ------
    SceneError
        If no built-in scene has this name.
    """
    groups = [group for group in key_groups(Scene) if group.keys]
    meanings = {
        f"{table}.{key.name}".lstrip("."): key.meaning
        for group in groups
        for table in group.names
        for key in group.keys
    }
    lines, table = [], ""
    for line in builtin_text(name).strip().split("\n"):
        table = line.strip("[]") if line.startswith("[") else table
        meaning = meanings.get(f"{table}.{line.split('=')[0].strip()}".lstrip("."))
        lines.append(f"{line:{34}}  # {meaning}" if meaning else line)
    tables = " ".join(group.headings for group in groups if group.headings)
    rest = f"Further keys and tables are listed by `tractive-sam keys [TABLE]`: {tables}"
    comments = textwrap.wrap(rest, 98, break_long_words=False, break_on_hyphens=False)
    return "\n".join([_HEAD, *lines, "", *(f"# {comment}" for comment in comments)]) + "\n"
