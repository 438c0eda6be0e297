"""Former names of the package that still work, found in its source."""

import ast
from collections.abc import Iterator
from pathlib import Path

from tables import format_table

import tractive_sam

PACKAGE = Path(tractive_sam.__file__).parent


def page() -> str:
    """Return a table of former and present names of functions, classes and attributes."""
    pairs = sorted(pair for file in PACKAGE.rglob("*.py") for pair in _renamed(file))
    rows = ((f"`{old}`", f"`{new}`") for old, new in pairs)
    return format_table(("old name", "new name"), rows)


def _renamed(file: Path) -> Iterator[tuple[str, str]]:
    """Yield former and present names: dictionaries of a package, and attributes of classes."""
    text = file.read_text("utf-8")
    if "deprecation" not in text or file.stem == "deprecation":
        return
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            for call in node.decorator_list:
                match call:
                    case ast.Call(func=ast.Name(id="renamed_attributes"), keywords=keywords):
                        for old in keywords:
                            name = ast.literal_eval(old.value)
                            yield f"{node.name}.{old.arg}", f"{node.name}.{name}"
        elif isinstance(node, ast.Dict) and file.stem == "__init__":
            prefix = ".".join(("ts", *file.relative_to(PACKAGE).parts[:-1]))
            for old, new in ast.literal_eval(node).items():
                yield f"{prefix}.{old}", f"{prefix}.{new}"
