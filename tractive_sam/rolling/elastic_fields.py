"""An observer that records the elastic energy and stores the displacement of the bodies."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.results import BODIES, Quantity, State
from tractive_sam.rolling.observer import Observer
from tractive_sam.schema import Fault, SceneError
from tractive_sam.subsurface import check_depths, displacement, elastic_energy


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
