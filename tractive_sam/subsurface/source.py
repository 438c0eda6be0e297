"""Methods that compute the stress in bodies: patches or strips of traction."""

from collections.abc import Iterable, Iterator, Sequence
from functools import singledispatch
from typing import Literal, Protocol

import numpy as np

from tractive_sam.mechanics import Elasticity, HalfSpaces, StressCriterion, Strips
from tractive_sam.operators import Lattice, StressLayers, StressPlane, StripLayers
from tractive_sam.results import Grid
from tractive_sam.subsurface.distant import DistantLoads
from tractive_sam.subsurface.mirror import tractions_on_bodies
from tractive_sam.subsurface.multilevel import MultiLevel
from tractive_sam.subsurface.patches import PatchLoads
from tractive_sam.subsurface.strips import StripLevels, StripLoads


class StressSource(Protocol):
    """Protocol of stress solvers for half-spaces under tractions on a grid.

    Stresses have the order of `results.plane_stress.COMPONENTS`, MPa.
    """

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, n_y) if z.

        The shape is (bodies, 6, n, k) at k depths, or (bodies, 6, n_x, n_y) for the axis z.
        """

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths.

        They are in all rows of the grid; depths are above 0.
        """

    def levels(self, criterion: StressCriterion) -> MultiLevel | StripLevels:
        """Return the stress at several depths (resolutions) in which the maximum is searched."""


@singledispatch
def stress_source(
    body: Elasticity,
    bodies: Sequence[Elasticity],
    signs: Sequence[float],
    grid: Grid,
    tractions: np.ndarray,
) -> StressSource:
    """Return the stress solver for the class of the first body; ValueError if none is registered.

    Parameters
    ----------
    body : Elasticity
        The first body; its class selects the method.
    bodies : sequence of Elasticity
        The bodies, see `Elasticity.single_body`.
    signs : sequence of float
        Sign of each body, see `SIGNS`.
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on body A, MPa.

    Raises
    ------
    ValueError
        If no method is registered for the class.
    """
    raise ValueError(
        f"the stress in bodies with the law {body!r} is unknown; use HalfSpaces or a subclass"
    )


class PatchStress:
    """Stress solver for half-spaces under tractions on rectangular elements."""

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
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        grid = self._grid
        lattice = Lattice(grid.elements, grid.dx, grid.dy)
        loads = self._tractions, self._poisson, self._signs
        return map(StressLayers(lattice, *loads, threads).at, depths)

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, n_y) if z."""
        if axis == "z":
            return next(self.layers([position]))
        loads = self._tractions, self._poisson, self._signs
        plane = StressPlane(self._grid, axis, position, *loads)
        return np.stack([plane.at(depth) for depth in depths], axis=-1)

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""
        grid, sides = self._grid, (self._grid.dx, self._grid.dy)
        each = zip(tractions_on_bodies(self._tractions, self._signs), self._poisson, strict=True)
        patches = [PatchLoads.on_mesh(grid.x, grid.y, sides, on_body, nu) for on_body, nu in each]
        return np.stack([patch.stress(points).T for patch in patches])

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths.

        See `DistantLoads` for the error.
        """
        loads = DistantLoads(self._grid, self._tractions, self._signs, self._poisson)
        return loads.stress(x, depths)

    def levels(self, criterion: StressCriterion) -> MultiLevel:
        """Return the `MultiLevel` of the bodies, in which the largest stress is searched."""
        return MultiLevel(self._grid, self._tractions, self._signs, self._bodies, criterion)


class StripStress:
    """Stress solver for half-spaces under tractions on strips (line contact)."""

    def __init__(
        self, bodies: Sequence[Strips], signs: Sequence[float], grid: Grid, tractions: np.ndarray
    ):
        self._bodies, self._signs, self._grid, self._tractions = bodies, signs, grid, tractions
        self._poisson = tuple(body.A.poisson for body in bodies)

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        lattice = Lattice(self._grid.elements, self._grid.dx, self._grid.dy)
        return map(StripLayers(lattice, self._tractions, self._poisson, self._signs).at, depths)

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, 1) if z."""
        if axis == "z":
            return next(self.layers([position]))
        if axis == "y":
            return np.concatenate(list(self.layers(depths)), axis=-1)
        points = np.stack(np.broadcast_arrays(position, 0.0, depths), axis=-1)
        return self.at(points)[:, :, None]

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""
        each = zip(tractions_on_bodies(self._tractions, self._signs), self._poisson, strict=True)
        strips = [StripLoads.on_grid(self._grid, on_body, nu) for on_body, nu in each]
        return np.stack([strip.stress(points).T for strip in strips])

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths.

        The sum over the elements is exact.
        """
        places = np.broadcast_arrays(x[:, None], 0.0, depths)
        stress = self.at(np.stack(places, axis=-1).reshape(-1, 3))
        return stress.reshape(len(stress), 6, x.size, 1, depths.size)

    def levels(self, criterion: StressCriterion) -> StripLevels:
        """Return the `StripLevels` of the bodies, in which the largest stress is searched."""
        return StripLevels(self._grid, self._tractions, self._signs, self._bodies, criterion)


@stress_source.register
def _patch_stress(body: HalfSpaces, *of_bodies) -> PatchStress:
    """Return the stress solver for half-spaces under rectangular elements."""
    return PatchStress(*of_bodies)


@stress_source.register
def _strip_stress(body: Strips, *of_bodies) -> StripStress:
    """Return the stress solver for a line contact."""
    return StripStress(*of_bodies)
