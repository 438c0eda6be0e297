"""A thin compliant layer between the bodies: what it shears by itself, in every point."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.mechanics.elasticity import Elasticity


@dataclass(frozen=True)
class Layered(Elasticity):
    """Bodies with an interfacial layer, which a traction p_t shears by compliance p_t.

    A layer of the thickness h and the shear modulus G3 has the compliance h/G3 (the third body of
    Vollebregt 2014, Wear 314, 151-157). It adds L dp_t/dx to the slip: the initial slope of the
    traction curve falls. It presses no further, and is part of neither body: the stress in these is
    that of the tractions.

    Parameters
    ----------
    bodies : Elasticity
        The bodies without it.
    compliance : float
        L, mm/MPa.

    Examples
    --------
    >>> laws = ts.Laws.of(scene)
    >>> third_body = laws.replace(elasticity=ts.Layered(laws.elasticity, compliance=0.5))
    >>> ts.solve(scene, laws=third_body).Qx < contact.Qx
    True
    """

    bodies: Elasticity
    compliance: float

    @property
    def coupled(self) -> bool:
        """See `Elasticity.coupled`: that of the bodies."""
        return self.bodies.coupled

    @property
    def layer(self) -> float:
        """See `Elasticity.layer`."""
        return self.compliance

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """See `Elasticity.coefficients`: an element shears the layer below itself only."""
        table = self.bodies.coefficients(component, offsets, dx, dy)
        if component in ("xx", "yy"):
            table = table.copy()
            table[0, 0] += self.compliance
        return table

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """See `Elasticity.gap_per_pressure`."""
        return self.bodies.gap_per_pressure(length, dx, dy)

    def slip_per_traction(self, dx: float, dy: float) -> float:
        """See `Elasticity.slip_per_traction`."""
        return self.bodies.slip_per_traction(dx, dy) + self.compliance / dx

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """See `Elasticity.opening`: the layer ends with the contact."""
        return self.bodies.opening(normal, dx, dy)

    def spanning(self, length: float) -> "Layered":
        """See `Elasticity.spanning`."""
        return Layered(self.bodies.spanning(length), self.compliance)

    def alone(self, body: str) -> Elasticity:
        """See `Elasticity.alone`."""
        return self.bodies.alone(body)
