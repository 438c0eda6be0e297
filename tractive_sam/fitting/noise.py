"""Standard deviations of measured values, as functions of the predicted ones."""

from dataclasses import dataclass, fields
from math import log
from typing import Any

import numpy as np

from tractive_sam.fitting.tables import Noise


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """Noise of measured values: absolute, relative to the prediction, or of the logarithm.

    With a relative noise, the standard deviation is one of the predicted value m: if it followed
    the measured value y, low values would weigh more, and the mean of n values y = m (1 + s e)
    would come out as (1 - 2 s^2) m for any n. The fit solves the equations of quasi-likelihood,
    sum (y - m) m' / sd(m)^2 = 0, which are unbiased: the derivative of sd(m) does not appear in
    them (Wedderburn, Biometrika 61 (1974) 439-447).

    Attributes
    ----------
    absolute, relative : ndarray
        Standard deviation, and standard deviation over the predicted value; added in quadrature.
    logarithmic : ndarray
        Standard deviation of the natural logarithm of a value; 0 without a factor.
    """

    smallest = 0.1
    """Smallest prediction over the measured value for the standard deviation: a prediction of zero
    would have none."""

    absolute: np.ndarray
    relative: np.ndarray
    logarithmic: np.ndarray

    @classmethod
    def from_table(cls, noise: Noise, shape: tuple[int, ...], column: Any = None) -> "NoiseModel":
        """Return the noise of values of a shape from its table, and the column that it names."""
        logarithmic = 0.0 if noise.factor is None else log(noise.factor)
        absolute = (noise.absolute or 0.0) if column is None else np.asarray(column)[:, None]
        parts = (absolute, noise.relative or 0.0, logarithmic)
        return cls(*(np.broadcast_to(np.asarray(part, float), shape) for part in parts))

    @classmethod
    def join(cls, models: list["NoiseModel"]) -> "NoiseModel":
        """Return the noise of the values of all models in one row."""
        names = [field.name for field in fields(cls)]
        return cls(*(np.concatenate([getattr(m, name).ravel() for m in models]) for name in names))

    @property
    def follows_prediction(self) -> bool:
        """Whether a standard deviation depends on the prediction, with the residual linear."""
        return bool(self.relative.any())

    def deviation(self, predicted: np.ndarray, observed: np.ndarray) -> np.ndarray:
        """Return the standard deviations of measured values at predictions, in their unit."""
        size = np.maximum(np.abs(predicted), self.smallest * np.abs(observed))
        linear = np.hypot(self.absolute, self.relative * size)
        is_log = self.logarithmic > 0.0
        return np.where(is_log, self.logarithmic * np.where(is_log, size, 0.0), linear)

    def residuals(
        self, predicted: np.ndarray, observed: np.ndarray, deviation: np.ndarray
    ) -> np.ndarray:
        """Return (predicted - measured) over given standard deviations; of logarithms by a factor.

        A prediction with another sign than a measured value with a factor has the residual nan.
        """
        is_log = self.logarithmic > 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            residuals = (predicted - observed) / deviation
            if is_log.any():
                ratios = np.log(predicted[is_log] / observed[is_log])
                residuals[is_log] = ratios / self.logarithmic[is_log]
        return residuals
