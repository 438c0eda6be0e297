"""Courses of a transient: prescribed quantities over the distance, linear between knots."""

from collections.abc import Mapping
from itertools import pairwise
from math import ceil
from typing import Any, ClassVar

from tractive_sam.scene import Scene, Stage
from tractive_sam.schema import required

PARTS = 10
"""Default number of steps of a stretch of shifts."""

CLOSE = 1e-6
"""Part of a step by which a step may be longer, instead of leaving a shorter one."""


class Courses:
    """Loads, creepages, shifts and friction that a [transient] prescribes over the distance.

    The knots of all stages form one list. The stretch between two stages has no length.

    Parameters
    ----------
    scene : Scene
        Scene with a [transient].
    """

    creepages: ClassVar = ("creepage.longitudinal", "creepage.lateral", "creepage.spin")
    """Keys of the creepages, or of the shifts."""

    def __init__(self, scene: Scene):
        self.scene, self.table = scene, required(scene.transient, "transient")
        self.knots = self.table.knots
        self._place = [(stage, k) for stage in self.table.stages for k in stage.knot_range]
        self._at_knots: dict[int, dict[str, Any]] = {}

    @property
    def stretches(self) -> int:
        """Number of stretches, each between two successive knots of all stages."""
        return len(self.knots) - 1

    def stage(self, stretch: int) -> Stage:
        """Return the stage of a stretch; a stretch between two stages belongs to the later one."""
        return self._place[stretch + 1][0]

    def rolls(self, stretch: int) -> bool:
        """Return whether the bodies roll in a stretch between two knots; otherwise they shift."""
        return self.stage(stretch).rolls

    def time(self, length: float, stretch: int) -> float:
        """Return the time, s, of a part of the parameter of a shift; 0 if shifts take none."""
        stage = self.stage(stretch)
        return (stage.duration or 0.0) * length / (stage.distance[-1] - stage.distance[0])

    def rolled_to(self, stretch: int) -> bool:
        """Return whether bodies roll into the end of a stretch of knots (-1: the first knot)."""
        return self.rolls(stretch) or (stretch < 0 and self.table.start == "steady")

    def shift_comes_next(self, stretch: int, distance: float) -> bool:
        """Return whether a stretch ends at this distance and a shift without rolling follows."""
        at_end = distance == self.knots[stretch + 1]
        return at_end and stretch + 1 < self.stretches and self.shifted(stretch + 1)

    def at(self, distance: float, stretch: int) -> dict[str, float | None]:
        """Return the prescribed quantities, by scene key, at a distance between two knots."""
        first, last = self.knots[stretch], self.knots[stretch + 1]
        end = self._at_knot(stretch + 1)
        if last == first:
            return end
        share, begin = (distance - first) / (last - first), self._at_knot(stretch)
        return {
            key: value if value == begin[key] else (1.0 - share) * begin[key] + share * value
            for key, value in end.items()
        }

    @property
    def first_shift(self) -> tuple[float, float, float]:
        """Shifts in x and y, mm, and turn, radians, at the first knot; zero if the bodies roll."""
        return (0.0, 0.0, 0.0) if self.rolls(-1) else creepages_of(self.first())

    @property
    def shifts_from_steady(self) -> bool:
        """Whether bodies in steady rolling are shifted, or loads jump, at the first knot."""
        steady = self._constant(self.table.stages[0])
        changed = (
            value not in (None, steady[key])
            for key, value in self.first().items()
            if key not in self.creepages
        )
        return not self.rolls(-1) and (any(self.first_shift) or any(changed))

    def first(self) -> dict[str, float | None]:
        """Return the prescribed quantities, by scene key, at the start, before any jump there."""
        return self._at_knot(0)

    def _at_knot(self, knot: int) -> dict[str, Any]:
        """Return the prescribed quantities, by scene key, at a knot of the list of all stages."""
        if knot not in self._at_knots:
            stage, k = self._place[knot]
            self._at_knots[knot] = stage.values_at(k, self._constant(stage))
        return self._at_knots[knot]

    def _constant(self, stage: Stage) -> dict[str, float | None]:
        """Return loads, creepages and friction of the scene, by key; shifts of a stage are zero."""
        scene, load, creepage = self.scene, self.scene.load, self.scene.creepage
        constant = {
            "load.normal": scene.normal_load,
            "load.approach": load.approach,
            "load.force_x": load.force_x,
            "load.force_y": load.force_y,
            "creepage.longitudinal": creepage.longitudinal,
            "creepage.lateral": creepage.lateral,
            "creepage.spin": creepage.spin,
            "friction.mu": required(scene.friction, "friction").mu[0],
        }
        shifts_in_list = self.table.stage and not stage.rolls
        return constant | dict.fromkeys(self.creepages, 0.0) if shifts_in_list else constant

    def shifted(self, stretch: int) -> bool:
        """Return whether a stretch without length is a jump of values, which needs a shift step."""
        if self.knots[stretch] != self.knots[stretch + 1]:
            return False
        before, after = self._at_knot(stretch), self._at_knot(stretch + 1)
        return any(self.jump(stretch)) or any(
            value not in (None, before[key])
            for key, value in after.items()
            if key not in self.creepages
        )

    def jump(self, stretch: int) -> tuple[float, float, float]:
        """Return the changes of the shifts (x, y, turn) between two knots; zero if bodies roll."""
        if self.rolls(stretch):
            return 0.0, 0.0, 0.0
        (before, _), (after, _) = self._place[stretch : stretch + 2]
        first, last = self._at_knot(stretch), self._at_knot(stretch + 1)
        if before is not after:  # a shift counts from the start of its course
            continued = frozenset() if before.rolls else before.courses.keys()
            first = first | {key: 0.0 for key in self.creepages if key not in continued}
        x, y, turn = (
            late - early
            for early, late in zip(creepages_of(first), creepages_of(last), strict=True)
        )
        return x, y, turn

    def friction_factor(self, inputs: Mapping[str, float | None]) -> float:
        """Return the prescribed coefficient of friction over the one of the scene."""
        mu = required(inputs["friction.mu"], "friction.mu")
        return mu / required(self.scene.friction, "friction").mu[0]

    def steady_scene(self) -> Scene:
        """Return the scene of the steady rolling that precedes the first knot."""
        scene, friction = self.scene, required(self.scene.friction, "friction")
        changes: dict[str, Any] = {"transient": None, "wear": None}
        if not self.rolls(-1):  # the courses are of shifts
            return scene.replace(**changes)
        inputs, courses = self.first(), self.table.stages[0].courses
        factor = self.friction_factor(inputs)
        for key in friction.entries().keys() & {"mu", "static", "kinetic"}:
            changes[f"friction.{key}"] = tuple(factor * mu for mu in getattr(friction, key))
        for key in ("load.normal", "load.approach"):
            if key in courses:
                changes[key] = inputs[key]
        for force, creepage in Stage.forced:
            forced = inputs[f"load.{force}"] is not None
            key = f"load.{force}" if forced else f"creepage.{creepage}"
            changes[key] = inputs[key]
        changes["creepage.spin"] = inputs["creepage.spin"]
        return scene.replace(**changes)


def creepages_of(inputs: Mapping[str, float | None]) -> tuple[float, float, float]:
    """Return the three creepages, or shifts, among prescribed quantities (longitudinal first)."""
    longitudinal, lateral, spin = (required(inputs[key], key) for key in Courses.creepages)
    return longitudinal, lateral, spin


def expected_steps(scene: Scene, dx: float) -> int:
    """Return the (approximate) number of records for elements of the length dx, mm."""
    courses, count = Courses(scene), 1
    for stretch, (first, end) in enumerate(pairwise(courses.knots)):
        if first == end:
            count += courses.shifted(stretch)
            continue
        step = courses.stage(stretch).step or (
            dx if courses.rolls(stretch) else (end - first) / PARTS
        )
        count += ceil((end - first) / step - CLOSE)
        saved = ((s - first) / step for s in courses.table.save if first < s < end)
        count += sum(abs(place - round(place)) > CLOSE for place in saved)  # between two steps
    return count
