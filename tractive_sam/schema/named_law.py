"""Laws of other packages that a scene names, with their parameters.

A table names a law as ``module:name``, or by an entry point of the group "tractive_sam.laws";
further keys of the table are its parameters. Reading a scene imports nothing: only the form of the
name is checked, and `build_law` imports the module when the law is needed. It imports only modules
of installed packages, or uses modules that are already imported, and calls only subclasses of the
class that the table needs. A scene file can neither contain code nor run code of another library.
"""

import inspect
import json
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module, metadata
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path
from typing import Any, ClassVar, get_type_hints
from urllib.parse import urlparse
from urllib.request import url2pathname

import numpy as np
from pydantic import ConfigDict, PydanticUserError, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from .allowed_text import describe_allowed, list_names
from .faults import Fault, SceneError, shorten, suggest_name
from .table import Table
from .table_base import to_python


@dataclass(frozen=True)
class NamedLaw:
    """Name ("module:class") and parameters of a user-defined law, as a scene gives them.

    Attributes
    ----------
    name : str
        ``module:name`` of its class.
    parameters : mapping
        Arguments of the class, as the table gives them.
    """

    name: str
    parameters: Mapping[str, Any]

    def __hash__(self) -> int:
        return hash(self.name)

    def __str__(self) -> str:
        parameters = ", ".join(f"{key} = {value}" for key, value in self.parameters.items())
        return f"{self.name}({parameters})"


class LawTable(Table):
    """Base class of tables that name a law: built-in, or a user-defined class and parameters."""

    law_key: ClassVar[str] = "law"
    """Key that names the law."""
    law_names: ClassVar[tuple[str, ...]] = ()
    """Names of the laws of this package."""
    law_fields: ClassVar[tuple[str, ...]] = ()
    """Keys of these laws; a law of another package may have parameters of these names."""

    @classmethod
    def unfold(cls, table: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return entries in which a user-defined law and its parameters are one `NamedLaw`."""
        text = table.get(cls.law_key)
        if not isinstance(text, str) or text in cls.law_names or not (name := _full_name(text)):
            return table
        common = {*cls.model_fields} - {*cls.law_fields, cls.law_key}
        parameters = {
            str(key): to_python(value)
            for key, value in table.items()
            if key not in common and key != cls.law_key and value is not None
        }
        entries = {key: value for key, value in table.items() if key in common}
        return {cls.law_key: NamedLaw(name, parameters), **entries}

    @classmethod
    def find_parameter(cls, name: str) -> FieldInfo | None:
        """Return a field for a further key, taken as a parameter of the law; None if misspelt.

        A name with the letters of a key of the table in another order is a spelling mistake.
        """
        misspelt = sorted(name) in map(sorted, cls.model_fields)
        if misspelt or not name.isidentifier():
            return None
        return FieldInfo(annotation=Any, title=f"{name}, a parameter of the law")

    @property
    def named_law(self) -> NamedLaw | None:
        """User-defined law that the table names; None for a built-in law."""
        law = getattr(self, self.law_key)
        return law if isinstance(law, NamedLaw) else None

    def entries(self) -> dict[str, Any]:
        """Return the entries that were set, with the parameters of a user-defined law."""
        return self._with_parameters(super().entries())

    def settings(self) -> dict[str, Any]:
        """Return all entries with defaults, and the parameters of a user-defined law."""
        return self._with_parameters(super().settings())

    def _with_parameters(self, entries: dict[str, Any]) -> dict[str, Any]:
        """Return entries in which a `NamedLaw` is replaced by its name and its parameters."""
        if (law := self.named_law) is None:
            return entries
        return {**entries, self.law_key: law.name, **law.parameters}


def allow_laws(names: tuple[str, ...]) -> str:
    """Return text for the allowed values of a key: built-in names or ``module:class``."""
    another = '"module:name" of an installed package'
    return f"{list_names(names)}, or {another}" if names else another


def _full_name(text: str) -> str | None:
    """Return "module:class" for this text or for an entry point's name; else None."""
    if ":" in text:
        identifier = r"[^\W\d]\w*"
        return text if re.fullmatch(rf"{identifier}(\.{identifier})*:{identifier}", text) else None
    points = metadata.entry_points(group="tractive_sam.laws", name=text)
    return next((f"{point.module}:{point.attr}" for point in points), None)


def build_law(
    key: str, law: NamedLaw, base: type[Any], provided: Mapping[str, Any] | None = None
) -> Any:
    """Return an instance of the user-defined law that a scene names, checked for its base.

    Parameters
    ----------
    key : str
        Dotted key that names the law, as ``friction.law``.
    law : NamedLaw
        Name and parameters of the law.
    base : type
        Base class that the law must have.
    provided : mapping, optional
        Values of other keys of the scene, given to the class if it has parameters of these names.

    Raises
    ------
    SceneError
        If the law is not installed, is no law for this key, or has unknown, missing or wrong
        parameters; with all these faults.
    """
    kind = load_law_class(key, law, base)
    table, _, name = key.rpartition(".")
    faults: list[Fault] = []
    arguments = dict(_arguments(kind, law.parameters, provided or {}, faults))
    if not faults:
        try:
            return kind(**arguments)
        except (TypeError, ValueError) as error:
            faults.append(Fault(name, str(law), f"what the law accepts ({error})"))
    raise SceneError(fault.under(table) for fault in faults)


def load_law_class(key: str, law: NamedLaw, base: type[Any]) -> type[Any]:
    """Import and return the user-defined subclass of `base` that a scene names, or raise.

    Parameters
    ----------
    key, law, base
        See `build_law`.

    Raises
    ------
    SceneError
        If it is not installed, or is no subclass of `base`.
    """
    try:
        kind = _load(law.name)
    except (ImportError, AttributeError, ValueError) as error:
        allowed = f"a law of an installed package, module:name ({error})"
        raise SceneError([Fault(key, law.name, allowed)]) from None
    if not (isinstance(kind, type) and issubclass(kind, base)):
        raise SceneError([Fault(key, law.name, f"a subclass of ts.{base.__name__}")])
    return kind


def _load(name: str) -> Any:
    """Import and return the class "module:class" of an installed module."""
    module, _, attribute = name.partition(":")
    if module not in sys.modules:
        _check_installed(module.partition(".")[0])
    return getattr(import_module(module), attribute)


def _check_installed(root: str) -> None:
    """Raise an ImportError unless a module is part of an installed package."""
    spec = find_spec(root)
    if spec is None:
        raise ImportError(f"the module {root} does not exist")
    if not _is_installed(spec):
        place = spec.origin or "the interpreter"
        raise ImportError(f"{root} is not an installed package: it comes from {place}")


def _is_installed(spec: ModuleSpec) -> bool:
    """Return whether a module lies in a folder of installed packages."""
    if spec.submodule_search_locations is not None:
        folders = [Path(location).parent for location in spec.submodule_search_locations]
    else:
        folders = [Path(spec.origin).parent] if spec.has_location and spec.origin else []
    installed: set[Path] = set()
    editable: list[Path] = []
    for distribution in metadata.distributions():
        installed.add(Path(str(distribution.locate_file(""))).resolve())
        editable += _source_folder(distribution)
    # `python -m` and interactive sessions search the current folder, which may contain a scene.
    installed -= {Path.cwd().resolve()}
    places = [folder.resolve() for folder in folders]
    return bool(places) and all(
        place in installed or any(place.is_relative_to(folder) for folder in editable)
        for place in places
    )


def _source_folder(distribution: metadata.Distribution) -> Iterator[Path]:
    """Yield the source folder of a package that is installed as editable (PEP 610)."""
    text = distribution.read_text("direct_url.json")
    origin = json.loads(text) if text else {}
    if origin.get("dir_info", {}).get("editable"):
        yield Path(url2pathname(urlparse(origin["url"]).path)).resolve()


def _arguments(
    kind: type, values: Mapping[str, Any], provided: Mapping[str, Any], faults: list[Fault]
) -> Iterator[tuple[str, Any]]:
    """Yield (name, value) of constructor arguments; collect faults of the given values."""
    parameters = inspect.signature(kind).parameters
    named = {
        name: parameter
        for name, parameter in parameters.items()
        if parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY)
    }
    types, free = _parameter_types(kind), [name for name in named if name not in provided]
    any_name = any(p.kind is p.VAR_KEYWORD for p in parameters.values())
    for name, value in values.items():
        if name in named or any_name:
            yield name, _read_argument(name, value, types.get(name, Any), faults)
        else:
            none = f"no parameter: {kind.__name__} has none"
            allowed = suggest_name(name, free) if free else none
            faults.append(Fault(name, shorten(value), allowed))
    for name, parameter in named.items():
        if name in values:
            continue
        if name in provided:
            yield name, provided[name]
        elif parameter.default is parameter.empty:
            expected = _describe_type(types.get(name, Any))
            faults.append(Fault(name, "nothing", f"{expected}, which {kind.__name__} needs"))


