"""Laws of other packages that a scene names, with their parameters.

A table names a law as ``module:name``, or by an entry point of the group "tractive_sam.laws";
further keys of the table are its parameters. Reading a scene imports nothing: only the form of the
name is checked, and `build_law` imports the module when the law is needed. It imports only modules
of registered laws and modules that the user allows (`allow_laws`), because importing a module runs
its code. The modules of this package need no permission. It calls only subclasses of the class that
the table needs.
"""

import inspect
import json
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module, metadata
from pathlib import Path
from typing import Any, ClassVar, get_type_hints
from urllib.parse import urlparse

import numpy as np
from pydantic import ConfigDict, PydanticUserError, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from .faults import Fault, SceneError, shorten, suggest_name
from .keys import describe_allowed, list_names
from .table import Table, to_python

_IDENTIFIER = r"[^\W\d]\w*"
_MODULE = rf"{_IDENTIFIER}(?:\.{_IDENTIFIER})*"
_ALLOWED: set[str] = set()


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


def describe_law_names(names: tuple[str, ...]) -> str:
    """Return text for the allowed values of a key: built-in names or ``module:class``."""
    another = '"module:name" of a registered or allowed class'
    return f"{list_names(names)}, or {another}" if names else another


def allow_laws(*names: str) -> tuple[str, ...]:
    """Allow scenes to name classes of these modules; return all names that are allowed.

    Applies to laws, criteria, processes and observers, in this Python process and in the workers of
    its studies, tables and fits. The modules are imported when the classes are needed. Registered
    laws (entry-point group "tractive_sam.laws") need no permission. Importing a module runs its
    code: allow only modules that you trust.

    Parameters
    ----------
    *names : str
        ``module:name`` of a class, or ``module`` for all its classes.

    Raises
    ------
    ValueError
        If a name has another form, or is a module ``__main__``, which would run a program.

    Examples
    --------
    >>> ts.allow_laws("film_laws:Film")
    ('film_laws:Film',)
    """
    for name in names:
        if not re.fullmatch(rf"{_MODULE}(:{_IDENTIFIER})?", name) or "__main__" in name:
            raise ValueError(f"{name!r} cannot be allowed; use MODULE or MODULE:NAME, no __main__")
    _ALLOWED.update(names)
    return tuple(sorted(_ALLOWED))


def installed_entry_points(group: str) -> Iterator[metadata.EntryPoint]:
    """Yield the entry points of a group that installed packages register.

    Metadata in the current folder or in the source folder of an editable installation (PEP 610) do
    not count: the interpreter may search these folders, and received files may be in them.
    """
    from urllib.request import url2pathname  # noqa: PLC0415 - loads http and ssl

    here, sources = Path.cwd().resolve(), []
    distributions = [
        (place, distribution)
        for distribution in metadata.distributions()
        if (place := Path(str(distribution.locate_file(""))).resolve()) != here
    ]
    for _, distribution in distributions:
        with suppress(AttributeError, KeyError, ValueError):  # metadata that are not valid
            origin = json.loads(distribution.read_text("direct_url.json") or "{}")
            if origin.get("dir_info", {}).get("editable"):
                sources.append(Path(url2pathname(urlparse(origin["url"]).path)).resolve())
    for place, distribution in distributions:
        # A virtual environment may be within a source folder.
        installed = place.name in ("site-packages", "dist-packages")
        if installed or not any(map(place.is_relative_to, sources)):
            yield from distribution.entry_points.select(group=group)


def _full_name(text: str) -> str | None:
    """Return "module:class" for this text or for an entry point's name; else None."""
    if ":" in text:
        return text if re.fullmatch(f"{_MODULE}:{_IDENTIFIER}", text) else None
    return next((name for short, name in _registered_laws() if short == text), None)


def _registered_laws() -> Iterator[tuple[str, str]]:
    """Yield (short name, "module:class") of the laws that installed packages register."""
    for point in installed_entry_points("tractive_sam.laws"):
        yield point.name, f"{point.module}:{point.attr}"


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
        If the law may not be imported, is no law for this key, or has unknown, missing or wrong
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
    """Return the user-defined subclass of `base` that a scene names; import it if it is allowed.

    Parameters
    ----------
    key, law, base
        See `build_law`.

    Raises
    ------
    SceneError
        If it may not be imported, cannot be imported, or is no subclass of `base`.
    """
    kind: Any
    module, _, name = law.name.partition(":")
    registered = (full for _, full in _registered_laws())
    if module.startswith("tractive_sam.") and "__main__" not in module:
        with suppress(ImportError):
            import_module(module)
    if _ALLOWED.isdisjoint((module, law.name)) and law.name not in registered:
        # A lookup in the module itself: its `__getattr__` could import other modules.
        loaded = sys.modules.get(module)
        kind = object.__getattribute__(loaded, "__dict__").get(name) if loaded else None
        passed_on = str(getattr(kind, "__module__", "")).startswith("tractive_sam.")
        if not issubclass(type(kind), type) or (passed_on and kind.__module__ != module):
            cure = f"--allow {law.name} or ts.allow_laws({law.name!r}) if you trust this code"
            cure = "a module __main__ is never imported" if "__main__" in module else cure
            allowed = f"a law that an installed package registers; {cure}"
            raise SceneError([Fault(key, law.name, allowed)])
    else:
        try:
            kind = getattr(import_module(module), name)
        except Exception as error:  # whatever the module raises
            allowed = f"a class that can be imported ({type(error).__name__}: {error})"
            raise SceneError([Fault(key, law.name, allowed)]) from error
    if not (issubclass(type(kind), type) and issubclass(kind, base)):
        raise SceneError([Fault(key, law.name, f"a subclass of ts.{base.__name__}")])
    return kind


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
    try:
        adapter = TypeAdapter(kind, config=ConfigDict(arbitrary_types_allowed=True))
    except PydanticUserError:  # records have a configuration already
        adapter = TypeAdapter(kind)
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


def _describe_type(kind: Any) -> str:
    """Return text that describes the values of a type, for messages."""
    if kind is Any:
        return "a value"
    return describe_allowed(kind) or f"a value of the type {inspect.formatannotation(kind)}"
