"""Free parameters, and the coordinates in which they are fitted."""

import math
from dataclasses import dataclass

import numpy as np

from tractive_sam.fitting.design import Fit
from tractive_sam.fitting.entries import is_integer, start_of


@dataclass(frozen=True, eq=False)
class Parameters:
    """Free parameters: bounds, priors, and the map from values v to fitted coordinates u.

    u = 1 + ln(v / start) of a positive one, and 1 + (v - start) / scale of others: all begin at 1,
    and a change by 1 is one of the size of the parameter.

    Attributes
    ----------
    keys : tuple of str
        Keys of the parameters.
    start, scale, lower, upper : ndarray, shape (n,)
        First values, scales of the linear ones, and bounds of the values.
    logarithmic : ndarray of bool, shape (n,)
        Whether the coordinate is a logarithm.
    integer : ndarray of bool, shape (n,)
        Whether the value is an integer.
    prior : ndarray, shape (n, 2)
        Mean and standard deviation known before; nan if unknown.
    """

    keys: tuple[str, ...]
    start: np.ndarray
    scale: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    logarithmic: np.ndarray
    integer: np.ndarray
    prior: np.ndarray

    @classmethod
    def of(cls, fit: Fit) -> "Parameters":
        """Return the free parameters of a fit, with start, scale, bounds and priors."""
        tables = [fit.settings_of(key) for key in fit.free]
        start = np.array([start_of(fit.scene, table.key, table.start) for table in tables])
        lower = np.array([-math.inf if t.lower is None else t.lower for t in tables])
        upper = np.array([math.inf if t.upper is None else t.upper for t in tables])
        start = np.clip(start, lower, upper)
        logarithmic = np.array(
            [
                (t.scale or ("log" if value > 0.0 and (t.lower is None or t.lower >= 0.0) else ""))
                == "log"
                for t, value in zip(tables, start, strict=True)
            ]
        )
        prior = np.array([t.prior or (math.nan, math.nan) for t in tables])
        widths = np.stack([np.abs(start), prior[:, 1], upper - lower])
        usable = np.isfinite(widths) & (widths > 0.0)
        scale = np.where(usable.any(axis=0), widths[usable.argmax(axis=0), range(len(start))], 1.0)
        integer = np.array([is_integer(fit.scene, key) for key in fit.free])
        return cls(fit.free, start, scale, lower, upper, logarithmic, integer, prior)

    def __len__(self) -> int:
        return len(self.keys)

    def values(self, u: np.ndarray) -> np.ndarray:
        """Return the values of the parameters at coordinates."""
        u = np.asarray(u, float)[: len(self)]
        linear = self.start + self.scale * (u - 1.0)
        with np.errstate(over="ignore"):
            powers = np.abs(self.start) * np.exp(np.where(self.logarithmic, u - 1.0, 0.0))
        return np.where(self.logarithmic, powers, linear)

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        """Return the coordinates of values of the parameters; the inverse of `values`."""
        values = np.asarray(values, float)
        ratio = np.divide(values, self.start, out=np.ones(len(self)), where=self.logarithmic)
        with np.errstate(divide="ignore"):
            powers = 1.0 + np.log(ratio)
        return np.where(self.logarithmic, powers, 1.0 + (values - self.start) / self.scale)

    def slopes(self, u: np.ndarray) -> np.ndarray:
        """Return the derivative of each value by its coordinate."""
        return np.where(self.logarithmic, self.values(u), self.scale)

    @property
    def value_bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the values, at least 0 for logarithmic parameters."""
        return np.where(self.logarithmic, np.maximum(self.lower, 0.0), self.lower), self.upper

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds, in coordinates."""
        lower = np.where(self.logarithmic & (self.lower <= 0.0), 0.0, self.lower)
        return self.coordinates(lower), self.coordinates(self.upper)

    def values_by_key(self, u: np.ndarray) -> dict[str, float]:
        """Return the values of the parameters at coordinates, by key."""
        return dict(zip(self.keys, self.values(u).tolist(), strict=True))
