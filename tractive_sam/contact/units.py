"""Units of dimensionless problems."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from tractive_sam.mechanics import Elasticity, Frame
from tractive_sam.results import Grid
from tractive_sam.scene import Scene
from tractive_sam.schema import required


@dataclass(frozen=True)
class Units:
    """Units of pressure, gap and slip that make a problem of order one.

    Attributes
    ----------
    pressure : float
        p*, MPa.
    gap : float
        g*, mm; for half-spaces p* l / E*, with l the mean semi-axis of the contact.
    slip : float
        s*, dimensionless; for half-spaces max(mu1, mu2)² p* / G.
    """

    pressure: float
    gap: float
    slip: float

    @classmethod
    def of_contact(
        cls,
        scene: Scene,
        grid: Grid,
        elasticity: Elasticity,
        frame: Frame,
        undeformed_gap: Callable[[], np.ndarray],
    ) -> Self:
        """Return the units of a scene, from its Hertz contact, or from the mesh without one.

        `undeformed_gap` computes the gap, mm; only a prescribed approach without Hertz needs it.
        """
        hertz, sides = scene.hertz, (grid.dx, grid.dy)
        if hertz is not None:
            length = hertz.mean_semi_axis
        elif grid.line:
            length = 0.5 * grid.half_length[0]
        else:
            length = 0.5 * math.sqrt(grid.half_length[0] * grid.half_length[1])
        gap = elasticity.gap_per_pressure(length, *sides)
        load = scene.normal_load
        if hertz is not None:
            pressure = hertz.p0
        elif load is not None:
            pressure = load / (2.0 * length if grid.line else math.pi * length**2)
        else:
            approach = required(scene.load.approach, "load.approach")
            interference = approach - float(undeformed_gap().min())
            # Without contact the unit only has to be positive.
            pressure = (abs(interference) or 1e-3 * length) / gap
        slip = max(frame.mu) ** 2 * elasticity.slip_per_traction(*sides)
        return cls(pressure, gap * pressure, slip * pressure)
