"""Methods that see nothing but a dimensionless problem and return an outcome."""

from tractive_sam.results.status import Cost, Status
from tractive_sam.solvers.outcome import Outcome

__all__ = ["Cost", "Outcome", "Status"]
