"""The tables [wheel], [rail] and [wheelset], and the patches that follow for the other tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidatorFunctionWrapHandler, WrapValidator

from tractive_sam.mechanics import Material, combine
from tractive_sam.rail import (
    BUILTIN,
    SECTIONS,
    SUFFIXES,
    ContactLocus,
    NoContactError,
    Patch,
    Profile,
    Rail,
    Wheel,
    builtin_profile,
    check_datum,
    find_locus,
    find_patches,
    free_roll,
    place_rail,
    read_profile,
    read_sections,
)
from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    Positive,
    Real,
    Row,
    SceneError,
    Table,
    ValidEntries,
    entry,
    exactly_one,
    not_both,
    optional,
    to_python,
)

from .inputs import (
    InputName,
    absolute_path,
    check_exists,
    content_of,
    describe_reading,
    may_be_missing,
)
from .schedule import PatchSchedule, Schedule
from .tables import Creepage


def _check_profile(
    value: Any, check_text: ValidatorFunctionWrapHandler, built_in: tuple[str, ...]
) -> str:
    """Return a built-in name, or the path of an existing profile file with its content."""
    if isinstance(value, InputName):
        return value
    name: str = check_text(str(value) if isinstance(value, Path) else value)
    if name in built_in:
        return name
    listed = " or ".join(built_in)
    if Path(name).suffix.lower() not in SUFFIXES:
        raise ValueError(f"{listed}, or a file ending in {', '.join(SUFFIXES)}")
    path = str(absolute_path(Path(name), SUFFIXES))
    content = content_of(path)
    if content is None:
        check_exists(Path(path), f"{listed}, or ")
    return InputName.bind(path, content)


_Unit = Literal["mm", "m", "in", "cm", "um"]
_WheelProfile = Annotated[str, WrapValidator(partial(_check_profile, built_in=("S1002",)))]
_RailProfile = Annotated[
    str, WrapValidator(partial(_check_profile, built_in=("60E1", "UIC60-manchester")))
]
_FreeOrReal = Literal["free"] | Real
_Pitch = Literal["free", "rolling-radius"] | Real


class Grinding(Table):
    """Material removed from a profile between two positions, by a sum of splines.

    A design finds a profile by these factors, for example of the gauge corner of a rail.

    Examples
    --------
    >>> corner = ts.Grinding(start=-34.0, end=-5.0, depths=(0.1, 0.3, 0.1))
    >>> ts.RailTable(profile="60E1", ground=corner).ground.depths[1]
    0.3
    """

    start: Real = entry("lateral position in the frame of the profile, mm, outward positive")
    end: Real = entry("lateral position at which it ends, mm")
    depths: tuple[Real, ...] = entry(
        "factors of equal cubic B-splines side by side: depths normal to the profile, mm",
        "a list of numbers; negative ones add material",
        min_length=1,
    )


class _ProfileTable(Table):
    """Base class of [wheel] and [rail]: unit and smoothing of a profile file, and its reading."""

    unit: _Unit | None = entry(
        "unit of the profile file; by default, the unit in the file, or mm", default=None
    )
    smoothing: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] | None = entry(
        "rms distance of a smoothing spline from the points of the file, mm; 0 interpolates them. "
        "By default they are smoothed only if they scatter by their last printed digit",
        "a number of at least 0",
        default=None,
    )
    mirror: bool = entry(
        "whether y of the file runs the other way: for a rail, towards the track centre",
        "true or false",
        default=False,
    )
    side: Literal["left", "right"] | None = entry(
        "side that is read from a file with y and z of a left and a right side", default=None
    )
    ground: InnerTable[Grinding | None] = optional("material removed from the profile")

    reading_keys: ClassVar[tuple[str, ...]] = ("unit", "smoothing", "mirror", "side")

    def _describe_file(self, profile: str, kind: Literal["wheel", "rail"]) -> Iterator[str]:
        """Yield notes on what the file states and is not used, or on keys without a file."""
        if profile in BUILTIN:
            for key in self.reading_keys:
                if getattr(self, key):
                    yield f"{key} is not used, as {profile} is built in"
            return
        with suppress(ValueError):  # reported as a fault of the scene
            yield from self._read(profile, kind).notes

    @property
    def reading(self) -> str:
        """Keys that influence how the file is read, see `FileContent.read`."""
        return describe_reading(self, type(self).model_fields.keys() - self.reading_keys)

    def _read(self, profile: str, kind: Literal["wheel", "rail"]) -> Any:
        """Return a built-in profile, or the profile or sections in a file."""
        if profile in BUILTIN:
            return builtin_profile(profile)

        def read(kind: Any, path: str | Path) -> Profile:
            numbers, mirror, side = (self.unit, self.smoothing), self.mirror, self.side
            return read_profile(path, kind, *numbers, mirror=mirror, side=side)

        def read_file() -> Any:
            if profile.lower().endswith(SECTIONS):
                return read_sections(profile, partial(read, "section"))
            return read(kind, profile)

        content = getattr(profile, "content", None)
        return read_file() if content is None else content.read(self.reading, read_file)


class WheelTable(_ProfileTable):
    """Table [wheel]: body A is a wheel with this profile and radius.

    Examples
    --------
    >>> ts.WheelTable(profile="S1002", radius=460.0).radius
    460.0
    """

    excludes: ClassVar[dict[str, str]] = {
        "gap": "profiles give the separation",
        "wear.turns": "rail.passes is the key of worn profiles",
        "transient": "it is not available for wheels",
        "process": "it is not available for wheels",
        "accuracy": "use a study over grid.elements",
        "load_history": "use a study, or [[duty]]",
    }
    profile: _WheelProfile = entry(
        "wheel profile: S1002, or a file", "S1002, or the path of a file"
    )
    radius: Positive = entry("radius at the tread datum (tape line), mm", default=460.0)
    tape_line: Positive = entry(
        "distance of the tread datum, the origin of the profile, from the back of the wheel, mm",
        default=70.0,
    )

    @property
    def curve(self) -> Profile:
        """Profile of the wheel as a curve.

        Raises
        ------
        ValueError
            If the file cannot be used, or its origin is not the tread datum.
        """
        profile = self._read(self.profile, "wheel")
        check_datum(profile, self.tape_line)
        return _grind(profile, self.ground, 1.0)

    @property
    def notes(self) -> Iterator[str]:
        """Notes on the file and its tread datum."""
        yield from self._describe_file(self.profile, "wheel")
        with suppress(ValueError):
            profile = self._read(self.profile, "wheel")
            if note := check_datum(profile, self.tape_line, self.radius):
                yield note

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield a report row with the profile and the radius of the wheel."""
        line = f", tape line {self.tape_line:g} mm from the back" * (self.tape_line != 70.0)
        text = f"{Path(self.profile).name}, radius {self.radius:g} mm{line}"
        text += _describe_ground(self.ground)
        yield Row("wheel", text, brief=True)


