"""The scaled tribological frame, in which orthotropic friction is isotropic.

Friction coefficients mu1, mu2 belong to the tribological axes e1, e2, which are turned by an angle
counter-clockwise from x, y. With F = M R, M = diag(mu1, mu2) and R the rotation, tractions and slip
become p~ = F^-T p_t and s~ = F s. Their work does not change, p~ . s~ = p_t . s, and the ellipse of
tractions that friction allows becomes a disc. Angles in radians.
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

    @cached_property
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


Pair = tuple[float, float]


def full_slip_force(load: float, mu: Pair, angle: float, slip: Pair) -> Pair:
    """Return the friction force (Q_x, Q_y) on body A, N, if the complete contact slips one way.

    The associated sliding rule Q = -P M² s / ||s||* with ||s||* = |M s| in tribological axes.
    Source: Juliá & Rodríguez-Tembleque, Int. J. Mech. Sci. 294 (2025) 110195, eqs. (10), (15).
    For slip along x its size is P sqrt(mu1² cos² angle + mu2² sin² angle) in x, which is also the
    largest Q_x that friction can carry at any Q_y.

    Parameters
    ----------
    load : float
        Normal load P, N.
    mu : (float, float)
        Friction coefficients mu1, mu2.
    angle : float
        Angle from x to e1, radians.
    slip : (float, float)
        Slip (s_x, s_y) of A over B; only its direction counts.

    Returns
    -------
    (float, float)
        Q_x, Q_y, N.

    Raises
    ------
    ValueError
        If the slip is zero: its direction is unknown.

    Examples
    --------
    >>> Q_x, Q_y = full_slip_force(300.0, (0.6, 0.3), np.pi / 4, slip=(-0.005, 0.0))
    >>> round(Q_x, 2), round(Q_y, 2)
    (142.3, 85.38)
    """
    frame = Frame(mu, angle)
    norm = float(frame.dual_norm(np.array(slip)))
    if not norm > 0:
        raise ValueError("the slip must not be zero: it gives the direction of sliding")
    Q_x, Q_y = frame.to_physical(-load / norm * frame.slip_to_scaled(np.array(slip)))
    return float(Q_x), float(Q_y)


def load_to_carry(force: Pair, mu: Pair, angle: float) -> float:
    """Return the smallest normal load under which friction carries the force (Q_x, Q_y), N.

    The elliptic norm sqrt((Q_e1/mu1)² + (Q_e2/mu2)²) of eq. (10), inverse to `full_slip_force`.

    Examples
    --------
    >>> round(load_to_carry((90.0, 0.0), (0.6, 0.3), angle=0.0), 9)
    150.0
    """
    return float(Frame(mu, angle).norm(np.array(force)))
