"""Length of the next step: error control, wrapped by the stops that it has to reach.

A step that was refused differs from one that was cut short by a stop. After a refusal, the next
step is shorter. A cut says little about the next step, which is as long as the error allowed
before. The coordinate may be revolutions, or a distance rolled; its stops may be points to save,
the end, or the blocks of a duty cycle.
"""

from bisect import bisect_right
from dataclasses import dataclass
from math import ceil, isfinite

SAFETY, SHORTEST_CUT, LONGEST_GROWTH = 0.8, 0.2, 2.0
"""Safety factor and bounds of the change of a step. With variable steps the two-step formula of
`rolling.adaptive` is stable up to a growth by 2.4."""


@dataclass(frozen=True)
class Trial:
    """Length of a step to try, and the length that its error control would allow.

    Attributes
    ----------
    length : float
        Length of the step.
    wish : float
        Length that error control allows without stops.
    refused : bool
        Whether a longer step was refused; `wish` is then the length of this one.
    """

    length: float
    wish: float
    refused: bool = False


@dataclass(frozen=True)
class ErrorControl:
    """Choice of step lengths by an error estimate (Hairer, Norsett & Wanner 1993, II.4).

    Parameters
    ----------
    order : int
        Power of the length with which the error of a step grows.
    unit : float
        Unit of length: steps are integer multiples of it.
    """

    order: int
    unit: float = 1

    def shorter(self, step: Trial, error: float) -> Trial:
        """Return a shorter step to try after a refused one; `error` is over the tolerance."""
        length = self._round(min(step.length * self._change(error), step.length - self.unit))
        return Trial(length, length, refused=True)

    def next(self, step: Trial, error: float) -> float:
        """Return the length of the next step; after a refused one it does not grow."""
        change = self._change(error)
        return self._round(step.length * (min(change, 1.0) if step.refused else change))

    def _change(self, error: float) -> float:
        """Return the factor by which an error changes the step length, within limits."""
        change = SAFETY * max(error, 1e-9) ** (-1.0 / self.order)
        return min(max(change, SHORTEST_CUT), LONGEST_GROWTH)

    def _round(self, length: float) -> float:
        """Return a length rounded down to a multiple of the unit, at least one unit."""
        return max(1, int(length / self.unit)) * self.unit


@dataclass(frozen=True)
class Stops:
    """Error control of steps that must end at stops, for example at coordinates to save.

    Parameters
    ----------
    control : ErrorControl
        Error control of the steps.
    stops : tuple of float
        Places at which a step must end, ascending.
    approach : float
        Longest step over the distance to the next stop.
    """

    control: ErrorControl
    stops: tuple[float, ...]
    approach: float = 1.0

    def first(self, here: float, wish: float, settled: float) -> Trial:
        """Return the first step to try from a coordinate; the next stop limits its length."""
        distance = self.stops[bisect_right(self.stops, here)] - here
        unit = self.control.unit
        nearer = max(unit, settled, ceil(self.approach * distance / unit) * unit)
        return Trial(min(wish, distance, nearer), wish)

    def accepts(self, error: float) -> bool:
        """Return whether a step with this error, over the tolerance, is accepted."""
        return error <= 1.0

    def shorter(self, step: Trial, error: float) -> Trial:
        """Return a shorter step after a refused one, as `ErrorControl.shorter` does."""
        return self.control.shorter(step, error)

    def next(self, step: Trial, error: float) -> float:
        """Return the length of the next step; ending at a stop does not shorten it.

        After a step cut short by a stop, its wish counts again.
        """
        after = self.control.next(step, error)
        return max(after, step.wish) if step.length < step.wish else after


@dataclass(frozen=True)
class FixedSteps:
    """Step control with one step to each stop; it is halved only if it cannot be solved.

    The steps do not depend on the solution, so results are smooth functions of the entries of a
    scene, and finite differences give their derivatives.

    Parameters
    ----------
    stops : tuple of float
        Places at which steps end, ascending.
    """

    stops: tuple[float, ...]

    def first(self, here: float, wish: float, settled: float) -> Trial:
        """Return the step from a coordinate to the next stop."""
        distance = self.stops[bisect_right(self.stops, here)] - here
        return Trial(distance, distance)

    def accepts(self, error: float) -> bool:
        """Return whether the step was solved: its error is finite."""
        return isfinite(error)

    def shorter(self, step: Trial, error: float) -> Trial:
        """Return a refused step of half the length, at least 1; its error is not used."""
        length = max(1, int(0.5 * step.length))
        return Trial(length, length, refused=True)

    def next(self, step: Trial, error: float) -> float:
        """Return the length of the accepted step; it has no effect on the next one."""
        return step.length
