"""Temperatures of the surfaces of a contact: their fields, and the columns that they provide."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, ClassVar

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.results.grid import Grid
from tractive_sam.results.quantity import Quantity, index_by_name


def read_heat(name: str, contact: Any, none: Any = math.nan) -> Any:
    """Return an attribute of `contact.heat`, or the value `none` without heat."""
    return none if contact.heat is None else getattr(contact.heat, name)


_of_heat = partial(Quantity, needs=("heat",))


@dataclass(frozen=True, eq=False, repr=False)
class FlashTemperature(ShortArrays):
    """Steady temperatures of both surfaces, and the heat flux into them.

    Attributes
    ----------
    grid : Grid
        The mesh.
    touching : ndarray of bool, shape (n_x, n_y)
        Elements in contact: both surfaces have equal temperatures there.
    temperature : mapping of str to ndarray, shape (n_x, n_y)
        Temperatures of the surfaces of "A" and "B", degrees C.
    flux : mapping of str to ndarray, shape (n_x, n_y)
        Heat flux into each surface, mW/mm²; the sum is the frictional heat, -p_t . s.
    residual : float
        Relative residual of the equality of both temperatures in contact.

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
    residual: float = 0.0
    columns: ClassVar[tuple[Quantity, ...]] = (
        _of_heat("temperature_max", "degC", "largest temperature of the surfaces in contact",
                 partial(read_heat, "temperature_max"), symbol=r"T_\mathrm{max}",
                 over_blocks="largest"),
        _of_heat("temperature_max_at", "mm", "position (x, y) of the largest temperature",
                 partial(read_heat, "temperature_max_at", none=(math.nan, math.nan)),
                 ("axis",), place_of="temperature_max"),
        _of_heat("temperature_mean", "degC", "mean temperature of the surfaces in contact",
                 partial(read_heat, "temperature_mean"), symbol=r"T_\mathrm{mean}"),
        _of_heat("heat_share", "1", "fraction of the frictional heat that flows into body A",
                 partial(read_heat, "share"), format=".4f"),
    )  # fmt: skip
    """Columns of scenes with [heat]."""

    @property
    def temperature_A(self) -> np.ndarray:
        """Temperature of the surface of A, degrees C."""
        return self.temperature["A"]

    @property
    def temperature_B(self) -> np.ndarray:
        """Temperature of the surface of B, degrees C."""
        return self.temperature["B"]

    @property
    def into_A(self) -> np.ndarray:
        """Heat flux into A, mW/mm²."""
        return self.flux["A"]

    @property
    def shortfall(self) -> str:
        """Message if the temperatures of both bodies differ in contact; empty if they are equal."""
        if self.residual <= 1e-9:
            return ""
        return (
            "not converged: heat: the shares of the bodies in the frictional heat were solved only "
            f"to a residual of {self.residual:.1e}; check body.A.thermal and body.B.thermal, or "
            "change grid.elements"
        )

    @cached_property
    def _contact_temperature(self) -> np.ndarray:
        """Temperatures of elements in contact, degrees C; -inf for the other elements."""
        return np.where(self.touching, self.temperature["A"], -np.inf)

    @property
    def temperature_max(self) -> float:
        """Largest temperature in the contact, degrees C; nan without contact."""
        return float(self._contact_temperature.max()) if self.touching.any() else np.nan

    @property
    def temperature_max_at(self) -> tuple[float, float]:
        """Place of the largest temperature, (x, y) in mm; nan without contact."""
        if not self.touching.any():
            return np.nan, np.nan
        i, j = np.unravel_index(
            np.argmax(self._contact_temperature), self._contact_temperature.shape
        )
        return float(self.grid.x[i]), float(self.grid.y[j])

    @property
    def temperature_mean(self) -> float:
        """Mean temperature in the contact, degrees C; nan without contact."""
        return (
            float(self._contact_temperature[self.touching].mean())
            if self.touching.any()
            else np.nan
        )

    @property
    def power(self) -> float:
        """Frictional heat, W; for a line contact W/mm."""
        total = self.flux["A"] + self.flux["B"]
        return float(1e-3 * total.sum() * self.grid.element_area)

    @property
    def share(self) -> float:
        """Share of body A in the frictional heat; nan without heat."""
        into_A, total = self.flux["A"].sum(), (self.flux["A"] + self.flux["B"]).sum()
        return float(into_A / total) if total > 0.0 else np.nan


_warm = partial(Quantity, needs=("heat",), outside=math.nan)

HEAT_FIELDS = index_by_name(
    (
        _warm("temperature_A", "degC", "temperature of the surface of body A",
              partial(read_heat, "temperature_A")),
        _warm("temperature_B", "degC", "temperature of the surface of body B",
              partial(read_heat, "temperature_B")),
        _warm("heat_into_A", "mW/mm2", "heat flux into body A", partial(read_heat, "into_A")),
    )
)  # fmt: skip
"""Fields stored for scenes with [heat]; resuming does not need them."""
