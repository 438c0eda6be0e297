"""The scaled tribological frame, in which orthotropic friction is isotropic.

Friction coefficients mu1, mu2 belong to the tribological axes e1, e2, which are turned by an angle
counter-clockwise from x, y. With F = M R, M = diag(mu1, mu2) and R the rotation, tractions and slip
become p~ = F^-T p_t and s~ = F s. Their work does not change, p~ . s~ = p_t . s, and the ellipse of
tractions that friction allows becomes a disc.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Frame:
    """The scaled tribological frame: axes in which orthotropic friction is isotropic.

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
        """F = M R: slip into the frame, s~ = F s; traction out of the frame, p_t = F^T p~."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.diag(self.mu) @ np.array([[c, s], [-s, c]])

    @cached_property
    def inverse(self) -> np.ndarray:
        """F^-1 = R^T M^-1 (2, 2): slip out of the frame, s = F^-1 s~."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, -s], [s, c]]) / np.asarray(self.mu)

    @property
    def weights(self) -> tuple[float, float]:
        """(max mu / mu)² of both axes: squares of scaled over squares of unscaled tractions."""
        first, second = ((max(self.mu) / mu) ** 2 for mu in self.mu)
        return first, second

    def largest_by(self, change: np.ndarray) -> float:
        """Return the derivative of log max(mu1, mu2) along a change (d mu1, d mu2).

        For equal coefficients it is half of the one-sided derivative by each, as for central
        differences.

        Parameters
        ----------
        change : ndarray, shape (2,)
            Change of both coefficients.
        """
        largest = np.equal(self.mu, max(self.mu))
        return float(largest @ change / (largest.sum() * max(self.mu)))

    def to_scaled(self, traction: np.ndarray) -> np.ndarray:
        """Return tractions (2, ...) in the scaled frame, p~ = F^-T p_t."""
        return _times(self.inverse.T, traction)

    def to_physical(self, scaled: np.ndarray) -> np.ndarray:
        """Return tractions (2, ...) in x and y from the scaled frame, p_t = F^T p~."""
        return _times(self.matrix.T, scaled)

    def slip_to_scaled(self, slip: np.ndarray) -> np.ndarray:
        """Return slip (2, ...) in the scaled frame, in which friction is isotropic, s~ = F s."""
        return _times(self.matrix, slip)

    def slip_to_physical(self, scaled: np.ndarray) -> np.ndarray:
        """Return slip (2, ...) in x and y from the scaled frame, s = F^-1 s~."""
        return _times(self.inverse, scaled)

    def norm(self, traction: np.ndarray) -> np.ndarray:
        """Return ||p_t||_mu = |p~|: the least pressure at which friction carries a traction.

        The elliptic norm sqrt((p_e1/mu1)² + (p_e2/mu2)²) (paper, eq. 10); shape (2, ...) to (...).
        """
        return np.hypot(*self.to_scaled(traction))

    def dual_norm(self, direction: np.ndarray) -> np.ndarray:
        """Return |F d|, the largest component along d of a traction with ||p_t||_mu = 1.

        For a slip it is ||s||* = sqrt((mu1 s_e1)² + (mu2 s_e2)²), the work of friction on it.
        """
        return np.hypot(*self.slip_to_scaled(direction))


def _times(matrix: np.ndarray, field: np.ndarray) -> np.ndarray:
    """Return a matrix (2, 2) times the vectors of a field (2, ...)."""
    field = np.asarray(field)
    return (matrix @ field.reshape(2, -1)).reshape(field.shape)
