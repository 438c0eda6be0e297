"""The design of a study: a scene and the keys that vary in it, checked together."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Literal

from tractive_sam.scene import (
    FILE_KEYS,
    Scene,
    builtin_names,
    parse_settings,
    resolve_parametric_files,
)
from tractive_sam.schema import (
    Check,
    Document,
    Fault,
    LawTable,
    SceneError,
    ValidEntries,
    entry,
    optional,
    shorten,
    suggest_name,
)
from tractive_sam.studies.axis import MAX_CASES, Axis, Dimension, Latin


class StudyError(SceneError):
    """Error that lists all faults of a study and of its scenes.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> ts.Study(scene="spheres", axis=[{"key": "friction.angel", "values": [0, 90]}])
    Traceback (most recent call last):
        ...
    tractive_sam.studies.design.StudyError: 1 fault in the study:
      axis[0].key: given 'friction.angel'; allowed: a dotted key of a scene: angle, perhaps?
    """

    subject: ClassVar[str] = "study"


def _check_axes(entries: ValidEntries) -> Iterator[Fault]:
    """Report a study in which no entry varies."""
    if not entries["axis"] and entries["latin"] is None:
        yield Fault("axis", "nothing", "at least one [[axis]], or a [latin] hypercube")


def _check_entries(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys that vary more than once, and tables that vary together with keys in them."""
    keys = Counter(
        key for dim in _dimensions(entries["axis"], entries["latin"]) for key in dim.columns
    )
    for key, count in keys.items():
        if count > 1:
            yield Fault("axis", f"{key} varies {count} times", "each entry of the scene once")
        within = [entry_key for entry_key in keys if entry_key.startswith(f"{key}.")]
        if within:
            yield Fault("axis", f"{key} and {', '.join(within)}", "a table, or entries within it")


def _parameters_have_a_law(entries: ValidEntries) -> Iterator[Fault]:
    """Report unknown keys in a law's table, unless a user-defined law may have them."""
    keys = [key for dim in _dimensions(entries["axis"], entries["latin"]) for key in dim.columns]
    for key in keys:
        name, _, entry_name = key.partition(".")
        kind = Scene.table_class(Scene.model_fields[name]) if name in Scene.model_fields else None
        if kind is None or not issubclass(kind, LawTable) or entry_name in kind.model_fields:
            continue
        table = getattr(entries["scene"], name)
        has_law = table is not None and table.named_law is not None
        if entry_name and not has_law and f"{name}.{kind.law_key}" not in keys:
            yield Fault("axis", key, suggest_name(entry_name, kind.model_fields))


def _check_count(entries: ValidEntries) -> Iterator[Fault]:
    """Report a study with too many cases."""
    count = math.prod(map(len, _dimensions(entries["axis"], entries["latin"])))
    if count > MAX_CASES:
        yield Fault("axis", f"{count} cases", f"at most {MAX_CASES:.0e}")


