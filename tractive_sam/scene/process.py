"""The [process] table: a process of another package, by which the records of a scene follow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator

from tractive_sam.schema import (
    Check,
    Fault,
    LawTable,
    NamedLaw,
    Real,
    Row,
    ValidEntries,
    allow_laws,
    entry,
)

from .transient import OF_REVOLUTIONS, rising


def _saved_within(entries: ValidEntries) -> Iterator[Fault]:
    save, end = entries["save"], entries["end"]
    if save and save[-1] > end:
        yield Fault("save", str(list(save)), f"values of the coordinate up to end, {end:g}")


class ProcessTable(LawTable):
    """The [process] table: how the contacts of a scene follow each other.

    It names a subclass of `Process` of an installed package, or one of its entry points in the
    group "tractive_sam.laws"; further keys are its parameters.

    Examples
    --------
    >>> ts.ProcessTable(name="my_package:IndexingDrive", end=10, passes=5).save
    (0.0, 10.0)
    """

    name: NamedLaw = entry("the process", allow_laws(()))
    end: Real = entry("last value of its coordinate", "a number of at least 0", ge=0)
    save: Annotated[tuple[Real, ...], AfterValidator(rising)] = entry(
        "values of its coordinate at which fields are stored",
        "ascending numbers up to end",
        default_factory=lambda given: tuple(sorted({0.0, given["end"]})),
    )
    law_key: ClassVar[str] = "name"
    checks: ClassVar[tuple[Check, ...]] = (_saved_within,)

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`."""
        yield Row("name", str(self.name))
        yield Row(
            "end", f"{self.end:g}; fields stored at {', '.join(f'{at:g}' for at in self.save)}"
        )


def _process_is_alone(entries: ValidEntries) -> Iterator[Fault]:
    if entries["process"] is None:
        return
    for table in ("transient", "duty", "accuracy"):
        if entries[table]:
            yield Fault("process", f"together with [{table}]", "one of both")
    for key in OF_REVOLUTIONS:
        if f"wear.{key}" in entries.given:
            cure = "nothing: process.end says how long it wears"
            yield Fault(f"wear.{key}", "together with [process]", cure)


PROCESS_CHECKS: tuple[Check, ...] = (_process_is_alone,)
"""Checks between [process] and the other tables."""
