"""The bodies of a contact as half-spaces under its tractions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.mechanics import Elasticity
from tractive_sam.results import Grid, State, widen_field
from tractive_sam.scene import Scene
from tractive_sam.subsurface.mirror import SIGNS
from tractive_sam.subsurface.source import StressSource, stress_source


class Loading(Protocol):
    """Protocol of a loaded surface: scene, grid and tractions, as `State` has them.

    Attributes
    ----------
    scene : Scene
        Scene with the materials.
    grid : Grid
        The mesh.
    pressure, traction : ndarray
        See `State`.
    """

    @property
    def scene(self) -> Scene:
        """Scene of the contact."""

    @property
    def grid(self) -> Grid:
        """Mesh of the surface."""

    @property
    def pressure(self) -> np.ndarray:
        """Pressure, shape (n_x, n_y), MPa."""

    @property
    def traction(self) -> np.ndarray:
        """Tractions (p_x, p_y) on body A, shape (2, n_x, n_y), MPa."""


@dataclass(frozen=True, eq=False)
class LoadedBodies:
    """Bodies of a contact as half-spaces z >= 0, with their tractions and stress solver.

    Attributes
    ----------
    names : tuple of str
        "A" or "B".
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on the half-space of body A, MPa.
    bodies : tuple of Elasticity
        Elastic laws of the bodies, see `Elasticity.single_body`.
    source : StressSource
        Solver of the stress in them.
    """

    names: tuple[str, ...]
    tractions: np.ndarray
    bodies: tuple[Elasticity, ...]
    source: StressSource

    @classmethod
    def from_contact(
        cls, contact: Loading, names: Sequence[str], laws: Laws | None = None, beyond: int = 0
    ) -> "LoadedBodies":
        """Return the loaded bodies of a contact, with the elastic law of its solution.

        Parameters
        ----------
        contact : Loading
            The contact.
        names : sequence of str
            "A" or "B".
        laws : Laws, optional
            Laws of the bodies.
        beyond : int
            Elements without load that are added to the mesh before and behind the contact.

        Raises
        ------
        ValueError
            If a body is neither "A" nor "B", or its law does not give the stress.
        """
        for name in names:
            if name not in SIGNS:
                raise ValueError(f'a body is "A" or "B", not {name!r}')
        tractions = np.concatenate((contact.traction, contact.pressure[None]))
        grid = contact.grid.lengthened(beyond) if beyond else contact.grid
        tractions = widen_field(tractions, grid.elements)
        # Without laws the contact is a state: stored fields have none.
        elasticity = (laws or Laws.of_contact(cast(State, contact))).elasticity
        bodies = tuple(elasticity.single_body(name) for name in names)
        signs = tuple(SIGNS[name] for name in names)
        source = stress_source(bodies[0], bodies, signs, grid, tractions)
        return cls(tuple(names), tractions, bodies, source)

    def in_contact_axes(self, stress: np.ndarray) -> np.ndarray:
        """Change half-spaces' stresses (bodies, 6, ...), in place, to contact axes; return them."""
        for tensor, name in zip(stress, self.names, strict=True):
            tensor[4:] *= SIGNS[name]
        return stress
