"""States equilibrium and friction of two bodies, and has it solved."""

from tractive_sam.contact.equilibrium import equilibrium
from tractive_sam.contact.fitted import fitted
from tractive_sam.contact.mesh import choose_grid, grown
from tractive_sam.contact.model import Gap, Model
from tractive_sam.results.state import Contact, NotConverged

__all__ = [
    "Contact",
    "Gap",
    "Model",
    "NotConverged",
    "choose_grid",
    "equilibrium",
    "fitted",
    "grown",
]
