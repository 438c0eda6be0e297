"""Parts of pages that are generated from the package and from the results of the benchmarks.

Scene keys, columns of a results file and commands come from the objects that read, write and run
them. Numbers come from the output files of the scripts in `benchmarks`.
"""

import inspect
import re
import tomllib
from collections.abc import Iterable
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Literal, get_args, get_origin

import names
import renamed
import typer
from numbers_of_benchmarks import TABLES
from tables import format_table

from tractive_sam.cli.program import app
from tractive_sam.results import COLUMNS, PACKAGE_FIELDS, STRESS
from tractive_sam.rolling.wheel_rail import WHEEL_COLUMNS
from tractive_sam.scene.scene import Scene
from tractive_sam.schema import Key, KeyGroup, key_groups
from tractive_sam.store import layout

PROJECT = Path(__file__).parents[1] / "pyproject.toml"


def write(docs: Path) -> None:
    """Write the parts to `_parts`, the page of names, and the notebooks as tutorials."""
    generated = {
        "keys": keys,
        "columns": columns,
        "layout": layout_of_files,
        "commands": commands,
        "layers": layers,
        "renamed": renamed.page,
    }
    for name, part in (generated | TABLES).items():
        _write(docs / "_parts" / f"{name}.md", part())
    reference = names.page()
    _write(docs / "reference" / "api.rst", reference)
    listed = set(re.findall(r"^   (\S+)$", reference, re.MULTILINE))
    for stub in (docs / "reference" / "names").glob("*.rst"):
        if stub.stem.removeprefix("tractive_sam.") not in listed:
            stub.unlink()  # of a name that was removed
    for notebook in sorted((docs.parent / "notebooks").glob("*.ipynb")):
        # Picture paths in a notebook are relative to the folder of the notebook.
        text = notebook.read_text(encoding="utf-8").replace("](../", "](../../")
        _write(docs / "tutorials" / notebook.name, text)


def _write(file: Path, text: str) -> None:
    """Write a file if its text has changed; Sphinx then reads only changed files again."""
    file.parent.mkdir(exist_ok=True)
    if not file.exists() or file.read_text(encoding="utf-8") != text:
        file.write_text(text, encoding="utf-8")


def keys() -> str:
    """Return every table of a scene with its keys: meaning, allowed values, default."""
    return "\n".join(part for group in key_groups(Scene) for part in _group(group))


def _group(group: KeyGroup) -> Iterable[str]:
    if group.names != ("",):
        yield "## " + ", ".join(f"`[{name}]`" for name in group.names) + "\n"
        yield group.about + "\n"
    if group.keys:
        rows = ((f"`{key.name}`", key.meaning, key.allowed, _default(key)) for key in group.keys)
        yield format_table(("key", "meaning", "allowed", "default"), rows)


def _default(key: Key) -> str:
    words = ("required", "none", "from other keys")
    return key.default if key.default in words else f"`{key.default}`"


def columns() -> str:
    """Return the quantities of a results file: columns of the history, fields, stress."""
    parts = []
    for title, quantities in (
        ("Columns of the history", COLUMNS),
        ("Columns of a wheel on a rail", WHEEL_COLUMNS),
        ("Fields", PACKAGE_FIELDS.values()),
        ("Stress", STRESS.values()),
    ):
        rows = ((f"`{q.name}`", q.unit, q.long_name, ", ".join(q.dims)) for q in quantities)
        parts.append(
            f"## {title}\n\n" + format_table(("name", "unit", "meaning", "dimensions"), rows)
        )
    return "\n".join(parts)


def layout_of_files() -> str:
    """Return the groups of a results file, from the docstring of the module that writes them."""
    text = inspect.cleandoc(layout.__doc__).split("\n\n", 1)[1]
    tree, words = text.split("\n\n", 1)
    return f"```text\n{inspect.cleandoc(tree)}\n```\n\n{words}\n"


def commands() -> str:
    """Return every command of the program with its arguments and options."""
    parts = []
    for command in app.registered_commands:
        function = command.callback
        name = command.name or function.__name__.replace("_", "-")
        parts.append(f"## `tractive-sam {name}`\n\n{inspect.cleandoc(function.__doc__)}\n")
        parameters = signature(function, eval_str=True).parameters.values()
        rows = [_describe_parameter(parameter) for parameter in parameters]
        if rows:
            parts.append(format_table(("argument", "meaning"), rows))
    return "\n".join(parts)


def _describe_parameter(parameter: inspect.Parameter) -> tuple[str, str]:
    """Return an argument or option of a command as written, and its meaning."""
    kind, option = get_args(parameter.annotation)[:2]
    if isinstance(option, typer.models.ArgumentInfo):
        return f"`{option.metavar or parameter.name.upper()}`", option.help
    choices = [str(choice) for choice in get_args(kind)] if get_origin(kind) is Literal else []
    types = [member for member in get_args(kind) or (kind,) if isinstance(member, type)] or [str]
    value = "" if types[0] is bool else option.metavar or "|".join(choices) or types[0].__name__
    # In an annotation, the first name of an option is in the place of its default.
    first = (option.default,) if isinstance(option.default, str) else ()
    names = (*first, *(option.param_decls or ())) or (f"--{parameter.name.replace('_', '-')}",)
    default = f" By default {parameter.default}." if choices else ""
    return f"`{' '.join([', '.join(names), value]).strip()}`", option.help + default


def layers() -> str:
    """Return the layers of the package, from the contracts of import-linter and the docstrings."""
    project = tomllib.loads(PROJECT.read_text("utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    exclusive = dict(
        contract["name"].split(" only in ")
        for contract in contracts
        if " only in " in contract["name"]
    )
    (order,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    rows = [
        (
            number,
            f"`{module.removeprefix('tractive_sam.')}`",
            inspect.cleandoc(import_module(module).__doc__).split("\n\n")[0].replace("\n", " "),
            ", ".join(
                library for library, place in exclusive.items() if module == f"tractive_sam.{place}"
            ),
        )
        for number, layer in enumerate(order, 1)
        for module in layer.split(" | ")
    ]
    return format_table(("layer", "module", "content", "only importer of"), rows)
