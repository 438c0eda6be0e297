"""Laws of other packages that a scene names, with their parameters.

A table names a law as ``module:name``, or by an entry point of the group "tractive_sam.laws";
further keys of the table are its parameters. Reading a scene imports nothing: the form of the name
is checked, and `build_law` imports the module where the law is needed. It imports only modules of
installed packages, or takes them where they are imported already, and calls only subclasses of the
law that the table takes: a scene file cannot bring code with it, nor have the code of any other
library run.
"""

from __future__ import annotations

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

from .faults import Fault, SceneError, shown, suggestion
from .table import Table, plain

GROUP = "tractive_sam.laws"
"""Entry points by which packages give their laws short names."""

ANOTHER = 'or "module:name" of an installed package'
"""What a key that names a law allows beside the laws of this package."""

_FORM = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*")


@dataclass(frozen=True)
class NamedLaw:
    """A law of another package.

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
        given = ", ".join(f"{key} = {value}" for key, value in self.parameters.items())
        return f"{self.name}({given})"


class LawTable(Table):
    """A table that names a law: one of this package, or one of another with any parameters."""

    law_key: ClassVar[str] = "law"
    """Key that names the law."""
    law_names: ClassVar[tuple[str, ...]] = ()
    """Names of the laws of this package."""
    law_fields: ClassVar[tuple[str, ...]] = ()
    """Keys of these laws; a law of another package may have parameters of these names."""

    @classmethod
    def unfolded(cls, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return the entries with a law of another package and its parameters as one."""
        text = given.get(cls.law_key)
        if not isinstance(text, str) or text in cls.law_names or not (name := _full_name(text)):
            return given
        common = {*cls.model_fields} - {*cls.law_fields, cls.law_key}
        parameters = {
            str(key): plain(value)
            for key, value in given.items()
            if key not in common and key != cls.law_key and value is not None
        }
        others = {key: value for key, value in given.items() if key in common}
        return {cls.law_key: NamedLaw(name, parameters), **others}

    @classmethod
    def described_beyond(cls, name: str) -> FieldInfo | None:
        """Return the field of a key that is none of the table: a parameter of a law.

        The letters of a key of the table in another order are a slip.
        """
        slip = sorted(name) in map(sorted, cls.model_fields)
        if slip or not name.isidentifier():
            return None
        return FieldInfo(annotation=Any, title=f"{name}, a parameter of the law")

    @property
    def named_law(self) -> NamedLaw | None:
        """The law of another package; None for the laws of this one."""
        law = getattr(self, self.law_key)
        return law if isinstance(law, NamedLaw) else None

    def entries(self) -> dict[str, Any]:
        """Return what was given, see `Table.entries`."""
        return self._with_parameters(super().entries())

    def settings(self) -> dict[str, Any]:
        """Return all settings, see `Table.settings`."""
        return self._with_parameters(super().settings())

    def _with_parameters(self, entries: dict[str, Any]) -> dict[str, Any]:
        if (law := self.named_law) is None:
            return entries
        return {**entries, self.law_key: law.name, **law.parameters}


def _full_name(text: str) -> str | None:
    """Return ``module:name`` of a law, or of an entry point; None for any other text."""
    if ":" in text:
        return text if _FORM.fullmatch(text) else None
    found = metadata.entry_points(group=GROUP, name=text)
    return next((f"{one.module}:{one.attr}" for one in found), None)


def build_law(
    key: str, law: NamedLaw, base: type[Any], provided: Mapping[str, Any] | None = None
) -> Any:
    """Return the law that a scene names, of an installed package.

    Parameters
    ----------
    key : str
        Dotted key that names the law, as ``friction.law``.
    law : NamedLaw
        Its name and parameters.
    base : type
        The class that it is to be a subclass of.
    provided : mapping, optional
        Values of other keys of the scene, given to the class if it has parameters of these names.

    Raises
    ------
    SceneError
        If the law is not installed, is no law for this key, or is given unknown, missing or
        wrong parameters; with all such faults.
    """
    kind = load_law_class(key, law, base)
    table = key.rpartition(".")[0]
    faults: list[Fault] = []
    arguments = dict(_arguments(kind, law.parameters, provided or {}, faults))
    if not faults:
        try:
            return kind(**arguments)
        except (TypeError, ValueError) as error:
            faults.append(Fault("law", str(law), f"what the law accepts ({error})"))
    raise SceneError(fault.under(table) for fault in faults)


