"""Parts of pages that are made from the package and from the results of the benchmarks.

Keys of a scene, columns of a results file and commands are told by the very objects that read,
write and run them; numbers are those that the scripts in `benchmarks` have written.
"""

import inspect
from collections.abc import Iterable
from enum import Enum
from inspect import signature
from pathlib import Path
from typing import get_args

import names
import typer
from numbers_of_benchmarks import TABLES
from tables import markdown

from tractive_sam.cli.program import app
from tractive_sam.results import COLUMNS, FIELDS, STRESS
from tractive_sam.scene.scene import Scene
from tractive_sam.schema import Key, KeyGroup, key_groups
from tractive_sam.store import layout


def write(docs: Path) -> None:
    """Write the parts into `_parts`, the page of names, and the notebooks as tutorials."""
    made = {"keys": keys, "columns": columns, "layout": layout_of_files, "commands": commands}
    for name, part in (made | TABLES).items():
        _write(docs / "_parts" / f"{name}.md", part())
    _write(docs / "reference" / "api.rst", names.page())
    for notebook in sorted((docs.parent / "notebooks").glob("*.ipynb")):
        # A notebook names pictures as seen from its own folder.
        text = notebook.read_text(encoding="utf-8").replace("](../", "](../../")
        _write(docs / "tutorials" / notebook.name, text)


def _write(file: Path, text: str) -> None:
    """Write a file that has changed; Sphinx reads the others no second time."""
    file.parent.mkdir(exist_ok=True)
    if not file.exists() or file.read_text(encoding="utf-8") != text:
        file.write_text(text, encoding="utf-8")


def keys() -> str:
    """Every table of a scene with its keys: meaning, what is allowed, default."""
    return "\n".join(part for group in key_groups(Scene) for part in _group(group))


def _group(group: KeyGroup) -> Iterable[str]:
    if group.names != ("",):
        yield "## " + ", ".join(f"`[{name}]`" for name in group.names) + "\n"
        yield group.about + "\n"
    if group.keys:
        rows = ((f"`{key.name}`", key.meaning, key.allowed, _default(key)) for key in group.keys)
        yield markdown(("key", "meaning", "allowed", "default"), rows)


def _default(key: Key) -> str:
    words = ("required", "none", "from the others")
    return key.default if key.default in words else f"`{key.default}`"


def columns() -> str:
    """What a results file holds: columns of the history, fields, stress."""
    parts = []
    for title, found in (
        ("Columns of the history", COLUMNS),
        ("Fields", FIELDS.values()),
        ("Stress", STRESS.values()),
    ):
        rows = ((f"`{one.name}`", one.unit, one.long_name, ", ".join(one.dims)) for one in found)
        parts.append(f"## {title}\n\n" + markdown(("name", "unit", "meaning", "dimensions"), rows))
    return "\n".join(parts)


def layout_of_files() -> str:
    """The groups of a results file, as the module that writes them tells it."""
    text = inspect.cleandoc(layout.__doc__).split("\n\n", 1)[1]
    tree, words = text.split("\n\n", 1)
    return f"```text\n{inspect.cleandoc(tree)}\n```\n\n{words}\n"


def commands() -> str:
    """Every command of the program with its arguments and options."""
    parts = []
    for command in app.registered_commands:
        does, name = command.callback, command.name or command.callback.__name__
        parts.append(f"## `tractive-sam {name}`\n\n{inspect.cleandoc(does.__doc__)}\n")
        rows = [_parameter(one) for one in signature(does, eval_str=True).parameters.values()]
        if rows:
            parts.append(markdown(("argument", "meaning"), rows))
    return "\n".join(parts)


def _parameter(one: inspect.Parameter) -> tuple[str, str]:
    """How an argument or option of a command is written, and its meaning."""
    kind, told = get_args(one.annotation)[:2]
    if isinstance(told, typer.models.ArgumentInfo):
        return f"`{told.metavar or one.name.upper()}`", told.help
    kinds = [alone for alone in get_args(kind) or (kind,) if isinstance(alone, type)]
    choices = [str(choice.value) for choice in kinds[0]] if issubclass(kinds[0], Enum) else []
    value = "" if kinds[0] is bool else told.metavar or "|".join(choices) or kinds[0].__name__
    # In an annotation the first of the names stands where a default would.
    first = (told.default,) if isinstance(told.default, str) else ()
    names = (*first, *(told.param_decls or ())) or (f"--{one.name.replace('_', '-')}",)
    default = f" By default {one.default.value}." if isinstance(one.default, Enum) else ""
    return f"`{' '.join([', '.join(names), value]).strip()}`", told.help + default
