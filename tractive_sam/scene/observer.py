"""The [[observer]] tables: observers of other packages, which follow the records of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, ClassVar

from tractive_sam.description import Row
from tractive_sam.schema import Fault, LawTable, NamedLaw, ValidEntries, allow_laws, entry


class ObserverTable(LawTable):
    """An [[observer]] table: what follows the steps of a process and records more of them.

    It names a subclass of `Observer` of an installed package, or one of its entry points in the
    group "tractive_sam.laws"; further keys are its parameters.

    Examples
    --------
    >>> ts.ObserverTable(name="my_package:FrictionEnergy", threshold=0.5).name.parameters
    {'threshold': 0.5}
    """

    name: NamedLaw = entry("the observer", allow_laws(()))
    law_key: ClassVar[str] = "name"

    @classmethod
    def describe_array(cls, observers: Sequence[Any], scene: Any) -> Iterator[Row]:
        """Describe the observers of a scene; what each does is described by itself."""
        for one in observers:
            yield Row("observer", str(one.name))


def check_observers(entries: ValidEntries) -> Iterator[Fault]:
    """Report observers that a scene names twice."""
    names = [one.name.name for one in entries["observer"]]
    for k, name in enumerate(names):
        if name in names[:k]:
            yield Fault(f"observer[{k}].name", name, "each observer once")
