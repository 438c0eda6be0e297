"""The scene: all settings of a computation, its hash, and the built-in scenes as text."""

from __future__ import annotations

import hashlib
import json
import re
import textwrap
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from importlib import resources
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from tractive_sam.description import html_table, text_table
from tractive_sam.mechanics import (
    CombinedMaterial,
    ContactPatch,
    HertzContact,
    HertzLine,
    Material,
    Steel,
    Turns,
)
from tractive_sam.rail import BUILTIN
from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    PlausibilityWarning,
    SceneError,
    SceneWarning,
    Table,
    TomlTable,
    entry,
    key_groups,
    optional,
    shorten,
    suggest_name,
    toml,
    warn,
)

from .bodies import STEEL, Bodies, Heat, Thermal
from .checks import SCENE_CHECKS, find_exclusions, unequal_turns, warn_if_large
from .conformal import Conformal, check_conformity
from .duty import (
    Block,
    Spectrum,
    block_scenes,
    check_blocks_on_mesh,
    cycle_notes,
    override,
    parse_settings,
)
from .friction import Friction, without_zero_friction
from .inclusion import Inclusion, check_inclusions
from .inputs import TEXTS, Gap, Input, InputName, InputPath
from .load_history import LoadHistory, add_blocks
from .plausibility import scene_notes
from .roller import add_roller_gap, check_roller, check_tilt
from .schedule import ObserverTable, ProcessTable, Schedule, Transient
from .steel import Fatigue, Residual, check_steel, find_steel
from .tables import (
    Accuracy,
    Creepage,
    ElasticBodies,
    LineContact,
    Load,
    Mesh,
    PointContact,
    Solver,
    Subsurface,
    draw_ellipse,
    summarize,
    warn_if_coarse,
)
from .wear import Wear
from .wheel_rail import (
    RailTable,
    WheelRail,
    WheelsetTable,
    WheelTable,
    add_wheel_contact,
    without_wheel_contact,
)


def builtin_names() -> tuple[str, ...]:
    """Return the names of the built-in scenes, in alphabetical order.

    Examples
    --------
    >>> "twin-discs" in ts.builtin_names()
    True
    """
    files = (resources.files(__package__) / "builtin").iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def is_path(name: str | PathLike[str]) -> bool:
    """Return whether a text is the path of a scene file (existing or not), rather than a name."""
    path = Path(name)
    return path.suffix == ".toml" or len(path.parts) > 1 or path.exists()


def builtin_text(name: str) -> str:
    """Return the TOML text of a built-in scene.

    Raises
    ------
    SceneError
        If no built-in scene has this name.
    """
    names = builtin_names()
    if name not in names:
        raise SceneError([Fault(Fault.SCENE, shorten(name), suggest_name(name, names))])
    return (resources.files(__package__) / "builtin" / f"{name}.toml").read_text(encoding="utf-8")


