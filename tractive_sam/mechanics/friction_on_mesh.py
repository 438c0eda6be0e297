"""A friction law on the elements of a mesh, in the units of the solvers."""

from dataclasses import dataclass, field, replace

import numpy as np

from tractive_sam.mechanics.friction import Bound, Coulomb, FrictionLaw


@dataclass(frozen=True, eq=False)
class FrictionOnMesh:
    """A friction law on the elements of a mesh, dimensionless, for the solvers.

    Parameters
    ----------
    law : FrictionLaw
        The law.
    x, y : ndarray, shapes (n_x, 1) and (1, n_y)
        Centres of the elements, mm.
    unit : float
        Unit of the pressure, MPa.
    slip : float
        Unit of the slip s/V.
    """

    law: FrictionLaw = field(default_factory=Coulomb)
    x: np.ndarray = field(default_factory=lambda: np.zeros((1, 1)))
    y: np.ndarray = field(default_factory=lambda: np.zeros((1, 1)))
    unit: float = 1.0
    slip: float = 1.0

    def bound(self, pressure: np.ndarray) -> Bound:
        """Return the traction bound at rest and its derivative by the pressure, dimensionless."""
        bound = self.law.bound(self.unit * pressure, self.x, self.y)
        radius = bound.radius / self.unit
        if radius.shape != pressure.shape:
            radius = np.broadcast_to(radius, pressure.shape)
        # Not `replace`, which takes longer than the bound on small meshes.
        return Bound(radius, bound.by_pressure, bound.slope)

    def bound_sliding(
        self, pressure: np.ndarray, slip: np.ndarray, contact: np.ndarray, staggered: float
    ) -> Bound:
        """Return the bound and slope under scaled slip of leading faces, dimensionless."""
        frame = self.law.frame
        centred = self.law.slip_at_centres(slip, contact, staggered)
        bound = self.law.bound_sliding(
            self.unit * pressure,
            self.slip * frame.slip_to_physical(centred),
            self.x,
            self.y,
            bool(staggered),
        )
        slope = bound.slope
        if slope is not None:
            # ds = F^-1 ds~: derivatives by the slip transform as tractions.
            by_slip = self.slip * frame.to_scaled(slope.by_slip)
            slope = replace(slope, by_share=slope.by_share / self.unit, by_slip=by_slip)
        return replace(bound, radius=bound.radius / self.unit, slope=slope)

    def at_speed_ratio(self, ratio: float) -> "FrictionOnMesh":
        """Return the law with the rolling speed multiplied by `ratio`; 0 gives static friction."""
        return replace(self, law=self.law.at_speed_ratio(ratio))

    def on_elements(self, x: np.ndarray, y: np.ndarray) -> "FrictionOnMesh":
        """Return the law on the elements with centres (x, y), mm."""
        return replace(self, x=x, y=y)
