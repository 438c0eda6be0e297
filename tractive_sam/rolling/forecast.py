"""Estimate the remaining contacts of a roll from the steps already rolled."""

from bisect import bisect_right
from math import ceil, inf, sqrt
from typing import ClassVar

import numpy as np

from tractive_sam.rolling.adaptive import SETTLING
from tractive_sam.rolling.control import LONGEST_GROWTH
from tractive_sam.scene import Scene


class Forecast:
    """Forecast of the remaining steps and time of a roll, updated record by record.

    Jumps grow with the revolutions rolled, and shorten before every stop: they are predicted one by
    one, by the rule of `rolling.control`.

    Parameters
    ----------
    scene : Scene
        Scene that is rolled.

    Attributes
    ----------
    done, left : float
        Contacts solved, and contacts to solve.
    end : float
        Coordinate of the end.
    """

    growth: ClassVar[float] = 0.4
    """Exponent of the growth of jumps with the revolutions rolled, once wear shapes the contact."""

    unhindered: ClassVar[float] = 0.5
    """Jump over the revolutions rolled above which only its own growth or a stop limits it."""

    shaped: ClassVar[float] = 0.02
    """Wear depth over the approach of the bodies above which wear shapes the contact: jumps of
    spheres and twin discs stop doubling at .0145 to .018 (runs of tests/rolling/test_forecast.py).
    """

    recent: ClassVar[int] = 20
    """Number of records with times per contact that are used for the remaining ones."""

    longest: ClassVar[int] = 100_000
    """Steps that are predicted one by one; further steps have the length of the last one."""

    def __init__(self, scene: Scene) -> None:
        schedule = scene.schedule
        self._stops, self.end = schedule.stops, schedule.end
        self._adaptive = schedule.adaptive
        self._wish, self._spent = 0.0, list[tuple[float, float]]()
        self._here, self._step = 0.0, 1.0
        # Longest step that may reach a stop directly: until a step was cut, the last one that wear
        # did not limit, as both depend on the time in which waves of the profile decay.
        self._settled, self._unhindered = 0.0, 1.0
        self.done = self.left = 0.0

    def add(
        self, place: float, jump: float, solves: float, seconds: float, worn: float = 0.0
    ) -> None:
        """Update the forecast by a record: its coordinate, next jump, contact solves and seconds.

        `worn` is its wear depth over the approach of the bodies.
        """
        if self._adaptive and self._wish and place > self._here:
            self._learn(place - self._here, self._distance_to_stop(self._here), self._wish)
        step = place - self._here
        self._step = step if step > 0.0 else self._step
        before, self._here, self._wish = self._wish, place, jump
        self._spent = [*self._spent[1 - self.recent :], (solves, seconds)]
        self.done += solves
        steps = (self.end - place) / self._step
        if self._adaptive:
            steps = self._count_steps(jump, before or jump, worn)
        self.left = steps * float(np.mean([solves for solves, _ in self._spent]))

    @property
    def remaining_seconds(self) -> float:
        """Return the estimated remaining time, s, from the last records; 0 without records."""
        if not self._spent:
            return 0.0
        first = 1 if 1 < len(self._spent) < self.recent else 0
        solves, seconds = map(sum, zip(*self._spent[first:], strict=True))
        return self.left * seconds / solves if solves else 0.0

    def _learn(self, step: float, distance: float, wish: float) -> None:
        """Adjust, by a step taken, the longest step that may end directly at a stop."""
        nearer, longest = ceil(SETTLING * distance), min(wish, distance)
        if nearer < step < longest:
            self._settled = step
        elif step == nearer < longest:
            self._settled = min(self._settled or self._unhindered, step)
        elif step > nearer and self._settled:
            self._settled = max(self._settled, step)

    def _distance_to_stop(self, here: float) -> float:
        """Return the distance from a coordinate to the next stop of the schedule after it."""
        return self._stops[bisect_right(self._stops, here)] - here

    def _count_steps(self, jump: float, before: float, worn: float) -> float:
        """Return the predicted number of remaining steps, from the last two proposed jumps."""
        here, shaped, count = self._here, self._here, 0
        wish = sqrt(jump * before)
        if worn < self.shaped and jump >= self.unhindered * here:
            wish, shaped = jump, max(here, 1.0) * self.shaped / worn if worn > 0.0 else inf
            self._unhindered = jump * shaped / max(here, 1.0)
        settled = self._settled or self._unhindered
        while here < self.end:
            distance = self._distance_to_stop(here)
            nearer = ceil(SETTLING * distance)
            step = max(1.0, min(wish, distance, max(settled, nearer)))
            if count == self.longest:
                return count + (self.end - here) / step
            grown = (here + step) / max(here, 1.0)
            here += step
            wish *= LONGEST_GROWTH if here < shaped else grown**self.growth
            count += 1
        return count
