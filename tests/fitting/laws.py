"""A wear law of another package, with parameters to fit."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.mechanics import WearLaw


@dataclass(frozen=True)
class PowerLaw(WearLaw):
    """Depth per distance that follows a power of pressure times slip."""

    factor: float
    exponent: float

    def rate(self, pressure, traction, slip):
        """See `WearLaw.rate`."""
        work = np.abs((traction * slip).sum(axis=0))
        return self.factor * work**self.exponent

    def per_load(self, pressure, traction, slip):
        """See `WearLaw.per_load`."""
        rate = self.exponent * self.rate(pressure, traction, slip)
        return np.divide(rate, pressure, out=np.zeros_like(rate), where=pressure > 0.0)