class Study(Document):
    """Study: a scene, and entries of it that vary; every combination of the axes is a case.

    Parameters
    ----------
    scene : Scene, str or mapping
        The scene: a scene, the name of a built-in one, a scene file, or the tables of one.
    axis : iterable of Axis or mapping
        See `Axis`; the last one varies fastest.
    latin : Latin or mapping, optional
        Entries that vary together at random, see `Latin`.
    set : iterable of str
        Settings of the scene, as ``solver.tolerance=1e-9``.
    without : iterable of str
        Entries and tables of the scene to leave out, as ``subsurface``.
    keep : str
        "all", a results file for each case, or "scalars", the numbers of its last record alone: all
        cases in one file.
    title : str
        Title.

    Raises
    ------
    StudyError
        With every fault of the study.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> study = ts.Study(
    ...     scene="twin-discs",
    ...     set=["wear.revolutions=1000"],
    ...     axis=[
    ...         {"key": "friction.angle", "values": [0, 45, 90]},
    ...         {"key": "load.normal", "start": 100, "stop": 400, "number": 4},
    ...     ],
    ... )
    >>> study.shape, len(study)
    ((3, 4), 12)
    """

    title: str = entry("title", default="")
    scene: Scene = entry("the scene", "a built-in name, a scene file, or the tables of a scene")
    axis: tuple[Axis, ...] = entry("the axes", "a list of tables", ())
    latin: Latin | None = optional("the Latin hypercube")
    keep: Literal["all", "scalars"] = entry(
        "what is stored of each case: a results file, or the numbers of its last record",
        default="all",
    )
    checks: ClassVar[tuple[Check, ...]] = (
        _check_axes,
        _check_entries,
        _parameters_have_a_law,
        _check_count,
    )
    error_class: ClassVar[type[SceneError]] = StudyError

    def __init__(
        self,
        /,
        scene: Any = None,
        set: Iterable[str] = (),
        without: Iterable[str] = (),
        **unknown: Any,
    ) -> None:
        allowed = (*type(self).model_fields, "set", "without")
        faults = [
            Fault(key, shorten(unknown.pop(key)), suggest_name(key, allowed))
            for key in [*unknown]
            if key not in allowed
        ]
        try:
            scene = _apply_settings(scene, set, without)
        except SceneError as error:
            faults += error.faults
            scene = Scene.builtin(builtin_names()[0])  # so that the rest is checked as well
        try:
            super().__init__(**unknown | {"scene": scene})
        except SceneError as error:
            faults += error.faults
        if faults:
            raise StudyError(faults)

    def entries(self) -> dict[str, Any]:
        """Return the given entries, with the scene written out and its settings applied.

        Relative files in it, which are sought from the working folder, become absolute.
        """
        return self.resolve_files(Path.cwd(), super().entries())

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Make relative paths in a study's tables start from a folder; SceneError for a scene."""
        if "body" in tables:
            cure = 'scene = "FILE.toml", or them in [scene]; tractive-sam run computes a scene'
            raise SceneError([Fault(Fault.FILE, "the tables of a scene", cure)])
        match tables:
            case {"set": list(settings)}:
                tables["set"] = [_setting_from(folder, setting) for setting in settings]
        return resolve_parametric_files(folder, tables)

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Dimensions in which cases are counted (axes, samples), the last one fastest."""
        return _dimensions(self.axis, self.latin)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each dimension of the study."""
        return tuple(map(len, self.dimensions))

    def __len__(self) -> int:
        return math.prod(self.shape)


def is_study(path: str | PathLike[str]) -> bool:
    """Return whether a file is TOML with axes or a Latin hypercube of a study.

    Examples
    --------
    >>> from tractive_sam.studies import is_study
    >>> is_study("twin-discs")  # a scene, and no file
    False
    """
    try:
        return bool({"axis", "latin"} & Study.read_tables(path).keys())
    except SceneError:
        return False


def _setting_from(folder: Path, setting: Any) -> Any:
    """Return a setting ("key=value") with its relative file path starting from a folder."""
    if not isinstance(setting, str) or setting.partition("=")[0].strip() not in FILE_KEYS:
        return setting
    ((key, file),) = parse_settings([setting]).items()
    return f"{key}={folder / str(file)}"


def _dimensions(axes: Iterable[Axis], latin: Latin | None) -> tuple[Dimension, ...]:
    """Return the dimensions of axes, followed by the one of a Latin hypercube."""
    of_axes = tuple(axis.dimension() for axis in axes)
    return of_axes if latin is None else (*of_axes, latin.dimension())


def _apply_settings(scene: Any, settings: Any, without: Any) -> Scene:
    """Return the scene of a study without some tables, and with its settings applied."""
    faults = [
        Fault(name, shorten(value), f"a list of {kind}")
        for name, value, kind in (
            ("set", settings, "settings like solver.tolerance=1e-9"),
            ("without", without, "keys like subsurface"),
        )
        if not isinstance(value, list | tuple) or not all(isinstance(text, str) for text in value)
    ]
    if faults:
        raise SceneError(faults)
    if not isinstance(scene, Scene | Mapping | str):
        value = "nothing" if scene is None else shorten(scene)
        allowed = Study.model_fields["scene"].description or "a scene"
        raise SceneError([Fault("scene", value, allowed)])
    _check_keys(without)
    try:
        if isinstance(scene, Scene):
            scene = scene.replace(**dict.fromkeys(without)) if without else scene
            return scene.with_set(settings) if settings else scene
        tables = Scene.tables_from_name(scene) if isinstance(scene, str) else scene
        return Scene.from_tables(tables, settings, without)
    except SceneError as error:
        raise SceneError(fault.under("scene") for fault in error.faults) from None


def _check_keys(without: Iterable[str]) -> None:
    """Raise a SceneError unless scenes have all of these keys."""
    for key in without:
        try:
            Scene.find_field(key)
        except SceneError as error:
            raise SceneError(replace(fault, key="without") for fault in error.faults) from None
