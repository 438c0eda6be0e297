"""The [process] table: a process of another package."""

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
    describe_law_names,
    entry,
)

from .contact_checks import REVOLUTION_KEYS
from .schedule import NamedSchedule, Schedule, check_ascending


def _check_save(entries: ValidEntries) -> Iterator[Fault]:
    """Report `save` of [process] if it has values beyond `end`, the last one of its coordinate."""
    save, end = entries["save"], entries["end"]
    if save and save[-1] > end:
        yield Fault("save", str(list(save)), f"values of the coordinate up to end, {end:g}")


class ProcessTable(LawTable):
    """Name, parameters and end of a process, a class that determines the sequence of contacts.

    The name is a subclass of `Process` in an installed package, or an entry point of this package
    in the group "tractive_sam.laws". Further keys are parameters of the class.

    Examples
    --------
    >>> ts.ProcessTable(name="my_package:IndexingDrive", end=10, passes=5).save
    (0.0, 10.0)
    """

    name: NamedLaw = entry("process", describe_law_names(()))
    end: Real = entry("last value of the coordinate of the process", ge=0)
    save: Annotated[tuple[Real, ...], AfterValidator(check_ascending)] = entry(
        "values of the coordinate at which fields are stored",
        "a list of ascending numbers up to end",
        default_factory=lambda entries: tuple(sorted({0.0, entries["end"]})),
    )
    law_key: ClassVar[str] = "name"
    checks: ClassVar[tuple[Check, ...]] = (_check_save,)

    @property
    def schedule(self) -> Schedule:
        """Schedule of the named process: end and values of its coordinate to store."""
        return NamedSchedule(self.end, self.save)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: name of the process, its end and the places of stored fields."""
        yield Row("name", str(self.name))
        yield Row(
            "end",
            f"{self.end:g}; fields stored at {', '.join(f'{place:g}' for place in self.save)}",
        )


def _check_process_excludes(entries: ValidEntries) -> Iterator[Fault]:
    """Report tables and keys that [process] excludes."""
    if entries["process"] is None:
        return
    for table in ("transient", "duty", "accuracy"):
        if entries[table]:
            yield Fault("process", f"with [{table}]", f"[process] or [{table}], not both")
    for key in REVOLUTION_KEYS:
        if f"wear.{key}" in entries.given:
            cure = "nothing: the process wears up to process.end"
            yield Fault(f"wear.{key}", "with [process]", cure)


PROCESS_CHECKS: tuple[Check, ...] = (_check_process_excludes,)
"""Checks between [process] and the other tables."""
