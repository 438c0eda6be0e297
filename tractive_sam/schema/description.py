"""Describe a document: each table returns its rows, and summaries and reports print them.

`Table.describe` returns the rows of a table that is given. `Table.effect` names what is left out
if a table is absent. The table of an array has `describe_array` in addition.
"""

from typing import Any

from tractive_sam.description import Row


def describe_tables(document: Any) -> dict[str, list[Row]]:
    """Return the rows (label, text) that describe each table of a document, by its key."""
    kinds = {key: document.table_class(info) for key, info in type(document).model_fields.items()}
    return {
        key: _describe_entry(kind, key, getattr(document, key), document)
        for key, kind in kinds.items()
        if kind is not None
    }


def _describe_entry(kind: Any, key: str, value: Any, document: Any) -> list[Row]:
    """Return the rows that describe a table; of a missing one, what is left out."""
    if isinstance(value, tuple):
        return [*kind.describe_array(value, document)]
    if value is not None:
        return [*value.describe(document)]
    return [Row(kind.effect, f"left out: the scene has no [{key}]")] if kind.effect else []
