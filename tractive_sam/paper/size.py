"""Meshes and revolutions of the problems of the paper."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Size:
    """Numbers of elements, creepages and revolutions with which the paper is reproduced.

    Attributes
    ----------
    name : str
        Description on the page.
    spheres : int
        Elements on a side of the mesh of the spheres.
    meshes : tuple of int
        Elements on a side of the meshes on which creep-force curves are compared.
    creepages : int
        Number of points of a creep-force curve.
    discs, flat_discs : tuple of int
        Elements in x and y of the twin discs, and of the discs with the flatter crown.
    saved : tuple of int
        Revolutions with stored fields; the last one ends the run.
    """

    name: str
    spheres: int
    meshes: tuple[int, ...]
    creepages: int
    discs: tuple[int, int]
    flat_discs: tuple[int, int]
    saved: tuple[int, ...]

    @property
    def revolutions(self) -> int:
        """Number of revolutions of a run: the last one with stored fields."""
        return self.saved[-1]


FULL = Size(
    "the paper's meshes and revolutions",
    spheres=91,
    meshes=(45, 91, 181),
    creepages=14,
    discs=(41, 121),
    flat_discs=(41, 241),
    saved=(0, 50, 250, 1000, 4000, 15000),
)

REDUCED = Size(
    "a reduced size: coarse meshes and few revolutions, as a quick check",
    spheres=31,
    meshes=(15, 31),
    creepages=6,
    discs=(21, 41),
    flat_discs=(21, 81),
    saved=(0, 50, 250),
)
