"""A measured profile against a predicted one: unknown lateral offset, tilt and level."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator


@dataclass(frozen=True, eq=False)
class ProfilePosition:
    """Unknown lateral offset, tilt and level with which a profile was measured, and their fit.

    The measured depth is d(y - offset) + tilt (y - middle) + level, of those that are unknown.
    Coordinates: offset over the width of the measurement, tilt times this width and level over the
    range of depths.

    Attributes
    ----------
    unknown : tuple of str
        Which of "offset", "tilt", "level" are unknown, in the order of the coordinates.
    y, depth : ndarray, shape (n,)
        Measured places and depths, mm.
    """

    trials = 81
    """Offsets that are tried for the first alignment."""

    unknown: tuple[str, ...]
    y: np.ndarray
    depth: np.ndarray

    @property
    def units(self) -> np.ndarray:
        """Values of offset, tilt or level that one unit of each coordinate stands for."""
        width, height = float(np.ptp(self.y)) or 1.0, float(np.ptp(self.depth)) or 1e-3
        units = {"offset": width, "tilt": height / width, "level": height}
        return np.array([units[name] for name in self.unknown])

    def values(self, position: np.ndarray) -> dict[str, float]:
        """Return offset (mm), tilt and level (mm) at coordinates, by name."""
        return dict(zip(self.unknown, (self.units * position).tolist(), strict=True))

    def predict(self, y: np.ndarray, depth: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Return a computed profile as it would be measured at a position, mm, shape (n,)."""
        values = self.values(position)
        line = values.get("tilt", 0.0) * self._arm + values.get("level", 0.0)
        return _depth(y, depth)(self.y - values.get("offset", 0.0)) + line

    def slopes(self, y: np.ndarray, depth: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Return the derivatives of `predict` by the coordinates of the position, (n, unknown)."""
        offset = self.values(position).get("offset", 0.0)
        columns = {
            "offset": lambda: -_depth(y, depth, 1)(self.y - offset),
            "tilt": lambda: self._arm,
            "level": lambda: np.ones_like(self.y),
        }
        slopes = [
            unit * columns[name]() for name, unit in zip(self.unknown, self.units, strict=True)
        ]
        return np.stack(slopes, axis=1) if slopes else np.empty((self.y.size, 0))

    def align(self, y: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Return the position at which a computed profile, times any factor, fits best."""
        position = np.zeros(len(self.unknown))
        lines = [column for name, column in (("tilt", self._arm), ("level", np.ones_like(self.y)))
                 if name in self.unknown]  # fmt: skip
        trials = [0.0]
        if "offset" in self.unknown:
            half = 0.5 * float(np.ptp(self.y))
            middle = 0.5 * float(self.y.min() + self.y.max())
            trials = [*np.linspace(middle - half, middle + half, self.trials), 0.0]
        best = np.inf
        for offset in trials:
            shape = _depth(y, depth)(self.y - offset)
            columns = np.stack([shape, *lines], axis=1)
            factors, *_ = np.linalg.lstsq(columns, self.depth, rcond=None)
            misfit = float(np.square(columns @ factors - self.depth).sum())
            if misfit < best and factors[0] > 0.0:
                best = misfit
                names = [name for name in ("tilt", "level") if name in self.unknown]
                values = {"offset": offset} | dict(zip(names, factors[1:], strict=True))
                position = np.array([values[name] for name in self.unknown]) / self.units
        return position

    @property
    def _arm(self) -> np.ndarray:
        """Lateral distances of the measured points from the middle of the profile, mm."""
        return self.y - 0.5 * (self.y.min() + self.y.max())


def _depth(y: np.ndarray, depth: np.ndarray, order: int = 0):
    """Return the depth, or its derivative, as a function of y: monotone cubic, 0 off the mesh."""
    step = y[1] - y[0]
    places = np.concatenate(([y[0] - step], y, [y[-1] + step]))
    curve = PchipInterpolator(places, np.pad(depth, 1), extrapolate=False)
    curve = curve.derivative(order) if order else curve
    return lambda at: np.nan_to_num(curve(at))
