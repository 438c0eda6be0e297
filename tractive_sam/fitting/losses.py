"""Losses of residuals: least squares, and robust losses that give outliers less weight."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

LOSSES: Mapping[str, Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]] = {
    "linear": lambda z: (z, np.ones_like(z)),
    "soft_l1": lambda z: (2.0 * (np.sqrt(1.0 + z) - 1.0), 1.0 / np.sqrt(1.0 + z)),
    "huber": lambda z: (
        np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
        np.where(z <= 1.0, 1.0, 1.0 / np.sqrt(np.maximum(z, 1.0))),
    ),
    "cauchy": lambda z: (np.log1p(z), 1.0 / (1.0 + z)),
    "arctan": lambda z: (np.arctan(z), 1.0 / (1.0 + z**2)),
}
"""Losses of squared residuals, and their derivatives, see `scipy.optimize.least_squares`."""


@dataclass(frozen=True)
class Loss:
    """Loss of residuals by its name in `LOSSES`.

    Attributes
    ----------
    name : str
        Name of the loss.
    """

    name: str

    def cost(self, residuals: np.ndarray) -> float:
        """Return half the sum of the losses of residuals."""
        return 0.5 * float(LOSSES[self.name](np.square(residuals))[0].sum())

    def weights(self, residuals: np.ndarray) -> np.ndarray:
        """Return the weights of residuals, those of the equivalent weighted least squares."""
        return LOSSES[self.name](np.square(residuals))[1]

    def inflation(self, residuals: np.ndarray, unknowns: int) -> float:
        """Return the variance of an estimate over the inverse of its weighted information.

        An M-estimate has the variance E(psi^2) / E(psi')^2 over the information of unit weights,
        with psi = w r. Weighted least squares would give 1 / E(w). The expectations are those of
        the residuals with outliers, but not below those of a normal residual, for which
        E(psi') = E(r psi) (Huber, Robust Statistics (1981), section 7.6, with the factor of few
        points).

        Parameters
        ----------
        residuals : ndarray, shape (points,)
            Residuals over the noise.
        unknowns : int
            Number of fitted coordinates.
        """
        if self.name == "linear":
            return 1.0
        weights, squares, slopes = _normal_moments(self)
        h, share = 1e-4, unknowns / residuals.size
        ends = [(residuals + d) * self.weights(residuals + d) for d in (-h, h)]
        bends = (ends[1] - ends[0]) / (2.0 * h)
        bend = max(float(bends.mean()), 0.2)  # all residuals may be outliers
        weight = self.weights(residuals)
        of_data = float(np.square(weight * residuals).mean() * weight.mean()) / bend**2
        of_data /= max(1.0 - share, share)
        few = (1.0 + share * float(bends.var()) / bend**2) ** 2
        return few * max(of_data, squares * weights / slopes**2)

    @property
    def rise(self) -> float:
        """Expected rise of twice the cost at one standard deviation: 1 for least squares."""
        _, squares, slopes = _normal_moments(self)
        return squares / slopes

    @property
    def slope(self) -> float:
        """Expected weighted square of a residual: 1 for least squares."""
        return _normal_moments(self)[2]


@cache
def _normal_moments(loss: Loss) -> tuple[float, float, float]:
    """Return the expectations of w, (w r)^2 and w r^2 for a standard normal residual r."""
    nodes, shares = np.polynomial.hermite_e.hermegauss(99)
    shares = shares / shares.sum()
    weights = loss.weights(nodes)
    moments = (weights, np.square(weights * nodes), weights * np.square(nodes))
    means = [float(shares @ moment) for moment in moments]
    return means[0], means[1], means[2]