class RailTable(_ProfileTable):
    """Table [rail]: body B is a rail with this profile, inclination and gauge.

    Examples
    --------
    >>> ts.RailTable(profile="60E1").inclination
    40.0
    """

    profile: _RailProfile = entry(
        "rail profile: 60E1, UIC60-manchester, or a file; a file ending in .slcs lists sections",
        "'60E1' (in quotes: 60E1 is a number), UIC60-manchester, or the path of a file",
    )
    inclination: Annotated[float, Field(ge=5.0)] = entry(
        "inclination towards the track centre; 40 means 1:40, and inf means none",
        "a number of at least 5, or inf",
        40.0,
    )
    gauge: Positive = entry("distance between the gauge faces, mm", default=1435.0)
    origin: tuple[Real, Real] | None = entry(
        "y and z of the origin of the profile's file in the track, mm, in place of the gauge",
        default=None,
    )
    passes: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] | None = entry(
        "number of wheels that pass a cross-section of the rail per revolution of the wheel, "
        "for [wear]; the default is 1",
        "a number of at least 0",
        default=None,
    )
    checks: ClassVar[tuple[Check, ...]] = (not_both("origin", "gauge"),)

    @property
    def curve(self) -> Any:
        """Profile or sections of the right rail in the track frame, with inclination and gauge."""
        return _placed(self.unplaced_curve, self.inclination, self.gauge, self.origin)

    @property
    def has_sections(self) -> bool:
        """Whether the section of the rail varies along the track."""
        return self.profile.lower().endswith(SECTIONS)

    @property
    def passes_per_revolution(self) -> float:
        """Passes of wheels over a point of the rail per revolution of the wheel, by default 1."""
        return 1.0 if self.passes is None else self.passes

    @property
    def unplaced_curve(self) -> Any:
        """Profile or sections of the rail in the frame of the file, without its placement."""
        return _grind(self._read(self.profile, "rail"), self.ground, -1.0)

    @property
    def notes(self) -> Iterator[str]:
        """Notes on the file."""
        return self._describe_file(self.profile, "rail")

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield a report row with the profile, inclination and gauge of the rail."""
        place = f"gauge {self.gauge:g} mm" if self.origin is None else f"origin {self.origin} mm"
        text = f"{Path(self.profile).name}, 1:{self.inclination:g}, {place}"
        text += _describe_ground(self.ground)
        if self.profile not in BUILTIN:
            text += f", gauge side at the {'largest' if self.mirror else 'smallest'} y of the file"
        yield Row("rail", text, brief=True)


@lru_cache(maxsize=32)
def _grind(profile: Profile, ground: Grinding | None, outward: float) -> Profile:
    """Return a profile without what is removed, if anything; `outward` as in `Profile.worn`."""
    if ground is None:
        return profile
    if not isinstance(profile, Profile):
        raise ValueError("ground: a file of sections; allowed: one profile")
    return profile.ground(ground.start, ground.end, ground.depths, outward)


def _describe_ground(ground: Any) -> str:
    """Describe what is removed from a profile; "" for nothing."""
    if ground is None:
        return ""
    largest = max(ground.depths, key=abs)
    return f", ground from y = {ground.start:g} to {ground.end:g} mm by up to about {largest:g} mm"


@lru_cache(maxsize=32)
def _placed(
    rail: Rail, inclination: float, gauge: float, origin: tuple[float, float] | None
) -> Rail:
    """Return the right rail in the track frame, at the gauge or with its origin at (y, z)."""
    if origin is None:
        return place_rail(rail, inclination, gauge)
    return rail.moved(-math.atan(1.0 / inclination), origin)


_PITCHES: Mapping[Any, str] = {
    "free": "found with the contacts: the axle of both wheels, equally loaded, has no moment",
    "rolling-radius": "from the mean rolling radius of both wheels; a moment may drive the axle",
}


class WheelsetTable(Table):
    """Position of the wheelset on the track, and load of the wheel.

    Examples
    --------
    >>> ts.WheelsetTable(y=3.5, yaw=8.4, load=1e4).roll
    'free'
    """

    inner: Positive = entry("distance of the wheel backs, mm; 70 to 80 below gauge", default=1360.0)
    x: Real = entry("position along the track, mm, if the rail has sections", default=0.0)
    y: Real = entry("lateral position, mm, positive to the right", default=0.0)
    yaw: Real = entry("yaw angle, mrad, clockwise from above", default=0.0, ge=-100, le=100)
    roll: _FreeOrReal = entry(
        'roll angle, mrad, positive if the right wheel is lower; with "free", both wheels rest '
        "on the rails",
        '"free" or a number',
        "free",
    )
    side: Literal["right", "left"] = entry("wheel that is computed", default="right")
    pitch: _Pitch = entry(
        'ratio of the angular velocity of the wheelset to V / radius, minus 1; with "free", no '
        "moment drives or brakes the axle: the moments of both wheels, with equal loads, add up to "
        'zero; with "rolling-radius", the wheelset rolls on the mean rolling radius of both wheels',
        '"free", "rolling-radius" or a number',
        "free",
    )
    slope: Real = entry(
        "slope of the path of the axle along the track, positive downwards", default=0.0
    )
    load: Positive | None = entry("vertical force on this wheel, N", default=None)
    normal_load: Positive | None = entry("sum of the normal forces of the patches, N", default=None)
    checks: ClassVar[tuple[Check, ...]] = (exactly_one("load", "normal_load"),)
    max_patches: ClassVar[int] = 8
    """Largest number of patches with stored fields."""

    @property
    def schedule(self) -> Schedule:
        """Schedule over the contact patches, as many as there may be."""
        return PatchSchedule(self.max_patches, tuple(range(1, self.max_patches + 1)))

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: position and load of the wheelset, angle and radius of each patch."""
        contact = scene.wheel_rail
        load = f"{self.load:g} N vertical" if self.load else f"{self.normal_load:g} N normal"
        along = f"x = {self.x:g} mm, " if scene.rail.has_sections else ""
        place = (
            f"{along}y = {self.y:g} mm, yaw {self.yaw:g} mrad, roll {1e3 * contact.roll:.4g} mrad"
        )
        yield Row("wheelset", f"{place}, {self.side} wheel, {load}", brief=True)
        pitch = _PITCHES.get(self.pitch, f"{self.pitch}, given")
        if not contact.is_motion(scene.creepage):
            pitch = "not used: [creepage] replaces the creepages due to the motion of the wheelset"
        yield Row("pitch", pitch)
        for patch in contact.patches:
            angle = f"angle {math.degrees(patch.angle):.2f} deg"
            text = f"{angle}, rolling radius {patch.rolling_radius:.2f} mm"
            # Not numbered: records have the number by the load, which is not solved here.
            yield Row(f"patch at y = {patch.origin[1]:.2f} mm", text, brief=True)


