"""When a scene is solved: along which coordinate, to which end, and where fields are stored.

A scene without [wear] is one contact. [wear] is rolled revolution by revolution, and a [transient]
step by step over a distance, or over a parameter where the bodies only shift.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from .gap import Gap

if TYPE_CHECKING:
    from .scene import Scene
    from .transient import Transient


@dataclass(frozen=True)
class Schedule:
    """The schedule of one contact of unworn bodies, and what all schedules have in common.

    Attributes
    ----------
    end : float
        Last value of the coordinate.
    save : tuple of float
        Its values at which fields are stored.
    adaptive : bool
        Whether jumps over many revolutions are as long as their error allows.
    courses : mapping of str to tuple of float
        What changes, by dotted keys: values at the knots.
    profiles : mapping of str to Gap
        Those that are fixed to the bodies and travel with them, by the names of their tables.
    """

    end: float = 0
    save: tuple[float, ...] = (0,)
    adaptive: bool = False
    courses: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    profiles: Mapping[str, Gap] = field(default_factory=dict)

    save_key: ClassVar[str] = "wear.save"
    """Key of the scene that lists `save`."""
    end_key: ClassVar[str] = "wear.revolutions"
    """Key of the scene that gives `end`."""
    revolves: ClassVar[bool] = True
    """Whether every record is steady rolling, after a number of revolutions."""
    rolls: ClassVar[bool] = True
    """Whether material rolls through the contact."""
    shifts: ClassVar[bool] = False
    """Whether the bodies only shift over each other."""
    message_start: ClassVar[str] = ""
    """Beginning of a message about a record, with its place; empty of the only one."""

    def __contains__(self, place: float) -> bool:
        """Whether fields are stored there."""
        return place in self.save

    @property
    def stops(self) -> tuple[float, ...]:
        """Values of the coordinate at which a step has to end, ascending."""
        return tuple(sorted({*self.save, self.end}))

    def heaviest(self, scene: Scene) -> Scene:
        """Return the scene under its largest load, which gives the size of the contact."""
        return scene


class Revolutions(Schedule):
    """The schedule of a scene with [wear]."""

    message_start = "revolution {}: "


class Distance(Schedule):
    """The schedule of a [transient] that rolls."""

    save_key, end_key = "transient.save", "transient.distance"
    revolves = False
    message_start = "after {:g} mm: "

    def heaviest(self, scene: Scene) -> Scene:
        """See `Schedule.heaviest`."""
        loads = {key: max(self.courses.get(key, (0.0,))) for key in _LOADS}
        heavy = {key: value for key, value in loads.items() if value > 0.0}
        return scene.replace(transient=None, wear=None, **heavy)


_LOADS = ("load.normal", "load.approach")


class Shifts(Distance):
    """The schedule of a [transient] whose bodies shift, over a parameter."""

    rolls, shifts = False, True
    message_start = "after {:g} of the parameter: "


class NamedSchedule(Schedule):
    """The schedule of a process of another package."""

    save_key, end_key = "process.save", "process.end"
    revolves = False
    message_start = "at {:g}: "


def schedule_of(scene: Scene) -> Schedule:
    """Return the schedule that the tables of a scene ask for."""
    if scene.process is not None:
        return NamedSchedule(scene.process.end, scene.process.save)
    if scene.transient is not None:
        return _of_transient(scene.transient)
    if scene.wear is not None:
        wear = scene.wear
        return Revolutions(wear.revolutions, wear.save, wear.stepping == "adaptive")
    return Schedule()


def _of_transient(table: Transient) -> Schedule:
    kind = Distance if table.rolls else Shifts
    profiles = table.profile.given
    return kind(table.distance[-1], table.save, courses=table.courses, profiles=profiles)
