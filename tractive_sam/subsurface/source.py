"""Which machinery finds the stress in bodies: patches or strips of traction."""

from collections.abc import Iterable, Iterator, Sequence
from functools import singledispatch
from typing import Literal, Protocol

import numpy as np

from tractive_sam.mechanics import Elasticity, HalfSpaces, StressCriterion, Strips
from tractive_sam.operators import Lattice, StressLayers, StressPlane, StripLayers
from tractive_sam.results import Grid
from tractive_sam.subsurface.distant import DistantLoads
from tractive_sam.subsurface.mirror import acting
from tractive_sam.subsurface.multilevel import MultiLevel
from tractive_sam.subsurface.patches import Patches
from tractive_sam.subsurface.strips import StripLevels, StripLoads


class StressSource(Protocol):
    """Bodies z >= 0, z into the body, each under the tractions on it on the elements of one grid.

    Stresses are in the order of `results.plane_stress.COMPONENTS`, MPa.
    """

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Stresses on the plane axis = position at the centres along it.

        Shape (bodies, 6, n, k) at k depths, or (bodies, 6, n_x, n_y) where the axis is z.
        """

    def at(self, points: np.ndarray) -> np.ndarray:
        """Stresses (bodies, 6, n) at points (n, 3)."""

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Stresses (bodies, 6, n_x, n_y, k) at x (n_x,) outside the grid and k depths below 0.

        In all rows of the grid.
        """

    def levels(self, criterion: StressCriterion) -> MultiLevel | StripLevels:
        """What the largest equivalent stresses are sought in."""


@singledispatch
def stress_source(
    body: Elasticity,
    bodies: Sequence[Elasticity],
    signs: Sequence[float],
    grid: Grid,
    tractions: np.ndarray,
) -> StressSource:
    """The machinery that goes with the elasticity of bodies.

    Parameters
    ----------
    body : Elasticity
        The first of the bodies, the kind of which decides.
    bodies : sequence of Elasticity
        As `Elasticity.single_body` gives them.
    signs : sequence of float
        Those of `SIGNS` for each.
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on body A, MPa.

    Raises
    ------
    ValueError
        If none is registered for this kind.
    """
    raise ValueError(f"the stress in bodies is not known of {body!r}")


class PatchStress:
    """Half-spaces under patches; arguments as of `stress_source`."""

    def __init__(
        self,
        bodies: Sequence[HalfSpaces],
        signs: Sequence[float],
        grid: Grid,
        tractions: np.ndarray,
    ):
        self._bodies, self._signs, self._grid, self._tractions = bodies, signs, grid, tractions
        self._poisson = tuple(body.A.poisson for body in bodies)

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """See `StressSource`."""
        grid = self._grid
        lattice = Lattice(grid.elements, grid.dx, grid.dy)
        own = self._tractions, self._poisson, self._signs
        return map(StressLayers(lattice, *own, threads).at, depths)

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """See `StressSource`."""
        if axis == "z":
            return next(self.layers([position]))
        own = self._tractions, self._poisson, self._signs
        plane = StressPlane(self._grid, axis, position, *own)
        return np.stack([plane.at(depth) for depth in depths], axis=-1)

    def at(self, points: np.ndarray) -> np.ndarray:
        """See `StressSource`."""
        grid, sides = self._grid, (self._grid.dx, self._grid.dy)
        each = zip(acting(self._tractions, self._signs), self._poisson, strict=True)
        patches = [Patches.on_mesh(grid.x, grid.y, sides, own, nu) for own, nu in each]
        return np.stack([one.stress(points).T for one in patches])

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """See `StressSource`; see `DistantLoads` for the error."""
        loads = DistantLoads(self._grid, self._tractions, self._signs, self._poisson)
        return loads.stress(x, depths)

    def levels(self, criterion: StressCriterion) -> MultiLevel:
        """See `StressSource`."""
        return MultiLevel(self._grid, self._tractions, self._signs, self._bodies, criterion)


class StripStress:
    """Half-spaces under strips; arguments as of `stress_source`."""

    def __init__(
        self, bodies: Sequence[Strips], signs: Sequence[float], grid: Grid, tractions: np.ndarray
    ):
        self._bodies, self._signs, self._grid, self._tractions = bodies, signs, grid, tractions
        self._poisson = tuple(body.A.poisson for body in bodies)

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """See `StressSource`."""
        lattice = Lattice(self._grid.elements, self._grid.dx, self._grid.dy)
        return map(StripLayers(lattice, self._tractions, self._poisson, self._signs).at, depths)

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """See `StressSource`."""
        if axis == "z":
            return next(self.layers([position]))
        if axis == "y":
            return np.concatenate(list(self.layers(depths)), axis=-1)
        points = np.stack(np.broadcast_arrays(position, 0.0, depths), axis=-1)
        return self.at(points)[:, :, None]

    def at(self, points: np.ndarray) -> np.ndarray:
        """See `StressSource`."""
        each = zip(acting(self._tractions, self._signs), self._poisson, strict=True)
        strips = [StripLoads.on_grid(self._grid, own, nu) for own, nu in each]
        return np.stack([one.stress(points).T for one in strips])

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """See `StressSource`; exact."""
        places = np.broadcast_arrays(x[:, None], 0.0, depths)
        stress = self.at(np.stack(places, axis=-1).reshape(-1, 3))
        return stress.reshape(len(stress), 6, x.size, 1, depths.size)

    def levels(self, criterion: StressCriterion) -> StripLevels:
        """See `StressSource`."""
        return StripLevels(self._grid, self._tractions, self._signs, self._bodies, criterion)


@stress_source.register
def _of_patches(body: HalfSpaces, *of_bodies) -> PatchStress:
    return PatchStress(*of_bodies)


@stress_source.register
def _of_strips(body: Strips, *of_bodies) -> StripStress:
    return StripStress(*of_bodies)
