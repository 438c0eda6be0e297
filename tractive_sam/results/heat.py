"""Heat that friction makes in a contact, and how warm it makes both surfaces."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.results.grid import Grid


@dataclass(frozen=True, eq=False, repr=False)
class FlashTemperature(ShortArrays):
    """Steady temperatures of both surfaces, and the heat that goes into them.

    Attributes
    ----------
    grid : Grid
        The mesh.
    touching : ndarray of bool, shape (n_x, n_y)
        Where the bodies touch: there they are equally warm.
    temperature : mapping of str to ndarray, shape (n_x, n_y)
        Of the surfaces of "A" and "B", degrees C.
    flux : mapping of str to ndarray, shape (n_x, n_y)
        Heat that goes into them, mW/mm²: together what friction makes, -p_t . s.

    Examples
    --------
    >>> hot = ts.solve(ts.Scene.builtin("hot-discs")).heat
    >>> bool(hot.temperature_max > 100.0), round(hot.share, 3)
    (True, 0.5)
    """

    grid: Grid
    touching: np.ndarray
    temperature: Mapping[str, np.ndarray]
    flux: Mapping[str, np.ndarray]

    @property
    def temperature_A(self) -> np.ndarray:
        """Of the surface of A, degrees C."""
        return self.temperature["A"]

    @property
    def temperature_B(self) -> np.ndarray:
        """Of the surface of B, degrees C."""
        return self.temperature["B"]

    @property
    def into_A(self) -> np.ndarray:
        """Heat that goes into A, mW/mm²."""
        return self.flux["A"]

    @cached_property
    def _inside(self) -> np.ndarray:
        return np.where(self.touching, self.temperature["A"], -np.inf)

    @property
    def temperature_max(self) -> float:
        """Largest temperature in the contact, degrees C; nan without contact."""
        return float(self._inside.max()) if self.touching.any() else np.nan

    @property
    def temperature_max_at(self) -> tuple[float, float]:
        """Where that is, (x, y) in mm; nan without contact."""
        if not self.touching.any():
            return np.nan, np.nan
        i, j = np.unravel_index(np.argmax(self._inside), self._inside.shape)
        return float(self.grid.x[i]), float(self.grid.y[j])

    @property
    def temperature_mean(self) -> float:
        """Mean over the contact, degrees C; nan without contact."""
        return float(self._inside[self.touching].mean()) if self.touching.any() else np.nan

    @property
    def power(self) -> float:
        """Heat made, W; of a line contact W/mm."""
        made = self.flux["A"] + self.flux["B"]
        return float(1e-3 * made.sum() * self.grid.element_area)

    @property
    def share(self) -> float:
        """Share of body A in the heat made; nan where none is."""
        into_A, made = self.flux["A"].sum(), (self.flux["A"] + self.flux["B"]).sum()
        return float(into_A / made) if made > 0.0 else np.nan
