"""Courses of a transient: prescribed quantities over the distance, linear between knots."""

from collections.abc import Mapping
from itertools import pairwise
from math import ceil
from typing import Any

from tractive_sam.scene import Scene
from tractive_sam.schema import required

PARTS = 10
"""Default number of steps of a stretch of shifts."""

CLOSE = 1e-6
"""Part of a step by which a step may be longer, instead of leaving a shorter one."""


class Courses:
    """Loads, creepages, shifts and friction that a [transient] prescribes over the distance.

    Parameters
    ----------
    scene : Scene
        Scene with a [transient].
    """

    def __init__(self, scene: Scene):
        self.scene, self.table = scene, required(scene.transient, "transient")
        self.knots = self.table.distance
        self.rolls = self.table.rolls
        load, creepage = scene.load, scene.creepage
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
        self._courses = self.table.courses
        self._constant = {k: v for k, v in constant.items() if k not in self._courses}
        if "load.normal" in self._courses or "load.approach" in self._courses:
            self._constant |= {
                k: None for k in ("load.normal", "load.approach") if k not in self._courses
            }

    @property
    def stretches(self) -> int:
        """Number of stretches, each between two successive knots (distances of the table)."""
        return len(self.knots) - 1

    def shift_comes_next(self, stretch: int, distance: float) -> bool:
        """Return whether a shift (a step without rolling) begins at this distance."""
        at_end = distance == self.knots[stretch + 1]
        return at_end and stretch + 1 < self.stretches and self.shifted(stretch + 1)

    def at(self, distance: float, stretch: int) -> dict[str, float | None]:
        """Return the prescribed quantities, by scene key, at a distance within a stretch."""
        first, last = self.knots[stretch], self.knots[stretch + 1]
        share = (distance - first) / (last - first) if last > first else 1.0
        values_at = dict(self._constant)
        for key, values in self._courses.items():
            values_at[key] = (1.0 - share) * values[stretch] + share * values[stretch + 1]
        return values_at

    def first(self) -> dict[str, float | None]:
        """Return the prescribed quantities, by scene key, at the start, before any jump there."""
        return self._constant | {key: values[0] for key, values in self._courses.items()}

    def shifted(self, stretch: int) -> bool:
        """Return whether a stretch of length zero is a jump of values that needs a shift step."""
        return self.knots[stretch] == self.knots[stretch + 1] and any(
            values[stretch] != values[stretch + 1]
            for key, values in self._courses.items()
            if not (self.rolls and key.startswith("creepage."))
        )

    def jump(self, stretch: int) -> tuple[float, float, float]:
        """Return the changes of the three shifts (x, y, turn) over a stretch."""
        none = (0.0,) * len(self.knots)
        courses = (self._courses.get(key, none) for key in CREEPAGES)
        x, y, turn = (values[stretch + 1] - values[stretch] for values in courses)
        return x, y, turn

    def friction_factor(self, inputs: Mapping[str, float | None]) -> float:
        """Return the prescribed coefficient of friction over the one of the scene."""
        mu = required(inputs["friction.mu"], "friction.mu")
        return mu / required(self.scene.friction, "friction").mu[0]

    def scene_at(self, inputs: Mapping[str, float | None]) -> Scene:
        """Return the scene of steady rolling with the quantities prescribed at a moment."""
        scene, friction = self.scene, required(self.scene.friction, "friction")
        factor = self.friction_factor(inputs)
        changes: dict[str, Any] = {"transient": None, "wear": None}
        for key in friction.entries().keys() & {"mu", "static", "kinetic"}:
            changes[f"friction.{key}"] = tuple(factor * mu for mu in getattr(friction, key))
        for key in ("load.normal", "load.approach"):
            if key in self._courses:
                changes[key] = inputs[key]
        for force, creepage in (("force_x", "longitudinal"), ("force_y", "lateral")):
            forced = inputs[f"load.{force}"] is not None
            key = f"load.{force}" if forced else f"creepage.{creepage}"
            changes[key] = inputs[key]
        changes["creepage.spin"] = inputs["creepage.spin"]
        return scene.replace(**changes)


CREEPAGES = ("creepage.longitudinal", "creepage.lateral", "creepage.spin")


def expected_steps(scene: Scene, dx: float) -> int:
    """Return the (approximate) number of records for elements of the length dx, mm."""
    courses, count = Courses(scene), 1
    for stretch, (first, end) in enumerate(pairwise(courses.knots)):
        if first == end:
            count += courses.shifted(stretch)
            continue
        step = courses.table.step or (dx if courses.rolls else (end - first) / PARTS)
        count += ceil((end - first) / step - CLOSE)
        saved = ((s - first) / step for s in courses.table.save if first < s < end)
        count += sum(abs(place - round(place)) > CLOSE for place in saved)  # between two steps
    return count