TABLES: Mapping[str, type[Table]] = {
    "wheel": WheelTable,
    "rail": RailTable,
    "wheelset": WheelsetTable,
}


@dataclass(frozen=True)
class WheelRail:
    """Wheel placed on a rail: both profiles, the motion, and the contact patches.

    Attributes
    ----------
    wheel, rail : Wheel and Rail
        The wheel that is computed, as a right one, and the right rail in the track frame.
    roll, pitch : float
        Roll of the wheelset, rad; its angular velocity over V / radius, minus 1. A free pitch
        depends on the contacts: this one, from the rolling radii, is near it.
    patches : tuple of Patch
        All patches, the one with most load first.
    opposite : WheelRail or None
        The other wheel with an equal load, if the pitch depends on it.
    """

    wheel: Wheel
    rail: Rail
    roll: float
    pitch: float
    patches: tuple[Patch, ...]
    opposite: WheelRail | None = None

    @classmethod
    def from_tables(
        cls, wheel: WheelTable, rail: RailTable, wheelset: WheelsetTable, e_star: float
    ) -> WheelRail:
        """Place the wheel of three tables on the rail, and find its contact patches.

        Raises
        ------
        ValueError
            If a profile cannot be used, or the wheel does not rest on the rail.
        """
        return _find(wheel.curve, wheel, rail.curve, wheelset, e_star)

    @classmethod
    def from_scene(cls, scene: Any) -> WheelRail:
        """Place the wheel of a scene on its rail, and find its contact patches."""
        if scene.wheelset is None:
            raise ValueError("the scene has no [wheel], [rail] and [wheelset]")
        return cls.from_tables(scene.wheel, scene.rail, scene.wheelset, scene.material.E_star)

    @classmethod
    def of_profiles(cls, scene: Any, wheel: Profile, rail: Any) -> WheelRail:
        """Place other profiles at the wheelset position of a scene, and find their patches.

        Parameters
        ----------
        scene : Scene
            Scene with [wheel], [rail] and [wheelset].
        wheel, rail : Profile
            Wheel, and rail in the track frame.
        """
        return _find(wheel, scene.wheel, rail, scene.wheelset, scene.material.E_star)

    @property
    def equivalent_radii(self) -> tuple[float, float]:
        """Radii R_x, R_y, mm, of an ellipsoid on a plane that stands for the first patch."""
        first = self.patches[0]
        long, wide = first.half_length
        return first.radius_x, first.radius_x * (wide / long) ** 2

    @property
    def creepages(self) -> tuple[float, float, float]:
        """Longitudinal and lateral creepage and spin (1/mm) of the first patch."""
        return self.patches[0].creepages(self.pitch)

    def is_motion(self, creepage: Creepage) -> bool:
        """Return whether creepages equal the creepages of the wheelset's motion."""
        return tuple(getattr(creepage, key) for key in _MOTIONS) == self.creepages


