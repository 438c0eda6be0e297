"""Which records keep their fields, and with them the stress on the planes of the scene."""

from dataclasses import dataclass
from typing import Self

from tractive_sam.scene import Scene


@dataclass(frozen=True)
class Saves:
    """Where along its course a roll keeps fields.

    Parameters
    ----------
    places : tuple of float
        Values of the coordinate, such as revolutions.
    end : float
        Where the roll ends.
    """

    places: tuple[float, ...]
    end: float

    @classmethod
    def of(cls, scene: Scene) -> Self:
        """As a scene asks for; without [wear] that of the unworn bodies, where it ends."""
        if scene.transient is not None:
            return cls(scene.transient.save, scene.transient.distance[-1])
        return cls((0,), 0) if scene.wear is None else cls(scene.wear.save, scene.wear.revolutions)

    def __contains__(self, place: float) -> bool:
        return place in self.places

    def __len__(self) -> int:
        return len(self.places)

    @property
    def stops(self) -> tuple[float, ...]:
        """Where a step has to end, ascending."""
        return tuple(sorted({*self.places, self.end}))
