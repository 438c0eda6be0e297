"""First guesses, dimensionless."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.contact.model import Model
from tractive_sam.results.state import Contact


@dataclass(frozen=True)
class Guess:
    """What a solve may start from, on the whole mesh; names and units of `Outcome`."""

    pressure: np.ndarray
    traction: np.ndarray
    approach: float
    creepage: np.ndarray

    @classmethod
    def of(cls, model: Model, contact: Contact) -> "Guess":
        """The solution of a contact nearby."""
        units = model.units
        creepage = np.array([contact.xi_x, contact.xi_y])[list(model.free)]
        return cls(
            contact.pressure / units.pressure,
            model.frame.to_scaled(contact.traction) / units.pressure,
            contact.approach / units.gap,
            creepage / units.slip,
        )

    @property
    def state(self) -> np.ndarray:
        """Pressure and tractions in one array of shape (3, n_x, n_y)."""
        return np.concatenate((self.pressure[None], self.traction))
