"""Orthotropic friction and the frame in which it is isotropic."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Frame:
    """The scaled tribological frame of orthotropic friction.

    Parameters
    ----------
    mu : tuple of float
        Friction coefficients (mu1, mu2) along the tribological axes.
    angle : float
        Angle beta of the first axis, counter-clockwise from x, radians.
    """

    mu: tuple[float, float] = (1.0, 1.0)
    angle: float = 0.0

    @cached_property
    def matrix(self) -> np.ndarray:
        """F = M R: slip into the frame, s~ = F s; traction out of it, p_t = F^T p~."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.diag(self.mu) @ np.array([[c, s], [-s, c]])

    def to_scaled(self, traction: np.ndarray) -> np.ndarray:
        """p~ = F^-T p_t for a field of shape (2, ...)."""
        return np.tensordot(np.linalg.inv(self.matrix).T, traction, axes=1)

    def to_physical(self, scaled: np.ndarray) -> np.ndarray:
        """p_t = F^T p~ for a field of shape (2, ...)."""
        return np.tensordot(self.matrix.T, scaled, axes=1)

    def slip_to_scaled(self, slip: np.ndarray) -> np.ndarray:
        """s~ = F s for a field of shape (2, ...)."""
        return np.tensordot(self.matrix, slip, axes=1)

    @property
    def weights(self) -> tuple[float, float]:
        """(max mu / mu)² of both axes: what squares of unscaled tractions have less of."""
        return tuple((max(self.mu) / mu) ** 2 for mu in self.mu)

    def slip_to_physical(self, scaled: np.ndarray) -> np.ndarray:
        """s = F^-1 s~ for a field of shape (2, ...)."""
        return np.tensordot(np.linalg.inv(self.matrix), scaled, axes=1)