def _parameter_types(kind: Any) -> dict[str, Any]:
    """Return the type hints of a class's parameters by name; empty if unresolved."""
    try:
        return get_type_hints(kind.__init__)
    except NameError:  # imported for type checkers only
        return {}


def _read_argument(name: str, value: Any, kind: Any, faults: list[Fault]) -> Any:
    """Return a value read as the type of an argument; append a fault if it does not fit."""
    if kind is np.ndarray:
        kind, value = Any, np.asarray(value)
        if value.dtype.kind not in "fiub":
            faults.append(Fault(name, shorten(value), "a list of numbers"))
    adapter = _adapter(kind)
    # A table may stand for a record, as { shear = 8e4, poisson = 0.3 } for a material.
    strict = not isinstance(value, Mapping)
    forms = (value, list(value)) if isinstance(value, tuple) else (value,)
    for form in forms:
        try:
            return adapter.validate_python(form, strict=strict)
        except ValidationError:
            continue
    faults.append(Fault(name, shorten(value), _describe_type(kind)))
    return None


def _adapter(kind: Any) -> TypeAdapter[Any]:
    """Return pydantic's validator of a type, which may be a class that pydantic does not know."""
    try:
        return TypeAdapter(kind, config=ConfigDict(arbitrary_types_allowed=True))
    except PydanticUserError:  # records have a configuration already
        return TypeAdapter(kind)


def _describe_type(kind: Any) -> str:
    """Return text that describes the values of a type, for messages."""
    if kind is Any:
        return "a value"
    return describe_allowed(kind) or f"a value of the type {inspect.formatannotation(kind)}"
