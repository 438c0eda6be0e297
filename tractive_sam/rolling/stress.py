"""The largest stress in the bodies, and stress on the planes of a scene, for every step."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.results import Maximum, PlaneStress, Quantity, State, stress_columns
from tractive_sam.rolling.observer import Observer
from tractive_sam.subsurface import maxima_by_body, stress_on_planes


@dataclass(frozen=True, eq=False)
class LargestStress(Observer):
    """Observer of the largest equivalent stress of each body, and of stress on planes.

    It is computed when it is recorded, so steps that are refused take no time.

    Attributes
    ----------
    contacts : tuple of State
        Contacts of the last step, one for each block.
    model : Model
        The scene in numbers.
    """

    name, key, unsolved = "stress", "subsurface", True

    contacts: tuple[State, ...] = ()
    model: Model | None = None

    def begin(self, step: Any, model: Model) -> "LargestStress":
        """Return the observer with the contacts of the first step; see `Observer.begin`."""
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> "LargestStress":
        """Return the observer with the contacts of a later step."""
        return LargestStress(step.contacts, model)

    def restore(self, step: Any, stored: Any) -> "LargestStress":
        """Return the observer unchanged: it stores nothing.

        It does not depend on earlier steps.

        Parameters as in `Observer.restore`.
        """
        return self

    def describe(self, model: Model) -> Iterator[Row]:
        """Yield the rows (label, text) that `explain` prints for the observer."""
        name = model.laws.criterion.long_name
        yield Row(f"largest {name}", "inside and at the surface, with every record")

    @property
    def columns(self) -> tuple[Quantity, ...]:
        """Columns of the largest stress, inside and at the surface; none before the first step.

        They are the columns of the fatigue criterion of the laws.
        """
        return () if self.model is None else stress_columns(self.model.blocks[0].laws.criterion)

    @cached_property
    def maxima(self) -> tuple[dict[str, Maximum], ...]:
        """Largest stresses below the contact of each block, by body; empty at the beginning."""
        if self.model is None:
            return ()
        blocks = zip(self.contacts, self.model.blocks, strict=True)
        return tuple(maxima_by_body(contact, block.laws) for contact, block in blocks)

    def record_block(self, block: int) -> dict[str, dict[str, Any]]:
        """Return the largest stresses of a block, by column and then by body."""
        names = ("value", "interior", "surface", "at")
        maxima = self.maxima[block].items()
        return {
            column.name: {body: getattr(maximum, name) for body, maximum in maxima}
            for column, name in zip(self.columns, names, strict=False)
        }

    def record_stress(self, block: int) -> tuple[PlaneStress, ...]:
        """Return the stress on planes below the contact of a block; none before the first step.

        The planes are listed in the scene.
        """
        if self.model is None:
            return ()
        laws = self.model.blocks[block].laws
        return tuple(stress_on_planes(self.contacts[block], laws=laws))
