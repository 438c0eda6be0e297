"""The meshes of a scene from coarse to fine, and the tolerances that go with an accuracy."""

import math

from tractive_sam.contact import Gap, choose_grid
from tractive_sam.results import Grid
from tractive_sam.scene import Scene

FIRST = -4
"""Coarsest level: a quarter of the usual elements along each axis."""

NEEDED = 3
"""Meshes that an error bar takes."""

WEAR_TOLERANCE = 2e-4
"""Loosest tolerance of the adaptive stepping: with it meshes differ by what they resolve only."""

SOLVER_SHARE = 0.01
"""Residual of the contact conditions over the accuracy."""


class Levels:
    """Meshes of a scene; level 0 is the usual one, each next one has twice the elements.

    Parameters
    ----------
    scene : Scene
        With [accuracy].
    measured : Gap, optional
        Its measured separation.
    """

    def __init__(self, scene: Scene, measured: Gap | None):
        self._scene, self._measured = scene, measured

    def grid(self, level: int) -> Grid:
        """The mesh of a level, before it grows with the contact."""
        return choose_grid(self._scene, self._measured, finer=2.0 ** (0.5 * level))

    def allowed(self, level: int) -> bool:
        """Whether a level has no more elements than the scene allows; the first ones always."""
        few = level < FIRST + NEEDED
        return few or math.prod(self.grid(level).elements) <= self._scene.accuracy.elements

    def of(self, grid: Grid) -> int:
        """The level of a mesh, which may have grown.

        Raises
        ------
        LookupError
            If it is of no level of this scene.
        """
        level = FIRST
        while self.grid(level).dx > 0.99 * grid.dx:
            same = math.isclose(self.grid(level).dx, grid.dx, rel_tol=1e-9)
            if same and math.isclose(self.grid(level).dy, grid.dy, rel_tol=1e-9):
                return level
            level += 1
        raise LookupError(f"{grid} is none of the meshes of the scene")


def with_tolerances(scene: Scene) -> Scene:
    """The scene with the tolerances that its accuracy asks for, where it does not give them."""
    tolerance = scene.accuracy.tolerance
    given = scene.entries()
    changes = {}
    if "tolerance" not in given.get("solver", {}):
        changes["solver.tolerance"] = max(SOLVER_SHARE * tolerance, 1e-8)
    if "wear" in given and "tolerance" not in given["wear"]:
        changes["wear.tolerance"] = min(tolerance, WEAR_TOLERANCE)
    return scene.replace(**changes)
