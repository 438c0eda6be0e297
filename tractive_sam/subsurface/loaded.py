"""The bodies of a contact as half-spaces under its tractions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.mechanics import Elasticity
from tractive_sam.results import Grid, widened
from tractive_sam.scene import Scene
from tractive_sam.subsurface.mirror import SIGNS
from tractive_sam.subsurface.source import StressSource, stress_source


class Loading(Protocol):
    """What stress is computed from: a `State`, or as much as was stored of one.

    Attributes
    ----------
    scene : Scene
        With the materials.
    grid : Grid
        The mesh.
    pressure, traction : ndarray
        As of `State`.
    """

    scene: Scene
    grid: Grid
    pressure: np.ndarray
    traction: np.ndarray


@dataclass(frozen=True, eq=False)
class LoadedBodies:
    """Bodies seen as half-spaces z >= 0, and the way back to the axes of the contact.

    Attributes
    ----------
    names : tuple of str
        "A" or "B".
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on the half-space of body A, MPa.
    bodies : tuple of Elasticity
        What they are made of, as `Elasticity.single_body` gives it.
    source : StressSource
        What finds the stress in them.
    """

    names: tuple[str, ...]
    tractions: np.ndarray
    bodies: tuple[Elasticity, ...]
    source: StressSource

    @classmethod
    def of(
        cls,
        contact: Loading,
        names: Sequence[str],
        laws: Laws | None = None,
        beyond: int = 0,
    ) -> "LoadedBodies":
        """Take bodies of a contact, by default with the laws that it was solved with.

        Their mesh may go on `beyond` the contact's by so many elements without load, before and
        behind it in the rolling direction.

        Raises
        ------
        ValueError
            If a body is neither "A" nor "B", or the stress in it is not known.
        """
        for name in names:
            if name not in SIGNS:
                raise ValueError(f'a body is "A" or "B", not {name!r}')
        tractions = np.concatenate((contact.traction, contact.pressure[None]))
        grid = contact.grid.lengthened(beyond) if beyond else contact.grid
        tractions = widened(tractions, grid.elements)
        elasticity = (laws or Laws.of_contact(contact)).elasticity
        bodies = tuple(elasticity.single_body(name) for name in names)
        signs = tuple(SIGNS[name] for name in names)
        source = stress_source(bodies[0], bodies, signs, grid, tractions)
        return cls(tuple(names), tractions, bodies, source)

    def in_contact_axes(self, stress: np.ndarray) -> np.ndarray:
        """Turn stresses (bodies, 6, ...) of the half-spaces into the axes of the contact."""
        for one, name in zip(stress, self.names, strict=True):
            one[4:] *= SIGNS[name]
        return stress
