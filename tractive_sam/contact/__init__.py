"""Sets up and solves steady rolling contact."""

from tractive_sam.contact.equilibrium import equilibrium, fitted
from tractive_sam.contact.jacobian import check_jacobian, jacobian_of
from tractive_sam.contact.laws import Laws
from tractive_sam.contact.measured import across
from tractive_sam.contact.mesh import choose_grid, grown
from tractive_sam.contact.model import Gap, Model
from tractive_sam.results import NotConverged, State

__all__ = [
    "Gap",
    "Laws",
    "Model",
    "NotConverged",
    "State",
    "across",
    "check_jacobian",
    "choose_grid",
    "equilibrium",
    "fitted",
    "grown",
    "jacobian_of",
]
