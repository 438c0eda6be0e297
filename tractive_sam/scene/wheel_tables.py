"""The tables [wheel], [rail] and [wheelset]: profiles, and the position of a wheelset."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import lru_cache, partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidatorFunctionWrapHandler, WrapValidator

from tractive_sam.rail import (
    BUILTIN,
    SECTIONS,
    SUFFIXES,
    Profile,
    Rail,
    builtin_profile,
    check_datum,
    place_rail,
    read_profile,
    read_sections,
)
from tractive_sam.schema import Check, Positive, Real, Row, Table, entry, exactly_one, not_both

from .gap import absolute_path, check_exists
from .inputs import InputName, content_of, describe_reading
from .schedule import PatchSchedule, Schedule


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

    def _describe_file(self, profile: str, kind: Literal["wheel", "rail"]) -> Iterator[str]:
        """Yield notes on what the file states and is not used, or on keys without a file."""
        if profile in BUILTIN:
            keys = ("unit", "smoothing", "mirror", "side")
            yield from (
                f"{key} is not used, as {profile} is built in" for key in keys if getattr(self, key)
            )
            return
        with suppress(ValueError):  # reported as a fault of the scene
            yield from self._read(profile, kind).notes

    @property
    def reading(self) -> str:
        """Keys that influence how the file is read, see `FileContent.read`."""
        return describe_reading(self, self.not_read)

    not_read: ClassVar[tuple[str, ...]] = ()
    """Keys without influence on the reading."""

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

    profile: _WheelProfile = entry(
        "wheel profile: S1002, or a file", "S1002, or the path of a file"
    )
    not_read: ClassVar[tuple[str, ...]] = ("profile", "radius", "tape_line")
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
        return profile

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
    not_read: ClassVar[tuple[str, ...]] = ("profile", "inclination", "gauge", "origin", "passes")

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
        return self._read(self.profile, "rail")

    @property
    def notes(self) -> Iterator[str]:
        """Notes on the file."""
        return self._describe_file(self.profile, "rail")

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield a report row with the profile, inclination and gauge of the rail."""
        place = f"gauge {self.gauge:g} mm" if self.origin is None else f"origin {self.origin} mm"
        text = f"{Path(self.profile).name}, 1:{self.inclination:g}, {place}"
        if self.profile not in BUILTIN:
            text += f", gauge side at the {'largest' if self.mirror else 'smallest'} y of the file"
        yield Row("rail", text, brief=True)


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
