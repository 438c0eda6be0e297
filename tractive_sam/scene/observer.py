"""The [[observer]] tables: observers of other packages, which follow the records of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, ClassVar

from tractive_sam.description import Row
from tractive_sam.schema import Fault, LawTable, NamedLaw, ValidEntries, describe_law_names, entry


class ObserverTable(LawTable):
    """Name and parameters of an observer, a class that computes further quantities of records.

    The name is a subclass of `Observer` in an installed package, or an entry point of this package
    in the group "tractive_sam.laws". Further keys are parameters of the class.

    Examples
    --------
    >>> ts.ObserverTable(name="my_package:FrictionEnergy", threshold=0.5).name.parameters
    {'threshold': 0.5}
    """

    name: NamedLaw = entry("observer", describe_law_names(()))
    law_key: ClassVar[str] = "name"

    @classmethod
    def describe_array(cls, observers: Sequence[Any], scene: Any) -> Iterator[Row]:
        """Yield a row with the name of each observer, for reports of a scene."""
        for observer in observers:
            yield Row("observer", str(observer.name))


def check_observers(entries: ValidEntries) -> Iterator[Fault]:
    """Report observers that are named twice in a scene."""
    names = [observer.name.name for observer in entries["observer"]]
    for k, name in enumerate(names):
        if name in names[:k]:
            yield Fault(f"observer[{k}].name", name, "each observer once")
