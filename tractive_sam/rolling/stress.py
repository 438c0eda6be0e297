"""Observers of stress: the largest one, planes, the elastic energy and displacements."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.description import Row
from tractive_sam.results import BODIES, Maximum, PlaneStress, Quantity, State, stress_columns
from tractive_sam.rolling.process import Observer
from tractive_sam.schema import Fault, SceneError
from tractive_sam.subsurface import (
    check_depths,
    displacement,
    elastic_energy,
    maxima_by_body,
    stress_on_planes,
)


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


@dataclass(frozen=True, eq=False)
class ElasticFields(Observer):
    """Observer of the bodies' elastic energy and of their displacement at a depth.

    Parameters
    ----------
    depth : float
        Depth of the stored displacement below the surface of each body, mm.

    Raises
    ------
    ValueError
        If the depth is negative or not finite.

    Examples
    --------
    >>> from tractive_sam.rolling import ElasticFields
    >>> history = ts.roll(scene, observers=[ElasticFields()])
    >>> history.field("displacement_z_A").shape, bool(history["stored_energy"][0] > 0.0)
    ((91, 91), True)
    """

    depth: float = 0.0
    contacts: tuple[State, ...] = ()
    weights: tuple[float, ...] = ()

    name = "elastic_fields"
    columns = (
        Quantity("stored_energy", "N mm", "elastic energy of both bodies, a mean of blocks"),
    )
    fields = tuple(
        Quantity(f"displacement_{axis}_{body}", "mm", f"displacement of body {body} in {axis}")
        for body in BODIES
        for axis in "xyz"
    )

    def __post_init__(self) -> None:
        check_depths([self.depth])

    def begin(self, step: Any, model: Model) -> Self:
        """Return the observer with the contacts of the first step.

        Raises
        ------
        SceneError
            For a line contact: its displacement relative to distant points is infinite.
        """
        if model.scene.line:
            cure = "a finite radius_y of a body: the displacement of a line contact is infinite"
            raise SceneError([Fault("observer", f"{self.name} in a line contact", cure)])
        return self.after(step, model)

    def after(self, step: Any, model: Model) -> Self:
        """Return the observer with the contacts of a later step instead of the earlier ones."""
        return replace(self, contacts=step.contacts, weights=step.weights)

    def restore(self, step: Any, stored: Any) -> Self:
        """Return the observer with the contacts of the step; nothing else is stored."""
        return replace(self, contacts=step.contacts, weights=step.weights)

    def record(self, model: Model, recorded: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the column `stored_energy`, the weighted sum over blocks, by name."""
        each = zip(self.weights, self.contacts, strict=True)
        return {"stored_energy": sum(w * elastic_energy(contact) for w, contact in each if w)}

    def record_fields(self, block: int) -> Mapping[str, np.ndarray]:
        """Return the displacements of both bodies at `depth`, by name, (n_x, n_y)."""
        return {
            f"displacement_{axis}_{body}": values
            for body in BODIES
            for axis, values in zip(
                "xyz", displacement(self.contacts[block], body, self.depth), strict=True
            )
        }
