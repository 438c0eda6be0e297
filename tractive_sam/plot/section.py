"""One plane through a body, filled with contours of its stress, true to scale."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.ticker import MaxNLocator

from tractive_sam.mechanics import CRITERIA, StressCriterion
from tractive_sam.plot.plane_maxima import StressMaximum, stress_maxima
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import SIGNED, STRESS
from tractive_sam.results import PlaneStress

GIVEN = ("zz", "xz", "yz")
"""Components that at the surface are the tractions, and do not depend on the mesh."""

BANDS = 14
"""About so many colours."""

ROUNDING = 1e-9
"""Stress at the surface, over the largest on the plane, that is none."""


@dataclass(frozen=True)
class Section:
    """A quantity on a plane of one body, and what to draw it against.

    Attributes
    ----------
    stress : PlaneStress
        The plane.
    quantity : str or StressCriterion
        A component, or what the stress is judged by: a criterion, or the name of one of `CRITERIA`.
    scale : Scale or None
        Half widths and pressure that stand for one; None for mm and MPa.

    Raises
    ------
    ValueError
        If there is no such quantity, or the plane is but a line.
    """

    stress: "PlaneStress"
    quantity: str | StressCriterion
    scale: Scale | None

    def __post_init__(self) -> None:
        known = (*CRITERIA, *self.stress.components)
        if self.criterion is None and self.quantity not in known:
            raise ValueError(f"quantity: one of {', '.join(known)}; not {self.quantity!r}")
        if min(self.values.shape) < 2:
            raise ValueError("a plane is drawn from at least 2 depths, and 2 points along it")

    @property
    def body(self) -> str:
        """The body."""
        return self.stress.body

    @property
    def parallel(self) -> bool:
        """Whether the plane is parallel to the surface."""
        return "depth" not in self.stress.axes

    @property
    def criterion(self) -> StressCriterion | None:
        """What the stress is judged by; None of a component."""
        if isinstance(self.quantity, StressCriterion):
            return self.quantity
        return CRITERIA.get(self.quantity)

    @property
    def signed(self) -> bool:
        """Whether the quantity has a sign."""
        return self.criterion is None

    @property
    def mesh_dependent(self) -> bool:
        """Whether values at the surface, which is part of the plane, depend on the mesh."""
        return self.quantity not in GIVEN and float(self.stress.depth.min()) == 0.0

    @cached_property
    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Ascending coordinates along both axes, over the half width a."""
        unit = self.scale.a if self.scale else 1.0
        first, second = self.stress.axes.values()
        return first / unit, np.sort(second) / unit

    @cached_property
    def values(self) -> np.ndarray:
        """The quantity over the pressure of the scale, shape as the axes say."""
        if self.criterion is None:
            values = self.stress.components[self.quantity]
        else:
            values = self.stress.by(self.criterion)
        _, second = self.stress.axes.values()
        return values[:, np.argsort(second)] / (self.scale.p if self.scale else 1.0)

    @cached_property
    def stress_maxima(self) -> list[StressMaximum]:
        """What is to be marked."""
        if self.parallel or self.signed:
            return [StressMaximum.of("largest", self.values, self.axes)]
        return stress_maxima(self.values, self.axes)

    @property
    def symbol(self) -> str:
        """Symbol of the quantity with its unit, for math text."""
        criterion = self.criterion
        symbol = rf"\sigma_{{{self.quantity}}}" if criterion is None else criterion.symbol
        unit = "MPa" if criterion is None else criterion.unit
        return rf"${symbol}/{self.scale.p_symbol}$" if self.scale else f"${symbol}$ ({unit})"

    @property
    def told(self) -> str:
        """What is drawn, for captions."""
        criterion = self.criterion
        return f"stress component {self.quantity}" if criterion is None else criterion.long_name

    @property
    def place(self) -> str:
        """Where the plane is, for math text."""
        plane = self.stress.plane
        unit = {"": r"\,\mathrm{mm}", "a": r"\,a", "b": r"\,b"}[plane.unit]
        if plane.unit and self.scale:
            unit = rf"\,{self.scale.a_symbol if plane.unit == 'a' else self.scale.b_symbol}"
        return f"${plane.axis} = {plane.number:g}{unit if plane.number else ''}$"

    @property
    def names(self) -> tuple[str, str]:
        """Names of the axes: "x", "y" or "depth"."""
        return tuple(self.stress.axes)

    @property
    def touching(self) -> np.ndarray:
        """Where along a plane through the depth the bodies touch; nowhere without its surface."""
        depth = self.stress.depth
        if depth.min() > 0.0:
            return np.zeros(self.values.shape[0], dtype=bool)
        zz = self.stress.components["zz"]
        return zz[:, np.argmin(depth)] < -ROUNDING * np.abs(zz).max()

    def length(self, name: str) -> str:
        """Label of a length, for math text."""
        return f"${name}/{self.scale.a_symbol}$" if self.scale else f"${name}$ (mm)"

    def coordinate(self, name: str, value: float) -> str:
        """A coordinate of a point, for math text."""
        if value == 0.0:
            return f"${name} = 0$"
        if self.scale is None:
            return rf"${name} = {value:.3g}\,\mathrm{{mm}}$"
        return rf"${name} = {value:.2f}\,{self.scale.a_symbol}$"

    def amount(self, value: float) -> str:
        """A value of the quantity, for math text."""
        return f"${value:.3f}$" if self.scale else rf"${value:.4g}\,\mathrm{{MPa}}$"

    def fill(self, axes: Axes, levels: np.ndarray, upwards: bool = True) -> ContourSet:
        """Fill axes with contours; depths count upwards or downwards."""
        first, second = self.axes
        second = second if upwards else -second
        colours = SIGNED if self.signed else STRESS
        filled = axes.contourf(first, second, self.values.T, levels, cmap=colours, zorder=0.5)
        filled.set_edgecolor("face")  # no gaps between the bands
        style = {"colors": "black", "linewidths": 0.35, "alpha": 0.35, "zorder": 0.6}
        axes.contour(first, second, self.values.T, levels, linestyles="-", **style)
        return filled


def common_levels(sections: Sequence[Section]) -> np.ndarray:
    """Round values between which the bands of all sections lie.

    Raises
    ------
    ValueError
        If there is no stress in any of them.
    """
    highest = max(float(np.abs(section.values).max()) for section in sections)
    if highest == 0.0:
        raise ValueError("nothing to draw: there is no stress on the plane")
    lowest = -highest if sections[0].signed else 0.0
    return MaxNLocator(BANDS, symmetric=sections[0].signed).tick_values(lowest, highest)
