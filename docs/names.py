"""The reference page of the public names."""

import inspect
from collections.abc import Iterator
from importlib import import_module
from types import ModuleType

import tractive_sam

SUBPACKAGES = {
    "tractive_sam.subsurface": "Stress",
    "tractive_sam.solvers": "Solution methods",
    "tractive_sam.plot": "Figures",
    "tractive_sam.studies": "Studies",
    "tractive_sam.reference": "Closed forms",
}
"""Packages with public names beyond those of `tractive_sam`, and their headings."""

HEAD = """\
Python names
============

This page lists all public names after ``import tractive_sam as ts``. Every name has an example;
the examples continue the example of the package.

.. currentmodule:: tractive_sam
"""


def page() -> str:
    """Return the page, with a summary for each kind of name in each package."""
    listed: set[int] = set()
    parts = [HEAD, *_summaries(tractive_sam, "", listed)]
    for package, title in SUBPACKAGES.items():
        module = import_module(package)
        summaries = list(_summaries(module, package.removeprefix("tractive_sam."), listed))
        about = inspect.cleandoc(module.__doc__).split("\n\n")[0].replace("`", "``")
        if summaries:
            parts += [f"{title}\n{'-' * len(title)}\n\n``{package}``: {about}\n", *summaries]
    return "\n".join(parts)


def _summaries(module: ModuleType, prefix: str, listed: set[int]) -> Iterator[str]:
    """Yield the summaries of functions, classes and errors that no earlier package has listed."""
    names = {name: getattr(module, name) for name in dir(module)}
    names = {
        name: value for name, value in names.items() if callable(value) and id(value) not in listed
    }
    listed.update(map(id, names.values()))
    classes = {name for name, value in names.items() if isinstance(value, type)}
    errors = {name for name in classes if issubclass(names[name], BaseException)}
    kinds = (
        ("Functions", names.keys() - classes, "function.rst"),
        ("Objects", classes - errors, "record.rst"),
        ("Errors and warnings", errors, ""),
    )
    for kind, members, template in kinds:
        if members:
            if not prefix:
                yield f"{kind}\n{'-' * len(kind)}\n"
            option = f"   :template: {template}\n" if template else ""
            lines = "".join(
                f"   {prefix + '.' if prefix else ''}{name}\n" for name in sorted(members)
            )
            yield f".. autosummary::\n   :toctree: names\n   :nosignatures:\n{option}\n{lines}"
