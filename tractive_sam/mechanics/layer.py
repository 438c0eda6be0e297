"""A thin compliant interfacial layer between the bodies."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.mechanics.elasticity import Elasticity


@dataclass(frozen=True)
class InterfacialLayer(Elasticity):
    """Elastic bodies with an interfacial layer, whose shear is compliance times traction.

    A layer of the thickness h and the shear modulus G3 has the compliance L = h/G3 (the third body
    of Vollebregt 2014, Wear 314, 151-157). It adds L dp_t/dx to the slip and reduces the initial
    slope of the creep force curve. It has no normal compliance, and no influence on the stress in
    the bodies under given tractions.

    Parameters
    ----------
    bodies : Elasticity
        The bodies without the layer.
    compliance : float
        L, mm/MPa.

    Examples
    --------
    >>> laws = ts.Laws.of(scene)
    >>> third_body = laws.replace(elasticity=ts.InterfacialLayer(laws.elasticity, compliance=0.5))
    >>> ts.solve(scene, laws=third_body).Qx < contact.Qx
    True
    """

    bodies: Elasticity
    compliance: float
    recorded_name = "Layered"

    @property
    def coupled(self) -> bool:
        """Whether pressure moves the bodies tangentially; the layer does not change it."""
        return self.bodies.coupled

    @property
    def layer(self) -> float:
        """Shear compliance of the interfacial layer, mm/MPa (`Elasticity.layer`)."""
        return self.compliance

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the influence coefficients of the bodies with the shear of the layer, mm/MPa.

        A traction shears only the layer at its own element.

        Parameters as in `Elasticity.coefficients`.
        """
        table = self.bodies.coefficients(component, offsets, dx, dy)
        if component in ("xx", "yy"):
            table = table.copy()
            table[0, 0] += self.compliance
        return table

    def gap_per_pressure(self, length: float, dx: float, dy: float) -> float:
        """Return the unit of gap over that of pressure, mm/MPa, of the bodies without layer.

        Parameters as in `Elasticity.gap_per_pressure`.
        """
        return self.bodies.gap_per_pressure(length, dx, dy)

    def slip_per_traction(self, dx: float, dy: float) -> float:
        """Return the unit of slip over that of traction, 1/MPa: bodies plus compliance/dx."""
        return self.bodies.slip_per_traction(dx, dy) + self.compliance / dx

    def opening(self, normal: np.ndarray, dx: float, dy: float) -> np.ndarray:
        """Return displacement by traction over that by pressure ahead of an edge; no layer.

        There is no layer outside the contact.

        Parameters as in `Elasticity.opening`.
        """
        return self.bodies.opening(normal, dx, dy)

    def spanning(self, length: float) -> "InterfacialLayer":
        """Return bodies and layer for a mesh of the given length in x, mm."""
        return InterfacialLayer(self.bodies.spanning(length), self.compliance)

    def single_body(self, body: str) -> Elasticity:
        """Return the elasticity of one body, "A" or "B", without layer, for the stress in it."""
        return self.bodies.single_body(body)
