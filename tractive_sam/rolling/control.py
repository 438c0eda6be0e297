"""How far the next step goes: error control, wrapped by the stops that it has to meet.

A step that was refused and one cut short by a stop are two things. After the first, the next one
is shorter; the second says little about the next one, which goes as far as the error allowed
before. What is stepped over may be any coordinate that grows: revolutions, or a distance rolled;
its stops may be what is saved, the end, or the blocks of a duty cycle.
"""

from bisect import bisect_right
from dataclasses import dataclass
from math import ceil, isfinite

SAFETY, SHORTEST_CUT, LONGEST_GROWTH = 0.8, 0.2, 2.0
"""Of error control; with variable steps the two-step formula of `rolling.adaptive` is stable up to
a growth by 2.4."""


@dataclass(frozen=True)
class Trial:
    """A step to try.

    Attributes
    ----------
    length : float
        How far it goes.
    wish : float
        How far error control would go.
    refused : bool
        Whether a longer one was refused; `wish` is then as short as this one.
    """

    length: float
    wish: float
    refused: bool = False


@dataclass(frozen=True)
class ErrorControl:
    """Steps as long as their error allows (Hairer, Norsett & Wanner 1993, section II.4).

    Parameters
    ----------
    order : int
        Power of the length with which the error of a step grows.
    unit : float
        Steps are whole multiples of it.
    """

    order: int
    unit: float = 1

    def shorter(self, step: Trial, error: float) -> Trial:
        """The next try, after one was refused for its error, over the tolerated one."""
        length = self._whole(min(step.length * self._change(error), step.length - self.unit))
        return Trial(length, length, refused=True)

    def next(self, step: Trial, error: float) -> float:
        """The length of the next step, after one was accepted; no longer if it was refused."""
        change = self._change(error)
        return self._whole(step.length * (min(change, 1.0) if step.refused else change))

    def _change(self, error: float) -> float:
        change = SAFETY * max(error, 1e-9) ** (-1.0 / self.order)
        return min(max(change, SHORTEST_CUT), LONGEST_GROWTH)

    def _whole(self, length: float) -> float:
        return max(1, int(length / self.unit)) * self.unit


@dataclass(frozen=True)
class Stops:
    """Error control that meets stops, in shorter steps on the way there.

    Parameters
    ----------
    control : ErrorControl
        What is wrapped.
    stops : tuple of float
        Where to stop, ascending.
    approach : float
        Longest step over the distance to the next stop.
    """

    control: ErrorControl
    stops: tuple[float, ...]
    approach: float = 1.0

    def first(self, here: float, wish: float, settled: float) -> Trial:
        """The first try from a place; steps up to `settled` may go right to a stop."""
        distance = self.stops[bisect_right(self.stops, here)] - here
        unit = self.control.unit
        nearer = max(unit, settled, ceil(self.approach * distance / unit) * unit)
        return Trial(min(wish, distance, nearer), wish)

    def accepts(self, error: float) -> bool:
        """Whether a step of this error, over the tolerated one, is accepted."""
        return error <= 1.0

    def shorter(self, step: Trial, error: float) -> Trial:
        """As of `ErrorControl`."""
        return self.control.shorter(step, error)

    def next(self, step: Trial, error: float) -> float:
        """As of `ErrorControl`; what was cut short for a stop goes on as wished."""
        after = self.control.next(step, error)
        return max(after, step.wish) if step.length < step.wish else after


@dataclass(frozen=True)
class FixedSteps:
    """One step to each stop, whatever its error.

    The steps do not depend on the solution, so that results are smooth functions of the entries of
    a scene: differences give their derivatives.

    Parameters
    ----------
    stops : tuple of float
        Where steps end, ascending.
    """

    stops: tuple[float, ...]

    def first(self, here: float, wish: float, settled: float) -> Trial:
        """Return the step from a place to the next stop."""
        distance = self.stops[bisect_right(self.stops, here)] - here
        return Trial(distance, distance)

    def accepts(self, error: float) -> bool:
        """Whether the step was solved."""
        return isfinite(error)

    def shorter(self, step: Trial, error: float) -> Trial:
        """Return half of a step that was not solved."""
        length = max(1, int(0.5 * step.length))
        return Trial(length, length, refused=True)

    def next(self, step: Trial, error: float) -> float:
        """Return the length of the accepted step, which the next one does not depend on."""
        return step.length
