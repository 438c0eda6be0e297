"""The bodies of a contact as half-spaces under its tractions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tractive_sam.results.grid import Grid
from tractive_sam.scene import Scene

SIGNS = {"A": 1.0, "B": -1.0}
"""Sign of z in each body, and of the tangential traction that acts on it."""


class Loading(Protocol):
    """What stress is computed from: a `Contact`, or as much as was stored of one.

    Attributes
    ----------
    scene : Scene
        With the materials.
    grid : Grid
        The mesh.
    pressure, traction : ndarray
        As of `Contact`.
    """

    scene: Scene
    grid: Grid
    pressure: np.ndarray
    traction: np.ndarray


@dataclass(frozen=True)
class LoadedBodies:
    """Bodies seen as half-spaces z >= 0, and the way back to the axes of the contact.

    Body A is one as it stands. Body B is its mirror image in z: it carries the opposite tangential
    traction, and in the axes of the contact its xz and yz have the opposite sign.

    Attributes
    ----------
    names : tuple of str
        "A" or "B".
    tractions : ndarray, shape (bodies, 3, n_x, n_y)
        (p_x, p_y, p_n) acting on each half-space, MPa.
    poisson : tuple of float
        Poisson's ratio of each.
    """

    names: tuple[str, ...]
    tractions: np.ndarray
    poisson: tuple[float, ...]

    @classmethod
    def of(cls, contact: Loading, names: Sequence[str]) -> "LoadedBodies":
        """Take bodies of a contact.

        Raises
        ------
        ValueError
            If a body is neither "A" nor "B".
        """
        for name in names:
            if name not in SIGNS:
                raise ValueError(f'a body is "A" or "B", not {name!r}')
        p_n = contact.pressure[None]
        tractions = [np.concatenate((SIGNS[name] * contact.traction, p_n)) for name in names]
        materials = contact.scene.materials
        return cls(
            tuple(names), np.stack(tractions), tuple(materials[name].poisson for name in names)
        )

    def in_contact_axes(self, stress: np.ndarray) -> np.ndarray:
        """Turn stresses (bodies, 6, ...) of the half-spaces into the axes of the contact."""
        for one, name in zip(stress, self.names, strict=True):
            one[4:] *= SIGNS[name]
        return stress
