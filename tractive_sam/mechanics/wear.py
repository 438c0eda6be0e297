"""Orthotropic Holm-Archard wear."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import wear


@dataclass(frozen=True)
class WearLaw:
    """Depth worn per sliding distance, p_n |s|_i (paper, eq. 16).

    Parameters
    ----------
    intensity : tuple of float
        Wear intensities (i1, i2) along the tribological axes, 1/MPa.
    angle : float
        Angle beta of the first axis, counter-clockwise from x, radians.
    """

    intensity: tuple[float, float]
    angle: float

    def rate(self, pressure: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """Depth worn per distance rolled, dimensionless.

        Parameters
        ----------
        pressure : ndarray, shape (n_x, n_y)
            p_n, MPa.
        slip : ndarray, shape (2, n_x, n_y)
            s/V, dimensionless.
        """
        c, s = np.cos(self.angle), np.sin(self.angle)
        along, across = c * slip[0] + s * slip[1], c * slip[1] - s * slip[0]
        return pressure * np.hypot(self.intensity[0] * along, self.intensity[1] * across)

    def depth(
        self, entering: np.ndarray, pressure: np.ndarray, slip: np.ndarray, dx: float
    ) -> np.ndarray:
        """Depth below every element during one pass (paper, eq. 32), mm.

        Parameters
        ----------
        entering : ndarray, shape (n_y,)
            Depth left by the previous revolution, mm.
        pressure, slip : ndarray
            As for `rate`.
        dx : float
            Side of an element in the rolling direction, mm.
        """
        return wear.sweep(entering, self.rate(pressure, slip), dx)
