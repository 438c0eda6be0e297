"""The base class of all tables of a document: construction, help, description.

`Table.describe` returns the rows of a table that is given. `Table.effect` names what is left out
if a table is absent. The table of an array has `describe_array` in addition.

Pydantic checks the type and the bounds of each entry; `reading` collects the faults of all entries
and of the checks between them.
"""

from collections.abc import Iterable
from typing import Any, ClassVar

from pydantic import BaseModel

from tractive_sam.description import Row

from .faults import SceneError
from .keys import docstring_with_keys, key_signature, set_allowed_texts
from .reading import read_entries
from .table_base import TableBase


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


_LIBRARY = set(dir(BaseModel))


def _internal_names(cls: Any) -> frozenset[str]:
    """Return the names of a table class, without special ones, that help leaves out."""
    return frozenset(_LIBRARY).union(*(getattr(base, "internal", ()) for base in cls.__mro__))


def _listed_names(cls: Any) -> list[str]:
    """Return the names of a table class that help and completion list."""
    internal = _internal_names(cls)
    names = type(BaseModel).__dir__(cls)
    return [name for name in names if name[:2] != "__" and name not in internal]


def _ignore_signature(cls: Any, of_library: Any) -> None:
    """Do nothing when pydantic sets the signature of a table class."""


def _construct(cls: Any, /, *unnamed: Any, **entries: Any) -> Any:
    """Construct a table class from keywords, and call its `check_complete`.

    The class has no `__init__` for this purpose: type checkers take the keys from the fields.
    """
    if unnamed:
        name = cls.__name__
        cure = f"; {name}.from_toml(path) reads a file" if hasattr(cls, "from_toml") else ""
        raise TypeError(f"{name}(...) takes keywords only{cure}")
    try:
        table = type(BaseModel).__call__(cls, **entries)
    except SceneError as error:
        raise cls.error_class(error.faults) from None
    table.check_complete()
    return table


# Pydantic has no public name for the metaclass of its models.
_TableType: Any = type(
    "_TableType",
    (type(BaseModel),),
    {
        "__call__": _construct,
        "__dir__": _listed_names,
        "__signature__": property(key_signature, _ignore_signature),
    },
)


class Table(TableBase, metaclass=_TableType):
    """Base class of immutable tables, with the keys of a TOML table as keywords.

    Keywords are the keys of the TOML table; None stands for "not given".

    Raises
    ------
    SceneError
        With all faults of the table and of its inner tables.
    """

    internal: ClassVar[frozenset[str]] = frozenset(
        (
            *("check_complete", "checks", "describe_array", "effect", "error_class", "find_field"),
            *("find_parameter", "internal", "key_advice", "table_class", "unfold"),
        )
    )
    """Names that the package uses and completion leaves out."""
    effect: ClassVar[str] = ""
    """What a document without the table leaves out, for descriptions; may be empty."""
    error_class: ClassVar[type[SceneError]] = SceneError
    """Class of the errors that report its faults."""

    def __init__(self, /, **entries: Any) -> None:
        reading = read_entries(type(self), entries)
        if reading.faults:
            raise SceneError(reading.faults)
        self.__setstate__(
            {
                "__dict__": reading.values,
                "__pydantic_fields_set__": set(reading.given),
                "__pydantic_extra__": None,
                "__pydantic_private__": None,
            }
        )

    def check_complete(self) -> None:
        """Check the constructed table and issue its warnings; does nothing by default.

        Raises
        ------
        SceneError
            With the faults that only the finished table shows.
        """

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Document the keys of a new class of tables."""
        set_allowed_texts(cls)
        cls.__doc__ = docstring_with_keys(cls)

    def describe(self, scene: Any) -> Iterable[Row]:
        """Return the rows (label, text) that describe the table in reports of a scene.

        Parameters
        ----------
        scene : Scene
            The scene that contains the table.
        """
        return ()

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse the change, with the way to make a changed copy."""
        cure = 'make a changed copy, as with scene.replace(**{"load.normal": 200.0})'
        raise AttributeError(f"{name}: a {type(self).__name__} cannot be changed; {cure}")

    def __dir__(self) -> list[str]:
        """Return the names for users, without internal names of pydantic and the package."""
        internal = _internal_names(type(self))
        return [name for name in super().__dir__() if name[:2] == "__" or name not in internal]