@lru_cache(maxsize=256)
def _find(
    profile: Profile, table: WheelTable, rail: Rail, wheelset: WheelsetTable, e_star: float
) -> WheelRail:
    """Place a wheel on a rail, and find its patches under the load; results are cached."""
    if rail.steepest and any(isinstance(value, str) for value in (wheelset.roll, wheelset.pitch)):
        raise ValueError("with sections of the rail, roll and pitch are numbers")
    rail = rail.seen_from(wheelset.x)
    radius, yaw = table.radius, 1e-3 * wheelset.yaw
    placed = Wheel(
        *(profile, radius, wheelset.inner, wheelset.y, yaw),
        slope=wheelset.slope,
        tape_line=table.tape_line,
    )
    free = wheelset.roll == "free"
    roll = free_roll(placed, rail) if free else 1e-3 * float(wheelset.roll)
    placed = replace(placed, roll=roll)
    load = wheelset.load or wheelset.normal_load or 0.0
    sides = (placed, placed.mirrored())[:: -1 if wheelset.side == "left" else 1]
    patches = find_patches(sides[0], rail, load, e_star)
    if isinstance(wheelset.pitch, str):
        others = find_patches(sides[1], rail, load, e_star)
        # Loaded patches may lie some millimetres beside the first touch.
        pitch = 2.0 * radius / (patches[0].rolling_radius + others[0].rolling_radius) - 1.0
        opposite = WheelRail(others[0].wheel, rail, roll, pitch, tuple(others))
    else:
        pitch, opposite = wheelset.pitch, None
    return WheelRail(patches[0].wheel, rail, roll, pitch, tuple(patches), opposite)


