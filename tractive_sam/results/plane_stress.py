"""Stress on a plane below the surface."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import StressCriterion, max_shear, principal_stresses, von_mises
from tractive_sam.scene import Plane

COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Components of a stress, in the order of every array of them."""


@dataclass(frozen=True, eq=False, repr=False)
class PlaneStress(ShortArrays):
    """Stress of one body on one plane.

    Attributes
    ----------
    body : "A" or "B"
        The body.
    plane : Plane
        The plane; its text is `str(plane)`.
    position : float
        Where it lies, mm: the x, y or depth that is constant on it.
    axes : dict of str to ndarray
        Names and coordinates of the two axes of every array, in their order, mm: "y" and "depth"
        where x is constant, "x" and "depth" where y is, "x" and "y" at constant depth.
    components : dict of str to ndarray
        xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.
    block : int, optional
        Of a duty cycle which block it is of, from 0.

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
        """Name and coordinates of the first axis, mm."""
        return next(iter(self.axes.items()))

    @property
    def depth(self) -> np.ndarray:
        """Depths, mm: those of the second axis, or the only one of a plane at constant depth."""
        return self.axes.get("depth", np.array([self.position]))

    @cached_property
    def _tensor(self) -> np.ndarray:
        return np.stack([self.components[name] for name in COMPONENTS])

    def by(self, criterion: StressCriterion) -> np.ndarray:
        """The stress judged by a criterion, in its unit."""
        return criterion(self._tensor)

    @cached_property
    def von_mises(self) -> np.ndarray:
        """Equivalent stress of von Mises, MPa."""
        return von_mises(self._tensor)

    @cached_property
    def max_shear(self) -> np.ndarray:
        """Largest shear stress, half the difference of the extreme principal stresses, MPa."""
        return max_shear(self._tensor)

    @cached_property
    def principal(self) -> np.ndarray:
        """Principal stresses, the largest first, shape (3, ...), MPa."""
        return principal_stresses(self._tensor)