def load_law_class(key: str, law: NamedLaw, base: type[Any]) -> type[Any]:
    """Return the class that a scene names, of an installed package.

    Parameters
    ----------
    key, law, base
        As of `build_law`.

    Raises
    ------
    SceneError
        If it is not installed, or no subclass of `base`.
    """
    try:
        kind = _load(law.name)
    except (ImportError, AttributeError, ValueError) as error:
        raise SceneError([Fault(key, law.name, f"{_ALLOWED} ({error})")]) from None
    if not (isinstance(kind, type) and issubclass(kind, base)):
        raise SceneError([Fault(key, law.name, f"a subclass of ts.{base.__name__}")])
    return kind


_ALLOWED = "a law of an installed package, module:name"


def _load(name: str) -> Any:
    """Return what a name stands for; a module that is not yet imported has to be installed."""
    module, _, attribute = name.partition(":")
    if module not in sys.modules:
        _check_installed(module.partition(".")[0])
    return getattr(import_module(module), attribute)


def _check_installed(root: str) -> None:
    spec = find_spec(root)
    if spec is None:
        raise ImportError(f"there is no module {root}")
    if not _is_installed(spec):
        place = spec.origin or "the interpreter"
        raise ImportError(f"{root} is no installed package: it comes from {place}")


def _is_installed(spec: ModuleSpec) -> bool:
    """Whether a module lies where packages are installed, and not in the current folder."""
    if spec.submodule_search_locations is not None:
        folders = [Path(one).parent for one in spec.submodule_search_locations]
    else:
        folders = [Path(spec.origin).parent] if spec.has_location and spec.origin else []
    installed: set[Path] = set()
    editable: list[Path] = []
    for one in metadata.distributions():
        installed.add(Path(str(one.locate_file(""))).resolve())
        editable += _source_folder(one)
    # `python -m` and interactive sessions search the current folder, which may be that of a scene.
    installed -= {Path.cwd().resolve()}
    places = [folder.resolve() for folder in folders]
    return bool(places) and all(
        place in installed or any(place.is_relative_to(one) for one in editable) for place in places
    )


def _source_folder(distribution: metadata.Distribution) -> Iterator[Path]:
    """Yield the folder of the sources of a package that is installed as editable (PEP 610)."""
    text = distribution.read_text("direct_url.json")
    origin = json.loads(text) if text else {}
    if origin.get("dir_info", {}).get("editable"):
        yield Path(url2pathname(urlparse(origin["url"]).path)).resolve()


def _arguments(
    kind: type, given: Mapping[str, Any], provided: Mapping[str, Any], faults: list[Fault]
) -> Iterator[tuple[str, Any]]:
    """Yield the arguments of a class by name; collect the faults of what is given."""
    parameters = inspect.signature(kind).parameters
    named = {
        name: one
        for name, one in parameters.items()
        if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)
    }
    types, own = _types(kind), [name for name in named if name not in provided]
    any_name = any(one.kind is one.VAR_KEYWORD for one in parameters.values())
    for name, value in given.items():
        if name in named or any_name:
            yield name, _read(name, value, types.get(name, Any), faults)
        else:
            allowed = suggestion(name, own) if own else f"no parameter: {kind.__name__} has none"
            faults.append(Fault(name, shown(value), allowed))
    for name, one in named.items():
        if name in given:
            continue
        if name in provided:
            yield name, provided[name]
        elif one.default is one.empty:
            expected = _describe_type(types.get(name, Any))
            faults.append(Fault(name, "nothing", f"{expected}, which {kind.__name__} needs"))


def _types(kind: Any) -> dict[str, Any]:
    """Return the types of the parameters of a class; empty where they cannot be found."""
    try:
        return get_type_hints(kind.__init__)
    except NameError:  # imported for type checkers only
        return {}


def _read(name: str, value: Any, kind: Any, faults: list[Fault]) -> Any:
    if kind is np.ndarray:
        kind, value = Any, np.asarray(value)
        if value.dtype.kind not in "fiub":
            faults.append(Fault(name, shown(value), "a list of numbers"))
    adapter = _adapter(kind)
    # A table may stand for a record, as { shear = 8e4, poisson = 0.3 } for a material.
    strict = not isinstance(value, Mapping)
    forms = (value, list(value)) if isinstance(value, tuple) else (value,)
    for form in forms:
        try:
            return adapter.validate_python(form, strict=strict)
        except ValidationError:
            continue
    faults.append(Fault(name, shown(value), _describe_type(kind)))
    return None


def _adapter(kind: Any) -> TypeAdapter[Any]:
    try:
        return TypeAdapter(kind, config=ConfigDict(arbitrary_types_allowed=True))
    except PydanticUserError:  # records have a configuration already
        return TypeAdapter(kind)


_WORDS = {float: "a number", int: "a whole number", str: "a text", bool: "true or false"}


def _describe_type(kind: Any) -> str:
    if kind is Any:
        return "a value"
    return _WORDS.get(kind) or f"a value of the type {inspect.formatannotation(kind)}"
