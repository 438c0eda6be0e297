"""Units of dimensionless problems."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Units:
    """Units in which the quantities of a problem are of order one (see `operators.elastic`).

    Attributes
    ----------
    pressure : float
        p*, MPa.
    gap : float
        g*, mm; for half-spaces p* l / E*, with l the mean semi-axis of the contact.
    slip : float
        s*, dimensionless; for half-spaces max(mu1, mu2)² p* / G.
    """

    pressure: float
    gap: float
    slip: float
