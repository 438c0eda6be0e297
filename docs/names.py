"""The page of the public names, as the package lets them out."""

import inspect
from importlib import import_module

import tractive_sam

ROOMS = {
    "tractive_sam.subsurface": "Stress",
    "tractive_sam.solvers": "Methods of solution",
    "tractive_sam.plot": "Figures",
    "tractive_sam.studies": "Studies",
    "tractive_sam.reference": "Closed forms",
}
"""Beside what the package itself lets out."""

HEAD = """\
Names of Python
===============

``import tractive_sam as ts``. Every name has an example, which goes on from that of the package.

.. currentmodule:: tractive_sam
"""


def page() -> str:
    """The page, with a summary for each kind of name in each room."""
    told: set[int] = set()
    parts = [HEAD, *_room(tractive_sam, "", told)]
    for room, title in ROOMS.items():
        module = import_module(room)
        found = list(_room(module, room.removeprefix("tractive_sam."), told))
        first = inspect.cleandoc(module.__doc__).split("\n\n")[0].replace("`", "``")
        parts += [f"{title}\n{'-' * len(title)}\n\n``{room}``: {first}\n", *found] if found else []
    return "\n".join(parts)


def _room(module, prefix: str, told: set[int]):
    """Functions, records and errors of a room that no room before has told."""
    names = {name: getattr(module, name) for name in module.__all__}
    names = {n: o for n, o in names.items() if callable(o) and id(o) not in told}
    told.update(map(id, names.values()))
    errors = {n for n, o in names.items() if isinstance(o, type) and issubclass(o, BaseException)}
    records = {n for n, o in names.items() if isinstance(o, type)} - errors
    functions = names.keys() - records - errors
    kinds = (
        ("Functions", functions, "function.rst"),
        ("Objects", records, "record.rst"),
        ("Errors and warnings", errors, ""),
    )
    for kind, some, template in kinds:
        if some:
            if not prefix:
                yield f"{kind}\n{'-' * len(kind)}\n"
            told_by = f"   :template: {template}\n" if template else ""
            listed = "".join(
                f"   {prefix + '.' if prefix else ''}{name}\n" for name in sorted(some)
            )
            yield f".. autosummary::\n   :toctree: names\n   :nosignatures:\n{told_by}\n{listed}"
