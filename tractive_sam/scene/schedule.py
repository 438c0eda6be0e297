"""Schedule of a scene: the coordinate, its end, and the values at which fields are stored.

A scene without [wear] is a single contact. [wear] is rolled revolution by revolution, and a
[transient] step by step over a distance, or over a parameter if the bodies only shift.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from .gap import Gap


@dataclass(frozen=True)
class Schedule:
    """Base class of schedules, and schedule of one contact: coordinate, end, stored values.

    Attributes
    ----------
    end : float
        Last value of the coordinate.
    save : tuple of float
        Values of the coordinate at which fields are stored.
    adaptive : bool
        Whether a jump over many revolutions is as long as its error allows.
    fixed : bool
        Whether each jump leads to the next value of `save`.
    courses : mapping of str to tuple of float
        Values at the knots, by the dotted key that changes.
    course_keys : mapping of str to str
        Dotted key of the first course of each of these keys.
    profiles : mapping of str to Gap
        Profiles that are fixed to the bodies and move with them, by the names of their tables.
    own_load : bool
        Whether the load of [load] applies, at least in a stage of a transient.
    shifting : tuple of (float, float)
        First and last value of the coordinate of each stage in which the bodies shift.
    """

    end: float = 0
    save: tuple[float, ...] = (0,)
    adaptive: bool = False
    fixed: bool = False
    courses: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    course_keys: Mapping[str, str] = field(default_factory=dict)
    profiles: Mapping[str, Gap] = field(default_factory=dict)
    own_load: bool = True
    shifting: tuple[tuple[float, float], ...] = ()

    save_key: ClassVar[str] = "wear.save"
    """Key of the scene that lists `save`."""
    end_key: ClassVar[str] = "wear.revolutions"
    """Key of the scene that gives `end`."""
    ends_there: ClassVar[bool] = True
    """Whether the last record is at `end`; otherwise `end` is an upper bound."""
    revolves: ClassVar[bool] = True
    """Whether every record is steady rolling, after a number of revolutions."""
    rolls: ClassVar[bool] = True
    """Whether material rolls through the contact."""
    in_sequence: ClassVar[bool] = True
    """Whether each record follows from the one before."""
    shifts: ClassVar[bool] = False
    """Whether the bodies only shift over each other."""
    message_start: ClassVar[str] = ""
    """Beginning of a message about a record, with its place; empty of the only one."""

    def __contains__(self, place: float) -> bool:
        """Return whether fields are stored at a value of the coordinate."""
        return place in self.save

    @property
    def stops(self) -> tuple[float, ...]:
        """Values of the coordinate at which a step must end, ascending."""
        return tuple(sorted({*self.save, self.end}))

    def rolled(self, places: Any) -> Any:
        """Return the distance rolled, mm, up to values of the coordinate: without the shifts.

        It is the coordinate without the parts in which the bodies shift.
        """
        shifted = (np.clip(places, first, last) - first for first, last in self.shifting)
        return places - sum(shifted)

    def shifts_at(self, place: float) -> bool:
        """Return whether the bodies shift in the step that ends at a value of the coordinate."""
        return self.shifts or any(first < place <= last for first, last in self.shifting)

    def under_largest_load(self, scene: Any) -> Any:
        """Return the scene under its largest load, which sets the mesh: the scene itself."""
        return scene

    @property
    def largest_loads(self) -> dict[str, float]:
        """Largest normal load and approach of the courses, by key, if they are above zero."""
        loads = {
            key: max(self.courses.get(key, (0.0,))) for key in ("load.normal", "load.approach")
        }
        return {key: load for key, load in loads.items() if load > 0.0}


class RevolutionSchedule(Schedule):
    """Schedule of a scene with [wear], over revolutions."""

    message_start = "revolution {}: "


class Distance(Schedule):
    """Schedule of a [transient] that rolls, over the distance in mm."""

    save_key, end_key = "transient.save", "transient.distance"
    revolves = False
    message_start = "after {:g} mm: "

    def under_largest_load(self, scene: Any) -> Any:
        """Return the steady scene, without wear, under the largest load of its courses."""
        scene = scene.replace(transient=None, wear=None)
        candidates = [scene.replace(**{key: load}) for key, load in self.largest_loads.items()]
        if self.own_load or not candidates:
            candidates.append(scene)
        if len(candidates) == 1:
            return candidates[0]
        return max(candidates, key=lambda case: 0.0 if case.hertz is None else case.hertz.load)


class Shifts(Distance):
    """Schedule of a [transient] without rolling, over the parameter of the shifts."""

    rolls, shifts = False, True
    message_start = "after {:g} of the parameter: "

    def rolled(self, places: Any) -> Any:
        """Return zero for each value of the coordinate: the bodies do not roll."""
        return 0.0 * places


class PatchSchedule(Schedule):
    """Schedule over the patches of a wheel on a rail, by increasing load."""

    save_key = end_key = "wheelset"
    revolves = ends_there = in_sequence = False
    message_start = "patch {:g}: "


class NamedSchedule(Schedule):
    """Schedule of a user-defined process, over its coordinate."""

    save_key, end_key = "process.save", "process.end"
    revolves = False
    message_start = "at {:g}: "
