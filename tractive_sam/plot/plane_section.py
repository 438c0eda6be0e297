"""The stress on a plane of a body: values, labels and contours."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.ticker import MaxNLocator

from tractive_sam.mechanics import CRITERIA, VON_MISES, StressCriterion
from tractive_sam.plot.plane_maxima import StressMaximum, stress_maxima
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import LOOK
from tractive_sam.results import PlaneStress


@dataclass(frozen=True)
class PlaneSection:
    """Quantity on a plane of one body as figures draw it, with its scale.

    Attributes
    ----------
    stress : PlaneStress
        The plane.
    quantity : str or StressCriterion
        A component of the stress, a criterion, or the name of one of `CRITERIA`.
    scale : Scale or None
        Half widths and pressure by which figures divide; None for mm and MPa.

    Raises
    ------
    ValueError
        If the quantity is unknown, or the plane is only a line.
    """

    stress: PlaneStress
    quantity: str | StressCriterion
    scale: Scale | None

    def __post_init__(self) -> None:
        allowed = (*CRITERIA, *self.stress.components)
        if self.criterion is None and self.quantity not in allowed:
            raise ValueError(f"quantity: one of {', '.join(allowed)}; not {self.quantity!r}")
        if min(self.values.shape) < 2:
            raise ValueError("a plane needs at least 2 depths, and 2 points along it")

    @property
    def body(self) -> str:
        """Name of the body, "A" or "B"."""
        return self.stress.body

    @property
    def parallel(self) -> bool:
        """Whether the plane is parallel to the surface."""
        return "depth" not in self.stress.axes

    @property
    def criterion(self) -> StressCriterion | None:
        """Criterion of the stress; None for a component."""
        if isinstance(self.quantity, StressCriterion):
            return self.quantity
        return CRITERIA.get(self.quantity)

    @property
    def signed(self) -> bool:
        """Whether the quantity may have both signs, like a stress component."""
        return self.criterion is None

    @property
    def mesh_dependent(self) -> bool:
        """Whether the plane includes the surface and values there depend on the mesh.

        The components zz, xz and yz are the tractions there, which do not.
        """
        return self.quantity not in ("zz", "xz", "yz") and float(self.stress.depth.min()) == 0.0

    @cached_property
    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Ascending coordinates along both axes, over half width a, or in mm without a scale."""
        unit = self.scale.a if self.scale else 1.0
        first, second = self.stress.axes.values()
        return first / unit, np.sort(second) / unit

    @cached_property
    def values(self) -> np.ndarray:
        """Values of the quantity over the scale's pressure, or MPa, in the shape of the axes."""
        if self.criterion is None:
            values = self.stress.components[str(self.quantity)]
        elif self.criterion == VON_MISES:  # without the compiled one: it takes long to load
            values = self.stress.von_mises
        else:
            values = self.stress.by(self.criterion)
        _, second = self.stress.axes.values()
        return values[:, np.argsort(second)] / (self.scale.p if self.scale else 1.0)

    @cached_property
    def stress_maxima(self) -> list[StressMaximum]:
        """Maxima that a figure marks: the largest magnitude, or interior and surface maxima."""
        if self.parallel or self.signed:
            return [StressMaximum.largest("largest", self.values, self.axes)]
        return stress_maxima(self.values, self.axes)

    @property
    def symbol(self) -> str:
        """Symbol of the quantity with its unit, for math text."""
        criterion = self.criterion
        symbol = rf"\sigma_{{{self.quantity}}}" if criterion is None else criterion.symbol
        unit = "MPa" if criterion is None else criterion.unit
        return rf"${symbol}/{self.scale.p_symbol}$" if self.scale else f"${symbol}$ ({unit})"

    @property
    def description(self) -> str:
        """Name of the quantity, for titles."""
        criterion = self.criterion
        return f"stress component {self.quantity}" if criterion is None else criterion.long_name

    @property
    def place(self) -> str:
        """Position of the plane, as math text."""
        plane = self.stress.plane
        unit = {"": r"\,\mathrm{mm}", "a": r"\,a", "b": r"\,b"}[plane.unit]
        if plane.unit and self.scale:
            unit = rf"\,{self.scale.a_symbol if plane.unit == 'a' else self.scale.b_symbol}"
        return f"${plane.axis} = {plane.number:g}{unit if plane.number else ''}$"

    @property
    def names(self) -> tuple[str, str]:
        """Names of the axes: "x", "y" or "depth"."""
        first, second = self.stress.axes
        return first, second

    @property
    def touching(self) -> np.ndarray:
        """Mask of the points in contact along a plane; all False for one below the surface."""
        depth = self.stress.depth
        if depth.min() > 0.0:
            return np.zeros(self.values.shape[0], dtype=bool)
        zz = self.stress.components["zz"]
        return (
            zz[:, np.argmin(depth)] < -1e-9 * np.abs(zz).max()
        )  # smaller ones are rounding errors

    def length_label(self, name: str) -> str:
        """Return the label of an axis or length, as math text."""
        return f"${name}/{self.scale.a_symbol}$" if self.scale else f"${name}$ (mm)"

    def format_coordinate(self, name: str, value: float) -> str:
        """Return a coordinate of a point, as math text."""
        if value == 0.0:
            return f"${name} = 0$"
        if self.scale is None:
            return rf"${name} = {value:.3g}\,\mathrm{{mm}}$"
        return rf"${name} = {value:.2f}\,{self.scale.a_symbol}$"

    def format_value(self, value: float) -> str:
        """Return a value of the quantity, as math text."""
        return f"${value:.3f}$" if self.scale else rf"${value:.4g}\,\mathrm{{MPa}}$"

    def draw_contours(self, axes: Axes, levels: np.ndarray, upwards: bool = True) -> ContourSet:
        """Fill axes with contours of the quantity; return the contour set."""
        first, second = self.axes
        second = second if upwards else -second
        colours = LOOK.signed if self.signed else LOOK.stress
        filled = axes.contourf(first, second, self.values.T, levels, cmap=colours, zorder=0.5)
        filled.set_edgecolor("face")  # no gaps between the bands
        style: dict[str, Any] = {
            "colors": "black",
            "linewidths": 0.35,
            "linestyles": "-",
            "alpha": 0.35,
        }
        axes.contour(first, second, self.values.T, levels, zorder=0.6, **style)
        return filled


def common_levels(sections: Sequence[PlaneSection], bands: int = 14) -> np.ndarray:
    """Return round contour levels for about `bands` bands in all sections together.

    Raises
    ------
    ValueError
        If none of them has any stress.
    """
    highest = max(float(np.abs(section.values).max()) for section in sections)
    if highest == 0.0:
        raise ValueError("nothing to draw: there is no stress on the plane; choose another one")
    lowest = -highest if sections[0].signed else 0.0
    locator = MaxNLocator(bands, symmetric=sections[0].signed)
    return np.asarray(locator.tick_values(lowest, highest))
