"""The scene: all that is asked of a computation."""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from tractive_sam.mechanics import CombinedMaterial, HertzContact, HertzLine, Material, Turns
from tractive_sam.schema import (
    Check,
    Document,
    PlausibilityWarning,
    SceneError,
    Table,
    entry,
    keywords_only,
    warn,
)

from . import describe
from .bodies import Bodies
from .catalogue import builtin_text, names_file
from .checks import SCENE_CHECKS, warn_if_large, warn_if_unequal
from .contact_type import LineContact, PointContact
from .duty import Block, Spectrum, block_scenes, off_the_mesh
from .fatigue import Fatigue
from .friction import Friction
from .gap import Gap
from .heat import STEEL, Heat, Thermal
from .load_history import DOUBTFUL, LoadHistory, with_blocks
from .override import override, parse_settings
from .plausibility import scene_notes
from .process import ProcessTable
from .resolution import warn_if_coarse
from .schedule import Schedule, schedule_of
from .tables import (
    Accuracy,
    Creepage,
    ElasticBodies,
    Load,
    Mesh,
    Solver,
    Subsurface,
)
from .transient import Transient
from .wear import Wear


class Scene(Document):
    """Two bodies, what presses and moves them, and what is to be computed.

    Built from keywords, from TOML, or from a built-in scene; immutable. Tables may be given as
    objects or as dictionaries.

    Raises
    ------
    SceneError
        With every fault of the scene.

    Warns
    -----
    SceneWarning
        If the grid is too coarse for the contact, the contact large against the radii, bodies that
        wear come round unequally often without ``wear.turns = "each"``, or an entry looks as if it
        was meant in another unit, or forgotten.

    Examples
    --------
    >>> lighter = scene.replace(**{"load.normal": 0.2, "friction.mu": 0.3})
    >>> round(lighter.hertz.a / scene.hertz.a, 3)
    0.752
    """

    title: str = entry("title", "a text", "")
    body: Bodies = entry("the two bodies")
    load: Load = entry("the load")
    creepage: Creepage = entry("the creepages", default=Creepage())
    elasticity: ElasticBodies | None = entry("the elastic law of the bodies", default=None)
    friction: Friction | None = entry("the friction law", default=None)
    wear: Wear | None = entry("the wear law", default=None)
    grid: Mesh | None = entry("the grid", default=None)
    accuracy: Accuracy | None = entry("the accuracy that chooses the grid", default=None)
    gap: Gap | None = entry("the additional separation", default=None)
    heat: Heat | None = entry("the flash temperature", default=None)
    subsurface: Subsurface | None = entry("the subsurface stress", default=None)
    fatigue: Fatigue | None = entry("the fatigue of the material", default=None)
    transient: Transient | None = entry("what changes over the distance rolled", default=None)
    process: ProcessTable | None = entry("a process of another package", default=None)
    duty: tuple[Block, ...] = entry(
        "blocks of a duty cycle", "at least one block, [[duty]]", (), min_length=1
    )
    load_history: LoadHistory | None = entry("the load history of the blocks", default=None)
    solver: Solver = entry("the solver", default=Solver())
    checks: ClassVar[tuple[Check, ...]] = SCENE_CHECKS
    internal: ClassVar[frozenset[str]] = frozenset(
        (
            *("alone", "bounded", "contact_type", "finds_creepage", "forced", "has"),
            *("heaviest", "named", "schedule", "spectrum"),
        )
    )

    @keywords_only
    def __init__(self, /, **tables: Any) -> None:
        super().__init__(**tables)
        if self.duty:
            self._check_blocks()
        for note in scene_notes(self):
            warn(note, PlausibilityWarning)
        if self.wear and self.schedule.revolves:
            warn_if_unequal(self.body, self.wear)
        if self.gap:  # the Hertz ellipse is not the contact
            return
        warn_if_large(self.body, self.hertz)
        if self.grid:
            warn_if_coarse(self.grid, self.hertz)

    @classmethod
    def unfold(cls, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """With the blocks of a load history."""
        return with_blocks(given)

    def _check_blocks(self) -> None:
        """Raise the faults of the blocks, and tell what is doubtful of them alone."""
        with warnings.catch_warnings(record=True) as notes:
            warnings.simplefilter("always")
            faults = [*off_the_mesh(self, self.blocks)]
        if faults:
            raise SceneError(faults)
        own = set(scene_notes(self))
        for told in dict.fromkeys(str(note.message) for note in notes):
            if told not in own and not told.startswith("wear"):
                warn(f"duty: {told}", PlausibilityWarning)
        cycle, revolutions = self.spectrum.cycle, self.wear.revolutions
        if revolutions % cycle:
            told = f"duty: the last of {revolutions} / {cycle} cycles is not whole"
            warn(told, PlausibilityWarning)
        if self.load_history and (self.load_history.work_error or 0.0) > DOUBTFUL:
            off = f"the mean of load x creepage by {self.load_history.work_error:.1%}"
            told = f"load_history: its levels change {off}; raise load_history.levels"
            warn(told, PlausibilityWarning)

    @property
    def blocks(self) -> tuple[Scene, ...]:
        """The scene of each block of [[duty]], in order; of a scene without, itself."""
        return self._blocks if self.duty else (self,)

    @cached_property
    def _blocks(self) -> tuple[Scene, ...]:
        return block_scenes(self)

    @property
    def alone(self) -> Scene:
        """Itself without [[duty]]."""
        return self.replace(duty=None, load_history=None) if self.duty else self

    @cached_property
    def spectrum(self) -> Spectrum | None:
        """Its different blocks; None without [[duty]]."""
        return Spectrum.of(self.duty, self.blocks) if self.duty else None

    @classmethod
    def named(cls, name: str) -> Scene:
        """Read a scene file, or build a built-in scene: what a command or a study is given.

        Raises
        ------
        SceneError
            If there is none, or if it is not valid.
        """
        return cls.from_toml(name) if names_file(name) else cls.builtin(name)

    @classmethod
    def builtin(cls, name: str) -> Scene:
        """Build a built-in scene, one of `builtin_names`.

        Raises
        ------
        SceneError
            If there is none of this name.
        """
        return cls.from_toml_text(builtin_text(name))

    def __repr__(self) -> str:
        return describe.format_summary(self)

    def _repr_html_(self) -> str:
        return describe.draw_summary(self)

    def fingerprint(self) -> str:
        """Hash of all that is asked, defaults included: the same for the same scene.

        The title does not count, and of a gap file its name.
        """
        settings = self.settings()
        settings.pop("title")
        settings.pop("load_history", None)
        text = json.dumps(_canonical(settings), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def replace(self, **changes: Any) -> Scene:
        """Return a new scene with entries changed by dotted key: ``**{"load.normal": 200.0}``.

        Whole tables may be given, too. See `override` for what else follows from a change.

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
        """What the bodies "A" and "B" conduct heat by: steel's where nothing is given."""
        return {name: getattr(self.body, name).thermal or STEEL for name in "AB"}

    @property
    def material(self) -> CombinedMaterial:
        """Elastic constants of the pair of bodies."""
        return self.body.material

    @property
    def normal_load(self) -> float | None:
        """Normal load, N, or N/mm of a line contact; None where the approach is given."""
        return self.body.normal_load(self.load)

    @property
    def wear_share(self) -> dict[str, float]:
        """Share of each body in the depth worn: by its own coefficient, or by hardness."""
        own = None if self.wear is None else self.wear.share
        return self.body.wear_share if own is None else own

    @property
    def turns(self) -> Turns:
        """How often each body comes round in a revolution that [wear] and [fatigue] count."""
        if self.wear is not None and self.wear.turns == "equal":
            return Turns.equal(self.wear_share)
        return Turns.of(self.wear_share, self.body.A.radius_x, self.body.B.radius_x)

    @property
    def heaviest(self) -> Scene:
        """The scene under the largest load of a [transient]: it tells the size of the contact."""
        return self.schedule.heaviest(self)

    @property
    def forced(self) -> tuple[bool, bool]:
        """Which of the tangential forces (Q_x, Q_y) are prescribed, in place of creepages."""
        courses = self.schedule.courses
        return tuple(
            getattr(self.load, key) is not None or f"load.{key}" in courses
            for key in ("force_x", "force_y")
        )

    @property
    def finds_creepage(self) -> bool:
        """Whether a tangential force is prescribed in any block, whose creepage is found."""
        return any(any(block.forced) for block in self.blocks)

    @property
    def bounded(self) -> bool:
        """Whether [grid] gives the domain; else it is chosen, and grows with the contact."""
        return self.grid is not None and self.grid.half_length is not None

    @cached_property
    def schedule(self) -> Schedule:
        """Along which coordinate it is solved, to which end, and where fields are stored."""
        return schedule_of(self)

    def has(self, key: str) -> bool:
        """Whether a table or entry of a dotted key is given, or a property of it holds."""
        value: Any = self
        for name in key.split("."):
            value = getattr(value, name, None)
            if value is None or value is False or (isinstance(value, tuple) and not value):
                return False
        return True

    @property
    def line(self) -> bool:
        """Whether it is a line contact: plane strain, forces per length, N/mm.

        So it is where both bodies have ``radius_y = inf`` and no [gap] gives the contact a width.
        """
        return self.body.infinitely_long and self.gap is None

    @property
    def contact_type(self) -> PointContact:
        """Units, motions and constants of a point or a line contact."""
        return LineContact() if self.line else PointContact()

    @property
    def force_unit(self) -> str:
        """Unit of forces: "N", of a line contact "N/mm"."""
        return self.contact_type.unit("N")

    @property
    def hertz(self) -> HertzContact | HertzLine | None:
        """The Hertz contact of the radii, without any gap; None unless they close.

        They have to close in x and y, but for a line contact.
        """
        if self.body.infinitely_long and self.gap is not None:
            return None
        return self.body.hertz(self.load)

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """The tables, with relative files in them sought from a folder."""
        for name in ("gap", "load_history"):
            match tables.get(name):
                case {"file": str(file)}:
                    tables[name]["file"] = str(folder / file)
        match tables:
            case {"transient": {"profile": dict(profiles)}}:
                for one in profiles.values():
                    if isinstance(one, dict) and isinstance(one.get("file"), str):
                        one["file"] = str(folder / one["file"])
        return tables


def _canonical(value: Any) -> Any:
    """What equal settings have in common, as JSON knows it."""
    match value:
        case dict():
            return {key: _canonical(item) for key, item in value.items()}
        case list() | tuple():
            return [_canonical(item) for item in value]
        case np.ndarray():
            return [value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
        case float():
            return value + 0.0  # no negative zero
        case bool() | int():
            return value
    return str(value)
