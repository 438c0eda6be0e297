"""Scenes of the paper, their meshes and revolutions."""

from dataclasses import dataclass

from tractive_sam.mechanics import HertzContact
from tractive_sam.scene import Friction, Scene
from tractive_sam.schema import required


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


ANGLES = (0.0, 45.0, 90.0)
"""Angles of the tribological axis e1 from the rolling direction, degrees."""

ANGLE_TEXT = "0°, 45° and 90°"
"""These angles as text."""


def spheres(size: Size, elements: int | None = None) -> Scene:
    """Return the scene of two equal spheres with isotropic friction (Sec. 8.1.1 of the paper)."""
    n = elements or size.spheres
    return Scene.builtin("spheres").with_set([f"grid.elements=[{n}, {n}]"])


def orthotropic_spheres(size: Size, angle: float) -> Scene:
    """Return the scene of equal spheres, orthotropic friction (Sec. 8.1.2); angle in degrees."""
    n = size.spheres
    settings = [f"grid.elements=[{n}, {n}]", f"friction.angle={angle}"]
    return Scene.builtin("spheres-orthotropic").with_set(settings)


def discs(size: Size, angle: float) -> Scene:
    """Return the scene of twin discs, orthotropic friction, wear (Sec. 8.2); angle in degrees."""
    settings = [*_wear_settings(size, size.discs), f"friction.angle={angle}"]
    return Scene.builtin("twin-discs").with_set(settings)


def flat_discs(size: Size) -> Scene:
    """Return the scene of twin discs with a flatter crown, isotropic friction (Appendix B)."""
    return Scene.builtin("twin-discs-isotropic").with_set(_wear_settings(size, size.flat_discs))


def _wear_settings(size: Size, elements: tuple[int, int]) -> list[str]:
    """Return assignments of scene keys ("key=value"): mesh, revolutions, stored fields."""
    return [
        f"grid.elements={list(elements)}",
        f"wear.revolutions={size.revolutions}",
        f"wear.save={list(size.saved)}",
    ]


def hertz_of(scene: Scene) -> HertzContact:
    """Return the Hertz contact of a scene, which every scene of the paper has."""
    hertz = scene.hertz
    assert isinstance(hertz, HertzContact)
    return hertz


def friction_of(scene: Scene) -> Friction:
    """Return the friction of a scene, which every scene of the paper has."""
    return required(scene.friction, "friction")


def friction_bound(scene: Scene) -> float:
    """Return mu1 P of a scene of the paper, the largest friction force along e1, N."""
    return friction_of(scene).mu[0] * hertz_of(scene).load
