"""Particles of the surfaces in a time step, and the work of tractions on them.

See `contact.step` for the equations.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.contact.model import Model


@dataclass(frozen=True, eq=False)
class Particles:
    """Particles at the nodes after, or before, a step, with their part in the work of the step.

    Attributes
    ----------
    pressure : ndarray, shape (n_x, n_y)
        Pressure, MPa.
    fields : ndarray, shape (2 or 3, n_x, n_y)
        Dimensionless tractions that do work; for dissimilar bodies after the pressure.
    change : ndarray, shape (2 or 3, n_x, n_y)
        Change of the dimensionless displacements in the step.
    rigid : ndarray, shape (2, n_x, n_y)
        Slip of the undeformed bodies, dimensionless.
    weight : float
        Share of these particles in the work.
    earlier : bool
        Whether they are at the nodes before the step.
    wearing : ndarray, shape (n_x, n_y), or float
        Factor on the slip that wears: 0 for particles that stick.
    recalled : ndarray, shape (terms, 3, n_x, n_y), optional
        Part of the change by the memory of each term of bodies that relax.
    """

    pressure: np.ndarray
    fields: np.ndarray
    change: np.ndarray
    rigid: np.ndarray
    weight: float = 1.0
    earlier: bool = False
    wearing: np.ndarray | float = 1.0
    recalled: np.ndarray | None = None

    @property
    def traction(self) -> np.ndarray:
        """Dimensionless traction, shape (2, n_x, n_y)."""
        return self.fields[-2:]

    @property
    def slip(self) -> np.ndarray:
        """Dimensionless slip: rigid slip and the change of displacement, shape (2, n_x, n_y)."""
        return self.rigid + self.change[-2:]


class StepWork:
    """Work of dimensionless fields on displacements of a model, in N mm.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    """

    def __init__(self, model: Model):
        units, grid = model.units, model.grid
        force = units.pressure * grid.element_area
        self._slip, self._gap = force * units.slip * grid.dx, force * units.gap

    def tangential(self, fields: np.ndarray, moved: np.ndarray) -> float:
        """Return the work, N mm, of tractions on tangential displacements, both dimensionless."""
        return self._slip * float(np.vdot(fields[-2:], moved[-2:]))

    def normal(self, fields: np.ndarray, moved: np.ndarray) -> float:
        """Return the work of the pressure, N mm; 0 if `fields` are tractions only."""
        return self._gap * float(np.vdot(fields[:-2], moved[:-2]))

    def energy(self, fields: np.ndarray, displacement: np.ndarray) -> float:
        """Return the elastic energy, N mm: half the work of fields on their displacements."""
        moved = displacement[:, : fields.shape[1]]
        return 0.5 * (self.tangential(fields, moved) + self.normal(fields, moved))

    def supplied(self, groups: Iterable[Particles]) -> float:
        """Return the work of the forces that drive the bodies in a step, N mm."""
        return sum(
            group.weight
            * (self.normal(group.fields, group.change) - self.tangential(group.fields, group.rigid))
            for group in groups
        )

    def friction(self, groups: Iterable[Particles]) -> float:
        """Return the work of friction in a step, N mm; positive if dissipated."""
        return -sum(group.weight * self.tangential(group.fields, group.slip) for group in groups)

    def match_work(self, groups: tuple[Particles, ...], friction: float) -> tuple[Particles, ...]:
        """Return the particles with `wearing` scaled so that their work equals that of friction.

        Interpolation also moves particles slightly between nodes that stick. That work is part of
        the sum, but nothing slides there: the sliding particles wear by all of it.

        Parameters
        ----------
        groups : tuple of Particles
            Particles of the step.
        friction : float
            Work of friction of the step, N mm.
        """
        wearing = 0.0
        for group in groups:
            local = np.maximum(-(group.traction * group.slip).sum(axis=0), 0.0)
            wearing += group.weight * self._slip * float((group.wearing * local).sum())
        factor = max(friction, 0.0) / wearing if wearing > 0.0 else 0.0
        return tuple(replace(group, wearing=factor * group.wearing) for group in groups)
