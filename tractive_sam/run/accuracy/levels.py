"""The meshes of a scene from coarse to fine, and the tolerances that follow from an accuracy."""

import math
from typing import ClassVar

from tractive_sam.contact import Gap, choose_grid
from tractive_sam.results import Grid
from tractive_sam.scene import Scene
from tractive_sam.schema import required


class Levels:
    """Meshes to refine a scene with [accuracy]: a level has twice the total elements of the last.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy].
    measured : Gap, optional
        Measured separation of the scene.
    """

    first: ClassVar[int] = -4
    """Coarsest level: a quarter of the usual elements along each axis."""

    needed: ClassVar[int] = 3
    """Number of meshes that an error bar needs."""

    def __init__(self, scene: Scene, measured: Gap | None):
        self._scene, self._measured = scene, measured

    def grid(self, level: int) -> Grid:
        """Return the mesh of a level (0: the usual one), before it grows with the contact."""
        return choose_grid(self._scene, self._measured, finer=2.0 ** (0.5 * level))

    def allowed(self, level: int) -> bool:
        """Return whether a level has few enough elements for the scene; the first levels always."""
        few = level < self.first + self.needed
        most = required(self._scene.accuracy, "accuracy").elements
        return few or math.prod(self.grid(level).elements) <= most

    def find_level(self, grid: Grid) -> int:
        """Return the level of a mesh, which may have grown; raise a LookupError for other meshes.

        Raises
        ------
        LookupError
            If the mesh is of no level of this scene.
        """
        level = self.first
        while self.grid(level).dx > 0.99 * grid.dx:
            equal = math.isclose(self.grid(level).dx, grid.dx, rel_tol=1e-9)
            if equal and math.isclose(self.grid(level).dy, grid.dy, rel_tol=1e-9):
                return level
            level += 1
        raise LookupError(f"{grid} is none of the meshes that the scene gives")


def set_tolerances(scene: Scene) -> Scene:
    """Return the scene with solver and wear tolerances for its accuracy, unless it sets them."""
    tolerance = required(scene.accuracy, "accuracy").tolerance
    entries = scene.entries()
    changes = {}
    if "tolerance" not in entries.get("solver", {}):
        changes["solver.tolerance"] = max(0.01 * tolerance, 1e-8)  # of the contact conditions
    if "wear" in entries and "tolerance" not in entries["wear"]:
        # With adaptive steps this accurate, meshes differ by their resolution only.
        changes["wear.tolerance"] = min(tolerance, 2e-4)
    return scene.replace(**changes)