def unworn_profiles(scene: Any, *sizes: int) -> tuple[Profile, Profile]:
    """Return new wheel and rail, in their own frames, with the nodes at which wear is recorded.

    The nodes are those of the profiles, and further ones between them: a twelfth of the half width
    of the narrowest patch apart, but between 0.02 and 0.1 mm.

    Parameters
    ----------
    scene : Scene
        Scene with [wheel], [rail] and [wheelset].
    *sizes : int
        Numbers of nodes of both profiles. Histories of earlier versions have no further nodes.
    """
    read = scene.wheel.curve, scene.rail.unplaced_curve
    if sizes == tuple(profile.s.size for profile in read):
        return read
    width = min(local.wheel_rail.patches[0].half_length[1] for local in scene.blocks)
    # A contact is narrower than the overlap by the square root of 2.
    spacing = min(max(width / math.sqrt(2.0) / 12.0, 0.02), 0.1)
    return read[0].refined(spacing), read[1].refined(spacing)


def contact_locus(scene: Any, positions: Any) -> ContactLocus:
    """Return the contact points of wheel and rail over lateral positions of the wheelset.

    Parameters
    ----------
    scene : Scene
        Profiles, yaw and roll; its lateral position and its load have no influence.
    positions : sequence of float
        Lateral positions, mm.

    Raises
    ------
    ValueError
        If the scene has no wheel, or a position no contact.

    Examples
    --------
    >>> locus = ts.contact_locus(ts.Scene.builtin("wheel-rail"), [-1.0, 0.0, 1.0])
    >>> locus.radius.shape  # two jumps between the three positions add their sides
    (2, 7)
    """
    if scene.wheelset is None or scene.rail.has_sections:
        raise ValueError("contact_locus: a scene with [wheelset], and one rail profile, is needed")
    scene = scene.with_current_files()
    wheelset = scene.wheelset
    table, yaw = scene.wheel, 1e-3 * wheelset.yaw
    wheel = Wheel(table.curve, table.radius, wheelset.inner, yaw=yaw, tape_line=table.tape_line)
    roll = None if scene.wheelset.roll == "free" else 1e-3 * scene.wheelset.roll
    return find_locus(wheel, scene.rail.curve, positions, roll)


