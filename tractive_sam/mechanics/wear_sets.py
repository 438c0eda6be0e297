"""Published coefficients of wear: rates over frictional work, and coefficients of regimes.

Each set has its source, the published units, and the range of the tests. Scenes name these sets;
`mechanics.wear` contains the laws that use them.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Regimes:
    """A wear rate, piecewise linear in the frictional work; a call returns rates and slopes.

    Attributes
    ----------
    starts, values, slopes : tuple of float
        Start of each regime, ascending from 0, the rate at the start, and the slope.
    tested : float
        Upper end of the tested range; inf if unknown.
    source : str
        Source of the numbers.

    Examples
    --------
    >>> from tractive_sam.mechanics import USFD
    >>> USFD["r8t-uic60"].at(50.0)
    55.0
    """

    starts: tuple[float, ...]
    values: tuple[float, ...]
    slopes: tuple[float, ...]
    tested: float = np.inf
    source: str = ""

    @classmethod
    def through(cls, points: tuple[tuple[float, float], ...]) -> "Regimes":
        """Return the piecewise linear rate through the origin and points (work, rate)."""
        work, rate = np.array(points, float).T
        if work[0] > 0.0:
            work, rate = np.append(0.0, work), np.append(0.0, rate)
        slopes = np.diff(rate) / np.diff(work)
        starts, values = work[:-1], rate[:-1]
        return cls(
            tuple(starts.tolist()), tuple(values.tolist()), tuple(slopes.tolist()), float(work[-1])
        )

    def at(self, work: float) -> float:
        """Return the wear rate at one value of the frictional work."""
        return float(self(np.array([float(work)]))[0][0])

    def __call__(self, work: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return rate and slope: values_k + slopes_k (W - starts_k), k the last with starts_k <= W.

        Returns
        -------
        rate, slope : ndarray
            Both of the shape of `work`.
        """
        starts, values, slopes = map(np.array, (self.starts, self.values, self.slopes))
        k = np.maximum(np.searchsorted(starts, work, side="right") - 1, 0)
        return values[k] + slopes[k] * (work - starts[k]), slopes[k]


USFD = {
    "r8t-uic60": Regimes(
        (0.0, 10.4, 77.2),
        (0.0, 55.0, 55.0),
        (5.3, 0.0, 61.9),
        120.0,
        "Braghin, Lewis, Dwyer-Joyce & Bruni 2006, Wear 261, 1253-1264: wheel R8T on rail UIC60 "
        "900A, twin discs",
    )
}
"""Worn mass of a wheel per rolling distance and area, µg/(m mm²), over T-gamma/A, N/mm². The tests
(Lewis & Dwyer-Joyce 2004, Proc. IMechE J 218, 467-478) cover up to 20 % slip at 1500 MPa; the
published 728 W of heat are 120 N/mm² there."""

BRR = {
    "pearce-sherratt": Regimes(
        (0.0, 100.0, 200.0),
        (0.0, 25.0, 84.0),
        (0.25, 0.0, 1.19),
        np.inf,
        "Pearce & Sherratt 1991, Wear 144, 343-351: wheel on rail, British Rail Research",
    )
}
"""Worn cross section of a wheel per rolling distance, times its diameter D, mm² mm/km, over
T-gamma, N: 0.25 T-gamma below 100 N, 25 up to 200 N, 1.19 T-gamma - 154 above, with a jump from 25
to 84. Values as commonly quoted; not compared with the paper."""

JENDEL = {
    name: (k, "Jendel 2002, Wear 253, 89-99: wheel on rail, dry; the range of each regime " + place)
    for name, k, place in (
        ("middle", (5.5e-4, 35e-4, 5.5e-4, 350e-4), "in its middle"),
        ("low", (1e-4, 30e-4, 1e-4, 300e-4), "at its lower end"),
        ("high", (10e-4, 40e-4, 10e-4, 400e-4), "at its upper end"),
    )
}
"""Coefficients k of Archard's law, V = k P s/H: slow, between both speeds, fast, high pressure.
Published as ranges: 1-10, 30-40, 1-10 and 300-400, times 1e-4. Values as commonly quoted; not
compared with the paper."""

JENDEL_BORDERS, JENDEL_LIMIT = (200.0, 700.0), 0.8
"""Sliding speeds between the regimes, mm/s, and the pressure over hardness above which the last
regime holds."""
