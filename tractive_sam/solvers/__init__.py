"""Methods that see nothing but a dimensionless problem and return an outcome."""

from tractive_sam.solvers.outcome import Cost, Outcome, Status

__all__ = ["Cost", "Outcome", "Status"]
