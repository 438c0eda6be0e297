"""Stress on a plane below the surface."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import StressCriterion, max_shear, principal_stresses, von_mises
from tractive_sam.scene import Plane

COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Components of a stress, in the order of all arrays of stress."""


@dataclass(frozen=True, eq=False, repr=False)
class PlaneStress(ShortArrays):
    """Full stress (six components) of one body at the points of a section plane, MPa.

    Attributes
    ----------
    body : "A" or "B"
        The body.
    plane : Plane
        The plane; its text is `str(plane)`.
    position : float
        The constant x, y or depth of the plane, mm.
    axes : dict of str to ndarray
        Names and coordinates of the two axes of the arrays, in their order, mm: "y" and "depth"
        at constant x, "x" and "depth" at constant y, "x" and "y" at constant depth.
    components : dict of str to ndarray
        xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.
    block : int, optional
        Block of a duty cycle, from 0.

    Examples
    --------
    >>> stress = ts.stress_on_plane(contact, "x=0")
    >>> list(stress.axes), list(stress.components)
    (['y', 'depth'], ['xx', 'yy', 'zz', 'xy', 'xz', 'yz'])
    >>> bool(stress.von_mises.max() < scene.hertz.p0)
    True
    """

    body: str
    plane: Plane
    position: float
    axes: dict[str, np.ndarray]
    components: dict[str, np.ndarray]
    block: int | None = None

    @property
    def along(self) -> tuple[str, np.ndarray]:
        """Name ("x" or "y") and coordinates, mm, of the first axis of the plane."""
        return next(iter(self.axes.items()))

    @property
    def depth(self) -> np.ndarray:
        """Depths of the plane's points, mm: its second axis, or one depth if it is horizontal."""
        return self.axes.get("depth", np.array([self.position]))

    @cached_property
    def _tensor(self) -> np.ndarray:
        """Stress components stacked in the order of `COMPONENTS`, shape (6, ...), MPa."""
        return np.stack([self.components[name] for name in COMPONENTS])

    def by(self, criterion: StressCriterion) -> np.ndarray:
        """Return the value of a stress criterion at each point of the plane, in its unit."""
        return criterion(self._tensor)

    @cached_property
    def von_mises(self) -> np.ndarray:
        """Equivalent stress of von Mises at each point of the plane, MPa."""
        return von_mises(self._tensor)

    @cached_property
    def max_shear(self) -> np.ndarray:
        """Largest shear stress (sigma_1 - sigma_3)/2 of the three-dimensional stress, MPa."""
        return max_shear(self._tensor)

    @cached_property
    def principal(self) -> np.ndarray:
        """Principal stresses, the largest first, shape (3, ...), MPa."""
        return principal_stresses(self._tensor)