def _canonical(value: Any) -> Any:
    """Return a value as JSON types, in one form for all equal settings."""
    match value:
        case dict():
            return {
                key: _canonical(item)
                for key, item in value.items()
                if item is not None and not (isinstance(item, list | tuple) and not item)
            }
        case list() | tuple():
            return [_canonical(item) for item in value]
        case np.ndarray():
            return [value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
        case float():
            return value + 0.0  # no negative zero
        case bool() | int():
            return value
    content = getattr(value, "content", None)
    return str(value) if content is None else content.digest


class Scene(TomlTable):
    """Scene: two bodies, their load and motion, and the quantities to compute.

    A scene is built from keywords, from TOML, or from a built-in scene, and cannot be changed.
    Tables may be given as objects or as dictionaries.

    Raises
    ------
    SceneError
        With every fault of the scene.

    Warns
    -----
    SceneWarning
        If the grid is too coarse for the contact, if the contact is large compared with the radii,
        if bodies that wear do not turn equally often and ``wear.turns = "each"`` is not given, or
        if a value is probably in another unit or missing.

    Examples
    --------
    >>> lighter = scene.replace(**{"load.normal": 0.2, "friction.mu": 0.3})
    >>> round(lighter.hertz.a / scene.hertz.a, 3)
    0.752
    """

    title: str = entry("title", default="")
    body: InnerTable[Bodies] = entry("the two bodies")
    load: InnerTable[Load] = entry("the load")
    creepage: InnerTable[Creepage] = entry("the creepages", default=Creepage())
    elasticity: InnerTable[ElasticBodies | None] = optional("the elastic law of the bodies")
    friction: InnerTable[Friction | None] = optional("the friction law")
    wear: InnerTable[Wear | None] = optional("the wear law")
    grid: InnerTable[Mesh | None] = optional("the grid")
    accuracy: InnerTable[Accuracy | None] = optional("the requested accuracy")
    gap: InnerTable[Gap | None] = optional("the separation added to the radii")
    conformal: InnerTable[Conformal | None] = optional("a contact that curves with its bodies")
    wheel: InnerTable[WheelTable | None] = optional("body A as a wheel")
    rail: InnerTable[RailTable | None] = optional("body B as a rail")
    wheelset: InnerTable[WheelsetTable | None] = optional("the position of the wheelset")
    heat: InnerTable[Heat | None] = optional("the flash temperature")
    subsurface: InnerTable[Subsurface | None] = optional("the subsurface stress")
    fatigue: InnerTable[Fatigue | None] = optional("the fatigue of the material")
    residual: InnerTable[Residual | None] = optional("the residual stress of the bodies")
    inclusion: tuple[Inclusion, ...] = entry(
        "inclusions of the bodies", "at least one inclusion, [[inclusion]]", (), min_length=1
    )
    transient: InnerTable[Transient | None] = optional("changes over the rolling distance")
    process: InnerTable[ProcessTable | None] = optional("a process of another package")
    observer: tuple[ObserverTable, ...] = entry(
        "observers of other packages", "at least one observer, [[observer]]", (), min_length=1
    )
    duty: tuple[Block, ...] = entry(
        "blocks of a duty cycle", "at least one block, [[duty]]", (), min_length=1
    )
    load_history: InnerTable[LoadHistory | None] = optional("the load history of the blocks")
    solver: InnerTable[Solver] = entry("the solver", default=Solver())
    checks: ClassVar[tuple[Check, ...]] = (
        *SCENE_CHECKS,
        check_steel,
        check_inclusions,
        check_roller,
        check_tilt,
        check_conformity,
    )
    internal: ClassVar[frozenset[str]] = frozenset(
        (
            *(
                "contact_type",
                "finds_creepage",
                "from_name",
                "has",
                "from_tables",
                "tables_from_name",
                "has_fixed_domain",
            ),
            *("has_prescribed_force", "schedule", "spectrum", "under_largest_load"),
            *(
                "find_exclusions",
                "has_gap",
                "pair",
                "patch",
                "wheel_rail",
                "opposite_wheel",
                "without_blocks",
            ),
        )
    )

    def check_complete(self) -> None:
        """Raise an error for faulty blocks, and issue the warnings of the complete scene."""
        if self.duty:
            self._check_blocks()
        for note in scene_notes(self):
            warn(note, PlausibilityWarning)
        if note := self._unequal_turns:
            warn(note)
        hertz = self.hertz
        if self.has_gap or hertz is None:  # with a gap the Hertz ellipse is not the contact
            return
        warn_if_large(self.body, hertz)
        if self.grid:
            warn_if_coarse(self.grid, hertz)

    @classmethod
    def unfold(cls, tables: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return tables with what follows from them: blocks, wheel contact, friction above 0."""
        tables = add_roller_gap(add_blocks(without_zero_friction(tables)), Bodies, Load)
        return add_wheel_contact(tables)

    def entries(self) -> dict[str, Any]:
        """Return the entries that were set, nested, without ones computed from the wheel."""
        entries = super().entries()
        if self.body.has_roller:
            entries.pop("gap", None)  # it follows from the profiles
        return entries if self.wheelset is None else without_wheel_contact(entries, self.wheel_rail)

    @cached_property
    def wheel_rail(self) -> WheelRail:
        """Geometry of wheel and rail; for scenes with [wheel], [rail] and [wheelset] only.

        Raises
        ------
        ValueError
            If these tables or a profile file are missing.
        """
        return WheelRail.from_scene(self)

    @cached_property
    def opposite_wheel(self) -> Scene:
        """Scene of the other wheel of the wheelset, with an equal load, on a separate mesh."""
        assert self.wheelset is not None
        side = "left" if self.wheelset.side == "right" else "right"
        changes = dict.fromkeys(("wear", "rail.passes", "fatigue", "subsurface"))
        elements = None if self.grid is None else self.grid.elements
        grid = {"elements": elements} if elements else None
        return self.without_blocks.replace(**{"wheelset.side": side, **changes, "grid": grid})

    def find_exclusions(self, use: str) -> dict[str, str]:
        """Return why a use of the scene is excluded, by key; empty if it is not.

        Parameters
        ----------
        use : str
            "jacobian", "levels" (`compare_levels`) or "tables" (of creep forces).
        """
        return find_exclusions(vars(self)).get(use, {})

    @property
    def pair(self) -> Conformal | Bodies:
        """Table that makes the patch and the elastic law of both bodies."""
        return self.conformal or self.body

    @property
    def patch(self) -> ContactPatch:
        """Geometry and motion of the undeformed bodies; not those of a wheel on a rail."""
        return self.pair.patch(self)

    @property
    def has_gap(self) -> bool:
        """Whether the undeformed surfaces differ from the radii, so that Hertz does not apply."""
        return any((self.gap, self.wheel, not self.patch.is_flat))

    @property
    def _unequal_turns(self) -> str:
        """Note on bodies that turn unequally often; empty if there is none."""
        revolves = self.wear and self.schedule.revolves and self.wheel is None
        return unequal_turns(self.body, self.wear) if revolves and self.wear else ""

    def _check_blocks(self) -> None:
        """Raise an error with all faults of the blocks, and issue their warnings."""
        with warnings.catch_warnings(record=True) as raised:
            warnings.simplefilter("always")
            faults = [*check_blocks_on_mesh(self, self.blocks)]
        if faults:
            raise SceneError(faults)
        notes = {*scene_notes(self), self._unequal_turns}
        messages = dict.fromkeys(str(warning.message) for warning in raised)
        kinds: dict[str, list[str]] = {}  # notes that differ in numbers alone
        for message in (message for message in messages if message not in notes):
            kinds.setdefault(re.sub(r"[-+.\de]*\d", "0", message), []).append(message)
        for first, *others in kinds.values():
            more = f" ({len(others)} more blocks have such a note)" if others else ""
            warn(f"duty: {first}{more}", PlausibilityWarning)
        for note in cycle_notes(self):
            warn(note, PlausibilityWarning)

    @property
    def blocks(self) -> tuple[Scene, ...]:
        """Scene of each block of [[duty]], in order; without [[duty]] the scene itself."""
        return self._blocks if self.duty else (self,)

    @cached_property
    def _blocks(self) -> tuple[Scene, ...]:
        """Scene of each block of [[duty]], in order; empty without [[duty]]."""
        return block_scenes(self)

    @property
    def without_blocks(self) -> Scene:
        """Copy of the scene without [[duty]] and [load_history]; itself if it has no blocks."""
        return self.replace(duty=None, load_history=None) if self.duty else self

    @cached_property
    def spectrum(self) -> Spectrum | None:
        """Load spectrum (different blocks and their revolutions); None without [[duty]]."""
        return Spectrum.from_blocks(self.duty, self.blocks) if self.duty else None

    @classmethod
    def from_name(cls, name: str) -> Scene:
        """Return a scene from a file, given its path, or a built-in one, given its name.

        Raises
        ------
        SceneError
            If the scene does not exist or is not valid.
        """
        return cls.from_toml(name) if is_path(name) else cls.builtin(name)

    @classmethod
    def tables_from_name(cls, name: str) -> dict[str, Any]:
        """Return the unchecked tables of a scene that `from_name` would return.

        Raises
        ------
        SceneError
            If the scene does not exist or is not TOML.
        """
        if not is_path(name):
            return toml.parse(builtin_text(name))
        return cls.resolve_files(Path(name).absolute().parent, cls.read_tables(name))

    @classmethod
    def from_tables(
        cls, tables: Mapping[str, Any], settings: Iterable[str] = (), without: Iterable[str] = ()
    ) -> Scene:
        """Return the scene of tables, changed by settings that may correct faults of the tables.

        Parameters
        ----------
        tables : mapping
            Nested tables of a scene.
        settings : iterable of str
            See `with_set`.
        without : iterable of str
            Keys to leave out.

        Raises
        ------
        SceneError
            If a setting cannot be read, or if the changed scene is not valid.
        """
        tables = override(tables, dict.fromkeys(without))
        if not settings:
            return cls(**tables)
        try:
            with warnings.catch_warnings():  # the settings may remove the cause of a warning
                warnings.simplefilter("ignore", SceneWarning)
                scene = cls(**tables)
        except SceneError:
            return cls(**override(tables, parse_settings(settings)))
        return scene.with_set(settings)

    @classmethod
    def builtin(cls, name: str) -> Scene:
        """Return a built-in scene, by one of the names of `builtin_names`.

        Raises
        ------
        SceneError
            If no built-in scene has this name.
        """
        return cls.from_toml_text(builtin_text(name))

    def __repr__(self) -> str:
        return text_table("Scene", summarize(self))

    def _repr_html_(self) -> str:
        """Return the summary and the contact ellipse as HTML, for notebooks."""
        return html_table(summarize(self), draw_ellipse(self.hertz))

    def fingerprint(self) -> str:
        """Return a hash of all settings with defaults, except the title and [load_history].

        The title has no influence. A file is represented by its content, wherever it lies. Keys
        without a value do not count, so that a later version with further optional keys returns an
        equal hash.
        """
        settings = self.settings().items()
        counting = {k: value for k, value in settings if k not in ("title", "load_history")}
        text = json.dumps(_canonical(counting), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def inputs(self) -> dict[str, Input]:
        """Files that the scene names, with their content, by dotted key, for example "gap.file"."""
        profiles = {} if self.transient is None else self.transient.profile.by_table
        tables: dict[str, Any] = {"wheel.profile": self.wheel, "rail.profile": self.rail}
        tables |= {f"{name}.file": table for name, table in ({"gap": self.gap} | profiles).items()}
        found: dict[str, Input] = {}
        for key, table in tables.items():
            file = getattr(table, key.rpartition(".")[2], None)
            if isinstance(file, InputPath | InputName) and file.content is not None:
                found[key] = Input(file, file.content, table.reading)
        return found

    def with_current_files(self, fix: bool = False) -> Scene:
        """Return the scene with its files as they are now; itself if they have not changed.

        Parameters
        ----------
        fix : bool
            Whether to fix their content, for a computation of many scenes: if a file changes in
            the meantime, the computation is refused.

        Raises
        ------
        SceneError
            If a file does not exist any more, or if the scene is not valid with a changed file.
        """
        changed = {
            key: str(file)
            for key, (file, content, _) in self.inputs.items()
            if not (content.is_fixed or content.is_stored) and content.changed_files()
        }
        scene = self.replace(**changed) if changed else self
        files = {
            key: type(file).bind(file, replace(content, is_fixed=True))
            for key, (file, content, _) in scene.inputs.items()
            if fix and not (content.is_fixed or content.is_stored)
        }
        return scene.replace(**files) if files else scene

    def replace(self, **changes: Any) -> Scene:
        """Return a new scene with entries changed by dotted key: ``**{"load.normal": 200.0}``.

        Tables may be given as well. A change may remove other keys, see `override`.

        Raises
        ------
        SceneError
            If the new scene is not valid.
        """
        plain = {k: v.entries() if isinstance(v, Table) else v for k, v in changes.items()}
        return type(self)(**override(self.entries(), plain))

    def with_set(self, settings: Iterable[str]) -> Scene:
        """Return a new scene with settings like ``load.normal=200`` or ``friction.mu=[0.4, 0.2]``.

        Raises
        ------
        SceneError
            If a setting cannot be read, or if the new scene is not valid.
        """
        return self.replace(**parse_settings(settings))

    @property
    def materials(self) -> dict[str, Material]:
        """Elastic constants of the bodies "A" and "B"."""
        return self.body.materials

    @property
    def thermal(self) -> dict[str, Thermal]:
        """Thermal properties of the bodies "A" and "B", by default of steel."""
        return {name: getattr(self.body, name).thermal or STEEL for name in "AB"}

    @cached_property
    def steel(self) -> dict[str, Steel]:
        """Residual stress and strength over the depth, by body; only bodies with such a table."""
        return find_steel(self)

    @property
    def material(self) -> CombinedMaterial:
        """Elastic constants of the pair of bodies."""
        return self.body.material

    @property
    def normal_load(self) -> float | None:
        """Normal load, N, or N/mm for a line contact; None if an approach is prescribed."""
        return self.body.normal_load(self.load)

    @property
    def wear_share(self) -> dict[str, float]:
        """Share of each body in the wear depth: from its coefficient, or from its hardness."""
        share = None if self.wear is None else self.wear.share
        return self.body.wear_share if share is None else share

    @property
    def turns(self) -> Turns:
        """Turns of each body in a counted revolution, by which wear and damage add up."""
        if self.wear is not None and self.wear.turns == "equal":
            return Turns.equal(self.wear_share)
        return Turns.from_radii(self.wear_share, self.body.A.radius_x, self.body.B.radius_x)

    @cached_property
    def under_largest_load(self) -> Scene:
        """Steady scene under the largest load of a [transient], from which the mesh follows."""
        return self.schedule.under_largest_load(self)

    @property
    def has_prescribed_force(self) -> tuple[bool, bool]:
        """Whether Q_x and Q_y, respectively, are prescribed instead of creepages."""
        load, courses = self.load, self.schedule.courses
        return (
            load.force_x is not None or "load.force_x" in courses,
            load.force_y is not None or "load.force_y" in courses,
        )

    @property
    def finds_creepage(self) -> bool:
        """Whether the scene or a block prescribes a tangential force instead of a creepage."""
        return any(any(block.has_prescribed_force) for block in self.blocks)

    @property
    def has_fixed_domain(self) -> bool:
        """Whether [grid] sets the half-lengths of the domain; if not, it grows with the contact."""
        return self.grid is not None and self.grid.half_length is not None

    @cached_property
    def schedule(self) -> Schedule:
        """Schedule of the records: their coordinate, its end, and values to store fields at."""
        tables = (self.process, self.transient, self.wear, self.wheelset)
        return next((table.schedule for table in tables if table is not None), Schedule())

    def has(self, key: str) -> bool:
        """Return whether a dotted key exists and its value is not None, False or empty."""
        value: Any = self
        for name in key.split("."):
            value = getattr(value, name, None)
            if value is None or value is False or (isinstance(value, tuple) and not value):
                return False
        return True

    @property
    def line(self) -> bool:
        """Whether this is a line contact: plane strain, forces per length, N/mm.

        Both bodies have ``radius_y = inf``, and there is no [gap] that limits the contact width.
        """
        return self.body.infinitely_long and (self.gap is None or self.gap.profile == "x")

    @property
    def contact_type(self) -> PointContact:
        """Object with the units and motions of a point contact or of a line contact."""
        return LineContact() if self.line else PointContact()

    @property
    def force_unit(self) -> str:
        """Unit of forces: "N", for a line contact "N/mm"."""
        return self.contact_type.unit("N")

    @property
    def hertz(self) -> HertzContact | HertzLine | None:
        """Hertz contact of the radii, without a gap; None if the radii give no closed contact.

        The combined curvature must be positive in x and, except for a line contact, in y.
        """
        if self.body.infinitely_long and not self.line:
            return None
        return self.body.hertz(self.load, self.creepage.speed)

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Let relative file paths in scene tables start from a folder, in place; return them."""
        inner: list[Any] = [tables.get(name) for name in ("residual", "fatigue")]
        over_depth = [
            table.get(body) for table in inner if isinstance(table, dict) for body in "AB"
        ]
        for table in (tables.get("gap"), tables.get("load_history"), *over_depth):
            if isinstance(table, dict) and isinstance(table.get("file"), str):
                table["file"] = str(folder / table["file"])
        bodies = tables.get("body")
        for body in bodies.values() if isinstance(bodies, dict) else ():
            match body:
                case {"profile": str(file)} if file.lower().endswith(TEXTS):
                    body["profile"] = str(folder / file)
                case {"profile": {"file": str(file)}}:
                    body["profile"]["file"] = str(folder / file)
        for name in ("wheel", "rail"):
            match tables.get(name):
                case {"profile": str(profile)} if profile not in BUILTIN:
                    tables[name]["profile"] = str(folder / profile)
        match tables:
            case {"transient": {"profile": dict(profiles)}}:
                for profile in profiles.values():
                    if isinstance(profile, dict) and isinstance(profile.get("file"), str):
                        profile["file"] = str(folder / profile["file"])
        return tables


_HEAD = """\
# Units: mm, N, MPa, degrees, revolutions. x is the rolling direction, y lateral; A is above.
# For another contact, change the values, and remove [grid] and [solver] if the file has them: mesh
# and method then follow from the contact. `tractive-sam explain FILE` describes what is modelled.
"""


def commented_scene(name: str) -> str:
    """Return a built-in scene as TOML text with a comment on every key, and a list of all tables.

    Raises
    ------
    SceneError
        If no built-in scene has this name.
    """
    groups = [group for group in key_groups(Scene) if group.keys]
    meanings = {
        f"{table}.{key.name}".lstrip("."): key.meaning
        for group in groups
        for table in group.names
        for key in group.keys
    }
    lines, table = [], ""
    for line in builtin_text(name).strip().split("\n"):
        table = line.strip("[]") if line.startswith("[") else table
        meaning = meanings.get(f"{table}.{line.split('=')[0].strip()}".lstrip("."))
        lines.append(f"{line:{34}}  # {meaning}" if meaning else line)
    tables = " ".join(group.headings for group in groups if group.headings)
    rest = f"Further keys and tables are listed by `tractive-sam keys [TABLE]`: {tables}"
    comments = textwrap.wrap(rest, 98, break_long_words=False, break_on_hyphens=False)
    return "\n".join([_HEAD, *lines, "", *(f"# {comment}" for comment in comments)]) + "\n"


FILE_KEYS = (
    "gap.file",
    "load_history.file",
    *(f"{table}.{body}.file" for table in ("residual", "fatigue") for body in "AB"),
    *(f"body.{body}.profile.file" for body in "AB"),
    "transient.profile.A.file",
    "transient.profile.B.file",
)
"""Keys of a scene that name a file."""


def resolve_parametric_files(folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
    """Let relative file paths in a study's tables start from a folder, in place; return them."""
    match tables:
        case {"scene": str(name)} if (folder / name).is_file():
            tables["scene"] = str(folder / name)
        case {"scene": dict(scene)}:
            Scene.resolve_files(folder, scene)
    for axis in _axes_with_zipped(tables.get("axis")):
        match axis:
            case {"key": str(key), "values": list() | tuple() as files} if key in FILE_KEYS:
                axis["values"] = [str(folder / str(file)) for file in files]
    return tables


def _axes_with_zipped(axes: Any) -> Iterator[Any]:
    """Yield each axis of a study, followed by the axes zipped with it."""
    for axis in axes if isinstance(axes, list | tuple) else ():
        yield axis
        match axis:
            case {"zip": list() | tuple() as zipped}:
                yield from zipped
