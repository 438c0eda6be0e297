"""The meshes of a scene from coarse to fine, and the tolerances that follow from an accuracy."""

import math

from tractive_sam.contact import Gap, choose_grid
from tractive_sam.results import Grid
from tractive_sam.scene import Scene

FIRST = -4
"""Coarsest level: a quarter of the usual elements along each axis."""

NEEDED = 3
"""Number of meshes that an error bar needs."""

WEAR_TOLERANCE = 2e-4
"""Largest tolerance of the adaptive steps: meshes then differ by their resolution only."""

SOLVER_SHARE = 0.01
"""Residual of the contact conditions over the accuracy."""


class Levels:
    """Meshes of a scene; level 0 is the usual one, each level has twice the elements of the last.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy].
    measured : Gap, optional
        Its measured separation.
    """

    def __init__(self, scene: Scene, measured: Gap | None):
        self._scene, self._measured = scene, measured

    def grid(self, level: int) -> Grid:
        """Return the mesh of a level, before it grows with the contact."""
        return choose_grid(self._scene, self._measured, finer=2.0 ** (0.5 * level))

    def allowed(self, level: int) -> bool:
        """Return whether the scene allows the elements of a level; the first levels always."""
        few = level < FIRST + NEEDED
        return few or math.prod(self.grid(level).elements) <= self._scene.accuracy.elements

    def of(self, grid: Grid) -> int:
        """Return the level of a mesh, which may have grown.

        Raises
        ------
        LookupError
            If the mesh is of no level of this scene.
        """
        level = FIRST
        while self.grid(level).dx > 0.99 * grid.dx:
            equal = math.isclose(self.grid(level).dx, grid.dx, rel_tol=1e-9)
            if equal and math.isclose(self.grid(level).dy, grid.dy, rel_tol=1e-9):
                return level
            level += 1
        raise LookupError(f"{grid} is none of the meshes that the scene gives")


def set_tolerances(scene: Scene) -> Scene:
    """Return the scene with the tolerances that its accuracy needs, unless it sets them itself."""
    tolerance = scene.accuracy.tolerance
    entries = scene.entries()
    changes = {}
    if "tolerance" not in entries.get("solver", {}):
        changes["solver.tolerance"] = max(SOLVER_SHARE * tolerance, 1e-8)
    if "wear" in entries and "tolerance" not in entries["wear"]:
        changes["wear.tolerance"] = min(tolerance, WEAR_TOLERANCE)
    return scene.replace(**changes)