def add_wheel_contact(tables: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """Return tables with radii, load and creepages from the wheel contact, unless they are set.

    The bodies get the radii of the ellipsoid on a plane that overlaps like the first patch: units
    and mesh follow from its Hertz contact. Keys that are given stay, and are checked later.
    """
    if all(tables.get(name) is None for name in TABLES):
        return tables
    body = {name: dict(_plain(_plain(tables.get("body")).get(name))) for name in "AB"}
    contact = _try_contact(tables, body)
    radius_x, radius_y = (1.0, 1.0) if contact is None else contact.equivalent_radii
    for name, radii in (("A", (radius_x, math.inf)), ("B", (math.inf, radius_y))):
        body[name] = dict(zip(("radius_x", "radius_y"), radii, strict=True)) | body[name]
    changed = {**tables, "body": {**_plain(tables.get("body")), **body}}
    wheelset = _plain(tables.get("wheelset"))
    load = to_python(wheelset.get("load") or wheelset.get("normal_load"))
    usable = isinstance(load, int | float) and load > 0.0
    given = _plain(tables.get("load"))
    has_normal = not given.keys().isdisjoint({"normal", "approach", "pressure"})
    normal = {} if has_normal else {"normal": float(load) if usable else 1.0}
    changed["load"] = {**given, **normal}  # a given table is a fault, with one message
    creepage = _plain(tables.get("creepage"))
    prescribed = set(_MOTIONS) & set(creepage) or given
    if contact is not None and not prescribed:
        changed["creepage"] = {**creepage, **dict(zip(_MOTIONS, contact.creepages, strict=True))}
    return changed


_MOTIONS = ("longitudinal", "lateral", "spin")


def _plain(table: Any) -> Mapping[Any, Any]:
    """Return a table in any form as a mapping; empty for other values."""
    if isinstance(table, Table):
        return table.entries()
    return table if isinstance(table, Mapping) else {}


def _try_contact(tables: Mapping[Any, Any], body: Mapping[str, Any]) -> WheelRail | None:
    """Return the wheel-rail geometry of tables; None if they are not valid."""
    try:
        wheel, rail, wheelset = (kind(**_plain(tables.get(name))) for name, kind in TABLES.items())
        pair = []
        for name in "AB":
            material = body[name]
            kind = Material.from_young if "young" in material else Material
            first = material.get("young", material.get("shear"))
            pair.append(kind(float(first), float(material["poisson"])))
        assert isinstance(wheel, WheelTable)
        assert isinstance(rail, RailTable)
        assert isinstance(wheelset, WheelsetTable)
        return WheelRail.from_tables(wheel, rail, wheelset, combine(*pair).E_star)
    except (SceneError, RuntimeError, ValueError, TypeError, KeyError, ZeroDivisionError):
        return None


def _check_wheel_is_complete(entries: ValidEntries) -> Iterator[Fault]:
    """Report missing tables among [wheel], [rail], [wheelset], and blocks without wear."""
    names = [name for name in TABLES if name in entries.given]
    if not names:
        return
    for name in TABLES:
        if name not in names:
            yield Fault(name, "nothing", f"a [{name}] table: [{names[0]}] is given")
    if entries["duty"] and entries["wear"] is None:
        cure = "a [wear] table, or a study over the positions: only their wear adds up"
        yield Fault("duty", "with [wheel] and without [wear]", cure)


def _check_wear_of_profiles(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys that only wear of profiles uses, and tables that it excludes."""
    wears, wheel = entries["wear"] is not None, entries["wheel"] is not None
    if "wear.step_depth" in entries.given and not wheel:
        yield Fault(
            "wear.step_depth", "without [wheel]", "nothing: only profiles wear in such steps"
        )
    if "rail.passes" in entries.given and not wears:
        yield Fault("rail.passes", "without [wear]", "nothing, or a [wear] table")
    if not (wears and wheel):
        return
    for name in ("subsurface", "fatigue"):
        if entries[name] is not None:
            cure = f"no [{name}] together with [wear]: leave [wear] out, for new or worn profiles"
            yield Fault(name, "with [wheel] and [wear]", cure)


def _check_sections(entries: ValidEntries) -> Iterator[Fault]:
    """Report keys and tables that need a rail with one profile, or a rail with sections."""
    rail, wheelset = entries["rail"], entries["wheelset"]
    if rail is None or wheelset is None:
        return
    if not rail.has_sections:
        if "wheelset.x" in entries.given:
            cure = "nothing, or a file of sections as rail.profile"
            yield Fault("wheelset.x", "with a rail of one profile", cure)
        return
    for key in ("roll", "pitch"):
        if isinstance(value := getattr(wheelset, key), str):
            cure = "a number: the other rail, which determines it, is not known"
            yield Fault(f"wheelset.{key}", f"{value}, with sections of the rail", cure)
    if entries["wear"] is not None:
        yield Fault("wear", "with sections of the rail", "no [wear], or a rail of one profile")


def _check_wheel_contact(entries: ValidEntries) -> Iterator[Fault]:
    """Report a wheel that cannot rest on its rail, and entries that follow from its contact."""
    if entries["wheelset"] is None or entries["wheel"] is None or entries["rail"] is None:
        return
    wheel, rail, wheelset = (entries[name] for name in TABLES)
    faults = [*_profile_faults(wheel=wheel, rail=rail)]
    if faults or [*_check_sections(entries)]:
        yield from faults if not may_be_missing() else ()
        return
    try:
        contact = WheelRail.from_tables(wheel, rail, wheelset, entries["body"].material.E_star)
    except (NoContactError, RuntimeError) as error:  # the roll may not converge without contact
        given = f"y = {wheelset.y:g}, inner = {wheelset.inner:g}, rail.gauge = {rail.gauge:g} mm"
        yield Fault("wheelset", f"{given}; {error}", _describe_possible_place(entries))
        return
    friction, y = entries["friction"], contact.rail.section(0.0).points[:, 0]
    if friction is not None and friction.across is not None:
        places = [place for place, _ in friction.across]
        if places[-1] < y.min() or places[0] > y.max():
            cure = f"places on the rail in the track, {y.min():.0f} to {y.max():.0f} mm"
            yield Fault("friction.across", f"y from {places[0]:g} to {places[-1]:g} mm", cure)
    radii = contact.equivalent_radii
    expected = {"A": (radii[0], math.inf), "B": (math.inf, radii[1])}
    for name, pair in expected.items():
        body = getattr(entries["body"], name)
        for axis, radius in zip("xy", pair, strict=True):
            if not math.isclose(getattr(body, f"radius_{axis}"), radius, rel_tol=1e-9):
                key = f"body.{name}.radius_{axis}"
                yield Fault(key, f"{getattr(body, f'radius_{axis}'):g}", "nothing with [wheel]")
    load = entries["load"]
    if load.normal != (wheelset.load or wheelset.normal_load) or load.force_x or load.force_y:
        yield Fault("load", "with [wheelset]", "no [load], but wheelset.load or normal_load")


def _describe_possible_place(entries: ValidEntries, halvings: int = 5) -> str:
    """Return text that suggests a lateral position at which the wheel rests on the rail."""
    wheel, rail, wheelset = (entries[name] for name in TABLES)
    text = "a place in which the tread or the face of the flange rests on the rail"
    for y in (*(wheelset.y / 2**k for k in range(1, halvings + 1)), 0.0):
        nearer = wheelset.model_copy(update={"y": y})
        with suppress(NoContactError, RuntimeError):
            WheelRail.from_tables(wheel, rail, nearer, entries["body"].material.E_star)
            return f"{text}, for example y = {y:g} mm"
    return f"{text}; with this inner, gauge and yaw not even y = 0 is one"


def _profile_faults(**tables: Any) -> Iterator[Fault]:
    """Yield a fault for each profile that cannot be used."""
    for name, table in tables.items():
        try:
            _ = table.curve
        except ValueError as error:
            yield Fault(f"{name}.profile", Path(table.profile).name, str(error))


WHEEL_CHECKS: tuple[Check, ...] = (
    _check_wheel_is_complete,
    _check_wear_of_profiles,
    _check_sections,
    _check_wheel_contact,
)
"""Checks between [wheel], [rail], [wheelset] and the other tables."""


def without_wheel_contact(entries: dict[str, Any], contact: WheelRail) -> dict[str, Any]:
    """Return a scene's entries without the radii, load and creepages from its wheel contact."""
    body = {
        name: {k: v for k, v in table.items() if not k.startswith("radius_")}
        for name, table in entries["body"].items()
    }
    creepage = dict(entries.get("creepage", {}))
    if tuple(creepage.get(key) for key in _MOTIONS) == contact.creepages:
        creepage = {key: value for key, value in creepage.items() if key not in _MOTIONS}
    unchanged = {key: value for key, value in entries.items() if key not in ("load", "creepage")}
    return {**unchanged, "body": body, **({"creepage": creepage} if creepage else {})}
